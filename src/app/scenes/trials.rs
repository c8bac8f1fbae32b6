//! Scenes opened, edited, broken and mended while they are shown.

use super::*;
use crate::temporary::Folder;
use std::sync::Mutex;

const SOON: Duration = Duration::from_secs(20);
const BALL: &str = r#"{ "type": "sphere", "center": [0, 0, 0], "radius": 1, "material": "red" }"#;

/// Scenes, and a channel that says when to ask for news.
fn scenes() -> (Scenes, Receiver<()>) {
    let (sender, woken) = channel();
    let sender = Mutex::new(sender);
    let wake = move || sender.lock().expect("nobody panics").send(()).unwrap_or(());
    (Scenes::new(LoadOptions::default(), RecentFiles::default(), Arc::new(wake)), woken)
}

fn ball(color: &str) -> String {
    format!(r#"{{ "version": 1, "materials": {{ "red": {{ "color": {color} }} }}, "objects": [{BALL}] }}"#)
}

/// Waits for news, or for `until` to come true.
fn wait(scenes: &mut Scenes, woken: &Receiver<()>, until: impl Fn(&Scenes) -> bool) -> Option<News> {
    let end = Instant::now() + SOON;
    loop {
        if let Some(news) = scenes.news() {
            return Some(news);
        }
        if until(scenes) {
            return None;
        }
        let left = end.saturating_duration_since(Instant::now());
        woken.recv_timeout(left).expect("something comes of it");
    }
}

fn opened(scenes: &mut Scenes, woken: &Receiver<()>) -> Arrival {
    match wait(scenes, woken, |_| false) {
        Some(News::Opened(arrival)) => arrival,
        other => panic!("{other:?}"),
    }
}

fn reloaded(scenes: &mut Scenes, woken: &Receiver<()>) -> Arrival {
    match wait(scenes, woken, |_| false) {
        Some(News::Reloaded(arrival)) => arrival,
        other => panic!("{other:?}"),
    }
}

fn red(arrival: &Arrival) -> f32 {
    arrival.scene.materials[0].color.factor.x
}

#[test]
fn a_folder_is_opened_and_its_file_remembered() {
    let folder = Folder::new();
    let file = folder.write("ball.json", ball("[0.5, 0, 0]"));
    let (mut scenes, woken) = scenes();
    scenes.drop_in(folder.path().to_owned());
    assert!(scenes.open_dropped() && scenes.is_loading() && !scenes.open_dropped());
    let arrival = opened(&mut scenes, &woken);
    assert_eq!((red(&arrival), arrival.file.as_ref()), (0.5, Some(&file)));
    assert_eq!(scenes.recent().files(), [file]);
    assert!(!scenes.is_loading());
}

#[test]
fn an_edit_is_seen_a_broken_one_is_survived_and_mended() {
    let folder = Folder::new();
    let file = folder.write("ball.json", ball("[0.5, 0, 0]"));
    let (mut scenes, woken) = scenes();
    scenes.open(&file);
    opened(&mut scenes, &woken);
    folder.write("ball.json", ball("[0.25, 0, 0]"));
    assert_eq!(red(&reloaded(&mut scenes, &woken)), 0.25);
    folder.write("ball.json", "{ \"version\": 1,");
    assert!(wait(&mut scenes, &woken, |scenes| scenes.failure.is_some()).is_none());
    let failure = scenes.report(Instant::now()).failure.expect("it was broken");
    assert!(failure.title.contains("ball.json could not be reloaded"), "{}", failure.title);
    assert!(failure.message.contains("ball.json:1:"), "{}", failure.message);
    let new = folder.write("ball.json.new", ball("[0.125, 0, 0]"));
    std::fs::rename(new, &file).expect("saved by renaming");
    assert_eq!(red(&reloaded(&mut scenes, &woken)), 0.125);
    assert!(scenes.report(Instant::now()).failure.is_none());
}

#[test]
fn a_texture_may_be_missing_and_come_and_change() {
    let folder = Folder::new();
    let file = folder.write(
        "ball.json",
        format!(
            r#"{{ "version": 1, "textures": {{ "wood": {{ "image": "wood.bmp" }} }},
                "materials": {{ "red": {{ "color": {{ "texture": "wood" }} }} }}, "objects": [{BALL}] }}"#
        ),
    );
    let (mut scenes, woken) = scenes();
    scenes.open(&file);
    // A JSON scene needs its textures; the scene was not opened, so what it lacks is not waited for.
    assert!(wait(&mut scenes, &woken, |scenes| scenes.failure.is_some()).is_none());
    folder.write("wood.bmp", bitmap(10));
    scenes.open(&file);
    opened(&mut scenes, &woken);
    folder.write("wood.bmp", bitmap(200));
    reloaded(&mut scenes, &woken);
    std::fs::remove_file(folder.path().join("wood.bmp")).expect("removed");
    assert!(wait(&mut scenes, &woken, |scenes| scenes.failure.is_some()).is_none());
    folder.write("wood.bmp", bitmap(10));
    reloaded(&mut scenes, &woken);
}

/// A bitmap of one grey pixel.
fn bitmap(grey: u8) -> Vec<u8> {
    let mut bytes = b"BM".to_vec();
    for word in [58_u32, 0, 54, 40, 1, 1, 1 | 24 << 16, 0, 4, 0, 0, 0, 0] {
        bytes.extend(word.to_le_bytes());
    }
    bytes.extend([grey, grey, grey, 0]);
    // Of another size each: two may be written within what the clock of files can tell apart.
    bytes.resize(bytes.len() + usize::from(grey), 0);
    bytes
}

#[test]
fn what_cannot_be_opened_leaves_what_is_shown_and_says_why() {
    let folder = Folder::new();
    let file = folder.write("ball.json", ball("[0.5, 0, 0]"));
    let (mut scenes, woken) = scenes();
    scenes.open(&file);
    opened(&mut scenes, &woken);
    let bad = folder.write("notes.txt", "");
    scenes.drop_in(bad.clone());
    assert!(scenes.open_dropped() && wait(&mut scenes, &woken, |scenes| scenes.failure.is_some()).is_none());
    let failure = scenes.report(Instant::now()).failure.cloned().expect("it is no scene");
    assert!(failure.message.contains("unknown scene format") && failure.file.as_ref() == Some(&bad));
    // What is shown is still watched.
    folder.write("ball.json", ball("[0.25, 0, 0]"));
    assert_eq!(red(&reloaded(&mut scenes, &woken)), 0.25);
}

#[test]
fn a_cancelled_load_is_forgotten() {
    let folder = Folder::new();
    let file = folder.write("ball.json", ball("[0.5, 0, 0]"));
    let (mut scenes, woken) = scenes();
    assert!(!scenes.cancel());
    scenes.open(&file);
    assert!(scenes.is_loading() && scenes.cancel() && !scenes.is_loading());
    scenes.open(&file);
    opened(&mut scenes, &woken);
    assert!(scenes.report(Instant::now()).failure.is_none() && scenes.news().is_none());
}

#[test]
fn that_another_file_cannot_be_opened_stays_told_while_the_scene_is_reloaded() {
    let folder = Folder::new();
    let (file, broken) = (folder.write("ball.json", ball("[0.5, 0, 0]")), folder.write("broken.json", "{"));
    let (mut scenes, woken) = scenes();
    scenes.open(&file);
    opened(&mut scenes, &woken);
    scenes.open(&broken);
    assert!(wait(&mut scenes, &woken, |scenes| scenes.failure.is_some()).is_none());
    folder.write("ball.json", ball("[0.25, 0, 0]"));
    assert_eq!(red(&reloaded(&mut scenes, &woken)), 0.25);
    let failure = scenes.report(Instant::now()).failure.expect("it cannot be opened still");
    assert!(failure.title.contains("broken.json"), "{}", failure.title);
}

/// An edit of the scene that is shown, seen while another one is opened, is loaded after that: once.
#[test]
fn a_reload_that_had_to_wait_can_be_stopped() {
    let folder = Folder::new();
    let (file, other) = (folder.write("ball.json", ball("[0.5, 0, 0]")), folder.write("other.json", ball("1")));
    let (mut scenes, woken) = scenes();
    scenes.open(&file);
    opened(&mut scenes, &woken);
    scenes.open(&other);
    scenes.outdated = true;
    assert!(scenes.cancel() && scenes.is_loading(), "the edit is loaded");
    assert!(scenes.cancel() && !scenes.is_loading(), "and that is stopped");
}

/// A sky of one texel, this bright.
fn sky(bright: u8) -> Vec<u8> {
    // Of another size each, as bitmaps are.
    let comments = "#\n".repeat(bright.into());
    [format!("#?RADIANCE\n{comments}\n-Y 1 +X 1\n").as_bytes(), &[bright, bright, bright, 128]].concat()
}

fn brought(scenes: &mut Scenes, woken: &Receiver<()>) -> Result<SkyArrival, String> {
    match wait(scenes, woken, |_| false) {
        Some(News::Sky(outcome)) => outcome,
        other => panic!("{other:?}"),
    }
}

#[test]
fn a_dropped_sky_is_brought_to_the_scene_and_followed() {
    let folder = Folder::new();
    let (file, hdr) = (folder.write("ball.json", ball("1")), folder.write("sky.HDR", sky(64)));
    let (mut scenes, woken) = scenes();
    scenes.open(&file);
    opened(&mut scenes, &woken);
    scenes.drop_in(hdr.clone());
    assert!(scenes.open_dropped() && !scenes.is_loading(), "it is no scene");
    let value = |outcome: Result<SkyArrival, String>| outcome.expect("a sky").image.texels[0][0];
    let arrival = brought(&mut scenes, &woken).expect("a sky");
    assert_eq!((&arrival.file, arrival.image.texels[0][0]), (&hdr, 0.25));
    assert_eq!(scenes.recent().files(), std::slice::from_ref(&file), "only scenes are remembered");
    folder.write("sky.HDR", sky(128));
    assert_eq!(value(brought(&mut scenes, &woken)), 0.5);
    folder.write("sky.HDR", "damaged");
    let said = brought(&mut scenes, &woken).expect_err("it is no picture");
    assert!(said.contains("sky.HDR: cannot decode the environment") && !said.contains('\n'), "{said}");
    folder.write("sky.HDR", sky(32));
    assert_eq!(value(brought(&mut scenes, &woken)), 0.125, "mended");
    scenes.open(&folder.path().join("missing.exr"));
    assert!(brought(&mut scenes, &woken).expect_err("not there").contains("missing.exr: cannot read the environment"));
    // What is edited still is the scene.
    folder.write("ball.json", ball("[0.25, 0, 0]"));
    assert_eq!(red(&reloaded(&mut scenes, &woken)), 0.25);
    scenes.open(&hdr);
    scenes.forget_sky();
    scenes.open(&hdr);
    assert_eq!(value(brought(&mut scenes, &woken)), 0.125, "once");
    assert!(scenes.news().is_none());
}

#[test]
fn what_is_shown_is_not_opened_but_reloaded() {
    let folder = Folder::new();
    let file = folder.write("ball.json", ball("[0.5, 0, 0]"));
    let (mut scenes, woken) = scenes();
    scenes.open(&file);
    opened(&mut scenes, &woken);
    scenes.open(&file);
    reloaded(&mut scenes, &woken);
}

#[test]
fn the_first_load_of_all_has_to_succeed() {
    let (mut scenes, woken) = scenes();
    let load = Load::start(Progress::default(), || Err("no such file".into()));
    scenes.expect(load, PathBuf::from("room.json"));
    match wait(&mut scenes, &woken, |_| false) {
        Some(News::Nothing(failed)) => assert_eq!(failed.to_string(), "no such file"),
        other => panic!("{other:?}"),
    }
}

#[test]
fn warnings_stay_until_they_were_read_and_come_back_when_they_are_others() {
    let folder = Folder::new();
    let odd = |key: &str| format!(r#"{{ "version": 1, "{key}": 1, "objects": [] }}"#);
    let file = folder.write("odd.json", odd("colour"));
    let (mut scenes, woken) = scenes();
    scenes.open(&file);
    opened(&mut scenes, &woken);
    assert!(scenes.report(Instant::now()).odd.is_some());
    scenes.dismiss_warnings();
    scenes.reload();
    reloaded(&mut scenes, &woken);
    assert!(scenes.report(Instant::now()).odd.is_none());
    folder.write("odd.json", odd("colours"));
    reloaded(&mut scenes, &woken);
    assert!(scenes.report(Instant::now()).odd.is_some());
}

#[test]
fn the_line_of_warnings_folds_away_and_the_list_stays() {
    let folder = Folder::new();
    let file = folder.write("odd.json", r#"{ "version": 1, "colour": 1, "objects": [] }"#);
    let (mut scenes, woken) = scenes();
    let is_list = |scenes: &Scenes| scenes.report(Instant::now()).odd.map(|odd| odd.is_list);
    scenes.toggle_warnings();
    assert_eq!((is_list(&scenes), scenes.next_end()), (None, None), "nothing to tell");
    scenes.open(&file);
    opened(&mut scenes, &woken);
    let end = scenes.next_end().expect("the line folds away");
    scenes.expire(end - Duration::from_millis(1));
    assert_eq!(is_list(&scenes), Some(false));
    assert_eq!(scenes.report(Instant::now()).folder, Some(folder.path()));
    scenes.expire(end);
    assert_eq!((is_list(&scenes), scenes.next_end()), (None, None));
    scenes.reload();
    reloaded(&mut scenes, &woken);
    assert_eq!(is_list(&scenes), None, "the same ones are not told of again");
    scenes.toggle_warnings();
    scenes.expire(Instant::now() + Duration::from_secs(3600));
    assert_eq!(is_list(&scenes), Some(true));
    scenes.toggle_warnings();
    assert_eq!(is_list(&scenes), None);
}

#[test]
fn a_file_is_one_however_its_path_is_spelled() {
    let folder = Folder::new();
    let file = folder.write("ball.json", ball("[0.5, 0, 0]"));
    std::fs::create_dir(folder.path().join("part")).expect("made");
    let (mut scenes, woken) = scenes();
    for spelled in ["part/../ball.json", "ball.json"] {
        scenes.open(&folder.path().join(spelled));
        assert_eq!(opened(&mut scenes, &woken).place.as_ref(), Some(&file));
        assert_eq!((scenes.place(), scenes.recent().files()), (Some(&*file), &[file.clone()][..]));
    }
}

#[test]
fn a_folder_that_is_replaced_is_still_watched() {
    let folder = Folder::new();
    let part = folder.path().join("part");
    let fill = |red: &str| {
        std::fs::create_dir(&part).expect("made");
        std::fs::write(part.join("ball.json"), ball(red)).expect("written");
    };
    fill("[0.5, 0, 0]");
    let (mut scenes, woken) = scenes();
    scenes.open(&part);
    opened(&mut scenes, &woken);
    for _ in 0..2 {
        std::fs::remove_dir_all(&part).expect("removed");
        assert!(wait(&mut scenes, &woken, |scenes| scenes.failure.is_some()).is_none());
        fill("[0.25, 0, 0]");
        assert_eq!(red(&reloaded(&mut scenes, &woken)), 0.25);
        std::fs::write(part.join("ball.json"), ball("[0.125, 0, 0]")).expect("edited");
        assert_eq!(red(&reloaded(&mut scenes, &woken)), 0.125);
    }
}
