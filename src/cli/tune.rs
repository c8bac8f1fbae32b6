//! `raywalk tune`: the cheapest settings whose errors stay within bounds.

use super::frames::Frames;
use super::interrupt::Interrupt;
use super::options::Options;
use super::output;
use super::progress::Progress;
use super::stage::Stage;
use super::{Failure, stdout};
use clap::ArgMatches;
use clap::parser::ValueSource;
use raywalk::app::screenshot;
use raywalk::measure::tune::{self, Bound, Machine, Task, Tuning};
use raywalk::settings::{ROWS, Settings};
use std::time::Duration;

/// No new settings are tried after this time.
const BUDGET: Duration = Duration::from_secs(40);
/// Steps of the progress bar.
const STEPS: f64 = 1000.0;

/// Searches for what `asked` says.
pub fn run(asked: &ArgMatches, interrupt: &Interrupt) -> Result<(), Failure> {
    let options = Options::of(asked, Settings::exact)?;
    output::check_planes(None, options.planes)?;
    if options.stats.is_some() {
        return Err(Failure::Usage("--stats: tune tells its figures itself; see --json".to_owned()));
    }
    if asked.get_one::<String>("preset").is_some_and(|preset| preset != "exact") {
        let reason = "tune starts from exact and tries the other presets itself; give single flags, which it keeps";
        return Err(Failure::Usage(format!("--preset: {reason}")));
    }
    let bounds = Bound::strictest(asked.get_many::<Bound>("max-error").into_iter().flatten().copied());
    if let Some(bound) = bounds.iter().find(|bound| !bound.can_hold()) {
        return Err(Failure::Run(format!("{bound}: not even equal pictures keep it; choose another bound")));
    }
    let is_given = |name: &str| asked.value_source(name) == Some(ValueSource::CommandLine);
    let frames = Frames::of(&options)?;
    let stage = Stage::set(&options)?;
    if let (Some(warning), false) = (&frames.warning, options.reading.quiet) {
        stdout::note(&format!("warning: {warning}"));
    }
    // Without a path all frames are alike.
    let range = if frames.differ() { frames.range.clone() } else { frames.first().range };
    let task = Task {
        cameras: range.map(|n| frames.camera(n, &stage.camera, &stage.loaded.scene)).collect::<Result<_, _>>()?,
        size: (stage.size.width, stage.size.height),
        settings: options.settings.clone(),
        fixed: ROWS.iter().map(|row| row.name).filter(|name| is_given(name)).collect(),
        bounds,
        also: Vec::new(),
        budget: BUDGET,
    };
    interrupt.careful();
    let progress = Progress::over_steps(STEPS as u64, options.reading.quiet);
    let told = |share: f64| progress.set((STEPS * share) as u64, &stage.loaded.scene.name);
    let mut machine = Machine::new(&stage.loaded.scene, interrupt.token.clone(), &told);
    let found = tune::tune(&task, &mut machine).map_err(|tune::Stopped| Failure::Interrupted)?;
    drop(progress);
    interrupt.check()?;
    let environment = screenshot::environment_flag(&options.reading.environment);
    if !asked.get_flag("json") {
        stdout::print(&tune::table(&found, environment.as_deref()))?;
    }
    stdout::print(&stdout::json(&tune::json(&found, environment.as_deref()))?)?;
    if found.chosen.is_some() { Ok(()) } else { Err(Failure::Run(nothing_keeps(&found))) }
}

fn nothing_keeps(found: &Tuning) -> String {
    let bounds: Vec<String> = found.bounds.iter().map(Bound::to_string).collect();
    format!(
        "none of the {} settings that were tried keeps {}; allow more error, or leave more settings free",
        found.trials.len(),
        bounds.join(" and ")
    )
}
