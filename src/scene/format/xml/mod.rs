//! XML: the same tree as JSON. An element's name is a key or an object's type, scalars and vectors are attributes
//! (`position="0 1 5"`), the entries of a map carry an `id`, lists of vectors are text (`0 0 0, 1 0 0`).
//!
//! ```xml
//! <scene version="1">
//!   <materials><material id="glass" transparency="1" ior="1.5"/></materials>
//!   <objects><sphere center="0 1 0" radius="1" material="glass"/></objects>
//! </scene>
//! ```

mod node;
mod path;
mod screen;
mod value;

use super::{Input, settle};
use crate::scene::build::SceneBuilder;
use crate::scene::desc::problem::{At, Problem, Warnings};
use crate::scene::desc::{self, Context};
use crate::scene::error::{Place, SceneError};
use crate::scene::format::place::line_column;
use crate::scene::limits::{Limits, exceeded};
use node::Xml;
use roxmltree::{Document, Error, ParsingOptions};
use std::path::Path;

/// Nodes of the text, blanks and comments included, that an object may come to.
const NODES_AN_OBJECT: u64 = 8;

/// Reads an XML scene into `builder`.
pub fn read(input: &Input, builder: &mut SceneBuilder) -> Result<(), SceneError> {
    let text = text_of(input, builder.limits())?;
    let document = parse(input.path, text, builder.limits())?;
    let mut context = Context { limits: builder.limits(), warnings: Warnings::default() };
    let root = document.root_element();
    let described = match root.tag_name().name() {
        "scene" => desc::read(Xml::root(root), &mut context),
        other => {
            let message = format!("expected <scene>, found <{}>", desc::map::shortened(other));
            Err(Problem::new(At(root.range().start), message))
        }
    };
    settle(described, context.warnings, builder, |positions| path::places(input.path, &document, positions))
}

/// The text of a file, once it is known to be harmless.
fn text_of<'t>(input: &Input<'t>, limits: &Limits) -> Result<&'t str, SceneError> {
    let text = str::from_utf8(input.bytes).map_err(|error| {
        let at = Some(line_column(input.bytes, error.valid_up_to()));
        invalid(input.path, at, "the text is not UTF-8; save the file in that encoding".to_owned())
    })?;
    screen::screen(text, limits)
        .map_err(|problem| invalid(input.path, Some(line_column(input.bytes, problem.at.0)), problem.message))?;
    Ok(text)
}

fn parse<'t>(file: &Path, text: &'t str, limits: &Limits) -> Result<Document<'t>, SceneError> {
    let nodes_limit = u32::try_from(limits.objects.saturating_mul(NODES_AN_OBJECT)).unwrap_or(u32::MAX);
    let options = ParsingOptions { nodes_limit, ..ParsingOptions::default() };
    Document::parse_with_options(text, options).map_err(|error| {
        let at = Some((error.pos().row as usize, error.pos().col as usize));
        match error {
            Error::NodesLimitReached => {
                let message = format!("elements: {}", exceeded("objects", limits.objects));
                invalid(file, None, message)
            }
            // The parser adds its own idea of the position.
            _ => {
                let message = error.to_string();
                let message = message.rfind(" at ").map_or(message.as_str(), |end| &message[..end]);
                invalid(file, at, format!("not valid XML: {message}"))
            }
        }
    })
}

fn invalid(file: &Path, line_column: Option<(usize, usize)>, message: String) -> SceneError {
    SceneError::Invalid { place: Place { file: file.to_owned(), line_column, pointer: String::new() }, message }
}
