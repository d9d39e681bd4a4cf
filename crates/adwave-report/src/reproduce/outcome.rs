//! What the making of a figure or table gives.

use crate::table::Table;

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

/// A figure or table reproduced.
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
