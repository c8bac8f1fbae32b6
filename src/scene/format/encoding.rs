//! Texts and names in the encodings in which other programs write them.

use std::borrow::Cow;

/// A text in a superset of ASCII: UTF-16 with a mark of its byte order becomes UTF-8, anything else stays as it is.
pub fn ascii_based(text: Cow<[u8]>) -> Cow<[u8]> {
    let unit: fn([u8; 2]) -> u16 = match *text {
        [0xFF, 0xFE, ..] => u16::from_le_bytes,
        [0xFE, 0xFF, ..] => u16::from_be_bytes,
        _ => return text,
    };
    let (units, _) = text[2..].as_chunks();
    let mut decoded = String::with_capacity(units.len());
    let characters = char::decode_utf16(units.iter().map(|pair| unit(*pair)));
    decoded.extend(characters.map(|character| character.unwrap_or(char::REPLACEMENT_CHARACTER)));
    Cow::Owned(decoded.into_bytes())
}

/// A name as text: UTF-8, else Latin-1, whose characters are its bytes. So names that differ in any encoding differ here.
pub fn name(bytes: &[u8]) -> String {
    str::from_utf8(bytes).map_or_else(|_| bytes.iter().map(|byte| char::from(*byte)).collect(), str::to_owned)
}

/// Whether a byte is of a character of several bytes: in Shift-JIS and GBK, what follows it may be a backslash that is none.
pub fn is_wide(byte: u8) -> bool {
    byte >= 0x80
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn utf_16_is_decoded_by_its_mark() {
        let text = "v 1 ä\u{1F600}";
        for (mark, bytes) in [([0xFF, 0xFE], u16::to_le_bytes as fn(u16) -> [u8; 2]), ([0xFE, 0xFF], u16::to_be_bytes)]
        {
            let encoded: Vec<u8> = mark.into_iter().chain(text.encode_utf16().flat_map(bytes)).collect();
            assert_eq!(&*ascii_based(encoded.as_slice().into()), text.as_bytes());
            // Half a character at the end, and half a pair.
            assert!(ascii_based(encoded[..encoded.len() - 1].into()).starts_with("v 1 ä".as_bytes()));
            assert!(ascii_based(encoded[..encoded.len() - 2].into()).ends_with("\u{FFFD}".as_bytes()));
        }
        assert_eq!(&*ascii_based(b"\xFF".as_slice().into()), b"\xFF");
    }

    #[test]
    fn names_that_differ_in_bytes_stay_different() {
        let names: [&[u8]; 5] = [b"\xBA\xEC", b"\xC2\xCC", b"\x90\xD4", b"caf\xE9", b"caf\xE8"];
        let texts: std::collections::HashSet<String> = names.iter().map(|bytes| name(bytes)).collect();
        assert_eq!(texts.len(), names.len());
        assert_eq!(name("café".as_bytes()), "café");
        assert_eq!(name(b"caf\xE9"), "café");
    }
}
