//! What is asked of a text before it is parsed: the parser takes time and memory by the square of some counts.

use crate::scene::desc::problem::{At, Outcome, Problem};
use crate::scene::limits::{Limits, exceeded};

/// Most attributes of an element: each is compared with those before it.
const MOST_ATTRIBUTES: usize = 256;
/// Most declarations of namespaces: each copies those around it. A scene needs none.
const MOST_NAMESPACES: usize = 16;

/// Refuses document types, elements too deep within each other, and far too many attributes or namespaces. Other
/// mistakes are left to the parser.
pub fn screen(text: &str, limits: &Limits) -> Outcome<()> {
    if let Some((at, _)) = text.match_indices("xmlns").nth(MOST_NAMESPACES) {
        let message = format!("more than {MOST_NAMESPACES} namespaces; a scene needs none, remove them");
        return Err(Problem::new(At(at), message));
    }
    let bytes = text.as_bytes();
    let (mut at, mut depth) = (0, 0);
    while let Some(start) = find(bytes, at, b"<") {
        let rest = &bytes[start..];
        if rest.starts_with(b"<!--") {
            at = past(bytes, start + 4, b"-->");
        } else if rest.starts_with(b"<![CDATA[") {
            at = past(bytes, start, b"]]>");
        } else if rest.starts_with(b"<?") {
            at = past(bytes, start, b"?>");
        } else if rest.starts_with(b"<!") {
            return Err(Problem::new(At(start), "a DOCTYPE is not allowed in a scene; remove it"));
        } else if rest.starts_with(b"</") {
            depth -= 1;
            at = past(bytes, start, b">");
        } else {
            let (end, attributes) = tag(bytes, start);
            if attributes > MOST_ATTRIBUTES {
                let message = format!("the element has more than {MOST_ATTRIBUTES} attributes");
                return Err(Problem::new(At(start), message));
            }
            if depth >= limits.nesting as i64 {
                let message = format!("levels of nesting: {}", exceeded("nesting", limits.nesting));
                return Err(Problem::new(At(start), message));
            }
            depth += i64::from(!bytes[..end].ends_with(b"/>"));
            at = end;
        }
    }
    Ok(())
}

/// Where the tag that starts at `start` ends, and how many attributes it has.
fn tag(bytes: &[u8], start: usize) -> (usize, usize) {
    let (mut quote, mut attributes) = (None, 0);
    for (i, &byte) in bytes.iter().enumerate().skip(start) {
        match (quote, byte) {
            (Some(open), _) if byte == open => quote = None,
            (None, b'"' | b'\'') => quote = Some(byte),
            (None, b'=') => attributes += 1,
            (None, b'>') => return (i + 1, attributes),
            _ => {}
        }
    }
    (bytes.len(), attributes)
}

/// Where `wanted` is next, from `at` on.
fn find(bytes: &[u8], at: usize, wanted: &[u8]) -> Option<usize> {
    bytes.get(at..)?.windows(wanted.len()).position(|window| window == wanted).map(|offset| at + offset)
}

/// The end of what is wanted, or of the text.
fn past(bytes: &[u8], at: usize, wanted: &[u8]) -> usize {
    find(bytes, at, wanted).map_or(bytes.len(), |found| found + wanted.len())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn refusal(text: &str) -> Option<(usize, String)> {
        screen(text, &Limits { nesting: 3, ..Limits::default() }).err().map(|p| (p.at.0, p.message))
    }

    #[test]
    fn depth_is_that_of_elements() {
        let fits = "<?xml version='1.0'?><a><b x='>'><c/></b><b><!-- <d><d> --><c><![CDATA[<d><d>]]></c></b></a>";
        assert_eq!(refusal(fits), None);
        let (at, message) = refusal("<a><b><c><d/></c></b></a>").unwrap();
        assert!(at == 9 && message.contains("limit nesting of 3"), "{at} {message}");
        assert_eq!(refusal("</a></a><a><"), None);
    }

    #[test]
    fn what_a_scene_does_not_need_is_refused_before_it_costs() {
        let (at, message) = refusal(" <!DOCTYPE a [<!ENTITY b 'c'>]><a>&b;</a>").unwrap();
        assert!(at == 1 && message.contains("DOCTYPE"), "{message}");
        let attributes: String = (0..300).map(|i| format!(" a{i}=''")).collect();
        assert!(refusal(&format!("<a{attributes}/>")).unwrap().1.contains("256 attributes"));
        assert!(refusal(&"<a xmlns:b='c'>".repeat(17)).unwrap().1.contains("16 namespaces"));
    }
}
