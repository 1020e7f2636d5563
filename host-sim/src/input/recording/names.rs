//! What the names of files tell: their natural order, numbers, and the camera.

use std::cmp::Ordering;

use super::Side;

/// What takes the place of the word that tells the camera.
const CAMERA: &str = "*";
/// Nouns before a 0 or 1 that is a camera's, not a frame's.
const CAMERA_NOUNS: [&str; 7] = ["", "c", "cam", "camera", "im", "view", "sensor"];

/// A piece of a name: digits or none.
fn pieces(name: &str) -> impl Iterator<Item = &str> {
    name.as_bytes().chunk_by(|a, b| a.is_ascii_digit() == b.is_ascii_digit()).scan(0, |at, piece| {
        let begin = *at;
        *at += piece.len();
        // A piece ends beside an ASCII digit, which is no part of another character.
        name.get(begin..*at)
    })
}

fn is_number(piece: &str) -> bool {
    piece.starts_with(|c: char| c.is_ascii_digit())
}

/// The order that people expect: 2 before 10.
pub(super) fn natural_order(a: &str, b: &str) -> Ordering {
    let (mut left, mut right) = (pieces(a), pieces(b));
    loop {
        let order = match (left.next(), right.next()) {
            (None, None) => return a.cmp(b),
            (None, _) => Ordering::Less,
            (_, None) => Ordering::Greater,
            (Some(left), Some(right)) if is_number(left) && is_number(right) => {
                let [left, right] = [left, right].map(|digits| digits.trim_start_matches('0'));
                left.len().cmp(&right.len()).then_with(|| left.cmp(right))
            }
            (Some(left), Some(right)) => left.cmp(right),
        };
        if order != Ordering::Equal {
            return order;
        }
    }
}

/// The number that counts or times the frame, of each name: that of its numbers which differs from name to
/// name, the last one if several do. None where a name is formed in another way than most, and nowhere if
/// two would have the same.
pub(super) fn moments(names: &[&str]) -> Vec<Option<i128>> {
    let parsed: Vec<Parsed> = names.iter().map(|name| Parsed::of(name)).collect();
    let count = |form: &str| parsed.iter().filter(|parsed| parsed.form == form).count();
    let Some(usual) = parsed.iter().max_by_key(|parsed| count(&parsed.form)) else { return Vec::new() };
    let alike: Vec<&Parsed> = parsed.iter().filter(|parsed| parsed.form == usual.form).collect();
    let column = |index: usize| alike.iter().map(|parsed| parsed.numbers[index]).collect::<Vec<i128>>();
    let is_distinct = |index: &usize| {
        let mut numbers = column(*index);
        numbers.sort_unstable();
        numbers.windows(2).all(|pair| pair[0] != pair[1])
    };
    let chosen = (0..usual.numbers.len()).rev().find(is_distinct);
    let number = |parsed: &Parsed| (parsed.form == usual.form).then(|| chosen.map(|index| parsed.numbers[index]))?;
    parsed.iter().map(number).collect()
}

/// A name's numbers, and what stands around them.
struct Parsed {
    form: String,
    numbers: Vec<i128>,
}

impl Parsed {
    fn of(name: &str) -> Self {
        let (mut form, mut numbers) = (String::new(), Vec::<i128>::new());
        let pieces: Vec<&str> = pieces(name).collect();
        let mut index = 0;
        while let Some(&piece) = pieces.get(index) {
            index += 1;
            // What is longer than any number of frames or nanoseconds is a name.
            let Some(number) = is_number(piece).then(|| piece.parse().ok()).flatten() else {
                form += piece;
                continue;
            };
            form.push('#');
            // Seconds since 1970 and their fraction are one time, in nanoseconds.
            match (pieces.get(index), pieces.get(index + 1)) {
                (Some(&"."), Some(fraction)) if piece.len() >= 9 && fraction.len() <= 9 => {
                    numbers.push(nanoseconds(number, fraction));
                    index += 2;
                }
                (Some(&"_" | &"-"), Some(fraction)) if piece.len() == 10 && fraction.len() == 9 => {
                    numbers.push(nanoseconds(number, fraction));
                    index += 2;
                }
                _ => numbers.push(number),
            }
        }
        Self { form, numbers }
    }
}

fn nanoseconds(seconds: i128, fraction: &str) -> i128 {
    let digits = format!("{fraction:0<9}");
    seconds * 1_000_000_000 + digits.parse::<i128>().unwrap_or(0)
}

/// How names tell the camera.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Scheme {
    /// `left` and `right`.
    Words,
    /// `l` and `r`.
    Letters,
    /// `0` and `1`, at the beginning.
    FirstDigit,
    /// `0` and `1`, at the end.
    LastDigit,
}

impl Scheme {
    pub(super) const ALL: [Self; 4] = [Self::Words, Self::Letters, Self::FirstDigit, Self::LastDigit];

    /// The camera that a name tells, and the name without it.
    pub(super) fn split(self, name: &str) -> Option<(Side, String)> {
        match self {
            Self::Words => split_word(name, ["left", "right"]),
            Self::Letters => split_word(name, ["l", "r"]),
            Self::FirstDigit => split_digit(name, true),
            Self::LastDigit => split_digit(name, false),
        }
    }
}

/// A word between what are no letters.
fn split_word(name: &str, words: [&str; 2]) -> Option<(Side, String)> {
    let mut at = 0;
    for part in name.split_inclusive(|c: char| !c.is_alphabetic()) {
        let word = part.trim_end_matches(|c: char| !c.is_alphabetic());
        for (side, wanted) in [Side::Left, Side::Right].into_iter().zip(words) {
            if word.eq_ignore_ascii_case(wanted) {
                let rest = format!("{}{CAMERA}{}", &name[..at], &name[at + word.len()..]);
                return Some((side, rest));
            }
        }
        at += part.len();
    }
    None
}

/// A single 0 or 1 that is the first or the last number of a name that has more to tell.
fn split_digit(name: &str, first: bool) -> Option<(Side, String)> {
    let pieces: Vec<&str> = pieces(name).collect();
    let mut numbers = (0..pieces.len()).filter(|&index| is_number(pieces[index]));
    let index = if first { numbers.next() } else { numbers.next_back() }?;
    let side = match pieces[index] {
        "0" => Side::Left,
        "1" => Side::Right,
        _ => return None,
    };
    let before = pieces[..index].last().map_or("", |words| words.trim_end_matches(['_', '-', '.', ' ']));
    let noun = before.rsplit(|c: char| !c.is_alphabetic()).next().unwrap_or("").to_lowercase();
    let is_camera = CAMERA_NOUNS.contains(&noun.as_str()) && !(noun.is_empty() && pieces.len() == 1);
    let rest: String = pieces.iter().enumerate().map(|(i, piece)| if i == index { CAMERA } else { piece }).collect();
    // Beginning and end: a number in the midst is something else.
    let is_at_edge = if first { pieces[..index].len() <= 1 } else { pieces[index + 1..].is_empty() };
    (is_camera && is_at_edge).then_some((side, rest))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_ordered_by_value() {
        let mut names = ["10", "9", "a10", "a2", "a02", "a", "b1", "a2b10", "a2b9", "1", "2"];
        names.sort_by(|a, b| natural_order(a, b));
        assert_eq!(names, ["1", "2", "9", "10", "a", "a02", "a2", "a2b9", "a2b10", "a10", "b1"]);
    }

    #[test]
    fn the_number_of_a_frame_is_the_one_that_changes() {
        let cases: [(&[&str], &[Option<i128>]); 9] = [
            (&["left_0003", "left_0010"], &[Some(3), Some(10)]),
            (&["cam0_7_raw", "cam0_8_raw"], &[Some(7), Some(8)]),
            (&["2023-01-05_3", "2023-01-05_4", "notes"], &[Some(3), Some(4), None]),
            (&["1403636579763555584"], &[Some(1_403_636_579_763_555_584)]),
            (&["1403636579.5", "1403636580.25"], &[Some(1_403_636_579_500_000_000), Some(1_403_636_580_250_000_000)]),
            (&["1403636579_000000005"], &[Some(1_403_636_579_000_000_005)]),
            (&["a", "b"], &[None, None]),
            (&["a1", "b1", "a2"], &[Some(1), None, Some(2)]),
            (&["1", "01"], &[None, None]),
        ];
        for (names, wanted) in cases {
            assert_eq!(moments(names), wanted, "{names:?}");
        }
    }

    #[test]
    fn a_name_tells_its_camera_in_several_ways() {
        let cases = [
            (Scheme::Words, "left_01", Some((Side::Left, "*_01"))),
            (Scheme::Words, "01right", Some((Side::Right, "01*"))),
            (Scheme::Words, "frame_Left_7", Some((Side::Left, "frame_*_7"))),
            (Scheme::Words, "leftover_01", None),
            (Scheme::Words, "upright1", None),
            (Scheme::Letters, "l10", Some((Side::Left, "*10"))),
            (Scheme::Letters, "01_R", Some((Side::Right, "01_*"))),
            (Scheme::Letters, "real_01", None),
            (Scheme::FirstDigit, "0_0007", Some((Side::Left, "*_0007"))),
            (Scheme::FirstDigit, "cam1_0007", Some((Side::Right, "cam*_0007"))),
            (Scheme::FirstDigit, "seq1_0007", None),
            (Scheme::FirstDigit, "10_0007", None),
            (Scheme::LastDigit, "0007_1", Some((Side::Right, "0007_*"))),
            (Scheme::LastDigit, "im0", Some((Side::Left, "im*"))),
            (Scheme::LastDigit, "frame_0", None),
            (Scheme::LastDigit, "000007_10", None),
            (Scheme::LastDigit, "0", None),
        ];
        for (scheme, name, wanted) in cases {
            let wanted = wanted.map(|(side, rest)| (side, rest.to_owned()));
            assert_eq!(scheme.split(name), wanted, "{scheme:?}, {name}");
        }
    }
}
