//! OpenEXR: linear, unclamped floats with the film's planes as further channels.
//!
//! Scan lines, ZIP, 32 bits a channel, no layer prefix: `R G B`, then what the film keeps of `depth`,
//! `normal.X normal.Y normal.Z`, `object` and `primitive` (the last two whole numbers).

use super::PictureError;
use super::format::Sink;
use crate::render::Film;
use exr::prelude::*;

/// Writes what `film` keeps.
pub(super) fn exr(film: &Film, sink: &mut dyn Sink) -> std::result::Result<(), PictureError> {
    let size = (film.width() as usize, film.height() as usize);
    let encoding =
        Encoding { compression: Compression::ZIP16, blocks: Blocks::ScanLines, line_order: LineOrder::Increasing };
    let layer = Layer::new(size, LayerAttributes::default(), encoding, AnyChannels::sort(channels(film).into()));
    Ok(Image::from_layer(layer).write().non_parallel().to_buffered(sink)?)
}

fn channels(film: &Film) -> Vec<AnyChannel<FlatSamples>> {
    let planes = film.planes();
    let mut channels: Vec<_> = ["R", "G", "B"]
        .into_iter()
        .enumerate()
        .map(|(i, name)| floats(name, film, |x, y| film.color(x, y)[i]))
        .collect();
    if planes.depth {
        channels.push(floats("depth", film, |x, y| film.depth(x, y).unwrap_or(f32::INFINITY)));
    }
    if planes.normal {
        for (i, name) in ["normal.X", "normal.Y", "normal.Z"].into_iter().enumerate() {
            channels.push(floats(name, film, |x, y| film.normal(x, y).unwrap_or_default()[i]));
        }
    }
    if planes.object {
        channels.push(indices("object", film, |x, y| film.object(x, y).unwrap_or(u32::MAX)));
    }
    if planes.primitive {
        channels.push(indices("primitive", film, |x, y| film.primitive(x, y).unwrap_or(u32::MAX)));
    }
    channels
}

fn floats(name: &str, film: &Film, value: impl Fn(u32, u32) -> f32) -> AnyChannel<FlatSamples> {
    AnyChannel::new(name, FlatSamples::F32(pixels(film, value)))
}

fn indices(name: &str, film: &Film, value: impl Fn(u32, u32) -> u32) -> AnyChannel<FlatSamples> {
    AnyChannel::new(name, FlatSamples::U32(pixels(film, value)))
}

/// One value a pixel, row by row from the top.
fn pixels<T>(film: &Film, value: impl Fn(u32, u32) -> T) -> Vec<T> {
    (0..film.height()).flat_map(|y| (0..film.width()).map(move |x| (x, y))).map(|(x, y)| value(x, y)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::render::Planes;
    use std::io::Cursor;

    fn written(planes: Planes) -> Cursor<Vec<u8>> {
        let mut bytes = Cursor::new(Vec::new());
        exr(&Film::new(20, 33, planes), &mut bytes).expect("memory takes it");
        bytes.set_position(0);
        bytes
    }

    #[test]
    fn channels_are_named_and_typed_as_promised() {
        let all = Planes { depth: true, normal: true, object: true, primitive: true, ..Planes::default() };
        let meta = MetaData::read_from_buffered(written(all), true).expect("it is an EXR");
        assert_eq!(meta.headers.len(), 1);
        let header = &meta.headers[0];
        assert_eq!(header.own_attributes.layer_name, None);
        assert_eq!(header.compression, Compression::ZIP16);
        assert_eq!(header.blocks, exr::meta::BlockDescription::ScanLines);
        let found: Vec<_> = header.channels.list.iter().map(|c| (c.name.to_string(), c.sample_type)).collect();
        let expected = [
            ("B", SampleType::F32),
            ("G", SampleType::F32),
            ("R", SampleType::F32),
            ("depth", SampleType::F32),
            ("normal.X", SampleType::F32),
            ("normal.Y", SampleType::F32),
            ("normal.Z", SampleType::F32),
            ("object", SampleType::U32),
            ("primitive", SampleType::U32),
        ];
        assert_eq!(found, expected.map(|(name, kind)| (name.to_owned(), kind)));
    }

    #[test]
    fn only_the_planes_kept_are_written() {
        let meta = MetaData::read_from_buffered(written(Planes { depth: true, ..Planes::default() }), true);
        let header = &meta.expect("it is an EXR").headers[0];
        let found: Vec<_> = header.channels.list.iter().map(|c| c.name.to_string()).collect();
        assert_eq!(found, ["B", "G", "R", "depth"]);
        assert_eq!(header.layer_size, Vec2(20, 33));
    }
}
