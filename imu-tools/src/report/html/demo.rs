//! What `imu demo` found, as one page: the comparison, and the plots of each level.

use maud::html;

use super::{document, picture, words};
use crate::report::demo::{Comparison, Level, REMARKS, comparisons, estimated, told};
use crate::report::plot;
use crate::scene::display_duration;

/// The page; the report of each level is in a folder of its name beside it.
#[must_use]
pub fn demo(levels: &[Level]) -> String {
    let body = html! {
        h1 { "Three noise levels, and what is read of them" }
        p.lead {
            "Each level is a sensor at rest, simulated with noise that is known, and calibrated as a \
             recording would be."
        }
        h2 { "Estimated beside true, and beside two classic tools" }
        div.wide {
            table {
                thead {
                    tr {
                        th { "level" }
                        th { "parameter, all axes" }
                        th { "unit" }
                        th { "true" }
                        th { "estimate" }
                        th { "90 % interval" }
                        th { "imu_utils" }
                        th { "kalibr_allan" }
                    }
                }
                tbody {
                    @for row in comparisons(levels) { (comparison(&row)) }
                }
            }
        }
        p { (REMARKS) }
        @for level in levels {
            h2 { (words::capital(level.name)) }
            (picture(&plot::allan(&level.calibration), ""))
            p {
                (display_duration(level.scene.duration_ns)) " at " (level.scene.rate.hz()) " Hz: "
                a href={ (level.name) "/report.html" } { "report of level " (level.name) }
            }
        }
    };
    document("IMU noise: three levels", &body)
}

fn comparison(row: &Comparison) -> maud::Markup {
    let (value, interval) = estimated(row.estimate);
    html! {
        tr {
            td { (row.level) }
            td { (row.quantity.name()) }
            td { (row.quantity.unit()) }
            td { (format!("{:.1e}", row.truth)) }
            td { (value) }
            td { (interval) }
            td { (told(row.imu_utils, row.truth)) }
            td { (told(row.kalibr_allan, row.truth)) }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::calibrate::{Options, calibrate};
    use crate::scene::{Preset, Scene, Simulator};

    #[test]
    fn a_row_and_a_plot_for_each_level() {
        let levels = [Preset::Low, Preset::Mid].map(|preset| {
            let scene = Scene { duration_ns: 600_000_000_000, ..preset.scene() };
            let source = Box::new(Simulator::new(&scene).unwrap());
            let calibration = calibrate(source, "a", &Options::default(), |_| {}).unwrap();
            Level { name: preset.name(), scene, calibration }
        });
        let page = demo(&levels);
        assert_eq!(page.matches("<tr>").count(), 1 + 2 * 4);
        assert_eq!(page.matches("<figure>").count(), 2);
        assert_eq!(page.matches("10 min at 200 Hz").count(), 2);
        assert!(page.contains("href=\"mid/report.html\"") && page.contains("kalibr_allan"));
        assert!(page.len() < 1_000_000 && !page.contains("NaN<"));
    }
}
