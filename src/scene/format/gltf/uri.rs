//! What the `uri` of a buffer or an image says: a file beside the scene, or the bytes themselves.

use base64::Engine;
use base64::alphabet;
use base64::engine::{DecodePaddingMode, GeneralPurpose, GeneralPurposeConfig};
use std::borrow::Cow;

/// Where a URI leads.
#[derive(Debug, PartialEq)]
pub enum Target<'a> {
    /// To a file, relative to the scene's folder.
    File(Cow<'a, str>),
    /// To these bytes.
    Bytes(Vec<u8>),
}

/// Some writers leave out the padding at the end.
const BASE64: GeneralPurpose = GeneralPurpose::new(
    &alphabet::STANDARD,
    GeneralPurposeConfig::new().with_decode_padding_mode(DecodePaddingMode::Indifferent),
);

/// Reads a URI; the error says what is wrong with it.
pub fn read(uri: &str) -> Result<Target<'_>, String> {
    if uri.get(..5).is_some_and(|scheme| scheme.eq_ignore_ascii_case("data:")) {
        return data(&uri[5..]).map(Target::Bytes);
    }
    // A single letter before the colon is a drive, which the scene's files refuse as an absolute path.
    let scheme = uri.split_once(':').map(|(scheme, _)| scheme);
    if let Some(scheme) = scheme.filter(|s| s.len() > 1 && s.bytes().all(|b| b.is_ascii_alphanumeric() || b == b'+')) {
        return Err(format!("{scheme}: addresses are not followed; put the file into the scene's folder"));
    }
    percent_decoded(uri).map(Target::File)
}

/// The bytes of a data URI, without its `data:`.
fn data(rest: &str) -> Result<Vec<u8>, String> {
    let Some((kind, contents)) = rest.split_once(',') else {
        return Err("the data URI has no comma before its data".to_owned());
    };
    if kind.to_ascii_lowercase().ends_with(";base64") {
        let contents = percent_decoded(contents)?;
        return BASE64.decode(contents.as_bytes()).map_err(|error| format!("the data URI is not base64: {error}"));
    }
    Ok(percent_bytes(contents).into_owned())
}

fn percent_decoded(text: &str) -> Result<Cow<'_, str>, String> {
    match percent_bytes(text) {
        Cow::Borrowed(_) => Ok(Cow::Borrowed(text)),
        Cow::Owned(bytes) => match String::from_utf8(bytes) {
            Ok(text) => Ok(Cow::Owned(text)),
            Err(_) => Err("the URI's percent codes are not UTF-8".to_owned()),
        },
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
        let file = |uri| match read(uri) {
            Ok(Target::File(name)) => name.into_owned(),
            other => panic!("{uri}: {other:?}"),
        };
        assert_eq!(file("a%20b.png"), "a b.png");
        assert_eq!(file("100%.png"), "100%.png");
        assert_eq!(file("%2e%2e%2fx"), "../x");
        assert_eq!(file("%+1%é%"), "%+1%é%");
        for odd in ["%FF", "http://a/b.bin", "file:///etc/passwd"] {
            assert!(read(odd).is_err(), "{odd}");
        }
    }

    #[test]
    fn data_is_decoded_with_and_without_padding() {
        for uri in ["data:application/octet-stream;base64,AAEC/w==", "DATA:;base64,AAEC/w", "data:,%00%01%02%FF"] {
            assert_eq!(read(uri), Ok(Target::Bytes(vec![0, 1, 2, 255])), "{uri}");
        }
        for wrong in ["data:", "data:;base64", "data:;base64,A*", "data:;base64,A"] {
            assert!(read(wrong).is_err(), "{wrong}");
        }
    }
}
