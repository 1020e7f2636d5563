//! What a study found: words, tables and plots, in the order of the page.

/// What a study found.
#[derive(Debug, Clone)]
pub struct Outcome {
    /// The study's name on the command line; begins the names of its files.
    pub name: &'static str,
    /// Its heading.
    pub title: String,
    /// Words, tables and plots, in order.
    pub parts: Vec<Part>,
}

/// A part of a study's page.
#[derive(Debug, Clone)]
pub enum Part {
    /// A paragraph: what was asked, how it was measured, what it says.
    Text(String),
    /// Figures, printed and written as CSV.
    Table(Table),
    /// A picture, written as SVG.
    Plot(Plot),
}

/// Figures in columns.
#[derive(Debug, Clone)]
pub struct Table {
    /// Ends the name of its file, after the study's.
    pub name: String,
    /// What it shows.
    pub caption: String,
    /// Headings, with units.
    pub columns: Vec<String>,
    /// Cells as they are to be read, as many in a row as there are columns.
    pub rows: Vec<Vec<String>>,
}

/// A picture.
#[derive(Debug, Clone)]
pub struct Plot {
    /// Ends the name of its file, after the study's.
    pub name: String,
    /// What it shows.
    pub caption: String,
    /// The picture, a whole SVG document.
    pub svg: String,
}
