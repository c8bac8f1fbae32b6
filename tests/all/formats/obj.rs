//! OBJ scenes with their material libraries: what they become, and how mistakes are told.

use super::picture;
use crate::temporary::Folder;
use glam::{Vec2, Vec3};
use raywalk::render::{Film, Planes, Scratch, render_frame};
use raywalk::scene::material::{Alpha, Model};
use raywalk::scene::texture::{Texture, Wrap, srgb_to_linear};
use raywalk::scene::{Camera, EnvironmentChoice, LoadOptions, Material, Scene, SceneError, load};
use raywalk::settings::Settings;

/// In the light that the file has, and nothing else.
fn in_its_own_light() -> LoadOptions {
    LoadOptions { environment: EnvironmentChoice::None, ..LoadOptions::default() }
}

fn load_obj(text: impl AsRef<[u8]>) -> Result<Scene, SceneError> {
    load(&Folder::new().write("s.obj", text), &LoadOptions::default())
}

/// The materials of a library.
fn load_mtl(text: &str) -> Scene {
    let folder = Folder::new();
    folder.write("s.mtl", text);
    load(&folder.write("s.obj", "mtllib s.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3"), &LoadOptions::default()).unwrap()
}

fn warnings(scene: &Scene) -> Vec<String> {
    scene.warnings.iter().map(ToString::to_string).collect()
}

#[test]
fn every_statement_becomes_what_it_says() {
    let folder = Folder::new();
    folder.write("every_statement.mtl", include_str!("every_statement.mtl"));
    for name in ["bricks.png", "heights.png", "normals.png"] {
        image::GrayImage::from_pixel(2, 2, image::Luma([128])).save(folder.write(name, "")).unwrap();
    }
    let scene = load(&folder.write("s.obj", include_str!("every_statement.obj")), &in_its_own_light()).unwrap();
    assert_eq!(scene.format, "OBJ");
    // The faces of an object with a material, one object for those with the same attributes.
    let objects: Vec<(Option<&str>, &str)> = scene
        .objects
        .iter()
        .map(|object| (object.name.as_deref(), &*scene.materials[object.material as usize].name))
        .collect();
    let first = Some("first");
    let expected = [
        (first, "brick"), // with texture coordinates and normals
        (first, "brick"), // with normals
        (first, "glass"),
        (first, "brick"), // with texture coordinates, for want of a normal
        (Some("second"), "brick"),
    ];
    assert_eq!(objects, expected);
    assert!(scene.objects.iter().all(|object| object.kind == "mesh"));
    assert_eq!(scene.geometry.len(), 2 + 3 + 1 + 1 + 1);
    assert!(scene.headlight && scene.cameras.len() == 1);

    let [brick, glass] = &scene.materials[..] else { panic!("two materials") };
    let Model::Phong { ambient, diffuse, specular, shininess } = brick.model else { panic!("Phong's model") };
    assert_eq!((ambient, diffuse), (Material::<u32>::AMBIENT, Vec3::ONE));
    assert_eq!((specular, shininess), (Vec3::new(0.1, 0.2, 0.3), 20.0));
    assert_eq!((brick.color.factor, brick.emission.factor), (Vec3::new(0.5, 0.25, 1.0), Vec3::new(0.0, 0.5, 0.0)));
    assert_eq!((brick.reflectivity, brick.transparency), (Vec3::ZERO, Vec3::ZERO));
    let lookup = brick.color.texture.unwrap();
    assert_eq!(lookup.transform.transform_point2(Vec2::ONE), Vec2::splat(2.0));
    let Texture::Image(image) = &scene.textures[lookup.texture as usize] else { panic!("an image") };
    assert_eq!(image.sampler.wrap, [Wrap::Clamp; 2]);
    assert_eq!(glass.color.factor, Vec3::new(1.0, 0.5, 1.0));
    assert_eq!((glass.reflectivity, glass.transparency), (Vec3::splat(0.5), Vec3::splat(0.75)));
    assert_eq!((glass.ior, glass.fresnel), (1.5, true));
    assert_eq!(glass.relief.bump.unwrap().scale, 0.02);
    assert_eq!(glass.relief.normal.unwrap().scale, 1.0);

    let warnings = warnings(&scene);
    let told = ["mtl:19:1: Pr is not drawn", "s.obj:32:1: points, lines and faces of fewer than 3 corners: 3 left out"];
    for told in told {
        assert!(warnings.iter().any(|warning| warning.contains(told)), "{told}: {warnings:#?}");
    }
    assert_eq!(warnings.len(), 2, "{warnings:#?}");
}

#[test]
fn vertices_are_shared_and_colours_follow_them() {
    let text = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0 0.50196078 0 0\nf 1 2 3 4\nf 4 3 2\n";
    let scene = load_obj(text).unwrap();
    assert_eq!(scene.geometry.len(), 3);
    // Two of the triangles have the coloured corner.
    let colors = vertex_colors(&scene).concat();
    let red = Vec3::new(srgb_to_linear(128), 0.0, 0.0);
    assert_eq!((colors.len(), colors.iter().filter(|color| color.abs_diff_eq(red, 1e-6)).count()), (9, 2));
    assert_eq!(colors.iter().filter(|color| **color == Vec3::ONE).count(), 7);
}

/// The vertex colours of all triangles that have any.
fn vertex_colors(scene: &Scene) -> Vec<[Vec3; 3]> {
    scene.geometry.extras.iter().map(|(_, extras)| extras.colors.map(|color| color.truncate())).collect()
}

/// A scene that leaves no face, the `§` where its first fault is, and words of its message.
const WRONG: &[(&str, &str)] = &[
    ("v 1 §x 3", "expected a number (position), found \"x\""),
    ("v -§1,0 -1,0 0,0\nv 1,0 -1,0 0,0\nv 1,0 1,0 0,0\nf 1 2 3", "found \"-1,0\""),
    ("v 1 2§\nv 1 2 3", "the line ends before position"),
    ("v 1 2§", "the file ends before position"),
    ("v §nan 0 0", "expected a number"),
    ("v 0 -§inf 0", "expected a number"),
    ("v 0 0 §1e39", "too large"),
    ("vn 0 0 §", "ends before normal"),
    ("vt §a", "expected a number"),
    ("v 0 0 0\nv 0 0 1\nf 1 2 §3", "index 3 names none of the 2 positions of the file"),
    ("v 0 0 0\nf 1 §0 1", "index 0 names none"),
    ("v 0 0 0\nf 1 1 §-2", "index -2 names none of the 1 positions given so far"),
    ("v 0 0 0\nf 1 1 §-1.5", "expected a corner such as"),
    ("v 0 0 0\nf 1 §9223372036854775807 1", "names none"),
    ("v 0 0 0\nf 1 §99999999999999999999 1", "expected a corner such as"),
    ("v 0 0 0\nvt 0 0\nf §/1 1 1", "expected a corner such as"),
    ("v 0 0 0\nf 1 §1/// 1", "expected a corner such as"),
    ("v 0 0 0\nf 1 §a 1", "expected a corner such as"),
    ("v 0 0 0\n§f 1 1", "a face of fewer than 3 corners"),
    ("f 1 §2 3\nv 0 0 0", "index 2 names none of the 1 positions"),
    ("§<!DOCTYPE html>\n<html>404</html>", "unknown statement \"<!DOCTYPE\""),
    ("# made on an old Mac\rv 0 0 0\rv 1 §x 0\r", "found \"x\""),
];

#[test]
fn texts_that_leave_no_face_are_refused_with_the_place_of_the_first_fault() {
    for (text, says) in WRONG {
        let text = text.replace("-§", "§-");
        let (before, after) = text.split_once('§').unwrap();
        let line = 1 + before.matches(['\n', '\r']).count();
        let column = 1 + before.rsplit(['\n', '\r']).next().unwrap().chars().count();
        let error = load_obj(format!("{before}{after}")).expect_err(&text);
        let SceneError::Invalid { place, message } = &error else { panic!("{text}: {error}") };
        assert!(message.contains(says), "{error}\n{text}");
        assert_eq!(place.line_column, Some((line, column)), "{error}\n{text}");
        assert!(!error.to_string().contains('\n'), "{error:?}");
    }
}

const TRIANGLE: &str = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";

#[test]
fn what_is_missing_is_warned_of_and_drawn_plainly() {
    let scene = load_obj(format!("mtllib none.mtl\n{TRIANGLE}usemtl red\nf 1 2 3")).unwrap();
    assert_eq!(scene.materials, [Material::default_phong()]);
    let [warning] = &warnings(&scene)[..] else { panic!("{:?}", scene.warnings) };
    assert!(warning.contains("s.obj:1:1: cannot read the materials of \"none.mtl\""), "{warning}");
    let outside = load_obj(format!("mtllib ../../../../etc/passwd\n{TRIANGLE}f 1 2 3")).unwrap();
    assert!(warnings(&outside)[0].contains("cannot read the materials"), "{:?}", outside.warnings);

    let folder = Folder::new();
    folder.write("a.mtl", "newmtl red\nKd 1 0 0");
    folder.write("b c.mtl", "newmtl blue\nKd 0 0 1");
    let text =
        format!("mtllib a.mtl\nmtllib b c.mtl\n{TRIANGLE}usemtl rde\nf 1 2 3\nusemtl blue\nf 1 2 3\nusemtl\nf 1 2 3");
    let scene = load(&folder.write("s.obj", text), &LoadOptions::default()).unwrap();
    let names: Vec<&str> = scene.objects.iter().map(|o| &*scene.materials[o.material as usize].name).collect();
    assert_eq!(names, ["", "blue", ""]);
    let [warning] = &warnings(&scene)[..] else { panic!("{:?}", scene.warnings) };
    assert!(warning.contains("s.obj:6:1: no material is called \"rde\"") && warning.contains("red"), "{warning}");
    let both = load(
        &folder.write("s.obj", format!("mtllib a.mtl a.mtl\n{TRIANGLE}usemtl red\nf 1 2 3")),
        &LoadOptions::default(),
    );
    assert_eq!(both.unwrap().materials[0].color.factor, Vec3::X);
}

#[test]
fn corners_may_name_normals_where_there_are_none() {
    let scene = load_obj(format!("{TRIANGLE}f 1/1/1 2/2/2 3/3/3\nf 1//7 2//7 3//7")).unwrap();
    assert_eq!(scene.geometry.len(), 2);
    let told: Vec<String> = warnings(&scene);
    assert_eq!(told.len(), 2, "{told:?}");
    assert!(told[0].contains("s.obj:4:3: a face names texture coordinates, but the file has none"), "{told:?}");
}

#[test]
fn materials_follow_their_statements() {
    let one = |text: &str| load_mtl(&format!("newmtl m\n{text}")).materials.swap_remove(0);
    let highlight = |text: &str| match one(text).model {
        Model::Phong { specular, .. } => specular.x,
        Model::MetallicRoughness { .. } => panic!("Phong's model"),
    };
    let plain = one("");
    assert_eq!((plain.color.factor, plain.transparency, plain.ior), (Vec3::ONE, Vec3::ZERO, 1.0));
    assert_eq!(highlight(""), 0.0);
    assert_eq!(one("Ks 2 0.5 0\nillum 3").reflectivity, Vec3::new(1.0, 0.5, 0.0));
    assert_eq!(one("KD 0.5").color.factor, Vec3::splat(0.5));
    assert_eq!(one("Kd 255 51 0").color.factor, Vec3::new(1.0, 0.2, 0.0));
    // Models without a highlight, and one as wide as all that light falls on.
    assert_eq!(
        ["", "illum 0", "illum 1", "illum 2", "Ns 0", "Ns 5"].map(|text| highlight(&format!("Ks 1\n{text}"))),
        [1.0, 0.0, 0.0, 1.0, 0.0, 0.5]
    );
    // Of maps that are missing, nothing glows and nothing is bent.
    let bare = one("map_Ke a.png\nnorm n.png\nmap_Bump b.png");
    assert_eq!((bare.emission.factor, bare.emission.texture), (Vec3::ZERO, None));
    assert_eq!((bare.relief.normal, bare.relief.bump), (None, None));
}

#[test]
fn opacity_blends_and_only_filters_tint() {
    let one = |text: &str| load_mtl(&format!("newmtl m\nKd 0 0 1\n{text}")).materials.swap_remove(0);
    for (text, opacity) in [
        ("Tr 0.25", 0.75),
        ("Tr 1\nd 0.5", 0.5),
        ("d -halo 0.5", 0.5),
        ("d 0", 0.0),
        ("d 0.5\nTf 1 1 1", 0.5),
        ("d 0.5\nTf 0 0 0", 0.5),
        ("d 0.5\nNi 1.5\nillum 4", 0.5),
    ] {
        let blended = one(text);
        assert_eq!(
            (blended.alpha, blended.opacity, blended.transparency),
            (Alpha::Blend, opacity, Vec3::ZERO),
            "{text}"
        );
        assert_eq!(blended.color.factor, Vec3::Z, "{text}");
    }
    for text in ["d 7", "Tr 1", "Tf 0 1 0", "d nan", "Tr -1.#IND"] {
        let opaque = one(text);
        assert_eq!((opaque.alpha, opaque.opacity), (Alpha::Opaque, 1.0), "{text}");
    }
    let filter = one("d 0.25\nTf 0.5 1 1");
    assert_eq!((filter.color.factor, filter.transparency), (Vec3::new(0.5, 1.0, 1.0), Vec3::splat(0.75)));
    assert!(filter.is_thin() && !filter.fresnel);
    let glass = one("d 0.25\nNi 1.5\nillum 7");
    assert_eq!((glass.color.factor, glass.transparency), (Vec3::ONE, Vec3::splat(0.75)));
    assert!(!glass.is_thin() && glass.fresnel);
    let Model::Phong { diffuse, .. } = glass.model else { panic!("Phong's model") };
    assert_eq!(diffuse, Vec3::Z);
}

/// Red behind a square of a material.
fn before_red(folder: &Folder, library: &str) -> [f32; 3] {
    folder.write("s.mtl", format!("newmtl back\nKd 1 0 0\nnewmtl m\n{library}"));
    let text = "mtllib s.mtl\nv -2 -1 0\nv 2 -1 0\nv 2 1 0\nv -2 1 0\nv -4 -3 -1\nv 4 -3 -1\nv 4 3 -1\nv -4 3 -1\n\
                vt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\nusemtl back\nf 5 6 7 8\nusemtl m\nf 1/1 2/2 3/3 4/4";
    let scene = load(&folder.write("s.obj", text), &in_its_own_light()).unwrap();
    let off_the_diagonal = Vec3::new(0.25, -0.25, 0.0);
    let eye = off_the_diagonal + Vec3::Z * 4.0;
    let camera = Camera { eye, look_at: off_the_diagonal, ..Camera::default() };
    let mut film = Film::new(3, 3, Planes::default());
    render_frame(&scene, &camera, &Settings::exact(), &mut Scratch::default(), &mut film);
    film.color(1, 1)
}

#[test]
fn what_lies_behind_shows_by_the_opacity_alone() {
    let folder = Folder::new();
    let [all, none, _] = before_red(&folder, "d 0");
    assert!(all > 0.5 && none == 0.0, "{all} {none}");
    let is = |library: &str, expected: [f32; 3]| {
        let found = before_red(&folder, library);
        let near = found.iter().zip(expected).all(|(found, expected)| (found - expected * all).abs() < 0.02);
        assert!(near, "{library}: {found:?}, not {expected:?} of {all}");
    };
    is("Kd 0 0 0\nd 0.2", [0.8, 0.0, 0.0]);
    is("Kd 0 0 1\nd 0.2", [0.8, 0.0, 0.2]);
    is("Kd 0 0 1\nTr 0.4", [0.4, 0.0, 0.6]);
    // The light at the eye passes the filter, too.
    is("Kd 0 0 1\nd 0.6\nTf 0.5 1 0", [0.04, 0.0, 0.6]);
    for (name, opacity) in [("a", 102), ("b", 153)] {
        let image = image::RgbaImage::from_pixel(4, 4, image::Rgba([0, 0, 255, opacity]));
        image.save(folder.write(&format!("{name}.png"), "")).unwrap();
    }
    is("map_Kd a.png\nmap_d a.png", [0.6, 0.0, 0.4]);
    is("Kd 0 0 0\nmap_Kd b.png\nmap_d b.png", [0.4, 0.0, 0.6]);
    is("map_Kd a.png\nmap_d a.png\nd 0", [0.6, 0.0, 0.4]);
    is("map_Kd a.png\nmap_d a.png\nd 0.5", [0.8, 0.0, 0.2]);
    is("Kd 0 1 0\nmap_d a.png", [0.6, 0.4, 0.0]);
    // The colours of one file, the opacities of another; where those are damaged, the colours remain.
    is("map_Kd a.png\nmap_d b.png", [0.4, 0.0, 0.6]);
    folder.write("broken.png", "no image");
    image::RgbImage::from_pixel(4, 4, image::Rgb([0, 0, 255])).save(folder.write("blue.png", "")).unwrap();
    is("map_Kd blue.png\nmap_d broken.png", [0.0, 0.0, 1.0]);
}

#[test]
fn odd_libraries_are_warned_of() {
    let scene = load_mtl(
        "Kd 1 1 1\nnewmtl a\nKd 1 x 1\nKs -1 0 0\nKd spectral a.rfl\nNs\nmap_Kd\nmap_Ks a.png\nmap_Ks b.png\nillum two",
    );
    let told = [
        "s.mtl:1:1: Kd stands before the first newmtl",
        "s.mtl:3:6: expected a number (green), found \"x\"; it is left out",
        "s.mtl:4:1: Ks is below 0; it is left out",
        "s.mtl:5:4: expected a number (red), found \"spectral\"; it is left out",
        "s.mtl:6:3: the line ends before Ns; it is left out",
        "s.mtl:7:1: map_Kd names no file; it is left out",
        "s.mtl:8:1: map_Ks is not drawn",
        "s.mtl:10:7: expected a number (illum), found \"two\"; it is left out",
    ];
    let warnings = warnings(&scene);
    assert_eq!(warnings.len(), told.len(), "{warnings:#?}");
    for (warning, told) in warnings.iter().zip(told) {
        assert!(warning.contains(told), "{warning}");
    }
}

#[test]
fn images_are_found_by_paths_of_other_machines() {
    let folder = Folder::new();
    let image = image::RgbImage::from_pixel(2, 2, image::Rgb([255, 0, 0]));
    image.save(folder.write("maps/red.png", "")).unwrap();
    image.save(folder.write("blue.png", "")).unwrap();
    folder.write(
        "s.mtl",
        "newmtl a\nmap_Kd maps\\red.png\nnewmtl b\nmap_Kd C:\\Users\\me\\blue.png\nnewmtl c\nmap_Kd /home/me/blue.png",
    );
    let scene =
        load(&folder.write("s.obj", format!("mtllib s.mtl\n{TRIANGLE}usemtl a\nf 1 2 3")), &LoadOptions::default())
            .unwrap();
    assert!(scene.warnings.is_empty(), "{:?}", scene.warnings);
    assert_eq!(scene.textures.len(), 3);
    assert!(picture(&scene, 16, 9).iter().any(|[red, green, blue]| *red > 100 && *green < 20 && *blue < 20));
}

/// Some programs begin a file with the mark of its byte order, write paths as Windows does, or continue lines.
#[test]
fn files_and_libraries_of_other_programs_are_read() {
    let folder = Folder::new();
    let mark = "\u{feff}";
    let image = image::RgbImage::from_pixel(2, 2, image::Rgb([255, 0, 0]));
    image.save(folder.write("sub/red.png", "")).unwrap();
    folder.write("sub/s.mtl", format!("{mark}newmtl a\nmap_Kd red.png"));
    folder.write("s.mtl", "newmtl a\nKd 1 0 0");
    for library in [r".\s.mtl", r"sub\s.mtl", r"C:\my work\s.mtl", "\\\n s.mtl"] {
        let text = format!("{mark}mtllib {library}\n{TRIANGLE}usemtl \\\r\n a\nf 1 2 3");
        let scene = load(&folder.write("s.obj", text), &LoadOptions::default()).unwrap();
        assert!(scene.warnings.is_empty(), "{library}: {:?}", scene.warnings);
        assert_eq!(scene.materials[scene.objects[0].material as usize].name, "a", "{library}");
    }
}

#[test]
fn a_flood_of_libraries_is_cut_off() {
    let names: String = (0..1500).map(|i| format!("mtllib {i}.mtl\n")).collect();
    let scene = load_obj(format!("{names}{TRIANGLE}f 1 2 3")).unwrap();
    let told = warnings(&scene);
    assert!(
        told[100].contains("901 more warnings"),
        "a thousand that are missing, and one about the rest: {}",
        told[100]
    );
    let again = "mtllib s.mtl\n".repeat(1_000_000);
    assert_eq!(load_obj(format!("{again}{TRIANGLE}f 1 2 3")).unwrap().warnings.len(), 1);
}

#[test]
fn what_an_opacity_map_leaves_out_is_not_there() {
    let folder = Folder::new();
    // The lower half is left out; the map of it is larger than the colours.
    let holes = image::GrayImage::from_fn(1, 4, |_, y| image::Luma([if y < 2 { 255 } else { 0 }]));
    holes.save(folder.write("holes.png", "")).unwrap();
    let colors = image::RgbImage::from_pixel(2, 2, image::Rgb([0, 255, 0]));
    colors.save(folder.write("green.png", "")).unwrap();
    let both = image::RgbaImage::from_fn(1, 4, |_, y| image::Rgba([0, 255, 0, if y < 2 { 255 } else { 0 }]));
    both.save(folder.write("both.png", "")).unwrap();
    let square = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\nusemtl a\nf 1/1 2/2 3/3 4/4";
    let obj = folder.write("s.obj", format!("mtllib s.mtl\n{square}"));
    let seen = |library: &str| {
        folder.write("s.mtl", format!("newmtl a\nKd 0 1 0\n{library}"));
        let scene = load(&obj, &in_its_own_light()).unwrap();
        (scene.materials[0].alpha, picture(&scene, 64, 64).iter().filter(|[_, green, _]| *green > 40).count())
    };
    let (alpha, whole) = seen("map_Kd green.png");
    assert_eq!(alpha, Alpha::Opaque);
    let two_names = "map_Kd both.png\nmap_d ./both.png";
    let one_name = "map_Kd both.png\nmap_d both.png";
    for library in ["map_Kd green.png\nmap_d holes.png", "map_d holes.png", one_name, two_names] {
        let (alpha, rest) = seen(library);
        assert_eq!(alpha, Alpha::Mask(0.5), "{library}");
        assert!((whole * 4 / 10..whole * 6 / 10).contains(&rest), "{library}: {rest} of {whole}");
    }
    assert_eq!(seen("map_Kd green.png\nmap_d none.png").0, Alpha::Opaque);
}

#[test]
fn a_missing_colour_is_shown_as_grey_squares() {
    let folder = Folder::new();
    let square = "v 0 0 0\nv 4 0 0\nv 4 4 0\nv 0 4 0\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\nusemtl a\nf 1/1 2/2 3/3 4/4";
    let obj = folder.write("s.obj", format!("mtllib s.mtl\n{square}"));
    for (library, told) in [
        ("newmtl a\nKd 0 0 0\nmap_Kd none.png", "cannot read image \"none.png\""),
        ("newmtl a\nmap_Kd s.mtl", "cannot decode image \"s.mtl\""),
    ] {
        folder.write("s.mtl", library);
        let scene = load(&obj, &in_its_own_light()).unwrap();
        let warnings = warnings(&scene);
        assert!(warnings[0].contains(told) && warnings[0].ends_with("a placeholder is shown"), "{warnings:?}");
        let [Texture::Checker { size, .. }] = scene.textures[..] else { panic!("squares") };
        assert_eq!(size, 0.25, "of a metre");
        let picture = picture(&scene, 32, 18);
        let [low, high] = [u8::MIN, u8::MAX].map(|start| {
            let shown = picture.iter().filter(|pixel| **pixel != [0; 3]);
            shown.fold(255 - start, |kept, pixel| if start == 0 { kept.min(pixel[0]) } else { kept.max(pixel[0]) })
        });
        assert!(high - low >= 8 && high < 200 && picture.iter().all(|[r, g, b]| r == g && g == b), "{low} {high}");
    }
}

/// A Zstandard frame of one raw block (RFC 8878) that holds a text shorter than 256 bytes.
fn frame(text: &str) -> Vec<u8> {
    let length = text.len() as u8;
    let block = (u32::from(length) << 3 | 1).to_le_bytes();
    [&[0x28, 0xB5, 0x2F, 0xFD, 0x20, length][..], &block[..3], text.as_bytes()].concat()
}

#[test]
fn compressed_files_are_read_within_the_limit() {
    let folder = Folder::new();
    let text = format!("{TRIANGLE}f 1 2 3");
    let file = folder.write("s.obj.zst", frame(&text));
    let scene = load(&file, &LoadOptions::default()).unwrap();
    assert_eq!((scene.format, scene.geometry.len()), ("OBJ", 1));
    let error = load(&folder.write("s.obj.zst", frame("v 1 x")), &LoadOptions::default()).unwrap_err().to_string();
    assert!(error.contains("s.obj.zst:1:5: expected a number"), "{error}");
    let cut = load(&folder.write("s.obj.zst", &frame(&text)[..20]), &LoadOptions::default()).unwrap_err().to_string();
    assert!(cut.contains("cannot expand the file"), "{cut}");
    // A thousand blocks that repeat a blank 131,072 times each.
    let block = (131_072_u32 << 3 | 0b010).to_le_bytes();
    let bomb = [&[0x28, 0xB5, 0x2F, 0xFD, 0x00, 0x38][..], &[&block[..3], b" "].concat().repeat(1000)].concat();
    let mut options = LoadOptions::default();
    options.limits.set("file-bytes", "1000000").unwrap();
    let error = load(&folder.write("s.obj.zst", bomb), &options).unwrap_err().to_string();
    assert!(error.contains("limit file-bytes of 1000000"), "{error}");
}

#[test]
fn limits_hold_before_memory_is_taken() {
    let groups = format!("{TRIANGLE}{}", "g\nf 1 2 3\n".repeat(20));
    let fan = format!("{TRIANGLE}f {}", "1 2 3 ".repeat(10));
    let (positions, corners) =
        (format!("{TRIANGLE}{TRIANGLE}").repeat(2), format!("{TRIANGLE}f {}", "1 2 3 ".repeat(3)));
    for (limit, text) in [("objects", groups), ("primitives", fan), ("vertices", positions), ("vertices", corners)] {
        let mut options = LoadOptions::default();
        options.limits.set(limit, "10").unwrap();
        let error = load(&Folder::new().write("s.obj", text), &options).unwrap_err().to_string();
        assert!(error.contains(&format!("limit {limit} of 10")), "{error}");
    }
}
