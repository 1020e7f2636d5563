//! Which views belong together: never by their place in the order, so that a lost frame shifts nothing.

use std::collections::HashMap;

use anyhow::{Result, ensure};

use super::names;
use super::views::View;

/// Numbers that are closer than this count frames. Then only the same number is the same moment; times may be
/// read a little apart.
const LEAST_PERIOD: i128 = 8;

/// The views of one moment, one of which may be missing.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Moment {
    pub(super) left: Option<View>,
    pub(super) right: Option<View>,
}

impl Moment {
    fn any(&self) -> Option<&View> {
        self.left.as_ref().or(self.right.as_ref())
    }
}

/// Pairs the views: those of the same name, then those of the same number or of the nearest time within half
/// a period. What is left over stays alone. All in the order of their numbers, else of their names.
///
/// # Errors
/// If not a single pair comes about.
pub(super) fn pair(left: Vec<View>, right: Vec<View>) -> Result<Vec<Moment>> {
    let partners = partners(&left, &right);
    ensure!(
        partners.iter().any(Option::is_some) || left.is_empty() || right.is_empty(),
        "no name or number of the {} left views is one of the {} right ones, as {} and {}: nothing tells which belong \
         together",
        left.len(),
        right.len(),
        left[0].file(),
        right[0].file()
    );
    let mut right: Vec<Option<View>> = right.into_iter().map(Some).collect();
    let mut moments: Vec<Moment> = left
        .into_iter()
        .zip(partners)
        .map(|(left, partner)| Moment { left: Some(left), right: partner.and_then(|index| right[index].take()) })
        .collect();
    moments.extend(right.into_iter().flatten().map(|view| Moment { left: None, right: Some(view) }));
    moments.sort_by(|a, b| match (a.any(), b.any()) {
        (Some(a), Some(b)) => {
            let by_number = (a.moment.is_none(), a.moment).cmp(&(b.moment.is_none(), b.moment));
            by_number.then_with(|| names::natural_order(&a.key, &b.key))
        }
        _ => std::cmp::Ordering::Equal,
    });
    Ok(moments)
}

/// For each left view the index of its right one.
fn partners(left: &[View], right: &[View]) -> Vec<Option<usize>> {
    if let ([one], [other]) = (left, right) {
        // Nothing contradicts.
        let belong = one.key == other.key || one.moment == other.moment;
        return vec![belong.then_some(0)];
    }
    let by_key: HashMap<&str, usize> = right.iter().enumerate().map(|(i, view)| (view.key.as_str(), i)).collect();
    let by_number: HashMap<i128, usize> =
        right.iter().enumerate().filter_map(|(i, view)| Some((view.moment?, i))).collect();
    let mut taken = vec![false; right.len()];
    let mut found: Vec<Option<usize>> = left.iter().map(|view| by_key.get(view.key.as_str()).copied()).collect();
    found.iter().flatten().for_each(|&index| taken[index] = true);
    for (view, partner) in left.iter().zip(&mut found).filter(|(_, partner)| partner.is_none()) {
        *partner = view.moment.and_then(|moment| by_number.get(&moment).copied()).filter(|&index| !taken[index]);
        partner.iter().for_each(|&index| taken[index] = true);
    }
    if let Some(period) = [left, right].into_iter().filter_map(period).min().filter(|&period| period >= LEAST_PERIOD) {
        pair_nearest([left, right], period, &mut found, &mut taken);
    }
    found
}

/// Pairs what is left over by time: two that are each other's nearest, less than half a period apart.
fn pair_nearest([left, right]: [&[View]; 2], period: i128, found: &mut [Option<usize>], taken: &mut [bool]) {
    let open = |views: &[View], is_open: &dyn Fn(usize) -> bool| {
        let times = views.iter().enumerate().filter(|(index, _)| is_open(*index));
        let mut times: Vec<(i128, usize)> = times.filter_map(|(index, view)| Some((view.moment?, index))).collect();
        times.sort_unstable();
        times
    };
    let lefts = open(left, &|index| found[index].is_none());
    let rights = open(right, &|index| !taken[index]);
    for &(time, index) in &lefts {
        let Some((other, partner)) = nearest(&rights, time) else { return };
        let is_mutual = nearest(&lefts, other) == Some((time, index));
        if is_mutual && 2 * (time - other).abs() < period {
            found[index] = Some(partner);
            taken[partner] = true;
        }
    }
}

fn nearest(sorted: &[(i128, usize)], time: i128) -> Option<(i128, usize)> {
    let at = sorted.partition_point(|&(other, _)| other < time);
    let around = [at.checked_sub(1), Some(at)].into_iter().flatten().filter_map(|index| sorted.get(index).copied());
    around.min_by_key(|&(other, _)| (other - time).abs())
}

/// The usual step from view to view: the median.
fn period(views: &[View]) -> Option<i128> {
    let mut moments: Vec<i128> = views.iter().filter_map(|view| view.moment).collect();
    moments.sort_unstable();
    let mut steps: Vec<i128> = moments.windows(2).map(|pair| pair[1] - pair[0]).collect();
    steps.sort_unstable();
    steps.get(steps.len() / 2).copied()
}

#[cfg(test)]
mod tests {
    use super::super::views::of_names;
    use super::*;

    fn paired(left: &[&str], right: &[&str]) -> Result<Vec<String>> {
        let text = |view: Option<View>| view.map_or_else(|| "-".to_owned(), |view| view.key);
        let moments = pair(of_names(left), of_names(right))?;
        Ok(moments.into_iter().map(|moment| format!("{} {}", text(moment.left), text(moment.right))).collect())
    }

    #[test]
    fn views_pair_by_name_or_number_and_a_lone_one_stays_alone() {
        let cases: [(&[&str], &[&str], &[&str]); 9] = [
            (&["a", "b", "d"], &["b", "c", "d"], &["a -", "b b", "- c", "d d"]),
            (&["a"], &[], &["a -"]),
            (&["l1", "l10", "l2"], &["r001", "r002", "r010"], &["l1 r001", "l2 r002", "l10 r010"]),
            (&["1", "10", "11", "2", "9"], &["1", "10", "11", "2", "9"], &["1 1", "2 2", "9 9", "10 10", "11 11"]),
            (
                &["left_0001", "left_0002", "left_0003", "left_0005"],
                &["right_0001", "right_0002", "right_0004", "right_0005"],
                &[
                    "left_0001 right_0001",
                    "left_0002 right_0002",
                    "left_0003 -",
                    "- right_0004",
                    "left_0005 right_0005",
                ],
            ),
            (
                &["1000000000", "1000000033", "1000000066", "1000000100"],
                &["1000000003", "1000000063", "1000000117", "1000000131"],
                &[
                    "1000000000 1000000003",
                    "1000000033 -",
                    "1000000066 1000000063",
                    "1000000100 -",
                    "- 1000000117",
                    "- 1000000131",
                ],
            ),
            (&["0", "1", "2"], &["1", "2", "3"], &["0 -", "1 1", "2 2", "- 3"]),
            (&["view"], &["scene"], &["view scene"]),
            (&["a7"], &["b7"], &["a7 b7"]),
        ];
        for (left, right, wanted) in cases {
            assert_eq!(paired(left, right).unwrap(), wanted, "{left:?}, {right:?}");
        }
    }

    #[test]
    fn views_that_nothing_pairs_are_refused() {
        let cases: [(&[&str], &[&str]); 5] = [
            (&["a", "b"], &["c", "d"]),
            (&["1", "3", "5"], &["2", "4", "6"]),
            (&["l1", "l2"], &["r3", "r4"]),
            (&["left1"], &["right2"]),
            (&["1", "9"], &["5", "13"]),
        ];
        for (left, right) in cases {
            assert!(paired(left, right).is_err(), "{left:?}, {right:?}");
        }
    }
}
