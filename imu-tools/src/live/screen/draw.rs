//! What stands where: a title, a plot a sensor, the numbers, the link, what was said last, the keys.

use ratatui::Frame;
use ratatui::layout::{Constraint, Layout, Rect};
use ratatui::style::Modifier;
use ratatui::text::{Line, Span};
use ratatui::widgets::Paragraph;

use super::{Style, plot};
use crate::live::session::View;
use crate::report::harmless;
use crate::report::live::{Number, hint, link, numbers, sensors};
use crate::report::table::duration;

/// The keys.
const KEYS: &str = " s save   p pause   m mark   q quit with the report";

/// Draws all of it.
pub fn draw(frame: &mut Frame<'_>, view: &View, style: Style, said: &str) {
    let rows = numbers(view, style.within);
    let link = wrap(&link(view), frame.area().width);
    let areas = Layout::vertical([
        Constraint::Length(1),
        Constraint::Min(5),
        Constraint::Length(rows.len().max(1) as u16 + 1),
        Constraint::Length(link.len() as u16),
        Constraint::Length(1),
        Constraint::Length(1),
    ]);
    let [title, plots, table, state, message, keys] = areas.areas(frame.area());
    frame.render_widget(Paragraph::new(heading(view)), title);
    draw_plots(frame, plots, view, style);
    frame.render_widget(Paragraph::new(lines(&rows, view)), table);
    let state_lines: Vec<Line<'_>> = link.into_iter().map(Line::from).collect();
    frame.render_widget(Paragraph::new(state_lines), state);
    frame.render_widget(Paragraph::new(format!(" {}", harmless(said, ""))), message);
    let bold =
        Span::from(KEYS).style(ratatui::style::Style::new().add_modifier(Modifier::REVERSED));
    frame.render_widget(Paragraph::new(Line::from(bold)), keys);
}

/// What is calibrated, for how long, and what the sensor does.
fn heading(view: &View) -> Line<'static> {
    let span = duration(view.snapshot.calibration.span_s);
    let name = harmless(&view.link.name, "").into_owned();
    let mut parts = vec![
        Span::from(format!(" imu live  {name}  ")),
        Span::from(span).style(ratatui::style::Style::new().add_modifier(Modifier::BOLD)),
    ];
    if let Some(hint) = hint(view) {
        parts.push(Span::from(format!("  {}", harmless(&hint, ""))));
    }
    Line::from(parts)
}

fn draw_plots(frame: &mut Frame<'_>, area: Rect, view: &View, style: Style) {
    let shown: Vec<_> = sensors(view).filter(|sensor| sensor.deviation.len() > 1).collect();
    if shown.is_empty() {
        let [came, _] = view.samples;
        let text = if came == 0 { " waiting for samples" } else { " waiting for more samples" };
        frame.render_widget(Paragraph::new(text), area);
        return;
    }
    let columns = Layout::horizontal(vec![Constraint::Fill(1); shown.len()]).split(area);
    for (sensor, column) in shown.into_iter().zip(columns.iter()) {
        plot::draw(frame, *column, sensor, style.colours);
    }
}

/// N and K as a table.
fn lines(rows: &[Number], view: &View) -> Vec<Line<'static>> {
    let wide = |of: fn(&Number) -> &String| {
        rows.iter().map(|row| of(row).chars().count()).max().unwrap_or(0)
    };
    let (name, value, half) = (wide(|r| &r.name), wide(|r| &r.value), wide(|r| &r.half));
    let mut lines: Vec<Line<'static>> = rows
        .iter()
        .map(|row| {
            let Number { name: n, value: v, half: h, when } = row;
            Line::from(format!(" {n:<name$}  {v:<value$}  {h:>half$}  {when}"))
        })
        .collect();
    if lines.is_empty() {
        let refusal = view.snapshot.refusal.as_ref().map(ToString::to_string).unwrap_or_default();
        lines.push(Line::from(format!(" {}", harmless(&refusal, ""))));
    }
    lines
}

/// Parts with semicolons between, in lines of this width.
fn wrap(parts: &[String], width: u16) -> Vec<String> {
    let mut lines = vec![String::from(" ")];
    for part in parts {
        let Some(last) = lines.last_mut() else { break };
        let length = last.chars().count() + 3 + part.chars().count();
        if last.len() > 1 && length > usize::from(width) {
            lines.push(format!(" {part}"));
        } else {
            if last.len() > 1 {
                last.push_str(" | ");
            }
            last.push_str(part);
        }
    }
    lines
}
