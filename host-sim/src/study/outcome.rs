//! What a study found: words, tables and plots, in the order of the page.

use anyhow::Result;

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

impl Table {
    /// How many of the first columns hold words; the others hold numbers, or `-` where there is none.
    #[must_use]
    pub fn word_columns(&self) -> usize {
        let is_number = |cell: &String| cell == "-" || cell.trim_end_matches('%').trim().parse::<f64>().is_ok();
        let holds_words = |&column: &usize| !self.rows.iter().filter_map(|row| row.get(column)).all(is_number);
        (0..self.columns.len()).take_while(holds_words).count()
    }

    /// As CSV, the headings first.
    ///
    /// # Errors
    /// If a row has not as many cells as there are columns.
    pub fn encode_csv(&self) -> Result<Vec<u8>> {
        let mut writer = csv::Writer::from_writer(Vec::new());
        std::iter::once(&self.columns).chain(&self.rows).try_for_each(|record| writer.write_record(record))?;
        Ok(writer.into_inner()?)
    }
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

#[cfg(test)]
mod tests {
    use super::*;

    fn table(rows: &[&[&str]]) -> Table {
        let words = |cells: &[&str]| cells.iter().map(|&cell| cell.to_owned()).collect();
        let columns = words(&["scene", "share, %", "error, px"]);
        let rows = rows.iter().map(|cells| words(cells)).collect();
        Table { name: "t".to_owned(), caption: "c".to_owned(), columns, rows }
    }

    #[test]
    fn words_stand_before_numbers() {
        assert_eq!(table(&[&["room", "12.5", "-"], &["1", "-3", "0.1"]]).word_columns(), 1);
        assert_eq!(table(&[&["1", "2", "3"]]).word_columns(), 0);
    }

    #[test]
    fn csv_has_the_headings_and_quotes_commas() {
        let csv = String::from_utf8(table(&[&["room", "1", "2"]]).encode_csv().unwrap()).unwrap();
        assert_eq!(csv, "scene,\"share, %\",\"error, px\"\nroom,1,2\n");
        assert!(table(&[&["room", "1"]]).encode_csv().is_err());
    }
}
