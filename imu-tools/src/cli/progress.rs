//! A progress bar on a terminal, and silence anywhere else.

use indicatif::{ProgressBar, ProgressFinish, ProgressStyle};

/// A bar on the standard error towards `total` units; it draws nothing unless that is a terminal,
/// and leaves nothing behind when it is dropped.
pub(super) fn bar(total: u64, doing: &'static str) -> ProgressBar {
    let style = ProgressStyle::with_template("{msg} {wide_bar} {percent:>3} % {eta}")
        .unwrap_or_else(|_| ProgressStyle::default_bar());
    let clear = ProgressFinish::AndClear;
    ProgressBar::new(total).with_style(style).with_message(doing).with_finish(clear)
}
