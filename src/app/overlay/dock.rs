//! Where the panel stands: beside the picture, which then has the rest of the window to itself.

use super::{Panel, Shown};
use crate::app::present::PixelRect;

/// Usual width of the panel in points, edges included.
const USUAL: f32 = 380.0;
/// A panel narrower than this cannot be read.
const LEAST: f32 = 280.0;
/// The panel's greatest share of the window's width.
const SHARE: f32 = 0.3;

/// Width of the panel in points beside the picture in a window of `width` points. `None` where it would take too much.
fn panel_width(width: f32) -> Option<f32> {
    let most = SHARE * width;
    (most >= LEAST).then(|| most.min(USUAL))
}

/// The same in whole pixels, for a window of `width` pixels.
pub fn panel_pixels(width: u32, pixels_per_point: f32) -> Option<u32> {
    panel_width(width as f32 / pixels_per_point).map(|points| (points * pixels_per_point) as u32)
}

/// The part of a window of `size` pixels that the picture has to itself: all of it, or what is right of the panel.
pub fn free_area(size: (u32, u32), pixels_per_point: f32, shown: Shown) -> PixelRect {
    let (width, height) = size;
    let panel = panel_pixels(width, pixels_per_point).filter(|_| shown.overlay && shown.panel != Panel::Closed);
    let left = panel.unwrap_or(0);
    [left, 0, width - left, height]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_panel_takes_30_percent_of_the_width_at_most() {
        for width in 1..5000_u32 {
            for scale in [1.0, 1.25, 1.5, 2.0, 3.0] {
                match panel_pixels(width, scale) {
                    Some(panel) => assert!(panel as f32 <= 0.3 * width as f32 && panel as f32 >= 0.99 * LEAST * scale),
                    None => assert!(0.3 * (width as f32) < LEAST * scale, "{width} at {scale}"),
                }
            }
        }
        assert_eq!(panel_pixels(1280, 1.0), Some(380));
        assert_eq!(panel_pixels(2560, 2.0), Some(760));
        assert_eq!(panel_pixels(640, 1.0), None);
        assert_eq!(panel_pixels(1280, 2.0), None, "640 points");
    }

    #[test]
    fn the_picture_has_what_the_panel_leaves() {
        let shown = |panel, overlay| Shown { overlay, panel, help: false };
        let area = |size, panel, overlay| free_area(size, 1.0, shown(panel, overlay));
        assert_eq!(area((1280, 720), Panel::Open, true), [380, 0, 900, 720]);
        assert_eq!(area((1280, 720), Panel::Closed, true), [0, 0, 1280, 720]);
        assert_eq!(area((1280, 720), Panel::Open, false), [0, 0, 1280, 720], "everything is hidden");
        assert_eq!(area((640, 480), Panel::Open, true), [0, 0, 640, 480], "it is collapsed");
        assert_eq!(area((640, 480), Panel::OverPicture, true), [0, 0, 640, 480]);
        assert_eq!(area((0, 0), Panel::Open, true), [0, 0, 0, 0]);
    }
}
