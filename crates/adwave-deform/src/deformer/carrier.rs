//! Motion of vertices by the blended motions of the columns.

use super::{ColumnMotion, Deformer};
use crate::HandleMotion;
use crate::coarse_base::BlendRow;
use crate::lengths::KeptLengths;
use crate::rotation::{NO_TURN, compose, image, normalized, turn_change};
use adwave::vector::{Vector, add_scaled, subtract};

/// Motions of all columns, ready to move vertices.
pub(super) struct Carrier<'a> {
    deformer: &'a Deformer,
    welded: &'a [u32],
    motions: Vec<ColumnMotion>,
    has_stretch: bool,
    /// Motion of each region that differs from the common one.
    exact: Vec<Option<HandleMotion>>,
    /// The common motion in model units; `None` if it moves nothing.
    common: Option<HandleMotion>,
    common_turn: Option<[f64; 4]>,
}

impl<'a> Carrier<'a> {
    pub(super) fn new(deformer: &'a Deformer) -> Self {
        let motions = deformer.column_motions();
        let common = deformer.common_motion();
        Self {
            deformer,
            welded: deformer.decomposer.vertex_map().as_slice(),
            has_stretch: motions.iter().any(|motion| motion.stretch.is_some()),
            motions,
            exact: deformer.exact_regions(),
            common: deformer.common_in_model_units(),
            common_turn: (common != HandleMotion::default()).then(|| common.rotation()),
        }
    }

    /// New place of vertex `v`, which is at `p` before.
    pub(super) fn point(&self, v: usize, p: &Vector) -> Vector {
        let Deformer { base, bound, is_at_rest, .. } = self.deformer;
        let x = self.welded[v] as usize;
        let mut point = *p;
        if let Some(kept) = self.length_positions(x) {
            let detail = subtract(p, &self.deformer.decomposer.positions()[x]);
            let change = turn_change(&kept.turns[x], &detail);
            return [0, 1, 2].map(|c| kept.points[x][c] + (detail[c] + change[c]));
        }
        if *is_at_rest || !base.takes_part[x] {
            if let (Some(exact), false) = (self.deformer.exact_motion(x), *is_at_rest) {
                return exact.apply(p);
            }
        } else if let Some(Some(exact)) = self.exact.get(bound.region_of[x] as usize) {
            return exact.apply(p);
        } else {
            let (row, place) = (bound.rows.row(x), &base.points[x]);
            let (shift, turn) = blend(&self.motions, row, place);
            let detail = [0, 1, 2].map(|c| p[c] - base.unit * place[c]);
            let mut change = turn_change(&turn, &detail);
            if self.has_stretch {
                add_stretch(&self.motions, row, &detail, &mut change);
            }
            point = [0, 1, 2].map(|c| p[c] + (base.unit * shift[c] + change[c]));
        }
        self.common.as_ref().map_or(point, |common| common.apply(&point))
    }

    /// Positions that keep lengths, if welded vertex `x` has one.
    fn length_positions(&self, x: usize) -> Option<&'a KeptLengths> {
        self.deformer.kept.as_ref().filter(|_| self.deformer.moves_freely(x))
    }

    /// Rotation of the frame of vertex `v`.
    pub(super) fn turn(&self, v: usize) -> [f64; 4] {
        let Deformer { base, bound, .. } = self.deformer;
        let x = self.welded[v] as usize;
        if let Some(kept) = self.length_positions(x) {
            return kept.turns[x];
        }
        let (_, turn) = blend(&self.motions, bound.rows.row(x), &base.points[x]);
        self.common_turn.map_or(turn, |common| normalized(&compose(&common, &turn)))
    }
}

/// Adds the change of a detail by handles whose motion is not rigid.
fn add_stretch(motions: &[ColumnMotion], row: BlendRow<'_>, detail: &Vector, change: &mut Vector) {
    for (&k, &w) in row.columns.iter().zip(row.weights) {
        if let Some(stretch) = &motions[k as usize].stretch {
            *change = add_scaled(change, w, &image(stretch, detail));
        }
    }
}

/// Displacement at a place of the base and rotation of its frame: the columns' blended by the weights of the row.
#[inline]
pub(super) fn blend(motions: &[ColumnMotion], row: BlendRow<'_>, place: &Vector) -> (Vector, [f64; 4]) {
    let BlendRow { columns, weights } = row;
    let mut linear = [[0.0; 3]; 3];
    let (mut offset, mut turn) = ([0.0; 3], [0.0; 4]);
    let reference = columns.first().map_or(NO_TURN, |&k| motions[k as usize].turn);
    for (&k, &w) in columns.iter().zip(weights) {
        let motion = &motions[k as usize];
        for (sum, row) in linear.iter_mut().zip(&motion.linear) {
            for c in 0..3 {
                sum[c] += w * row[c];
            }
        }
        for (sum, c) in offset.iter_mut().zip(&motion.offset) {
            *sum += w * c;
        }
        let q = &motion.turn;
        let cosine = q[0] * reference[0] + q[1] * reference[1] + q[2] * reference[2] + q[3] * reference[3];
        let signed = if cosine < 0.0 { -w } else { w };
        for (sum, c) in turn.iter_mut().zip(q) {
            *sum += signed * c;
        }
    }
    let moved = image(&linear, place);
    ([0, 1, 2].map(|c| moved[c] + offset[c]), normalized(&turn))
}
