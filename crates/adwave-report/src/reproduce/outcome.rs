//! What the making of a figure or table gives.

use std::fmt::Write as _;

/// Whether a figure came out as the paper claims, each with a sentence that gives the numbers it rests on.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Verdict {
    /// All of the claim.
    AsClaimed(String),
    /// A part of the claim.
    PartlyAsClaimed(String),
    /// None of the claim.
    NotAsClaimed(String),
}

impl Verdict {
    /// As claimed where all `parts` of a claim hold, not as claimed where none does.
    ///
    /// ```
    /// use adwave_report::reproduce::Verdict;
    /// let verdict = Verdict::from_parts(&[true, false], "two of three");
    /// assert_eq!(verdict.headline(), "Partly as the paper claims");
    /// ```
    pub fn from_parts(parts: &[bool], sentence: impl Into<String>) -> Self {
        if parts.iter().all(|&holds| holds) {
            Self::AsClaimed(sentence.into())
        } else if parts.iter().any(|&holds| holds) {
            Self::PartlyAsClaimed(sentence.into())
        } else {
            Self::NotAsClaimed(sentence.into())
        }
    }

    /// The verdict in a few words.
    pub fn headline(&self) -> &'static str {
        match self {
            Self::AsClaimed(_) => "As the paper claims",
            Self::PartlyAsClaimed(_) => "Partly as the paper claims",
            Self::NotAsClaimed(_) => "Not as the paper claims",
        }
    }

    /// One word for machines.
    pub fn keyword(&self) -> &'static str {
        match self {
            Self::AsClaimed(_) => "as-claimed",
            Self::PartlyAsClaimed(_) => "partly",
            Self::NotAsClaimed(_) => "not-as-claimed",
        }
    }

    /// The numbers it rests on.
    pub fn sentence(&self) -> &str {
        match self {
            Self::AsClaimed(text) | Self::PartlyAsClaimed(text) | Self::NotAsClaimed(text) => text,
        }
    }
}

/// A picture as a file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct PictureFile {
    /// Its name with the ending `.png` or `.svg`; unique within the figure.
    pub name: String,
    /// What to see.
    pub caption: String,
    /// Its content.
    pub bytes: Vec<u8>,
}

/// The numbers behind a figure.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Table {
    /// The name of its file, with the ending `.csv`; unique within the figure.
    pub name: String,
    /// What the numbers are.
    pub caption: String,
    /// Names of the columns, with units.
    pub head: Vec<String>,
    /// One cell a column.
    pub rows: Vec<Vec<String>>,
}

impl Table {
    /// A table without rows.
    pub fn new(name: &str, caption: &str, head: &[&str]) -> Self {
        let head = head.iter().map(|&h| h.to_owned()).collect();
        Self { name: name.to_owned(), caption: caption.to_owned(), head, rows: Vec::new() }
    }

    /// Adds a row.
    ///
    /// # Panics
    /// Unless there is one cell a column.
    pub fn push<const N: usize>(&mut self, row: [String; N]) {
        assert_eq!(N, self.head.len(), "one cell a column of {}", self.name);
        self.rows.push(row.into());
    }

    /// The table as RFC 4180 has it: cells with commas, quotes or line breaks in quotes.
    ///
    /// ```
    /// use adwave_report::reproduce::Table;
    /// let mut table = Table::new("a.csv", "", &["x", "y"]);
    /// table.push(["1".to_owned(), "a, \"b\"".to_owned()]);
    /// assert_eq!(table.csv(), "x,y\n1,\"a, \"\"b\"\"\"\n");
    /// ```
    pub fn csv(&self) -> String {
        let mut text = String::new();
        for row in std::iter::once(&self.head).chain(&self.rows) {
            for (k, cell) in row.iter().enumerate() {
                text.push_str(if k > 0 { "," } else { "" });
                if cell.contains([',', '"', '\n', '\r']) {
                    let _ = write!(text, "\"{}\"", cell.replace('"', "\"\""));
                } else {
                    text.push_str(cell);
                }
            }
            text.push('\n');
        }
        text
    }
}

/// A figure or table made again.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Outcome {
    /// `fig1` … `table2`; filled in by [`reproduce`](super::reproduce()).
    pub id: String,
    /// What the paper shows; filled in by [`reproduce`](super::reproduce()).
    pub title: String,
    /// The command that makes it; filled in by [`reproduce`](super::reproduce()).
    pub command: String,
    /// Which shapes it was made on.
    pub shapes: Vec<String>,
    /// Pictures; where an SVG and a PNG share their stem, they are the same picture.
    pub pictures: Vec<PictureFile>,
    /// The numbers behind them.
    pub tables: Vec<Table>,
    /// What to see, in paragraphs.
    pub text: Vec<String>,
    /// Whether it came out as claimed.
    pub verdict: Verdict,
}

impl Outcome {
    /// An outcome without pictures and tables.
    pub fn new(verdict: Verdict) -> Self {
        Self {
            id: String::new(),
            title: String::new(),
            command: String::new(),
            shapes: Vec::new(),
            pictures: Vec::new(),
            tables: Vec::new(),
            text: Vec::new(),
            verdict,
        }
    }

    /// Adds a shape that it was made on.
    #[must_use]
    pub fn on(mut self, shape: impl Into<String>) -> Self {
        let shape = shape.into();
        if !self.shapes.contains(&shape) {
            self.shapes.push(shape);
        }
        self
    }

    /// Adds a paragraph.
    #[must_use]
    pub fn say(mut self, paragraph: impl Into<String>) -> Self {
        self.text.push(paragraph.into());
        self
    }

    /// Adds a picture.
    #[must_use]
    pub fn picture(mut self, name: &str, caption: impl Into<String>, bytes: Vec<u8>) -> Self {
        self.pictures.push(PictureFile { name: name.to_owned(), caption: caption.into(), bytes });
        self
    }

    /// Adds a table.
    #[must_use]
    pub fn table(mut self, table: Table) -> Self {
        self.tables.push(table);
        self
    }
}

/// Four significant digits, in scientific notation where the number is very large or small.
///
/// ```
/// use adwave_report::reproduce::digits;
/// assert_eq!((digits(0.0), digits(12.3456), digits(1.0e-9)), ("0".into(), "12.35".into(), "1.000e-9".into()));
/// ```
pub fn digits(value: f64) -> String {
    let size = value.abs();
    if value == 0.0 {
        "0".to_owned()
    } else if !value.is_finite() {
        String::new()
    } else if (1e-3..1e6).contains(&size) {
        let decimals = (3 - size.log10().floor() as i32).clamp(0, 6) as usize;
        format!("{value:.decimals$}")
    } else {
        format!("{value:.3e}")
    }
}
