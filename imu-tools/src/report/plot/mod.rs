//! Pictures of a calibration: the same shapes as SVG, in a page, and as PNG.
//!
//! No picture needs a font of the system or the network: *Imu Sans* (a subset of DejaVu Sans; its
//! license stands beside it in `assets`) is part of the program.
//!
//! ```
//! use imu_tools::calibrate::{Options, calibrate};
//! use imu_tools::report::plot;
//! use imu_tools::scene::{Preset, Scene, Simulator};
//!
//! let scene = Scene { duration_ns: 60_000_000_000, ..Preset::Mid.scene() };
//! let source = Box::new(Simulator::new(&scene)?);
//! let calibration = calibrate(source, "simulated", &Options::default(), |_| {})?;
//! let picture = plot::allan(&calibration);
//! assert!(picture.svg().starts_with("<svg"));
//! # Ok::<(), imu_tools::error::Error>(())
//! ```

mod allan;
mod chart;
mod curve;
mod integration;
mod png;
mod residual;
mod scale;
mod signal;
mod spline;
mod svg;
mod tradeoff;

pub use allan::allan;
pub(super) use allan::lowest;
pub use curve::{curve, curve_residual};
pub use integration::{errors, trajectory};
pub use residual::residual;
pub use signal::signal;
pub use spline::{spline_orders, spline_price};
pub use tradeoff::{rules, tradeoff};

use base64::Engine as _;
use base64::prelude::BASE64_STANDARD as STANDARD;
use chart::{Drawn, Key};
use svg::{Anchor, Shapes, escape};

/// The font of all pictures.
const FONT: &[u8] = include_bytes!("../../../assets/imu-sans.ttf");

/// Colours and strokes of the classes on paper.
pub(super) const STYLE: &str = include_str!("../../../assets/plot.css");

/// Width of all pictures, pixels.
const WIDTH: f64 = 960.0;

/// The classes of the three axes.
const AXES: [&str; 3] = ["x", "y", "z"];

/// A picture.
#[derive(Clone, Debug)]
pub struct Figure {
    height: f64,
    /// What there is to see, in a sentence.
    description: String,
    shapes: Shapes,
    /// What its charts name, each once.
    legend: Vec<Key>,
}

impl Figure {
    /// Charts of this height under one another, one for each of `count`.
    fn new(description: String, charts: impl Iterator<Item = Drawn>, each: f64) -> Self {
        Self::stacked(description, charts.map(|chart| (chart, each)))
    }

    /// Charts under one another, each with its height.
    fn stacked(description: String, charts: impl Iterator<Item = (Drawn, f64)>) -> Self {
        let (mut shapes, mut legend) = (Shapes::default(), Vec::new());
        let mut height = 0.0;
        for (chart, each) in charts {
            shapes.append(&chart.shapes);
            for key in chart.legend {
                if !legend.contains(&key) {
                    legend.push(key);
                }
            }
            height += each;
        }
        Self { height, description, shapes, legend }
    }

    /// What its colours mean, each an element of its own, which a narrow page can wrap.
    pub fn keys(&self) -> impl Iterator<Item = String> {
        self.legend.iter().map(|key| {
            let mut shapes = Shapes::default();
            key.draw(&mut shapes, (0.0, 9.0));
            shapes.words("label", (24.0, 13.5), Anchor::Start, &key.name);
            let width = 30.0 + 7.4 * key.name.chars().count() as f64;
            format!(
                "<svg viewBox=\"0 0 {width} 18\" width=\"{width}\" height=\"18\" \
                 font-family=\"Imu Sans, sans-serif\">{}</svg>",
                shapes.text()
            )
        })
    }

    /// Whether there is nothing to see.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.height == 0.0
    }

    /// A file of its own, on white, with its font.
    #[must_use]
    pub fn svg(&self) -> String {
        let style = format!(
            "<style>@font-face {{ font-family: \"Imu Sans\"; src: url(data:font/ttf;base64,{}); }}\n\
             {STYLE}</style>\n<rect class=\"paper\" width=\"100%\" height=\"100%\"/>\n",
            font_base64()
        );
        self.element(&style)
    }

    /// An element of a page, whose style sheet decides the colours.
    #[must_use]
    pub fn inline(&self) -> String {
        self.element("")
    }

    /// The same picture in pixels, two for one, on white.
    ///
    /// # Errors
    /// A sentence, when there is not enough memory for it.
    pub fn png(&self) -> Result<Vec<u8>, crate::error::Error> {
        let style = format!(
            "<style>{STYLE}</style>\n<rect class=\"paper\" width=\"100%\" height=\"100%\"/>\n"
        );
        png::render(&self.element(&style), 2.0)
    }

    fn element(&self, start: &str) -> String {
        format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {WIDTH} {}\" \
             width=\"{WIDTH}\" height=\"{}\" font-family=\"Imu Sans, sans-serif\" role=\"img\">\n\
             <title>{}</title>\n{start}{}</svg>\n",
            self.height,
            self.height,
            escape(&self.description),
            self.shapes.text()
        )
    }
}

/// The font in the letters of base64, as a style sheet holds it.
pub(super) fn font_base64() -> String {
    STANDARD.encode(FONT)
}
