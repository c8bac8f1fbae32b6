//! Accessors: typed elements in the bytes of buffer views, dense or sparse, at any stride, of any number type.
//!
//! Everything a file says of offsets, strides and counts is computed in u64 with overflow checked, and compared with the
//! bytes that are really there before any memory is taken.

use super::document::{Document, get, room, to_usize};
use super::fault::{Fault, Read};
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
}

/// Elements that replace others.
struct Sparse<'d> {
    indices: Strided<'d>,
    index_type: ComponentType,
    values: Strided<'d>,
    count: usize,
}

impl<'d> Accessor<'d> {
    /// Opens an accessor; `by` points at who asks.
    pub fn open(document: &'d Document, index: Index<json::Accessor>, by: fmt::Arguments) -> Read<Self> {
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
        let count = accessor.count.0;
        if count == 0 {
            return Err(Fault::new(format!("/accessors/{i}/count"), "count is 0; expected at least 1"));
        }
        if accessor.buffer_view.is_none() {
            document.take_zeros(count, format_args!("/accessors/{i}/count"))?;
        }
        let size = (component.size() * kind.multiplicity()) as u64;
        let dense = match accessor.buffer_view {
            None => None,
            Some(view) => {
                let offset = accessor.byte_offset.map_or(0, |offset| offset.0);
                let by = format_args!("/accessors/{i}/bufferView");
                Some(Strided::open(document, view, offset, count, size, by)?)
            }
        };
        let sparse = match &accessor.sparse {
            None => None,
            Some(sparse) => Some(Sparse::open(document, sparse, i, size)?),
        };
        let normalized = accessor.normalized;
        Ok(Self { document, number: i, count: to_usize(count), kind, component, normalized, dense, sparse })
    }

    /// How many elements there are.
    pub fn count(&self) -> usize {
        self.count
    }

    /// Vectors of `N` numbers. Whole numbers are taken as shares of their greatest where the accessor says so.
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

    /// Whole numbers, `N` an element.
    pub fn integers<const N: usize>(&self, which: Which) -> Read<Vec<[u32; N]>> {
        let unsigned = matches!(self.component, ComponentType::U8 | ComponentType::U16 | ComponentType::U32);
        self.expect(unsigned, "componentType", "expected an unsigned type: 5121, 5123 or 5125")?;
        self.read(which, |strided, elements| match self.component {
            ComponentType::U8 => strided.copy(elements, |[b]| u32::from(b)),
            ComponentType::U16 => strided.copy(elements, |b| u32::from(u16::from_le_bytes(b))),
            _ => strided.copy(elements, u32::from_le_bytes),
        })
    }

    fn decode<const N: usize>(&self, which: Which, normalized: bool) -> Read<Vec<[f32; N]>> {
        let elements = self.read(which, |strided, elements: &mut [[f32; N]]| match (self.component, normalized) {
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
        })?;
        match elements.iter().position(|element| !element.iter().all(|v| v.is_finite())) {
            None => Ok(elements),
            Some(at) => {
                let message = format!("element {at} is {:?}; its numbers must be finite", elements[at]);
                Err(Fault::new(format!("/accessors/{}", self.number), message))
            }
        }
    }

    /// The elements asked for: the dense ones, and the sparse ones over them.
    fn read<T: Copy + Default, const N: usize>(
        &self,
        which: Which,
        copy: impl Fn(&Strided, &mut [[T; N]]),
    ) -> Read<Vec<[T; N]>> {
        self.expect(self.kind.multiplicity() == N, "type", &format!("expected {N} numbers an element"))?;
        let pointer = format_args!("/accessors/{}/count", self.number);
        if let Which::These(places) = which
            && let Some(place) = places.iter().find(|place| **place as usize >= self.count)
        {
            return Err(Fault::new(
                pointer.to_string(),
                format!("count is {}; a vertex has number {place}", self.count),
            ));
        }
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
                let Some(element) = elements.get_mut(place as usize) else {
                    let message = format!("index {place} names none of the {} elements", self.count);
                    return Err(Fault::new(format!("/accessors/{}/sparse/indices", self.number), message));
                };
                *element = value;
            }
        }
        Ok(match which {
            Which::All => elements,
            Which::These(places) => places.iter().map(|place| elements[*place as usize]).collect(),
        })
    }

    fn expect(&self, holds: bool, key: &str, message: &str) -> Read<()> {
        match holds {
            true => Ok(()),
            false => Err(Fault::new(format!("/accessors/{}/{key}", self.number), message)),
        }
    }
}

impl<'d> Strided<'d> {
    /// `count` elements of `size` bytes each, from `offset` on in a buffer view.
    fn open(
        document: &'d Document,
        view: Index<json::buffer::View>,
        offset: u64,
        count: u64,
        size: u64,
        by: fmt::Arguments,
    ) -> Read<Self> {
        let (bytes, stride) = document.view(view, by)?;
        let stride = stride.unwrap_or(size);
        if stride < size {
            let pointer = format!("/bufferViews/{}/byteStride", view.value());
            return Err(Fault::new(pointer, format!("byteStride {stride} is less than an element's {size} bytes")));
        }
        let length = (count - 1).checked_mul(stride).and_then(|start| start.checked_add(size));
        let end = length.and_then(|length| offset.checked_add(length));
        let own = end.and_then(|end| bytes.get(to_usize(offset)..to_usize(end)));
        let bytes = own.ok_or_else(|| {
            let message = format!(
                "{count} elements of {size} bytes, {stride} apart from byte {offset}, reach beyond buffer view {}, which has {}",
                view.value(),
                bytes.len()
            );
            Fault::new(by.to_string(), message)
        })?;
        Ok(Self { bytes, stride: to_usize(stride) })
    }

    /// Those from element `place` on; none beyond the last.
    fn from(&self, place: u32) -> Self {
        let start = (place as usize).saturating_mul(self.stride);
        Self { bytes: self.bytes.get(start..).unwrap_or_default(), stride: self.stride }
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

    fn open(document: &'d Document, sparse: &sparse::Sparse, accessor: usize, size: u64) -> Read<Self> {
        let sparse::Sparse { count, indices, values, .. } = sparse;
        let at = |key: &str| format!("/accessors/{accessor}/sparse/{key}");
        if count.0 == 0 {
            return Err(Fault::new(at("count"), "count is 0; expected at least 1"));
        }
        let Checked::Valid(index_type) = indices.component_type else {
            return Err(Fault::new(at("indices/componentType"), "expected an unsigned type: 5121, 5123 or 5125"));
        };
        let index_type = index_type.0;
        let open = |view, offset, size, key| {
            Strided::open(document, view, offset, count.0, size, format_args!("/accessors/{accessor}/sparse/{key}"))
        };
        Ok(Self {
            indices: open(indices.buffer_view, indices.byte_offset.0, index_type.size() as u64, "indices")?,
            index_type,
            values: open(values.buffer_view, values.byte_offset.0, size, "values")?,
            count: to_usize(count.0),
        })
    }
}
