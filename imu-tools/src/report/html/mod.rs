//! The report as one page: no script, no network, light and dark, and made to be printed.
//!
//! ```
//! use imu_tools::calibrate::{Options, calibrate};
//! use imu_tools::report::html;
//! use imu_tools::scene::{Preset, Scene, Simulator};
//!
//! let scene = Scene { duration_ns: 60_000_000_000, ..Preset::Mid.scene() };
//! let source = Box::new(Simulator::new(&scene)?);
//! let options = Options { keep_signal: true, ..Options::default() };
//! let calibration = calibrate(source, "simulated", &options, |_| {})?;
//! assert!(html::page(&calibration).starts_with("<!DOCTYPE html>"));
//! # Ok::<(), imu_tools::error::Error>(())
//! ```

mod demo;
mod words;

pub use demo::demo;

use imu_core::allan::Parameter;
use maud::{DOCTYPE, Markup, PreEscaped, html};

use super::formats::Form;
use super::json::AXES;
use super::plot::{self, Figure, font_base64};
use super::table::{duration, short};
use super::{Quantity, Twin, harmless};
use crate::calibrate::verdict::interval;
use crate::calibrate::{Calibration, SensorNoise};

/// Colours of the page and of the pictures in it.
const STYLE: &str = include_str!("../../../assets/report.css");

/// The whole page.
#[must_use]
pub fn page(calibration: &Calibration) -> String {
    let sensors: Vec<&SensorNoise> =
        [&calibration.gyroscope, &calibration.accelerometer].into_iter().flatten().collect();
    let body = html! {
        h1 { "IMU noise" }
        p.lead { (words::recorded(calibration)) }
        p.small { (words::TERMS) }
        (verdict(&sensors))
        (warnings(calibration))
        @for sensor in &sensors { (numbers(sensor)) }
        (pictures(calibration))
        (filters(calibration, &sensors))
        h2 { "What to record next time" }
        ul { @for sentence in words::next_time(&sensors) { li { (sentence) } } }
    };
    document(&format!("IMU noise: {}", calibration.path), &body)
}

/// A page of its own.
fn document(title: &str, body: &Markup) -> String {
    let font = format!(
        "@font-face {{ font-family: \"Imu Sans\"; src: url(data:font/ttf;base64,{}); }}",
        font_base64()
    );
    let markup = html! {
        (DOCTYPE)
        html lang="en" {
            head {
                meta charset="utf-8";
                meta name="viewport" content="width=device-width, initial-scale=1";
                title { (title) }
                style { (PreEscaped(font)) (PreEscaped(plot::STYLE)) (PreEscaped(STYLE)) }
            }
            body {
                (body)
                footer {
                    p {
                        "N and K are continuous-time densities. Lettering: Imu Sans, a subset of DejaVu Sans."
                    }
                }
            }
        }
    };
    harmless(&markup.into_string(), "\n").into_owned()
}

fn verdict(sensors: &[&SensorNoise]) -> Markup {
    html! {
        h2 { "Is it good enough?" }
        p.lead { (words::overall(sensors)) }
        @for sensor in sensors {
            p { b { (words::capital(sensor.kind.name())) ". " } (words::verdict(sensor)) }
        }
    }
}

fn warnings(calibration: &Calibration) -> Markup {
    html! {
        @if !calibration.warnings.is_empty() {
            h2 { "Warnings" }
            ul.warnings { @for warning in &calibration.warnings { li { (warning) } } }
        }
        @if !calibration.remarks.is_empty() {
            p.small { "Taken for granted: " (calibration.remarks.join("; ")) "." }
        }
    }
}

/// The terms of a sensor, by axis and all together.
fn numbers(sensor: &SensorNoise) -> Markup {
    let kind = sensor.kind;
    html! {
        h2 { (words::capital(kind.name())) }
        p { (words::sampling(sensor)) }
        @for (quantity, of) in Quantity::fitted(sensor) {
            h3 { (words::capital(quantity.name())) }
            @if let Some(pooled) = of(&sensor.pooled) {
                p { (words::meaning(quantity, pooled, sensor)) }
            }
            div.wide {
                table {
                    thead {
                        tr {
                            th { "axis" }
                            th { (quantity.unit()) }
                            th { "90 % interval" }
                            @for twin in twins(quantity) { th { (twin.unit) } }
                        }
                    }
                    tbody {
                        @for (name, axis) in AXES.iter().zip(&sensor.axes) {
                            (row(name, of(axis), quantity))
                        }
                        (row("all", of(&sensor.pooled), quantity))
                    }
                }
            }
            @if let Some(sentence) = words::row_of_all(sensor.axes.each_ref().map(of), of(&sensor.pooled)) {
                p.small { (sentence) }
            }
        }
        p { (words::lowest_point(sensor)) }
    }
}

/// All units that datasheets use for a parameter.
fn twins(quantity: Quantity) -> impl Iterator<Item = Twin> {
    [quantity.twin()].into_iter().chain(quantity.further_twins().iter().copied())
}

fn row(name: &str, parameter: Option<Parameter>, quantity: Quantity) -> Markup {
    let twins = || twins(quantity);
    let Some(parameter) = parameter else {
        return html! {
            tr.all[name == "all"] {
                td { (name) }
                td { "not asked for" }
                td {}
                @for _ in twins() { td {} }
            }
        };
    };
    html! {
        tr.all[name == "all"] {
            td { (name) }
            @match parameter {
                Parameter::Observable { value, low90, high90, .. } => {
                    td { (short(value)) }
                    td {
                        @if high90.is_finite() {
                            @let (low, high) = interval(value, low90, high90);
                            (short(low)) " to " (short(high))
                        } @else { "a reading, none" }
                    }
                    @for twin in twins() { td { (short(value * twin.per_si)) } }
                }
                Parameter::NotObservable { upper90, .. } if upper90.is_finite() => {
                    td { "not observable" }
                    td { "below " (short(upper90)) }
                    @for twin in twins() { td { "below " (short(upper90 * twin.per_si)) } }
                }
                Parameter::NotObservable { .. } => {
                    td { "not observable" }
                    td { "nothing is known" }
                    @for _ in twins() { td { "–" } }
                }
            }
        }
    }
}

fn pictures(calibration: &Calibration) -> Markup {
    html! {
        h2 { "How to read the plots" }
        (picture(&plot::allan(calibration), words::ALLAN))
        (picture(&plot::residual(calibration), words::RESIDUAL))
        (picture(&plot::signal(calibration), words::SIGNAL))
    }
}

fn picture(figure: &Figure, caption: &str) -> Markup {
    html! {
        @if !figure.is_empty() {
            figure {
                p.hint { "Wider than this screen: the plot scrolls sideways." }
                div.plot { (PreEscaped(figure.inline())) }
                div.keys { @for key in figure.keys() { (PreEscaped(key)) } }
                figcaption { (caption) }
            }
        }
    }
}

fn filters(calibration: &Calibration, sensors: &[&SensorNoise]) -> Markup {
    let forms = [
        ("Kalibr", "imu.yaml", Form::Kalibr),
        ("VINS-Mono, VINS-Fusion", "in the configuration", Form::Vins),
        ("OpenVINS", "kalibr_imu_chain.yaml", Form::OpenVins),
        ("ORB-SLAM3", "in the settings", Form::OrbSlam3),
        ("ROS", "covariances of sensor_msgs/Imu", Form::RosCovariance),
    ];
    html! {
        h2 { "What to put into your filter" }
        p { (words::HERE) }
        div.wide.factors {
            table {
                thead {
                    tr {
                        th {}
                        th { "advice: multiply by" }
                        th { "upper end of its interval" }
                        th { "noisiest axis" }
                        th { "vibration, drift" }
                    }
                }
                tbody {
                    @for row in sensors.iter().flat_map(|sensor| words::factors(sensor)) {
                        tr { @for cell in row { td { (cell) } } }
                    }
                }
            }
        }
        p { b { "Multiply what the blocks hold by this advice before you use it." } (words::ADVICE) }
        p { "What was found beside white noise and a random walk:" }
        ul {
            @for sentence in words::found(sensors, |sensor| warned(calibration, sensor)) {
                li { (sentence) }
            }
        }
        @for (program, file, form) in forms {
            details open {
                summary { (program) " (" (file) ")" }
                pre { (form.write(calibration)) }
            }
        }
    }
}

/// Whether a warning speaks of a sensor.
fn warned(calibration: &Calibration, sensor: &SensorNoise) -> bool {
    calibration.warnings.iter().any(|warning| warning.starts_with(sensor.kind.name()))
}

/// A span of time as words.
fn span(seconds: f64) -> String {
    duration(seconds)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::calibrate::verdict::NextRecord;
    use crate::calibrate::{Options, calibrate};
    use crate::scene::{Preset, Scene, Simulator};

    fn calibration(seconds: u64, name: &str) -> Calibration {
        let scene = Scene { duration_ns: seconds * 1_000_000_000, ..Preset::Mid.scene() };
        let source = Box::new(Simulator::new(&scene).unwrap());
        let options = Options { keep_signal: true, ..Options::default() };
        calibrate(source, name, &options, |_| {}).unwrap()
    }

    #[test]
    fn a_page_answers_and_stays_small_and_alone() {
        let page = page(&calibration(600, "a <b>&\x1b\u{85}.bag"));
        for words in [
            "a &lt;b&gt;&amp;\\u001b\\u0085.bag, 10 min long",
            "White noise is known well",
            "Is it good enough?",
            "How to read the plots",
            "What to put into your filter",
            "What to record next time",
            "angle random walk",
            "Integrated over an hour",
        ] {
            assert!(page.contains(words) || page.contains(&words::capital(words)), "{words}");
        }
        assert!(page.len() < 1_000_000, "{}", page.len());
        // Nothing is fetched: the only address is the name of SVG.
        assert!(page.matches("http").count() == page.matches("http://www.w3.org/2000/svg").count());
        assert!(!page.contains("<script") && !page.contains("NaN") && !page.contains("inf "));
    }

    #[test]
    fn what_was_found_is_not_nothing() {
        let mut calibration = calibration(600, "a");
        let clean = page(&calibration);
        assert!(clean.contains("°/s/√Hz") && clean.contains("no recording at rest can know"));
        assert_eq!(clean.matches("<details open>").count(), 5);
        assert!(!clean.contains("more than was fitted"));
        calibration.gyroscope.as_mut().unwrap().misfit = [true, false, true];
        let page = page(&calibration);
        assert!(page.contains("gyroscope: more than was fitted, on axes x and z"), "{page}");
        assert!(page.contains("or more: see the warnings"), "{page}");
        assert!(!page.contains("gyroscope: nothing"), "{page}");
    }

    /// Warning, Kalibr's file and the end of the page name the same length.
    #[test]
    fn one_advice_of_how_long_to_record() {
        let mut calibration = calibration(120, "a");
        let sensor = calibration.gyroscope.as_mut().unwrap();
        let bound = Parameter::NotObservable { upper90: 1e-3, record_at_least_s: 300.0 };
        sensor.pooled.random_walk = bound;
        let enough_s = NextRecord::enough_s(sensor).expect("it is too short");
        let advice = format!("record at least {}", span(enough_s));
        let page = page(&calibration);
        assert!(page.matches(&advice).count() >= 2, "{advice}: {page}");
    }

    /// Seconds, a constant: pages and pictures say what is not known, and none has a number that is
    /// none.
    #[test]
    fn little_is_said_of_little() {
        let page = page(&calibration(2, "short"));
        assert!(page.contains("record longer") || page.contains("does not show"), "{page}");
        assert!(!page.contains("NaN"));
        let svg = plot::allan(&calibration(2, "short")).svg();
        assert!(!svg.contains("NaN") && !svg.contains("inf"));
    }

    #[test]
    fn the_plot_is_a_png_of_its_svg() {
        let figure = plot::allan(&calibration(60, "a"));
        let png = figure.png().unwrap();
        assert!(png.starts_with(b"\x89PNG\r\n") && png.len() > 20_000);
        assert!(figure.svg().contains("gyroscope: Allan deviation"));
    }
}
