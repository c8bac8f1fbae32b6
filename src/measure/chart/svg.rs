//! SVG elements as text.

use super::palette::{DARK, STYLE, class, mark};
use std::fmt::Write;

/// Where a text starts from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Anchor {
    Start,
    Middle,
    End,
}

/// Elements so far.
#[derive(Clone, Debug, Default)]
pub struct Svg(pub String);

/// Text with the signs that XML keeps for itself replaced, and those that it does not allow at all (XML 1.0, 2.2).
pub fn escaped(text: &str) -> String {
    let allowed = |c: char| match c {
        '\t' | '\n' | '\r' => c,
        '\0'..' ' | '\u{fffe}' | '\u{ffff}' => char::REPLACEMENT_CHARACTER,
        _ => c,
    };
    let text: String = text.chars().map(allowed).collect();
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;")
}

/// A file of its own.
pub fn document((width, height): (f64, f64), title: &str, body: &str) -> String {
    format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{width}\" height=\"{height}\" viewBox=\"0 0 {width} {height}\">\n\
         <title>{}</title>\n<style>{STYLE}\n@media (prefers-color-scheme: dark) {{{DARK}}}</style>\n{body}</svg>\n",
        escaped(title)
    )
}

/// The width of a text in pixels, on the wide side: what is really drawn depends on the viewer's fonts.
pub fn text_width(text: &str, font_size: f64) -> f64 {
    let width = |c: char| match c {
        'i' | 'j' | 'l' | '.' | ',' | ':' | '\'' | '|' | '\u{202f}' => 0.3,
        'm' | 'w' | 'M' | 'W' | '%' => 0.9,
        ' ' | 'f' | 't' | 'r' | '(' | ')' | '/' | '-' | '[' | ']' => 0.4,
        'A'..='Z' => 0.7,
        _ => 0.57,
    };
    font_size * text.chars().map(width).sum::<f64>()
}

/// The lines of a text that is broken between words where it would get wider than `width`.
pub fn wrapped(text: &str, font_size: f64, width: f64) -> Vec<String> {
    let mut lines = vec![String::new()];
    for word in text.split(' ') {
        let line = lines.len() - 1;
        let longer = if lines[line].is_empty() { word.to_owned() } else { format!("{} {word}", lines[line]) };
        if lines[line].is_empty() || text_width(&longer, font_size) <= width {
            lines[line] = longer;
        } else {
            lines.push(word.to_owned());
        }
    }
    lines
}

impl Svg {
    fn add(&mut self, element: std::fmt::Arguments<'_>) {
        // Writing to a string cannot fail.
        let _ = self.0.write_fmt(element);
        self.0.push('\n');
    }

    /// The paper that all is drawn on, and its title.
    pub fn on_paper((width, height): (f64, f64), title: &str, note: &str) -> Self {
        let mut svg = Self::default();
        svg.rectangle(0.0, 0.0, width, height, "paper");
        svg.text(18.0, 26.0, Anchor::Start, "title", title);
        for (i, line) in wrapped(note, 12.0, width - 36.0).iter().enumerate() {
            svg.text(18.0, 45.0 + 15.0 * i as f64, Anchor::Start, "note", line);
        }
        svg
    }

    pub fn line(&mut self, (x1, y1): (f64, f64), (x2, y2): (f64, f64), class: &str) {
        self.add(format_args!(r#"<line class="{class}" x1="{x1:.1}" y1="{y1:.1}" x2="{x2:.1}" y2="{y2:.1}"/>"#));
    }

    pub fn rectangle(&mut self, x: f64, y: f64, width: f64, height: f64, class: &str) {
        self.add(format_args!(
            r#"<rect class="{class}" x="{x:.1}" y="{y:.1}" width="{width:.1}" height="{height:.1}"/>"#
        ));
    }

    /// A rectangle that tells what it is when pointed at.
    pub fn part(&mut self, x: f64, y: f64, width: f64, height: f64, class: &str, told: &str) {
        self.add(format_args!(
            r#"<rect class="{class}" x="{x:.1}" y="{y:.1}" width="{width:.1}" height="{height:.1}"><title>{}</title></rect>"#,
            escaped(told)
        ));
    }

    pub fn text(&mut self, x: f64, y: f64, anchor: Anchor, class: &str, text: &str) {
        let anchor = match anchor {
            Anchor::Start => "start",
            Anchor::Middle => "middle",
            Anchor::End => "end",
        };
        self.add(format_args!(
            r#"<text class="{class}" x="{x:.1}" y="{y:.1}" text-anchor="{anchor}">{}</text>"#,
            escaped(text)
        ));
    }

    /// Text that runs upwards, centred on (x, y).
    pub fn text_upwards(&mut self, x: f64, y: f64, class: &str, text: &str) {
        self.add(format_args!(
            r#"<text class="{class}" transform="translate({x:.1} {y:.1}) rotate(-90)" text-anchor="middle">{}</text>"#,
            escaped(text)
        ));
    }

    /// A line through points.
    pub fn polyline(&mut self, points: &[(f64, f64)], class: &str, dashes: &str) {
        let points: Vec<String> = points.iter().map(|(x, y)| format!("{x:.1},{y:.1}")).collect();
        let dashes = if dashes == "none" { String::new() } else { format!(r#" stroke-dasharray="{dashes}""#) };
        self.add(format_args!(r#"<polyline class="{class}"{dashes} points="{}"/>"#, points.join(" ")));
    }

    /// The mark of a family at (x, y), which tells what it is when pointed at. `point` names it on the page.
    pub fn mark(&mut self, at: (f64, f64), family: &str, faint: bool, told: &str, point: Option<usize>) {
        self.named_mark(at, family, faint, told, point, "");
    }

    /// The same with a name behind it that can be pointed at as well.
    pub fn named_mark(
        &mut self,
        (x, y): (f64, f64),
        family: &str,
        faint: bool,
        told: &str,
        point: Option<usize>,
        name: &str,
    ) {
        let faint = if faint { " faint" } else { "" };
        let point = point.map(|point| format!(r#" data-point="{point}" tabindex="0""#)).unwrap_or_default();
        self.add(format_args!(
            r#"<g class="point"{point}><title>{}</title><path class="{}{faint}" transform="translate({x:.1} {y:.1})" d="{}"/>"#,
            escaped(told),
            class(family),
            mark(family)
        ));
        if !name.is_empty() {
            self.text(x + 12.0, y + 4.5, Anchor::Start, "", name);
        }
        self.add(format_args!("</g>"));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn texts_hold_only_what_xml_allows() {
        assert_eq!(escaped("a\u{1}b\n<\u{ffff}&>"), "a\u{fffd}b\n&lt;\u{fffd}&amp;&gt;");
        assert!(!document((9.0, 9.0), "\0", "").contains('\0'));
    }

    #[test]
    fn long_texts_are_broken_between_words_and_nothing_is_lost() {
        let text = "a note that is much too long for one line of so narrow a chart";
        let lines = wrapped(text, 12.0, 150.0);
        assert!(lines.len() > 2 && lines.iter().all(|line| text_width(line, 12.0) <= 150.0), "{lines:?}");
        assert_eq!(lines.join(" "), text);
        assert_eq!(wrapped("unbreakable", 12.0, 5.0), ["unbreakable"]);
    }
}
