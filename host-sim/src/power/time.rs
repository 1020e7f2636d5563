//! Times in tables: seconds, or a date.

use super::decimal;

/// Seconds of a number, or of a date as `2026-11-26T12:34:56.789Z` since 1970; only differences count.
pub(super) fn seconds(text: &[u8]) -> Option<f64> {
    decimal::number(text).or_else(|| of_date(std::str::from_utf8(text).ok()?.trim()))
}

fn of_date(text: &str) -> Option<f64> {
    let (date, time) = text.trim_end_matches('Z').split_once(['T', ' '])?;
    let mut date = date.splitn(3, '-').map(|number| number.parse::<i64>().ok());
    let (year, month, day) = (date.next()??, date.next()??, date.next()??);
    let mut time = time.splitn(3, ':').map(|number| number.parse::<f64>().ok());
    let (hour, minute, second) = (time.next()??, time.next()??, time.next()??);
    let is_right =
        (1..=12).contains(&month) && (1..=31).contains(&day) && hour < 24.0 && minute < 60.0 && second < 61.0;
    let seconds = days(year, month, day) as f64 * 86_400.0 + hour * 3600.0 + minute * 60.0 + second;
    (is_right && hour >= 0.0 && minute >= 0.0 && second >= 0.0).then_some(seconds)
}

/// Days since 1970, by the Gregorian calendar whose year begins in March.
fn days(year: i64, month: i64, day: i64) -> i64 {
    let year = if month > 2 { year } else { year - 1 };
    let day_of_year = (153 * ((month + 9) % 12) + 2) / 5 + day - 1;
    year * 365 + year.div_euclid(4) - year.div_euclid(100) + year.div_euclid(400) + day_of_year - 719_468
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn dates_and_numbers_are_seconds() {
        assert_eq!(seconds(b"12.5"), Some(12.5));
        assert_eq!(seconds(b"1970-01-01T00:00:00Z"), Some(0.0));
        assert_eq!(seconds(b"2000-03-01 00:00:01.5"), Some(951_868_801.5));
        let across = ["2024-02-28T23:59:59Z", "2024-02-29T00:00:00Z", "2024-03-01T00:00:00Z"]
            .map(|t| seconds(t.as_bytes()).unwrap());
        assert_eq!([across[1] - across[0], across[2] - across[1]], [1.0, 86_400.0]);
        for text in ["", "soon", "NaN", "inf", "2024-13-01T00:00:00Z", "2024-01-01", "2024-01-01T25:00:00Z"] {
            assert_eq!(seconds(text.as_bytes()), None, "{text}");
        }
    }
}
