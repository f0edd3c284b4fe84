//! A progress bar on a terminal, and silence anywhere else.

use std::time::Duration;

use indicatif::{ProgressBar, ProgressFinish, ProgressStyle};

/// A bar on the standard error towards `total` samples; it draws nothing unless that is a terminal,
/// and leaves nothing behind when it is dropped.
pub(super) fn bar(total: u64, doing: &'static str) -> ProgressBar {
    let style = ProgressStyle::with_template(
        "{msg} {wide_bar} {human_pos}/{human_len} samples {per_sec} {eta}",
    )
    .unwrap_or_else(|_| ProgressStyle::default_bar());
    let clear = ProgressFinish::AndClear;
    ProgressBar::new(total).with_style(style).with_message(doing).with_finish(clear)
}

/// Something that turns, for work whose length nobody knows.
pub(super) fn turning(doing: &'static str) -> ProgressBar {
    let style = ProgressStyle::with_template("{msg} {spinner} {elapsed}")
        .unwrap_or_else(|_| ProgressStyle::default_bar());
    let turning = ProgressBar::new_spinner().with_style(style).with_message(doing);
    turning.enable_steady_tick(Duration::from_millis(200));
    turning.with_finish(ProgressFinish::AndClear)
}

/// The same for records.
pub(super) fn records(total: u64, doing: &'static str) -> ProgressBar {
    let style = ProgressStyle::with_template("{msg} {wide_bar} {pos}/{len} records {eta}")
        .unwrap_or_else(|_| ProgressStyle::default_bar());
    let clear = ProgressFinish::AndClear;
    ProgressBar::new(total).with_style(style).with_message(doing).with_finish(clear)
}

/// The same for bytes read; a spinner where their number is not known.
pub(super) fn bytes(total: Option<u64>, doing: &'static str) -> ProgressBar {
    let template = match total {
        Some(_) => "{msg} {wide_bar} {bytes}/{total_bytes} {bytes_per_sec} {eta}",
        None => "{msg} {spinner} {bytes} {bytes_per_sec}",
    };
    let style =
        ProgressStyle::with_template(template).unwrap_or_else(|_| ProgressStyle::default_bar());
    let bar = match total {
        Some(total) => ProgressBar::new(total),
        None => ProgressBar::new_spinner(),
    };
    bar.with_style(style).with_message(doing).with_finish(ProgressFinish::AndClear)
}
