//! Pictures with the colors of an OBJ's materials.

use std::collections::HashMap;
use std::path::Path;

use adwave::Progress;

use crate::files::read::read_file;
use crate::text::{line_end, parse_f64, words};
use crate::{ReadError, ReadLimits};

/// The file of `map_Kd` for each material that has one, from the libraries in `folder`.
pub(super) fn read_materials(
    folder: &Path,
    libraries: &[String],
    limits: &ReadLimits,
) -> Result<HashMap<String, String>, ReadError> {
    let mut pictures = HashMap::new();
    for library in libraries {
        // A line may name several files, and a name may contain blanks: the whole line is tried first.
        let whole = folder.join(library);
        let paths = if whole.exists() || !library.contains(' ') {
            vec![whole]
        } else {
            library.split(' ').map(|name| folder.join(name)).collect()
        };
        for path in paths {
            let bytes = read_file(&path, limits, Progress::none()).map_err(|e| e.in_file(&path))?;
            parse_library(&bytes, &mut pictures);
        }
    }
    Ok(pictures)
}

fn parse_library(bytes: &[u8], pictures: &mut HashMap<String, String>) {
    let (mut material, mut position) = (String::new(), 0);
    while position < bytes.len() {
        let end = line_end(bytes, position);
        let line = bytes[position..end].trim_ascii();
        position = end + 1;
        let rest = |keyword: &str| {
            let text = line.get(keyword.len()..).unwrap_or_default();
            String::from_utf8_lossy(text.trim_ascii()).into_owned()
        };
        match words(line).next().map(<[u8]>::to_ascii_lowercase).as_deref() {
            Some(b"newmtl") => material = rest("newmtl"),
            Some(b"map_kd") => {
                let name = without_options(&rest("map_kd")).replace('\\', "/");
                if !name.is_empty() {
                    pictures.insert(material.clone(), name);
                }
            }
            _ => {}
        }
    }
}

/// Name after options such as `-s 1 1 1`, `-clamp on` and `-bm 0.5`.
fn without_options(text: &str) -> String {
    let mut rest = text;
    while let Some(option) = rest.strip_prefix('-') {
        let (keyword, mut after) = option.split_once(char::is_whitespace).unwrap_or((option, ""));
        after = after.trim_start();
        let most = match keyword {
            "s" | "o" | "t" => 3,
            "mm" => 2,
            _ => 1,
        };
        for taken in 0..most {
            let (word, next) = after.split_once(char::is_whitespace).unwrap_or((after, ""));
            // The first argument may be a word; further ones are optional numbers.
            if next.is_empty() || (taken > 0 && parse_f64(word.as_bytes()).is_none()) {
                break;
            }
            after = next.trim_start();
        }
        if after.len() == rest.len() {
            break;
        }
        rest = after;
    }
    rest.to_owned()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn options_before_the_name_are_skipped_and_blanks_in_it_kept() {
        for (text, name) in [
            ("wood.png", "wood.png"),
            ("-s 1 1 1 -clamp on my wood.png", "my wood.png"),
            ("-o 0.5 wood.png", "wood.png"),
            ("-bm 0.3 -mm 0 1 a/b.jpg", "a/b.jpg"),
            ("-blendu off wood-2.png", "wood-2.png"),
            ("-", ""),
        ] {
            assert_eq!(without_options(text), name, "{text}");
        }
    }

    #[test]
    fn each_material_has_its_own_picture() {
        let mut pictures = HashMap::new();
        parse_library(
            b"newmtl a\nKd 1 0 0\nmap_Kd x.png\nnewmtl b b\r\nmap_kd c\\y.png\nnewmtl c\n",
            &mut pictures,
        );
        assert_eq!(pictures.len(), 2);
        assert_eq!((pictures["a"].as_str(), pictures["b b"].as_str()), ("x.png", "c/y.png"));
    }
}
