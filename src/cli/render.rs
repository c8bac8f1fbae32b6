//! `raywalk render`: frames without a window.

use super::frames::Frames;
use super::interrupt::Interrupt;
use super::options::Options;
use super::output::{self, Output};
use super::progress::Progress;
use super::record::RecordTarget;
use super::stage::Stage;
use super::{Failure, stdout};
use clap::ArgMatches;
use raywalk::app::maps::Map;
use raywalk::measure::record::Subject;
use raywalk::measure::run::{WARM_UP_FRAMES, timed_frame};
use raywalk::measure::{MotionMeter, Record, Run};
use raywalk::picture::WriteOptions;
use raywalk::render::{Film, Planes, Scratch, TileCount, render_frame};
use raywalk::settings::{Settings, Visibility};
use std::path::{Path, PathBuf};

/// Renders what `asked` says.
pub fn run(asked: &ArgMatches, interrupt: &Interrupt) -> Result<(), Failure> {
    let options = Options::of(asked, Settings::exact)?;
    let write = WriteOptions { binary: asked.get_flag("binary") };
    let output = asked.get_one::<PathBuf>("output").map(PathBuf::as_path);
    output::check_planes(output, options.planes)?;
    output::check_map(output, options.map)?;
    if output.is_some_and(|path| options.stats.as_deref().is_some_and(|stats| Path::new(stats) == path)) {
        return Err(Failure::Usage("--stats and -o name the same file".to_owned()));
    }
    let frames = Frames::of(&options)?;
    let output = output.map(|path| Output::new(path, write, &frames)).transpose()?;
    let stage = Stage::set(&options)?;
    render(&stage, &frames, &options, output, interrupt)
}

/// Renders `frames` of `stage`, and writes the pictures and the record asked for.
pub fn render(
    stage: &Stage,
    frames: &Frames,
    options: &Options,
    mut output: Option<Output>,
    interrupt: &Interrupt,
) -> Result<(), Failure> {
    interrupt.careful();
    let (width, height) = (stage.size.width, stage.size.height);
    if let (Some(warning), false) = (&frames.warning, options.reading.quiet) {
        stdout::note(&format!("warning: {warning}"));
    }
    frames.check(&stage.camera, &stage.loaded.scene)?;
    check_memory(width, height, options)?;
    if let Some(output) = &mut output {
        output.prepare(width, height, frames)?;
    }
    let record = options.stats.as_deref().map(RecordTarget::prepare).transpose()?;

    let mut scratch = Scratch::new();
    scratch.cancel = interrupt.token.clone();
    let planes = if options.map == Map::Picture { options.planes } else { options.map.planes() };
    let mut tracer = Tracer { stage, frames, interrupt, scratch, film: Film::new(width, height, planes) };
    let mut reference = options.reference.map(|visibility| Reference::new(visibility, stage));
    let mut exact = options.map.needs_exact().then(|| Reference::new(Visibility::Full, stage));
    let (warm_up, count) =
        (if record.is_some() { WARM_UP_FRAMES as u64 } else { 0 }, frames.range.end - frames.range.start);
    let tiles = |settings| TileCount::of_frame(settings, width, height);
    let of_references = reference.iter().chain(&exact).map(|reference| tiles(&reference.settings)).sum::<u64>();
    let all =
        (warm_up + count).saturating_mul(tiles(&stage.settings)).saturating_add(count.saturating_mul(of_references));
    let progress = Progress::over_tiles(all, tracer.scratch.tiles.clone(), options.reading.quiet);
    let mut untimed = Run::default();
    for _ in 0..warm_up {
        progress.tell("warming up");
        tracer.trace(frames.range.start, &mut untimed)?;
    }
    let mut run = Run::default();
    for number in frames.range.clone() {
        let what = format!("frame {} of {count}", number - frames.range.start + 1);
        progress.tell(if count > 1 { &what } else { "" });
        tracer.trace(number, &mut run)?;
        if let Some(reference) = &mut reference {
            tracer.compare(number, reference)?;
        }
        if let Some(output) = &mut output {
            tracer.paint(number, options.map, exact.as_mut())?;
            output.write(number, frames, &tracer.film)?;
        }
    }
    drop(progress);
    interrupt.check()?;
    if output.is_none() && !options.reading.quiet {
        stdout::note(&timing(stage, &run));
    }
    match record {
        Some(target) => target.write(&record_of(stage, &run, reference.as_ref())),
        None => Ok(()),
    }
}

/// What was done where nothing was written.
fn timing(stage: &Stage, run: &Run) -> String {
    let (frames, ms, cpu) = (run.frames(), run.frame_ms().median, run.cpu_ms().median);
    let which = if frames == 1 { "1 frame".to_owned() } else { format!("{frames} frames") };
    let median = if frames == 1 { "" } else { "a median of " };
    let (scene, size) = (&stage.loaded.scene.name, stage.size);
    format!(
        "rendered {which} of {scene} at {}x{} in {median}{ms:.1} ms (CPU time {cpu:.1} ms) and wrote no picture; -o FILE.png \
         writes one",
        size.width, size.height
    )
}

/// Measured: bytes a pixel of a picture while it is traced and written, without and with other planes.
const PLAIN_PIXEL: usize = 24;
const PIXEL_WITH_PLANES: usize = 80;

/// Looks whether there is memory for the picture: short of it later, the program would end without a word.
fn check_memory(width: u32, height: u32, options: &Options) -> Result<(), Failure> {
    let pixel = if options.planes == Planes::default() { PLAIN_PIXEL } else { PIXEL_WITH_PLANES };
    let bytes = (width as usize).saturating_mul(height as usize).saturating_mul(pixel);
    Vec::<u8>::new().try_reserve_exact(bytes).map_err(|_| {
        Failure::Run(format!("there is no memory for a picture of {width}x{height} pixels; choose a smaller --size"))
    })
}

/// What all frames of a run share.
struct Tracer<'a> {
    stage: &'a Stage,
    frames: &'a Frames,
    interrupt: &'a Interrupt,
    scratch: Scratch,
    film: Film,
}

impl Tracer<'_> {
    /// Traces frame `number` and adds its cost to `run`.
    fn trace(&mut self, number: u64, run: &mut Run) -> Result<(), Failure> {
        let camera = self.frames.camera(number, &self.stage.camera, &self.stage.loaded.scene)?;
        let (scene, settings) = (&self.stage.loaded.scene, &self.stage.settings);
        let completed = timed_frame(run, scene, &camera, settings, &mut self.scratch, &mut self.film);
        // Asked again: Ctrl-C may come while the last tile is traced.
        self.interrupt.check()?;
        if completed { Ok(()) } else { Err(Failure::Interrupted) }
    }

    /// Paints frame `number`, which was traced last, as a map.
    fn paint(&mut self, number: u64, map: Map, mut exact: Option<&mut Reference>) -> Result<(), Failure> {
        if let Some(exact) = &mut exact {
            self.trace_reference(number, exact)?;
        }
        map.paint(&mut [&mut self.film], exact.map(|exact| &exact.film));
        Ok(())
    }

    /// Traces the reference of frame `number`, which was traced last, and measures the difference.
    fn compare(&mut self, number: u64, reference: &mut Reference) -> Result<(), Failure> {
        self.trace_reference(number, reference)?;
        reference.meter.add(self.film.rgba(), reference.film.rgba());
        Ok(())
    }

    /// Traces the reference of frame `number`.
    fn trace_reference(&mut self, number: u64, reference: &mut Reference) -> Result<(), Failure> {
        let camera = self.frames.camera(number, &self.stage.camera, &self.stage.loaded.scene)?;
        let Reference { settings, film, .. } = reference;
        let stats = render_frame(&self.stage.loaded.scene, &camera, settings, &mut self.scratch, film);
        self.interrupt.check()?;
        if stats.completed { Ok(()) } else { Err(Failure::Interrupted) }
    }
}

/// What the frames of a run are measured against.
struct Reference {
    settings: Settings,
    film: Film,
    meter: MotionMeter,
}

impl Reference {
    /// The run's own settings without what approximates.
    fn new(visibility: Visibility, stage: &Stage) -> Self {
        Self {
            settings: Settings { visibility, ..stage.settings.reference() },
            film: Film::new(stage.size.width, stage.size.height, Planes::default()),
            meter: MotionMeter::default(),
        }
    }
}

fn record_of(stage: &Stage, run: &Run, reference: Option<&Reference>) -> Record {
    let Stage { loaded, size, settings, .. } = stage;
    let subject = Subject::new(&loaded.scene, settings, (size.width, size.height), loaded.total_ms);
    Record::new(subject, run, reference.map(|reference| &reference.meter))
}
