//! A frame depends on nothing that was rendered before.

use crate::picture_bits::{PictureBits, film, render};
use crate::stress;
use raywalk::render::{Scratch, render_frame};
use raywalk::scene::Scene;
use raywalk::settings::{Settings, Visibility};

const SIZE: (u32, u32) = (100, 70);

fn scenes() -> Vec<Scene> {
    let wanted = ["crowd", "within glass", "many lights", "only a headlight"];
    stress::scenes().into_iter().filter(|(name, _)| wanted.contains(&name.as_str())).map(|(_, scene)| scene).collect()
}

fn all_settings() -> [Settings; 3] {
    let subsample = Settings { visibility: Visibility::Subsample, ..Settings::exact() };
    [Settings::exact(), subsample, Settings::balanced()]
}

#[test]
fn a_used_scratch_gives_the_bits_of_a_fresh_one() {
    let scenes = scenes();
    for settings in all_settings() {
        let mut scratch = Scratch::new();
        let mut used = film(SIZE);
        for _ in 0..2 {
            for scene in &scenes {
                let camera = scene.cameras[0].camera;
                let fresh = PictureBits::of(&render(scene, &camera, &settings, SIZE));
                for _ in 0..2 {
                    render_frame(scene, &camera, &settings, &mut scratch, &mut used);
                    assert_eq!(fresh.difference(&PictureBits::of(&used)), None);
                }
            }
        }
    }
}

#[test]
fn a_cancelled_frame_leaves_nothing_behind() {
    let scenes = scenes();
    let settings = Settings::exact();
    let mut scratch = Scratch::new();
    let mut used = film(SIZE);
    for scene in &scenes {
        let camera = scene.cameras[0].camera;
        let fresh = PictureBits::of(&render(scene, &camera, &settings, SIZE));
        let cancel = scratch.cancel.clone();
        let stopped = std::thread::scope(|scope| {
            scope.spawn(|| {
                std::thread::sleep(std::time::Duration::from_millis(1));
                cancel.cancel();
            });
            let mut large = film((320, 240));
            render_frame(scene, &camera, &settings, &mut scratch, &mut large)
        });
        scratch.cancel.cancel();
        assert!(!render_frame(scene, &camera, &settings, &mut scratch, &mut used).completed);
        scratch.cancel.reset();
        let stats = render_frame(scene, &camera, &settings, &mut scratch, &mut used);
        assert!(stats.completed, "after {stopped:?}");
        let pixels = stats.pixels;
        assert_eq!(
            pixels.traced + pixels.resolved + pixels.certified + pixels.interpolated,
            u64::from(SIZE.0 * SIZE.1),
            "counts of the cancelled frame are not carried over"
        );
        assert_eq!(fresh.difference(&PictureBits::of(&used)), None);
    }
}

#[test]
fn the_planes_that_a_film_keeps_do_not_change_its_colours() {
    for scene in scenes() {
        let camera = scene.cameras[0].camera;
        for settings in all_settings() {
            let with = render(&scene, &camera, &settings, SIZE);
            let mut without = raywalk::render::Film::new(SIZE.0, SIZE.1, raywalk::render::Planes::default());
            render_frame(&scene, &camera, &settings, &mut Scratch::new(), &mut without);
            assert_eq!(with.rgba(), without.rgba());
        }
    }
}
