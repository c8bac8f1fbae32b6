//! What a bench measures: which methods, on which views, for how long.

mod effort;
mod growth;
mod job;
mod method;
mod scene;

pub use effort::Effort;
pub use growth::by_primitives;
pub use job::{Comparison, Job, Judge, Reference, View, Walk};
pub use method::{
    Change, Method, OPTIMISATIONS, optimisations_alone, optimisations_taken_away, stability_methods, sweep_methods,
    walk_methods,
};
pub use scene::{affordable_size, of_scene};
