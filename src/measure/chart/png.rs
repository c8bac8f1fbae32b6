//! SVG as pictures: charts, and texts for other pictures.

use crate::picture::EightBit;
use resvg::{tiny_skia, usvg};
use std::sync::{Arc, LazyLock};

/// The one font that pictures are written in, whatever the system has: the one of the window.
static FONTS: LazyLock<Arc<usvg::fontdb::Database>> = LazyLock::new(|| {
    let mut fonts = usvg::fontdb::Database::new();
    fonts.load_font_data(epaint_default_fonts::UBUNTU_LIGHT.to_vec());
    let family = fonts.faces().next().and_then(|face| face.families.first()).map(|(name, _)| name.clone());
    if let Some(family) = family {
        fonts.set_sans_serif_family(family);
    }
    Arc::new(fonts)
});

/// The picture of an SVG on white paper, `scale` pixels a unit.
///
/// # Errors
/// What is wrong with the SVG, which none of ours should cause.
pub fn rasterised(svg: &str, scale: f32) -> Result<EightBit, String> {
    let options = usvg::Options { fontdb: Arc::clone(&FONTS), ..usvg::Options::default() };
    let tree = usvg::Tree::from_str(svg, &options).map_err(|error| error.to_string())?;
    let size = tree.size().to_int_size().scale_by(scale).ok_or("the picture has no size")?;
    let mut pixels = tiny_skia::Pixmap::new(size.width(), size.height()).ok_or("the picture has no size")?;
    pixels.fill(tiny_skia::Color::WHITE);
    resvg::render(&tree, tiny_skia::Transform::from_scale(scale, scale), &mut pixels.as_mut());
    // On white paper nothing is transparent.
    let rgb = pixels.pixels().iter().flat_map(|pixel| [pixel.red(), pixel.green(), pixel.blue()]).collect();
    Ok(EightBit { width: size.width(), height: size.height(), rgb })
}
