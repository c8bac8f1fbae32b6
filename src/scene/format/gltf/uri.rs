//! What the `uri` of a buffer or an image says: a file beside the scene, or the bytes themselves.

use base64::Engine;
use base64::alphabet;
use base64::engine::{DecodePaddingMode, GeneralPurpose, GeneralPurposeConfig};
use std::borrow::Cow;

/// Where a URI leads.
#[derive(Debug, PartialEq)]
pub enum Target {
    /// To a file, relative to the scene's folder: names that the URI may stand for, the likeliest first, at least one.
    File(Vec<String>),
    /// To these bytes.
    Bytes(Vec<u8>),
}

/// Some writers leave out the padding at the end.
const BASE64: GeneralPurpose = GeneralPurpose::new(
    &alphabet::STANDARD,
    GeneralPurposeConfig::new().with_decode_padding_mode(DecodePaddingMode::Indifferent),
);

/// Reads a URI; the error says what is wrong with it.
pub fn read(uri: &str) -> Result<Target, String> {
    let uri = uri.trim();
    if uri.get(..5).is_some_and(|scheme| scheme.eq_ignore_ascii_case("data:")) {
        return data(&uri[5..]).map(Target::Bytes);
    }
    // A single letter before the colon is a drive; of paths on other machines what lies beside the scene is found.
    let scheme = uri.split_once(':').map(|(scheme, _)| scheme).filter(|scheme| !scheme.eq_ignore_ascii_case("file"));
    if let Some(scheme) = scheme.filter(|s| s.len() > 1 && s.bytes().all(|b| b.is_ascii_alphanumeric() || b == b'+')) {
        return Err(format!("{scheme}: addresses are not followed; put the file into the scene's folder"));
    }
    // As a URI; as the plain name that it should not be; without what is no part of a file's name.
    let path = uri.split(['?', '#']).next().unwrap_or_default();
    let mut names = Vec::new();
    for name in [percent_decoded(uri), Some(Cow::Borrowed(uri)), percent_decoded(path), Some(Cow::Borrowed(path))] {
        if let Some(name) = name.filter(|name| !name.is_empty())
            && !names.iter().any(|known| *known == name)
        {
            names.push(name.into_owned());
        }
    }
    if names.is_empty() { Err("the URI is empty".to_owned()) } else { Ok(Target::File(names)) }
}

/// The bytes of a data URI, without its `data:`.
fn data(rest: &str) -> Result<Vec<u8>, String> {
    let Some((kind, contents)) = rest.split_once(',') else {
        return Err("the data URI has no comma before its data".to_owned());
    };
    if !kind.split(';').skip(1).any(|part| part.trim().eq_ignore_ascii_case("base64")) {
        return Ok(percent_bytes(contents).into_owned());
    }
    let mut encoded = percent_bytes(contents);
    // Lines are broken, and there is an alphabet for names of files.
    if encoded.iter().any(|byte| byte.is_ascii_whitespace() || matches!(byte, b'-' | b'_')) {
        let plain = |byte: &u8| match byte {
            b'-' => b'+',
            b'_' => b'/',
            other => *other,
        };
        encoded = encoded.iter().filter(|byte| !byte.is_ascii_whitespace()).map(plain).collect();
    }
    BASE64.decode(&encoded).map_err(|error| format!("the data URI is not base64: {error}"))
}

/// The text that percent codes stand for; `None` where it is not UTF-8.
fn percent_decoded(text: &str) -> Option<Cow<'_, str>> {
    match percent_bytes(text) {
        Cow::Borrowed(_) => Some(Cow::Borrowed(text)),
        Cow::Owned(bytes) => String::from_utf8(bytes).ok().map(Cow::Owned),
    }
}

/// A percent sign that no two digits follow stands for itself: file names hold such.
fn percent_bytes(text: &str) -> Cow<'_, [u8]> {
    if !text.contains('%') {
        return Cow::Borrowed(text.as_bytes());
    }
    let mut decoded = Vec::with_capacity(text.len());
    let mut rest = text.as_bytes();
    while let [first, after @ ..] = rest {
        let digits = (*first == b'%').then(|| after.first_chunk::<2>()).flatten();
        let digits = digits.filter(|digits| digits.iter().all(u8::is_ascii_hexdigit));
        let byte = digits.and_then(|digits| u8::from_str_radix(std::str::from_utf8(digits).ok()?, 16).ok());
        decoded.push(byte.unwrap_or(*first));
        rest = if byte.is_some() { &after[2..] } else { after };
    }
    Cow::Owned(decoded)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_decoded_and_odd_ones_do_no_harm() {
        let names = |uri| match read(uri) {
            Ok(Target::File(names)) => names,
            other => panic!("{uri}: {other:?}"),
        };
        assert_eq!(names("a%20b.png"), ["a b.png", "a%20b.png"]);
        assert_eq!(names("100%.png"), ["100%.png"]);
        assert_eq!(names("%2e%2e%2fx"), ["../x", "%2e%2e%2fx"]);
        assert_eq!(names("%+1%é%"), ["%+1%é%"]);
        assert_eq!(names("%FF"), ["%FF"]);
        assert_eq!(names("a%20b.png?v=3#4"), ["a b.png?v=3#4", "a%20b.png?v=3#4", "a b.png", "a%20b.png"]);
        assert_eq!(names(" a#b.png\n"), ["a#b.png", "a"]);
        assert_eq!(names(r"C:\a.png"), [r"C:\a.png"]);
        assert_eq!(names("file:///C:/a.png"), ["file:///C:/a.png"]);
        for odd in ["http://a/b.bin", "", " "] {
            assert!(read(odd).is_err(), "{odd}");
        }
    }

    #[test]
    fn data_is_decoded_with_and_without_padding() {
        for uri in [
            "data:application/octet-stream;base64,AAEC/w==",
            "DATA:;base64,AAEC/w",
            "data:,%00%01%02%FF",
            "data:image/png;charset=utf-8;BASE64, AAE\n C_w==\r\n",
            "data:image/png;base64;charset=utf-8,AAEC%2Fw%3D%3D",
        ] {
            assert_eq!(read(uri), Ok(Target::Bytes(vec![0, 1, 2, 255])), "{uri}");
        }
        for wrong in ["data:", "data:;base64", "data:;base64,A*", "data:;base64,A"] {
            assert!(read(wrong).is_err(), "{wrong}");
        }
    }
}
