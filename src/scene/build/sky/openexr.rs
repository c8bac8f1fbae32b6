//! OpenEXR pictures, block by block: no more of one is in memory than a block and the finished picture.

use super::canvas::Canvas;
use super::{Allowed, Refused, SkyError};
use crate::scene::desc::map::shortened;
use exr::block::chunk::CompressedBlock;
use exr::block::reader::{ChunksReader, Reader};
use exr::block::{BlockIndex, UncompressedBlock};
use exr::compression::Compression;
use exr::meta::BlockDescription;
use exr::meta::attribute::{EnvironmentMap, SampleType};
use exr::meta::header::Header;
use exr::prelude::f16;
use std::collections::HashMap;
use std::io::{Cursor, Read, Seek};

/// The first bytes of every OpenEXR file.
const MAGIC: [u8; 4] = [0x76, 0x2f, 0x31, 0x01];

/// Why a picture could not be decoded.
#[derive(Debug, thiserror::Error)]
pub enum ExrError {
    #[error("{}", one_line(.0))]
    Damaged(#[from] exr::error::Error),
    #[error("it has neither channels R, G and B nor Y; it has {0}")]
    NoColor(String),
    #[error("it holds the faces of a cube; an equirectangular picture is needed")]
    Cube,
}

impl From<exr::error::Error> for SkyError {
    fn from(error: exr::error::Error) -> Self {
        ExrError::from(error).into()
    }
}

/// Whether a file is an OpenEXR picture.
pub fn is(bytes: &[u8]) -> bool {
    bytes.starts_with(&MAGIC)
}

/// Decodes a picture. Infinite values become `stand_in`.
pub fn decode(bytes: &[u8], stand_in: f32, allowed: Allowed) -> Result<(Canvas, Vec<String>), SkyError> {
    let reader = exr::block::read(Cursor::new(bytes), false)?;
    for header in reader.headers() {
        // The picture may be smaller than a layer, yet none is read without these.
        check(header, allowed)?;
    }
    let layer = Layer::best(&reader).ok_or_else(|| ExrError::NoColor(channels(&reader)))?;
    if layer.is_cube {
        return Err(ExrError::Cube.into());
    }
    let (width, height) = layer.window.size;
    allowed.check_size(width.into(), height.into())?;
    let mut canvas = Canvas::new(width, height, stand_in);
    let mut chunks = reader.all_chunks(false)?;
    while let Some(chunk) = chunks.read_next_chunk() {
        allowed.check_cancelled()?;
        let chunk = chunk?;
        let is_largest = match &chunk.compressed_block {
            CompressedBlock::Tile(tile) => tile.coordinates.is_largest_resolution_level(),
            _ => true,
        };
        if chunk.layer_index == layer.index && is_largest {
            let block = UncompressedBlock::decompress_chunk(chunk, chunks.meta_data(), false)?;
            layer.paint(&block, &chunks.meta_data().headers[layer.index], &mut canvas)?;
        }
    }
    let compression = chunks.headers()[layer.index].compression;
    if matches!(
        compression,
        Compression::PXR24 | Compression::B44 | Compression::B44A | Compression::DWAA(_) | Compression::DWAB(_)
    ) {
        // Lossy compression leaves values a little below 0 where there were none.
        canvas.faults.negative = 0;
    }
    Ok((canvas, Vec::new()))
}

/// Whether a layer keeps the limits.
fn check(header: &Header, allowed: Allowed) -> Result<(), SkyError> {
    let (width, height) = (header.layer_size.width() as u64, header.layer_size.height() as u64);
    let most = allowed.limits.texture_edge;
    if width.max(height) > most {
        return Err(Refused::Edge(most).into());
    }
    let pixels = match header.blocks {
        BlockDescription::Tiles(tiles) => {
            (tiles.tile_size.width() as u64).saturating_mul(tiles.tile_size.height() as u64)
        }
        BlockDescription::ScanLines => width.saturating_mul(header.compression.scan_lines_per_block() as u64),
    };
    // A block is in memory as it is stored, in no more bytes, and as it is decoded.
    let bytes = pixels.saturating_mul(header.channels.bytes_per_pixel as u64).saturating_mul(2);
    let most = allowed.limits.texture_bytes;
    if bytes > most { Err(Refused::Effort(most).into()) } else { Ok(()) }
}

/// The picture within the plane of a layer's coordinates.
#[derive(Clone, Copy, Debug)]
struct Window {
    /// Where the layer's first pixel is in the picture.
    offset: (i64, i64),
    size: (u32, u32),
}

impl Window {
    /// The display window of a file; where the layer is all outside of it, the layer.
    fn of(header: &Header) -> Self {
        let (data, display) = (header.data_window(), header.shared_attributes.display_window);
        let along = |data: i32, length: usize, display: i32, all: usize| {
            let offset = i64::from(data) - i64::from(display);
            (offset < all as i64 && offset + length as i64 > 0).then_some(offset)
        };
        let x = along(data.position.x(), data.size.width(), display.position.x(), display.size.width());
        let y = along(data.position.y(), data.size.height(), display.position.y(), display.size.height());
        let size = |size: exr::math::Vec2<usize>| {
            [size.width(), size.height()].map(|edge| u32::try_from(edge).unwrap_or(u32::MAX)).into()
        };
        match (x, y) {
            (Some(x), Some(y)) => Self { offset: (x, y), size: size(display.size) },
            _ => Self { offset: (0, 0), size: size(data.size) },
        }
    }

    /// The place in the picture of a pixel of the layer.
    fn place(&self, x: usize, y: usize) -> Option<(u32, u32)> {
        let within = |at: usize, offset: i64, edge: u32| u32::try_from(at as i64 + offset).ok().filter(|at| *at < edge);
        Some((within(x, self.offset.0, self.size.0)?, within(y, self.offset.1, self.size.1)?))
    }
}

/// What is shown of a file.
#[derive(Debug)]
struct Layer {
    /// Among the headers.
    index: usize,
    /// Which channels are red, green and blue.
    channels: [usize; 3],
    window: Window,
    /// It holds the faces of a cube.
    is_cube: bool,
}

impl Layer {
    /// Colours rather than grey, and those of the whole picture rather than those with a prefix.
    fn best<R: Read + Seek>(reader: &Reader<R>) -> Option<Self> {
        let ranked =
            reader.headers().iter().enumerate().filter(|(_, header)| !header.deep).filter_map(|(index, header)| {
                let (rank, channels) = colors(header)?;
                let is_cube = header.own_attributes.environment_map == Some(EnvironmentMap::Cube);
                Some((rank, Self { index, channels, window: Window::of(header), is_cube }))
            });
        // The first of the best.
        ranked.min_by_key(|(rank, _)| *rank).map(|(_, layer)| layer)
    }

    /// Paints a block.
    fn paint(&self, block: &UncompressedBlock, header: &Header, canvas: &mut Canvas) -> Result<(), SkyError> {
        let BlockIndex { pixel_position, pixel_size, .. } = block.index;
        let (left, width) = (pixel_position.x(), pixel_size.width());
        let kinds = self.channels.map(|channel| header.channels.list[channel].sample_type);
        // All channels of a row, then those of the next.
        let mut row: Vec<&[u8]> = vec![&[]; header.channels.list.len()];
        for line in block.lines(&header.channels) {
            let channel = line.location.channel;
            row[channel] = line.value;
            if channel + 1 < row.len() {
                continue;
            }
            let y = line.location.position.y();
            let values = [0, 1, 2].map(|color| (row[self.channels[color]], kinds[color]));
            for i in 0..width {
                let Some((x, y)) = self.window.place(left + i, y) else { continue };
                let mut color = [0.0; 3];
                for (to, (bytes, kind)) in color.iter_mut().zip(values) {
                    *to = sample(bytes, kind, i).ok_or(exr::error::Error::Invalid("block size".into()))?;
                }
                canvas.paint(x, y, color);
            }
        }
        Ok(())
    }
}

/// A value of a row.
fn sample(row: &[u8], kind: SampleType, i: usize) -> Option<f32> {
    let four = || row.as_chunks().0.get(i).copied();
    match kind {
        SampleType::F16 => row.as_chunks().0.get(i).map(|&bytes| f16::from_ne_bytes(bytes).to_f32()),
        SampleType::F32 => four().map(f32::from_ne_bytes),
        SampleType::U32 => four().map(|bytes| u32::from_ne_bytes(bytes) as f32),
    }
}

/// The channels of a layer that are its colours, and how good a choice they are: less is better.
fn colors(header: &Header) -> Option<(u8, [usize; 3])> {
    // By prefix: the order in which it first comes, and its channels.
    let mut groups: HashMap<String, (usize, [Option<usize>; 4])> = HashMap::new();
    for (channel, description) in header.channels.list.iter().enumerate() {
        let name = description.name.to_string();
        let (prefix, last) = name.rsplit_once('.').unwrap_or(("", &name));
        let kind = match last {
            "R" | "r" => 0,
            "G" | "g" => 1,
            "B" | "b" => 2,
            "Y" | "y" | "L" => 3,
            _ => continue,
        };
        let order = groups.len();
        groups.entry(prefix.to_owned()).or_insert((order, [None; 4])).1[kind] = Some(channel);
    }
    let ranked = groups.into_iter().filter_map(|(prefix, (order, found))| {
        let rank = match &*prefix {
            "" => 0,
            // What Blender calls the finished picture of a layer.
            _ if prefix.ends_with("Combined") => 1,
            _ => 2,
        };
        match found {
            [Some(red), Some(green), Some(blue), _] => Some((rank, order, [red, green, blue])),
            [.., Some(grey)] => Some((rank + 3, order, [grey; 3])),
            _ => None,
        }
    });
    ranked.min_by_key(|&(rank, order, _)| (rank, order)).map(|(rank, _, channels)| (rank, channels))
}

/// What channels there are, for messages.
fn channels<R: Read + Seek>(reader: &Reader<R>) -> String {
    let names = reader.headers().iter().filter(|header| !header.deep).flat_map(|header| &header.channels.list);
    let names: Vec<String> = names.map(|channel| channel.name.to_string()).collect();
    if names.is_empty() { "none that can be read".to_owned() } else { shortened(&names.join(", ")) }
}

fn one_line(error: &exr::error::Error) -> String {
    error.to_string().split_ascii_whitespace().collect::<Vec<_>>().join(" ")
}
