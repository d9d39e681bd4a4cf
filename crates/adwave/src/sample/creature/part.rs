//! A part of the creature: a chain of round cones with its own fillet and skin.

use super::super::implicit::{Flatten, RoundCone, V3, smooth_carve, smooth_union};
use super::skin::{Place, Skin};

/// What a bone does to the part so far.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Role {
    Add,
    Carve,
}

/// A round cone, possibly flattened, and how it joins those before.
#[derive(Clone, Debug)]
struct Bone {
    cone: RoundCone,
    flatten: Option<Flatten>,
    role: Role,
    /// Width of the fillet, model units.
    blend: f64,
    /// Length of the chain before this bone, model units.
    arc: f64,
}

impl Bone {
    fn distance(&self, p: V3) -> f64 {
        match &self.flatten {
            None => self.cone.distance(p),
            Some(flatten) => self.cone.distance(flatten.unsqueeze(p)) / flatten.factor,
        }
    }
}

/// Bones, their common bounding ball, and the skin on them.
#[derive(Clone, Debug)]
pub(super) struct Part {
    bones: Vec<Bone>,
    skin: Vec<Skin>,
    /// Width of the fillet to the parts before, model units.
    pub(super) blend: f64,
    centre: V3,
    radius: f64,
    /// Largest flattening: distances are underestimated by at most this factor.
    stretch: f64,
}

impl Part {
    pub(super) fn new(blend: f64) -> Self {
        Self { bones: Vec::new(), skin: Vec::new(), blend, centre: V3::zeros(), radius: 0.0, stretch: 1.0 }
    }

    /// Adds a round cone from ball (`a`, `ra`) to ball (`b`, `rb`).
    pub(super) fn bone(mut self, a: V3, ra: f64, b: V3, rb: f64, blend: f64) -> Self {
        let arc = self.bones.last().map_or(0.0, |bone| bone.arc + bone.cone.length());
        self.bones.push(Bone {
            cone: RoundCone::new(a, ra, b, rb),
            flatten: None,
            role: Role::Add,
            blend,
            arc,
        });
        self.bounded()
    }

    /// Adds round cones through the balls in turn.
    pub(super) fn chain(mut self, balls: &[(V3, f64)], blend: f64) -> Self {
        for pair in balls.windows(2) {
            self = self.bone(pair[0].0, pair[0].1, pair[1].0, pair[1].1, blend);
        }
        self
    }

    /// Adds a ball (as a very short round cone).
    pub(super) fn ball(self, centre: V3, radius: f64, blend: f64) -> Self {
        let offset = V3::new(0.0, 1e-4, 0.0);
        self.bone(centre - offset, radius, centre + offset, radius, blend)
    }

    /// Makes the last bone `factor` times as thin along `normal`, about the middle of its axis.
    pub(super) fn flattened(mut self, normal: V3, factor: f64) -> Self {
        let bone = self.bones.last_mut().expect("a bone to flatten");
        let [(a, _), (b, _)] = bone.cone.balls();
        bone.flatten = Some(Flatten { centre: a.lerp(&b, 0.5), normal: normal.normalize(), factor });
        self.bounded()
    }

    /// Makes the last bone a hollow in place of a solid.
    pub(super) fn carved(mut self) -> Self {
        self.bones.last_mut().expect("a bone to carve with").role = Role::Carve;
        self.bounded()
    }

    /// Adds a layer of skin.
    pub(super) fn skin(mut self, skin: Skin) -> Self {
        self.skin.push(skin);
        self
    }

    fn bounded(mut self) -> Self {
        let solid = || self.bones.iter().filter(|b| b.role == Role::Add);
        let balls: Vec<_> = solid().flat_map(|b| b.cone.balls()).collect();
        self.centre = balls.iter().map(|b| b.0).sum::<V3>() / balls.len().max(1) as f64;
        // A fillet of width k bulges by at most k/4.
        let bulge: f64 = solid().map(|b| 0.25 * b.blend).sum();
        self.radius = balls.iter().map(|b| (b.0 - self.centre).norm() + b.1).fold(0.0, f64::max) + bulge;
        self.stretch = solid().filter_map(|b| b.flatten.as_ref()).map(|f| f.factor).fold(1.0, f64::max);
        self
    }

    /// Balls that hold the part together.
    pub(super) fn balls(&self) -> impl Iterator<Item = (V3, f64)> + '_ {
        let solid = self.bones.iter().filter(|b| b.role == Role::Add);
        let bulge = 0.25 * self.blend;
        solid.flat_map(move |b| b.cone.balls().map(move |(c, r)| (c, r + bulge)))
    }

    /// Whether [`distance`](Self::distance) is certainly more than `limit` at `p`.
    pub(super) fn farther_than(&self, p: V3, limit: f64) -> bool {
        let reach = self.radius + (limit * self.stretch).max(0.0);
        (p - self.centre).norm_squared() > reach * reach
    }

    /// Signed distance (an underestimate where flattened) to the part without skin.
    pub(super) fn distance(&self, p: V3) -> f64 {
        let mut total = f64::INFINITY;
        for bone in &self.bones {
            let distance = bone.distance(p);
            total = match bone.role {
                Role::Carve => smooth_carve(total, distance, bone.blend),
                Role::Add if total.is_finite() => smooth_union(total, distance, bone.blend),
                Role::Add => distance,
            };
        }
        total
    }

    /// Height of the skin at `p`, positive outwards, model units.
    pub(super) fn skin_height(&self, p: V3) -> f64 {
        if self.skin.is_empty() {
            return 0.0;
        }
        let solid = self.bones.iter().filter(|b| b.role == Role::Add);
        let (_, bone) = solid
            .map(|b| (b.distance(p), b))
            .reduce(|near, other| if other.0 < near.0 { other } else { near })
            .expect("a part has a bone");
        let along = bone.arc + bone.cone.fraction(p) * bone.cone.length();
        let place = Place { at: p, along };
        self.skin.iter().map(|skin| skin.height(&place)).sum()
    }
}
