//! The text of a file: its encoding, and tokens that some writers put into it that are not JSON.

use super::fault::Notes;
use crate::scene::format::encoding::as_utf8;
use std::borrow::Cow;

/// The text in UTF-8, without what pads it.
pub fn read<'a>(bytes: &'a [u8], notes: &mut Notes) -> Cow<'a, [u8]> {
    let text = as_utf8(bytes);
    // Chunks are padded with blanks; some writers take zeros.
    let length = text.iter().rposition(|byte| *byte != 0).map_or(0, |last| last + 1);
    let text = match text {
        Cow::Borrowed(text) => Cow::Borrowed(&text[..length]),
        Cow::Owned(mut text) => {
            text.truncate(length);
            Cow::Owned(text)
        }
    };
    if std::str::from_utf8(&text).is_ok() {
        return text;
    }
    notes.add("", "the text is not UTF-8; characters that are not known are shown as \u{FFFD}");
    Cow::Owned(String::from_utf8_lossy(&text).into_owned().into_bytes())
}

/// The text with `null` for tokens that are not JSON: `NaN`, `Infinity` and the like, numbers beyond all bounds; within
/// strings with `\uFFFD` for halves of characters, a backslash for one that escapes nothing, as paths have them, and blanks
/// for control characters. `None` where it has none of them.
pub fn tamed(text: &str) -> Option<String> {
    let bytes = text.as_bytes();
    let mut tamed = String::new();
    // What is copied so far, and where it is read.
    let (mut copied, mut at) = (0, 0);
    let mut in_string = false;
    while let Some(byte) = bytes.get(at) {
        let rest = &bytes[at..];
        let (length, instead) = match byte {
            b'"' => {
                in_string = !in_string;
                (1, None)
            }
            b'\\' if in_string => escape(rest),
            0..b' ' if in_string => (1, Some(" ")),
            _ if in_string => (1, None),
            b'-' | b'+' | b'.' | b'0'..=b'9' | b'a'..=b'z' | b'A'..=b'Z' => word(rest),
            _ => (1, None),
        };
        if let Some(instead) = instead {
            tamed += &text[copied..at];
            tamed += instead;
            copied = at + length;
        }
        at += length;
    }
    (copied > 0).then(|| tamed + &text[copied..])
}

/// An escape within a string: its length, and what is put in its place.
fn escape(rest: &[u8]) -> (usize, Option<&'static str>) {
    let unit = |at: usize| {
        let digits = rest.get(at..)?.strip_prefix(br"\u")?.first_chunk::<4>()?;
        digits.iter().all(u8::is_ascii_hexdigit).then_some(())?;
        u16::from_str_radix(std::str::from_utf8(digits).ok()?, 16).ok()
    };
    match (unit(0), unit(6)) {
        (Some(0xD800..=0xDBFF), Some(0xDC00..=0xDFFF)) => (12, None),
        (Some(0xD800..=0xDFFF), _) => (6, Some(r"\uFFFD")),
        (Some(_), _) => (6, None),
        (None, _) if rest.get(1).is_some_and(|escaped| br#""\/bfnrt"#.contains(escaped)) => (2, None),
        (None, _) => (1, Some(r"\\")),
    }
}

/// A number or a name: its length, and what is put in its place.
fn word(rest: &[u8]) -> (usize, Option<&'static str>) {
    let is_inside = |byte: &u8| byte.is_ascii_alphanumeric() || b"-+.#()".contains(byte);
    let length = rest.iter().position(|byte| !is_inside(byte)).unwrap_or(rest.len());
    let Ok(word) = std::str::from_utf8(&rest[..length]) else { return (length, None) };
    let is_number = word.parse::<f64>().is_ok_and(f64::is_finite);
    let is_known = is_number || matches!(word, "true" | "false" | "null");
    let is_odd = word.parse::<f64>().is_ok() || word.contains("nan(") || word.contains('#');
    (length, (!is_known && is_odd).then_some("null"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tokens_that_are_no_json_become_null() {
        let tamed = |text| tamed(text);
        let odd = r#"{ "NaN": [NaN, -nan, -nan(ind), Infinity, -Infinity, 1.#INF, 1e999, 1.5e3, true, null] }"#;
        let plain = r#"{ "NaN": [null, null, null, null, null, null, null, 1.5e3, true, null] }"#;
        assert_eq!(tamed(odd).as_deref(), Some(plain));
        assert_eq!(tamed(plain), None);
        assert_eq!(
            tamed(r#""a\"NaN\ud83d\ude00\ud83d x\ude00""#).as_deref(),
            Some(r#""a\"NaN\ud83d\ude00\uFFFD x\uFFFD""#)
        );
        assert_eq!(tamed("\"textures\\wood\\é\\u00\tx\\n\"").as_deref(), Some(r#""textures\\wood\\é\\u00 x\n""#));
        assert_eq!(tamed(r#""é\"#).as_deref(), Some(r#""é\\"#));
        assert_eq!(tamed("é nano"), None);
    }

    #[test]
    fn padding_and_odd_characters_cost_nothing_else() {
        let mut notes = Notes::default();
        assert_eq!(&*read(b"{} \0\0", &mut notes), b"{} ");
        assert_eq!(&*read(b"\0\0", &mut notes), b"");
        assert_eq!(&*read(b"{\"\xE9\": 1}", &mut notes), "{\"\u{FFFD}\": 1}".as_bytes());
    }
}
