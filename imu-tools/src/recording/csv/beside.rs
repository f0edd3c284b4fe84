//! What a table holds beside the columns that are taken: a second IMU, or anything else.

use super::columns::Column;
use super::increments;
use super::names::Name;
use crate::recording::SampleKind;
use crate::recording::sensor::Sensor;

/// Names shown in a sentence, at most.
const SHOWN: usize = 24;

/// The columns of a sensor that has all of its axes more than once, by their names; `None` where each
/// sensor is there once.
pub fn several_imus(names: &[&[u8]], hint: Option<Sensor>) -> Option<String> {
    let parts: Vec<Name> = names.iter().map(|text| Name::new(text)).collect();
    let mut columns = increments::meanings(&parts, hint);
    for (column, text) in columns.iter_mut().zip(names) {
        if is_about_readings(text) {
            *column = Column::Other;
        }
    }
    let twice = |sensor: fn(u8) -> Column| {
        [0, 1, 2].iter().all(|&axis| columns.iter().filter(|&&c| c == sensor(axis)).count() > 1)
    };
    let (rates, forces) = (twice(Column::Rate), twice(Column::Force));
    let meant = |column: &Column| match column {
        Column::Rate(_) => rates,
        Column::Force(_) => forces,
        _ => false,
    };
    let found: Vec<String> = names
        .iter()
        .zip(&columns)
        .filter(|(_, column)| meant(column))
        .map(|(n, _)| name(n))
        .collect();
    (rates || forces).then(|| listed(&found, SHOWN))
}

/// What the names of the columns that are taken say of the samples; increments become means.
pub fn samples(names: &[&[u8]], columns: &[Column]) -> Option<SampleKind> {
    let reading = |column: &Column| matches!(column, Column::Rate(_) | Column::Force(_));
    let taken = names.iter().zip(columns).filter(|(_, column)| reading(column));
    let mut names = taken.map(|(text, _)| Name::new(text));
    names.any(|name| name.is_mean() || name.is_increment()).then_some(SampleKind::Mean)
}

/// The columns that are not taken, by their names where they have any; empty where there are none.
/// `row` is the first one.
pub fn not_taken(names: &[&[u8]], columns: &[Column], row: &[&[u8]]) -> String {
    /// Beside topics in a list, a few will do.
    const FEW: usize = 5;
    let taken = |at: usize| columns.get(at).is_some_and(|column| *column != Column::Other);
    let width = row.iter().rposition(|field| !field.is_empty()).map_or(0, |last| last + 1);
    let left = (0..width).filter(|at| !taken(*at));
    let left: Vec<String> = match names {
        [] => left.map(|at| format!("column {}", at + 1)).collect(),
        names => left.filter_map(|at| names.get(at)).map(|text| name(text)).collect(),
    };
    let left: Vec<String> = left.into_iter().filter(|name| !name.is_empty()).collect();
    listed(&left, FEW)
}

/// Whether a column holds something about readings (their bias, their scatter, what gravity leaves of
/// them) and not readings.
fn is_about_readings(text: &[u8]) -> bool {
    const ABOUT: [&str; 8] = ["bias", "offset", "cov", "var", "std", "sigma", "err", "free"];
    let name = name(text).to_lowercase();
    ABOUT.iter().any(|word| name.contains(word))
}

/// A column's name as a sentence shows it.
pub fn name(text: &[u8]) -> String {
    String::from_utf8_lossy(text).trim().to_owned()
}

/// Names in a row, so many at most.
fn listed(names: &[String], most: usize) -> String {
    let shown = names.iter().take(most).map(String::as_str).collect::<Vec<_>>().join(", ");
    match names.len().saturating_sub(most) {
        0 => shown,
        more => format!("{shown} and {more} more"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn fields(header: &str) -> Vec<&[u8]> {
        header.split(',').map(str::as_bytes).collect()
    }

    #[test]
    fn a_sensor_with_all_axes_twice_is_two() {
        let two = several_imus(
            &fields("t,imu1_gx,imu1_gy,imu1_gz,imu2_gx,imu2_gy,imu2_gz,ax,ay,az"),
            None,
        );
        assert_eq!(two.as_deref(), Some("imu1_gx, imu1_gy, imu1_gz, imu2_gx, imu2_gy, imu2_gz"));
        for one in [
            "t,gx,gy,gz,ax,ay,az",
            "t,gyro_x,gyro_y,gyro_z,gyro_x_bias,gyro_y_bias,gyro_z_bias",
            "t,acc_x,acc_y,acc_z,free_acc_x,free_acc_y,free_acc_z,mag_x,mag_y,mag_z",
            "t,gx,gy,gz,wx",
        ] {
            assert_eq!(several_imus(&fields(one), None), None, "{one}");
        }
    }

    #[test]
    fn what_is_not_taken_is_named() {
        let columns = [Column::Other, Column::Time, Column::Rate(0)];
        let row = fields("1,2,3,4,5,6,7,8,9,");
        assert_eq!(not_taken(&fields("i,t,gx,mx,,b c"), &columns, &row), "i, mx, b c");
        let unnamed = "column 1, column 4, column 5, column 6, column 7 and 2 more";
        assert_eq!(not_taken(&[], &columns, &row), unnamed);
        assert_eq!(not_taken(&[], &columns[1..], &row[..2]), "");
    }
}
