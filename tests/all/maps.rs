//! Planes of how pixels were obtained, and the maps painted from them.

use crate::picture_bits::PictureBits;
use crate::stress;
use raywalk::app::maps::{Key, Map};
use raywalk::render::stats::PixelCounts;
use raywalk::render::{Decision, Film, FrameStats, Planes, Scratch, render_frame};
use raywalk::scene::{LoadOptions, Scene, builtin};
use raywalk::settings::{Fill, Settings, Supersample, Visibility};

/// Several tiles, the last ones cut off.
const SIZE: (u32, u32) = (150, 83);
const SEEN: Planes = Planes { depth: true, normal: true, object: true, primitive: true, decision: false, cost: false };

fn scenes() -> Vec<Scene> {
    let wanted = ["crowd", "water", "heap", "only a headlight"];
    let stress = stress::scenes().into_iter().filter(|(name, _)| wanted.contains(&name.as_str()));
    let builtin = builtin(&LoadOptions::default()).expect("it loads");
    std::iter::once(builtin).chain(stress.map(|(_, scene)| scene)).collect()
}

/// Every way of finding out what is seen, every way to fill it in, and every number of samples.
fn all_settings() -> Vec<Settings> {
    let exact = Settings::exact();
    let mut all = vec![Settings { visibility: Visibility::Full, ..exact.clone() }];
    for fill in [Fill::Hit, Fill::Color] {
        all.push(Settings { fill, ..exact.clone() });
        for stride in [2, 8, 16] {
            all.push(Settings { visibility: Visibility::Subsample, stride, fill, ..exact.clone() });
        }
    }
    for supersample in [Supersample::Adaptive, Supersample::Grid { side: 2 }] {
        all.push(Settings { supersample, ..exact.clone() });
        all.push(Settings { supersample, ..Settings::balanced() });
        all.push(Settings { supersample, visibility: Visibility::Subsample, ..exact.clone() });
    }
    all.push(Settings::fast());
    all.push(Settings { render_scale: 0.7, supersample: Supersample::Adaptive, ..exact.clone() });
    all
}

fn render(scene: &Scene, settings: &Settings, planes: Planes, scratch: &mut Scratch) -> (Film, FrameStats) {
    let mut film = Film::new(SIZE.0, SIZE.1, planes);
    let stats = render_frame(scene, &scene.cameras[0].camera, settings, scratch, &mut film);
    (film, stats)
}

fn pixels() -> impl Iterator<Item = (u32, u32)> {
    (0..SIZE.1).flat_map(|y| (0..SIZE.0).map(move |x| (x, y)))
}

fn counts(film: &Film) -> (PixelCounts, u64) {
    let (mut counts, mut supersampled) = (PixelCounts::default(), 0);
    for (x, y) in pixels() {
        let obtained = film.decision(x, y).expect("it is kept");
        *match obtained.decision {
            Decision::Traced => &mut counts.traced,
            Decision::Resolved => &mut counts.resolved,
            Decision::Certified => &mut counts.certified,
            Decision::Interpolated => &mut counts.interpolated,
        } += 1;
        supersampled += u64::from(obtained.supersampled);
    }
    (counts, supersampled)
}

#[test]
fn decisions_and_rays_of_all_pixels_add_up_to_the_stats() {
    let mut scratch = Scratch::new();
    let (mut seen, mut off) = ([0; 5], Vec::new());
    for scene in scenes() {
        for settings in all_settings() {
            let planes = Planes { decision: true, cost: true, ..Planes::default() };
            let (film, stats) = render(&scene, &settings, planes, &mut scratch);
            let (counted, supersampled) = counts(&film);
            let rays: u64 = pixels().map(|(x, y)| u64::from(film.cost(x, y).expect("it is kept"))).sum();
            let traced = stats.rays.primary + stats.rays.shadow + stats.rays.reflection + stats.rays.refraction;
            if (counted, supersampled, rays) != (stats.pixels, stats.supersampled, traced) {
                off.push(format!(
                    "{}, {}: {counted:?} {supersampled} {rays}, not {:?} {} {traced}",
                    scene.name,
                    settings.flags(),
                    stats.pixels,
                    stats.supersampled
                ));
            }
            let PixelCounts { traced, resolved, certified, interpolated } = counted;
            for (sum, count) in seen.iter_mut().zip([traced, resolved, certified, interpolated, supersampled]) {
                *sum += count;
            }
        }
    }
    assert!(off.is_empty(), "{}", off.join("\n"));
    assert!(seen.iter().all(|count| *count > 1000), "some decision is no test: {seen:?}");
}

#[test]
fn planes_of_how_pixels_were_obtained_change_no_bit_of_what_is_drawn() {
    let mut scratch = Scratch::new();
    for scene in scenes() {
        for settings in all_settings() {
            let (without, _) = render(&scene, &settings, SEEN, &mut scratch);
            let (with, _) = render(&scene, &settings, Planes { decision: true, cost: true, ..SEEN }, &mut scratch);
            let difference = PictureBits::of(&without).difference(&PictureBits::of(&with));
            assert_eq!(difference, None, "{}, {}", scene.name, settings.flags());
            assert!(without.rgba() == with.rgba());
        }
    }
}

#[test]
fn every_map_paints_with_a_key_of_its_own() {
    let scene = builtin(&LoadOptions::default()).expect("it loads");
    let mut scratch = Scratch::new();
    let (exact, _) = render(&scene, &Settings::balanced().reference(), Planes::default(), &mut scratch);
    let (picture, _) = render(&scene, &Settings::balanced(), Planes::default(), &mut scratch);
    for map in Map::ALL.into_iter().skip(1) {
        let (mut film, _) = render(&scene, &Settings::balanced(), map.planes(), &mut scratch);
        let mut other = Film::new(SIZE.0, SIZE.1, map.planes());
        let legend = map.paint(&mut [&mut film, &mut other], Some(&exact)).expect("a map has a legend");
        assert!(film.rgba() != picture.rgba(), "{}", map.name());
        assert!(film.rgba().chunks(4).all(|pixel| pixel[3] == 255), "{} is opaque", map.name());
        match legend.key {
            Key::Classes(classes) => {
                for at in 0..2 {
                    let all: f64 = classes.iter().map(|class| class.shares[at]).sum();
                    assert!((all - 1.0).abs() < 1e-9, "{all} of film {at}");
                }
            }
            Key::Scale(scale) => {
                assert!(scale.marks.is_sorted_by(|a, b| a.0 < b.0), "{:?}", scale.marks);
                assert!(!scale.unit.is_empty() && scale.marks.iter().all(|(_, number)| !number.is_empty()));
            }
            Key::Words(words) => assert!(!words.is_empty()),
        }
    }
}
