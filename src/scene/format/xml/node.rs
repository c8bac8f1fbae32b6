//! Elements and attributes as the values of a scene's tree.

use super::value::Value;
use crate::scene::desc::map::shortened;
use crate::scene::desc::node::{Field, Kind, Node};
use crate::scene::desc::problem::{At, Outcome, Problem};
use roxmltree::{Attribute, NodeType};
use std::borrow::Cow;
use std::collections::HashSet;

type Element<'t> = roxmltree::Node<'t, 't>;

/// A value of the tree.
#[derive(Clone, Copy)]
pub enum Xml<'t> {
    /// An element, and how it was come by.
    Element(Element<'t>, Role),
    /// The text of an attribute or of an element, or a part of it.
    Text(Value<'t>),
}

/// How an element was come by, which tells what its name and its `id` mean.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Role {
    /// By its name.
    Named,
    /// By its `id`.
    Entry,
    /// As one of a list: its name is its type.
    Item,
}

impl<'t> Xml<'t> {
    /// The outermost value.
    pub fn root(element: Element<'t>) -> Self {
        Self::Element(element, Role::Named)
    }

    /// The text of a value that is nothing but text.
    fn value(self) -> Option<Value<'t>> {
        match self {
            Self::Text(value) => Some(value),
            Self::Element(element, _) => {
                let mut children = element.children().filter(|child| child.is_text());
                let only = children.next().filter(|_| children.next().is_none())?;
                let is_plain = element.attributes().all(|a| is_comment(&a)) && elements(element).next().is_none();
                is_plain.then(|| text_of(only))
            }
        }
    }

    fn scalar<T>(self, expected: &str, read: impl Fn(Value<'t>) -> Option<T>) -> Outcome<T> {
        self.value().and_then(read).ok_or_else(|| self.mismatch(expected))
    }
}

impl<'t> Node<'t> for Xml<'t> {
    fn at(self) -> At {
        match self {
            Self::Element(element, _) => At(element.range().start),
            Self::Text(value) => value.at,
        }
    }

    fn kind(self) -> Kind {
        // A list of elements shows as such only where it is asked for.
        self.value().map_or(Kind::Map, Value::kind)
    }

    fn fields(self) -> Outcome<Vec<Field<'t, Self>>> {
        let Self::Element(element, role) = self else { return Err(self.mismatch("an element")) };
        only_blanks(element)?;
        let mut fields = Vec::new();
        if role == Role::Item {
            let at = name_at(element);
            let name = Value { text: element.tag_name().name(), at, verbatim: true };
            fields.push(Field { key: Cow::Borrowed("type"), at, value: Self::Text(name) });
        }
        let is_own = |a: &Attribute| a.namespace().is_none() && !(role == Role::Entry && a.name() == "id");
        fields.extend(element.attributes().filter(is_own).map(|attribute| Field {
            key: Cow::Borrowed(attribute.name()),
            at: At(attribute.range().start),
            value: Self::Text(value_of(attribute)),
        }));
        fields.extend(elements(element).map(|child| Field {
            key: Cow::Borrowed(child.tag_name().name()),
            at: name_at(child),
            value: Self::Element(child, Role::Named),
        }));
        unique(fields)
    }

    fn named_fields(self) -> Outcome<Vec<Field<'t, Self>>> {
        let Self::Element(element, _) = self else { return Err(self.mismatch("an element")) };
        only_blanks(element)?;
        no_attributes(element)?;
        // `materials` holds `material`s.
        let plural = element.tag_name().name();
        let singular = plural.strip_suffix('s').unwrap_or(plural);
        let entries = elements(element).filter(|child| child.tag_name().name() != "comment");
        let fields = entries.map(|child| {
            let name = child.tag_name().name();
            if name != singular {
                let message = format!("expected <{singular}>, found <{}>", shortened(name));
                return Err(Problem::new(name_at(child), message));
            }
            let id = child.attribute_node("id").ok_or_else(|| {
                Problem::new(name_at(child), format!("missing id; write <{singular} id=\"its name\" ..>"))
            })?;
            let (key, at) = (Cow::Borrowed(id.value()), value_of(id).at);
            Ok(Field { key, at, value: Self::Element(child, Role::Entry) })
        });
        unique(fields.collect::<Outcome<_>>()?)
    }

    fn items(self) -> Outcome<Vec<Self>> {
        self.list(Value::items)
    }

    fn rows(self) -> Outcome<Vec<Self>> {
        self.list(Value::rows)
    }

    fn number(self) -> Outcome<f64> {
        self.scalar("a number", Value::number)
    }

    fn text(self) -> Outcome<Cow<'t, str>> {
        let text = self.scalar("a string", |value| Some(value.text))?;
        // Between tags, blanks are layout.
        Ok(Cow::Borrowed(if matches!(self, Self::Text(_)) { text } else { text.trim() }))
    }

    fn boolean(self) -> Outcome<bool> {
        self.scalar("true or false", |value| value.text.trim().parse().ok())
    }

    fn number_rows<const N: usize>(self) -> Option<Vec<[f64; N]>> {
        self.value()?.tuples()
    }

    fn index_rows<const N: usize>(self) -> Option<Vec<[u32; N]>> {
        self.value()?.tuples()
    }
}

impl<'t> Xml<'t> {
    /// The values of a list: elements, or what `split` makes of a text.
    fn list(self, split: impl Fn(Value<'t>) -> Vec<Value<'t>>) -> Outcome<Vec<Self>> {
        if let Some(value) = self.value() {
            // An element's text may be nothing but the blanks between its tags.
            return Ok(split(value).into_iter().map(Self::Text).collect());
        }
        let Self::Element(element, _) = self else { return Ok(Vec::new()) };
        only_blanks(element)?;
        no_attributes(element)?;
        let items = elements(element).filter(|child| child.tag_name().name() != "comment");
        Ok(items.map(|child| Self::Element(child, Role::Item)).collect())
    }
}

/// The elements right within another.
fn elements<'t>(element: Element<'t>) -> impl Iterator<Item = Element<'t>> {
    element.children().filter(|child| child.node_type() == NodeType::Element)
}

fn is_comment(attribute: &Attribute) -> bool {
    attribute.name() == "comment"
}

/// Where the name in an element's first tag stands.
fn name_at(element: Element) -> At {
    At(element.range().start + 1)
}

/// The text of an attribute.
fn value_of<'t>(attribute: Attribute<'t, 't>) -> Value<'t> {
    let (text, range) = (attribute.value(), attribute.range_value());
    Value { text, at: At(range.start), verbatim: text.len() == range.len() }
}

/// A text between tags.
fn text_of(node: Element) -> Value {
    let (text, range) = (node.text().unwrap_or_default(), node.range());
    Value { text, at: At(range.start), verbatim: text.len() == range.len() }
}

/// An element that holds others has no text between them.
fn only_blanks(element: Element) -> Outcome<()> {
    let stray = |child: &Element| child.is_text() && !child.text().unwrap_or_default().trim().is_empty();
    element.children().find(stray).map_or(Ok(()), |child| {
        let text = child.text().unwrap_or_default();
        let start = child.range().start + (text.len() - text.trim_start().len());
        let is_broken = element.children().any(|child| child.is_comment());
        let remedy = if is_broken { "; a comment may not stand within a text" } else { "" };
        Err(Problem::new(At(start), format!("unexpected text \"{}\"{remedy}", shortened(text.trim()))))
    })
}

/// A list has no attributes but `comment`.
fn no_attributes(element: Element) -> Outcome<()> {
    element.attributes().find(|attribute| !is_comment(attribute)).map_or(Ok(()), |attribute| {
        let (name, list) = (shortened(attribute.name()), element.tag_name().name());
        let message = format!("unexpected attribute \"{name}\"; <{list}> holds elements only");
        Err(Problem::new(At(attribute.range().start), message))
    })
}

/// No name may stand twice.
fn unique<'t>(fields: Vec<Field<'t, Xml<'t>>>) -> Outcome<Vec<Field<'t, Xml<'t>>>> {
    let mut seen = HashSet::with_capacity(fields.len());
    match fields.iter().find(|field| field.key != "comment" && !seen.insert(&field.key)) {
        None => Ok(fields),
        Some(twice) => {
            let message = format!("\"{}\" stands twice here; remove one", shortened(&twice.key));
            Err(Problem::new(twice.at, message))
        }
    }
}
