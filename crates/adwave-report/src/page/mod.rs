//! A page of sections with pictures and tables, as an HTML file that opens from a disk, without a network and without
//! scripts, on a phone and on a wide screen, light and dark. Pictures are inside the file, or files beside it.

mod html;
mod image;

pub use image::{DARK_GROUND, Image, ImageError, ImageKind, LIGHT_GROUND, Source};

use crate::table::Table;

/// A page.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Page {
    /// The name above all.
    pub title: String,
    /// Paragraphs below the title.
    pub introduction: Vec<String>,
    /// The parts, each with a line in the table of contents.
    pub sections: Vec<Section>,
    /// The last line.
    pub footer: String,
}

/// A part of a page.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Section {
    /// What a link names it by: letters and digits, unique on the page.
    pub id: String,
    /// Its title.
    pub title: String,
    /// Its content, from top to bottom.
    pub blocks: Vec<Block>,
}

impl Section {
    /// A section without content.
    pub fn new(id: &str, title: impl Into<String>) -> Self {
        Self { id: id.to_owned(), title: title.into(), blocks: Vec::new() }
    }

    /// Adds a paragraph; see [`Block::Paragraph`].
    pub fn say(&mut self, text: impl Into<String>) {
        self.blocks.push(Block::Paragraph(text.into()));
    }

    /// Adds a remark that is set off from the text.
    pub fn note(&mut self, text: impl Into<String>) {
        self.blocks.push(Block::Note(text.into()));
    }

    /// Adds a block.
    pub fn push(&mut self, block: Block) {
        self.blocks.push(block);
    }
}

/// A piece of a section.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Block {
    /// Text. What stands between backticks is set as code, and the j of `W_j`, `S_j`, `n_j` and `σ_j` as a subscript.
    Paragraph(String),
    /// A remark.
    Note(String),
    /// A judgment and what it rests on.
    Verdict(Verdict),
    /// Names with their values.
    Facts(Vec<Fact>),
    /// Pictures side by side, below each other on a phone.
    Gallery(Vec<Figure>),
    /// Numbers, with a link that saves them as CSV; a long table is the link only.
    Table(Table),
    /// The same with a link to the CSV file beside the page.
    TableBeside(Table, String),
    /// Files beside the page.
    Files(Vec<Link>),
}

/// A judgment.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Verdict {
    /// Whether it is good.
    pub tone: Tone,
    /// In a few words.
    pub headline: String,
    /// What it rests on.
    pub sentence: String,
}

/// How a judgment sounds; it colors it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Tone {
    /// All is well.
    Good,
    /// Well in part.
    Mixed,
    /// Not well.
    Bad,
}

/// A name, its value, and what the value means.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Fact {
    /// What it is.
    pub name: String,
    /// A number with its unit, or a word.
    pub value: String,
    /// What it means; may be empty.
    pub meaning: String,
}

/// A picture with its caption.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Figure {
    /// The picture.
    pub image: Image,
    /// What it shows, for those who do not see it.
    pub alt: String,
    /// What to see.
    pub caption: String,
    /// What its colors stand for.
    pub legend: Option<Legend>,
    /// A file beside the page that opens when the picture is chosen.
    pub link: Option<String>,
}

/// What colors stand for.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Legend {
    /// A range of values.
    Bar {
        /// Name and unit.
        label: String,
        /// What the first color stands for.
        low: String,
        /// What the last color stands for.
        high: String,
        /// From first to last, evenly spaced.
        colors: Vec<[u8; 3]>,
    },
    /// One meaning a color.
    Keys(Vec<([u8; 3], String)>),
}

/// A file beside the page.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Link {
    /// Where it is, relative to the page, with `/` between folders.
    pub path: String,
    /// What is in it.
    pub text: String,
}

impl Page {
    /// The page as an HTML file. O(bytes).
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
