//! PNG with text in it: what made the picture travels with it.

use super::format::Sink;
use super::{EightBit, PictureError};

/// A keyword and its text, as PNG keeps them.
pub type Note = (&'static str, String);

/// Writes `picture` as 8-bit RGB with `notes` before the pixels: as `tEXt`, which everything reads, or as `iTXt` where
/// the text has letters beyond ASCII.
///
/// # Errors
/// [`PictureError::Encode`] with the encoder's or the sink's reason.
pub fn write_annotated(picture: &EightBit, notes: &[Note], sink: &mut dyn Sink) -> Result<(), PictureError> {
    let mut encoder = png::Encoder::new(sink, picture.width, picture.height);
    encoder.set_color(png::ColorType::Rgb);
    encoder.set_depth(png::BitDepth::Eight);
    encoder.set_source_srgb(png::SrgbRenderingIntent::Perceptual);
    for (keyword, text) in notes {
        let (keyword, text) = ((*keyword).to_owned(), text.clone());
        if text.is_ascii() { encoder.add_text_chunk(keyword, text) } else { encoder.add_itxt_chunk(keyword, text) }?;
    }
    let mut writer = encoder.write_header()?;
    writer.write_image_data(&picture.rgb)?;
    Ok(writer.finish()?)
}

impl From<png::EncodingError> for PictureError {
    fn from(error: png::EncodingError) -> Self {
        Self::Encode(error.to_string())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::io::Cursor;

    #[test]
    fn text_and_pixels_are_read_back() {
        let picture = EightBit { width: 5, height: 3, rgb: (0..45).collect() };
        let notes = [("Software", "raywalk".to_owned()), ("Comment", "Львів, 45°".to_owned())];
        let mut bytes = Cursor::new(Vec::new());
        write_annotated(&picture, &notes, &mut bytes).expect("memory takes it");
        bytes.set_position(0);
        let mut reader = png::Decoder::new(bytes).read_info().expect("a PNG");
        let mut rgb = vec![0; reader.output_buffer_size().expect("small")];
        reader.next_frame(&mut rgb).expect("whole");
        assert_eq!(rgb, picture.rgb);
        let info = reader.info();
        let plain = &info.uncompressed_latin1_text[0];
        assert_eq!((plain.keyword.as_str(), plain.text.as_str()), ("Software", "raywalk"));
        let wide = &info.utf8_text[0];
        assert_eq!((wide.keyword.as_str(), wide.get_text().expect("text").as_str()), ("Comment", "Львів, 45°"));
    }
}
