//! Pictures as bits: what "same pixels" compares.

use raywalk::render::{Film, Planes, Scratch, render_frame};
use raywalk::scene::{Camera, Scene};
use raywalk::settings::Settings;

/// Every plane of a film, as bits.
#[derive(PartialEq, Eq)]
pub struct PictureBits {
    width: usize,
    /// Colour, depth, normal, object, primitive.
    pixels: Vec<[u32; 9]>,
}

const CHANNELS: [&str; 9] = ["R", "G", "B", "depth", "normal.X", "normal.Y", "normal.Z", "object", "primitive"];

impl PictureBits {
    /// Reads a film that keeps all planes.
    pub fn of(film: &Film) -> Self {
        let (width, height) = (film.width(), film.height());
        let bits = |x, y| {
            let [r, g, b] = film.color(x, y).map(f32::to_bits);
            let [nx, ny, nz] = film.normal(x, y).unwrap().map(f32::to_bits);
            let depth = film.depth(x, y).unwrap().to_bits();
            [r, g, b, depth, nx, ny, nz, film.object(x, y).unwrap(), film.primitive(x, y).unwrap()]
        };
        let pixels = (0..height).flat_map(|y| (0..width).map(move |x| bits(x, y))).collect();
        Self { width: width as usize, pixels }
    }

    /// Where this differs from `other`, in words; `None` where it does not.
    pub fn difference(&self, other: &Self) -> Option<String> {
        assert_eq!((self.width, self.pixels.len()), (other.width, other.pixels.len()));
        let differs = |&i: &usize| self.pixels[i] != other.pixels[i];
        let count = (0..self.pixels.len()).filter(differs).count();
        let first = (0..self.pixels.len()).find(differs)?;
        let (a, b) = (&self.pixels[first], &other.pixels[first]);
        let channel = (0..9).find(|&c| a[c] != b[c])?;
        let value = |bits: u32| if channel < 7 { f32::from_bits(bits).to_string() } else { bits.to_string() };
        Some(format!(
            "{count} pixels, the first at ({}, {}): {} is {} instead of {}",
            first % self.width,
            first / self.width,
            CHANNELS[channel],
            value(b[channel]),
            value(a[channel]),
        ))
    }

    /// How many pixels hold a number that is none.
    pub fn not_a_number(&self) -> usize {
        self.pixels.iter().filter(|p| p[..7].iter().any(|&bits| f32::from_bits(bits).is_nan())).count()
    }
}

/// A film that keeps every plane.
pub fn film((width, height): (u32, u32)) -> Film {
    Film::new(width, height, Planes { depth: true, normal: true, object: true, primitive: true, ..Planes::default() })
}

/// Renders one frame with a scratch of its own.
pub fn render(scene: &Scene, camera: &Camera, settings: &Settings, size: (u32, u32)) -> Film {
    let mut film = film(size);
    assert!(render_frame(scene, camera, settings, &mut Scratch::new(), &mut film).completed);
    film
}
