//! The table that a user can send us.

use std::fmt::Write as _;

use haarline::Stage;

use super::run::{Board, Outcome};

/// One method's row.
#[derive(Debug, Clone)]
pub struct Line {
    /// The method.
    pub method: &'static str,
    /// What came of each scene.
    pub outcomes: Vec<Outcome>,
    /// Instructions of all scenes, where they were counted.
    pub instructions: Option<u64>,
}

/// The table's head, in Markdown.
pub const HEAD: &str = "\
| chip | revision | MHz | compiler | method | scenes | cycles a pixel | instructions a pixel | cycles an instruction | worst push, cycles | x mean | state, B | stack with it, B | maps |
| --- | --- | ---: | --- | --- | ---: | ---: | ---: | ---: | ---: | ---: | ---: | ---: | --- |
";

impl Line {
    fn pixels(&self) -> u64 {
        self.outcomes.iter().map(|outcome| outcome.pixels).sum()
    }

    fn cycles(&self) -> u64 {
        self.outcomes.iter().flat_map(|outcome| outcome.figures.stages).sum()
    }

    /// Whether every row of every scene was the host's.
    #[must_use]
    pub fn is_right(&self) -> bool {
        self.outcomes.iter().all(|outcome| outcome.different.is_none())
    }

    /// The row of the table, in Markdown.
    #[must_use]
    pub fn markdown(&self, board: &Board) -> String {
        let pixels = self.pixels().max(1) as f64;
        let cycles = self.cycles() as f64;
        let worst = self.outcomes.iter().map(|outcome| outcome.figures.worst).max().unwrap_or(0);
        let pushes = self.outcomes.iter().map(|outcome| outcome.pushes).sum::<u64>().max(1);
        let most = |of: fn(&Outcome) -> u32| self.outcomes.iter().map(of).max().unwrap_or(0);
        let [instructions, ratio] = match self.instructions {
            Some(count) => [format!("{:.1}", count as f64 / pixels), format!("{:.2}", cycles / count.max(1) as f64)],
            None => ["-".to_owned(), "-".to_owned()],
        };
        format!(
            "| {} | {} | {} | {} | {} | {} | {:.1} | {instructions} | {ratio} | {worst} | {:.1} | {} | {} | {} |\n",
            board.chip,
            board.revision,
            board.mhz,
            board.compiler,
            self.method,
            self.outcomes.len(),
            cycles / pixels,
            f64::from(worst) * pushes as f64 / cycles.max(1.0),
            most(|outcome| outcome.figures.state),
            most(|outcome| outcome.figures.stack),
            if self.is_right() { "equal" } else { "DIFFERENT" },
        )
    }

    /// Cycles a pixel of each stage that took any, for a reader.
    #[must_use]
    pub fn stages(&self) -> String {
        let mut text = String::new();
        for stage in Stage::ALL {
            let cycles: u64 = self.outcomes.iter().map(|outcome| outcome.figures.stages[stage.index()]).sum();
            if cycles > 0 {
                let comma = if text.is_empty() { "" } else { ", " };
                let _ = write!(text, "{comma}{} {:.1}", stage.name(), cycles as f64 / self.pixels().max(1) as f64);
            }
        }
        text
    }
}

#[cfg(test)]
mod tests {
    use haarline_link::message::Figures;

    use super::*;

    #[test]
    fn a_row_has_every_column_of_the_head() {
        let figures = Figures { stages: [0, 0, 500, 0, 0, 1000, 0, 0, 0, 0], worst: 300, state: 7, stack: 8 };
        let outcome = Outcome { figures, pixels: 100, pushes: 10, different: None };
        let board = Board { chip: "C".into(), revision: "V".into(), mhz: 480, compiler: "rustc".into() };
        let line = Line { method: "full", outcomes: vec![outcome; 2], instructions: Some(2000) };
        let row = line.markdown(&board);
        assert_eq!(row, "| C | V | 480 | rustc | full | 2 | 15.0 | 10.0 | 1.50 | 300 | 2.0 | 7 | 8 | equal |\n");
        let columns = HEAD.lines().map(|line| line.matches('|').count());
        assert!(columns.eq([row.matches('|').count(); 2]));
        assert_eq!(line.stages(), "features 5.0, blocks 10.0");
        let wrong = Outcome { different: Some(3), ..outcome };
        assert!(Line { outcomes: vec![outcome, wrong], ..line }.markdown(&board).ends_with("| DIFFERENT |\n"));
    }
}
