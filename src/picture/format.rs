//! The list of picture formats that can be written.

use super::{EightBit, PictureError, eight_bit, exr, ppm};
use crate::render::Film;
use std::io::{Seek, Write};
use std::path::Path;

/// Where an encoder writes to.
pub trait Sink: Write + Seek {}
impl<T: Write + Seek> Sink for T {}

/// How a picture is written, where its format leaves a choice.
#[derive(Clone, Copy, Debug, Default)]
pub struct WriteOptions {
    /// PPM: raw bytes (P6) instead of text (P3).
    pub binary: bool,
}

/// What a format keeps of a film.
enum Encoder {
    /// The 8-bit sRGB picture.
    EightBit(fn(&EightBit, WriteOptions, &mut dyn Sink) -> Result<(), PictureError>),
    /// Linear colour and the film's planes.
    Linear(fn(&Film, &mut dyn Sink) -> Result<(), PictureError>),
}

/// One format: its extensions and its encoder.
pub struct Format {
    /// Extensions in lower case, without the dot; the first is the usual one.
    pub extensions: &'static [&'static str],
    /// One line of help.
    pub help: &'static str,
    /// Greatest width and height, where the format has one below that of a film.
    pub max_side: Option<u32>,
    encoder: Encoder,
}

/// Every format that can be written.
pub const FORMATS: &[Format] = &[
    Format { extensions: &["png"], help: "8-bit sRGB", max_side: None, encoder: Encoder::EightBit(eight_bit::png) },
    Format {
        extensions: &["jpg", "jpeg"],
        help: "8-bit sRGB, quality 95",
        max_side: Some(65_535),
        encoder: Encoder::EightBit(eight_bit::jpeg),
    },
    Format { extensions: &["bmp"], help: "8-bit sRGB", max_side: None, encoder: Encoder::EightBit(eight_bit::bmp) },
    Format {
        extensions: &["ppm"],
        help: "8-bit sRGB as text (P3), or raw (P6)",
        max_side: None,
        encoder: Encoder::EightBit(ppm::ppm),
    },
    Format {
        extensions: &["exr"],
        help: "linear and unclamped, before exposure and tone map, with the planes asked for",
        max_side: None,
        encoder: Encoder::Linear(exr::exr),
    },
];

impl Format {
    /// The format of `path` by its extension, in any case of letters.
    ///
    /// # Errors
    /// [`PictureError::UnknownExtension`], listing the known ones.
    pub fn of(path: &Path) -> Result<&'static Self, PictureError> {
        let extension = path.extension().and_then(|e| e.to_str()).unwrap_or_default().to_ascii_lowercase();
        FORMATS
            .iter()
            .find(|f| f.extensions.contains(&extension.as_str()))
            .ok_or_else(|| PictureError::UnknownExtension { path: path.to_owned(), known: Self::known() })
    }

    /// All extensions, as listed in messages.
    pub fn known() -> String {
        let names: Vec<String> = FORMATS.iter().map(|f| format!(".{}", f.extensions[0])).collect();
        names.join(" ")
    }

    /// Whether it keeps linear colour and the film's planes.
    pub fn keeps_planes(&self) -> bool {
        matches!(self.encoder, Encoder::Linear(_))
    }

    /// Refuses a size that the format cannot hold, before anything is rendered.
    ///
    /// # Errors
    /// [`PictureError::TooLargeForFormat`], naming `path`.
    pub fn check_size(&self, path: &Path, width: u32, height: u32) -> Result<(), PictureError> {
        match self.max_side {
            Some(limit) if width.max(height) > limit => {
                Err(PictureError::TooLargeForFormat { path: path.to_owned(), width, height, limit })
            }
            _ => Ok(()),
        }
    }

    /// Writes what this format keeps of `film`.
    ///
    /// # Errors
    /// [`PictureError::Encode`] with the encoder's or the sink's reason.
    pub fn write_film(&self, film: &Film, options: WriteOptions, sink: &mut dyn Sink) -> Result<(), PictureError> {
        match self.encoder {
            Encoder::EightBit(encode) => encode(&EightBit::of_film(film), options, sink),
            Encoder::Linear(encode) => encode(film, sink),
        }
    }

    /// Writes a picture that is no film, such as a difference.
    ///
    /// # Errors
    /// [`PictureError::Encode`] with the encoder's or the sink's reason, or because this format keeps linear colour.
    pub fn write_eight_bit(&self, picture: &EightBit, sink: &mut dyn Sink) -> Result<(), PictureError> {
        match self.encoder {
            Encoder::EightBit(encode) => encode(picture, WriteOptions::default(), sink),
            Encoder::Linear(_) => Err(PictureError::Encode("this format keeps linear colour only".to_owned())),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_format_is_found_by_its_extension_in_any_case() {
        for (name, usual) in [("a.png", "png"), ("a.b.JPEG", "jpg"), ("x.Exr", "exr"), ("/d.e/f.ppm", "ppm")] {
            assert_eq!(Format::of(Path::new(name)).expect("known").extensions[0], usual);
        }
        for name in ["a", "a.", ".png", "a.webp", ""] {
            let error = Format::of(Path::new(name)).err().expect("unknown").to_string();
            assert!(error.contains(".png .jpg .bmp .ppm .exr"), "{error}");
        }
    }

    #[test]
    fn extensions_are_unique_and_only_exr_keeps_planes() {
        let all: Vec<_> = FORMATS.iter().flat_map(|f| f.extensions).collect();
        for (i, extension) in all.iter().enumerate() {
            assert!(!all[..i].contains(extension), "{extension} twice");
        }
        assert!(FORMATS.iter().all(|f| f.keeps_planes() == (f.extensions == ["exr"])));
    }

    #[test]
    fn jpeg_refuses_sizes_it_cannot_hold() {
        let path = Path::new("wide.jpg");
        let jpeg = Format::of(path).expect("known");
        assert!(jpeg.check_size(path, 65_535, 1).is_ok());
        assert!(jpeg.check_size(path, 65_536, 1).is_err());
    }
}
