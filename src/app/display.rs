//! Finding a display: making an event loop where one can be had, and an error instead of a panic elsewhere.

use super::error::AppError;
use std::panic::{self, AssertUnwindSafe};
use winit::event_loop::{EventLoop, EventLoopBuilder};

/// An event loop on the display server that answers.
///
/// # Errors
/// [`AppError::NoDisplay`] when none does, or a library of it is missing.
pub fn event_loop<T: 'static>() -> Result<EventLoop<T>, AppError> {
    let mut builder = EventLoop::<T>::with_user_event();
    choose_server(&mut builder);
    // winit's loaders panic when libraries such as libxkbcommon-x11 are missing.
    let hook = panic::take_hook();
    panic::set_hook(Box::new(|_| {}));
    let built = panic::catch_unwind(AssertUnwindSafe(|| builder.build()));
    panic::set_hook(hook);
    match built {
        Ok(Ok(event_loop)) => Ok(event_loop),
        Ok(Err(error)) => Err(AppError::NoDisplay(without_place(&error.to_string()).to_owned())),
        Err(panic) => Err(AppError::NoDisplay(panic_message(panic.as_ref()))),
    }
}

/// winit's messages begin with the line of its source that made them: of no use to a reader of ours.
fn without_place(message: &str) -> &str {
    let place_end = message.find(".rs:").and_then(|at| message[at..].find(": ").map(|end| at + end + 2));
    place_end.map_or(message, |end| &message[end..])
}

fn panic_message(panic: &(dyn std::any::Any + Send)) -> String {
    let text = panic.downcast_ref::<String>().map(String::as_str).or_else(|| panic.downcast_ref::<&str>().copied());
    text.unwrap_or("a library of the display server is missing").lines().next().unwrap_or_default().to_owned()
}

/// winit goes by the environment alone and lets no one try twice: where it names a Wayland server that
/// does not answer and an X server as well, ask for the latter.
#[cfg(all(unix, not(target_os = "macos")))]
fn choose_server<T: 'static>(builder: &mut EventLoopBuilder<T>) {
    use winit::platform::x11::EventLoopBuilderExtX11;
    let set = |name: &str| std::env::var_os(name).filter(|value| !value.is_empty());
    if set("WAYLAND_SOCKET").is_some() || set("DISPLAY").is_none() {
        return;
    }
    let Some(name) = set("WAYLAND_DISPLAY") else { return };
    // An absolute name replaces the folder.
    let socket = std::path::PathBuf::from(set("XDG_RUNTIME_DIR").unwrap_or_default()).join(name);
    if std::os::unix::net::UnixStream::connect(socket).is_err() {
        builder.with_x11();
    }
}

#[cfg(not(all(unix, not(target_os = "macos"))))]
fn choose_server<T: 'static>(_builder: &mut EventLoopBuilder<T>) {}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_place_in_winits_source_is_left_out() {
        assert_eq!(without_place("os error at /x/mod.rs:765: DISPLAY is not set: none"), "DISPLAY is not set: none");
        assert_eq!(without_place("not supported"), "not supported");
    }

    #[test]
    fn a_panic_becomes_one_line() {
        assert_eq!(panic_message(&"library missing".to_owned()), "library missing");
        assert_eq!(panic_message(&"library\nmissing"), "library");
        assert_eq!(panic_message(&7), "a library of the display server is missing");
    }
}
