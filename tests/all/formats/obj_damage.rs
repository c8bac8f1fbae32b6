//! OBJ files as other programs write or damage them: what is odd costs itself alone.

use crate::temporary::Folder;
use glam::{DVec3, Vec3};
use raywalk::scene::{LoadOptions, Scene, load};

fn load_obj(text: impl AsRef<[u8]>) -> Scene {
    load(&Folder::new().write("s.obj", text), &LoadOptions::default()).unwrap()
}

fn warnings(scene: &Scene) -> Vec<String> {
    scene.warnings.iter().map(ToString::to_string).collect()
}

/// Where the corners of all triangles are, in an order that does not tell of the file's.
fn triangles(scene: &Scene) -> Vec<[f32; 9]> {
    let mut triangles: Vec<[f32; 9]> =
        (0..scene.geometry.len() as u32).map(|primitive| scene.geometry.corners_of(primitive)).collect();
    triangles.sort_by(|a, b| a.partial_cmp(b).expect("numbers"));
    triangles
}

const SQUARE: &str = "v -1 -1 0\nv 1 -1 0\nv 1 1 0\nv -1 1 0\n";

#[test]
fn damaged_parts_cost_themselves_alone() {
    let whole = triangles(&load_obj(format!("{SQUARE}f 1 2 3 4")));
    for (text, told) in [
        (format!("{SQUARE}v nan nan nan\nf 1 2 3 4"), "s.obj:5:3: a position that is no number"),
        (format!("{SQUARE}v 1e40 0 0\nf 1 2 3 4\nf 1 2 5"), "a position that is no number"),
        (format!("{SQUARE}vn -nan(ind) 0 0\nf 1//1 2//1 3//1 4//1"), "a normal that is no number"),
        (format!("{SQUARE}vn 0 0 -1.#IND\nf 1//1 2//1 3//1 4//1"), "a normal that is no number"),
        (format!("{SQUARE}vt inf 0\nf 1/1 2/1 3/1 4/1"), "a texture coordinate that is no number"),
        (format!("{SQUARE}f 1 2 3 4\nf 1 2 0\nf 1 2 9\nf 1 2 -9\nf 1 2 a"), "a face with a corner that is none"),
        (format!("{SQUARE}vt 0 0\nf 1/1 2/2 3/3 4/0"), "a face names texture coordinates that are not there"),
        (format!("{SQUARE}vn 0 0 1\nf 1//1 2//7 3//1 4//1"), "a face names normals that are not there"),
        (format!("{SQUARE}s x\nf 1 2 3 4"), "a smoothing group that is no number"),
        ("v -1 -1\nv 1 -1\nv 1 1 0\nv -1 1 0\nf 1 2 3 4".to_owned(), "a position without z"),
        (format!("{SQUARE}v 0 0 0 1 x 1\nf 1 2 3 4"), "a vertex colour that is no number"),
        (format!("{SQUARE}what is this\nf 1 2 3 4"), "unknown statement \"what\""),
    ] {
        let scene = load_obj(&text);
        assert_eq!(triangles(&scene), whole, "{text}");
        let told_of: Vec<String> = warnings(&scene).into_iter().filter(|warning| warning.contains(told)).collect();
        assert!(!told_of.is_empty(), "{text}: {:?}", scene.warnings);
    }
}

#[test]
fn odd_spellings_are_read() {
    let whole = triangles(&load_obj(format!("{SQUARE}f 1 2 3 4")));
    let old = format!("{SQUARE}f 1 2 3 4\n");
    for text in [
        old.replace('\n', "\r"),
        format!("# an old Mac\r{}", old.replace('\n', "\r")),
        old.replace('\n', "\r\n"),
        format!("{old}\x1A"),
        format!("{old}\0\0\0"),
        format!("f 1 2 3 4\n{SQUARE}"),
        format!("{SQUARE}vt 0 0\nf 1/1 2/2 3/2 4/1\nvt 1 1\n"),
        format!("{SQUARE}f 1// 2// 3// 4//"),
        format!("{SQUARE}vt 0 0\nf 1/1/ 2/1/ 3/1/ 4/1/"),
        format!("{SQUARE}vn 0 0 1\nf 1/ /1 2/ /1 3/ /1 4/ /1"),
        format!("{SQUARE}f 1.0 2.0 3.0 4.0"),
        old.replace('v', "V").replace('f', "F"),
        old.replace("-1 -1 0", "-1.0D+00 -1e0, 0;"),
        old.replace(" 0\n", " 0 1 0 0 1\n").replace(" 0 1 0 0 1\nv -1 1", " 0 # a comment\nv -1 1"),
    ] {
        let scene = load_obj(&text);
        assert!(scene.warnings.is_empty(), "{text:?}: {:?}", scene.warnings);
        assert_eq!(triangles(&scene), whole, "{text:?}");
    }
    for unit in [u16::to_le_bytes as fn(u16) -> [u8; 2], u16::to_be_bytes] {
        let scene = load_obj(format!("\u{feff}{old}").encode_utf16().flat_map(unit).collect::<Vec<u8>>());
        assert!(scene.warnings.is_empty() && triangles(&scene) == whole, "{:?}", scene.warnings);
    }
}

#[test]
fn vertex_colours_may_be_bytes() {
    let corner = |text: &str| {
        let scene = load_obj(text);
        let (_, extras) = scene.geometry.extras.first().expect("colours");
        (extras.colors.map(|color| color.truncate()), warnings(&scene))
    };
    let (mut colors, told) = corner("v 0 0 0 255 0 0\nv 1 0 0 0 255 0\nv 0 1 0\nv 5 5 5 0 0 255\nf 1 2 3");
    colors.sort_by_key(|color| color.to_array().map(f32::to_bits));
    assert_eq!(colors, [Vec3::Y, Vec3::X, Vec3::ONE]);
    assert!(told.len() == 1 && told[0].contains("from 0 to 255"), "{told:?}");
    let (mut colors, told) = corner("v 0 0 0 1.001 0 0\nv 1 0 0 -1 1 0\nv 0 1 0 0 0 1\nf 1 2 3");
    colors.sort_by_key(|color| color.to_array().map(f32::to_bits));
    assert!(colors == [Vec3::Z, Vec3::Y, Vec3::X] && told.is_empty(), "{colors:?} {told:?}");
}

/// The shading normals of a box that is cut in half by y = 0: of its faces around the corner (1, 1, 1).
fn box_normals(smoothing: [&str; 3]) -> Vec<Vec3> {
    let [x, y, z] = smoothing;
    let text = format!(
        "v 1 1 1\nv 1 0 1\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0 1 1\nv 0 0 1\n{x}\nf 1 2 3 4\n{y}\nf 1 4 5 6\n{z}\nf 1 6 7 2"
    );
    let scene = load_obj(text);
    let mut found = Vec::new();
    for primitive in 0..scene.geometry.len() as u32 {
        let corners = scene.geometry.corners_of(primitive);
        let corners = [0, 3, 6].map(|i| Vec3::from_slice(&corners[i..i + 3]));
        let winding = scene.geometry.triangle(primitive).expect("a triangle")[9];
        let flat = (corners[1] - corners[0]).cross(corners[2] - corners[0]).normalize() * winding;
        let normals = scene.geometry.attributes_of(primitive).and_then(|attributes| attributes.normals);
        let at = corners.iter().position(|corner| *corner == Vec3::ONE);
        found.extend(at.map(|at| normals.map_or(flat, |normals| normals[at])));
    }
    found
}

#[test]
fn smoothing_groups_give_normals_where_there_are_none() {
    let diagonal = DVec3::ONE.normalize().as_vec3();
    let near = |normals: &[Vec3], expected: &[Vec3]| {
        normals.iter().all(|normal| expected.iter().any(|expected| normal.abs_diff_eq(*expected, 1e-6)))
            && expected.iter().all(|expected| normals.iter().any(|normal| normal.abs_diff_eq(*expected, 1e-6)))
    };
    let one = box_normals(["s 1", "", ""]);
    assert!(near(&one, &[diagonal]), "{one:?}");
    for off in ["s off", "s 0", ""] {
        let flat = box_normals([off, "", ""]);
        assert!(near(&flat, &[Vec3::X, Vec3::Y, Vec3::Z]), "{off}: {flat:?}");
    }
    let two = box_normals(["s 1", "s 1", "s 2"]);
    assert!(near(&two, &[Vec3::new(1.0, 1.0, 0.0).normalize(), Vec3::Z]), "{two:?}");
    let then_flat = box_normals(["s 3", "s 3", "s off"]);
    assert!(near(&then_flat, &[Vec3::new(1.0, 1.0, 0.0).normalize(), Vec3::Z]), "{then_flat:?}");
}

/// The colour of the material of a file's first object.
fn first_color(scene: &Scene) -> Vec3 {
    scene.materials[scene.objects[0].material as usize].color.factor
}

#[test]
fn the_library_of_the_same_name_is_read_where_none_is_named_or_found() {
    let folder = Folder::new();
    folder.write("s.mtl", "newmtl red\nKd 1 0 0");
    for (library, told) in [("", 0), ("mtllib original.mtl\n", 1)] {
        let file = folder.write("s.obj", format!("{library}{SQUARE}usemtl red\nf 1 2 3 4"));
        let scene = load(&file, &LoadOptions::default()).unwrap();
        assert_eq!((first_color(&scene), scene.warnings.len()), (Vec3::X, told), "{library}: {:?}", scene.warnings);
    }
    assert!(load_obj(format!("{SQUARE}usemtl red\nf 1 2 3 4")).warnings.len() == 1, "none is there");
}

#[test]
fn names_are_compared_as_bytes_and_without_what_stands_around_them() {
    let folder = Folder::new();
    // Two names in GBK, one of them with a backslash as its last byte, as in Shift-JIS.
    let library = [
        &b"newmtl \xBA\xEC\nKd 1 0 0\nnewmtl \xC2\xCC\nKd 0 1 0\nnewmtl \x95\x5C\nKd 0 0 1\n"[..],
        b"newmtl \"a b\" # c\nKd 1 1 0",
    ];
    folder.write("my lib.mtl", library.concat());
    for named in ["mtllib my lib.mtl", "mtllib \"my lib.mtl\"", "mtllib my lib.mtl # the library"] {
        for (name, color) in [
            (&b"\xBA\xEC"[..], Vec3::X),
            (b"\xC2\xCC", Vec3::Y),
            (b"\x95\x5C", Vec3::Z),
            (b"a b", Vec3::new(1.0, 1.0, 0.0)),
            (b"\"a b\" # d", Vec3::new(1.0, 1.0, 0.0)),
        ] {
            let text = [named.as_bytes(), b"\n", SQUARE.as_bytes(), b"usemtl ", name, b"\nf 1 2 3 4"].concat();
            let scene = load(&folder.write("s.obj", text), &LoadOptions::default()).unwrap();
            assert!(scene.warnings.is_empty(), "{named} {name:?}: {:?}", scene.warnings);
            assert_eq!(first_color(&scene), color, "{named} {name:?}");
        }
    }
}

#[test]
fn libraries_in_utf_16_name_files_with_options_behind_them() {
    let folder = Folder::new();
    image::RgbImage::from_pixel(2, 2, image::Rgb([9, 8, 7])).save(folder.write("old oak.png", "")).unwrap();
    let library = "\u{feff}newmtl a\r\nmap_Kd \"old oak.png\" -S 2 2 1\r\n";
    folder.write("s.mtl", library.encode_utf16().flat_map(u16::to_le_bytes).collect::<Vec<u8>>());
    let file = folder.write("s.obj", format!("mtllib s.mtl\n{SQUARE}vt 0 0\nusemtl a\nf 1/1 2/1 3/1 4/1"));
    let scene = load(&file, &LoadOptions::default()).unwrap();
    assert!(scene.warnings.is_empty(), "{:?}", scene.warnings);
    assert_eq!(scene.materials[0].name, "a");
    let lookup = scene.materials[0].color.texture.unwrap();
    assert_eq!(lookup.transform.transform_point2(glam::Vec2::ONE), glam::Vec2::splat(2.0));
}

#[cfg(unix)]
#[test]
fn files_may_be_called_in_latin_1() {
    use std::os::unix::ffi::OsStrExt;
    let folder = Folder::new();
    let image = image::RgbImage::from_pixel(2, 2, image::Rgb([9, 8, 7]));
    for on_disk in [&b"caf\xE9.png"[..], "café.png".as_bytes()] {
        let path = folder.path().join(std::ffi::OsStr::from_bytes(on_disk));
        image.save_with_format(&path, image::ImageFormat::Png).unwrap();
        folder.write("s.mtl", b"newmtl a\nmap_Kd caf\xE9.png");
        let text = format!("mtllib s.mtl\n{SQUARE}vt 0 0\nusemtl a\nf 1/1 2/1 3/1 4/1");
        let scene = load(&folder.write("s.obj", text), &LoadOptions::default()).unwrap();
        assert!(scene.warnings.is_empty(), "{on_disk:?}: {:?}", scene.warnings);
        std::fs::remove_file(path).unwrap();
    }
}

/// A picture of 4 x 4 pixels, the left half red and the right half blue, in every format that images may have.
#[test]
fn images_of_every_format_are_decoded() {
    let folder = Folder::new();
    let picture = image::RgbImage::from_fn(4, 4, |x, _| image::Rgb(if x < 2 { [255, 0, 0] } else { [0, 0, 255] }));
    let mut files = Vec::new();
    for name in ["a.png", "a.bmp", "a.tga", "a.tif", "a.gif"] {
        picture.save(folder.write(name, "")).unwrap();
        files.push(name);
    }
    // One block of BC1: red and blue, and two pixels of each in a row.
    let mut dds = [0_u8; 136];
    dds[..4].copy_from_slice(b"DDS ");
    (dds[12], dds[16], dds[80]) = (4, 4, 4);
    dds[84..88].copy_from_slice(b"DXT1");
    dds[128..].copy_from_slice(&[0x00, 0xF8, 0x1F, 0x00, 0x50, 0x50, 0x50, 0x50]);
    folder.write("a.dds", dds);
    files.push("a.dds");
    let text = format!("mtllib s.mtl\n{SQUARE}vt 0 0\nusemtl a\nf 1/1 2/1 3/1 4/1");
    let obj = folder.write("s.obj", text);
    for file in files {
        folder.write("s.mtl", format!("newmtl a\nmap_Kd {file}"));
        let scene = load(&obj, &LoadOptions::default()).unwrap();
        assert!(scene.warnings.is_empty(), "{file}: {:?}", scene.warnings);
        let raywalk::scene::Texture::Image(image) = &scene.textures[0] else { panic!("{file}") };
        let texels = [0, 1, 2, 3].map(|x| image.texels.texel(0, x, 3));
        assert_eq!(texels, [[255, 0, 0, 255], [255, 0, 0, 255], [0, 0, 255, 255], [0, 0, 255, 255]], "{file}");
        // Damaged ones cost themselves, and take no time and no memory.
        let whole = std::fs::read(folder.path().join(file)).unwrap();
        for i in 0..60 {
            let mut damaged = whole.clone();
            let at = i * 7 % damaged.len();
            damaged[at] ^= 1 << (i % 8);
            damaged.truncate(if i % 3 == 0 { at } else { damaged.len() });
            folder.write(file, damaged);
            load(&obj, &LoadOptions::default()).unwrap();
        }
    }
}
