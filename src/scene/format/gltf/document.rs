//! The parsed file: its JSON as the `gltf` crate types it, and the bytes of its buffers.
//!
//! Only the crate's plain types are used. Its own readers of buffers, accessors and nodes trust what they read: they
//! panic on strides, types and indices that do not fit, and follow nodes in circles.

use super::fault::{Fault, Notes, Read};
use super::root::{Buffer, Root};
use super::uri::{self, Target};
use crate::scene::desc::map::shortened;
use crate::scene::files::FileError;
use crate::scene::limits::{Limits, exceeded};
use gltf::json::{Index, buffer};
use std::borrow::Cow;
use std::fmt;
use std::sync::atomic::{AtomicU64, Ordering};

/// A file taken apart.
pub struct Document<'a> {
    /// What the JSON says.
    pub root: Root,
    /// The bytes of each buffer, or why there are none: asked for only by those who use it.
    buffers: Vec<Read<Cow<'a, [u8]>>>,
    /// Vertices and indices that may still be read.
    elements_left: AtomicU64,
    element_limit: u64,
    /// Elements without bytes that may still be opened.
    zeros_left: AtomicU64,
}

/// Most elements without bytes of all uses of accessors together: nothing else would bound what a few words ask for.
const MOST_ZEROS: u64 = 1 << 22;

/// A part of a buffer.
#[derive(Clone, Copy)]
pub struct View<'d> {
    /// Its bytes, as far as they are there.
    pub bytes: &'d [u8],
    /// How far apart its elements are, if it says so.
    pub stride: Option<u64>,
}

impl<'a> Document<'a> {
    /// Takes the buffers of `root` from `bin`, the bytes that came with it, and by `read_file`.
    pub fn new(
        root: Root,
        bin: Option<&'a [u8]>,
        limits: &Limits,
        notes: &mut Notes,
        mut read_file: impl FnMut(&str) -> Result<Cow<'static, [u8]>, FileError>,
    ) -> Self {
        let mut load = |(i, buffer): (usize, &Option<Buffer>)| {
            let damaged = || Fault::new(format!("/buffers/{i}"), "the buffer is damaged");
            load(i, buffer.as_ref().ok_or_else(damaged)?, bin, notes, &mut read_file)
        };
        let buffers = root.buffers.iter().enumerate().map(&mut load).collect();
        let element_limit = limits.vertices;
        Self {
            root,
            buffers,
            elements_left: AtomicU64::new(element_limit),
            element_limit,
            zeros_left: AtomicU64::new(MOST_ZEROS),
        }
    }

    /// A buffer view; one that reaches beyond its buffer ends with it. `by` points at who asks.
    pub fn view(&self, index: Index<buffer::View>, by: fmt::Arguments, notes: &mut Notes) -> Read<View<'_>> {
        let view = get(&self.root.buffer_views, index, "buffer view", by)?;
        let i = index.value();
        get(&self.root.buffers, view.buffer, "buffer", format_args!("/bufferViews/{i}/buffer"))?;
        let buffer = self.buffers[view.buffer.value()].as_ref().map_err(Fault::clone)?;
        let start = view.byte_offset.map_or(0, |offset| offset.0);
        let rest = buffer.get(to_usize(start)..).unwrap_or_default();
        let bytes = rest.get(..to_usize(view.byte_length.0)).unwrap_or(rest);
        if (bytes.len() as u64) < view.byte_length.0 {
            let message = format!(
                "{} bytes from byte {start} reach beyond buffer {}, which has {}; the rest is missing",
                view.byte_length.0,
                view.buffer.value(),
                buffer.len()
            );
            notes.add_kind(
                format!("/bufferViews/{i}"),
                "buffer views reach beyond their buffers",
                &*message,
                &*message,
            );
        }
        Ok(View { bytes, stride: view.byte_stride.map(|stride| stride.0 as u64) })
    }

    /// How many bytes the buffers have.
    pub fn buffer_bytes(&self) -> usize {
        self.buffers.iter().flatten().map(|buffer| buffer.len()).sum()
    }

    /// Takes `count` vertices or indices from what a file may ask for.
    pub fn take_elements(&self, count: u64, pointer: fmt::Arguments) -> Read<()> {
        if take(&self.elements_left, count) {
            return Ok(());
        }
        let message = format!("vertices and indices: {}", exceeded("vertices", self.element_limit));
        Err(Fault::fatal(pointer.to_string(), message))
    }

    /// Takes `count` elements from what a file may ask for without giving their bytes.
    pub fn take_zeros(&self, count: u64, pointer: fmt::Arguments) -> Read<()> {
        if take(&self.zeros_left, count) {
            return Ok(());
        }
        let message = format!(
            "{count} elements without a bufferView; expected at most {MOST_ZEROS} in the whole file, each use of them counted"
        );
        Err(Fault::fatal(pointer.to_string(), message))
    }
}

/// The entry of a list that something points to; `by` points at who does.
pub fn get<'d, T, U>(list: &'d [Option<T>], index: Index<U>, what: &str, by: fmt::Arguments) -> Read<&'d T> {
    let i = index.value();
    match list.get(i) {
        Some(Some(entry)) => Ok(entry),
        Some(None) => Err(Fault::new(by.to_string(), format!("{what} {i} is damaged"))),
        None => {
            let range = match list.len() {
                0 => format!("the file has no {what}"),
                n => format!("expected a number from 0 to {}", n - 1),
            };
            Err(Fault::new(by.to_string(), format!("{what} {i} does not exist; {range}")))
        }
    }
}

/// Takes `count` from what is left; false where that is less.
fn take(left: &AtomicU64, count: u64) -> bool {
    left.fetch_update(Ordering::Relaxed, Ordering::Relaxed, |left| left.checked_sub(count)).is_ok()
}

/// Room for `count` vertices or indices; `pointer` points at what asks for them.
pub fn room<T>(count: usize, pointer: fmt::Arguments) -> Read<Vec<T>> {
    let mut room = Vec::new();
    match room.try_reserve_exact(count) {
        Ok(()) => Ok(room),
        Err(_) => Err(Fault::fatal(pointer.to_string(), format!("there is no memory for {count} vertices"))),
    }
}

/// What no slice is as long as stays so.
pub fn to_usize(value: u64) -> usize {
    usize::try_from(value).unwrap_or(usize::MAX)
}

fn load<'a>(
    i: usize,
    buffer: &Buffer,
    bin: Option<&'a [u8]>,
    notes: &mut Notes,
    read_file: &mut impl FnMut(&str) -> Result<Cow<'static, [u8]>, FileError>,
) -> Read<Cow<'a, [u8]>> {
    let pointer = || format!("/buffers/{i}");
    let bytes = match &buffer.uri {
        // Only the first buffer may be the bytes that came with the JSON.
        None => match bin {
            Some(bin) if i == 0 => Cow::Borrowed(bin),
            _ => return Err(Fault::new(pointer(), "the buffer has no uri, and no bytes came with the file for it")),
        },
        Some(uri) => match uri::read(uri).map_err(|message| Fault::new(pointer(), message))? {
            Target::Bytes(bytes) => Cow::Owned(bytes),
            Target::File(names) => read_first(&names, read_file).map_err(|error| {
                let message = format!("cannot read \"{}\": {error}", shortened(&names[0]));
                match error {
                    FileError::TooLarge(_) | FileError::Cancelled => Fault::fatal(pointer(), message),
                    _ => Fault::new(pointer(), message),
                }
            })?,
        },
    };
    let Some(wanted) = buffer.byte_length else {
        notes.add(pointer(), "a buffer without byteLength; all its bytes are taken");
        return Ok(bytes);
    };
    if (bytes.len() as u64) < wanted {
        let message = format!("byteLength is {wanted}, but there are only {} bytes; the rest is missing", bytes.len());
        notes.add_kind(pointer(), "buffers are shorter than they say", &*message, &*message);
    }
    let wanted = to_usize(wanted).min(bytes.len());
    Ok(match bytes {
        Cow::Borrowed(bytes) => Cow::Borrowed(&bytes[..wanted]),
        Cow::Owned(mut bytes) => {
            bytes.truncate(wanted);
            bytes.shrink_to_fit();
            Cow::Owned(bytes)
        }
    })
}

/// The file that the first of some names leads to; where none does, what is wrong with the first.
fn read_first(
    names: &[String],
    read_file: &mut impl FnMut(&str) -> Result<Cow<'static, [u8]>, FileError>,
) -> Result<Cow<'static, [u8]>, FileError> {
    let mut first = None;
    for name in names {
        match read_file(name) {
            Err(error) if !matches!(error, FileError::TooLarge(_) | FileError::Cancelled) => {
                first.get_or_insert(error);
            }
            read => return read,
        }
    }
    Err(first.unwrap_or(FileError::Outside))
}
