use ratatui::Terminal;
use ratatui::backend::TestBackend;

use super::*;
use crate::calibrate::Options;
use crate::live::link::{Link, LinkClock};
use crate::live::session::Session;
use crate::recording::{Block, Source as _, Temperature};
use crate::scene::{Preset, Scene, Simulator};

/// Ten minutes of a sensor, and what its link says.
fn view() -> View {
    let scene = Scene { duration_ns: 600_000_000_000, ..Preset::Mid.scene() };
    let mut source = Simulator::new(&scene).unwrap();
    let mut session = Session::new("ttyUSB0", &Options::default());
    let mut block = Block::default();
    while source.next_block(&mut block).unwrap() {
        block.temperature.push(Temperature { stamp_ns: 0, celsius: 31.25 });
        session.take(&mut block);
    }
    let clock = LinkClock { rate_hz: 200.01, lost: 3, ..LinkClock::default() };
    session.view(&Link {
        name: "/dev/ttyUSB0 \u{1b}[31m".into(),
        bytes: 20_000,
        refused: 100,
        clock: Some(clock),
        ..Link::default()
    })
}

fn screen(view: &View, width: u16, height: u16, colours: bool) -> (String, bool) {
    let mut terminal = Terminal::new(TestBackend::new(width, height)).unwrap();
    let style = Style { colours, within: 0.1 };
    terminal.draw(|frame| draw(frame, view, style, "mark 1 at 5.0 s")).unwrap();
    let buffer = terminal.backend().buffer();
    let text = buffer.content().chunks(usize::from(width));
    let lines: Vec<String> =
        text.map(|row| row.iter().map(|cell| cell.symbol()).collect()).collect();
    let coloured = buffer.content().iter().any(|cell| {
        ![ratatui::style::Color::Reset].contains(&cell.fg)
            || cell.bg != ratatui::style::Color::Reset
    });
    (lines.join("\n"), coloured)
}

#[test]
fn all_that_is_known_is_on_screens_of_any_size() {
    let view = view();
    for (width, height) in [(80, 24), (200, 60), (120, 30)] {
        let (text, coloured) = screen(&view, width, height, true);
        for wanted in [
            "imu live  /dev/ttyUSB0",
            "10 min",
            "gyroscope Allan deviation, rad/s",
            "accelerometer Allan deviation, m/s²",
            "gyroscope N",
            "accelerometer K",
            "rad/s/√Hz",
            "±",
            "200.0100 Hz",
            "guessed from arrivals",
            "100 bytes refused (0.50 %)",
            "31.2 °C",
            "mark 1 at 5.0 s",
            "s save   p pause   m mark   q quit",
            "1e0 ",
        ] {
            assert!(text.contains(wanted), "{wanted} on {width}x{height}:\n{text}");
        }
        assert!(coloured);
        let braille = text.chars().filter(|c| ('\u{2801}'..='\u{28ff}').contains(c)).count();
        assert!(braille > 60, "{braille} cells of curves:\n{text}");
        assert!(!text.contains('\u{1b}'), "nothing steers the terminal");
    }
}

#[test]
fn without_colours_letters_tell_axes_apart() {
    let (text, coloured) = screen(&view(), 80, 24, false);
    assert!(!coloured);
    for letter in ['x', 'y', 'z'] {
        let rows = text.lines().skip(2).take(12);
        let on_curves = rows.flat_map(str::chars).filter(|c| *c == letter).count();
        assert!(on_curves >= 3, "{letter}: {on_curves}\n{text}");
    }
}

#[test]
fn small_and_empty_screens_do_no_harm() {
    let nothing = Session::new("it", &Options::default()).view(&Link::default());
    let (text, _) = screen(&nothing, 80, 24, true);
    assert!(text.contains("waiting for samples"), "{text}");
    let view = view();
    for (width, height) in [(1, 1), (10, 3), (30, 8), (80, 5)] {
        let _ = screen(&view, width, height, true);
        let _ = screen(&nothing, width, height, true);
    }
}
