//! The picture of all first views. One scene at a time is in memory, besides the sheet.

use super::figures::{Entry, Figures};
use anyhow::{anyhow, ensure};
use raywalk::measure::chart::{escaped, rasterised, text_width, wrapped};
use raywalk::picture::EightBit;
use raywalk::render::{CancelToken, Film, Planes, Scratch, render_frame};
use raywalk::scene::{self, Limits, LoadOptions, Progress};
use raywalk::settings::Settings;
use std::path::{Path, PathBuf};
use std::sync::mpsc::{RecvTimeoutError, channel};
use std::thread;
use std::time::{Duration, Instant};

/// Height of a name, its font and the room around a thumbnail, in pixels.
const CAPTION: u32 = 20;
const FONT_SIZE: f64 = 13.0;
const GAP: u32 = 8;
/// Distance between lines of text.
const LINE: f64 = 16.0;

/// How the sheet is laid out.
pub struct Layout {
    /// Size of a thumbnail in pixels.
    pub thumbnail: (u32, u32),
    /// Thumbnails in a row.
    pub columns: u32,
    /// Longest time that a file may take. The load ends between its steps, the frame between its tiles.
    pub limit: Duration,
}

/// A finished sheet.
pub struct Sheet {
    /// The picture.
    pub picture: EightBit,
    /// Its files, in order.
    pub entries: Vec<Entry>,
}

impl Layout {
    /// Width and height of a sheet of `count` thumbnails, within the usual limit of a picture.
    pub fn size(&self, count: usize) -> anyhow::Result<(u32, u32)> {
        let columns = count.min(self.columns as usize);
        let side = |cells: usize, cell: u32| (cells as u64).saturating_mul((cell + GAP).into()) + u64::from(GAP);
        let width = side(columns, self.thumbnail.0);
        let height = side(count.div_ceil(self.columns as usize), self.thumbnail.1 + CAPTION);
        let most = Limits::default().picture_pixels;
        ensure!(
            width.saturating_mul(height) <= most,
            "a sheet of {count} files would have {width}x{height} pixels, more than {most}; choose a smaller --size"
        );
        Ok((u32::try_from(width)?, u32::try_from(height)?))
    }

    /// Left and top of a thumbnail.
    pub fn place(&self, index: u32) -> (u32, u32) {
        let (column, row) = (index % self.columns, index / self.columns);
        (GAP + column * (self.thumbnail.0 + GAP), GAP + row * (self.thumbnail.1 + CAPTION + GAP))
    }
}

/// Draws the sheet of `files` in `folder` and tells `note` of each.
///
/// A file that cannot be drawn gets a grey thumbnail that says why.
pub fn draw(folder: &Path, files: &[PathBuf], layout: &Layout, note: &dyn Fn(&str)) -> anyhow::Result<Sheet> {
    let (width, height) = layout.size(files.len())?;
    let mut picture = EightBit { width, height, rgb: vec![255; 3 * width as usize * height as usize] };
    let planes = Planes { object: true, ..Planes::default() };
    let mut film = Film::new(layout.thumbnail.0, layout.thumbnail.1, planes);
    let mut scratch = Scratch::new();
    let mut entries = Vec::new();
    for (index, path) in (0..).zip(files) {
        let inside = path.strip_prefix(folder).unwrap_or(path).to_string_lossy();
        let file = inside.replace(char::is_control, "\u{fffd}");
        let start = Instant::now();
        let drawn = first_view(path, layout.limit, &mut scratch, &mut film);
        let seconds = start.elapsed().as_secs_f64();
        let (left, top) = layout.place(index);
        let (thumbnail, error, figures) = match drawn {
            Ok(figures) => (EightBit::of_film(&film), None, Some(figures)),
            Err(error) => (grey(&error, layout)?, Some(error), None),
        };
        let remark = error.as_ref().map(|error| format!(": {error}")).unwrap_or_default();
        note(&format!("{} of {}: {file} ({seconds:.1} s){remark}", index + 1, files.len()));
        paste(&mut picture, &thumbnail, left, top);
        paste(&mut picture, &caption(&file, layout)?, left, top + layout.thumbnail.1);
        entries.push(Entry { file, seconds, error, figures });
    }
    Ok(Sheet { picture, entries })
}

/// Draws what `raywalk render FILE` does, or says in one line why not.
fn first_view(path: &Path, limit: Duration, scratch: &mut Scratch, film: &mut Film) -> Result<Figures, String> {
    let (progress, cancel) = (Progress::default(), CancelToken::default());
    scratch.cancel = cancel.clone();
    let options = LoadOptions { progress: progress.clone(), ..LoadOptions::default() };
    let give_up = {
        let progress = progress.clone();
        move || {
            progress.cancel();
            cancel.cancel();
        }
    };
    within(limit, give_up, || {
        let too_slow = || format!("took longer than {} s", limit.as_secs());
        let place = path.display().to_string();
        let scene = scene::load(path, &options).map_err(|error| {
            let text = error.to_string();
            // The name stands below; the place within the file stays.
            let reason = text.strip_prefix(&place).unwrap_or(&text).trim_start_matches([':', ' ']);
            if progress.is_cancelled() { too_slow() } else { reason.replace(char::is_control, " ") }
        })?;
        let settings = scene.resolved(&Settings::exact());
        let stats = render_frame(&scene, &scene.cameras[0].camera, &settings, scratch, film);
        if stats.completed { Ok(Figures::of(&scene, film)) } else { Err(too_slow()) }
    })
}

/// Does `work`, and calls `give_up` when it takes longer than `limit`.
pub fn within<T>(limit: Duration, give_up: impl FnOnce() + Send, work: impl FnOnce() -> T) -> T {
    let (done, is_done) = channel::<()>();
    thread::scope(|scope| {
        scope.spawn(move || {
            if is_done.recv_timeout(limit) == Err(RecvTimeoutError::Timeout) {
                give_up();
            }
        });
        let result = work();
        drop(done);
        result
    })
}

/// The name under a thumbnail.
fn caption(name: &str, layout: &Layout) -> anyhow::Result<EightBit> {
    text((layout.thumbnail.0, CAPTION), "#fff", "#222", &[shortened(name, f64::from(layout.thumbnail.0))])
}

/// A thumbnail of what cannot be drawn, with the beginning of `message`.
fn grey(message: &str, layout: &Layout) -> anyhow::Result<EightBit> {
    let (width, height) = layout.thumbnail;
    let room = (f64::from(width) - f64::from(2 * GAP)).max(0.0);
    let lines = (f64::from(height) / LINE).max(1.0) as usize;
    let lines = wrapped(message, FONT_SIZE, room).into_iter().take(lines).map(|line| shortened(&line, room));
    text((width, height), "#777", "#fff", &lines.collect::<Vec<_>>())
}

/// Lines of text in the middle of a picture.
fn text((width, height): (u32, u32), paper: &str, ink: &str, lines: &[String]) -> anyhow::Result<EightBit> {
    let (x, middle) = (f64::from(width) / 2.0, f64::from(height) / 2.0);
    let y = |line: usize| middle + FONT_SIZE / 3.0 + LINE * (line as f64 - (lines.len() as f64 - 1.0) / 2.0);
    let lines = lines.iter().enumerate().map(|(i, line)| {
        format!("<text x=\"{x}\" y=\"{:.1}\" text-anchor=\"middle\" fill=\"{ink}\">{}</text>\n", y(i), escaped(line))
    });
    let svg = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{width}\" height=\"{height}\" font-family=\"sans-serif\" \
         font-size=\"{FONT_SIZE}\">\n<rect width=\"{width}\" height=\"{height}\" fill=\"{paper}\"/>\n{}</svg>\n",
        lines.collect::<String>()
    );
    rasterised(&svg, 1.0).map_err(|message| anyhow!("cannot draw a text: {message}"))
}

/// A text that is not wider than `width` pixels: its middle is left out where it would be.
pub fn shortened(text: &str, width: f64) -> String {
    if text_width(text, FONT_SIZE) <= width {
        return text.to_owned();
    }
    let chars: Vec<char> = text.chars().collect();
    let kept = |count: usize| -> String {
        let (head, tail) = (&chars[..count / 2], &chars[chars.len() - count.div_ceil(2)..]);
        head.iter().chain(&['…']).chain(tail).collect()
    };
    (0..chars.len()).rev().map(kept).find(|text| text_width(text, FONT_SIZE) <= width).unwrap_or_default()
}

/// Copies `part` into `whole`, which has room for it there.
fn paste(whole: &mut EightBit, part: &EightBit, left: u32, top: u32) {
    let bytes = 3 * part.width as usize;
    for (row, pixels) in (top..).zip(part.rgb.chunks_exact(bytes)) {
        let start = 3 * (row as usize * whole.width as usize + left as usize);
        whole.rgb[start..start + bytes].copy_from_slice(pixels);
    }
}
