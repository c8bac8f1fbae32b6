//! Reading a map key by key, so that what nobody asked for can be reported.

use super::node::{Field, Kind, Node};
use super::problem::{At, Outcome, Problem, Warnings};
use super::suggest::hint;
use std::borrow::Cow;

/// A map being read. Every key asked for is remembered as known; [`finish`](Self::finish) warns of the others.
pub struct Map<'t, N> {
    at: At,
    unread: Vec<Option<Field<'t, N>>>,
    known: Vec<&'static str>,
}

impl<'t, N: Node<'t>> Map<'t, N> {
    /// Starts reading `node`, which must be a map.
    pub fn open(node: N) -> Outcome<Self> {
        let unread = node.fields()?.into_iter().map(Some).collect();
        Ok(Self { at: node.at(), unread, known: Vec::new() })
    }

    /// Where the map starts.
    pub fn at(&self) -> At {
        self.at
    }

    /// Whether the map has a key that was not read yet.
    pub fn has(&self, key: &str) -> bool {
        self.unread.iter().flatten().any(|f| f.key == key)
    }

    /// The value of a key.
    pub fn take(&mut self, key: &'static str) -> Option<N> {
        self.known.push(key);
        self.unread.iter_mut().find(|f| f.as_ref().is_some_and(|f| f.key == key))?.take().map(|f| f.value)
    }

    /// The value of a key as `read` understands it, if it is there.
    pub fn optional<T>(&mut self, key: &'static str, read: impl FnOnce(N) -> Outcome<T>) -> Outcome<Option<T>> {
        self.take(key).map(read).transpose()
    }

    /// The value of a key as `read` understands it, else `default`.
    pub fn or<T>(&mut self, key: &'static str, default: T, read: impl FnOnce(N) -> Outcome<T>) -> Outcome<T> {
        Ok(self.optional(key, read)?.unwrap_or(default))
    }

    /// The value of a key that must be there.
    pub fn required<T>(&mut self, key: &'static str, read: impl FnOnce(N) -> Outcome<T>) -> Outcome<T> {
        match self.take(key) {
            Some(node) => read(node),
            None => Err(Problem::new(self.at, self.missing(key))),
        }
    }

    /// Reads the entries of a map within: a name and a value each.
    pub fn entries<T>(
        &mut self,
        key: &'static str,
        mut read: impl FnMut(Cow<'t, str>, At, N) -> Outcome<T>,
    ) -> Outcome<Vec<T>> {
        let Some(node) = self.take(key) else { return Ok(Vec::new()) };
        let fields = node.named_fields()?.into_iter();
        fields.filter(|f| !is_comment(f)).map(|f| read(f.key, f.at, f.value)).collect()
    }

    /// Warns of every key that nobody asked for.
    pub fn finish(self, warnings: &mut Warnings) {
        for field in self.unread.iter().flatten().filter(|f| f.key != "comment") {
            let hint = hint(&field.key, self.known.iter().copied());
            warnings.push(field.at, format!("unknown key \"{}\" is ignored; {hint}", shortened(&field.key)));
        }
    }

    /// The message about a key that is not there, naming a misspelt one that may be meant.
    fn missing(&self, key: &'static str) -> String {
        let others = self.unread.iter().flatten().map(|f| &*f.key).filter(|k| !self.known.contains(k));
        match hint(key, others).strip_prefix("did you mean ") {
            Some(near) => format!("missing key \"{key}\" (is it spelled {}?)", near.trim_end_matches('?')),
            None => format!("missing key \"{key}\""),
        }
    }
}

/// In a map whose keys are the user's own names, `comment` is one only when it holds text.
fn is_comment<'t, N: Node<'t>>(field: &Field<'t, N>) -> bool {
    field.key == "comment" && field.value.kind() == Kind::Text
}

/// At most the first 60 characters of a text, for messages: one line stays one line.
pub fn shortened(text: &str) -> String {
    let visible = text.chars().flat_map(char::escape_debug);
    let short: String = visible.clone().take(60).collect();
    if visible.count() > 60 { short + "..." } else { short }
}
