//! Code that is meant never to panic, but reads what strangers wrote: should it panic, what it was to read is all that is
//! lost.

use std::any::Any;
use std::cell::Cell;
use std::panic::{AssertUnwindSafe, catch_unwind};

thread_local! {
    static DEPTH: Cell<u32> = const { Cell::new(0) };
}

/// Does some work, of which nothing is kept if it panics.
///
/// # Errors
/// What the panic says of itself.
pub fn guarded<T>(work: impl FnOnce() -> T) -> Result<T, String> {
    DEPTH.set(DEPTH.get() + 1);
    let done = catch_unwind(AssertUnwindSafe(work));
    DEPTH.set(DEPTH.get() - 1);
    done.map_err(|panic| said(&*panic))
}

/// Whether a panic on this thread would become an error: then it need not be told of on stderr.
pub fn is_guarded() -> bool {
    DEPTH.get() > 0
}

fn said(panic: &dyn Any) -> String {
    let text = panic.downcast_ref::<&str>().map(|text| (*text).to_owned());
    text.or_else(|| panic.downcast_ref::<String>().cloned()).unwrap_or_else(|| "it gives no reason".to_owned())
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::panic::resume_unwind;

    #[test]
    fn a_panic_becomes_an_error_that_says_why() {
        assert_eq!(guarded(|| 7), Ok(7));
        let inner = || guarded(|| -> () { resume_unwind(Box::new("index 9 of 3".to_owned())) });
        assert_eq!(guarded(|| (is_guarded(), inner(), is_guarded())), Ok((true, Err("index 9 of 3".to_owned()), true)));
        assert_eq!(guarded(|| -> () { resume_unwind(Box::new(7)) }), Err("it gives no reason".to_owned()));
        assert!(!is_guarded());
    }
}
