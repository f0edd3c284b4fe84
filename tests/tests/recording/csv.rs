//! CSV files as people have them: any separator, header, unit and gap.

use std::io::Write as _;

use imu_tools::error::Error;
use imu_tools::recording::{self, Block, ForceUnit, Note, RateUnit, ReadOptions, Sample, TimeUnit};

/// All samples and notes of a CSV of this text.
fn read(text: &[u8], options: &ReadOptions) -> Result<(Block, Vec<Note>), Error> {
    let mut file = tempfile::NamedTempFile::with_suffix(".csv").unwrap();
    file.write_all(text).unwrap();
    let mut source = recording::open(file.path(), options)?;
    let (mut all, mut block) = (Block::default(), Block::default());
    while source.next_block(&mut block)? {
        all.gyroscope.append(&mut block.gyroscope);
        all.accelerometer.append(&mut block.accelerometer);
    }
    Ok((all, source.take_notes()))
}

fn error(text: &str) -> Error {
    read(text.as_bytes(), &ReadOptions::default()).unwrap_err()
}

fn plain(text: &str) -> Block {
    read(text.as_bytes(), &ReadOptions::default()).unwrap().0
}

#[test]
fn samples_are_read_back_to_the_bit() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.csv");
    let mut block = Block::default();
    for i in 0..10_000_i64 {
        let v = (i as f64 * 0.7).sin() * 10_f64.powi((i % 600) as i32 - 300);
        let stamp_ns = 1_403_636_579_763_555_584 + i * 4_999_999;
        block.gyroscope.push(Sample { stamp_ns, value: [v, 1.0 / v, -v] });
        if i % 3 == 0 {
            block.accelerometer.push(Sample { stamp_ns, value: [0.1 + v, 9.81, -0.0] });
        }
    }
    let mut sink = recording::create(&path).unwrap();
    sink.write_block(&block).unwrap();
    sink.finish().unwrap();
    let (read, notes) = read(&std::fs::read(&path).unwrap(), &ReadOptions::default()).unwrap();
    assert_eq!(read, block);
    assert_eq!(notes, []);
}

#[test]
fn any_separator_and_line_end() {
    let expected = plain("0.005,1,2,3,4,5,6\n0.010,1,2,3,4,5,7\n");
    assert_eq!(expected.gyroscope[0], Sample { stamp_ns: 5_000_000, value: [1.0, 2.0, 3.0] });
    assert_eq!(expected.accelerometer[1], Sample { stamp_ns: 10_000_000, value: [4.0, 5.0, 7.0] });
    for text in [
        "0.005;1;2;3;4;5;6\n0.010;1;2;3;4;5;7",
        "0.005\t1\t2\t3\t4\t5\t6\r\n0.010\t1\t2\t3\t4\t5\t7\r\n",
        "  0.005 1  2 3   4 5 6\n  0.010 1  2 3   4 5 7 \n",
        "\u{feff}time,gx,gy,gz,ax,ay,az\n0.005, 1, 2, 3, 4, 5, 6\n\n# pause\n0.010,1,2,3,4,5,7\n",
        "# written by a logger\n# t gx gy gz ax ay az\n0.005 1 2 3 4 5 6\n0.010 1 2 3 4 5 7\n",
        "ax,t,az,ay,temp,gz,gy,gx\n4,0.005,6,5,36,3,2,1\n4,0.010,7,5,36,3,2,1\n",
    ] {
        assert_eq!(plain(text), expected, "{text}");
    }
}

#[test]
fn euroc_rows() {
    let text = "#timestamp [ns],w_RS_S_x [rad s^-1],w_RS_S_y [rad s^-1],w_RS_S_z [rad s^-1],\
                a_RS_S_x [m s^-2],a_RS_S_y [m s^-2],a_RS_S_z [m s^-2]\n\
                1403636579758555392,-0.099134701513277898,0.14730578886832138,\
                0.02722713633111154,8.1476917083333333,-0.37592158333333331,-2.4026292499999999\n";
    let (block, notes) = read(text.as_bytes(), &ReadOptions::default()).unwrap();
    assert_eq!(block.gyroscope[0].stamp_ns, 1_403_636_579_758_555_392);
    assert_eq!(block.gyroscope[0].value[1], 0.14730578886832138);
    assert_eq!(block.accelerometer[0].value[2], -2.402_629_25);
    assert_eq!(notes, []);
}

#[test]
fn units_are_read_given_and_told() {
    let near = |a: f64, b: f64| assert!((a / b - 1.0).abs() < 1e-15, "{a} {b}");
    let text = "time_us;gyro_x [deg/s];gyro_y [deg/s];gyro_z [deg/s];acc_x [g];acc_y [g];acc_z [g]\n\
                1000;180;0;0;0;0;1\n";
    let (block, notes) = read(text.as_bytes(), &ReadOptions::default()).unwrap();
    assert_eq!((block.gyroscope[0].stamp_ns, notes), (1_000_000, vec![]));
    near(block.gyroscope[0].value[0], std::f64::consts::PI);
    near(block.accelerometer[0].value[2], 9.80665);

    let options = ReadOptions {
        gyro_unit: Some(RateUnit::DegPerH),
        accel_unit: Some(ForceUnit::MilliG),
        time_unit: Some(TimeUnit::Milliseconds),
        columns: Some("ax,ay,az,-,gx,gy,gz,t".into()),
        ..ReadOptions::default()
    };
    let (block, notes) = read(b"0,0,1000,7,648000,0,0,2.5\n", &options).unwrap();
    assert_eq!((block.gyroscope[0].stamp_ns, notes), (2_500_000, vec![]));
    near(block.gyroscope[0].value[0], std::f64::consts::PI);
    near(block.accelerometer[0].value[2], 9.80665);

    let (block, notes) =
        read(b"0,1,2,3,4,5,6\n5,1,2,3,4,5,6\n10,1,2,3,4,5,6\n", &ReadOptions::default()).unwrap();
    assert_eq!(block.gyroscope[2].stamp_ns, 10_000_000);
    let [Note::Info(told)] = &notes[..] else { panic!("{notes:?}") };
    for part in ["time as ms", "rad/s", "m/s^2"] {
        assert!(told.contains(part), "{told}");
    }
}

#[test]
fn failed_readings_and_absent_sensors() {
    let block = plain("t,gx,gy,gz,ax,ay,az\n0.1,1,nan,3,4,,inf\n0.2,1,2,3,,,\n0.3,,,,4,5,6\n");
    assert_eq!(block.gyroscope.len(), 2);
    assert!(block.gyroscope[0].value[1].is_nan());
    assert_eq!(block.gyroscope[1].value, [1.0, 2.0, 3.0]);
    assert_eq!(block.accelerometer.len(), 2);
    assert!(block.accelerometer[0].value[1].is_nan());
    assert_eq!(block.accelerometer[0].value[2], f64::INFINITY);
    assert_eq!(block.accelerometer[1].stamp_ns, 300_000_000);
}

#[test]
fn one_sensor_is_enough_and_is_told() {
    let (block, notes) = read(b"t,gx,gy,gz\n0.1,1,2,3\n", &ReadOptions::default()).unwrap();
    assert_eq!((block.gyroscope.len(), block.accelerometer.len()), (1, 0));
    assert!(notes.iter().any(|n| matches!(n, Note::Warning(w) if w.contains("accelerometer"))));
}

#[test]
fn a_row_cut_at_the_end_is_left_out() {
    let text = b"0.1,1,2,3,4,5,6\n0.2,1,2,3,4,5,6\n0.3,1,2";
    let (block, notes) = read(text, &ReadOptions::default()).unwrap();
    assert_eq!(block.gyroscope.len(), 2);
    assert!(notes.iter().any(|n| matches!(n, Note::Warning(w) if w.contains("line 3"))));
}

#[test]
fn faults_name_file_line_and_column() {
    for (text, parts) in [
        ("0.1,1,2,3,4\n", &["line 1", "5 columns", "7"][..]),
        ("0.1,1,2,3,4,5,6\n0.2,1,2,3\n0.3,1,2,3,4,5,6\n", &["line 2", "4 columns", "7"]),
        ("t,gx,gy,gz,ax,ay,az\n0.1,1,2,oops,4,5,6\n", &["line 2", "column 4", "'oops'"]),
        ("0.1,1,2,3,4,5,6\n12:30,1,2,3,4,5,6\n", &["line 2", "column 1", "'12:30'", "time"]),
        ("0.1,1,2,3,4,5,6\n,1,2,3,4,5,6\n", &["line 2", "column 1", "time"]),
        ("gx,gy,gz,ax,ay,az\n1,2,3,4,5,6\n", &["header", "time", "--columns"]),
        ("t,a,b,c\n1,2,3,4\n", &["header", "gyroscope", "--columns"]),
        ("t,gx [rpm],gy [rpm],gz [rpm]\n0,1,2,3\n", &["'gx [rpm]'", "'rpm'", "--gyro-unit"]),
        ("t [min],gx,gy,gz\n0,1,2,3\n", &["'t [min]'", "--time-unit"]),
        ("t,ax [ft/s2],ay,az\n0,1,2,3\n", &["'ft/s2'", "--accel-unit"]),
        ("t,gx [deg/s],gy [rad/s],gz\n0,1,2,3\n", &["'gy [rad/s]'", "--gyro-unit"]),
        ("hello world\n", &["no row of numbers"]),
        ("", &["empty"]),
        ("\n\n", &["no row of numbers"]),
    ] {
        let error = error(text);
        assert_eq!(error.exit_code(), 1, "{text}");
        let sentence = error.to_string();
        assert!(sentence.contains(".csv"), "{sentence}");
        for part in parts {
            assert!(sentence.contains(part), "{text:?}: {sentence}");
        }
    }
    assert!(error("a\0b\u{1}").to_string().contains("neither"));
}

#[test]
fn options_that_do_not_fit_are_usage_errors() {
    let row = b"0.1,1,2,3,4,5,6\n";
    let bad = [
        ReadOptions { columns: Some("t,u".into()), ..ReadOptions::default() },
        ReadOptions { topic: Some("/imu".into()), ..ReadOptions::default() },
        ReadOptions { bag_time: true, ..ReadOptions::default() },
    ];
    for options in bad {
        assert_eq!(read(row, &options).unwrap_err().exit_code(), 2);
    }
}

#[test]
fn a_line_without_end_is_refused() {
    let mut text = b"0.1,1,2,3,4,5,6\n".to_vec();
    text.extend(std::iter::repeat_n(b'1', 3 << 20));
    let error = read(&text, &ReadOptions::default()).unwrap_err();
    assert!(error.to_string().contains("megabyte"), "{error}");
}
