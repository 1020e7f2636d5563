//! The page of the studies: one HTML file with everything in it, without scripts and without links out.

use maud::{DOCTYPE, Markup, PreEscaped, html};

use super::{Outcome, Part, Plot, Table};

/// Who made a page, from what.
#[derive(Debug)]
pub struct Origin<'a> {
    /// The command that makes it again.
    pub command: &'a str,
    /// Seed of everything random.
    pub seed: u64,
    /// Where the frames come from.
    pub scenes: &'a str,
}

const STYLE: &str = "
:root { color-scheme: light dark; --ink: #1c1c1e; --soft: #5b5b62; --paper: #fcfcfa; --line: #d9d9d4;
  --stripe: #f2f2ee; --link: #00568a; }
@media (prefers-color-scheme: dark) {
  :root { --ink: #e8e8e6; --soft: #a5a5aa; --paper: #17171a; --line: #3a3a40; --stripe: #202024; --link: #7cc4f2; }
}
* { box-sizing: border-box; }
body { margin: 0 auto; max-width: 66rem; padding: 1rem 1rem 4rem; background: var(--paper); color: var(--ink);
  font: 1rem/1.55 system-ui, sans-serif; overflow-wrap: break-word; }
p, nav, dl { max-width: 46rem; }
h1 { font-size: 1.7rem; line-height: 1.2; }
h2 { font-size: 1.3rem; line-height: 1.25; margin-top: 3rem; border-top: 1px solid var(--line); padding-top: 1rem; }
a { color: var(--link); }
dl { display: grid; grid-template-columns: max-content 1fr; gap: .2rem 1rem; color: var(--soft); }
dd { margin: 0; min-width: 0; }
code { font-family: ui-monospace, monospace; font-size: .92em; }
figure { margin: 1.6rem 0; }
figcaption { color: var(--soft); margin-bottom: .5rem; max-width: 46rem; }
.wide { overflow-x: auto; }
table { border-collapse: collapse; font-size: .9rem; font-variant-numeric: tabular-nums; }
th, td { padding: .3rem .7rem; text-align: right; white-space: nowrap; border-bottom: 1px solid var(--line); }
th { vertical-align: bottom; border-bottom-width: 2px; }
th.words, td.words { text-align: left; }
td.words + td.words:last-child { white-space: normal; }
tbody tr:nth-child(even) { background: var(--stripe); }
figure svg { display: block; background: #fff; max-width: 100%; height: auto; border-radius: 4px; }
@media (max-width: 40rem) { figure svg { max-width: none; } }
";

/// The page of `outcomes`, in their order.
#[must_use]
pub fn page(title: &str, origin: &Origin<'_>, outcomes: &[Outcome]) -> String {
    let body = html! {
        (made_by(origin))
        @if outcomes.len() > 1 { (contents(outcomes)) }
        @for outcome in outcomes { (section(outcome)) }
    };
    document(title, &body)
}

/// A page in one file, with that heading.
pub(crate) fn document(title: &str, body: &Markup) -> String {
    let markup = html! {
        (DOCTYPE)
        html lang="en" {
            head {
                meta charset="utf-8";
                meta name="viewport" content="width=device-width, initial-scale=1";
                title { (title) }
                style { (PreEscaped(STYLE)) }
            }
            body {
                h1 { (title) }
                (body)
            }
        }
    };
    markup.into_string() + "\n"
}

fn made_by(origin: &Origin<'_>) -> Markup {
    html! {
        dl {
            dt { "made by" } dd { code { (origin.command) } }
            dt { "version" } dd { "haarline " (env!("CARGO_PKG_VERSION")) }
            dt { "seed" } dd { (origin.seed) }
            dt { "frames" } dd { (origin.scenes) }
        }
        p { "The same command gives the same figures, but for times: their columns and plots are marked as measured." }
    }
}

fn contents(outcomes: &[Outcome]) -> Markup {
    html! {
        nav aria-label="Contents" {
            ol { @for outcome in outcomes { li { a href={ "#" (outcome.name) } { (outcome.title) } } } }
        }
    }
}

fn section(outcome: &Outcome) -> Markup {
    html! {
        section id=(outcome.name) {
            h2 { (outcome.title) }
            (parts(&outcome.parts))
        }
    }
}

/// Words, tables and plots, one below the other.
pub(crate) fn parts(parts: &[Part]) -> Markup {
    html! {
        @for part in parts {
            @match part {
                Part::Text(text) => p { (text) },
                Part::Table(table) => (figures(table)),
                Part::Plot(plot) => (picture(plot)),
            }
        }
    }
}

fn figures(table: &Table) -> Markup {
    let words = table.word_columns();
    let class = |column: usize| (column < words).then_some("words");
    html! {
        figure {
            figcaption { (table.caption) }
            div.wide tabindex="0" {
                table {
                    thead {
                        tr { @for (column, head) in table.columns.iter().enumerate() { th class=[class(column)] { (head) } } }
                    }
                    tbody {
                        @for row in &table.rows {
                            tr { @for (column, cell) in row.iter().enumerate() { td class=[class(column)] { (cell) } } }
                        }
                    }
                }
            }
        }
    }
}

fn picture(plot: &Plot) -> Markup {
    html! {
        figure {
            figcaption { (plot.caption) }
            div.wide tabindex="0" role="img" aria-label=(plot.caption) { (PreEscaped(&plot.svg)) }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn outcome(name: &'static str) -> Outcome {
        let (columns, rows) =
            (vec!["<scene>".to_owned(), "error, px".to_owned()], vec![vec!["a & b".to_owned(), "1.5".to_owned()]]);
        let table = Table { name: "t".to_owned(), caption: "figures".to_owned(), columns, rows };
        let plot = Plot { name: "p".to_owned(), caption: "a \"picture\"".to_owned(), svg: "<svg></svg>".to_owned() };
        let parts = vec![Part::Text("1 < 2".to_owned()), Part::Table(table), Part::Plot(plot)];
        Outcome { name, title: format!("Study {name}"), parts }
    }

    fn made(outcomes: &[Outcome]) -> String {
        page(
            "Studies",
            &Origin { command: "haarline study all -o DIR --seed 3", seed: 3, scenes: "rendered" },
            outcomes,
        )
    }

    #[test]
    fn everything_is_in_it_and_escaped() {
        let page = made(&[outcome("one"), outcome("two")]);
        let wanted = [
            "1 &lt; 2",
            "&lt;scene&gt;",
            "a &amp; b",
            "<svg></svg>",
            "a &quot;picture&quot;",
            "--seed 3",
            "href=\"#two\"",
            "id=\"two\"",
        ];
        for words in wanted {
            assert!(page.contains(words), "{words}");
        }
        assert!(page.contains("class=\"words\">a &amp; b") && page.contains("<td>1.5"), "numbers stand to the right");
    }

    #[test]
    fn it_needs_nothing_else_and_one_study_needs_no_contents() {
        let page = made(&[outcome("one")]);
        for words in ["<script", "http:", "https:", "url(", "@import", "<nav"] {
            assert!(!page.contains(words), "{words}");
        }
    }
}
