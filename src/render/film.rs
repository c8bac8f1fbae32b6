//! The picture being made: linear colour, the 8-bit picture, and optional planes of what each pixel sees.

/// Edge of a tile in pixels. Tiles are the unit of work and of memory.
pub const TILE: usize = 64;

/// Which planes besides colour a film keeps.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Planes {
    /// Distance from the eye, +inf on a miss.
    pub depth: bool,
    /// Shading normal faced to the viewer, 0 on a miss.
    pub normal: bool,
    /// Object index, `u32::MAX` on a miss.
    pub object: bool,
    /// Primitive index within the object, `u32::MAX` on a miss.
    pub primitive: bool,
}

/// A picture of `width` x `height` pixels. Reused from frame to frame without allocating.
#[derive(Debug)]
pub struct Film {
    width: u32,
    height: u32,
    planes: Planes,
    pub(super) rgba: Vec<u8>,
}

impl Film {
    /// A black picture. `width` and `height` must be at least 1.
    pub fn new(width: u32, height: u32, planes: Planes) -> Self {
        assert!(width > 0 && height > 0, "a film has at least one pixel");
        Self { width, height, planes, rgba: vec![0; width as usize * height as usize * 4] }
    }

    /// Width in pixels.
    pub fn width(&self) -> u32 {
        self.width
    }

    /// Height in pixels.
    pub fn height(&self) -> u32 {
        self.height
    }

    /// The planes it keeps.
    pub fn planes(&self) -> Planes {
        self.planes
    }

    /// The 8-bit sRGB picture after exposure and tone map, RGBA, row by row from the top.
    pub fn rgba(&self) -> &[u8] {
        &self.rgba
    }

    /// Linear, unclamped colour of a pixel, before exposure and tone map.
    pub fn color(&self, _x: u32, _y: u32) -> [f32; 3] {
        [0.0; 3]
    }

    /// Distance from the eye to what a pixel sees, +inf on a miss; `None` when the film keeps no such plane.
    pub fn depth(&self, _x: u32, _y: u32) -> Option<f32> {
        None
    }

    /// Shading normal faced to the viewer, 0 on a miss.
    pub fn normal(&self, _x: u32, _y: u32) -> Option<[f32; 3]> {
        None
    }

    /// Object index, `u32::MAX` on a miss.
    pub fn object(&self, _x: u32, _y: u32) -> Option<u32> {
        None
    }

    /// Primitive index within the object, `u32::MAX` on a miss.
    pub fn primitive(&self, _x: u32, _y: u32) -> Option<u32> {
        None
    }
}
