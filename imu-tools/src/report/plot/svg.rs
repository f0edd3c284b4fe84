//! A drawing as SVG text: shapes with classes, whose colours a style sheet decides.
//!
//! Coordinates are pixels from the upper left corner, written with two decimals.

use std::fmt::Write as _;

/// A point in pixels.
pub(super) type Point = (f64, f64);

/// Where a text stands relative to its point.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Anchor {
    /// To the right of it.
    Start,
    /// Around it.
    Middle,
    /// To the left of it.
    End,
}

/// Shapes, in the order in which they are drawn.
#[derive(Clone, Debug, Default)]
pub(super) struct Shapes(String);

impl Shapes {
    /// The elements' text.
    pub(super) fn text(&self) -> &str {
        &self.0
    }

    /// Adds other shapes on top.
    pub(super) fn append(&mut self, other: &Self) {
        self.0.push_str(&other.0);
    }

    /// Adds other shapes, of which only what lies in a rectangle is seen.
    pub(super) fn append_within(&mut self, other: &Self, id: &str, from: Point, to: Point) {
        let (width, height) = (to.0 - from.0, to.1 - from.1);
        let _ = writeln!(
            self.0,
            "<clipPath id=\"{id}\"><rect x=\"{:.2}\" y=\"{:.2}\" width=\"{width:.2}\" \
             height=\"{height:.2}\"/></clipPath>\n<g clip-path=\"url(#{id})\">",
            from.0, from.1
        );
        self.0.push_str(&other.0);
        self.0.push_str("</g>\n");
    }

    /// A line through points; nothing of fewer than two.
    pub(super) fn line(&mut self, class: &str, points: &[Point]) {
        if points.len() >= 2 {
            let _ = writeln!(self.0, "<polyline class=\"{class}\" points=\"{}\"/>", list(points));
        }
    }

    /// A filled outline.
    pub(super) fn area(&mut self, class: &str, points: &[Point]) {
        if points.len() >= 3 {
            let _ = writeln!(self.0, "<polygon class=\"{class}\" points=\"{}\"/>", list(points));
        }
    }

    /// A rectangle between two corners.
    pub(super) fn rectangle(&mut self, class: &str, from: Point, to: Point) {
        let _ = writeln!(
            self.0,
            "<rect class=\"{class}\" x=\"{:.2}\" y=\"{:.2}\" width=\"{:.2}\" height=\"{:.2}\"/>",
            from.0.min(to.0),
            from.1.min(to.1),
            (to.0 - from.0).abs(),
            (to.1 - from.1).abs()
        );
    }

    /// A dot.
    pub(super) fn dot(&mut self, class: &str, at: Point, radius: f64) {
        let _ = writeln!(
            self.0,
            "<circle class=\"{class}\" cx=\"{:.2}\" cy=\"{:.2}\" r=\"{radius}\"/>",
            at.0, at.1
        );
    }

    /// Words.
    pub(super) fn words(&mut self, class: &str, at: Point, anchor: Anchor, words: &str) {
        let anchor = match anchor {
            Anchor::Start => "start",
            Anchor::Middle => "middle",
            Anchor::End => "end",
        };
        let _ = writeln!(
            self.0,
            "<text class=\"{class}\" x=\"{:.2}\" y=\"{:.2}\" text-anchor=\"{anchor}\">{}</text>",
            at.0,
            at.1,
            escape(words)
        );
    }

    /// Words that run upwards, around a point.
    pub(super) fn upwards(&mut self, class: &str, at: Point, words: &str) {
        let _ = writeln!(
            self.0,
            "<text class=\"{class}\" transform=\"translate({:.2} {:.2}) rotate(-90)\" \
             text-anchor=\"middle\">{}</text>",
            at.0,
            at.1,
            escape(words)
        );
    }
}

fn list(points: &[Point]) -> String {
    points.iter().fold(String::new(), |mut text, (x, y)| {
        let space = if text.is_empty() { "" } else { " " };
        let _ = write!(text, "{space}{x:.2},{y:.2}");
        text
    })
}

/// Text as XML holds it; control characters, which it cannot hold, become blanks.
pub(super) fn escape(text: &str) -> String {
    text.chars().fold(String::new(), |mut escaped, c| {
        match c {
            '&' => escaped.push_str("&amp;"),
            '<' => escaped.push_str("&lt;"),
            '>' => escaped.push_str("&gt;"),
            '"' => escaped.push_str("&quot;"),
            c if c.is_control() => escaped.push(' '),
            c => escaped.push(c),
        }
        escaped
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_cannot_break_out() {
        let mut shapes = Shapes::default();
        shapes.words("a", (0.0, 1.0), Anchor::Start, "</text><b>&\u{0}");
        assert!(shapes.text().contains(">&lt;/text&gt;&lt;b&gt;&amp; </text>"));
    }
}
