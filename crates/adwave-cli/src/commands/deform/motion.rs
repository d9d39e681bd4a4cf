//! Motions as they are typed.

use crate::error::CliError;
use adwave_deform::HandleMotion;
use std::fs::File;
use std::io::Read;
use std::path::PathBuf;

/// Largest number of bytes of a file with a matrix that are read.
const LONGEST_MATRIX: u64 = 1 << 16;

/// A motion before the center of its handle is known.
#[derive(Clone, Debug)]
pub(crate) enum MotionText {
    /// Translation by a vector.
    By([f64; 3]),
    /// Translation of the center to a point.
    To([f64; 3]),
    /// Rotation about an axis by an angle in degrees, through a point or the center.
    Turn { axis: [f64; 3], angle: f64, center: Option<[f64; 3]> },
    /// The matrix in a file.
    Matrix(PathBuf),
}

fn numbers(text: &str) -> Result<Vec<f64>, String> {
    let read = |word: &str| match word.trim().parse::<f64>() {
        Ok(number) if number.is_finite() => Ok(number),
        _ => Err(format!("must be finite numbers separated by commas, got '{}'", word.trim())),
    };
    text.split(',').map(read).collect()
}

fn vector(text: &str) -> Result<[f64; 3], String> {
    let found = numbers(text)?;
    found.try_into().map_err(|found: Vec<f64>| format!("must be three numbers X,Y,Z, got {}", found.len()))
}

/// Reads `X,Y,Z` as a translation.
pub(crate) fn translation(text: &str) -> Result<MotionText, String> {
    vector(text).map(MotionText::By)
}

/// Reads `X,Y,Z` as a target.
pub(crate) fn target(text: &str) -> Result<MotionText, String> {
    vector(text).map(MotionText::To)
}

/// Reads `AXIS,ANGLE[,X,Y,Z]`, where the axis is a letter or three numbers.
pub(crate) fn turn(text: &str) -> Result<MotionText, String> {
    let axes = [("x", [1.0, 0.0, 0.0]), ("y", [0.0, 1.0, 0.0]), ("z", [0.0, 0.0, 1.0])];
    let letter = axes.iter().find_map(|(name, axis)| {
        text.trim().strip_prefix(name).and_then(|rest| rest.strip_prefix(',')).map(|rest| (*axis, rest))
    });
    let (axis, rest) = match letter {
        Some((axis, rest)) => (axis, numbers(rest)?),
        None => match numbers(text)?[..] {
            [x, y, z, ref rest @ ..] => ([x, y, z], rest.to_vec()),
            _ => return Err("must be AXIS,ANGLE or AXIS,ANGLE,X,Y,Z".to_owned()),
        },
    };
    match rest[..] {
        [angle] => Ok(MotionText::Turn { axis, angle, center: None }),
        [angle, x, y, z] => Ok(MotionText::Turn { axis, angle, center: Some([x, y, z]) }),
        _ => Err("must be AXIS,ANGLE or AXIS,ANGLE,X,Y,Z, with the axis x, y, z or three numbers".to_owned()),
    }
}

/// Takes the name of a file with a matrix.
#[expect(clippy::unnecessary_wraps, reason = "a value parser returns a result")]
pub(crate) fn matrix(text: &str) -> Result<MotionText, String> {
    Ok(MotionText::Matrix(PathBuf::from(text)))
}

impl MotionText {
    /// The motion of a handle with this center.
    pub(crate) fn resolve(&self, center: [f64; 3]) -> Result<HandleMotion, CliError> {
        Ok(match self {
            Self::By(by) => HandleMotion::from_translation(*by),
            Self::To(to) => HandleMotion::from_translation([0, 1, 2].map(|c| to[c] - center[c])),
            Self::Turn { axis, angle, center: through } => {
                HandleMotion::from_turn(*axis, angle.to_radians(), through.unwrap_or(center))?
            }
            Self::Matrix(path) => {
                let name = path.display();
                let mut text = String::new();
                File::open(path)
                    .and_then(|file| file.take(LONGEST_MATRIX).read_to_string(&mut text))
                    .map_err(|e| CliError::Input(format!("{name}: cannot be read: {e}")))?;
                let words = text.lines().filter(|line| !line.trim_start().starts_with('#'));
                let words: Vec<&str> = words.flat_map(str::split_whitespace).collect();
                let found: Vec<f64> = words.iter().filter_map(|word| word.parse().ok()).collect();
                if found.len() != words.len() || found.len() != 16 {
                    return Err(CliError::Input(format!(
                        "{name}: a matrix must have 16 numbers, four by four, and no other words, got {} numbers in {} words",
                        found.len(),
                        words.len()
                    )));
                }
                let matrix = [0, 1, 2, 3].map(|i| [0, 1, 2, 3].map(|j| found[4 * i + j]));
                HandleMotion::from_matrix(&matrix)?
            }
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn motions_are_read_in_any_of_their_forms() {
        let moved = |motion: Result<MotionText, String>| {
            let center = [1.0, 0.0, 0.0];
            motion.unwrap().resolve(center).unwrap().apply(&[2.0, 0.0, 0.0]).map(|c| (1e9 * c).round() / 1e9)
        };
        assert_eq!(moved(translation("0,-1,0.5")), [2.0, -1.0, 0.5]);
        assert_eq!(moved(target("0,0,3")), [1.0, 0.0, 3.0]);
        assert_eq!(moved(turn("z,90")), [1.0, 1.0, 0.0]);
        assert_eq!(moved(turn("0,0,2,90,0,0,0")), [0.0, 2.0, 0.0]);
        for wrong in ["z", "z,1,2", "1,2", "w,90", "z,nan", ""] {
            assert!(turn(wrong).is_err(), "{wrong}");
        }
        assert_eq!(translation("1,2").unwrap_err(), "must be three numbers X,Y,Z, got 2");
    }
}
