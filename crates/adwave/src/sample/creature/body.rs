//! Anatomy of the creature: bones, radii and skin, all in model units.

use super::super::implicit::V3;
use super::part::BodyPart;
use super::skin::Skin;
use nalgebra::Rotation3;

/// Half of the body; the creature's left is +x.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum BodySide {
    Left,
    Right,
}

impl BodySide {
    const BOTH: [Self; 2] = [Self::Left, Self::Right];

    fn sign(self) -> f64 {
        match self {
            Self::Left => 1.0,
            Self::Right => -1.0,
        }
    }

    /// The point on this half that corresponds to the given point on the left half.
    fn point(self, x: f64, y: f64, z: f64) -> V3 {
        V3::new(self.sign() * x, y, z)
    }
}

fn point(x: f64, y: f64, z: f64) -> V3 {
    V3::new(x, y, z)
}

/// All parts; the first is the torso, which most others join.
pub(super) fn parts() -> Vec<BodyPart> {
    let mut parts = vec![torso(), shell(), tail(), head(), nose()];
    for side in BodySide::BOTH {
        parts.extend([eye(side), ear(side), leg(side), knee(side), foot(side), arm(side)]);
        parts.extend(hand(side));
    }
    parts
}

fn torso() -> BodyPart {
    let (half_width, front) = (0.165, 0.08);
    BodyPart::new(0.0)
        .bone(point(0.0, 1.00, 0.0), 0.225, point(0.0, 1.19, -0.01), 0.19, 0.1)
        .ball(point(0.0, 0.88, 0.065), 0.24, 0.1)
        .ball(point(0.0, 0.73, 0.0), 0.2, 0.1)
        .ball(point(0.085, 1.14, 0.105), 0.1, 0.04)
        .ball(point(-0.085, 1.14, 0.105), 0.1, 0.04)
        .skin(Skin::BellyPlates { size: 0.078, height: 0.007, half_width, front })
        .skin(Skin::Flanks { size: 0.06, height: 0.0045, half_width, front })
}

fn shell() -> BodyPart {
    BodyPart::new(0.02)
        .bone(point(0.0, 0.85, -0.10), 0.28, point(0.0, 1.10, -0.095), 0.25, 0.02)
        .ball(point(0.0, 0.98, 0.50), 0.515, 0.03)
        .carve()
        .skin(Skin::Scales {
            center: point(0.0, 0.97, -0.10),
            radius: 0.275,
            half_height: 0.41,
            n_rows: 13.0,
            n_columns: 18.0,
            height: 0.014,
        })
}

fn tail() -> BodyPart {
    let joints = [
        (point(0.0, 0.66, -0.16), 0.135),
        (point(0.02, 0.45, -0.40), 0.1),
        (point(0.08, 0.27, -0.57), 0.08),
        (point(0.20, 0.16, -0.70), 0.063),
        (point(0.36, 0.15, -0.74), 0.05),
        (point(0.49, 0.22, -0.70), 0.037),
        (point(0.55, 0.33, -0.66), 0.022),
    ];
    BodyPart::new(0.05).chain(&curve(&joints, 4), 0.03).skin(Skin::Rings {
        size: 0.065,
        height: 0.007,
        from: 0.12,
        to: 1.3,
    })
}

/// Balls along the Catmull–Rom curve through `joints`, with `n_pieces` per segment and linear radii.
fn curve(joints: &[(V3, f64)], n_pieces: usize) -> Vec<(V3, f64)> {
    let last = joints.len() - 1;
    let mut balls = Vec::with_capacity(last * n_pieces + 1);
    for i in 0..last {
        let [p0, p1, p2, p3] = [i.max(1) - 1, i, i + 1, (i + 2).min(last)].map(|j| joints[j].0);
        for k in 0..n_pieces {
            let t = k as f64 / n_pieces as f64;
            let slope = (p2 - p0)
                + (p0 * 2.0 - p1 * 5.0 + p2 * 4.0 - p3) * t
                + (p1 * 3.0 - p0 - p2 * 3.0 + p3) * (t * t);
            balls.push((p1 + slope * (0.5 * t), joints[i].1 + t * (joints[i + 1].1 - joints[i].1)));
        }
    }
    balls.push(joints[last]);
    balls
}

/// Scale of the head; its lengths are given for a head of half the size of the chest.
const HEAD: f64 = 1.13;

/// Converts coordinates of the head (origin in the skull, y up, z along the snout) to model coordinates.
fn head_at(x: f64, y: f64, z: f64) -> V3 {
    point(0.0, 1.53, 0.07) + Rotation3::from_euler_angles(0.10, 0.22, -0.06) * point(x, y, z) * HEAD
}

fn head() -> BodyPart {
    let mut head = BodyPart::new(0.05)
        .bone(head_at(0.0, 0.02, -0.02), 0.15 * HEAD, head_at(0.0, -0.02, 0.08), 0.12 * HEAD, 0.06)
        .bone(point(0.0, 1.20, -0.02), 0.16, head_at(0.0, -0.06, -0.02), 0.115 * HEAD, 0.06)
        .bone(head_at(0.0, -0.025, 0.12), 0.092 * HEAD, head_at(0.0, -0.06, 0.34), 0.056 * HEAD, 0.06);
    for x in [0.085, -0.085] {
        head = head.ball(head_at(x, -0.07, 0.07), 0.06 * HEAD, 0.05).bone(
            head_at(0.35 * x, 0.080, 0.138),
            0.022 * HEAD,
            head_at(1.35 * x, 0.085, 0.085),
            0.030 * HEAD,
            0.03,
        );
    }
    // The lower jaw is slightly open, with a sharp crease below the snout.
    head = head.bone(head_at(0.0, -0.11, 0.06), 0.07 * HEAD, head_at(0.0, -0.165, 0.26), 0.034 * HEAD, 0.01);
    for x in [0.085, -0.085] {
        head = head.ball(head_at(1.02 * x, 0.028, 0.148), 0.043 * HEAD, 0.02).carve();
    }
    head.skin(Skin::Pebbles { size: 0.058, height: 0.0035 })
}

/// Nose and eyes: smooth parts on the head.
fn nose() -> BodyPart {
    let mut nose = BodyPart::new(0.015).ball(head_at(0.0, -0.035, 0.385), 0.044 * HEAD, 0.02);
    for x in [0.019, -0.019] {
        nose = nose.ball(head_at(x, -0.030, 0.428), 0.0135 * HEAD, 0.008).carve();
    }
    nose
}

fn eye(side: BodySide) -> BodyPart {
    let s = side.sign();
    let ball = head_at(s * 0.078, 0.034, 0.120);
    let direction = |x: f64, y: f64, z: f64| (head_at(s * x, y, z) - head_at(0.0, 0.0, 0.0)).normalize();
    // A ball this large cuts like a plane.
    let flat = 0.5;
    // The lid is a cap just outside the eyeball, open downwards and forwards; the pupil is a dimple.
    BodyPart::new(0.006)
        .ball(ball, 0.0475 * HEAD, 0.003)
        .ball(ball + direction(0.05, -0.75, 0.65) * (flat - 0.004), flat, 0.003)
        .carve()
        .ball(ball, 0.041 * HEAD, 0.003)
        .ball(ball + direction(0.42, -0.12, 0.9) * (0.047 * HEAD), 0.0145 * HEAD, 0.006)
        .carve()
}

fn ear(side: BodySide) -> BodyPart {
    let s = side.sign();
    let outward = (head_at(s * 0.40, 0.0, 1.0) - head_at(0.0, 0.0, 0.0)).normalize();
    let ear_at = |t: f64, forward: f64| {
        let base = head_at(s * 0.085, 0.10, -0.03);
        let tip = head_at(s * 0.28, 0.37, -0.07);
        base.lerp(&tip, t) + outward * forward
    };
    BodyPart::new(0.03)
        .bone(ear_at(0.0, 0.0), 0.055, ear_at(0.48, 0.0), 0.11, 0.02)
        .flatten_along(outward, 2.3)
        .bone(ear_at(0.48, 0.0), 0.11, ear_at(1.05, 0.0), 0.026, 0.02)
        .flatten_along(outward, 2.3)
        .bone(ear_at(0.20, 0.054), 0.045, ear_at(0.48, 0.054), 0.080, 0.015)
        .flatten_along(outward, 1.8)
        .carve()
        .bone(ear_at(0.48, 0.054), 0.080, ear_at(0.85, 0.050), 0.035, 0.015)
        .flatten_along(outward, 1.8)
        .carve()
        // A fold along the inside.
        .bone(ear_at(0.15, 0.022), 0.022, ear_at(0.62, 0.008), 0.012, 0.02)
}

fn leg(side: BodySide) -> BodyPart {
    let knee = side.point(0.27, 0.40, 0.12);
    BodyPart::new(0.05)
        .bone(side.point(0.15, 0.66, 0.01), 0.165, knee, 0.10, 0.05)
        .bone(knee, 0.095, side.point(0.25, 0.13, -0.01), 0.07, 0.04)
        // The calf.
        .ball(side.point(0.265, 0.27, 0.01), 0.085, 0.05)
        .skin(Skin::Pebbles { size: 0.068, height: 0.006 })
        .skin(Skin::Rings { size: 0.06, height: 0.004, from: 0.47, to: 0.65 })
}

/// A smooth cap on the knee.
fn knee(side: BodySide) -> BodyPart {
    BodyPart::new(0.015)
        .ball(side.point(0.285, 0.415, 0.185), 0.058, 0.02)
        .flatten_along(side.point(0.15, 0.05, 1.0), 1.25)
}

fn foot(side: BodySide) -> BodyPart {
    let ankle = side.point(0.25, 0.11, -0.01);
    let mut foot = BodyPart::new(0.04).bone(ankle, 0.07, side.point(0.255, 0.055, -0.05), 0.07, 0.03).bone(
        side.point(0.255, 0.06, -0.02),
        0.07,
        side.point(0.29, 0.05, 0.14),
        0.07,
        0.03,
    );
    for (angle, length) in [(-0.32_f64, 0.10), (0.12, 0.125), (0.60, 0.10)] {
        let direction = side.point(angle.sin(), 0.0, angle.cos());
        let root = side.point(0.285, 0.045, 0.14) + side.point(0.11 * angle.sin(), 0.0, 0.03);
        let tip = root + direction * length;
        foot = foot.bone(root, 0.042, tip, 0.036, 0.015).bone(
            tip + point(0.0, 0.008, 0.0) + direction * 0.025,
            0.02,
            tip + direction * 0.08 - point(0.0, 0.02, 0.0),
            0.009,
            0.006,
        );
    }
    foot.skin(Skin::Pebbles { size: 0.055, height: 0.003 })
}

/// Shoulder, elbow and wrist: the left arm waves, the right one reaches out.
fn arm_joints(side: BodySide) -> [V3; 3] {
    match side {
        BodySide::Left => [point(0.21, 1.21, -0.01), point(0.47, 1.17, 0.0), point(0.60, 1.42, 0.09)],
        BodySide::Right => [point(-0.21, 1.21, -0.01), point(-0.45, 1.08, 0.06), point(-0.60, 1.24, 0.25)],
    }
}

fn arm(side: BodySide) -> BodyPart {
    let [shoulder, elbow, wrist] = arm_joints(side);
    let upper = elbow - shoulder;
    let back = (elbow - shoulder.lerp(&wrist, 0.5)).normalize();
    BodyPart::new(0.05)
        .bone(shoulder, 0.115, elbow, 0.075, 0.04)
        .bone(elbow, 0.078, wrist, 0.054, 0.03)
        // Upper arm muscle, forearm muscle, elbow.
        .ball(shoulder + upper * 0.5 + point(0.0, 0.02, 0.03), 0.08, 0.05)
        .ball(elbow.lerp(&wrist, 0.3), 0.082, 0.05)
        .ball(elbow + back * 0.055, 0.038, 0.03)
        .skin(Skin::Pebbles { size: 0.062, height: 0.0055 })
        .skin(Skin::Rings { size: 0.06, height: 0.004, from: 0.40, to: 0.62 })
}

/// The hand, and its claws as a part without skin.
fn hand(side: BodySide) -> [BodyPart; 2] {
    let [_, elbow, wrist] = arm_joints(side);
    let along = (wrist - elbow).normalize();
    // The palm looks forward, the thumb points up and inward.
    let palm = (point(0.0, -0.1, 1.0) - along * along.dot(&point(0.0, -0.1, 1.0))).normalize();
    let across = palm.cross(&along) * side.sign();
    let hand_at = |a: f64, c: f64, f: f64| wrist + along * a + across * c + palm * f;
    let mut claws = BodyPart::new(0.006);
    let mut hand = BodyPart::new(0.03)
        .bone(hand_at(0.0, 0.0, 0.0), 0.055, hand_at(0.10, 0.0, 0.0), 0.075, 0.03)
        .flatten_along(palm, 1.45);
    let fingers = [(0.52_f64, 0.045, 0.11, 0.95), (0.08, 0.0, 0.125, 1.0), (-0.38, -0.048, 0.11, 0.92)];
    let thumb = (1.25, 0.045, 0.035, 0.85);
    for (angle, offset, start, size) in fingers.into_iter().chain([thumb]) {
        let direction = along * angle.cos() + across * angle.sin();
        let root = hand_at(start, offset, 0.005);
        let knuckle = root + direction * (0.085 * size);
        let bent = (direction + palm * 0.45).normalize();
        let tip = knuckle + bent * (0.065 * size);
        let claw = (direction + palm * 0.9).normalize();
        hand = hand.branch(start).bone(root, 0.032 * size, knuckle, 0.030 * size, 0.012).bone(
            knuckle,
            0.031 * size,
            tip,
            0.026 * size,
            0.01,
        );
        claws = claws.bone(tip + bent * 0.012, 0.018 * size, tip + claw * (0.068 * size), 0.0095, 0.006);
    }
    [hand.skin(Skin::Rings { size: 0.045, height: 0.0024, from: 0.15, to: 9.0 }), claws]
}
