//! Where and with what a bench was run: figures of two environments are never mixed.

use crate::math::simd::SimdToken;
use crate::render::thread_count;
use crate::settings::Settings;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::collections::hash_map::DefaultHasher;
use std::fs::{self, File};
use std::hash::Hasher;
use std::io::Read;
use std::path::Path;

/// Machine, build and settings of a bench.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Environment {
    /// The processor's name.
    pub machine: String,
    /// Operating system and architecture.
    pub system: String,
    /// Cores that this process may use.
    pub cores: usize,
    /// Version, kind of build, and a fingerprint of the program.
    pub build: String,
    /// Instruction set of the kernels.
    pub simd: String,
    /// Worker threads.
    pub threads: usize,
    /// `default` or `quick`.
    pub effort: String,
    /// What was changed of the preset `exact` for all methods, as it is typed.
    pub flags: String,
    /// A fingerprint of what is to be seen in each view of a scene.
    pub views: BTreeMap<String, String>,
    /// Width and height at which the views of sweeps are measured: less than was asked for where frames take too long.
    #[serde(default)]
    pub sizes: BTreeMap<String, (u32, u32)>,
}

impl Environment {
    /// This process on this machine, with the settings that all methods start from.
    pub fn here(base: &Settings, effort: &str) -> Self {
        let kind = if cfg!(debug_assertions) { "debug" } else { "release" };
        let program = std::env::current_exe().ok().and_then(|program| fingerprint(&program));
        Self {
            machine: processor(),
            system: format!("{} {}", std::env::consts::OS, std::env::consts::ARCH),
            cores: thread_count(0),
            build: format!("{} {kind} {}", env!("CARGO_PKG_VERSION"), program.unwrap_or_default()),
            simd: SimdToken::new(base.simd).unwrap_or_else(SimdToken::best).name().to_owned(),
            threads: thread_count(base.threads),
            effort: effort.to_owned(),
            flags: base.flags(),
            views: BTreeMap::new(),
            sizes: BTreeMap::new(),
        }
    }

    /// What makes figures of the two not comparable: its name, and both values.
    pub fn difference(&self, now: &Self) -> Option<(String, String, String)> {
        let number = |count: usize| count.to_string();
        let cores = (number(self.cores), number(now.cores));
        let threads = (number(self.threads), number(now.threads));
        let fields = [
            ("machine", &self.machine, &now.machine),
            ("number of cores", &cores.0, &cores.1),
            ("number of threads", &threads.0, &threads.1),
            ("build", &self.build, &now.build),
            ("SIMD level", &self.simd, &now.simd),
            ("effort", &self.effort, &now.effort),
            ("set of flags", &self.flags, &now.flags),
        ];
        let views = self.views.iter().filter_map(|(name, before)| Some((name, before, now.views.get(name)?)));
        let mut all = fields
            .map(|(what, a, b)| (what.to_owned(), a, b))
            .into_iter()
            .chain(views.map(|(name, before, now)| (format!("version of {name}"), before, now)));
        let (what, before, now) = all.find(|(_, before, now)| before != now)?;
        let shown = |text: &str| if text.is_empty() { "none".to_owned() } else { text.to_owned() };
        Some((what, shown(before), shown(now)))
    }

    /// One line for people.
    pub fn line(&self) -> String {
        let Self { machine, system, cores, build, simd, threads, effort, .. } = self;
        format!("raywalk {build}, {simd}, {threads} threads on {cores} cores of {machine}, {system}; sweep: {effort}")
    }
}

/// A short name for a file's contents; `None` where it cannot be read.
fn fingerprint(file: &Path) -> Option<String> {
    let mut hasher = DefaultHasher::new();
    let mut file = File::open(file).ok()?;
    let mut block = vec![0; 1 << 16];
    loop {
        match file.read(&mut block).ok()? {
            0 => return Some(format!("{:08x}", hasher.finish() as u32)),
            length => hasher.write(&block[..length]),
        }
    }
}

/// The processor's name, where the system tells it.
fn processor() -> String {
    let told = fs::read_to_string("/proc/cpuinfo").unwrap_or_default();
    let name = told.lines().find_map(|line| line.strip_prefix("model name")?.split_once(':'));
    name.map_or_else(|| std::env::consts::ARCH.to_owned(), |(_, name)| name.trim().to_owned())
}
