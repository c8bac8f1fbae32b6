//! The texels of a picture, laid out for filtered lookups by packets.

mod mean;
mod mip;
mod opacity;

use super::material::Encoding;
use super::texture::{Blending, Sampler, Wrap, linear_to_srgb, srgb_table};
use crate::math::V3;
use crate::math::power::log2;
use fearless_simd::Simd;
use fearless_simd::prelude::*;
use mip::{Channel, Coding};

/// Lane mask of native width.
type Mask<S> = <<S as Simd>::f32s as SimdBase<S>>::Mask;

/// A picture at its full size and, halved again and again, at smaller ones.
///
/// Texels lie in square tiles of one cache line each, so that the four around a point are mostly in one line, whichever
/// way neighbouring rays run over the picture. They stay as the file has them: decoded to linear light they would take
/// twice to four times the memory, and the cache with it.
#[derive(Clone, Debug, PartialEq)]
pub struct Texels {
    encoding: Encoding,
    /// The full size first. Never empty.
    levels: Box<[Level]>,
    /// Red, green, blue and opacity; 0 in what fills up the last tiles.
    texels: Store,
}

/// Texels, their channels from the lowest bits up.
#[derive(Clone, Debug, PartialEq)]
enum Store {
    /// Of 8 bits a channel.
    Bytes(Box<[u32]>),
    /// Of 16 bits a channel, which are linear.
    Words(Box<[u64]>),
}

/// One size of a picture.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Level {
    /// In texels, at least 1.
    width: u32,
    /// In texels, at least 1.
    height: u32,
    /// Texels from one row of tiles to the next.
    tile_row: u32,
    /// Where its texels begin.
    start: u32,
}

/// Base 2 logarithm of a tile's edge: 4 x 4 texels of 4 bytes are a cache line.
const TILE_SHIFT: u32 = 2;
/// Edge of a tile in texels.
const TILE: u32 = 1 << TILE_SHIFT;

/// What a lookup finds: linear colour or data, and opacity if that was asked for.
#[derive(Clone, Copy, Debug)]
pub struct Texel<S: Simd> {
    /// Red, green and blue.
    pub color: V3<S::f32s>,
    /// From 0 to 1; 0 if nobody asked.
    pub opacity: S::f32s,
}

impl<S: Simd> Texel<S> {
    #[inline(always)]
    fn select(mask: Mask<S>, a: Self, b: Self) -> Self {
        Self { color: V3::select(mask, a.color, b.color), opacity: mask.select(a.opacity, b.opacity) }
    }

    /// `a` and so much of `b` as `share` says.
    #[inline(always)]
    fn mix<const OPACITY: bool>(simd: S, a: Self, b: Self, share: S::f32s) -> Self {
        let rest = S::f32s::splat(simd, 1.0) - share;
        let color = a.color.scale(rest) + b.color.scale(share);
        Self { color, opacity: if OPACITY { a.opacity * rest + b.opacity * share } else { a.opacity } }
    }
}

impl Texels {
    /// From encoded texels, row by row from the top, with all smaller sizes if `mips`. `None` unless there are
    /// `width` x `height` of them, both at least 1, and few enough to be numbered by a u32.
    pub fn new(width: u32, height: u32, rows: &[[u8; 4]], encoding: Encoding, mips: bool) -> Option<Self> {
        let (levels, texels) = Self::laid_out(width, height, rows, &bytes(encoding), u32::from_le_bytes, mips)?;
        Some(Self { encoding, levels, texels: Store::Bytes(texels) })
    }

    /// From data of 16 bits a channel, likewise.
    pub fn of_words(width: u32, height: u32, rows: &[[u16; 4]], mips: bool) -> Option<Self> {
        let pack = |texel: [u16; 4]| texel.iter().rev().fold(0, |packed, word| packed << 16 | u64::from(*word));
        let (levels, texels) = Self::laid_out(width, height, rows, &words(), pack, mips)?;
        Some(Self { encoding: Encoding::Data, levels, texels: Store::Words(texels) })
    }

    #[allow(clippy::type_complexity, reason = "two lists that are taken apart at once")]
    fn laid_out<C: Channel, P: Copy + Default>(
        width: u32,
        height: u32,
        rows: &[[C; 4]],
        coding: &Coding<impl Fn(C) -> f32, impl Fn(f32) -> C>,
        pack: impl Fn([C; 4]) -> P,
        mips: bool,
    ) -> Option<(Box<[Level]>, Box<[P]>)> {
        if rows.is_empty() || rows.len() as u64 != u64::from(width) * u64::from(height) {
            return None;
        }
        let (levels, len) = Level::chain(width, height, mips)?;
        let mut texels = vec![P::default(); len as usize];
        levels[0].fill(rows, &mut texels, &pack);
        let mut smaller;
        let mut rows = rows;
        for pair in levels.windows(2) {
            smaller = mip::halve(rows, [pair[0].width, pair[0].height], [pair[1].width, pair[1].height], coding);
            pair[1].fill(&smaller, &mut texels, &pack);
            rows = &smaller;
        }
        Some((levels, texels.into()))
    }

    /// Width in texels, at least 1.
    pub fn width(&self) -> u32 {
        self.levels[0].width
    }

    /// Height in texels, at least 1.
    pub fn height(&self) -> u32 {
        self.levels[0].height
    }

    /// How many sizes there are, the full one included.
    pub fn levels(&self) -> usize {
        self.levels.len()
    }

    /// What the numbers are.
    pub fn encoding(&self) -> Encoding {
        self.encoding
    }

    /// Bytes that the texels take.
    pub fn bytes(&self) -> usize {
        match &self.texels {
            Store::Bytes(texels) => size_of_val(&**texels),
            Store::Words(texels) => size_of_val(&**texels),
        }
    }

    /// The encoded texel in column `x` of row `y` of a size, counted from the top left; all must be inside. Of channels of
    /// 16 bits, the upper 8.
    pub fn texel(&self, level: usize, x: u32, y: u32) -> [u8; 4] {
        let place = self.levels[level].place(x, y);
        match &self.texels {
            Store::Bytes(texels) => texels[place].to_le_bytes(),
            Store::Words(texels) => unpacked(texels[place]).map(|word| (word >> 8) as u8),
        }
    }

    /// Width and height of a size.
    pub fn size(&self, level: usize) -> [u32; 2] {
        [self.levels[level].width, self.levels[level].height]
    }

    /// Filtered lookup for the lanes in the bit set `lanes`; others get anything. The picture is 1 wide and 1 high;
    /// v = 0 is the bottom of the lowest row. `footprint2` is the square of how far neighbouring rays lie apart on the
    /// picture, in texels of the full size; `None` for no distance at all.
    #[inline(always)]
    pub(super) fn sample<S: Simd, const OPACITY: bool>(
        &self,
        simd: S,
        coordinates: [S::f32s; 2],
        footprint2: Option<S::f32s>,
        sampler: &Sampler,
        lanes: u64,
    ) -> Texel<S> {
        let zero = S::f32s::splat(simd, 0.0);
        // Half the logarithm of the square; what is not a number is looked up in full size.
        let one = S::f32s::splat(simd, 1.0);
        let Some(minified) = footprint2.filter(
            #[inline(always)]
            |footprint2| footprint2.simd_gt(one).to_bitmask() & lanes != 0,
        ) else {
            return self.sample_level::<S, OPACITY>(simd, coordinates, 0, sampler, sampler.magnification, lanes);
        };
        let is_minified = minified.simd_gt(one) & minified.simd_lt(S::f32s::splat(simd, f32::MAX));
        let Some(between) = sampler.between_levels.filter(|_| self.levels.len() > 1) else {
            let near = self.sample_level::<S, OPACITY>(simd, coordinates, 0, sampler, sampler.magnification, lanes);
            if sampler.minification == sampler.magnification {
                return near;
            }
            let far = self.sample_level::<S, OPACITY>(simd, coordinates, 0, sampler, sampler.minification, lanes);
            return Texel::select(is_minified, far, near);
        };
        let last = S::f32s::splat(simd, (self.levels.len() - 1) as f32);
        let detail = (log2::<S, S::f32s>(is_minified.select(minified, one)) * 0.5).min(last);
        let (level, share) = match between {
            // Near a size it is taken alone, as graphics hardware does: that saves a quarter of all lookups.
            Blending::Linear => {
                let level = (detail + 0.25).floor();
                (level, ((detail - level - 0.25) * 2.0).max(0.0))
            }
            Blending::Nearest => ((detail + 0.5).floor(), zero),
        };
        let mut found = Texel { color: V3::all(zero), opacity: zero };
        let mut left = lanes;
        while left != 0 {
            let number = level[left.trailing_zeros() as usize % S::f32s::LEN];
            let same = level.simd_eq(number);
            let own = same.to_bitmask() & left;
            left &= !own;
            let number = number as usize;
            let blending = sampler.minification;
            let mut texel = self.sample_level::<S, OPACITY>(simd, coordinates, number, sampler, blending, own);
            let blended = share.simd_gt(zero);
            let between = blended.to_bitmask() & own;
            if between != 0 {
                let coarser =
                    self.sample_level::<S, OPACITY>(simd, coordinates, number + 1, sampler, blending, between);
                texel = Texel::select(blended, Texel::mix::<OPACITY>(simd, texel, coarser, share), texel);
            }
            found = Texel::select(same, texel, found);
        }
        if sampler.magnification != sampler.minification {
            let magnified =
                self.sample_level::<S, OPACITY>(simd, coordinates, 0, sampler, sampler.magnification, lanes);
            found = Texel::select(is_minified, found, magnified);
        }
        found
    }

    /// Lookup in one size. Not inlined: it is called for every size and way of blending.
    fn sample_level<S: Simd, const OPACITY: bool>(
        &self,
        simd: S,
        coordinates: [S::f32s; 2],
        level: usize,
        sampler: &Sampler,
        blending: Blending,
        lanes: u64,
    ) -> Texel<S> {
        simd.vectorize(
            #[inline(always)]
            || {
                self.sample_level_inlined::<S, OPACITY>(
                    simd,
                    coordinates,
                    &self.levels[level],
                    sampler,
                    blending,
                    lanes,
                )
            },
        )
    }

    #[inline(always)]
    fn sample_level_inlined<S: Simd, const OPACITY: bool>(
        &self,
        simd: S,
        [u, v]: [S::f32s; 2],
        level: &Level,
        sampler: &Sampler,
        blending: Blending,
        lanes: u64,
    ) -> Texel<S> {
        let one = S::f32s::splat(simd, 1.0);
        let (left, right, across) = neighbours(simd, u, level.width, sampler.wrap[0], blending);
        // Rows are counted from the top, v from the bottom.
        let (upper, lower, down) = neighbours(simd, one - v, level.height, sampler.wrap[1], blending);
        let [left, right] = [columns::<S>(left), columns::<S>(right)];
        let [upper, lower] = [level.rows(simd, upper), level.rows(simd, lower)];
        let places = [upper + left, upper + right, lower + left, lower + right];
        let [upper_left, upper_right, lower_left, lower_right] = self.gather::<S, OPACITY>(simd, &places, lanes);
        let upper = Texel::mix::<OPACITY>(simd, upper_left, upper_right, across);
        let lower = Texel::mix::<OPACITY>(simd, lower_left, lower_right, across);
        Texel::mix::<OPACITY>(simd, upper, lower, down)
    }

    /// The texels at four places a lane, linear; 0 in the lanes that are not in the bit set `lanes`.
    #[inline(always)]
    fn gather<S: Simd, const OPACITY: bool>(&self, simd: S, places: &[S::u32s; 4], lanes: u64) -> [Texel<S>; 4] {
        match &self.texels {
            Store::Bytes(texels) => {
                let decode = decode_table(self.encoding);
                gather_with::<S, OPACITY>(
                    simd,
                    places,
                    lanes,
                    #[inline(always)]
                    |place| {
                        let [r, g, b, a] = texels[place].to_le_bytes();
                        ([r, g, b].map(|byte| decode[usize::from(byte)]), f32::from(a) * (1.0 / 255.0))
                    },
                )
            }
            Store::Words(texels) => gather_with::<S, OPACITY>(
                simd,
                places,
                lanes,
                #[inline(always)]
                |place| {
                    let [r, g, b, a] = unpacked(texels[place]).map(word_value);
                    ([r, g, b], a)
                },
            ),
        }
    }
}

/// What `texel` says of four places a lane.
///
/// All four of a lane in one round: its waits for memory overlap. Texels of [u16; 4] in linear light were a quarter
/// faster where they fit the cache, but slower where they do not, and no longer exact. Separate loops that load and
/// decode become gather instructions, which are slower than this.
#[inline(always)]
fn gather_with<S: Simd, const OPACITY: bool>(
    simd: S,
    places: &[S::u32s; 4],
    lanes: u64,
    texel: impl Fn(usize) -> ([f32; 3], f32),
) -> [Texel<S>; 4] {
    let zero = S::f32s::splat(simd, 0.0);
    let mut found = [Texel::<S> { color: V3::all(zero), opacity: zero }; 4];
    let mut left = lanes;
    while left != 0 {
        let lane = left.trailing_zeros() as usize % S::u32s::LEN;
        left &= left - 1;
        for (places, found) in places.iter().zip(&mut found) {
            let ([r, g, b], opacity) = texel(places[lane] as usize);
            found.color.x.as_mut_slice()[lane] = r;
            found.color.y.as_mut_slice()[lane] = g;
            found.color.z.as_mut_slice()[lane] = b;
            if OPACITY {
                found.opacity.as_mut_slice()[lane] = opacity;
            }
        }
    }
    found
}

/// The channels of a texel of 16 bits each.
#[inline(always)]
fn unpacked(texel: u64) -> [u16; 4] {
    [texel as u16, (texel >> 16) as u16, (texel >> 32) as u16, (texel >> 48) as u16]
}

/// What a channel of 16 bits stands for.
#[inline(always)]
fn word_value(word: u16) -> f32 {
    f32::from(word) / 65535.0
}

/// How channels of 8 bits are stored.
fn bytes(encoding: Encoding) -> Coding<impl Fn(u8) -> f32, impl Fn(f32) -> u8> {
    let decode = decode_table(encoding);
    let encode = move |value: f32| match encoding {
        Encoding::Color => linear_to_srgb(value),
        Encoding::Data => (value * 255.0 + 0.5) as u8,
    };
    Coding { decode: |byte: u8| decode[usize::from(byte)], encode }
}

/// How channels of 16 bits are stored.
fn words() -> Coding<impl Fn(u16) -> f32, impl Fn(f32) -> u16> {
    Coding { decode: word_value, encode: |value: f32| (value * 65535.0 + 0.5) as u16 }
}

impl Level {
    /// The sizes of a picture down to a single texel, or just the full one, and how many texels that makes.
    fn chain(mut width: u32, mut height: u32, mips: bool) -> Option<(Box<[Self]>, u32)> {
        let mut levels = Vec::new();
        let mut start = 0_u32;
        loop {
            let tile_row = width.div_ceil(TILE).checked_mul(TILE * TILE)?;
            levels.push(Self { width, height, tile_row, start });
            start = height.div_ceil(TILE).checked_mul(tile_row)?.checked_add(start)?;
            if !mips || (width == 1 && height == 1) {
                return Some((levels.into(), start));
            }
            (width, height) = ((width / 2).max(1), (height / 2).max(1));
        }
    }

    /// Puts rows in their places among all texels.
    fn fill<T: Copy, P>(&self, rows: &[T], texels: &mut [P], pack: impl Fn(T) -> P) {
        for (y, row) in (0..).zip(rows.chunks_exact(self.width as usize)) {
            for (x, texel) in (0..).zip(row) {
                texels[self.place(x, y)] = pack(*texel);
            }
        }
    }

    fn place(&self, x: u32, y: u32) -> usize {
        let column = ((x >> TILE_SHIFT) << (2 * TILE_SHIFT)) + (x & (TILE - 1));
        let row = (y >> TILE_SHIFT) * self.tile_row + ((y & (TILE - 1)) << TILE_SHIFT);
        (self.start + column + row) as usize
    }

    /// Where rows begin.
    #[inline(always)]
    fn rows<S: Simd>(&self, simd: S, y: S::u32s) -> S::u32s {
        (y >> TILE_SHIFT) * S::u32s::splat(simd, self.tile_row) + ((y & (TILE - 1)) << TILE_SHIFT) + self.start
    }
}

/// What each byte stands for.
fn decode_table(encoding: Encoding) -> &'static [f32; 256] {
    match encoding {
        Encoding::Color => srgb_table(),
        Encoding::Data => &DATA_TABLE,
    }
}

/// From 0 to 1 in equal steps.
static DATA_TABLE: [f32; 256] = {
    let mut table = [0.0; 256];
    let mut byte = 0;
    while byte < 256 {
        table[byte] = byte as f32 / 255.0;
        byte += 1;
    }
    table
};

/// Where columns lie within their rows.
#[inline(always)]
fn columns<S: Simd>(x: S::u32s) -> S::u32s {
    ((x >> TILE_SHIFT) << (2 * TILE_SHIFT)) + (x & (TILE - 1))
}

/// The two texels around coordinate `t` of a row of `size` texels, and the share of the second.
#[inline(always)]
fn neighbours<S: Simd>(simd: S, t: S::f32s, size: u32, wrap: Wrap, blending: Blending) -> (S::u32s, S::u32s, S::f32s) {
    let (zero, one) = (S::f32s::splat(simd, 0.0), S::f32s::splat(simd, 1.0));
    let finite = t.abs().simd_lt(S::f32s::splat(simd, f32::INFINITY));
    let t = finite.select(t, zero);
    let (texels, last) = (size as f32, S::f32s::splat(simd, size as f32 - 1.0));
    // Within one copy of the picture, or two that mirror each other.
    let t = match wrap {
        Wrap::Repeat => t - t.floor(),
        Wrap::Clamp => t.max(0.0).min(1.0),
        Wrap::Mirror => {
            let pair = (t - (t * 0.5).floor() * 2.0).min(2.0);
            pair.simd_gt(one).select(S::f32s::splat(simd, 2.0) - pair, pair)
        }
    };
    let position = t * texels - 0.5;
    let before = position.floor();
    let after = before + 1.0;
    let mut share = position - before;
    if blending == Blending::Nearest {
        share = share.simd_ge(0.5).select(one, zero);
    }
    let (below, beyond) = (before.simd_lt(zero), after.simd_gt(last));
    let (before, after) = match wrap {
        Wrap::Repeat => (below.select(last, before), beyond.select(zero, after)),
        // The edge mirrors itself.
        Wrap::Clamp | Wrap::Mirror => (below.select(zero, before), beyond.select(last, after)),
    };
    (before.to_int(), after.to_int(), share)
}

#[cfg(test)]
mod tests {
    use super::super::texture::srgb_to_linear;
    use super::*;
    use crate::math::{SimdToken, dispatch};

    /// Texels of sizes that fill no tile, all different.
    fn rows(width: u32, height: u32) -> Vec<[u8; 4]> {
        let texel = |i: u32| [i, i * 7 + 3, 255 - i, 255].map(|value| (value % 256) as u8);
        (0..width * height).map(texel).collect()
    }

    fn lanes<S: Simd>(simd: S, texels: &Texels, [u, v]: [f32; 2], footprint: f32, sampler: &Sampler) -> [f32; 3] {
        let coordinates = [S::f32s::splat(simd, u), S::f32s::splat(simd, v)];
        let footprint2 = S::f32s::splat(simd, footprint * footprint);
        let found = texels.sample::<S, true>(simd, coordinates, Some(footprint2), sampler, (1 << S::f32s::LEN) - 1);
        found.color.lane(S::f32s::LEN - 1).into()
    }

    fn sample(texels: &Texels, coordinates: [f32; 2]) -> [f32; 3] {
        sample_with(texels, coordinates, 0.0, &Sampler::default())
    }

    fn sample_with(texels: &Texels, coordinates: [f32; 2], footprint: f32, sampler: &Sampler) -> [f32; 3] {
        dispatch!(SimdToken::best(), simd => lanes(simd, texels, coordinates, footprint, sampler))
    }

    #[test]
    fn texels_are_found_again_in_their_tiles() {
        for (width, height) in [(1, 1), (1, 5), (4, 4), (5, 3), (9, 13)] {
            let rows = rows(width, height);
            let texels = Texels::new(width, height, &rows, Encoding::Color, true).unwrap();
            for (y, row) in (0..).zip(rows.chunks(width as usize)) {
                for (x, &texel) in (0..).zip(row) {
                    assert_eq!(texels.texel(0, x, y), texel, "({x}, {y}) of {width} x {height}");
                    let centre = [(x as f32 + 0.5) / width as f32, 1.0 - (y as f32 + 0.5) / height as f32];
                    for (found, expected) in sample(&texels, centre).into_iter().zip(texel.map(srgb_to_linear)) {
                        assert!((found - expected).abs() < 1e-5, "({x}, {y}) of {width} x {height}");
                    }
                }
            }
        }
    }

    #[test]
    fn data_of_16_bits_keep_them() {
        let rows: Vec<[u16; 4]> = (0..15).map(|i| [40_000 + i, 3 * i, 65_535 - i, 65_535 - 256 * i]).collect();
        let texels = Texels::of_words(5, 3, &rows, true).unwrap();
        assert_eq!((texels.encoding(), texels.levels()), (Encoding::Data, 3));
        for (i, row) in (0..15).zip(&rows) {
            let (x, y) = (i % 5, i / 5);
            assert_eq!(texels.texel(0, x, y), row.map(|word| (word >> 8) as u8));
            let centre = [(x as f32 + 0.5) / 5.0, 1.0 - (y as f32 + 0.5) / 3.0];
            for (found, expected) in sample(&texels, centre).into_iter().zip(row) {
                assert!((found * 65535.0 - f32::from(*expected)).abs() < 0.05, "({x}, {y}): {found}");
            }
        }
        assert_eq!(texels.bytes(), 2 * Texels::new(5, 3, &[[0; 4]; 15], Encoding::Data, true).unwrap().bytes());
        assert_eq!(Texels::of_words(2, 2, &rows, true), None);
    }

    #[test]
    fn edges_blend_with_the_opposite_ones() {
        let texels = Texels::new(5, 3, &rows(5, 3), Encoding::Color, true).unwrap();
        let corners = [(0, 0), (4, 0), (0, 2), (4, 2)].map(|(x, y)| texels.texel(0, x, y).map(srgb_to_linear));
        for corner in [[0.0, 0.0], [1.0, 0.0], [-3.0, 7.0]] {
            for (channel, found) in sample(&texels, corner).into_iter().enumerate() {
                let mean = corners.iter().map(|texel| texel[channel]).sum::<f32>() / 4.0;
                assert!((found - mean).abs() < 1e-6, "{corner:?}");
            }
        }
    }

    #[test]
    fn coordinates_that_are_no_numbers_are_looked_up_at_zero() {
        let texels = Texels::new(5, 3, &rows(5, 3), Encoding::Color, true).unwrap();
        for odd in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY] {
            assert_eq!(sample(&texels, [odd, odd]), sample(&texels, [0.0, 0.0]));
        }
    }

    #[test]
    fn sizes_that_do_not_fit_are_refused() {
        for (width, height, texels) in [(0, 0, 0), (2, 2, 3), (0, 3, 3), (u32::MAX, u32::MAX, 1)] {
            let texels = Texels::new(width, height, &vec![[0; 4]; texels], Encoding::Data, true);
            assert_eq!(texels, None, "{width} x {height}");
        }
    }

    #[test]
    fn wraps_repeat_mirror_or_hold_the_edge() {
        let texels = Texels::new(3, 1, &rows(3, 1), Encoding::Data, false).unwrap();
        let texel = |x: u32| f32::from(texels.texel(0, x, 0)[2]) / 255.0;
        let nearest = Blending::Nearest;
        let look = |wrap, u: f32| {
            let sampler =
                Sampler { wrap: [wrap; 2], magnification: nearest, minification: nearest, between_levels: None };
            sample_with(&texels, [u, 0.5], 0.0, &sampler)[2]
        };
        // A texel and a half beyond the right edge, and beyond the left.
        for (wrap, right, left) in [(Wrap::Repeat, 1, 1), (Wrap::Mirror, 1, 1), (Wrap::Clamp, 2, 0)] {
            assert_eq!([look(wrap, 1.5), look(wrap, -0.5)], [texel(right), texel(left)], "{wrap:?}");
            assert_eq!(look(wrap, 0.9), texel(2), "{wrap:?}");
        }
        assert_eq!([look(Wrap::Repeat, 1.1), look(Wrap::Mirror, 1.1)], [texel(0), texel(2)]);
        assert_eq!([look(Wrap::Repeat, -0.1), look(Wrap::Mirror, -0.1)], [texel(2), texel(0)]);
    }

    #[test]
    fn footprints_choose_sizes_and_blend_between_them() {
        let (width, height) = (8, 4);
        let texels = Texels::new(width, height, &rows(width, height), Encoding::Data, true).unwrap();
        assert_eq!(
            (0..texels.levels()).map(|level| texels.size(level)).collect::<Vec<_>>(),
            [[8, 4], [4, 2], [2, 1], [1, 1]]
        );
        // The centre of a texel of each size.
        let coordinates = [0.5 / 2.0, 0.5];
        let at = |footprint: f32| sample_with(&texels, coordinates, footprint, &Sampler::default())[2];
        let of_two = f32::from(texels.texel(2, 0, 0)[2]) / 255.0;
        let of_one = f32::from(texels.texel(3, 0, 0)[2]) / 255.0;
        assert!((at(4.0) - of_two).abs() < 1e-6);
        assert!((at(8.0) - of_one).abs() < 1e-6 && at(1e9) == at(8.0));
        let between = at(32.0_f32.sqrt());
        assert!((between - 0.5 * (of_two + of_one)).abs() < 1e-4, "{between}");
        assert_eq!(at(0.5), at(0.0));
        assert_eq!(at(f32::NAN), at(0.0));
    }
}
