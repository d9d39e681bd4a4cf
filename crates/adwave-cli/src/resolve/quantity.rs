//! Quantities that a signal holds: numbers, directions in tangent planes, or symmetric tensors. Each is split into scalars
//! and directions, which are filtered, and put together again.

use super::signal::Signal;
use crate::args::QuantityArgs;
use crate::error::CliError;
use crate::global::Global;
use crate::output::{count, note, number};
use adwave::directions::{Directions, Symmetry, TensorOrder, exp_tensors, log_tensors};
use adwave::mask::missing;
use adwave::{Decomposer, Progress};
use adwave_io::SignalValues;
use serde_json::{Value, json};
use std::borrow::Cow;
use std::fmt::Write;

/// Share of the squares outside the tangent planes that is worth a note.
const NOTED_SHARE: f64 = 1e-6;

/// A signal whose bands are taken on a domain of its own.
pub(crate) struct CarriedSignal<'a> {
    pub(crate) decomposer: Decomposer,
    pub(crate) signal: Cow<'a, Signal>,
}

/// The signals that are filtered, and the way back to the quantity that was given.
pub(crate) struct Carried<'a> {
    /// One signal, or the traces and the lines of tensors on a surface.
    pub(crate) signals: Vec<CarriedSignal<'a>>,
    back: WayBack,
}

enum WayBack {
    /// The values are those of the signal.
    Values,
    Directions {
        directions: Directions,
        normal_share: f64,
    },
    /// Logarithms of tensors in a volume, with the tensors that were given.
    Logarithms {
        order: TensorOrder,
        given: Vec<f64>,
        n_not_positive: usize,
    },
    SurfaceTensors {
        order: TensorOrder,
        directions: Directions,
        normal_share: f64,
    },
}

/// Facts about an edit of directions or tensors.
pub(crate) enum QuantityReport {
    Directions {
        symmetry: Symmetry,
        normal_share: f64,
        /// Numbers of singularities before and after, and the sum of their indices; `None` if they cannot be counted.
        singularities: Option<(usize, usize, f64)>,
    },
    Tensors {
        order: TensorOrder,
        n_not_positive: usize,
        normal_share: f64,
    },
}

impl<'a> Carried<'a> {
    /// The signals of a quantity on a domain, with notes on what takes no part.
    pub(crate) fn new(
        args: QuantityArgs,
        decomposer: &Decomposer,
        signal: &'a Signal,
        name: &str,
        global: &Global<'_>,
        progress: Progress<'_>,
    ) -> Result<Self, CliError> {
        let carry = |decomposer: &Decomposer, n_channels: usize, values: Vec<f64>| CarriedSignal {
            decomposer: decomposer.clone(),
            signal: Cow::Owned(Signal::new(n_channels, SignalValues::Other(values))),
        };
        let outside = |share: f64, what: &str| {
            if share > NOTED_SHARE {
                let percent = number(100.0 * share);
                note(global, &format!("{percent} % of the squares of {name} {what} and are left out"));
            }
        };
        if let Some(symmetry) = args.directions {
            check_channels(signal, name, 3, "--directions takes vectors of three components")?;
            let directions = Directions::new(decomposer, symmetry, progress)?;
            let split = directions.split(&signal.values)?;
            outside(split.normal_share, "lie along the normals");
            return Ok(Self {
                signals: vec![carry(directions.decomposer(), 2, split.channels)],
                back: WayBack::Directions { directions, normal_share: split.normal_share },
            });
        }
        let Some(order) = args.tensors else {
            let signals =
                vec![CarriedSignal { decomposer: decomposer.clone(), signal: Cow::Borrowed(signal) }];
            return Ok(Self { signals, back: WayBack::Values });
        };
        check_channels(signal, name, 6, "--tensors takes symmetric tensors of six components")?;
        let tensors = order.to_upper(&signal.values);
        if decomposer.geometry().is_some() {
            let directions = Directions::new(decomposer, Symmetry::Lines, progress)?;
            let split = directions.split_tensors(&tensors)?;
            outside(split.normal_share, "do not lie in the tangent planes");
            return Ok(Self {
                signals: vec![
                    carry(decomposer, 1, split.trace),
                    carry(directions.decomposer(), 2, split.channels),
                ],
                back: WayBack::SurfaceTensors { order, directions, normal_share: split.normal_share },
            });
        }
        let found = log_tensors(&tensors, progress)?;
        if found.n_not_positive > 0 {
            let voxels = count(found.n_not_positive, "tensor", "tensors");
            note(
                global,
                &format!(
                    "{name}: {voxels} of {} are not positive definite; they take no part and stay as they are (--tensors {} says the \
                     order of their components)",
                    tensors.len() / 6,
                    order.name()
                ),
            );
        }
        if found.logarithms.iter().all(|value| value.is_nan()) {
            return Err(CliError::Input(format!(
                "{name}: no tensor is positive definite in the order {}; choose the order of its components by --tensors",
                order.name()
            )));
        }
        // Masked here, since the note above has said so.
        let masked = match missing(&found.logarithms, 6) {
            Some(flags) => decomposer.masked(&flags).map_err(|e| CliError::Input(format!("{name}: {e}")))?,
            None => decomposer.clone(),
        };
        Ok(Self {
            signals: vec![carry(&masked, 6, found.logarithms)],
            back: WayBack::Logarithms { order, given: tensors, n_not_positive: found.n_not_positive },
        })
    }

    /// The values of the quantity from those of its signals after an edit, and what is to be reported.
    pub(crate) fn join(
        &self,
        mut edited: Vec<Vec<f64>>,
        progress: Progress<'_>,
    ) -> Result<(Vec<f64>, Option<QuantityReport>), CliError> {
        let first = edited.swap_remove(0);
        Ok(match &self.back {
            WayBack::Values => (first, None),
            WayBack::Directions { directions, normal_share } => {
                let before = &self.signals[0].signal.values;
                let found = directions.singularities_of(&[before, &first], progress).ok();
                let singularities = found.map(|found| {
                    let [before, after] = [&found[0], &found[1]];
                    (before.len(), after.len(), after.iter().map(|singularity| singularity.index).sum())
                });
                let symmetry = directions.symmetry();
                let report =
                    QuantityReport::Directions { symmetry, normal_share: *normal_share, singularities };
                (directions.join(&first)?, Some(report))
            }
            WayBack::Logarithms { order, given, n_not_positive } => {
                let mut tensors = exp_tensors(&first, progress)?;
                if tensors.iter().any(|value| value.is_infinite()) {
                    return Err(CliError::Input(
                        "the gains make the logarithm of a tensor too large for a number; choose smaller gains"
                            .to_owned(),
                    ));
                }
                for (new, old) in tensors.iter_mut().zip(given) {
                    if new.is_nan() {
                        *new = *old;
                    }
                }
                let report = QuantityReport::Tensors {
                    order: *order,
                    n_not_positive: *n_not_positive,
                    normal_share: 0.0,
                };
                (order.reorder_upper(&tensors), Some(report))
            }
            WayBack::SurfaceTensors { order, directions, normal_share } => {
                let lines = edited.swap_remove(0);
                let tensors = directions.join_tensors(&first, &lines)?;
                let report =
                    QuantityReport::Tensors { order: *order, n_not_positive: 0, normal_share: *normal_share };
                (order.reorder_upper(&tensors), Some(report))
            }
        })
    }
}

impl Carried<'_> {
    /// Values of a band of the quantity from those of its signals: vectors and tensors in space, of tensors in a volume
    /// logarithms. Those of vectors and tensors add up to the quantity, those of lines and crosses do not.
    pub(crate) fn join_band(&self, bands: &[&[f64]]) -> Result<Vec<f64>, CliError> {
        Ok(match &self.back {
            WayBack::Values => bands[0].to_vec(),
            WayBack::Directions { directions, .. } => directions.join(bands[0])?,
            WayBack::Logarithms { order, .. } => order.reorder_upper(bands[0]),
            WayBack::SurfaceTensors { order, directions, .. } => {
                order.reorder_upper(&directions.join_tensors(bands[0], bands[1])?)
            }
        })
    }
}

fn check_channels(signal: &Signal, name: &str, expected: usize, what: &str) -> Result<(), CliError> {
    if signal.n_channels == expected {
        return Ok(());
    }
    Err(CliError::Input(format!(
        "{what}, and {name} has {} at each place",
        count(signal.n_channels, "number", "numbers")
    )))
}

impl QuantityReport {
    /// Adds a line for people.
    pub(crate) fn describe(&self, text: &mut String) {
        match self {
            Self::Directions { symmetry, singularities, .. } => {
                let _ = write!(text, "{} in the tangent planes", symmetry.name());
                if let Some((before, after, sum)) = singularities {
                    let after = count(*after, "singularity", "singularities");
                    let _ =
                        write!(text, ", {after} ({before} before), whose indices sum to {}", number(*sum));
                }
                text.push('\n');
            }
            Self::Tensors { order, n_not_positive, .. } => {
                let _ = writeln!(
                    text,
                    "tensors in the order {}, {n_not_positive} left as they are",
                    order.name()
                );
            }
        }
    }

    /// Adds the facts for machines.
    pub(crate) fn add_to(&self, report: &mut Value) {
        match self {
            Self::Directions { symmetry, normal_share, singularities } => {
                let mut own = json!({"kind": symmetry.name(), "normal_share": normal_share});
                if let Some((before, after, sum)) = singularities {
                    own["singularities"] = json!({"before": before, "after": after, "index_sum": sum});
                }
                report["directions"] = own;
            }
            Self::Tensors { order, n_not_positive, normal_share } => {
                report["tensors"] = json!({
                    "order": order.name(), "not_positive": n_not_positive, "normal_share": normal_share,
                });
            }
        }
    }
}
