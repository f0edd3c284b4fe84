//! Headers, units and specifications of columns.

use super::columns::{Column, Columns};
use super::dialect::Dialect;
use super::told::Told;
use crate::recording::{ForceUnit, RateUnit, TimeUnit};

fn named(header: &str) -> Result<Columns, String> {
    let names: Vec<&[u8]> = Dialect::of(header.as_bytes()).fields(header.as_bytes()).collect();
    Columns::from_names(&names, None)
}

fn told<U>(unit: Option<U>) -> Told<U> {
    unit.map_or(Told::Nothing, Told::Unit)
}

#[test]
fn headers_that_people_write() {
    let (rate, force) = (Some(RateUnit::RadPerS), Some(ForceUnit::MPerS2));
    let customary = Columns::customary();
    for (header, time, rate, force) in [
        (
            "timestamp [ns],w_RS_S_x [rad s^-1],w_RS_S_y [rad s^-1],w_RS_S_z [rad s^-1],\
             a_RS_S_x [m s^-2],a_RS_S_y [m s^-2],a_RS_S_z [m s^-2]",
            Some(TimeUnit::Nanoseconds),
            rate,
            force,
        ),
        (
            "timestamp [ns],gyro_x [rad/s],gyro_y [rad/s],gyro_z [rad/s],\
             accel_x [m/s^2],accel_y [m/s^2],accel_z [m/s^2]",
            Some(TimeUnit::Nanoseconds),
            rate,
            force,
        ),
        ("t,gx,gy,gz,ax,ay,az", None, None, None),
        ("Time,GyroX,GyroY,GyroZ,AccX,AccY,AccZ", None, None, None),
        (
            "time_us,omega_x (deg/s),omega_y (deg/s),omega_z (deg/s),acc_x (g),acc_y (g),acc_z (g)",
            Some(TimeUnit::Microseconds),
            Some(RateUnit::DegPerS),
            Some(ForceUnit::G),
        ),
        (
            "t_s,gyro_x_rad_s,gyro_y_rad_s,gyro_z_rad_s,accel_x_m_s2,accel_y_m_s2,accel_z_m_s2",
            Some(TimeUnit::Seconds),
            rate,
            force,
        ),
        (
            "time,angular_velocity.x,angular_velocity.y,angular_velocity.z,\
             linear_acceleration.x,linear_acceleration.y,linear_acceleration.z",
            None,
            None,
            None,
        ),
        (
            "stamp (s),wx,wy,wz,acc_x [mg],acc_y [mg],acc_z [mg]",
            Some(TimeUnit::Seconds),
            None,
            Some(ForceUnit::MilliG),
        ),
        (
            "time_s,gyro_dps_x,gyro_dps_y,gyro_dps_z,acc_g_x,acc_g_y,acc_g_z",
            Some(TimeUnit::Seconds),
            Some(RateUnit::DegPerS),
            Some(ForceUnit::G),
        ),
        (
            "t,angular_velocity_rad_s_x,angular_velocity_rad_s_y,angular_velocity_rad_s_z,\
             acc_m_s2_x,acc_m_s2_y,acc_m_s2_z",
            None,
            rate,
            force,
        ),
        (
            "t,gyro_x_deg_per_s,gyro_y_deg_per_s,gyro_z_deg_per_s,a_ms2_x,a_ms2_y,a_ms2_z",
            None,
            Some(RateUnit::DegPerS),
            force,
        ),
    ] {
        let (time, rate, force) = (told(time), told(rate), told(force));
        let columns = customary.columns.clone();
        let expected = Columns { columns, time, rate, force, ..Columns::default() };
        assert_eq!(named(header), Ok(expected), "{header}");
    }
}

#[test]
fn units_that_nobody_knows_are_no_si_units() {
    let time = named("t [min],gx,gy,gz").unwrap().time;
    assert!(time.unless(None).unwrap_err().contains("'t [min]': 'min' is no unit of time"));
    assert_eq!(time.unless(Some(TimeUnit::Seconds)), Ok(Some(TimeUnit::Seconds)));
    let rate = named("t,gyro_x_rpm,gyro_y_rpm,gyro_z_rpm").unwrap().rate;
    assert!(rate.unless(None).unwrap_err().contains("'rpm' is no unit of angular rate"));
    let force = named("t,ax [g],ay [mg],az [g]").unwrap().force;
    assert!(force.unless(None).unwrap_err().contains("'ay [mg]': its unit is not that of"));
}

#[test]
fn other_columns_are_left_alone() {
    let columns = named(
        "seq,%time,field.header.stamp,field.orientation.x,field.angular_velocity.x,\
         field.angular_velocity.y,field.angular_velocity.z,\
         field.angular_velocity_covariance0,field.linear_acceleration.x,\
         field.linear_acceleration.y,field.linear_acceleration.z,mag_x,b_w_RS_S_x,temp",
    )
    .unwrap();
    use Column::{Force, Other, Rate, Temperature, Time};
    let expected = [
        Other,
        Other,
        Time,
        Other,
        Rate(0),
        Rate(1),
        Rate(2),
        Other,
        Force(0),
        Force(1),
        Force(2),
        Other,
        Other,
        Temperature,
    ];
    assert_eq!(columns.columns, expected);
}

#[test]
fn specifications() {
    assert_eq!(Columns::from_spec("t,gx,gy,gz,ax,ay,az,-"), Ok(Columns::customary()));
    assert!(Columns::from_spec("gx,gy,gz,ax,ay,az").unwrap_err().contains("time"));
    assert!(Columns::from_spec("t,gx,gy,ax,ay,az").is_err());
    assert!(Columns::from_spec("t,gx,gx,gz").is_err());
    assert!(Columns::from_spec("t,u").unwrap_err().contains("'u'"));
    assert!(Columns::from_spec("t,-,ax,ay,az").is_ok());
}
