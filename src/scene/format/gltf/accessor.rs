//! Accessors: typed elements in the bytes of buffer views, dense or sparse, at any stride, of any number type.
//!
//! Everything a file says of offsets, strides and counts is computed in u64 with overflow checked, and compared with the
//! bytes that are really there before any memory is taken. Elements beyond those bytes are missing; the others are read.

use super::document::{Document, View, get, room, to_usize};
use super::fault::{Fault, Notes, Read};
use gltf::json::accessor::{ComponentType, Type, sparse};
use gltf::json::validation::Checked;
use gltf::json::{self, Index};
use std::fmt;

/// An accessor whose elements are known to be there.
pub struct Accessor<'d> {
    document: &'d Document<'d>,
    number: usize,
    count: usize,
    kind: Type,
    component: ComponentType,
    normalized: bool,
    /// Where the elements lie; without any, all are 0.
    dense: Option<Strided<'d>>,
    sparse: Option<Sparse<'d>>,
}

/// Which elements are wanted.
#[derive(Clone, Copy)]
pub enum Which<'a> {
    /// All, in their order.
    All,
    /// These, all of which there are.
    These(&'a [u32]),
}

/// Elements at equal distances.
#[derive(Clone, Copy)]
struct Strided<'d> {
    bytes: &'d [u8],
    stride: usize,
    /// The file gives a distance by which they would overlap.
    is_packed: bool,
}

/// Stands for what is no index.
pub const NO_INDEX: u32 = u32::MAX;
/// What is done about a stride by which elements overlap.
const PACKED: &str = "byteStride is less than an element; the elements are taken as packed";

/// Elements that replace others.
struct Sparse<'d> {
    indices: Strided<'d>,
    index_type: ComponentType,
    values: Strided<'d>,
    count: usize,
}

impl<'d> Accessor<'d> {
    /// Opens an accessor that has at least one element; `by` points at who asks.
    pub fn open(
        document: &'d Document,
        index: Index<json::Accessor>,
        by: fmt::Arguments,
        notes: &mut Notes,
    ) -> Read<Self> {
        let accessor = get(&document.root.accessors, index, "accessor", by)?;
        let i = index.value();
        let Checked::Valid(kind) = accessor.type_ else {
            return Err(Fault::new(format!("/accessors/{i}/type"), "unknown type; expected SCALAR, VEC2, .. or MAT4"));
        };
        let Checked::Valid(component) = accessor.component_type else {
            let message = "unknown componentType; expected 5120 to 5126 but 5124";
            return Err(Fault::new(format!("/accessors/{i}/componentType"), message));
        };
        let component = component.0;
        let wanted = accessor.count.0;
        if wanted == 0 {
            return Err(Fault::new(format!("/accessors/{i}/count"), "count is 0; expected at least 1"));
        }
        let size = (component.size() * kind.multiplicity()) as u64;
        let (dense, count) = match accessor.buffer_view {
            None => {
                document.take_zeros(wanted, format_args!("/accessors/{i}/count"))?;
                (None, wanted)
            }
            Some(view) => {
                let offset = accessor.byte_offset.map_or(0, |offset| offset.0);
                let view = document.view(view, format_args!("/accessors/{i}/bufferView"), notes)?;
                let (dense, there) = Strided::open(view, offset, size);
                if dense.is_packed {
                    notes.add(format!("/accessors/{i}/bufferView"), PACKED);
                }
                if there == 0 {
                    let message = "the accessor lies beyond the bytes of its buffer view";
                    return Err(Fault::new(format!("/accessors/{i}/bufferView"), message));
                }
                (Some(dense), wanted.min(there))
            }
        };
        if count < wanted {
            let message =
                format!("count is {wanted}, but there are bytes for {count} elements; the others are missing");
            notes.add_kind(format!("/accessors/{i}/count"), "accessors hold less than they say", &*message, &*message);
        }
        let sparse = match &accessor.sparse {
            Some(sparse) if sparse.count.0 > 0 => {
                let opened = Sparse::open(document, sparse, i, size, notes);
                notes.attempt(opened, "sparse parts of accessors left out")?
            }
            _ => None,
        };
        let is_beyond = |place: &u32| u64::from(*place) >= count;
        if sparse.as_ref().is_some_and(|sparse| sparse.places().iter().any(is_beyond)) {
            let pointer = format!("/accessors/{i}/sparse/indices");
            notes.add(pointer, "indices of elements that are not there; they are left out");
        }
        let normalized = accessor.normalized;
        Ok(Self { document, number: i, count: to_usize(count), kind, component, normalized, dense, sparse })
    }

    /// How many elements there are.
    pub fn count(&self) -> usize {
        self.count
    }

    /// How many numbers an element has.
    pub fn width(&self) -> usize {
        self.kind.multiplicity()
    }

    /// Whether elements are whole numbers that are never below 0.
    pub fn is_unsigned(&self) -> bool {
        matches!(self.component, ComponentType::U8 | ComponentType::U16 | ComponentType::U32)
    }

    /// Vectors of `N` numbers, which may be of any value. Whole numbers are taken as shares of their greatest where the accessor says so.
    pub fn vectors<const N: usize>(&self, which: Which) -> Read<Vec<[f32; N]>> {
        self.decode(which, self.normalized)
    }

    /// Vectors of `N` shares from 0 to 1, whether whole numbers or not.
    pub fn shares<const N: usize>(&self, which: Which) -> Read<Vec<[f32; N]>> {
        self.decode(which, true)
    }

    /// Colours with opacity, which is 1 where the file gives three numbers.
    pub fn colors(&self, which: Which) -> Read<Vec<[f32; 4]>> {
        match self.kind {
            Type::Vec3 => {
                let colors = self.shares::<3>(which)?;
                Ok(colors.into_iter().map(|[r, g, b]| [r, g, b, 1.0]).collect())
            }
            _ => self.shares(which),
        }
    }

    /// Whole numbers, `N` an element; [`NO_INDEX`] for any other number.
    pub fn integers<const N: usize>(&self, which: Which) -> Read<Vec<[u32; N]>> {
        let whole = |number: i32| u32::try_from(number).unwrap_or(NO_INDEX);
        self.read(which, |strided, elements| match self.component {
            ComponentType::U8 => strided.copy(elements, |[b]| u32::from(b)),
            ComponentType::I8 => strided.copy(elements, |b| whole(i8::from_le_bytes(b).into())),
            ComponentType::U16 => strided.copy(elements, |b| u32::from(u16::from_le_bytes(b))),
            ComponentType::I16 => strided.copy(elements, |b| whole(i16::from_le_bytes(b).into())),
            ComponentType::U32 => strided.copy(elements, u32::from_le_bytes),
            ComponentType::F32 => strided.copy(elements, |b| {
                let number = f32::from_le_bytes(b);
                let is_whole = number.fract() == 0.0 && (0.0..4e9).contains(&number);
                if is_whole { number as u32 } else { NO_INDEX }
            }),
        })
    }

    fn decode<const N: usize>(&self, which: Which, normalized: bool) -> Read<Vec<[f32; N]>> {
        self.read(which, |strided, elements: &mut [[f32; N]]| match (self.component, normalized) {
            (ComponentType::F32, _) => strided.copy(elements, f32::from_le_bytes),
            (ComponentType::U8, true) => strided.copy(elements, |[b]| f32::from(b) / 255.0),
            (ComponentType::U8, false) => strided.copy(elements, |[b]| f32::from(b)),
            (ComponentType::I8, true) => {
                strided.copy(elements, |b| (f32::from(i8::from_le_bytes(b)) / 127.0).max(-1.0));
            }
            (ComponentType::I8, false) => strided.copy(elements, |b| f32::from(i8::from_le_bytes(b))),
            (ComponentType::U16, true) => strided.copy(elements, |b| f32::from(u16::from_le_bytes(b)) / 65535.0),
            (ComponentType::U16, false) => strided.copy(elements, |b| f32::from(u16::from_le_bytes(b))),
            (ComponentType::I16, true) => {
                strided.copy(elements, |b| (f32::from(i16::from_le_bytes(b)) / 32767.0).max(-1.0));
            }
            (ComponentType::I16, false) => strided.copy(elements, |b| f32::from(i16::from_le_bytes(b))),
            (ComponentType::U32, _) => strided.copy(elements, |b| u32::from_le_bytes(b) as f32),
        })
    }

    /// The elements asked for: the dense ones, and the sparse ones over them. Of elements that are wider the first numbers
    /// are taken; those that are not there are 0.
    fn read<T: Copy + Default, const N: usize>(
        &self,
        which: Which,
        copy: impl Fn(&Strided, &mut [[T; N]]),
    ) -> Read<Vec<[T; N]>> {
        let width = self.width();
        if width < N {
            let message = format!("expected {N} numbers an element, found {width}");
            return Err(Fault::new(format!("/accessors/{}/type", self.number), message));
        }
        let pointer = format_args!("/accessors/{}/count", self.number);
        if let (Which::These(places), Some(dense), None) = (which, &self.dense, &self.sparse) {
            self.document.take_elements(places.len() as u64, pointer)?;
            let mut elements = room(places.len(), pointer)?;
            elements.resize(places.len(), [T::default(); N]);
            for (element, &place) in elements.iter_mut().zip(places) {
                copy(&dense.from(place), std::slice::from_mut(element));
            }
            return Ok(elements);
        }
        let replaced = self.sparse.as_ref().map_or(0, |sparse| sparse.count);
        self.document.take_elements(self.count as u64 + replaced as u64, pointer)?;
        let mut elements = room(self.count, pointer)?;
        elements.resize(self.count, [T::default(); N]);
        if let Some(dense) = &self.dense {
            copy(dense, &mut elements);
        }
        if let Some(sparse) = &self.sparse {
            let mut values = room(sparse.count, pointer)?;
            values.resize(sparse.count, [T::default(); N]);
            copy(&sparse.values, &mut values);
            for (place, value) in sparse.places().into_iter().zip(values) {
                if let Some(element) = elements.get_mut(place as usize) {
                    *element = value;
                }
            }
        }
        Ok(match which {
            Which::All => elements,
            Which::These(places) => {
                places.iter().map(|place| elements.get(*place as usize).copied().unwrap_or([T::default(); N])).collect()
            }
        })
    }
}

impl<'d> Strided<'d> {
    /// Elements of `size` bytes each, from `offset` on in a buffer view, and how many there are.
    fn open(view: View<'d>, offset: u64, size: u64) -> (Self, u64) {
        let bytes = view.bytes.get(to_usize(offset)..).unwrap_or_default();
        let stride = view.stride.filter(|stride| *stride >= size);
        // A stride of 0 says that elements are packed: so it was in glTF 1.0.
        let is_packed = stride.is_none() && view.stride.is_some_and(|stride| stride != 0);
        let stride = stride.unwrap_or(size);
        let count = (bytes.len() as u64).checked_sub(size).map_or(0, |rest| rest / stride + 1);
        (Self { bytes, stride: to_usize(stride), is_packed }, count)
    }

    /// Those from element `place` on; none beyond the last.
    fn from(&self, place: u32) -> Self {
        let start = (place as usize).saturating_mul(self.stride);
        Self { bytes: self.bytes.get(start..).unwrap_or_default(), ..*self }
    }

    /// Copies the first elements there are, number by number.
    fn copy<T, const N: usize, const SIZE: usize>(&self, elements: &mut [[T; N]], convert: impl Fn([u8; SIZE]) -> T) {
        for (element, bytes) in elements.iter_mut().zip(self.bytes.chunks(self.stride)) {
            for (number, own) in element.iter_mut().zip(bytes.as_chunks::<SIZE>().0) {
                *number = convert(*own);
            }
        }
    }
}

impl<'d> Sparse<'d> {
    /// Which elements are replaced.
    fn places(&self) -> Vec<u32> {
        let mut places = vec![[0_u32]; self.count];
        match self.index_type {
            ComponentType::U8 => self.indices.copy(&mut places, |[b]| u32::from(b)),
            ComponentType::U16 => self.indices.copy(&mut places, |b| u32::from(u16::from_le_bytes(b))),
            _ => self.indices.copy(&mut places, u32::from_le_bytes),
        }
        places.into_iter().map(|[place]| place).collect()
    }

    fn open(
        document: &'d Document,
        sparse: &sparse::Sparse,
        accessor: usize,
        size: u64,
        notes: &mut Notes,
    ) -> Read<Self> {
        let sparse::Sparse { count, indices, values, .. } = sparse;
        let at = |key: &str| format!("/accessors/{accessor}/sparse/{key}");
        let Checked::Valid(index_type) = indices.component_type else {
            return Err(Fault::new(at("indices/componentType"), "expected an unsigned type: 5121, 5123 or 5125"));
        };
        let index_type = index_type.0;
        let mut open = |view, offset, size, key: &str| {
            let view = document.view(view, format_args!("/accessors/{accessor}/sparse/{key}"), notes)?;
            Ok(Strided::open(view, offset, size))
        };
        let (indices, first) = open(indices.buffer_view, indices.byte_offset.0, index_type.size() as u64, "indices")?;
        let (values, second) = open(values.buffer_view, values.byte_offset.0, size, "values")?;
        let there = first.min(second).min(count.0);
        if there < count.0 {
            let message = format!("count is {}, but there are bytes for {there}; the others are left out", count.0);
            notes.add(at("count"), message);
        }
        Ok(Self { indices, index_type, values, count: to_usize(there) })
    }
}
