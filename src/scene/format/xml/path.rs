//! The places of positions in a document: line, column and an XPath.

use crate::scene::desc::map::shortened;
use crate::scene::desc::problem::At;
use crate::scene::error::Place;
use crate::scene::format::place::by_line;
use roxmltree::{Document, Node};
use std::path::Path;

/// The places of positions.
pub fn places(file: &Path, document: &Document, positions: &[At]) -> Vec<Place> {
    let places = by_line(file, document.input_text().as_bytes(), positions).into_iter();
    places.zip(positions).map(|(place, at)| Place { pointer: pointer(document.root(), at.0), ..place }).collect()
}

/// The XPath of the innermost element or attribute around a position.
fn pointer(mut node: Node, at: usize) -> String {
    let mut pointer = String::new();
    while let Some(child) = node.children().find(|c| c.is_element() && c.range().contains(&at)) {
        pointer.push('/');
        pointer.push_str(&segment(child));
        node = child;
    }
    if let Some(attribute) = node.attributes().find(|a| a.range().contains(&at)) {
        pointer.push_str("/@");
        pointer.push_str(&shortened(attribute.name()));
    }
    pointer
}

/// An element's name, and what tells it from others of that name around it: its `id`, else its number from 1.
fn segment(element: Node) -> String {
    let name = shortened(element.tag_name().name());
    if let Some(id) = element.attribute("id") {
        return format!("{name}[@id='{}']", shortened(id));
    }
    let is_alike = |other: &Node| other.is_element() && other.tag_name() == element.tag_name();
    let before = element.prev_siblings().skip(1).filter(is_alike).count();
    match before > 0 || element.next_siblings().skip(1).any(|other| is_alike(&other)) {
        true => format!("{name}[{}]", before + 1),
        false => name,
    }
}
