//! The parsed file: its JSON as the `gltf` crate types it, and the bytes of its buffers.
//!
//! Only the crate's plain types are used. Its own readers of buffers, accessors and nodes trust what they read: they
//! panic on strides, types and indices that do not fit, and follow nodes in circles.

use super::fault::{Fault, Read};
use super::root::Root;
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

impl<'a> Document<'a> {
    /// Takes the buffers of `root` from `bin`, the bytes that came with it, and by `read_file`.
    pub fn new(
        root: Root,
        bin: Option<&'a [u8]>,
        limits: &Limits,
        mut read_file: impl FnMut(&str) -> Result<Cow<'static, [u8]>, FileError>,
    ) -> Self {
        let buffers = (0..).zip(&root.buffers).map(|(i, buffer)| load(i, buffer, bin, &mut read_file)).collect();
        let element_limit = limits.vertices;
        Self {
            root,
            buffers,
            elements_left: AtomicU64::new(element_limit),
            element_limit,
            zeros_left: AtomicU64::new(MOST_ZEROS),
        }
    }

    /// The bytes of a buffer view, and how far apart its elements are, if it says so. `by` points at who asks.
    pub fn view(&self, index: Index<buffer::View>, by: fmt::Arguments) -> Read<(&[u8], Option<u64>)> {
        let view = get(&self.root.buffer_views, index, "buffer view", by)?;
        let i = index.value();
        get(&self.root.buffers, view.buffer, "buffer", format_args!("/bufferViews/{i}/buffer"))?;
        let buffer = self.buffers[view.buffer.value()].as_ref().map_err(Fault::clone)?;
        let start = view.byte_offset.map_or(0, |offset| offset.0);
        let range = start.checked_add(view.byte_length.0).and_then(|end| buffer.get(to_usize(start)..to_usize(end)));
        let bytes = range.ok_or_else(|| {
            let message = format!(
                "{} bytes from byte {start} reach beyond buffer {}, which has {}",
                view.byte_length.0,
                view.buffer.value(),
                buffer.len()
            );
            Fault::new(format!("/bufferViews/{i}"), message)
        })?;
        Ok((bytes, view.byte_stride.map(|stride| stride.0 as u64)))
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
        Err(Fault::new(pointer.to_string(), message))
    }

    /// Takes `count` elements from what a file may ask for without giving their bytes.
    pub fn take_zeros(&self, count: u64, pointer: fmt::Arguments) -> Read<()> {
        if take(&self.zeros_left, count) {
            return Ok(());
        }
        let message = format!(
            "{count} elements without a bufferView; expected at most {MOST_ZEROS} in the whole file, each use of them counted"
        );
        Err(Fault::new(pointer.to_string(), message))
    }
}

/// The entry of a list that something points to; `by` points at who does.
pub fn get<'d, T>(list: &'d [T], index: Index<T>, what: &str, by: fmt::Arguments) -> Read<&'d T> {
    list.get(index.value()).ok_or_else(|| {
        let range = match list.len() {
            0 => format!("the file has no {what}"),
            n => format!("expected a number from 0 to {}", n - 1),
        };
        Fault::new(by.to_string(), format!("{what} {} does not exist; {range}", index.value()))
    })
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
        Err(_) => Err(Fault::new(pointer.to_string(), format!("there is no memory for {count} vertices"))),
    }
}

/// What no slice is as long as stays so.
pub fn to_usize(value: u64) -> usize {
    usize::try_from(value).unwrap_or(usize::MAX)
}

fn load<'a>(
    i: usize,
    buffer: &buffer::Buffer,
    bin: Option<&'a [u8]>,
    read_file: &mut impl FnMut(&str) -> Result<Cow<'static, [u8]>, FileError>,
) -> Read<Cow<'a, [u8]>> {
    let fault = |message: String| Fault::new(format!("/buffers/{i}"), message);
    let bytes = match &buffer.uri {
        // Only the first buffer may be the bytes that came with the JSON.
        None => match bin {
            Some(bin) if i == 0 => Cow::Borrowed(bin),
            _ => return Err(fault("the buffer has no uri, and no bytes came with the file for it".to_owned())),
        },
        Some(uri) => match uri::read(uri).map_err(fault)? {
            Target::Bytes(bytes) => Cow::Owned(bytes),
            Target::File(name) => {
                read_file(&name).map_err(|error| fault(format!("cannot read \"{}\": {error}", shortened(&name))))?
            }
        },
    };
    let wanted = buffer.byte_length.0;
    if (bytes.len() as u64) < wanted {
        return Err(fault(format!("byteLength is {wanted}, but there are only {} bytes", bytes.len())));
    }
    Ok(match bytes {
        Cow::Borrowed(bytes) => Cow::Borrowed(&bytes[..to_usize(wanted)]),
        Cow::Owned(mut bytes) => {
            bytes.truncate(to_usize(wanted));
            bytes.shrink_to_fit();
            Cow::Owned(bytes)
        }
    })
}
