//! Numbers as charts and pages write them.

/// About three significant digits, without an exponent where that is short.
pub fn short(value: f64) -> String {
    let magnitude = value.abs();
    if value == 0.0 {
        return "0".to_owned();
    }
    if !(1e-4..1e7).contains(&magnitude) {
        let text = format!("{value:.2e}");
        return match text.split_once('e') {
            Some((digits, exponent)) => format!("{}e{exponent}", trimmed(digits)),
            None => text,
        };
    }
    // Digits behind the point that make three in all, counted from the leading digit.
    let behind = (2 - libm::floor(libm::log10(magnitude)) as i32).max(0) as usize;
    let text = format!("{value:.behind$}");
    let text = if behind > 0 { trimmed(&text) } else { &text };
    grouped(text)
}

fn trimmed(digits: &str) -> &str {
    if digits.contains('.') { digits.trim_end_matches('0').trim_end_matches('.') } else { digits }
}

/// Thousands set apart by thin spaces, from five digits on.
fn grouped(text: &str) -> String {
    let digits = text.trim_start_matches('-');
    if digits.contains('.') || digits.len() < 5 {
        return text.to_owned();
    }
    let mut grouped = String::new();
    for (i, digit) in digits.chars().enumerate() {
        if i > 0 && (digits.len() - i).is_multiple_of(3) {
            grouped.push('\u{202f}');
        }
        grouped.push(digit);
    }
    if text.starts_with('-') { format!("-{grouped}") } else { grouped }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn three_digits_and_no_more() {
        for (value, text) in [
            (0.0, "0"),
            (0.05, "0.05"),
            (1.0, "1"),
            (1.234, "1.23"),
            (12.34, "12.3"),
            (123.4, "123"),
            (1234.0, "1234"),
            (0.000_01, "1e-5"),
            (3e7, "3e7"),
            (-2.5, "-2.5"),
        ] {
            assert_eq!(short(value), text);
        }
        assert_eq!(short(123_456.0), "123\u{202f}456");
    }
}
