//! Result of making a figure or table.

use adwave_report::Table;

/// Comparison of a figure with the claim of the paper; each variant has a sentence with the numbers on which it is
/// based.
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Verdict {
    /// The whole claim holds.
    AsClaimed(String),
    /// A part of the claim holds.
    PartlyAsClaimed(String),
    /// No part of the claim holds.
    NotAsClaimed(String),
}

impl Verdict {
    /// Judges a claim: as claimed if all `parts` hold, not as claimed if none does.
    ///
    /// ```
    /// use adwave_reproduce::Verdict;
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

    /// Verdict in a few words.
    pub fn headline(&self) -> &'static str {
        match self {
            Self::AsClaimed(_) => "As the paper claims",
            Self::PartlyAsClaimed(_) => "Partly as the paper claims",
            Self::NotAsClaimed(_) => "Not as the paper claims",
        }
    }

    /// Verdict as a keyword for programs.
    pub fn keyword(&self) -> &'static str {
        match self {
            Self::AsClaimed(_) => "as-claimed",
            Self::PartlyAsClaimed(_) => "partly",
            Self::NotAsClaimed(_) => "not-as-claimed",
        }
    }

    /// Sentence with the numbers on which the verdict is based.
    pub fn sentence(&self) -> &str {
        match self {
            Self::AsClaimed(text) | Self::PartlyAsClaimed(text) | Self::NotAsClaimed(text) => text,
        }
    }
}

/// Picture as a file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct PictureFile {
    /// File name with the extension `.png` or `.svg`; unique within the figure.
    pub name: String,
    /// Caption.
    pub caption: String,
    /// Content of the file.
    pub bytes: Vec<u8>,
}

/// Reproduced figure or table.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Outcome {
    /// Name of the figure, `fig1` … `table2`; set by [`reproduce`](crate::reproduce()).
    pub id: String,
    /// Title of the figure; set by [`reproduce`](crate::reproduce()).
    pub title: String,
    /// Command that makes the figure; set by [`reproduce`](crate::reproduce()).
    pub command: String,
    /// Names of the shapes on which the figure was made.
    pub shapes: Vec<String>,
    /// Pictures. An SVG and a PNG with the same stem are the same picture.
    pub pictures: Vec<PictureFile>,
    /// Numbers of the figure.
    pub tables: Vec<Table>,
    /// Explanation, in paragraphs.
    pub text: Vec<String>,
    /// Comparison with the claim of the paper.
    pub verdict: Verdict,
}

impl Outcome {
    /// Creates an outcome without pictures and tables.
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

    /// Adds the name of a shape on which the figure was made.
    #[must_use]
    pub fn add_shape(mut self, shape: impl Into<String>) -> Self {
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
