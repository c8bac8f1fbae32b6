//! Surfaces that vary: holes, blending, relief, colours of corners, filtered textures. Whatever is looked up depends on
//! the ray alone, so every way to find hits gives the same bits; and it shows what it should.

use crate::exactness::wrong_pixels;
use crate::picture_bits::render;
use crate::random::Random;
use glam::{Affine2, DAffine3, DVec2, DVec3, Vec2, Vec3, Vec4};
use image::{ImageFormat, RgbaImage};
use raywalk::render::Film;
use raywalk::scene::build::SceneBuilder;
use raywalk::scene::desc::problem::{At, Warnings};
use raywalk::scene::desc::{
    CameraDesc, ImageDesc, ImageSource, MaterialDesc, MeshDesc, NameRef, ObjectDesc, SceneDesc, ShapeDesc, TextureDesc,
    TextureKind,
};
use raywalk::scene::files::Files;
use raywalk::scene::light::{Falloff, LightKind};
use raywalk::scene::material::{Alpha, ColorSource, Lookup, Model, Relief, Scaled};
use raywalk::scene::texture::{Blending, Sampler, Wrap};
use raywalk::scene::{Camera, FORMATS, Light, LoadOptions, Material, Scene};
use raywalk::settings::{Settings, Supersample, ToneMap};
use std::io::Cursor;
use std::path::Path;
use std::sync::Arc;

pub(super) fn name(text: &str) -> NameRef {
    NameRef { name: text.to_owned(), at: At(0) }
}

/// A texture of the given texels, row by row from the top.
pub(super) fn texture(called: &str, width: u32, texels: &[[u8; 4]], sampler: Sampler) -> TextureDesc {
    let image = RgbaImage::from_raw(width, texels.len() as u32 / width, texels.concat()).unwrap();
    let mut bytes = Cursor::new(Vec::new());
    image.write_to(&mut bytes, ImageFormat::Png).unwrap();
    let source = ImageSource::Embedded { bytes: bytes.into_inner().into(), name: name(called) };
    let kind = TextureKind::Image(ImageDesc { source, sampler, optional: false });
    TextureDesc { name: name(called), kind, size: 1.0 }
}

fn noise(random: &mut Random, count: usize) -> Vec<[u8; 4]> {
    (0..count).map(|_| [(); 4].map(|()| random.below(256) as u8)).collect()
}

pub(super) fn material(called: &str) -> MaterialDesc {
    MaterialDesc { name: called.to_owned(), ..MaterialDesc::default_phong() }
}

pub(super) fn lookup(texture: &str) -> Lookup<NameRef> {
    Lookup::new(name(texture))
}

pub(super) fn scaled(texture: &str, scale: f32) -> Option<Scaled<NameRef>> {
    Some(Scaled { lookup: lookup(texture), scale })
}

pub(super) fn object(kind: &'static str, material: &str, shape: ShapeDesc) -> ObjectDesc {
    ObjectDesc { at: At(0), kind, name: None, material: Some(name(material)), transform: None, shape }
}

/// A square of edge 2 around the origin, in the plane z = 0, its texture coordinates from 0 to 1.
fn square() -> MeshDesc {
    let corners = [DVec2::ZERO, DVec2::X, DVec2::ONE, DVec2::Y];
    MeshDesc {
        vertices: corners.map(|c| (c * 2.0 - 1.0).extend(0.0)).to_vec(),
        triangles: vec![[0, 1, 2], [0, 2, 3]],
        uvs: corners.to_vec(),
        ..MeshDesc::default()
    }
}

pub(super) fn built(scene: SceneDesc) -> Scene {
    let options = LoadOptions::default();
    let mut builder =
        SceneBuilder::new(Path::new("surfaces"), &FORMATS[0], Files::embedded(&[], &options.limits), &options);
    builder.add(scene, &mut Warnings::default()).unwrap();
    builder.finish().expect("nobody cancels")
}

pub(super) fn light(position: DVec3) -> Light<DVec3> {
    Light { name: None, kind: LightKind::Point { position }, color: Vec3::ONE, falloff: Falloff::None }
}

pub(super) fn camera(eye: Vec3, look_at: Vec3) -> Camera {
    Camera { eye, look_at, up: Vec3::Y, fov: 50.0, near: 0.0, far: f32::INFINITY }
}

/// Everything that may vary, in a room of mirrors and glass.
fn crowd(seed: u64) -> (Scene, Vec<Camera>) {
    let mut random = Random::new(seed);
    let pick = |random: &mut Random| Sampler {
        wrap: [(); 2].map(|()| random.pick(&[Wrap::Repeat, Wrap::Mirror, Wrap::Clamp])),
        magnification: random.pick(&[Blending::Nearest, Blending::Linear]),
        minification: random.pick(&[Blending::Nearest, Blending::Linear]),
        between_levels: random.pick(&[None, Some(Blending::Nearest), Some(Blending::Linear)]),
    };
    let textures: Vec<TextureDesc> = ["a", "b", "c"]
        .into_iter()
        .map(|called| {
            let (width, height) = (1 + random.below(13), 1 + random.below(9));
            let texels = noise(&mut random, width * height);
            let sampler = pick(&mut random);
            texture(called, width as u32, &texels, sampler)
        })
        .collect();
    let turned = Lookup {
        set: 1,
        transform: Affine2::from_scale_angle_translation(Vec2::new(3.0, -2.0), 0.7, Vec2::new(0.3, 0.1)),
        ..lookup("b")
    };
    let rough = |roughness| Model::MetallicRoughness { ambient: Vec3::splat(0.1), metallic: 0.5, roughness };
    let textured = ColorSource { factor: Vec3::splat(0.9), texture: Some(lookup("a")) };
    let materials = vec![
        MaterialDesc { alpha: Alpha::Mask(0.5), color: textured.clone(), ..material("cut") },
        MaterialDesc { alpha: Alpha::Blend, opacity: 0.8, color: textured.clone(), ..material("blended") },
        MaterialDesc {
            relief: Relief { normal: scaled("c", 0.7), bump: scaled("b", 0.02), parallax: scaled("a", 0.1) },
            color: ColorSource::textured(turned.clone()),
            reflectivity: Vec3::splat(0.3),
            ..material("carved")
        },
        MaterialDesc {
            model: rough(0.4),
            metallic_roughness: Some(turned),
            occlusion: scaled("c", 0.8),
            emission: ColorSource { factor: Vec3::splat(0.2), texture: Some(lookup("c")) },
            color: textured.clone(),
            ..material("worn")
        },
        MaterialDesc { unlit: true, color: textured.clone(), ..material("unlit") },
        MaterialDesc {
            model: rough(0.05),
            transparency: Vec3::splat(0.8),
            transmission: Some(lookup("b")),
            fresnel: true,
            thin: true,
            color: textured,
            ..material("pane")
        },
        MaterialDesc { reflectivity: Vec3::splat(0.8), ..material("mirror") },
    ];
    let mut objects = Vec::new();
    for number in 0..40 {
        let mut mesh = square();
        if random.chance(0.6) {
            mesh.uvs1 = (0..4).map(|_| random.point(2.0).as_vec3().truncate()).collect();
        }
        if random.chance(0.5) {
            mesh.colors = (0..4).map(|_| (random.point(0.5).as_vec3() + 0.5).extend(0.7)).collect();
        }
        if random.chance(0.5) {
            let sign = random.sign() as f32;
            mesh.tangents = (0..4).map(|_| random.direction().as_vec3().extend(sign)).collect();
        }
        if random.chance(0.5) {
            mesh.normals = (0..4).map(|_| DVec3::Z + random.point(0.4)).collect();
        }
        let called = ["cut", "blended", "carved", "worn", "unlit", "pane", "mirror"][number % 7];
        let shape = match number % 9 {
            7 => ShapeDesc::Sphere { center: DVec3::ZERO, radius: 0.8 },
            8 => ShapeDesc::Cone { base: -DVec3::Y, top: DVec3::Y, radius: 0.4, radius_top: 0.2, capped: true },
            _ => ShapeDesc::Mesh(Arc::new(mesh)),
        };
        let (axis, angle) = (random.direction(), random.within(0.0, 6.0));
        let place = DAffine3::from_axis_angle(axis, angle);
        let move_by = DAffine3::from_translation(random.point(3.0));
        objects.push(ObjectDesc { transform: Some(move_by * place), ..object("mesh", called, shape) });
    }
    let floor = ShapeDesc::Plane { point: -DVec3::Y * 3.0, normal: DVec3::Y };
    objects.push(object("plane", "carved", floor));
    let scene = SceneDesc {
        textures,
        materials,
        objects,
        lights: vec![light(DVec3::new(2.0, 6.0, 3.0)), light(DVec3::new(-5.0, 3.0, -1.0))],
        ..SceneDesc::default()
    };
    let cameras = (0..2).map(|_| camera(random.point(5.0).as_vec3(), random.point(1.0).as_vec3())).collect();
    (built(scene), cameras)
}

#[test]
fn surfaces_that_vary_keep_every_bit() {
    let mut wrong = Vec::new();
    for seed in 0..4 {
        let (scene, cameras) = crowd(seed);
        assert!(!scene.geometry.holes.is_empty(), "nothing is cut");
        wrong.extend(wrong_pixels(&format!("crowd {seed}"), &scene, &cameras));
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

/// One square seen straight on from a distance of 3, before a white wall that needs no light.
fn before_a_wall(textures: Vec<TextureDesc>, square_of: MaterialDesc, mesh: MeshDesc) -> Scene {
    let wall = MaterialDesc { unlit: true, ..material("wall") };
    let plane = ShapeDesc::Plane { point: -DVec3::Z * 5.0, normal: DVec3::Z };
    let called = square_of.name.clone();
    built(SceneDesc {
        textures,
        materials: vec![square_of, wall],
        objects: vec![object("mesh", &called, ShapeDesc::Mesh(Arc::new(mesh))), object("plane", "wall", plane)],
        lights: vec![light(DVec3::new(0.0, 0.0, 3.0))],
        cameras: vec![CameraDesc {
            at: At(0),
            name: "front".to_owned(),
            eye: DVec3::Z * 3.0,
            look_at: DVec3::ZERO,
            camera: camera(Vec3::Z * 3.0, Vec3::ZERO),
        }],
        ..SceneDesc::default()
    })
}

fn shown(scene: &Scene) -> Film {
    render(scene, &scene.cameras[0].camera, &Settings::exact(), (64, 64))
}

/// The linear colour of a pixel in the middle of a quarter of the square: -1 or 1 to the right and upwards.
fn quarter(film: &Film, [right, up]: [i32; 2]) -> Vec3 {
    let at = |side: i32| (32 + side * 10) as u32;
    film.color(at(right), at(-up)).into()
}

pub(super) const NEAREST: Sampler = Sampler {
    wrap: [Wrap::Repeat; 2],
    magnification: Blending::Nearest,
    minification: Blending::Nearest,
    between_levels: None,
};

/// The outermost texels beyond the edges, too.
const HELD: Sampler = Sampler { wrap: [Wrap::Clamp; 2], ..NEAREST };

#[test]
fn what_lies_behind_holes_is_seen_and_lit_through_them() {
    // Whole in the upper left and lower right.
    let (whole, hole) = ([200, 0, 0, 255], [200, 0, 0, 0]);
    let leaf = texture("leaf", 2, &[whole, hole, hole, whole], NEAREST);
    let cut = MaterialDesc {
        alpha: Alpha::Mask(0.5),
        color: ColorSource::textured(lookup("leaf")),
        unlit: true,
        ..material("cut")
    };
    let film = shown(&before_a_wall(vec![leaf], cut, square()));
    for corner in [[1, 1], [-1, -1]] {
        assert_eq!(quarter(&film, corner), Vec3::ONE, "{corner:?}");
    }
    for corner in [[-1, 1], [1, -1]] {
        assert_eq!(quarter(&film, corner).y, 0.0, "{corner:?}");
    }
}

#[test]
fn blended_surfaces_cover_by_their_opacity() {
    let half = texture("half", 1, &[[0, 0, 0, 51]], NEAREST);
    let blended = MaterialDesc {
        alpha: Alpha::Blend,
        opacity: 0.5,
        color: ColorSource::textured(lookup("half")),
        unlit: true,
        ..material("blended")
    };
    let film = shown(&before_a_wall(vec![half], blended, square()));
    assert!((quarter(&film, [1, 1]) - Vec3::splat(0.9)).abs().max_element() < 1e-6);
}

#[test]
fn corners_tint_what_is_unlit() {
    let mesh = MeshDesc { colors: vec![Vec4::new(0.25, 0.5, 1.0, 1.0); 4], ..square() };
    let unlit = MaterialDesc { unlit: true, ..material("unlit") };
    let film = shown(&before_a_wall(Vec::new(), unlit, mesh));
    assert!((quarter(&film, [-1, 1]) - Vec3::new(0.25, 0.5, 1.0)).abs().max_element() < 1e-6);
}

/// A square with relief, in white.
fn relieved(textures: Vec<TextureDesc>, relief: Relief<NameRef>) -> Film {
    let carved = MaterialDesc {
        relief,
        model: Model::Phong { ambient: Vec3::ZERO, diffuse: Vec3::ONE, specular: Vec3::ZERO, shininess: 1.0 },
        ..material("carved")
    };
    shown(&before_a_wall(textures, carved, square()))
}

#[test]
fn normal_maps_turn_surfaces_towards_the_light_they_lean_to() {
    let map = |x: u8, y: u8| texture("map", 1, &[[x, y, 255, 255]], NEAREST);
    let relief = || Relief { normal: scaled("map", 1.0), ..Relief::NONE };
    let flat = relieved(vec![map(128, 128)], relief());
    let plain = relieved(Vec::new(), Relief::NONE);
    // The light is in front of the middle: left of it, what leans to the right sees more of it.
    let [leaning_right, leaning_up] =
        [relieved(vec![map(148, 128)], relief()), relieved(vec![map(128, 148)], relief())];
    for corner in [[-1, -1], [1, -1], [-1, 1], [1, 1]] {
        let light = |film: &Film| quarter(film, corner).x;
        assert!((light(&flat) - light(&plain)).abs() < 0.01, "{corner:?}");
        assert_eq!(light(&leaning_right) > light(&flat), corner[0] < 0, "{corner:?}");
        assert_eq!(light(&leaning_up) > light(&flat), corner[1] < 0, "{corner:?}");
    }
}

#[test]
fn bumps_lean_away_from_where_they_rise() {
    let ramp: Vec<[u8; 4]> = (0..64).map(|x| [x * 4, x * 4, x * 4, 255]).collect();
    let linear = Sampler { between_levels: None, ..Sampler::default() };
    let relief = Relief { bump: scaled("ramp", 0.5), ..Relief::NONE };
    let film = relieved(vec![texture("ramp", 64, &ramp, linear)], relief);
    // Rising to the right it leans to the left: darker on the left, brighter on the right.
    assert!(quarter(&film, [-1, 1]).x < 0.95 * quarter(&film, [1, 1]).x);
}

#[test]
fn parallax_shows_the_bottom_nearer_to_the_middle() {
    // All at the bottom, and a colour that is red on the left half and green on the right.
    let (deep, red, green) = ([0, 0, 0, 255], [255, 0, 0, 255], [0, 255, 0, 255]);
    let textures = || vec![texture("depth", 1, &[deep], NEAREST), texture("halves", 2, &[red, green], HELD)];
    let film = |height: f32| {
        let carved = MaterialDesc {
            relief: Relief { parallax: scaled("depth", height), ..Relief::NONE },
            color: ColorSource::textured(lookup("halves")),
            unlit: true,
            ..material("carved")
        };
        let mut scene = before_a_wall(textures(), carved, square());
        // From the right, so that what is deeper moves to the right.
        scene.cameras[0].camera = camera(Vec3::new(2.0, 0.0, 2.0), Vec3::ZERO);
        shown(&scene)
    };
    let [flat, deep] = [film(0.0), film(0.3)];
    let reds = |film: &Film| (0..64).filter(|&x| film.color(x, 32) == [1.0, 0.0, 0.0]).count();
    assert!(reds(&deep) > reds(&flat) + 2, "{} {}", reds(&deep), reds(&flat));
}

#[test]
fn far_textures_are_means_of_near_ones() {
    let (black, white) = ([0, 0, 0, 255], [255, 255, 255, 255]);
    let checks: Vec<[u8; 4]> = (0..256 * 256).map(|i| if (i + i / 256) % 2 == 0 { black } else { white }).collect();
    let unlit = || MaterialDesc { unlit: true, color: ColorSource::textured(lookup("checks")), ..material("checked") };
    let film = |sampler| shown(&before_a_wall(vec![texture("checks", 256, &checks, sampler)], unlit(), square()));
    let contrast = |film: &Film| {
        let values = (20..44).flat_map(|x| (20..44).map(move |y| (x, y))).map(|(x, y)| film.color(x, y)[0]);
        let (least, most) = values.fold((1.0_f32, 0.0_f32), |(least, most), v| (least.min(v), most.max(v)));
        most - least
    };
    assert!(contrast(&film(Sampler::default())) < 0.05);
    assert!(contrast(&film(NEAREST)) > 0.9);
}

#[test]
fn what_is_unlit_keeps_its_colour_under_the_tone_curve_beside_what_is_lit() {
    // A lit wall, so that the curve is applied; before it an unlit square of four colours.
    let colors = [[255, 0, 0, 255], [255, 255, 255, 255], [200, 120, 40, 255], [40, 40, 40, 255]];
    let color = ColorSource::textured(lookup("colors"));
    let square_of = MaterialDesc { unlit: true, color, ..material("plate") };
    let mut scene = before_a_wall(vec![texture("colors", 2, &colors, NEAREST)], square_of, square());
    scene.materials[1].unlit = false;
    assert!(!scene.is_all_unlit());
    let exposure = raywalk::settings::Exposure::Scene;
    for tone_map in [ToneMap::Neutral, ToneMap::None] {
        for supersample in [Supersample::Off, Supersample::Grid { side: 2 }] {
            let settings = Settings { exposure, tone_map: Some(tone_map), supersample, ..Settings::exact() };
            let film = render(&scene, &scene.cameras[0].camera, &settings, (64, 64));
            for (color, [right, up]) in colors.iter().zip([[-1, 1], [1, 1], [-1, -1], [1, -1]]) {
                let at = ((32 - up * 10) * 64 + 32 + right * 10) as usize * 4;
                let shown = &film.rgba()[at..at + 3];
                let is_near = shown.iter().zip(color).all(|(shown, color)| shown.abs_diff(*color) <= 2);
                assert!(is_near, "{tone_map:?}: {color:?} is shown as {shown:?}");
            }
        }
    }
    let wrong = wrong_pixels("plate", &scene, &[scene.cameras[0].camera]);
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

#[test]
fn half_of_an_unlit_colour_is_half_of_it_under_the_tone_curve() {
    let white = [[255; 4]];
    let plate = MaterialDesc { unlit: true, alpha: Alpha::Blend, opacity: 0.5, ..material("plate") };
    let mut scene = before_a_wall(vec![texture("white", 1, &white, NEAREST)], plate, square());
    let black = Model::Phong { ambient: Vec3::ZERO, diffuse: Vec3::ZERO, specular: Vec3::ZERO, shininess: 1.0 };
    scene.materials[1] = Material { model: black, ..Material::default_phong() };
    let settings = Settings { tone_map: Some(ToneMap::Neutral), ..Settings::exact() };
    let film = render(&scene, &scene.cameras[0].camera, &settings, (64, 64));
    let shown = film.rgba()[(20 * 64 + 20) * 4];
    assert!(shown.abs_diff(188) <= 4, "{shown}");
}
