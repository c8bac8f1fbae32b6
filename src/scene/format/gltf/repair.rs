//! Repairs JSON values that do not fit: each fault costs the smallest part that can be done without.
//!
//! Only values that serde refuses come here, so that good files are read in one pass.

use super::fault::Notes;
use super::text::tamed;
use serde::de::DeserializeOwned;
use serde_json::value::RawValue;
use serde_json::{Map as Entries, Number as Numeral, Value};

/// What a value is to be.
#[derive(Clone, Copy, Debug)]
pub enum Kind {
    /// The number of an entry of a list; below 0 stands for none.
    Index,
    /// A whole number, be it written 4.0.
    Whole,
    /// A number.
    Number,
    /// So many numbers.
    Numbers(usize),
    /// A string.
    Text,
    /// True or false.
    Truth,
    /// A list, and what is put in the place of entries that do not fit.
    List(&'static Kind, Instead),
    /// Any keys, and values of one kind.
    Map(&'static Kind),
    /// Keys that are known; others stay as they are.
    Object(&'static [Key]),
}

/// A key of an object.
#[derive(Clone, Copy, Debug)]
pub struct Key {
    /// Its name.
    pub name: &'static str,
    /// What its value is to be.
    pub kind: Kind,
    /// What becomes of the object where the value is missing or does not fit.
    pub need: Need,
}

/// What becomes of an object whose key is missing or does not fit.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Need {
    /// It goes without.
    Optional,
    /// It does not fit, either.
    Must,
    /// It does not fit where the value does not, but may go without it.
    OrAll,
    /// It may go without; a value that does not fit becomes the number of an entry that is not there.
    OrNoEntry,
    /// The value is an empty list.
    AsEmptyList,
    /// The value is an empty object.
    AsEmptyObject,
    /// The value is 0.
    AsZero,
}

/// What is put in the place of a list's entry that does not fit.
#[derive(Clone, Copy, Debug)]
pub enum Instead {
    /// The list becomes shorter.
    Nothing,
    /// The number of an entry that is not there.
    NoEntry,
    /// 0.
    Zero,
    /// An empty object.
    Empty,
}

/// The number of no entry.
pub const NO_ENTRY: u32 = u32::MAX;

/// Most parts of a value that is repaired: as a tree each takes some hundred bytes.
const MOST_PARTS: usize = 1 << 20;

/// What came of a value.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Repaired {
    Fits,
    /// It stands for none.
    Absent,
    Misfit,
}

/// Reads a value, repaired if need be; `None` where that is not possible, which is noted.
pub fn read<T: DeserializeOwned>(raw: &RawValue, kind: Kind, pointer: &str, notes: &mut Notes) -> Option<T> {
    let text = raw.get();
    if let Ok(value) = serde_json::from_str(text) {
        return Some(value);
    }
    if text == "null" {
        notes.add(pointer, "null is taken as if it were not there");
        return None;
    }
    let read = || {
        if text.bytes().filter(|byte| b"[{,".contains(byte)).count() > MOST_PARTS {
            return Err("it does not fit its type, and is too large to be repaired".to_owned());
        }
        let value: Result<Value, _> = serde_json::from_str(text);
        let value = value.or_else(|error| serde_json::from_str(&tamed(text).ok_or(error)?));
        value.map_err(|error| error.to_string())
    };
    let mut repair = || {
        let mut value = read()?;
        let mut at = pointer.to_owned();
        match kind.repair(&mut value, &mut at, notes) {
            Repaired::Absent => Ok(None),
            Repaired::Misfit => Err(format!("expected {}", kind.expected())),
            Repaired::Fits => serde_json::from_value(value).map(Some).map_err(|error| error.to_string()),
        }
    };
    repair().unwrap_or_else(|message| {
        notes.add_kind(pointer, "damaged entries left out", &*message, format!("damaged: {message}; left out"));
        None
    })
}

impl Kind {
    fn expected(self) -> String {
        match self {
            Self::Index => "the number of an entry".to_owned(),
            Self::Whole => "a whole number".to_owned(),
            Self::Number => "a number".to_owned(),
            Self::Numbers(count) => format!("a list of {count} numbers"),
            Self::Text => "a string".to_owned(),
            Self::Truth => "true or false".to_owned(),
            Self::List(..) => "a list".to_owned(),
            Self::Map(_) => "an object".to_owned(),
            Self::Object(keys) => {
                let must: Vec<&str> = keys.iter().filter(|key| key.need == Need::Must).map(|key| key.name).collect();
                if must.is_empty() { "an object".to_owned() } else { format!("an object with {}", must.join(", ")) }
            }
        }
    }

    fn repair(self, value: &mut Value, at: &mut String, notes: &mut Notes) -> Repaired {
        let fits = |fits| if fits { Repaired::Fits } else { Repaired::Misfit };
        match self {
            Self::Index => match whole(value) {
                Some(index) if index < 0.0 => {
                    notes.add(&**at, "a number below 0 is taken as none");
                    Repaired::Absent
                }
                Some(index) if index < f64::from(NO_ENTRY) => {
                    *value = Value::from(index as u32);
                    Repaired::Fits
                }
                _ => Repaired::Misfit,
            },
            Self::Whole => match whole(value) {
                // Above this not every whole number is one of f64.
                Some(number) if value.is_u64() || (0.0..9e15).contains(&number) => {
                    *value = value.as_u64().map_or_else(|| Value::from(number as u64), Value::from);
                    Repaired::Fits
                }
                _ => Repaired::Misfit,
            },
            Self::Number => fits(number(value)),
            Self::Numbers(count) => {
                let Value::Array(numbers) = value else { return Repaired::Misfit };
                if numbers.len() > count {
                    notes.add(&**at, format!("more than {count} numbers; the first {count} are taken"));
                    numbers.truncate(count);
                }
                fits(numbers.len() == count && numbers.iter_mut().all(number))
            }
            Self::Text => {
                if value.is_number() {
                    *value = Value::String(value.to_string());
                }
                fits(value.is_string())
            }
            Self::Truth => {
                if let Some(number) = whole(value).filter(|number| [0.0, 1.0].contains(number)) {
                    *value = Value::Bool(number == 1.0);
                }
                fits(value.is_boolean())
            }
            Self::List(kind, instead) => {
                let Value::Array(values) = value else { return Repaired::Misfit };
                kind.repair_list(values, instead, at, notes);
                Repaired::Fits
            }
            Self::Map(kind) => {
                let Value::Object(entries) = value else { return Repaired::Misfit };
                let names: Vec<String> = entries.keys().cloned().collect();
                for name in names {
                    kind.repair_entry(&name, entries, at, notes);
                }
                Repaired::Fits
            }
            Self::Object(keys) => {
                let Value::Object(entries) = value else { return Repaired::Misfit };
                entries.remove("extras");
                fits(keys.iter().all(|key| key.repair(entries, at, notes)))
            }
        }
    }

    fn repair_list(self, values: &mut Vec<Value>, instead: Instead, at: &mut String, notes: &mut Notes) {
        let length = at.len();
        let mut place = 0;
        values.retain_mut(|value| {
            at.truncate(length);
            *at += &format!("/{place}");
            place += 1;
            let repaired = self.repair(value, at, notes);
            if repaired == Repaired::Fits {
                return true;
            }
            if repaired == Repaired::Misfit {
                notes.add(&**at, format!("expected {}; left out", self.expected()));
            }
            match instead {
                Instead::Nothing => return false,
                Instead::NoEntry => *value = Value::from(NO_ENTRY),
                Instead::Zero => *value = Value::from(0),
                Instead::Empty => {
                    *value = Value::Object(Entries::new());
                    self.repair(value, at, notes);
                }
            }
            true
        });
        at.truncate(length);
    }

    /// Repairs the value of a key; one that does not fit is left out, which is noted, and so is `null`.
    fn repair_entry(
        self,
        name: &str,
        entries: &mut Entries<String, Value>,
        at: &mut String,
        notes: &mut Notes,
    ) -> Repaired {
        let Some(value) = entries.get_mut(name) else { return Repaired::Absent };
        let length = at.len();
        *at += "/";
        *at += &name.replace('~', "~0").replace('/', "~1");
        let repaired = match value {
            Value::Null => {
                notes.add(&**at, "null is taken as if it were not there");
                Repaired::Absent
            }
            _ => self.repair(value, at, notes),
        };
        if repaired == Repaired::Misfit {
            notes.add(&**at, format!("expected {}; left out", self.expected()));
        }
        if repaired != Repaired::Fits {
            entries.remove(name);
        }
        at.truncate(length);
        repaired
    }
}

impl Key {
    /// Whether the object fits with this key.
    fn repair(&self, entries: &mut Entries<String, Value>, at: &mut String, notes: &mut Notes) -> bool {
        let repaired = self.kind.repair_entry(self.name, entries, at, notes);
        let instead = match (self.need, repaired) {
            (_, Repaired::Fits) | (Need::Optional, _) | (Need::OrNoEntry | Need::OrAll, Repaired::Absent) => {
                return true;
            }
            (Need::Must | Need::OrAll, _) => return false,
            (Need::OrNoEntry, _) => Value::from(NO_ENTRY),
            (Need::AsEmptyList, _) => Value::Array(Vec::new()),
            (Need::AsEmptyObject, _) => Value::Object(Entries::new()),
            (Need::AsZero, _) => Value::from(0),
        };
        entries.insert(self.name.to_owned(), instead);
        true
    }
}

/// A number, be it in a string.
fn number(value: &mut Value) -> bool {
    if let Some(text) = value.as_str()
        && let Some(number) = text.trim().parse().ok().and_then(Numeral::from_f64)
    {
        *value = Value::Number(number);
    }
    value.is_number()
}

/// A whole number, be it written 4.0 or in a string.
fn whole(value: &mut Value) -> Option<f64> {
    number(value);
    value.as_f64().filter(|number| number.fract() == 0.0)
}
