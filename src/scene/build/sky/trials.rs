//! Pictures of both kinds, made here, whole and damaged.

use super::*;
use exr::image::write::layers::WritableLayers;
use exr::math::RoundingMode;
use exr::prelude::*;
use radiance::RadianceError;
use std::io::Cursor;

type Texel = [f32; 3];

fn decoded(bytes: &[u8]) -> std::result::Result<Decoded, SkyError> {
    within(bytes, &Limits::default())
}

fn within(bytes: &[u8], limits: &Limits) -> std::result::Result<Decoded, SkyError> {
    let progress = Progress::default();
    decode("sky", bytes, Allowed { limits, bytes: limits.texture_bytes, progress: &progress })
}

/// The texels of a picture without oddities.
fn texels(bytes: &[u8]) -> Vec<Texel> {
    let Decoded { image, odd } = decoded(bytes).unwrap();
    assert_eq!(odd, Vec::<String>::new());
    image.texels.into_vec()
}

/// A picture of 16 by 4 pixels in which columns 5 to 12 of each row are alike.
fn pixels() -> Vec<[u8; 4]> {
    let pixel = |x: u8, y: u8| match x {
        5..=12 => [200, 10 * y, 128, 129],
        _ => [128 + x, 3 * x, 40 * y, 127 + y],
    };
    (0..4).flat_map(|y| (0..16).map(move |x| pixel(x, y))).collect()
}

/// What pixels mean.
fn meant(pixels: &[[u8; 4]]) -> Vec<Texel> {
    let meant = |[r, g, b, e]: [u8; 4]| [r, g, b].map(|c| (f64::from(c) * 2_f64.powi(i32::from(e) - 136)) as f32);
    pixels.iter().copied().map(meant).collect()
}

fn hdr(header: &str, data: &[u8]) -> Vec<u8> {
    [header.as_bytes(), data].concat()
}

const HEADER: &str = "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 4 +X 16\n";

/// Scanlines component by component, runs among them.
fn run_length_coded() -> Vec<u8> {
    let mut data = Vec::new();
    for row in pixels().chunks(16) {
        data.extend([2, 2, 0, 16]);
        for component in 0..4 {
            data.push(5);
            data.extend(row[..5].iter().map(|pixel| pixel[component]));
            data.extend([128 + 8, row[5][component], 0, 3]);
            data.extend(row[13..].iter().map(|pixel| pixel[component]));
        }
    }
    data
}

#[test]
fn all_codings_of_a_radiance_picture_are_one_picture() {
    let wanted = meant(&pixels());
    assert_eq!(texels(&hdr(HEADER, pixels().as_flattened())), wanted, "flat");
    assert_eq!(texels(&hdr(HEADER, &run_length_coded())), wanted, "by component");
    let mut old = Vec::new();
    for row in pixels().chunks(16) {
        old.extend(row[..6].as_flattened());
        old.extend([1, 1, 1, 7]);
        old.extend(row[13..].as_flattened());
    }
    assert_eq!(texels(&hdr(HEADER, &old)), wanted, "pixels repeated");
    // Long repetitions, and one that goes on from the scanline before.
    let long = [[7, 8, 9, 140], [1, 1, 1, 43], [1, 1, 1, 1], [1, 1, 1, 44], [1, 1, 1, 1]];
    let header = HEADER.replace("-Y 4 +X 16", "-Y 2 +X 300");
    assert_eq!(texels(&hdr(&header, long.as_flattened())), meant(&[[7, 8, 9, 140]; 600]));
    // Narrow pictures are never coded by component, even if a pixel looks so.
    let narrow = [[2, 2, 0, 3], [9, 9, 9, 0], [128, 1, 1, 255]];
    let texels = texels(&hdr(&HEADER.replace("-Y 4 +X 16", "-Y 1 +X 3"), narrow.as_flattened()));
    assert_eq!(texels, [meant(&narrow[..1])[0], [0.0; 3], [128.0, 1.0, 1.0].map(|c: f32| c * 2_f32.powi(119))]);
}

#[test]
fn odd_headers_are_read() {
    let data = pixels();
    let wanted = meant(&data);
    let headers = [
        "#?RGBE\n# a comment\nGAMMA=1\nPRIMARIES= 0.64 0.33 0.29 0.6 0.15 0.06 0.3333 0.3333\n\n-Y 4 +X 16\n",
        "#?RADIANCE\r\nFORMAT=32-bit_rle_rgbe\r\n\r\n-Y 4 +X 16\r\n",
        "#?RADIANCE\npfilt -1 a.hdr\nFORMAT= 32-bit_rle_rgbe \n\n-Y 4 +X 16\n",
        "#?\n\n-Y4 +X16 \n",
        "#?AUTOPANO\nSOFTWARE=x\n-Y 4 +X 16\n",
        "FORMAT=32-bit_rle_rgbe\n\n-Y 4 +X 16\n",
        "#?RADIANCE\nother.hdr:\n\tEXPOSURE=7\n\tFORMAT=odd\nEXPOSURE=1\n\n-Y 4 +X 16\n",
    ];
    for header in headers {
        assert_eq!(texels(&hdr(header, data.as_flattened())), wanted, "{header}");
    }
    let exposed = "#?RADIANCE\nEXPOSURE=8\nCOLORCORR= 1 0.5 2\nEXPOSURE= 2.5e-1 \n\n-Y 4 +X 16\n";
    let divided: Vec<Texel> = wanted.iter().map(|[r, g, b]| [r / 2.0, *g, b / 4.0]).collect();
    assert_eq!(texels(&hdr(exposed, data.as_flattened())), divided);
    let wrong = HEADER.replace("FORMAT", "EXPOSURE=0\nEXPOSURE=bright\nCOLORCORR=1 2\nFORMAT");
    let Decoded { image, odd } = decoded(&hdr(&wrong, data.as_flattened())).unwrap();
    assert_eq!((image.texels.into_vec(), odd.len()), (wanted, 3), "{odd:?}");
    // White of equal energy is white, and a colour beyond RGB is cut to it.
    let xyz = HEADER.replace("rgbe", "xyze").replace("-Y 4 +X 16", "-Y 1 +X 2");
    let of_xyz = texels(&hdr(&xyz, &[128, 128, 128, 129, 0, 128, 0, 129]));
    assert!(of_xyz[0].iter().all(|c| (c - 1.0).abs() < 1e-5), "{of_xyz:?}");
    assert_eq!((of_xyz[1][0], of_xyz[1][2], of_xyz[1][1] > 1.9), (0.0, 0.0, true), "{of_xyz:?}");
}

#[test]
fn every_orientation_is_turned_upright() {
    // The picture: two rows of three texels.
    let wanted = [1, 2, 3, 4, 5, 6].map(|value: u8| [128 + value, 0, 0, 129]);
    let orders = [
        ("-Y 2 +X 3", [0, 1, 2, 3, 4, 5]),
        ("-Y 2 -X 3", [2, 1, 0, 5, 4, 3]),
        ("+Y 2 +X 3", [3, 4, 5, 0, 1, 2]),
        ("+Y 2 -X 3", [5, 4, 3, 2, 1, 0]),
        ("+X 3 -Y 2", [0, 3, 1, 4, 2, 5]),
        ("+X 3 +Y 2", [3, 0, 4, 1, 5, 2]),
        ("-X 3 -Y 2", [2, 5, 1, 4, 0, 3]),
        ("-X 3 +Y 2", [5, 2, 4, 1, 3, 0]),
    ];
    for (size, order) in orders {
        let stored = order.map(|at| wanted[at]);
        let bytes = hdr(&HEADER.replace("-Y 4 +X 16", size), stored.as_flattened());
        let Decoded { image, .. } = decoded(&bytes).unwrap();
        assert_eq!((image.width, image.height), (3, 2), "{size}");
        assert_eq!(image.texels.into_vec(), meant(&wanted), "{size}");
    }
}

#[test]
fn damaged_radiance_pictures_are_one_error() {
    let whole = hdr(HEADER, &run_length_coded());
    let with = |size: &str| hdr(&HEADER.replace("-Y 4 +X 16", size), &run_length_coded());
    let mut wide = run_length_coded();
    wide[3] = 17;
    let mut past = run_length_coded();
    past[10] = 255;
    let repeated = [[1, 1, 1, 3], [9, 9, 9, 9]].as_flattened().repeat(40);
    let endless = [[9, 9, 9, 9], [1, 1, 1, 0], [1, 1, 1, 0], [1, 1, 1, 0], [1, 1, 1, 0], [1, 1, 1, 1]];
    let cases: [(Vec<u8>, &str); 16] = [
        (Vec::new(), "neither a Radiance"),
        (b"-Y".to_vec(), "neither a Radiance"),
        (b"\x89PNG\r\n\x1a\n0123456789\n\n\n\n".to_vec(), "neither a Radiance"),
        (HEADER.as_bytes()[..40].to_vec(), "no line such as"),
        (whole[..HEADER.len() + 8].to_vec(), "ends in scanline"),
        (whole[..whole.len() - 1].to_vec(), "ends in scanline 4 of 4"),
        (with("-Y 2147483648 +X 2147483648"), "texture-edge"),
        (with("-Y 99999999999999999999 +X 4"), "texture-edge"),
        (with("-Y 16384 +X 16384"), "ends in scanline"),
        (with("-Y 0 +X 4"), "no pixels"),
        (with("-Y 4 +Y 4"), "its size is given as \"-Y 4 +Y 4\""),
        (hdr(HEADER, &wide), "scanline 1 of 4 holds 17 pixels in place of 16"),
        (hdr(HEADER, &past), "in place of 16"),
        (hdr(HEADER, &repeated), "repeats a pixel before there is one"),
        (hdr(HEADER, &endless.as_flattened().repeat(8)), "in place of 16"),
        (hdr(&HEADER.replace("rgbe", "cmyk"), &[0; 256]), "FORMAT=32-bit_rle_cmyk is unknown"),
    ];
    for (bytes, says) in cases {
        let message = decoded(&bytes).expect_err(says).to_string();
        assert!(message.contains(says) && !message.contains('\n'), "{says}: {message}");
    }
    for end in 0..whole.len() {
        assert!(decoded(&whole[..end]).is_err(), "{end}");
    }
    let missing = SkyError::Radiance(RadianceError::NoSize).to_string();
    assert!(missing.contains("-Y 512 +X 1024"));
}

/// The color of a pixel of the pictures below.
fn color(Vec2(x, y): Vec2<usize>) -> Texel {
    [x as f32, 0.25 + y as f32, 100.0 * (x + y) as f32]
}

/// All texels of a picture of this size.
fn colors(width: usize, height: usize) -> Vec<Texel> {
    (0..height).flat_map(|y| (0..width).map(move |x| color(Vec2(x, y)))).collect()
}

fn written<'img, L: WritableLayers<'img>>(image: &'img Image<L>) -> Vec<u8> {
    let mut bytes = Cursor::new(Vec::new());
    image.write().non_parallel().to_buffered(&mut bytes).unwrap();
    bytes.into_inner()
}

fn encoding(compression: Compression, blocks: Blocks) -> Encoding {
    Encoding { compression, blocks, line_order: LineOrder::Unspecified }
}

/// An EXR picture in half floats.
fn exr_in(compression: Compression, blocks: Blocks) -> Vec<u8> {
    let line_order = if blocks == Blocks::ScanLines { LineOrder::Increasing } else { LineOrder::Unspecified };
    let encoding = Encoding { line_order, ..encoding(compression, blocks) };
    let channels = SpecificChannels::rgba(|at: Vec2<usize>| {
        let [r, g, b] = color(at).map(f16::from_f32);
        (r, g, b, f16::ONE)
    });
    written(&Image::from_encoded_channels((24, 20), encoding, channels))
}

#[test]
fn exr_pictures_of_every_coding_are_one_picture() {
    let codings = [
        Compression::Uncompressed,
        Compression::RLE,
        Compression::ZIP1,
        Compression::ZIP16,
        Compression::PIZ,
        Compression::PXR24,
    ];
    for compression in codings {
        for blocks in [Blocks::ScanLines, Blocks::Tiles(Vec2(7, 9))] {
            let bytes = exr_in(compression, blocks);
            assert_eq!(texels(&bytes), colors(24, 20), "{compression:?} {blocks:?}");
        }
    }
}

/// A channel of samples of 32 bits.
fn channel(name: &str, size: Vec2<usize>, sample: impl Fn(Vec2<usize>) -> f32) -> AnyChannel<FlatSamples> {
    let samples = (0..size.area()).map(|i| sample(Vec2(i % size.width(), i / size.width())));
    AnyChannel::new(name, FlatSamples::F32(samples.collect()))
}

/// A picture with these channels.
fn exr_of(size: Vec2<usize>, list: Vec<AnyChannel<FlatSamples>>) -> Vec<u8> {
    written(&Image::from_channels(size, AnyChannels::sort(list.into())))
}

#[test]
fn the_colours_of_an_exr_are_found_among_its_channels() {
    let size = Vec2(5, 3);
    let named = |names: [&str; 3]| {
        let channels = [0, 1, 2].map(|c| channel(names[c], size, move |at| color(at)[c]));
        channels.to_vec()
    };
    let other = |name: &str| channel(name, size, |_| 9.0);
    assert_eq!(texels(&exr_of(size, named(["R", "G", "B"]))), colors(5, 3));
    assert_eq!(texels(&exr_of(size, named(["r", "g", "b"]))), colors(5, 3));
    let layered = ["View Layer.Combined.R", "View Layer.Combined.G", "View Layer.Combined.B"];
    let among = ["A.R", "A.G", "A.B", "Z", "View Layer.Combined.A"].map(other);
    assert_eq!(texels(&exr_of(size, [named(layered), among.to_vec()].concat())), colors(5, 3));
    let plain = ["left.R", "left.G", "left.B", "A", "Y"].map(other);
    assert_eq!(texels(&exr_of(size, [named(["R", "G", "B"]), plain.to_vec()].concat())), colors(5, 3));
    let grey = channel("Y", size, |at| color(at)[2]);
    let wanted: Vec<Texel> = colors(5, 3).iter().map(|color| [color[2]; 3]).collect();
    assert_eq!(texels(&exr_of(size, vec![grey, other("A")])), wanted);
    let counts =
        [1, 2, 3].map(|c| AnyChannel::new(["R", "G", "B"][c - 1], FlatSamples::U32(vec![c as u32; size.area()])));
    assert_eq!(texels(&exr_of(size, counts.to_vec())), [[1.0, 2.0, 3.0]; 15]);
    let message = decoded(&exr_of(size, vec![other("Z"), other("R")])).unwrap_err().to_string();
    assert!(message.contains("it has R, Z"), "{message}");
}

#[test]
fn an_exr_shows_its_display_window() {
    let at = |layer: (i32, i32), display: ((i32, i32), (usize, usize))| {
        let channels = SpecificChannels::rgb(|at: Vec2<usize>| <(f32, f32, f32)>::from(color(at)));
        let attributes = LayerAttributes { layer_position: layer.into(), ..LayerAttributes::default() };
        let layer = Layer::new((4, 2), attributes, Encoding::FAST_LOSSLESS, channels);
        let window = IntegerBounds::new(display.0, display.1);
        decoded(&written(&Image::from_layer(layer).with_display_window(window))).unwrap().image
    };
    let within = at((12, 21), ((10, 20), (8, 4)));
    assert_eq!((within.width, within.height), (8, 4));
    assert_eq!(within.texels[8 + 2..8 + 6], colors(4, 2)[..4]);
    assert_eq!(within.texels.iter().filter(|texel| **texel != [0.0; 3]).count(), 8);
    let larger = at((-1, 0), ((0, 0), (2, 1)));
    assert_eq!(larger.texels[..], [color(Vec2(1, 0)), color(Vec2(2, 0))]);
    let elsewhere = at((100, 100), ((0, 0), (2, 1)));
    assert_eq!(elsewhere.texels[..], colors(4, 2)[..], "all of it is outside");
}

trait WithDisplay {
    fn with_display_window(self, window: IntegerBounds) -> Self;
}

impl<L> WithDisplay for Image<L> {
    fn with_display_window(mut self, window: IntegerBounds) -> Self {
        self.attributes.display_window = window;
        self
    }
}

#[test]
fn of_a_mip_mapped_exr_the_largest_level_is_shown() {
    let sizes = [Vec2(8, 4), Vec2(4, 2), Vec2(2, 1), Vec2(1, 1)];
    let list = [0, 1, 2].map(|c| {
        let level = |(depth, size): (usize, &Vec2<usize>)| {
            let sample = |i| if depth == 0 { color(Vec2(i % 8, i / 8))[c] } else { -7.0 };
            FlatSamples::F32((0..size.area()).map(sample).collect())
        };
        let level_data = sizes.iter().enumerate().map(level).collect();
        AnyChannel::new(["R", "G", "B"][c], Levels::Mip { level_data, rounding_mode: RoundingMode::Down })
    });
    let encoding = encoding(Compression::ZIP16, Blocks::Tiles(Vec2(3, 3)));
    let channels = AnyChannels::sort(list.into_iter().collect());
    assert_eq!(texels(&written(&Image::from_encoded_channels((8, 4), encoding, channels))), colors(8, 4));
}

#[test]
fn what_is_no_radiance_is_replaced_with_one_warning() {
    let values = [f32::NAN, -2.0, f32::INFINITY, f32::NEG_INFINITY, 50.0, 0.5];
    let size = Vec2(2, 1);
    let list = [0, 1, 2].map(|c| channel(["R", "G", "B"][c], size, move |at| values[c + 3 * at.x()]));
    let Decoded { image, odd } = decoded(&exr_of(size, list.to_vec())).unwrap();
    assert_eq!(image.texels[..], [[0.0, 0.0, 50.0], [0.0, 50.0, 0.5]]);
    assert_eq!(odd.len(), 1);
    assert!(odd[0].contains("1 not a number") && odd[0].contains("2 negative") && odd[0].contains("1 infinite"));
    let all = ["R", "G", "B"].map(|name| channel(name, size, |_| f32::INFINITY));
    assert_eq!(decoded(&exr_of(size, all.to_vec())).unwrap().image.texels[..], [[0.0; 3]; 2]);
    let tiny = "#?RADIANCE\nEXPOSURE=1e-30\n\n-Y 1 +X 1\n";
    let Decoded { image, odd } = decoded(&hdr(tiny, &[128, 0, 0, 255])).unwrap();
    assert_eq!((image.texels[0], odd.len()), ([0.0; 3], 1), "{odd:?}");
}

#[test]
fn damaged_exr_pictures_are_one_error() {
    let refused = |bytes: &[u8], says: &str| {
        let message = decoded(bytes).expect_err(says).to_string();
        assert!(message.contains(says) && !message.contains('\n'), "{says}: {message}");
    };
    let whole = exr_in(Compression::ZIP16, Blocks::ScanLines);
    for end in (0..whole.len()).step_by(7) {
        assert!(decoded(&whole[..end]).is_err(), "{end}");
    }
    // The data window and the display window, each corner a pair of numbers.
    let place = |name: &[u8]| whole.windows(name.len()).position(|window| window == name).unwrap();
    let with_window = |name: &str, corner: [i32; 2]| {
        let mut bytes = whole.clone();
        let at = place(&[name.as_bytes(), b"\0box2i\0"].concat()) + name.len() + 7 + 4 + 8;
        bytes[at..at + 8].copy_from_slice(corner.map(i32::to_le_bytes).as_flattened());
        bytes
    };
    refused(&with_window("dataWindow", [i32::MAX / 2 - 1, i32::MAX / 2 - 1]), "");
    refused(&with_window("dataWindow", [20_000, 20_000]), "");
    refused(&with_window("dataWindow", [16_000, 16_000]), "");
    refused(&with_window("displayWindow", [20_000, 3]), "texture-edge");
}

#[test]
fn limits_and_cancelling_end_it() {
    let mut limits = Limits { texture_edge: 15, ..Limits::default() };
    let picture = hdr(HEADER, pixels().as_flattened());
    let exr = exr_in(Compression::ZIP16, Blocks::ScanLines);
    let refused = |bytes: &[u8], limits: &Limits| within(bytes, limits).unwrap_err().to_string();
    assert!(refused(&picture, &limits).contains("--limit texture-edge=N"));
    assert!(refused(&exr, &limits).contains("--limit texture-edge=N"));
    limits.texture_edge = 24;
    assert!(within(&picture, &limits).is_ok() && within(&exr, &limits).is_ok());
    limits.texture_bytes = 16 * 4 * 12 - 1;
    assert!(refused(&picture, &limits).contains("the scene's textures have more than the limit texture-bytes"));
    assert!(refused(&exr, &limits).contains("--limit texture-bytes=N"));
    let (limits, progress) = (Limits::default(), Progress::default());
    progress.cancel();
    for bytes in [picture, exr] {
        let allowed = Allowed { limits: &limits, bytes: 1 << 20, progress: &progress };
        assert!(matches!(decode("sky", &bytes, allowed), Err(SkyError::Refused(Refused::Cancelled))));
    }
}
