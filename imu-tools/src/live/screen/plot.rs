//! The Allan deviation of a sensor in dots of Braille: curves of x, y and z with their letters, intervals
//! as upright lines, both scales logarithmic.

use imu_core::allan::interval;
use ratatui::Frame;
use ratatui::layout::Rect;
use ratatui::style::Color;
use ratatui::symbols::Marker;
use ratatui::text::Line as Text;
use ratatui::widgets::canvas::{Canvas, Context, Line};
use ratatui::widgets::{Block, Borders};

use crate::calibrate::SensorNoise;

const LETTERS: [&str; 3] = ["x", "y", "z"];
/// Colours of every terminal's own palette, which suit its background.
const COLOURS: [Color; 3] = [Color::Red, Color::Green, Color::Blue];
/// Confidence of the intervals.
const CONFIDENCE: f64 = 0.9;

/// A deviation with its interval, all as decimal logarithms.
struct Point {
    tau: f64,
    value: f64,
    low: f64,
    high: f64,
}

fn curve(sensor: &SensorNoise, axis: usize) -> Vec<Point> {
    let points = sensor.deviation.iter().filter_map(|d| {
        let (octave, edf) = (d.octaves.get(axis)?, *d.edf.get(axis)?);
        if octave.differences == 0 || octave.variance <= 0.0 {
            return None;
        }
        let (low, high) = interval(octave.variance, edf, CONFIDENCE);
        let value = 0.5 * octave.variance.log10();
        // An interval without an end says nothing: the value stands for it.
        let end = |end: f64| Some(0.5 * end.log10()).filter(|end| end.is_finite()).unwrap_or(value);
        Some(Point { tau: d.tau_s.log10(), value, low: end(low), high: end(high) })
    });
    points.filter(|point| point.tau.is_finite() && point.value.is_finite()).collect()
}

/// Draws one sensor.
pub(super) fn draw(frame: &mut Frame<'_>, area: Rect, sensor: &SensorNoise, colours: bool) {
    let curves = [0, 1, 2].map(|axis| curve(sensor, axis));
    let all = || curves.iter().flatten();
    let least = |of: fn(&Point) -> f64| all().map(of).fold(f64::INFINITY, f64::min);
    let most = |of: fn(&Point) -> f64| all().map(of).fold(f64::NEG_INFINITY, f64::max);
    let (left, right) = (least(|p| p.tau), most(|p| p.tau));
    // Intervals of the longest averaging times may be wide: a decade of them is enough.
    let (bottom, top) = (least(|p| p.low.max(p.value - 0.5)), most(|p| p.high.min(p.value + 0.5)));
    let unit = sensor.kind.unit();
    let short = format!(" {} Allan deviation, {unit}", sensor.kind.name());
    let whole = format!("{short}, over s ");
    // The corner takes a column.
    let fits = whole.chars().count() < usize::from(area.width);
    let title = if fits { whole } else { short };
    let block = Block::new().borders(Borders::TOP | Borders::LEFT).title(title);
    if !(left < right && bottom.is_finite() && top.is_finite()) {
        frame.render_widget(block, area);
        return;
    }
    // Room for the numbers of the scale, and for the last letter.
    let column = (right - left) / f64::from(area.width.max(20));
    let x = [left - 6.0 * column, right + 2.0 * column];
    let margin = 0.06 * (top - bottom).max(0.5);
    let y = [bottom - 2.0 * margin, top + margin];
    let colour = |axis: usize| if colours { COLOURS[axis] } else { Color::Reset };
    let canvas =
        Canvas::default().block(block).marker(Marker::Braille).x_bounds(x).y_bounds(y).paint(
            |canvas| {
                for (axis, points) in curves.iter().enumerate() {
                    draw_curve(canvas, points, colour(axis));
                }
                canvas.layer();
                print_scales(canvas, [x[0], left, x[1]], y);
                for (axis, points) in curves.iter().enumerate() {
                    print_letters(canvas, points, axis, colour(axis));
                }
            },
        );
    frame.render_widget(canvas, area);
}

fn draw_curve(canvas: &mut Context<'_>, points: &[Point], colour: Color) {
    for (a, b) in points.iter().zip(points.iter().skip(1)) {
        canvas.draw(&Line::new(a.tau, a.value, b.tau, b.value, colour));
    }
    for point in points {
        canvas.draw(&Line::new(point.tau, point.low, point.tau, point.high, colour));
    }
}

/// The letter of an axis on every third point of its curve, and on the last: other axes have theirs between.
fn print_letters(canvas: &mut Context<'_>, points: &[Point], axis: usize, colour: Color) {
    let Some(letter) = LETTERS.get(axis) else { return };
    let last = points.len().saturating_sub(1);
    for (at, point) in points.iter().enumerate() {
        if at % 3 == axis || at == last {
            let text = Text::styled(*letter, ratatui::style::Style::new().fg(colour));
            canvas.print(point.tau, point.value, text);
        }
    }
}

/// Powers of ten along the left and the lower edge, whose corner is left free.
fn print_scales(canvas: &mut Context<'_>, [edge, left, right]: [f64; 3], y: [f64; 2]) {
    let decades = |[from, to]: [f64; 2]| from.ceil() as i32..=to.floor() as i32;
    for power in decades(y) {
        canvas.print(edge, f64::from(power), format!("1e{power}"));
    }
    for power in decades([left, right]) {
        canvas.print(f64::from(power), y[0], format!("1e{power}"));
    }
}
