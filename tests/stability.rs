//! The stability suite: every method on every scene of `scenes/stress/`, each made to break one, and how often it is
//! wrong there. What promises the same pixels must have no wrong value at all; what approximates must fail as often as
//! its row says, no more and no less, so that the README can say where.

#[path = "common/flips.rs"]
mod flips;
#[path = "common/picture_bits.rs"]
mod picture_bits;
#[path = "common/random.rs"]
#[allow(dead_code, reason = "not every target needs every kind of number")]
mod random;
#[path = "common/tracer/mod.rs"]
mod tracer;

mod stability {
    mod exact;
    mod failures;
    mod precision;
    mod rates;
    mod scenes;
    mod wires;
}
