//! The terminal taken over: raw mode, the second screen, no cursor, the mouse; and given back however the walk ends.

use super::palette::{Color, Palette};
use std::io::{self, Write};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};
use termina::escape::csi::{Csi, Cursor, Device, Keyboard, KittyKeyboardFlags, Sgr};
use termina::escape::dcs::{Dcs, DcsRequest, DcsResponse};
use termina::style::ColorSpec;
use termina::{Event, EventReader, PlatformTerminal, Terminal};

/// The second screen; no cursor; buttons, drags and the wheel; gain and loss of the focus.
const TAKE: &str = "\x1b[?1049h\x1b[?25l\x1b[?1000h\x1b[?1002h\x1b[?1006h\x1b[?1004h";
/// The same taken back, and what a frame may have left behind. Erased, because tmux mixes up the screens where the second
/// has text in rows that the first did not have.
const GIVE_BACK: &str =
    "\x1b[?2026l\x1b[m\x1b[H\x1b[2J\x1b[?1004l\x1b[?1006l\x1b[?1002l\x1b[?1000l\x1b[?25h\x1b[?1049l";
/// A colour that nobody would have chosen, to see whether the terminal knows it again.
const ODD: [u8; 3] = [1, 2, 3];
/// Answers are waited for this long.
const PATIENCE: Duration = Duration::from_secs(1);
/// Columns and rows of a terminal that does not know its own.
const USUAL_SIZE: (u16, u16) = (80, 24);

/// What the terminal can do, by its own answers.
#[derive(Clone, Copy, Debug, Default)]
pub struct Abilities {
    /// It tells when keys are released.
    pub tells_releases: bool,
    /// It tells where the cursor is.
    pub answers: bool,
    /// It knows 24 bits a colour.
    true_color: bool,
}

/// The terminal, as long as it is ours.
#[derive(Debug)]
pub struct Screen {
    terminal: PlatformTerminal,
    abilities: Abilities,
    /// Something panicked: the terminal was given back, and the report of it should stay.
    panicked: Arc<AtomicBool>,
}

impl Screen {
    /// Takes the terminal over and asks what it can do.
    pub fn take() -> io::Result<Self> {
        let mut terminal = PlatformTerminal::new()?;
        let panicked = Arc::new(AtomicBool::new(false));
        let flag = panicked.clone();
        terminal.set_panic_hook(move |out| {
            if !flag.swap(true, Ordering::SeqCst) {
                // The report of the panic follows in any case.
                let _ = out.write_all(give_back().as_bytes());
            }
        });
        // From here on, dropping it gives the terminal back.
        let mut screen = Self { terminal, abilities: Abilities::default(), panicked };
        screen.resume()?;
        screen.abilities = screen.ask()?;
        Ok(screen)
    }

    /// Takes the terminal over again after [`give_back`](Self::give_back).
    pub fn resume(&mut self) -> io::Result<()> {
        self.terminal.enter_raw_mode()?;
        let keyboard = Csi::Keyboard(Keyboard::PushFlags(
            KittyKeyboardFlags::DISAMBIGUATE_ESCAPE_CODES
                | KittyKeyboardFlags::REPORT_EVENT_TYPES
                | KittyKeyboardFlags::REPORT_ALTERNATE_KEYS
                | KittyKeyboardFlags::REPORT_ALL_KEYS_AS_ESCAPE_CODES,
        ));
        // Terminals that do not know the protocol ignore it.
        self.write(format!("{TAKE}{keyboard}").as_bytes())
    }

    /// Gives the terminal back as it was.
    pub fn give_back(&mut self) -> io::Result<()> {
        let written = self.write(give_back().as_bytes());
        self.terminal.enter_cooked_mode()?;
        written
    }

    /// Writes bytes at once, unless the report of a panic is being read.
    pub fn write(&mut self, bytes: &[u8]) -> io::Result<()> {
        if self.panicked.load(Ordering::SeqCst) {
            return Ok(());
        }
        self.terminal.write_all(bytes)?;
        self.terminal.flush()
    }

    /// Columns and rows.
    pub fn size(&self) -> (u16, u16) {
        self.terminal.get_dimensions().map_or(USUAL_SIZE, |size| (size.cols, size.rows))
    }

    /// Reads what is typed, and what the terminal answers.
    pub fn reader(&self) -> EventReader {
        self.terminal.event_reader()
    }

    /// What the terminal can do.
    pub fn abilities(&self) -> Abilities {
        self.abilities
    }

    /// The colours to draw with: as the environment has it, else as the terminal answered.
    pub fn palette(&self) -> Palette {
        let asked = if self.abilities.true_color { Palette::TrueColor } else { Palette::Colors256 };
        Palette::of_environment(|name| std::env::var(name).ok()).unwrap_or(asked)
    }

    /// Asks everything at once, and last what every terminal answers: the time of one answer, not of four.
    fn ask(&mut self) -> io::Result<Abilities> {
        let questions = format!(
            "\x1b[48;{}m{}\x1b[m{}{}{}",
            Color::Rgb(ODD),
            Dcs::Request(DcsRequest::GraphicRendition),
            Csi::Keyboard(Keyboard::QueryFlags),
            Csi::Cursor(Cursor::RequestActivePositionReport),
            Csi::Device(Device::RequestPrimaryDeviceAttributes),
        );
        self.write(questions.as_bytes())?;
        let mut abilities = Abilities::default();
        let deadline = Instant::now() + PATIENCE;
        loop {
            let left = deadline.saturating_duration_since(Instant::now());
            // What was typed meanwhile stays to be read.
            if left.is_zero() || !self.terminal.poll(Event::is_escape, Some(left))? {
                return Ok(abilities);
            }
            match self.terminal.read(Event::is_escape)? {
                Event::Dcs(Dcs::Response { value: DcsResponse::GraphicRendition(rendition), .. }) => {
                    abilities.true_color = rendition.iter().any(is_odd);
                }
                Event::Csi(Csi::Keyboard(Keyboard::ReportFlags(flags))) => {
                    abilities.tells_releases = flags.contains(KittyKeyboardFlags::REPORT_EVENT_TYPES);
                }
                Event::Csi(Csi::Cursor(Cursor::ActivePositionReport { .. })) => abilities.answers = true,
                Event::Csi(Csi::Device(Device::DeviceAttributes(()))) => return Ok(abilities),
                _ => {}
            }
        }
    }
}

impl Drop for Screen {
    fn drop(&mut self) {
        // A terminal that is gone needs nothing back.
        let _ = self.give_back();
    }
}

fn give_back() -> String {
    format!("{}{GIVE_BACK}", Csi::Keyboard(Keyboard::PopFlags(1)))
}

fn is_odd(rendition: &Sgr) -> bool {
    let [red, green, blue] = ODD;
    match rendition {
        Sgr::Background(ColorSpec::TrueColor(color)) => (color.red, color.green, color.blue) == (red, green, blue),
        _ => false,
    }
}
