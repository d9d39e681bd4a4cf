//! `[U][C][N][Z][4][u][v][n]MESH`: a grid of points whose neighbors form quadrilaterals.

use adwave::Progress;

use crate::formats::geomview::read::Scene;
use crate::progress::at_row;
use crate::text::tokens::Tokens;
use crate::{ReadError, ReadLimits};

/// Options given by the letters before `MESH`.
#[derive(Clone, Copy)]
#[allow(clippy::struct_excessive_bools)] // one for each letter
pub(crate) struct Letters {
    has_texture: bool,
    has_color: bool,
    has_normal: bool,
    is_height: bool,
    has_w: bool,
    wraps_u: bool,
    wraps_v: bool,
}

/// Parses the letters of a word that ends in `MESH`.
pub(crate) fn letters(word: &[u8]) -> Option<Letters> {
    let own = word.strip_suffix(b"MESH")?;
    let has = |letter: u8| own.contains(&letter);
    own.iter().all(|b| b"UCNZ4uv".contains(b)).then(|| Letters {
        has_texture: has(b'U'),
        has_color: has(b'C'),
        has_normal: has(b'N'),
        is_height: has(b'Z'),
        has_w: has(b'4'),
        wraps_u: has(b'u'),
        wraps_v: has(b'v'),
    })
}

/// Reads the content after the keyword.
pub(crate) fn read_grid(
    tokens: &mut Tokens<'_>,
    letters: Letters,
    scene: &mut Scene,
    limits: &ReadLimits,
    progress: Progress<'_>,
) -> Result<(), ReadError> {
    let n_u = tokens.count("the size of the grid", 0)?;
    let n_v = tokens.count("the size of the grid", 0)?;
    let n = n_u.saturating_mul(n_v);
    limits.check_points(n.saturating_add(scene.points.len() as u64))?;
    let n_numbers = match (letters.is_height, letters.has_w) {
        (true, _) => 1,
        (false, false) => 3,
        (false, true) => 4,
    };
    tokens.check(n, 2 * n_numbers, "vertex")?;
    let first = scene.points.len() as u32;
    for row in 0..n {
        at_row(progress, row, n)?;
        let mut numbers = [0.0, 0.0, 0.0, 1.0];
        if letters.is_height {
            numbers = [(row % n_u) as f64, (row / n_u) as f64, tokens.number("vertex", row)?, 1.0];
        } else {
            for x in &mut numbers[..n_numbers as usize] {
                *x = tokens.number("vertex", row)?;
            }
        }
        let mut part = |is_there: bool, n: usize| -> Result<Option<[f64; 4]>, ReadError> {
            let mut values = [f64::NAN; 4];
            for x in &mut values[..if is_there { n } else { 0 }] {
                *x = tokens.number("vertex", row)?;
            }
            Ok(is_there.then_some(values))
        };
        let normal = part(letters.has_normal, 3)?;
        let color = part(letters.has_color, 4)?;
        part(letters.has_texture, 3)?;
        scene.push(numbers, normal, color);
    }
    if n == 0 {
        return Ok(());
    }
    let (columns, rows) =
        (n_u - u64::from(!letters.wraps_u && n_u > 0), n_v - u64::from(!letters.wraps_v && n_v > 0));
    for v in 0..rows {
        at_row(progress, v, rows)?;
        for u in 0..columns {
            let place = |u: u64, v: u64| first + ((v % n_v) * n_u + u % n_u) as u32;
            scene.faces.push(&[place(u, v), place(u + 1, v), place(u + 1, v + 1), place(u, v + 1)]);
        }
    }
    scene.end_object();
    Ok(())
}
