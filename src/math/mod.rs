//! Numbers: SIMD levels and lanes, vectors of lanes, and the functions that must give the same bits everywhere.
//!
//! Value arithmetic (whatever reaches a pixel) uses IEEE add, sub, mul, div and sqrt in one order, never
//! fused multiply-add and never the system's libm, so that every machine, level and thread count agrees.

pub mod arctangent;
pub mod power;
#[cfg(test)]
pub mod random;
pub mod simd;
pub mod vector;

pub use simd::{Lanes, SimdToken, dispatch};
pub use vector::V3;
