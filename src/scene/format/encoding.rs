//! Encodings of text files: UTF-8, with or without its mark, and UTF-16.

use std::borrow::Cow;

/// A text in UTF-8, without a byte order mark, from UTF-16 if that is what it is in. Bytes that are neither stay as they are.
pub fn as_utf8(bytes: &[u8]) -> Cow<'_, [u8]> {
    match bytes {
        [0xEF, 0xBB, 0xBF, rest @ ..] => Cow::Borrowed(rest),
        [0xFF, 0xFE, rest @ ..] => Cow::Owned(decoded(rest, u16::from_le_bytes)),
        [0xFE, 0xFF, rest @ ..] => Cow::Owned(decoded(rest, u16::from_be_bytes)),
        // Without its mark, a text that starts with two characters of ASCII.
        [1..=255, 0, 1..=255, 0, ..] => Cow::Owned(decoded(bytes, u16::from_le_bytes)),
        [0, 1..=255, 0, 1..=255, ..] => Cow::Owned(decoded(bytes, u16::from_be_bytes)),
        _ => Cow::Borrowed(bytes),
    }
}

fn decoded(bytes: &[u8], unit: fn([u8; 2]) -> u16) -> Vec<u8> {
    let units = bytes.as_chunks::<2>().0.iter().map(|&pair| unit(pair));
    let characters = char::decode_utf16(units).map(|character| character.unwrap_or(char::REPLACEMENT_CHARACTER));
    characters.collect::<String>().into_bytes()
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
    fn every_encoding_gives_the_same_text() {
        let text = "{ \"é\": \"𝄞\" }";
        let units = || text.encode_utf16();
        let little: Vec<u8> = units().flat_map(u16::to_le_bytes).collect();
        let big: Vec<u8> = units().flat_map(u16::to_be_bytes).collect();
        for bytes in [
            text.as_bytes().to_vec(),
            [b"\xEF\xBB\xBF", text.as_bytes()].concat(),
            [b"\xFF\xFE", &little[..]].concat(),
            [b"\xFE\xFF", &big[..]].concat(),
            little,
            big,
        ] {
            assert_eq!(as_utf8(&bytes), text.as_bytes());
        }
        assert_eq!(&*as_utf8(b"\xFF\xFE{"), b"");
        assert_eq!(&*as_utf8(b"\xE9\x80"), b"\xE9\x80");
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
