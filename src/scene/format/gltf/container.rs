//! Binary glTF (`.glb`): a header and chunks, the first of JSON, the second of bytes.

use super::fault::{Fault, Read};

/// What every binary glTF file starts with.
const MAGIC: &[u8] = b"glTF";
/// The version of the container that is known.
const VERSION: u32 = 2;
const JSON: &[u8] = b"JSON";
const BIN: &[u8] = b"BIN\0";

/// The parts of a file.
#[derive(Clone, Copy, Debug)]
pub struct Container<'a> {
    /// The text.
    pub json: &'a [u8],
    /// The bytes of the buffer that names no file.
    pub bin: Option<&'a [u8]>,
}

/// Takes a file apart; one that does not start as binary glTF is text from end to end.
pub fn open(bytes: &[u8]) -> Read<Container<'_>> {
    let Some(header) = bytes.strip_prefix(MAGIC) else {
        return Ok(Container { json: bytes, bin: None });
    };
    let wrong = |message: String| Fault::new("", format!("not valid binary glTF: {message}"));
    let (Some(version), Some(length)) = (number(header, 0), number(header, 4)) else {
        return Err(wrong(format!("the file ends after {} bytes, within its header", bytes.len())));
    };
    if version != VERSION {
        return Err(wrong(format!("version {version}; expected {VERSION}")));
    }
    let length = usize::try_from(length).unwrap_or(usize::MAX);
    if length > bytes.len() {
        return Err(wrong(format!("the header says {length} bytes, the file has {}; it was cut off", bytes.len())));
    }
    let mut chunks = bytes.get(12..length).unwrap_or_default();
    let Some(Chunk { kind: JSON, contents: json }) = next_chunk(&mut chunks).map_err(wrong)? else {
        return Err(wrong("the first chunk must be of type JSON".to_owned()));
    };
    // Chunks of other types are to be skipped, and only the second may hold the bytes.
    let second = next_chunk(&mut chunks).map_err(wrong)?;
    let bin = second.filter(|chunk| chunk.kind == BIN).map(|chunk| chunk.contents);
    Ok(Container { json, bin })
}

/// A part of a file.
struct Chunk<'a> {
    kind: &'a [u8],
    contents: &'a [u8],
}

/// Splits off the next chunk.
fn next_chunk<'a>(chunks: &mut &'a [u8]) -> Result<Option<Chunk<'a>>, String> {
    if chunks.is_empty() {
        return Ok(None);
    }
    let (Some(length), Some(kind)) = (number(chunks, 0), chunks.get(4..8)) else {
        return Err("the file ends within the header of a chunk".to_owned());
    };
    let contents = &chunks[8..];
    let length = usize::try_from(length).unwrap_or(usize::MAX);
    let Some(own) = contents.get(..length) else {
        return Err(format!("a chunk of {length} bytes has only {} left in the file", contents.len()));
    };
    *chunks = &contents[length..];
    Ok(Some(Chunk { kind, contents: own }))
}

fn number(bytes: &[u8], at: usize) -> Option<u32> {
    Some(u32::from_le_bytes(*bytes.get(at..)?.first_chunk()?))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn file(chunks: &[(&[u8], &[u8])]) -> Vec<u8> {
        let mut body = Vec::new();
        for (kind, contents) in chunks {
            body.extend((contents.len() as u32).to_le_bytes());
            body.extend(*kind);
            body.extend(*contents);
        }
        let length = (body.len() as u32 + 12).to_le_bytes();
        [MAGIC, &VERSION.to_le_bytes(), &length, &body].concat()
    }

    #[test]
    fn chunks_are_found_and_unknown_ones_skipped() {
        let bytes = file(&[(JSON, b"{}  "), (BIN, b"abcd"), (b"XTRA", b"?")]);
        let Container { json, bin } = open(&bytes).unwrap();
        assert_eq!((json, bin), (&b"{}  "[..], Some(&b"abcd"[..])));
        assert_eq!(open(&file(&[(JSON, b"{}")])).unwrap().bin, None);
        assert_eq!(open(b"{}").unwrap().json, b"{}");
    }

    #[test]
    fn every_shortened_file_is_refused_without_a_panic() {
        let bytes = file(&[(JSON, b"{}  "), (BIN, b"abcd")]);
        for length in 4..bytes.len() {
            assert!(open(&bytes[..length]).is_err(), "{length} bytes");
        }
        for wrong in [file(&[(BIN, b"abcd")]), file(&[])] {
            assert!(open(&wrong).unwrap_err().message.contains("first chunk"));
        }
    }
}
