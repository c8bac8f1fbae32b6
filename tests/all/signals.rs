//! Requests to end from outside: which exit code follows, and what is left behind.

use super::cli::{Bench, SCENE};
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

/// Longest wait for what takes a moment.
const PATIENCE: Duration = Duration::from_secs(60);
const PAUSE: Duration = Duration::from_millis(10);

/// A render that takes far longer than a test.
const LONG: &str = "render scene.json --size 640x480 --frames 0..1000000 -o a.png --stats run.json";

/// The program at work.
struct Running(Child);

impl Running {
    fn start(bench: &Bench, line: &str) -> Self {
        Self(bench.program(line).stdout(Stdio::null()).stderr(Stdio::null()).spawn().expect("the program starts"))
    }

    fn send(&self, signal: &str) {
        let sent = Command::new("kill").args([format!("-{signal}"), self.0.id().to_string()]).status();
        assert!(sent.expect("kill is there").success(), "{signal}");
    }

    fn code(mut self) -> Option<i32> {
        let code = self.0.wait().expect("it ends").code();
        // Nothing is left to be ended.
        std::mem::forget(self);
        code
    }
}

impl Drop for Running {
    fn drop(&mut self) {
        // After a failed test: whether it still runs does not matter.
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}

/// Waits until something holds.
fn until(what: &str, holds: impl Fn() -> bool) {
    let began = Instant::now();
    while !holds() {
        assert!(began.elapsed() < PATIENCE, "waited in vain: {what}");
        std::thread::sleep(PAUSE);
    }
}

/// The names of temporary files in a folder and those within.
fn unfinished(folder: &Path) -> Vec<String> {
    let Ok(entries) = folder.read_dir() else { return Vec::new() };
    let of = |path: &Path| {
        let name = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
        if path.is_dir() {
            unfinished(path)
        } else {
            Some(name).filter(|name| name.ends_with(".part")).into_iter().collect()
        }
    };
    entries.flatten().flat_map(|entry| of(&entry.path())).collect()
}

/// Whether these tests were started so that the programs they start ignore SIGHUP.
fn ignores_hang_up() -> bool {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let mask = status.lines().find_map(|line| line.strip_prefix("SigIgn:")).unwrap_or("0");
    u64::from_str_radix(mask.trim(), 16).expect("a mask of signals") & 1 == 1
}

#[test]
fn signals_end_a_render_and_leave_nothing() {
    for (signal, code) in [("INT", 130), ("TERM", 143), ("HUP", 129), ("QUIT", 131)] {
        if signal == "HUP" && ignores_hang_up() {
            continue;
        }
        let bench = Bench::new();
        bench.write("scene.json", SCENE);
        let running = Running::start(&bench, LONG);
        // Temporary files are the sign that frames are being traced.
        until("a picture is begun", || bench.names().len() > 2);
        running.send(signal);
        assert_eq!(running.code(), Some(code), "{signal}");
        assert_eq!(bench.names(), ["scene.json"], "{signal}");
    }
}

#[test]
fn whoever_cannot_wait_is_obeyed_and_nothing_is_left_either() {
    let bench = Bench::new();
    bench.write("scene.json", SCENE);
    let running = Running::start(&bench, LONG);
    until("a picture is begun", || bench.names().len() > 2);
    (0..3).for_each(|_| running.send("TERM"));
    assert_eq!(running.code(), Some(143));
    assert_eq!(bench.names(), ["scene.json"]);
}

#[test]
fn signals_end_a_bench_and_leave_whole_files() {
    let bench = Bench::new();
    bench.write("scene.json", SCENE);
    let running = Running::start(&bench, "bench scene.json --size 320x240 -o out");
    until("a row is measured", || bench.path("out/records.json").exists());
    running.send("TERM");
    assert_eq!(running.code(), Some(143));
    assert_eq!(unfinished(&bench.path("out")), [""; 0]);
    assert!(bench.path("out/index.html").exists(), "what there was is drawn");
}

#[cfg(target_os = "linux")]
#[test]
fn a_render_that_was_started_to_outlive_its_terminal_does() {
    let bench = Bench::new();
    bench.write("scene.json", SCENE);
    let line = format!("trap '' HUP; exec {} {LONG}", env!("CARGO_BIN_EXE_raywalk"));
    let mut shell = Command::new("sh");
    let shell = shell.args(["-c", &line]).current_dir(bench.path(".")).stderr(Stdio::null()).stdout(Stdio::null());
    let mut running = Running(shell.spawn().expect("a shell"));
    until("a picture is begun", || bench.names().len() > 2);
    running.send("HUP");
    std::thread::sleep(Duration::from_millis(500));
    assert_eq!(running.0.try_wait().expect("it is ours"), None);
    running.send("TERM");
    assert_eq!(running.code(), Some(143));
    assert_eq!(bench.names(), ["scene.json"]);
}
