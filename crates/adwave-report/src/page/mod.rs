//! Pages of sections with pictures and tables. A page is an HTML file without scripts that opens from a disk, without a
//! network, on narrow and wide screens, in light and dark mode. Pictures are embedded, or files in the same folder.

mod html;
mod image;

pub use image::{DARK_BACKGROUND, Image, ImageError, ImageKind, LIGHT_BACKGROUND, Source};

use crate::table::Table;

/// Page of sections.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Page {
    /// Title of the page.
    pub title: String,
    /// Paragraphs below the title.
    pub introduction: Vec<String>,
    /// Sections, which the table of contents lists.
    pub sections: Vec<Section>,
    /// Text at the end of the page.
    pub footer: String,
}

/// Section of a page.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Section {
    /// Anchor for links: letters and digits, unique on the page.
    pub id: String,
    /// Title of the section.
    pub title: String,
    /// Content from top to bottom.
    pub blocks: Vec<Block>,
}

impl Section {
    /// Creates a section without content.
    pub fn new(id: &str, title: impl Into<String>) -> Self {
        Self { id: id.to_owned(), title: title.into(), blocks: Vec::new() }
    }

    /// Adds a paragraph; see [`Block::Paragraph`].
    pub fn say(&mut self, text: impl Into<String>) {
        self.blocks.push(Block::Paragraph(text.into()));
    }

    /// Adds a note, which is set off from the text.
    pub fn note(&mut self, text: impl Into<String>) {
        self.blocks.push(Block::Note(text.into()));
    }

    /// Adds a block.
    pub fn push(&mut self, block: Block) {
        self.blocks.push(block);
    }
}

/// Block of a section.
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Block {
    /// Text. Words between backticks are set as code, and the j of `W_j`, `S_j`, `n_j` and `σ_j` as a subscript.
    Paragraph(String),
    /// Note, which is set off from the text.
    Note(String),
    /// Verdict with its reasons.
    Verdict(Verdict),
    /// Names with their values.
    Facts(Vec<Fact>),
    /// Pictures side by side, or below each other on a narrow screen.
    Gallery(Vec<Figure>),
    /// Table with a link that saves it as CSV; only the link for a long table.
    Table(Table),
    /// Table with a link to a CSV file in the folder of the page.
    TableWithFile(Table, String),
    /// Links to files in the folder of the page.
    Files(Vec<Link>),
}

/// Verdict with its reasons.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Verdict {
    /// Color of the headline.
    pub tone: Tone,
    /// Verdict in a few words.
    pub headline: String,
    /// Reasons, in a sentence.
    pub sentence: String,
}

/// Tone of a verdict, which decides its color.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Tone {
    /// Positive.
    Good,
    /// Partly positive.
    Mixed,
    /// Negative.
    Bad,
}

/// Name, value and meaning of a quantity.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Fact {
    /// Name of the quantity.
    pub name: String,
    /// Number with its unit, or a word.
    pub value: String,
    /// Explanation; may be empty.
    pub meaning: String,
}

/// Picture with its caption.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Figure {
    /// Encoded picture.
    pub image: Image,
    /// Text shown instead of the picture.
    pub alt: String,
    /// Caption below the picture.
    pub caption: String,
    /// Legend of the colors, if the picture shows a field.
    pub legend: Option<Legend>,
    /// File in the folder of the page that a click on the picture opens.
    pub link: Option<String>,
}

/// Legend of colors.
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Legend {
    /// Range of values.
    Bar {
        /// Name and unit of the values.
        label: String,
        /// Value of the first color.
        low: String,
        /// Value of the last color.
        high: String,
        /// Colors from first to last, evenly spaced.
        colors: Vec<[u8; 3]>,
    },
    /// Colors with their meanings.
    Keys(Vec<([u8; 3], String)>),
}

/// Link to a file in the folder of the page.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Link {
    /// Path relative to the page, with `/` between folders.
    pub path: String,
    /// Description of the file.
    pub text: String,
}

impl Page {
    /// Converts the page to an HTML file. O(bytes).
    ///
    /// ```
    /// use adwave_report::page::{Page, Section};
    /// let mut section = Section::new("first", "A < B");
    /// section.say("Written with `<b>`.");
    /// let page = Page { title: "T".to_owned(), sections: vec![section], ..Page::default() };
    /// assert!(page.html().contains("<h2>A &lt; B</h2>"));
    /// assert!(page.html().contains("&lt;b&gt;</code>"));
    /// ```
    pub fn html(&self) -> String {
        html::page(self)
    }
}
