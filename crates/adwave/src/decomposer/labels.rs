//! Filters of labels: by the filtered share of each label.

use super::BandsRequest;
use crate::filter::{FilterError, WeightedLayer};
use crate::local_fit::LocalFit;
use crate::parallel;

/// Number of labels that are filtered together, as the channels of one signal.
const LABELS_AT_A_TIME: usize = 4;

/// Difference of two shares that counts as rounding.
const TIE: f64 = 1e-9;

/// Number of vertices that a thread processes at a time.
const VERTICES_AT_A_TIME: usize = 1 << 12;

/// Shares of a vertex: that of its own label, and the largest one of the others with the index of its label.
#[derive(Clone, Copy)]
struct Shares {
    own: f64,
    largest: f64,
    label: u32,
}

impl BandsRequest<'_> {
    /// Filters a signal of labels, one per vertex; NaN at masked vertices, which stay. `labels` are all labels that
    /// occur, in ascending order. O(labels × products), with memory for four labels at a time.
    ///
    /// The share of a label is 1 where a vertex has it and 0 elsewhere. Each share is filtered (eq. 18), and a vertex
    /// gets the label with the largest one: with a smoothing, the label of most of its surroundings. On a tie it keeps
    /// its own label, or else takes the smallest. Shares are about the local mean: a label has no slope.
    ///
    /// ```
    /// use adwave::bands::Schedule;
    /// use adwave::filter::WeightedLayer;
    /// use adwave::shape::{Graph, Shape};
    /// use adwave::Decomposer;
    /// let path: Vec<_> = (0..8).map(|i| (i, i + 1, 1.0)).collect();
    /// let decomposer = Decomposer::new(&Shape::Graph(Graph::new(9, &path)?));
    /// let classes = [2.0, 2.0, 6.0, 2.0, 2.0, 6.0, 6.0, 6.0, 6.0]; // the first 6 is alone
    /// let (schedule, drop) = (Schedule::dyadic(2)?, WeightedLayer::everywhere(vec![0.0, 0.0]));
    /// let smooth = decomposer.request(&classes, 1, &schedule).filter_labels(&[2.0, 6.0], &[drop])?;
    /// assert_eq!(smooth, [2.0, 2.0, 2.0, 2.0, 2.0, 6.0, 6.0, 6.0, 6.0]);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// As for [`filter_layers`](Self::filter_layers).
    pub fn filter_labels(&self, labels: &[f64], layers: &[WeightedLayer]) -> Result<Vec<f64>, FilterError> {
        let values = self.signal();
        let none = Shares { own: 0.0, largest: f64::NEG_INFINITY, label: u32::MAX };
        let mut shares = vec![none; values.len()];
        for (block, together) in labels.chunks(LABELS_AT_A_TIME).enumerate() {
            let d = together.len();
            let mut indicators = crate::pages::zeros(values.len() * d);
            parallel::visit_rows(&mut indicators, d, VERTICES_AT_A_TIME, |first, rows| {
                for (v, row) in values[first..].iter().zip(rows.chunks_exact_mut(d)) {
                    for (share, label) in row.iter_mut().zip(together) {
                        *share = if v.is_nan() { f64::NAN } else { f64::from(u8::from(v == label)) };
                    }
                }
            });
            let filtered =
                self.with_signal(&indicators, d).local_fit(LocalFit::Constant).filter_layers(layers)?;
            parallel::visit_rows(&mut shares, 1, VERTICES_AT_A_TIME, |first, rows| {
                for (x, shares) in (first..).zip(rows) {
                    for (k, share) in filtered[x * d..][..d].iter().enumerate() {
                        if values[x] == together[k] {
                            shares.own = *share;
                        } else if *share > shares.largest + TIE {
                            shares.largest = *share;
                            shares.label = (block * LABELS_AT_A_TIME + k) as u32;
                        }
                    }
                }
            });
        }
        Ok(parallel::collect(values.len(), |x| {
            let Shares { own, largest, label } = shares[x];
            if largest > own + TIE { labels[label as usize] } else { values[x] }
        }))
    }
}
