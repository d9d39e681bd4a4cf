//! Fields of a Gmsh mesh: `$NodeData` and `$ElementData`.

use adwave::Progress;

use crate::ReadError;
use crate::formats::msh::input::Input;
use crate::model::field::Number;
use crate::progress::at_row;
use crate::text::line_end;
use crate::text::tokens::Tokens;

/// Values of some nodes or elements.
pub(crate) struct Values {
    pub(crate) name: String,
    pub(crate) n_channels: usize,
    pub(crate) tags: Vec<u64>,
    /// Numbers with all channels of one row adjacent.
    pub(crate) numbers: Vec<f64>,
}

/// Reads the content of `$NodeData` or `$ElementData`.
pub(crate) fn read_values(input: &mut Input<'_>, progress: Progress<'_>) -> Result<Values, ReadError> {
    let mut tokens = Tokens::new(input.bytes, input.position);
    let n_strings = tokens.count("the number of names", 0)?;
    tokens.check(n_strings, 1, "name")?;
    let mut name = None;
    for _ in 0..n_strings {
        let mut text: &[u8] = b"";
        while text.is_empty() && tokens.position < input.bytes.len() {
            let end = line_end(input.bytes, tokens.position);
            text = input.bytes[tokens.position..end].trim_ascii();
            tokens.position = (end + 1).min(input.bytes.len());
        }
        let text = String::from_utf8_lossy(text);
        name.get_or_insert_with(|| text.trim_matches('"').chars().filter(|c| !c.is_control()).collect());
    }
    let n_reals = tokens.count("the number of times", 0)?;
    tokens.check(n_reals, 2, "time")?;
    for row in 0..n_reals {
        tokens.number("time", row)?;
    }
    let n_wholes = tokens.count("the number of counts", 0)?;
    tokens.check(n_wholes, 2, "count")?;
    let mut counts = [0, 1, 0];
    for row in 0..n_wholes {
        let count = tokens.whole("count", row)?;
        if let Some(slot) = counts.get_mut(row as usize) {
            *slot = count;
        }
    }
    let [_, n_channels, n_rows] = counts;
    if n_wholes < 3 || !(1..=4096).contains(&n_channels) || n_rows < 0 {
        input.position = tokens.position;
        return Err(input.wrong("a field must have 1 to 4096 channels and a number of rows; correct it"));
    }
    let (n, n_channels) = (n_rows as u64, n_channels as usize);
    let mut found =
        Values { name: name.unwrap_or_default(), n_channels, tags: Vec::new(), numbers: Vec::new() };
    if found.name.is_empty() {
        found.name = "field".into();
    }
    if input.is_binary {
        input.position = line_end(input.bytes, tokens.position).saturating_add(1).min(input.bytes.len());
        let stride = 4 + 8 * n_channels;
        let mut cursor = input.cursor();
        let rows = cursor.rows(n, stride as u64, "value")?;
        input.position = cursor.position;
        for (row, bytes) in rows.chunks_exact(stride).enumerate() {
            at_row(progress, row as u64, n)?;
            found.tags.push(u32::from_bytes(bytes, input.order).into());
            found.numbers.extend(bytes[4..].chunks_exact(8).map(|b| f64::from_bytes(b, input.order)));
        }
        return Ok(found);
    }
    tokens.check(n, 2 * (1 + n_channels as u64), "value")?;
    for row in 0..n {
        at_row(progress, row, n)?;
        found.tags.push(tokens.count("value", row)?);
        for _ in 0..n_channels {
            found.numbers.push(tokens.number("value", row)?);
        }
    }
    input.position = tokens.position;
    Ok(found)
}
