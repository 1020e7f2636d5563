//! Decimal numbers as meters write them, read quickly: there are hundreds of millions of them in a file.

/// So many digits are whole numbers without rounding.
const MOST_DIGITS: usize = 15;
/// Powers of ten that have no rounding either.
const TENS: [f64; MOST_DIGITS + 1] =
    [1e0, 1e1, 1e2, 1e3, 1e4, 1e5, 1e6, 1e7, 1e8, 1e9, 1e10, 1e11, 1e12, 1e13, 1e14, 1e15];

/// The number that `text` is, the nearest there is; `None` if it is none, or not finite.
pub(super) fn number(text: &[u8]) -> Option<f64> {
    plain(text)
        .or_else(|| std::str::from_utf8(text).ok()?.trim().parse().ok().filter(|number: &f64| number.is_finite()))
}

/// Of a sign, some digits and a point only: a quotient of two numbers without rounding is rounded right.
fn plain(text: &[u8]) -> Option<f64> {
    let (is_negative, digits) = match text {
        [b'-', digits @ ..] => (true, digits),
        digits => (false, digits),
    };
    if digits.len() > MOST_DIGITS || digits.is_empty() {
        return None;
    }
    let (mut whole, mut point) = (0_u64, None);
    for (at, &byte) in digits.iter().enumerate() {
        match byte {
            b'0'..=b'9' => whole = 10 * whole + u64::from(byte - b'0'),
            b'.' if point.is_none() && digits.len() > 1 => point = Some(at),
            _ => return None,
        }
    }
    let decimals = point.map_or(0, |at| digits.len() - 1 - at);
    let number = whole as f64 / TENS[decimals];
    Some(if is_negative { -number } else { number })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_those_that_the_standard_library_reads() {
        let texts = [
            "0",
            "-0.0",
            "1",
            "12.5",
            "1234567.25",
            "0.1",
            "0.3",
            "-17.003",
            "599999.99",
            "20123.456",
            "123456789012345",
            "1234567890123456789",
            "0.000000000000001",
            "1e3",
            "-2.5E-4",
            " 7.5 ",
            "+4",
            ".5",
            "5.",
        ];
        for text in texts {
            assert_eq!(
                number(text.as_bytes()).map(f64::to_bits),
                text.trim().parse::<f64>().ok().map(f64::to_bits),
                "{text}"
            );
        }
        let mut state = 1_u64;
        for _ in 0..20_000 {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            let text = format!("{}.{:03}", (state >> 40) % 10_000_000, (state >> 20) % 1000);
            assert_eq!(plain(text.as_bytes()), text.parse().ok(), "{text}");
        }
        for text in ["", "-", ".", "1.2.3", "x", "1,5", "NaN", "inf", "--1", "0x1"] {
            assert_eq!(number(text.as_bytes()), None, "{text}");
        }
    }
}
