//! Two halves of a set of scenes: one to tune on, one to show that it holds elsewhere.
//!
//! Within each family the scenes go by name to A, B, B, A, A, B, B, A and so on. Neighbours in that order are
//! often the same place under another light; the pattern is fixed, so nobody chooses.

use std::collections::BTreeMap;
use std::fmt;

use clap::ValueEnum;

/// One half.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
#[value(rename_all = "UPPER")]
pub enum Half {
    /// To tune on
    A,
    /// To show it on
    B,
}

impl fmt::Display for Half {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::A => "A",
            Self::B => "B",
        })
    }
}

/// The half of each scene, of which name and family are given, in their order.
#[must_use]
pub fn halves(scenes: &[(String, String)]) -> Vec<Half> {
    let mut families: BTreeMap<&str, Vec<&str>> = BTreeMap::new();
    for (name, family) in scenes {
        families.entry(family).or_default().push(name);
    }
    families.values_mut().for_each(|names| names.sort_unstable());
    let place = |(name, family): &(String, String)| families[family.as_str()].partition_point(|other| **other < **name);
    scenes.iter().map(|scene| if matches!(place(scene) % 4, 0 | 3) { Half::A } else { Half::B }).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_family_is_halved_by_name() {
        let scenes = ["f x", "e x", "d x", "c x", "b x", "a x", "z y", "y y", "only z"];
        let scenes = scenes.map(|scene| scene.split_once(' ').unwrap()).map(|(a, b)| (a.to_owned(), b.to_owned()));
        use Half::{A, B};
        assert_eq!(halves(&scenes), [B, A, A, B, B, A, B, A, A]);
    }
}
