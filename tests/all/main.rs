//! The integration tests, in one binary.

mod blit;
mod overlay;
