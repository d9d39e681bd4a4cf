//! A part of the creature: a chain of round cones with its own fillet and skin.

use super::super::implicit::{Flatten, RoundCone, V3, smooth_carve, smooth_union, smoothstep};
use super::skin::{Skin, SkinPoint};

/// Axis length of a round cone that represents a ball, model units.
const BALL_AXIS: f64 = 2e-4;

/// Upper bound of the number of bones of a part.
const MAX_BONES: usize = 32;

/// Distance from the nearest bone within which bones share the position along the chain, model units.
const BEND_BLEND: f64 = 0.015;

/// Effect of a bone on the part.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum PartRole {
    Add,
    Carve,
}

/// A round cone, possibly flattened, and its joint with those before.
#[derive(Clone, Debug)]
struct Bone {
    cone: RoundCone,
    /// Center and radius of a ball that contains the cone, model units.
    ball: (V3, f64),
    flatten: Option<Flatten>,
    role: PartRole,
    /// Width of the fillet, model units.
    blend: f64,
    /// Length of the chain before this bone, model units.
    arc: f64,
}

impl Bone {
    /// True if [`distance`](Self::distance) is certainly at least `limit` at `p`.
    fn is_as_far_as(&self, p: V3, limit: f64) -> bool {
        let (center, radius) = self.ball;
        // A flattened bone is nearer by its factor at most.
        let reach = radius + limit * self.flatten.as_ref().map_or(1.0, |flatten| flatten.factor);
        reach <= 0.0 || (p - center).norm_squared() > reach * reach
    }

    fn distance(&self, p: V3) -> f64 {
        match &self.flatten {
            None => self.cone.distance(p),
            Some(flatten) => self.cone.distance(flatten.unsqueeze(p)) / flatten.factor,
        }
    }
}

/// Bones, their common bounding ball, and the skin on them.
#[derive(Clone, Debug)]
pub(super) struct BodyPart {
    bones: Vec<Bone>,
    /// Length of the chain so far, model units.
    next_arc: f64,
    skin: Vec<Skin>,
    /// Sum of the layers' largest heights, model units.
    highest: f64,
    /// Width of the fillet to the parts before, model units.
    pub(super) blend: f64,
    center: V3,
    radius: f64,
    /// Largest flattening: distances are underestimated by at most this factor.
    stretch: f64,
}

impl BodyPart {
    pub(super) fn new(blend: f64) -> Self {
        Self {
            bones: Vec::new(),
            next_arc: 0.0,
            skin: Vec::new(),
            highest: 0.0,
            blend,
            center: V3::zeros(),
            radius: 0.0,
            stretch: 1.0,
        }
    }

    /// Adds a round cone from ball (`a`, `ra`) to ball (`b`, `rb`).
    pub(super) fn bone(mut self, a: V3, ra: f64, b: V3, rb: f64, blend: f64) -> Self {
        assert!(self.bones.len() < MAX_BONES, "a part has at most {MAX_BONES} bones");
        let cone = RoundCone::new(a, ra, b, rb);
        let arc = self.next_arc;
        self.next_arc += cone.length();
        let ball = (a.lerp(&b, 0.5), 0.5 * cone.length() + ra.max(rb));
        self.bones.push(Bone { cone, ball, flatten: None, role: PartRole::Add, blend, arc });
        self.bounded()
    }

    /// Starts a new branch at the distance `arc` along the chain.
    pub(super) fn branch(mut self, arc: f64) -> Self {
        self.next_arc = arc;
        self
    }

    /// Adds round cones through the balls in turn.
    pub(super) fn chain(mut self, balls: &[(V3, f64)], blend: f64) -> Self {
        for pair in balls.windows(2) {
            self = self.bone(pair[0].0, pair[0].1, pair[1].0, pair[1].1, blend);
        }
        self
    }

    /// Adds a ball (as a very short round cone).
    pub(super) fn ball(self, center: V3, radius: f64, blend: f64) -> Self {
        let offset = V3::new(0.0, 0.5 * BALL_AXIS, 0.0);
        self.bone(center - offset, radius, center + offset, radius, blend)
    }

    /// Makes the last bone thinner by `factor` along `normal`, about the middle of its axis.
    pub(super) fn flatten_along(mut self, normal: V3, factor: f64) -> Self {
        let bone = self.bones.last_mut().expect("a bone to flatten");
        let [(a, _), (b, _)] = bone.cone.balls();
        bone.flatten = Some(Flatten { center: a.lerp(&b, 0.5), normal: normal.normalize(), factor });
        self.bounded()
    }

    /// Turns the last bone into a hollow.
    pub(super) fn carve(mut self) -> Self {
        self.bones.last_mut().expect("a bone to carve with").role = PartRole::Carve;
        self.bounded()
    }

    /// Adds a layer of skin.
    pub(super) fn skin(mut self, skin: Skin) -> Self {
        self.highest += skin.highest();
        self.skin.push(skin);
        self
    }

    fn bounded(mut self) -> Self {
        let solid = || self.bones.iter().filter(|b| b.role == PartRole::Add);
        let balls: Vec<_> = solid().flat_map(|b| b.cone.balls()).collect();
        self.center = balls.iter().map(|b| b.0).sum::<V3>() / balls.len().max(1) as f64;
        // A fillet of width k bulges by at most k/4.
        let bulge: f64 = solid().map(|b| 0.25 * b.blend).sum();
        self.radius = balls.iter().map(|b| (b.0 - self.center).norm() + b.1).fold(0.0, f64::max) + bulge;
        self.stretch = solid().filter_map(|b| b.flatten.as_ref()).map(|f| f.factor).fold(1.0, f64::max);
        self
    }

    /// Balls whose union contains the part.
    pub(super) fn balls(&self) -> impl Iterator<Item = (V3, f64)> + '_ {
        let solid = self.bones.iter().filter(|b| b.role == PartRole::Add);
        let bulge = 0.25 * self.blend;
        solid.flat_map(move |b| b.cone.balls().map(move |(c, r)| (c, r + bulge)))
    }

    /// True if [`distance`](Self::distance) is certainly more than `limit` at `p`.
    pub(super) fn is_farther_than(&self, p: V3, limit: f64) -> bool {
        let reach = self.radius + (limit * self.stretch).max(0.0);
        (p - self.center).norm_squared() > reach * reach
    }

    /// Signed distance (an underestimate where flattened) to the part without skin.
    pub(super) fn distance(&self, p: V3) -> f64 {
        let mut total = f64::INFINITY;
        for bone in &self.bones {
            // Beyond the width of the fillet a bone changes nothing.
            let side = if bone.role == PartRole::Carve { -total } else { total };
            if bone.is_as_far_as(p, side + bone.blend) {
                continue;
            }
            let distance = bone.distance(p);
            total = match bone.role {
                PartRole::Carve => smooth_carve(total, distance, bone.blend),
                PartRole::Add if total.is_finite() => smooth_union(total, distance, bone.blend),
                PartRole::Add => distance,
            };
        }
        total
    }

    /// Bound of the magnitude of [`skin_height`](Self::skin_height).
    pub(super) fn highest_skin(&self) -> f64 {
        self.highest
    }

    /// Height of the skin at `p`, positive outwards, model units.
    pub(super) fn skin_height(&self, p: V3) -> f64 {
        if self.skin.is_empty() {
            return 0.0;
        }
        let mut distances = [f64::INFINITY; MAX_BONES];
        let mut nearest = f64::INFINITY;
        for (bone, distance) in self.rods().zip(&mut distances) {
            if !bone.is_as_far_as(p, nearest + BEND_BLEND) {
                *distance = bone.distance(p);
                nearest = nearest.min(*distance);
            }
        }
        // On the inner side of a bend the two bones disagree; the blend keeps the pattern continuous there.
        let (mut along, mut weights) = (0.0, 0.0);
        for (bone, distance) in self.rods().zip(distances) {
            let weight = smoothstep(BEND_BLEND, 0.0, distance - nearest);
            if weight > 0.0 {
                along += weight * (bone.arc + bone.cone.fraction(p) * bone.cone.length());
                weights += weight;
            }
        }
        let along = if weights > 0.0 { along / weights } else { 0.0 };
        let place = SkinPoint { at: p, along };
        self.skin.iter().map(|skin| skin.height(&place)).sum()
    }

    /// The solid bones without the balls, which only thicken the chain.
    fn rods(&self) -> impl Iterator<Item = &Bone> {
        self.bones.iter().filter(|b| b.role == PartRole::Add && b.cone.length() > 2.0 * BALL_AXIS)
    }
}
