//! A walk in the terminal, in a real one: tmux draws it, types, and tells what is on the screen.

use super::temporary::Folder;
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

/// However busy the machine is.
const SOON: Duration = Duration::from_secs(90);

const SCENE: &str = r##"{ "version": 1, "render": { "background": "#4060a0" },
    "camera": { "position": [0, 1, 6], "look_at": [0, 0.5, 0] },
    "textures": { "tiles": { "checker": [0.9, [0.2, 0.5, 0.1]] } },
    "lights": [ { "type": "point", "position": [3, 5, 4] } ],
    "objects": [ { "type": "sphere", "center": [0, 1, 0], "radius": 1 },
                 { "type": "plane", "point": [0, 0, 0], "normal": [0, 1, 0], "material": "floor" } ],
    "materials": { "floor": { "color": { "texture": "tiles" } } } }"##;

/// What runs in the terminal: the program, and then what it left of the terminal.
const SCRIPT: &str = r#"sh -c 'echo $$ >pid; exec "$@"' walk "$@"; echo "exit code $?"; stty -a; exec sleep 1000"#;

/// A terminal of 80 by 24 cells with a walk in it.
struct Walk(Folder);

impl Walk {
    /// Starts the program with `flags` on [`SCENE`]; `None` where there is no tmux.
    fn start(flags: &[&str], colors: &str) -> Option<Self> {
        Self::start_by(SCRIPT, flags, colors)
    }

    /// The same, by another script.
    fn start_by(script: &str, flags: &[&str], colors: &str) -> Option<Self> {
        if let Err(error) = Command::new("tmux").arg("-V").stdout(Stdio::null()).status() {
            assert!(std::env::var_os("CI").is_none(), "tmux: {error}");
            println!("left out: no tmux ({error})");
            return None;
        }
        let walk = Self(Folder::new());
        walk.0.write("scene.json", SCENE);
        let mut new = walk.tmux(&["new-session", "-d", "-s", "walk", "-x", "80", "-y", "24", "-e"]);
        new.arg(format!("COLORTERM={colors}")).args(["sh", "-c", script, "walk", env!("CARGO_BIN_EXE_raywalk")]);
        let started = new.args(flags).arg("scene.json").output().expect("tmux starts");
        assert!(started.status.success(), "{started:?}");
        Some(walk)
    }

    /// tmux with a server of its own, which draws UTF-8 whatever the locale.
    fn tmux(&self, line: &[&str]) -> Command {
        let mut tmux = Command::new("tmux");
        tmux.current_dir(self.0.path()).env("TMUX_TMPDIR", self.0.path()).env("LC_ALL", "C.UTF-8").env_remove("TMUX");
        for display in ["DISPLAY", "WAYLAND_DISPLAY", "WAYLAND_SOCKET"] {
            tmux.env_remove(display);
        }
        tmux.args(["-u", "-f", "/dev/null", "-L", "walk"]).args(line);
        tmux
    }

    fn ask(&self, line: &[&str]) -> String {
        let output = self.tmux(line).output().expect("tmux starts");
        assert!(output.status.success(), "{line:?}: {output:?}");
        String::from_utf8(output.stdout).expect("UTF-8")
    }

    fn press(&self, keys: &[&str]) {
        self.ask(&[&["send-keys", "-t", "walk"], keys].concat());
    }

    /// The screen as text, with the sequences of its colours.
    fn screen(&self) -> String {
        self.ask(&["capture-pane", "-t", "walk", "-p", "-e", "-N"])
    }

    /// Waits until the screen is as it should be, twice in a row: one alone may be in the middle of a frame.
    fn until(&self, what: &str, holds: impl Fn(&str) -> bool) -> String {
        let start = Instant::now();
        let mut before = String::new();
        loop {
            let screen = self.screen();
            if screen == before && holds(&screen) {
                return screen;
            }
            assert!(start.elapsed() < SOON, "not within {SOON:?}: {what}\n{screen}");
            before = screen;
            std::thread::sleep(Duration::from_millis(50));
        }
    }

    /// Waits for the view to be at rest, in a picture other than `before`, and returns it.
    fn rests(&self, what: &str, before: &str) -> String {
        self.until(what, |screen| screen.contains(" at rest ") && picture(screen) != picture(before))
    }

    fn send(&self, signal: &str) {
        let pid = std::fs::read_to_string(self.0.path().join("pid")).expect("the walk has begun");
        let sent = Command::new("kill").args([signal, pid.trim()]).status().expect("kill starts");
        assert!(sent.success());
    }

    /// Expects that the walk ends with `code` and left the terminal as it was.
    fn ended(&self, code: i32) {
        let screen = self.until("the end", |screen| screen.contains("isig"));
        assert!(screen.contains(&format!("exit code {code}\n")), "{screen}");
        for on in [" echo ", " icanon ", " isig "] {
            assert!(screen.replace('\n', " ").contains(on), "{on}: {screen}");
        }
        assert!(!screen.contains('▀') && !screen.contains('['), "something is left: {screen:?}");
        let modes = "#{cursor_flag} #{alternate_on} #{mouse_any_flag}";
        assert_eq!(self.ask(&["display-message", "-t", "walk", "-p", modes]), "1 0 0\n");
    }
}

/// The colours of the two halves of each cell but for the status line, row after row.
fn picture(screen: &str) -> Vec<[&str; 2]> {
    let (mut cells, mut foreground, mut background) = (Vec::new(), "", "");
    // Colours hold beyond the end of a line.
    let status = screen.trim_end().rfind('\n').unwrap_or_default();
    let mut rest = &screen[..status];
    while let Some(character) = rest.chars().next() {
        rest = &rest[character.len_utf8()..];
        match character {
            '▀' => cells.push([foreground, background]),
            '\x1b' => {
                let (rendition, after) = rest.split_once('m').expect("a sequence ends");
                match rendition.get(1..3) {
                    Some("38") => foreground = rendition,
                    Some("48") => background = rendition,
                    Some("39") => foreground = "",
                    Some("49") => background = "",
                    _ => (foreground, background) = ("", ""),
                }
                rest = after;
            }
            '\n' => {}
            _ => cells.push([background, background]),
        }
    }
    cells
}

impl Drop for Walk {
    fn drop(&mut self) {
        // Nothing is left running, whatever failed.
        let _ = self.tmux(&["kill-server"]).stderr(Stdio::null()).status();
    }
}

#[test]
fn keys_walk_and_q_leaves() {
    let Some(walk) = Walk::start(&["--terminal"], "truecolor") else { return };
    let start = walk.rests("the first picture", "");
    assert!(start.contains('▀') && start.matches("8;2;").count() > 200, "{start}");
    let mut last = start.clone();
    for (key, what) in [("w", "forward"), ("d", "to the right"), ("Space", "up"), ("Left", "a turn"), ("W", "faster")] {
        walk.press(&[key]);
        last = walk.rests(what, &last);
    }
    walk.press(&["Home"]);
    walk.until("the first view again", |screen| screen.contains(" at rest ") && picture(screen) == picture(&start));
    walk.press(&["+", "1"]);
    let status = walk.until("the preset", |screen| screen.contains(" exact "));
    walk.press(&["-"]);
    walk.until("the speed", |screen| screen.lines().last() != status.lines().last());
    walk.ask(&["resize-window", "-t", "walk", "-x", "100", "-y", "30"]);
    walk.until("the new size", |screen| screen.contains(" at rest ") && screen.contains(" 100x58 "));
    walk.press(&["q"]);
    walk.ended(0);
}

#[test]
fn ctrl_c_and_signals_give_the_terminal_back() {
    // Without a display no flag is needed.
    for (end, code) in [("C-c", 130), ("-TERM", 143), ("-HUP", 129), ("-INT", 130), ("-QUIT", 131)] {
        let Some(walk) = Walk::start(&[], "truecolor") else { return };
        walk.rests("the first picture", "");
        match end.strip_prefix('-') {
            Some(_) => walk.send(end),
            None => walk.press(&[end]),
        }
        walk.ended(code);
    }
}

/// Stopped, the terminal is the shell's, and going on, the walk draws all of it anew.
#[test]
fn ctrl_z_lends_the_terminal_to_the_shell() {
    let Some(walk) = Walk::start_by("set -m; \"$@\"; stty -a; read go; fg", &["--terminal"], "truecolor") else {
        return;
    };
    let before = walk.rests("the first picture", "");
    walk.press(&["C-z"]);
    walk.until("the shell", |screen| screen.replace('\n', " ").contains(" isig ") && !screen.contains('▀'));
    walk.press(&["Enter"]);
    let after = walk.rests("the picture again", "");
    assert_eq!(picture(&after), picture(&before));
    walk.press(&["q"]);
}

#[test]
fn a_terminal_of_256_colours_gets_those() {
    let Some(walk) = Walk::start(&["--preset", "exact"], "yes") else { return };
    let picture = walk.rests("the first picture", "");
    assert!(picture.contains("8;5;") && !picture.contains("8;2;"), "{picture}");
    walk.press(&["Escape"]);
    walk.ended(0);
}

#[cfg(target_os = "linux")]
#[test]
fn at_rest_nothing_is_done() {
    let Some(walk) = Walk::start(&["--terminal"], "truecolor") else { return };
    walk.rests("the first picture", "");
    let pid = std::fs::read_to_string(walk.0.path().join("pid")).expect("the walk has begun");
    let ticks = || -> u64 {
        let stat = std::fs::read_to_string(format!("/proc/{}/stat", pid.trim())).expect("it lives");
        stat.split_whitespace().skip(13).take(2).map(|ticks| ticks.parse::<u64>().expect("a number")).sum()
    };
    let spent = || {
        let before = ticks();
        std::thread::sleep(Duration::from_secs(2));
        ticks() - before
    };
    assert!((0..5).any(|_| spent() <= 1), "it took CPU");
    walk.press(&["q"]);
    walk.ended(0);
}
