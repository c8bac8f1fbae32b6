//! All benchmarks, in one binary: one module a subject. `cargo bench -- kernels` runs one of them.

mod beams;
mod builds;
mod frames;
mod kernels;
mod rays;
mod shapes;
#[path = "../../examples/make_scenes/sphereflake.rs"]
mod sphereflake;
mod traversal;

fn main() {
    divan::main();
}
