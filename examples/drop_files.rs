//! Drops files onto a window of an X server, as a file manager would; the walk through the window in CI drags with it.
//!
//! `cargo run --release --example drop_files -- WINDOW PATH...`, the window as a number. It ends when the window has
//! taken the files, and fails if that takes too long. The source's side of XDND 5, <https://freedesktop.org/wiki/Specifications/XDND>.

use anyhow::{Context, bail, ensure};
use std::path::Path;
use std::time::{Duration, Instant};
use x11rb::connection::Connection;
use x11rb::protocol::Event;
use x11rb::protocol::xproto::{
    Atom, AtomEnum, ClientMessageEvent, ConnectionExt as _, CreateWindowAux, EventMask, PropMode,
    SELECTION_NOTIFY_EVENT, SelectionNotifyEvent, SelectionRequestEvent, Window, WindowClass,
};
use x11rb::rust_connection::RustConnection;
use x11rb::wrapper::ConnectionExt as _;
use x11rb::{COPY_DEPTH_FROM_PARENT, COPY_FROM_PARENT, CURRENT_TIME, NONE, atom_manager};

const VERSION: u32 = 5;
const PATIENCE: Duration = Duration::from_secs(20);

atom_manager! {
    /// What both sides call things.
    Atoms: AtomsCookie {
        XdndActionCopy,
        XdndDrop,
        XdndEnter,
        XdndFinished,
        XdndPosition,
        XdndSelection,
        XdndStatus,
        UriList: b"text/uri-list",
    }
}

/// What is held over the target.
struct Drag {
    connection: RustConnection,
    atoms: Atoms,
    source: Window,
    target: Window,
    /// One line a file.
    uris: String,
}

impl Drag {
    fn new(target: Window, uris: String) -> anyhow::Result<Self> {
        let (connection, screen) = x11rb::connect(None)?;
        let atoms = Atoms::new(&connection)?.reply()?;
        let (source, root) = (connection.generate_id()?, connection.setup().roots[screen].root);
        let (class, look) = (WindowClass::INPUT_OUTPUT, CreateWindowAux::new());
        connection.create_window(
            COPY_DEPTH_FROM_PARENT,
            source,
            root,
            0,
            0,
            1,
            1,
            0,
            class,
            COPY_FROM_PARENT,
            &look,
        )?;
        connection.set_selection_owner(source, atoms.XdndSelection, CURRENT_TIME)?;
        Ok(Self { connection, atoms, source, target, uris })
    }

    /// Sends the target a message; its first word is always where it comes from.
    fn tell(&self, kind: Atom, words: [u32; 4]) -> anyhow::Result<()> {
        let [a, b, c, d] = words;
        let message = ClientMessageEvent::new(32, self.target, kind, [self.source, a, b, c, d]);
        self.connection.send_event(false, self.target, EventMask::NO_EVENT, message)?;
        Ok(self.connection.flush()?)
    }

    /// Gives what is held to the target, which asked for it.
    fn hand_over(&self, request: &SelectionRequestEvent) -> anyhow::Result<()> {
        let is_known = request.target == self.atoms.UriList;
        if is_known {
            let (window, property, kind) = (request.requestor, request.property, request.target);
            self.connection.change_property8(PropMode::REPLACE, window, property, kind, self.uris.as_bytes())?;
        }
        let answer = SelectionNotifyEvent {
            response_type: SELECTION_NOTIFY_EVENT,
            sequence: 0,
            time: request.time,
            requestor: request.requestor,
            selection: request.selection,
            target: request.target,
            property: if is_known { request.property } else { AtomEnum::NONE.into() },
        };
        self.connection.send_event(false, request.requestor, EventMask::NO_EVENT, answer)?;
        Ok(self.connection.flush()?)
    }

    /// Holds it over the target, lets it go when that is welcome, and waits until it was taken.
    fn run(&self) -> anyhow::Result<()> {
        let [x, y] = [100, 100];
        self.tell(self.atoms.XdndEnter, [VERSION << 24, self.atoms.UriList, NONE, NONE])?;
        self.tell(self.atoms.XdndPosition, [0, x << 16 | y, CURRENT_TIME, self.atoms.XdndActionCopy])?;
        let end = Instant::now() + PATIENCE;
        while Instant::now() < end {
            match self.connection.poll_for_event()? {
                Some(Event::SelectionRequest(request)) => self.hand_over(&request)?,
                Some(Event::ClientMessage(message)) if message.type_ == self.atoms.XdndStatus => {
                    ensure!(message.data.as_data32()[1] & 1 == 1, "the window does not want it");
                    self.tell(self.atoms.XdndDrop, [0, CURRENT_TIME, 0, 0])?;
                }
                Some(Event::ClientMessage(message)) if message.type_ == self.atoms.XdndFinished => return Ok(()),
                Some(_) => {}
                None => std::thread::sleep(Duration::from_millis(5)),
            }
        }
        bail!("the window has not taken it")
    }
}

/// The name of a file as it travels: everything but letters, digits and a few signs by its number.
fn uri(path: &Path) -> anyhow::Result<String> {
    let path = path.canonicalize().with_context(|| format!("{}", path.display()))?;
    let mut uri = "file://".to_owned();
    for &byte in path.as_os_str().as_encoded_bytes() {
        if byte.is_ascii_alphanumeric() || b"/-_.~".contains(&byte) {
            uri.push(char::from(byte));
        } else {
            uri.push_str(&format!("%{byte:02X}"));
        }
    }
    Ok(uri + "\r\n")
}

fn main() -> anyhow::Result<()> {
    let mut arguments = std::env::args_os().skip(1);
    let window = arguments.next().and_then(|window| window.to_str()?.parse().ok());
    let uris = arguments.map(|path| uri(Path::new(&path))).collect::<anyhow::Result<String>>()?;
    ensure!(!uris.is_empty(), "usage: drop_files WINDOW PATH...");
    Drag::new(window.context("usage: drop_files WINDOW PATH...")?, uris)?.run()
}
