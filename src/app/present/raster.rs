//! egui's triangles, rasterised on the CPU.
//!
//! Without a GPU, a software adapter would run egui's shaders at some hundred nanoseconds a pixel, in time that the
//! tracer needs; a panel of this program takes it 30 ms, and this rasteriser one.

use super::{PaintJob, PixelRect};
use egui::epaint::{ImageDelta, Mesh, Primitive, TextureId, Vertex};
use egui::{Color32, ColorImage, ImageData, Pos2, Rect, TexturesDelta};
use std::collections::HashMap;

/// A picture of premultiplied sRGB-encoded colours, and the textures that are painted with.
#[derive(Debug, Default)]
pub struct Raster {
    width: usize,
    height: usize,
    pixels: Vec<Color32>,
    used: Option<PixelRect>,
    textures: HashMap<TextureId, ColorImage>,
}

impl Raster {
    /// Paints `job` over nothing.
    pub fn paint(&mut self, job: &PaintJob) {
        let [width, height] = job.size.map(|side| side as usize);
        if (self.width, self.height) == (width, height) {
            self.erase();
        } else {
            (self.width, self.height) = (width, height);
            self.pixels.clear();
            self.pixels.resize(width * height, Color32::TRANSPARENT);
        }
        self.used = job.used_pixels();
        for clipped in &job.primitives {
            // Callbacks are for GPUs; the overlay makes none.
            let Primitive::Mesh(mesh) = &clipped.primitive else { continue };
            let Some(texture) = self.textures.get(&mesh.texture_id) else { continue };
            let clip = job.clip_pixels(clipped.clip_rect);
            let mut target = Target { pixels: &mut self.pixels, stride: width, clip };
            target.mesh(mesh, texture, job.pixels_per_point);
        }
    }

    /// Textures to be there before painting.
    pub fn set_textures(&mut self, textures: &mut TexturesDelta) {
        for (id, deltas) in textures.set.drain() {
            for delta in deltas {
                self.set_texture(id, delta);
            }
        }
    }

    /// Textures not needed after painting.
    pub fn free_textures(&mut self, textures: &mut TexturesDelta) {
        for id in textures.free.drain() {
            self.textures.remove(&id);
        }
    }

    /// The part that shows anything.
    pub fn used(&self) -> Option<PixelRect> {
        self.used
    }

    /// Width and height in pixels.
    pub fn size(&self) -> [u32; 2] {
        [self.width as u32, self.height as u32]
    }

    /// A row of pixels.
    pub fn row(&self, y: u32) -> &[Color32] {
        &self.pixels[y as usize * self.width..][..self.width]
    }

    fn erase(&mut self) {
        let Some([left, top, width, height]) = self.used.map(|rect| rect.map(|side| side as usize)) else { return };
        for y in top..top + height {
            self.pixels[y * self.width + left..][..width].fill(Color32::TRANSPARENT);
        }
    }

    fn set_texture(&mut self, id: TextureId, delta: ImageDelta) {
        let ImageData::Color(image) = delta.image;
        let Some([left, top]) = delta.pos else {
            self.textures.insert(id, (*image).clone());
            return;
        };
        let Some(texture) = self.textures.get_mut(&id) else { return };
        let [width, height] = image.size;
        let [texture_width, texture_height] = texture.size;
        if left + width > texture_width || top + height > texture_height {
            return;
        }
        for y in 0..height {
            let row = &mut texture.pixels[(top + y) * texture_width + left..][..width];
            row.copy_from_slice(&image.pixels[y * width..][..width]);
        }
    }
}

/// Colour and texture coordinates at a place of a triangle: what is interpolated over it.
#[derive(Clone, Copy)]
struct Varying {
    color: [f32; 4],
    uv: [f32; 2],
}

impl Varying {
    fn of(vertex: &Vertex, texture: &ColorImage) -> Self {
        let uv = [vertex.uv.x * texture.size[0] as f32, vertex.uv.y * texture.size[1] as f32];
        Self { color: vertex.color.to_array().map(f32::from), uv }
    }

    fn weighted(parts: [(f32, Self); 3]) -> Self {
        let mut sum = Self { color: [0.0; 4], uv: [0.0; 2] };
        for (weight, part) in parts {
            (0..4).for_each(|i| sum.color[i] += weight * part.color[i]);
            (0..2).for_each(|i| sum.uv[i] += weight * part.uv[i]);
        }
        sum
    }
}

/// An upright rectangle of one colour with a part of the texture, upright as well.
struct Glyph {
    place: Rect,
    uv: Rect,
    color: Color32,
}

impl Glyph {
    /// What the first two triangles of `indices` are, if they are one, as egui makes them: left to right, then down.
    fn first_of(mesh: &Mesh, indices: &[u32]) -> Option<Self> {
        let &[a, b, c, second_c, second_b, d] = indices.first_chunk::<6>()?;
        if (second_b, second_c) != (b, c) {
            return None;
        }
        let corner = |i: u32| mesh.vertices.get(i as usize);
        let (a, b, c, d) = (corner(a)?, corner(b)?, corner(c)?, corner(d)?);
        let is_upright = |a: Pos2, b: Pos2, c: Pos2, d: Pos2| {
            a.y == b.y && c.y == d.y && a.x == c.x && b.x == d.x && a.x < b.x && a.y < c.y
        };
        let is_one_color = [b, c, d].iter().all(|vertex| vertex.color == a.color);
        let is_one = is_one_color && is_upright(a.pos, b.pos, c.pos, d.pos) && is_upright(a.uv, b.uv, c.uv, d.uv);
        is_one.then(|| Self {
            place: Rect::from_min_max(a.pos, d.pos),
            uv: Rect::from_min_max(a.uv, d.uv),
            color: a.color,
        })
    }
}

/// Pixels being painted, within a clip rectangle.
struct Target<'a> {
    pixels: &'a mut [Color32],
    stride: usize,
    clip: PixelRect,
}

impl Target<'_> {
    fn mesh(&mut self, mesh: &Mesh, texture: &ColorImage, scale: f32) {
        let mut indices = mesh.indices.as_slice();
        while let [a, b, c, rest @ ..] = indices {
            if let Some(glyph) = Glyph::first_of(mesh, indices) {
                self.glyph(&glyph, texture, scale);
                indices = &indices[6..];
                continue;
            }
            let corners = [a, b, c].map(|&i| mesh.vertices.get(i as usize));
            if let [Some(a), Some(b), Some(c)] = corners {
                self.triangle([*a, *b, *c], texture, scale);
            }
            indices = rest;
        }
    }

    /// Lays texels of one colour row by row: most of what is painted, and most of that is nothing.
    fn glyph(&mut self, glyph: &Glyph, texture: &ColorImage, scale: f32) {
        let [left, top, width, height] = self.clip;
        let (place, uv) = (glyph.place * scale, glyph.uv);
        let [texture_width, texture_height] = texture.size;
        let step = |uv: f32, texels: usize, points: f32| uv * texels as f32 / points;
        let (du, dv) =
            (step(uv.width(), texture_width, place.width()), step(uv.height(), texture_height, place.height()));
        let texel = |from: f32, texels: usize, step: f32, at: f32| nearest(from * texels as f32 + step * at, texels);
        let span = columns(place.left(), place.right(), left, left + width);
        for row in columns(place.top(), place.bottom(), top, top + height) {
            let v = texel(uv.top(), texture_height, dv, row as f32 + 0.5 - place.top());
            let Some(texels) = texture.pixels.get(v * texture_width..(v + 1) * texture_width) else { return };
            let pixels = &mut self.pixels[row as usize * self.stride..][span.start as usize..span.end as usize];
            for (x, pixel) in span.clone().zip(pixels) {
                let u = texel(uv.left(), texture_width, du, x as f32 + 0.5 - place.left());
                match texels.get(u) {
                    None | Some(&Color32::TRANSPARENT) => {}
                    Some(&texel) => lay(tinted(glyph.color, texel), pixel),
                }
            }
        }
    }

    /// Fills the pixels whose centres lie inside; centres on a shared edge belong to one side only.
    fn triangle(&mut self, vertices: [Vertex; 3], texture: &ColorImage, scale: f32) {
        let [a, b, c] = vertices.map(|vertex| Pos2::new(vertex.pos.x * scale, vertex.pos.y * scale));
        let area = (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
        if !area.is_finite() || area == 0.0 {
            return;
        }
        let [left, top, width, height] = self.clip;
        let (first_row, last_row) = (a.y.min(b.y).min(c.y), a.y.max(b.y).max(c.y));
        let rows = columns(first_row, last_row, top, top + height);
        let varyings = vertices.map(|vertex| Varying::of(&vertex, texture));
        let flat = vertices.iter().all(|v| v.uv == vertices[0].uv && v.color == vertices[0].color);
        let flat = flat.then(|| shade(varyings[0], texture));
        let at = |x: f32, y: f32| {
            let weight_b = ((x - a.x) * (c.y - a.y) - (y - a.y) * (c.x - a.x)) / area;
            let weight_c = ((b.x - a.x) * (y - a.y) - (b.y - a.y) * (x - a.x)) / area;
            let weights = [1.0 - weight_b - weight_c, weight_b, weight_c];
            Varying::weighted([(weights[0], varyings[0]), (weights[1], varyings[1]), (weights[2], varyings[2])])
        };
        for row in rows {
            let y = row as f32 + 0.5;
            let (mut from, mut to) = (f32::INFINITY, f32::NEG_INFINITY);
            for x in [(a, b), (b, c), (c, a)].into_iter().filter_map(|(p, q)| crossing(p, q, y)) {
                (from, to) = (from.min(x), to.max(x));
            }
            let span = columns(from, to, left, left + width);
            let pixels = &mut self.pixels[row as usize * self.stride..][span.start as usize..span.end as usize];
            match flat {
                Some(color) if color.a() == 255 => pixels.fill(color),
                Some(color) => pixels.iter_mut().for_each(|pixel| lay(color, pixel)),
                None => {
                    for (x, pixel) in span.zip(pixels) {
                        lay(shade(at(x as f32 + 0.5, y), texture), pixel);
                    }
                }
            }
        }
    }
}

/// Where the edge from `p` to `q` crosses the horizontal line at `y`. Taken from the upper end whichever way the edge
/// runs, so that both triangles that share it agree to the bit.
fn crossing(p: Pos2, q: Pos2, y: f32) -> Option<f32> {
    let (upper, lower) = if p.y <= q.y { (p, q) } else { (q, p) };
    let inside = upper.y <= y && y < lower.y;
    inside.then(|| upper.x + (y - upper.y) * ((lower.x - upper.x) / (lower.y - upper.y)))
}

/// The pixels whose centres lie in `[from, to)`, within `[least, end)`.
fn columns(from: f32, to: f32, least: u32, end: u32) -> std::ops::Range<u32> {
    let first = ((from - 0.5).ceil().max(0.0) as u32).clamp(least, end);
    let last = ((to - 0.5).ceil().max(0.0) as u32).clamp(first, end);
    first..last
}

/// Colour times texel. Glyphs are drawn at the size they were rasterised in, so the nearest texel is the right one.
fn shade(varying: Varying, texture: &ColorImage) -> Color32 {
    let [width, height] = texture.size;
    let index = nearest(varying.uv[1], height) * width + nearest(varying.uv[0], width);
    let texel = texture.pixels.get(index).copied().unwrap_or(Color32::WHITE).to_array();
    let [r, g, b, a]: [u8; 4] = std::array::from_fn(|i| (varying.color[i] * f32::from(texel[i]) / 255.0 + 0.5) as u8);
    Color32::from_rgba_premultiplied(r, g, b, a)
}

/// The texel that a coordinate in texels lies in.
fn nearest(at: f32, texels: usize) -> usize {
    (at.max(0.0) as usize).min(texels.saturating_sub(1))
}

/// One colour times a texel.
fn tinted(color: Color32, texel: Color32) -> Color32 {
    let times = |a: u8, b: u8| ((2 * u32::from(a) * u32::from(b) + 255) / 510) as u8;
    let ([r, g, b, a], [s, t, u, v]) = (color.to_array(), texel.to_array());
    Color32::from_rgba_premultiplied(times(r, s), times(g, t), times(b, u), times(a, v))
}

fn lay(color: Color32, pixel: &mut Color32) {
    let [r, g, b, a] = over(color.to_array(), pixel.to_array());
    *pixel = Color32::from_rgba_premultiplied(r, g, b, a);
}

/// Premultiplied `color` over `below`, any order of channels with alpha last.
pub fn over(color: [u8; 4], below: [u8; 4]) -> [u8; 4] {
    // Two channels at a time in the halves of a word: half the time of one by one, which matters as it is done for
    // every pixel under the panel in every frame.
    const LOW_BYTES: u32 = 0x00ff_00ff;
    let through = 255 - u32::from(color[3]);
    let (color, below) = (u32::from_le_bytes(color), u32::from_le_bytes(below));
    let pair = |color: u32, below: u32| {
        // Exact rounding of a division by 255.
        let product = (below & LOW_BYTES) * through + 0x0080_0080;
        let quotient = ((product + ((product >> 8) & LOW_BYTES)) >> 8) & LOW_BYTES;
        let sum = quotient + (color & LOW_BYTES);
        // Colours that only add light have no alpha: what exceeds a byte stays at its end.
        (sum | (((sum >> 8) & 0x0001_0001) * 255)) & LOW_BYTES
    };
    (pair(color, below) | (pair(color >> 8, below >> 8) << 8)).to_le_bytes()
}

#[cfg(test)]
mod tests {
    use super::*;
    use egui::epaint::{ClippedPrimitive, textures::TextureOptions};
    use egui::pos2;

    const FONT: TextureId = TextureId::Managed(0);

    /// A painter whose texture is white in the corner and has one pixel of half a red one.
    fn raster() -> Raster {
        let mut image = ColorImage::filled([4, 4], Color32::WHITE);
        image.pixels[5] = Color32::from_rgba_premultiplied(128, 0, 0, 128);
        let mut textures = TexturesDelta::default();
        textures.push(FONT, ImageDelta::full(image, TextureOptions::LINEAR));
        let mut raster = Raster::default();
        raster.set_textures(&mut textures);
        raster
    }

    fn job(meshes: Vec<Mesh>, clip: Rect) -> PaintJob {
        let primitives =
            meshes.into_iter().map(|mesh| ClippedPrimitive { clip_rect: clip, primitive: Primitive::Mesh(mesh) });
        PaintJob { primitives: primitives.collect(), size: [16, 12], pixels_per_point: 1.0 }
    }

    fn rect(left: f32, top: f32, right: f32, bottom: f32) -> Rect {
        Rect::from_min_max(pos2(left, top), pos2(right, bottom))
    }

    fn colored(rect: Rect, color: Color32) -> Mesh {
        let mut mesh = Mesh::with_texture(FONT);
        mesh.add_colored_rect(rect, color);
        mesh
    }

    #[test]
    fn a_rectangle_covers_its_pixels_once_within_the_clip() {
        let mut raster = raster();
        let veil = Color32::from_rgba_premultiplied(60, 40, 20, 128);
        raster.paint(&job(vec![colored(rect(2.0, 1.0, 20.0, 9.0), veil)], rect(0.0, 0.0, 14.0, 8.0)));
        for y in 0..12 {
            for x in 0..16 {
                let inside = (2..14).contains(&x) && (1..8).contains(&y);
                let expected = if inside { veil } else { Color32::TRANSPARENT };
                assert_eq!(raster.row(y)[x as usize], expected, "({x}, {y})");
            }
        }
        assert_eq!(raster.used(), Some([2, 1, 12, 7]));
        raster.paint(&job(Vec::new(), Rect::EVERYTHING));
        assert!((0..12).all(|y| raster.row(y).iter().all(|pixel| *pixel == Color32::TRANSPARENT)), "erased");
        assert_eq!(raster.used(), None);
    }

    #[test]
    fn a_fan_of_slanted_triangles_leaves_no_gap_and_no_overlap() {
        let mut mesh = Mesh::with_texture(FONT);
        let veil = Color32::from_rgba_premultiplied(10, 10, 10, 100);
        for (x, y) in [(7.3, 5.1), (1.0, 1.0), (15.0, 1.0), (15.0, 11.0), (1.0, 11.0)] {
            mesh.colored_vertex(pos2(x, y), veil);
        }
        for i in 1..5 {
            mesh.add_triangle(0, i, i % 4 + 1);
        }
        let mut raster = raster();
        raster.paint(&job(vec![mesh], Rect::EVERYTHING));
        for y in 1..11 {
            assert!(raster.row(y)[1..15].iter().all(|pixel| *pixel == veil), "row {y}");
        }
    }

    #[test]
    fn texels_arrive_where_they_belong_and_are_laid_over() {
        let mut raster = raster();
        let mut glyph = Mesh::with_texture(FONT);
        glyph.add_rect_with_uv(rect(3.0, 3.0, 7.0, 7.0), rect(0.0, 0.0, 1.0, 1.0), Color32::WHITE);
        let below = colored(rect(0.0, 0.0, 16.0, 12.0), Color32::from_rgb(0, 200, 0));
        raster.paint(&job(vec![below, glyph], Rect::EVERYTHING));
        assert_eq!(raster.row(4)[4], Color32::from_rgb(128, 100, 0));
        assert_eq!(raster.row(3)[3], Color32::WHITE);
        assert_eq!(raster.row(7)[3], Color32::from_rgb(0, 200, 0));
    }

    #[test]
    fn glyphs_are_what_their_triangles_are() {
        let raster_of = |mesh: Mesh, clip: Rect| {
            let mut raster = raster();
            raster.paint(&job(vec![mesh], clip));
            (0..12).flat_map(|y| raster.row(y).to_vec()).collect::<Vec<_>>()
        };
        let clips = [Rect::EVERYTHING, rect(3.0, 2.0, 9.0, 7.0)];
        let mut random = crate::math::random::SplitMix64(7);
        for i in 0..200 {
            let mut at = |least: f64, most: f64| random.within(least, most) as f32;
            let (x, y) = (at(-3.0, 12.0), at(-3.0, 9.0));
            let place = rect(x, y, x + at(0.1, 9.0), y + at(0.1, 9.0));
            let (u, v) = (at(0.0, 0.7), at(0.0, 0.7));
            let uv = rect(u, v, u + at(0.01, 0.3), v + at(0.01, 0.3));
            let mut glyph = Mesh::with_texture(FONT);
            glyph.add_rect_with_uv(place, uv, Color32::from_rgba_premultiplied(90, 60, 30, 120));
            assert!(Glyph::first_of(&glyph, &glyph.indices).is_some());
            let mut triangles = glyph.clone();
            triangles.indices = [1, 2, 0, 1, 3, 2].into();
            assert!(Glyph::first_of(&triangles, &triangles.indices).is_none());
            let clip = clips[i % 2];
            let (glyph, triangles) = (raster_of(glyph, clip), raster_of(triangles, clip));
            // Where a pixel's centre lies on the border of two texels, rounding decides.
            let differing = glyph.iter().zip(&triangles).filter(|(a, b)| a != b).count();
            assert!(differing <= 2, "{differing} pixels of {place:?}");
        }
    }

    #[test]
    fn colours_run_between_corners() {
        let mut mesh = Mesh::with_texture(FONT);
        for (x, level) in [(0.0, 0), (16.0, 255), (0.0, 0), (16.0, 255)] {
            let y = if mesh.vertices.len() < 2 { 0.0 } else { 12.0 };
            mesh.colored_vertex(pos2(x, y), Color32::from_gray(level));
        }
        mesh.add_triangle(0, 1, 2);
        mesh.add_triangle(2, 1, 3);
        let mut raster = raster();
        raster.paint(&job(vec![mesh], Rect::EVERYTHING));
        for x in 0..16 {
            let expected = 255.0 * (x as f32 + 0.5) / 16.0;
            assert!((f32::from(raster.row(6)[x].r()) - expected).abs() <= 1.0, "{x}");
        }
    }

    #[test]
    fn what_cannot_be_painted_is_left_out() {
        let mut raster = raster();
        let mut broken = colored(rect(f32::NAN, 0.0, f32::INFINITY, 9.0), Color32::RED);
        broken.indices.extend([0, 1, 99]);
        let mut unknown = colored(rect(0.0, 0.0, 9.0, 9.0), Color32::RED);
        unknown.texture_id = TextureId::User(7);
        raster.paint(&job(vec![broken, unknown], Rect::EVERYTHING));
        assert!((0..12).all(|y| raster.row(y).iter().all(|pixel| *pixel == Color32::TRANSPARENT)));
    }

    #[test]
    fn laying_over_rounds_exactly() {
        for below in 0..=255_u8 {
            for alpha in 0..=255_u8 {
                let expected = (f64::from(below) * f64::from(255 - alpha) / 255.0).round() as u8;
                let seen = over([0, alpha, 0, alpha], [below; 4]);
                assert_eq!(seen[..3], [expected, expected.saturating_add(alpha), expected], "{below} under {alpha}");
            }
        }
        assert_eq!(over([9, 200, 255, 0], [250, 100, 1, 255]), [255, 255, 255, 255], "light that is only added");
    }
}
