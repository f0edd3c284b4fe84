//! A chart: a frame with two axes, in which lines, bands and marks are drawn.

use super::scale::Scale;
use super::svg::{Anchor, Point, Shapes};

/// Pixels around the frame: left, right, above, below.
const LEFT: f64 = 78.0;
const RIGHT: f64 = 18.0;
const ABOVE: f64 = 34.0;
const BELOW: f64 = 50.0;
/// Nearest two labels of an axis may come, across.
const ACROSS: f64 = 34.0;
/// A letter of a name takes no more than this across, and a line of them this up.
const LETTER: (f64, f64) = (7.4, 15.0);

/// A chart under construction.
pub(super) struct Chart {
    /// Upper left corner and size, all of it.
    at: Point,
    size: (f64, f64),
    x: Scale,
    y: Scale,
    inside: Shapes,
    /// What stands in the frame whatever lies below it.
    marks: Shapes,
    /// Where names of marks stand: upper left and lower right corners.
    named: Vec<(Point, Point)>,
    legend: Vec<Key>,
}

/// A line of the legend: a class, and what it is called.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Key {
    pub(super) class: &'static str,
    pub(super) name: String,
}

impl Key {
    /// Draws a sample of the class, 18 pixels wide, to the right of `x` around the height `y`.
    pub(super) fn draw(&self, shapes: &mut Shapes, (x, y): Point) {
        if self.class.starts_with("line") {
            shapes.line(self.class, &[(x, y), (x + 18.0, y)]);
        } else {
            shapes.rectangle(self.class, (x, y - 6.0), (x + 18.0, y + 6.0));
        }
    }
}

/// What colours mean, beside one another from the left, in as many lines as it takes.
pub(super) fn legend(keys: Vec<Key>, width: f64) -> (Drawn, f64) {
    const LINE: f64 = 22.0;
    let mut shapes = Shapes::default();
    let (mut x, mut y) = (LEFT, LINE);
    for key in &keys {
        let wide = 38.0 + LETTER.0 * key.name.chars().count() as f64;
        if x > LEFT && x + wide > width - RIGHT {
            (x, y) = (LEFT, y + LINE);
        }
        key.draw(&mut shapes, (x, y - 4.0));
        shapes.words("label", (x + 26.0, y), Anchor::Start, &key.name);
        x += wide;
    }
    (Drawn { shapes, legend: keys }, y + 8.0)
}

/// A chart that is drawn.
pub(super) struct Drawn {
    pub(super) shapes: Shapes,
    pub(super) legend: Vec<Key>,
}

impl Chart {
    /// A chart of this size, whose upper left corner is at `at`.
    pub(super) fn new(at: Point, size: (f64, f64), x: Scale, y: Scale) -> Self {
        let (inside, marks) = (Shapes::default(), Shapes::default());
        Self { at, size, x, y, inside, marks, named: Vec::new(), legend: Vec::new() }
    }

    /// A chart in which a unit is as long across as it is up: around these values, the shorter axis made longer.
    pub(super) fn equal(at: Point, size: (f64, f64), x: Scale, y: Scale) -> Self {
        let across = (size.0 - LEFT - RIGHT) / (size.1 - ABOVE - BELOW);
        let ((left, right), (bottom, top)) = (x.ends(), y.ends());
        let up = (top - bottom).max((right - left) / across);
        let about = |low: f64, high: f64, length: f64| {
            let middle = 0.5 * (low + high);
            Scale::between(middle - 0.5 * length, middle + 0.5 * length)
        };
        Self::new(at, size, about(left, right, up * across), about(bottom, top, up))
    }

    fn frame(&self) -> (Point, Point) {
        let (x, y) = self.at;
        ((x + LEFT, y + ABOVE), (x + self.size.0 - RIGHT, y + self.size.1 - BELOW))
    }

    fn across(&self, x: f64) -> f64 {
        let ((left, _), (right, _)) = self.frame();
        left + self.x.place(x).clamp(-10.0, 10.0) * (right - left)
    }

    fn up(&self, y: f64) -> f64 {
        let ((_, top), (_, bottom)) = self.frame();
        bottom - self.y.place(y).clamp(-10.0, 10.0) * (bottom - top)
    }

    fn pixels(&self, points: &[Point]) -> Vec<Point> {
        points
            .iter()
            .filter(|(x, y)| x.is_finite() && y.is_finite())
            .map(|&(x, y)| (self.across(x), self.up(y)))
            .collect()
    }

    /// A line through values.
    pub(super) fn line(&mut self, class: &str, points: &[Point]) {
        let points = self.pixels(points);
        self.inside.line(class, &points);
    }

    /// A dot at each value.
    pub(super) fn dots(&mut self, class: &str, points: &[Point]) {
        for point in self.pixels(points) {
            self.inside.dot(class, point, 2.6);
        }
    }

    /// A vertical bar from one value to another.
    pub(super) fn bar(&mut self, class: &str, x: f64, low: f64, high: f64) {
        let points = self.pixels(&[(x, low), (x, high)]);
        self.inside.line(class, &points);
    }

    /// The area between two lines over the same x: (x, low, high).
    pub(super) fn band(&mut self, class: &str, rows: &[(f64, f64, f64)]) {
        let lower = rows.iter().map(|&(x, low, _)| (x, low));
        let upper = rows.iter().rev().map(|&(x, _, high)| (x, high));
        let outline: Vec<Point> = lower.chain(upper).collect();
        let outline = self.pixels(&outline);
        self.inside.area(class, &outline);
    }

    /// Everything between two x, from bottom to top.
    pub(super) fn stripe(&mut self, class: &str, from: f64, to: f64) {
        let ((left, top), (right, bottom)) = self.frame();
        let (from, to) = (self.across(from).clamp(left, right), self.across(to).clamp(left, right));
        // A second of a day is still seen.
        self.inside.rectangle(class, (from, top), (to.max(from + 2.5), bottom));
    }

    /// A point with its name above it or below, to the right of it or to the left: where it is inside
    /// the frame and on no other name.
    pub(super) fn mark(&mut self, class: &str, (x, y): Point, below: bool, name: &str) {
        let ((left, top), (right, bottom)) = self.frame();
        let (px, py) = (self.across(x), self.up(y));
        if !(left..=right).contains(&px) || !(top..=bottom).contains(&py) {
            return;
        }
        self.marks.dot(class, (px, py), 4.5);
        let width = LETTER.0 * name.chars().count() as f64;
        let (over, under) = (py - 8.0, py + 20.0);
        let heights = if below { [under, over] } else { [over, under] };
        let places = [px + 9.0, px - 9.0 - width]
            .into_iter()
            .flat_map(|x| heights.map(|y| ((x, y - LETTER.1), (x + width, y + 3.0))));
        let inside = |((x, y), (to_x, to_y)): &(Point, Point)| {
            *x >= left && *to_x <= right && *y >= top && *to_y <= bottom
        };
        let free = |(from, to): &(Point, Point)| {
            self.named.iter().all(|(other_from, other_to)| {
                to.0 < other_from.0
                    || other_to.0 < from.0
                    || to.1 < other_from.1
                    || other_to.1 < from.1
            })
        };
        let mut fitting = places.filter(inside);
        // A name that finds no room beside its point stands across it.
        let fallback = fitting.clone().next().unwrap_or_else(|| {
            let x = (right - width).min(px + 9.0).max(left);
            let y = heights[0].clamp(top + LETTER.1, bottom - 4.0);
            ((x, y - LETTER.1), (x + width, y + 3.0))
        });
        let (from, to) = fitting.find(free).unwrap_or(fallback);
        self.named.push((from, to));
        let (x, anchor) = if to.0 < px { (to.0, Anchor::End) } else { (from.0, Anchor::Start) };
        let at = (x, to.1 - 3.0);
        self.marks.words("halo", at, anchor, name);
        self.marks.words("mark-name", at, anchor, name);
    }

    /// Names a class of lines, or of areas, in the legend.
    pub(super) fn name(&mut self, class: &'static str, name: &str) {
        self.legend.push(Key { class, name: name.to_owned() });
    }

    /// The whole chart; `id` is its own in the drawing.
    pub(super) fn finish(self, id: &str, title: &str, x_name: &str, y_name: &str) -> Drawn {
        let (from, to) = self.frame();
        let mut shapes = Shapes::default();
        shapes.words("title", (from.0, from.1 - 13.0), Anchor::Start, title);
        self.grid(&mut shapes);
        shapes.append_within(&self.inside, id, from, to);
        shapes.rectangle("frame", from, to);
        shapes.append(&self.marks);
        let middle = 0.5 * (from.0 + to.0);
        shapes.words("label", (middle, to.1 + 38.0), Anchor::Middle, x_name);
        shapes.upwards("label", (self.at.0 + 16.0, 0.5 * (from.1 + to.1)), y_name);
        let mut x = to.0;
        for key in self.legend.iter().rev() {
            x -= 7.2 * key.name.chars().count() as f64;
            shapes.words("label", (x, from.1 - 13.0), Anchor::Start, &key.name);
            x -= 26.0;
            key.draw(&mut shapes, (x, from.1 - 17.0));
            x -= 12.0;
        }
        Drawn { shapes, legend: self.legend }
    }

    fn grid(&self, shapes: &mut Shapes) {
        let ((left, top), (right, bottom)) = self.frame();
        let mut last = f64::NEG_INFINITY;
        for tick in self.x.ticks() {
            let x = self.across(tick.value);
            let class = if tick.label.is_empty() { "minor" } else { "grid" };
            shapes.line(class, &[(x, top), (x, bottom)]);
            if !tick.label.is_empty() && x - last >= ACROSS {
                shapes.words("tick", (x, bottom + 17.0), Anchor::Middle, &tick.label);
                last = x;
            }
        }
        for tick in self.y.ticks() {
            let y = self.up(tick.value);
            let class = if tick.label.is_empty() { "minor" } else { "grid" };
            shapes.line(class, &[(left, y), (right, y)]);
            shapes.words("tick", (left - 7.0, y + 4.0), Anchor::End, &tick.label);
        }
    }
}
