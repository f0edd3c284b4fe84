//! Tables as programs write them: spreadsheets, loggers, phones, ROS tools, other languages.

use std::f64::consts::PI;

use imu_tests::recordings::Folder;
use imu_tools::error::Error;
use imu_tools::recording::{self, Block, Note, ReadOptions, Sample};

/// All samples and notes of a file of that name and text.
fn read_as(
    name: &str,
    text: impl AsRef<[u8]>,
    options: &ReadOptions,
) -> Result<(Block, Vec<Note>), Error> {
    let folder = Folder::new();
    let path = folder.put(name, text);
    let mut source = recording::open(path.as_ref(), options)?;
    let (mut all, mut block) = (Block::default(), Block::default());
    while source.next_block(&mut block)? {
        all.gyroscope.append(&mut block.gyroscope);
        all.accelerometer.append(&mut block.accelerometer);
        all.temperature.append(&mut block.temperature);
    }
    Ok((all, source.take_notes()))
}

fn read(text: impl AsRef<[u8]>) -> Block {
    read_as("a.csv", text, &ReadOptions::default()).unwrap().0
}

fn map(map: &str) -> ReadOptions {
    ReadOptions { map: Some(map.into()), ..ReadOptions::default() }
}

/// What most of these files hold.
fn expected() -> Block {
    let mut block = Block::default();
    for (stamp_ns, last) in [(5_000_000, 6.0), (10_000_000, 7.0)] {
        block.gyroscope.push(Sample { stamp_ns, value: [1.5, 2.0, 3.0] });
        block.accelerometer.push(Sample { stamp_ns, value: [4.0, 5.0, last] });
    }
    block
}

#[test]
fn dialects() {
    let plain = "t,gx,gy,gz,ax,ay,az\n0.005,1.5,2,3,4,5,6\n0.010,1.5,2,3,4,5,7\n";
    assert_eq!(read(plain), expected());
    for text in [
        plain.replace(',', "|"),
        plain.replace(',', " | "),
        plain.replace('\n', "\r\n"),
        plain.replace('\n', "\r"),
        plain.replace(',', ";").replace('.', ","),
        plain.replace(',', "\t").replace('.', ","),
        plain.replace(',', "  ").replace('.', ","),
        format!("sep=;\n{}", plain.replace(',', ";").replace('.', ",")),
        format!("sep=|\n{}", plain.replace(',', "|")),
        plain
            .replace(",", "\",\"")
            .replace('\n', "\"\n")
            .replace("t\"", "\"t\"")
            .replace("0.0", "\"0.0"),
    ] {
        assert_eq!(read(&text), expected(), "{text}");
    }
    let utf16: Vec<u8> = format!("\u{feff}{}", plain.replace(',', "\t"))
        .encode_utf16()
        .flat_map(u16::to_le_bytes)
        .collect();
    assert_eq!(read(utf16), expected());
}

#[test]
fn a_row_of_units_below_the_header() {
    let text = "Time;Gyr_X;Gyr_Y;Gyr_Z;Acc_X;Acc_Y;Acc_Z\nms;deg/s;deg/s;deg/s;g;g;g\n\
                5;180;0;0;0;0;1\n10;180;0;0;0;0;1\n";
    let (block, notes) = read_as("a.csv", text, &ReadOptions::default()).unwrap();
    assert_eq!(notes, []);
    assert_eq!(block.gyroscope[1].stamp_ns, 10_000_000);
    assert!((block.gyroscope[0].value[0] / PI - 1.0).abs() < 1e-15);
    assert!((block.accelerometer[0].value[2] / 9.80665 - 1.0).abs() < 1e-15);
    // In brackets, with blanks for columns without a unit.
    let text = "n,time,wx,wy,wz\n,[us],[mdps],[mdps],[mdps]\n0,1000,180000,0,0\n1,6000,0,0,0\n";
    let block = read(text);
    assert_eq!(block.gyroscope[0].stamp_ns, 1_000_000);
    assert!((block.gyroscope[0].value[0] / PI - 1.0).abs() < 1e-15);
}

#[test]
fn preambles() {
    // Xsens: 10 kHz ticks.
    let text = "// General information:\n//  MT Manager version: 2022.0.0\n// Update Rate: 100.0Hz\n\
                // Start Time: 12:00:00.000, Wed May 1 2024\n\
                PacketCounter\tSampleTimeFine\tAcc_X\tAcc_Y\tAcc_Z\tFreeAcc_X\tGyr_X\tGyr_Y\tGyr_Z\tMag_X\n\
                17\t1000\t4\t5\t6\t0\t1.5\t2\t3\t0.1\n18\t1100\t4\t5\t6\t0\t1.5\t2\t3\t0.1\n";
    let block = read(text);
    assert_eq!(block.gyroscope[1], Sample { stamp_ns: 110_000_000, value: [1.5, 2.0, 3.0] });
    assert_eq!(block.accelerometer[0].value, [4.0, 5.0, 6.0]);
    // A line that begins with a number is no row yet.
    let text = "Device: A\n2024-05-01\n12 channels\n\nt,gx,gy,gz\n0.1,1,2,3\n0.2,1,2,3\n";
    assert_eq!(read(text).gyroscope.len(), 2);
}

#[test]
fn dates() {
    let noon_ns = 1_714_564_800_000_000_000;
    for text in [
        "time,gx,gy,gz\n2024-05-01T12:00:00.000Z,1,2,3\n2024-05-01T12:00:00.005Z,1,2,3\n",
        "time,gx,gy,gz\n2024-05-01 12:00:00,1,2,3\n2024-05-01 12:00:00.005,1,2,3\n",
        "time;gx;gy;gz\n2024-05-01 12:00:00,000;1;2;3\n2024-05-01 12:00:00,005;1;2;3\n",
        "Date,Time,gx,gy,gz\n2024-05-01,12:00:00,1,2,3\n2024-05-01,12:00:00.005,1,2,3\n",
        "date time gx gy gz\n2024/05/01 12:00:00 1 2 3\n2024/05/01 12:00:00.005 1 2 3\n",
        "date;time;gx;gy;gz\n01.05.2024;12:00:00,000;1;2;3\n01.05.2024;12:00:00,005;1;2;3\n",
        "time,gx,gy,gz\n1.5.2024 12:00:00.000,1,2,3\n1.5.2024 12:00:00.005,1,2,3\n",
        "\"date\",\"gx\",\"gy\",\"gz\"\n\"2024-05-01 14:00:00+02:00\",1,2,3\n\"2024-05-01 14:00:00.005+02:00\",1,2,3\n",
        "2024-05-01T12:00:00.000Z,1,2,3,4,5,6\n2024-05-01T12:00:00.005Z,1,2,3,4,5,6\n",
    ] {
        let block = read(text);
        let stamps: Vec<i64> = block.gyroscope.iter().map(|s| s.stamp_ns).collect();
        assert_eq!(stamps, [noon_ns, noon_ns + 5_000_000], "{text}");
        assert_eq!(block.gyroscope[1].value, [1.0, 2.0, 3.0]);
    }
    let bad = "time,gx,gy,gz\n2024-05-01 12:00:00,1,2,3\n2024-05-32 12:00:00,1,2,3\n";
    let error = read_as("a.csv", bad, &ReadOptions::default()).unwrap_err();
    assert!(
        error.to_string().contains("line 3, column 1: '2024-05-32 12:00:00' is no time"),
        "{error}"
    );
}

#[test]
fn dates_of_two_meanings_are_refused_by_name() {
    for (text, date) in [
        (
            "time,gx,gy,gz\n12/31/2024 11:59:59 PM,1,2,3\n",
            "a.csv begins with '12/31/2024 11:59:59 PM'",
        ),
        ("date,time,gx,gy,gz\n05/01/2024,12:00:00,1,2,3\n", "'05/01/2024'"),
        ("time,gx,gy,gz\n11:59:59 PM,1,2,3\n", "'11:59:59 PM'"),
    ] {
        let error = read_as("a.csv", text, &ReadOptions::default()).unwrap_err().to_string();
        assert!(error.contains(date) && error.contains("2024-12-31 13:00:00"), "{error}");
    }
}

#[test]
fn several_imus_in_one_table() {
    let text = "t,imu1_gx,imu1_gy,imu1_gz,imu2_gx,imu2_gy,imu2_gz\n0.1,1,2,3,4,5,6\n";
    let error = read_as("a.csv", text, &ReadOptions::default()).unwrap_err();
    assert_eq!(error.exit_code(), 2);
    for words in ["imu1_gx, imu1_gy, imu1_gz, imu2_gx", "--map", "--columns"] {
        assert!(error.to_string().contains(words), "{error}");
    }
    let (block, _) = read_as("a.csv", text, &map("t=t,gx=imu2_gx,gy=imu2_gy,gz=imu2_gz")).unwrap();
    assert_eq!(block.gyroscope[0].value, [4.0, 5.0, 6.0]);
    let survey = ReadOptions { survey: true, ..ReadOptions::default() };
    let (block, notes) = read_as("a.csv", text, &survey).unwrap();
    assert_eq!(block.gyroscope[0].value, [1.0, 2.0, 3.0]);
    assert!(matches!(&notes[0], Note::Warning(said) if said.contains("several IMUs")), "{notes:?}");
}

#[test]
fn times_too_large_for_their_unit() {
    let text = "t [s],gx,gy,gz\n1700000000000000000,1,2,3\n1700000000005000000,1,2,3\n";
    let error = read_as("a.csv", text, &ReadOptions::default()).unwrap_err().to_string();
    assert!(error.contains("is too large a time in s: --time-unit"), "{error}");
}

#[test]
fn ros_tools() {
    let stamp_ns = 1_700_000_000_000_000_123;
    let cov = |name: &str| (0..9).map(|i| format!(",{name}{i}")).collect::<String>();
    let zeros = ",0".repeat(9);
    // rostopic echo -p: the header's stamp, not the time of recording.
    let rostopic = format!(
        "%time,field.header.seq,field.header.stamp,field.header.frame_id,field.orientation.x,\
         field.orientation.y,field.orientation.z,field.orientation.w{},field.angular_velocity.x,\
         field.angular_velocity.y,field.angular_velocity.z{},field.linear_acceleration.x,\
         field.linear_acceleration.y,field.linear_acceleration.z{}\n\
         1700000000900000000,1,1700000000000000123,imu link,0,0,0,1{zeros},1,2,3{zeros},4,5,6{zeros}\n",
        cov("field.orientation_covariance"),
        cov("field.angular_velocity_covariance"),
        cov("field.linear_acceleration_covariance"),
    );
    // ros2 topic echo --csv has no header.
    let ros2 = format!("1700000000,123,imu,0,0,0,1{zeros},1,2,3{zeros},4,5,6{zeros}\n");
    // Seconds and nanoseconds apart, as several exporters have them.
    let apart = "Time,header.seq,header.stamp.secs,header.stamp.nsecs,header.frame_id,\
                 angular_velocity.x,angular_velocity.y,angular_velocity.z,\
                 linear_acceleration.x,linear_acceleration.y,linear_acceleration.z\n\
                 1700000000.9,1,1700000000,123,imu,1,2,3,4,5,6\n";
    // PlotJuggler.
    let juggler = "__time,/imu/angular_velocity/x,/imu/angular_velocity/y,/imu/angular_velocity/z,\
                   /imu/linear_acceleration/x,/imu/linear_acceleration/y,/imu/linear_acceleration/z\n\
                   1700000000.000000123,1,2,3,4,5,6\n";
    for text in [&rostopic, &ros2, apart, juggler] {
        let block = read(text);
        assert_eq!(block.gyroscope, [Sample { stamp_ns, value: [1.0, 2.0, 3.0] }], "{text}");
        assert_eq!(block.accelerometer, [Sample { stamp_ns, value: [4.0, 5.0, 6.0] }], "{text}");
    }
}

#[test]
fn flight_controllers() {
    // PX4's ulog2csv and ArduPilot's logs.
    for text in [
        "timestamp,gyro_rad[0],gyro_rad[1],gyro_rad[2],gyro_integral_dt,\
         accelerometer_timestamp_relative,accelerometer_m_s2[0],accelerometer_m_s2[1],\
         accelerometer_m_s2[2],accelerometer_integral_dt\n\
         5000,1.5,2,3,5000,0,4,5,6,5000\n10000,1.5,2,3,5000,0,4,5,7,5000\n",
        "TimeUS,I,GyrX,GyrY,GyrZ,AccX,AccY,AccZ,T\n5000,0,1.5,2,3,4,5,6,40\n10000,0,1.5,2,3,4,5,7,40\n",
    ] {
        assert_eq!(read(text), expected(), "{text}");
    }
}

#[test]
fn phones() {
    // phyphox, one file a sensor; Sensor Logger, whose axes are named by the file.
    let phyphox = "\"Time (s)\",\"Gyroscope x (rad/s)\",\"Gyroscope y (rad/s)\",\"Gyroscope z (rad/s)\",\
                   \"Absolute (rad/s)\"\n0.005,1.5,2,3,4\n0.010,1.5,2,3,4\n";
    assert_eq!(read(phyphox).gyroscope, expected().gyroscope);
    let bare =
        "\"Time (s)\";\"X (rad/s)\";\"Y (rad/s)\";\"Z (rad/s)\"\n0,005;1,5;2;3\n0,01;1,5;2;3\n";
    assert_eq!(read(bare).gyroscope, expected().gyroscope);
    let logger = "time,seconds_elapsed,z,y,x\n1700000000000000000,0.005,3,2,1.5\n\
                  1700000000005000000,0.010,3,2,1.5\n";
    let options = ReadOptions::default();
    let (block, _) = read_as("Gyroscope.csv", logger, &options).unwrap();
    assert_eq!(block.gyroscope[1].stamp_ns, 1_700_000_000_005_000_000);
    assert_eq!(block.gyroscope[1].value, [1.5, 2.0, 3.0]);
    let (block, _) = read_as("TotalAcceleration.csv", logger, &options).unwrap();
    assert_eq!(block.accelerometer[1].value, [1.5, 2.0, 3.0]);
    let error = read_as("a.csv", logger, &options).unwrap_err();
    assert!(error.to_string().contains("no column of a gyroscope"), "{error}");
}

#[test]
fn temperatures() {
    for (name, field) in [("temperature [°C]", "25"), ("imu_temp_k", "298.15"), ("Temp (F)", "77")]
    {
        let text = format!("t,gx,gy,gz,{name}\n0.1,1,2,3,{field}\n0.2,1,2,3,\n0.3,1,2,3,{field}\n");
        let block = read(text);
        assert_eq!(block.gyroscope.len(), 3);
        let stamps: Vec<i64> = block.temperature.iter().map(|t| t.stamp_ns).collect();
        assert_eq!(stamps, [100_000_000, 300_000_000], "{name}");
        // A few roundings of numbers below 512.
        assert!((block.temperature[0].celsius - 25.0).abs() < 1e-12, "{name}");
    }
}

#[test]
fn columns_by_name() {
    let text = "stamp,omega.x,omega.y,omega.z,acc_1 [g],acc_2 [g],acc_3 [g],extra\n\
                0.005,1.5,2,3,0,0,1,x\n0.010,1.5,2,3,0,0,1,x\n";
    let names = "t=stamp,gx=omega.x,gy=omega.y,gz=OMEGA.Z,ax=acc_1,ay=acc_2,az=acc_3 [g]";
    let (block, notes) = read_as("a.csv", text, &map(names)).unwrap();
    assert_eq!(block.gyroscope, expected().gyroscope);
    assert!((block.accelerometer[0].value[2] / 9.80665 - 1.0).abs() < 1e-15);
    assert!(
        !notes.iter().any(|n| matches!(n, Note::Info(told) if told.contains("force"))),
        "{notes:?}"
    );
    for (names, parts) in [
        (
            "t=stamp,gx=wx,gy=omega.y,gz=omega.z",
            &["no column 'wx', only stamp, omega.x, omega.y, omega.z, acc_1 [g]"][..],
        ),
        ("t=stamp,gx=omega.x", &["x, y and z"]),
        ("t=stamp,gx=omega.x,gy=omega.x,gz=omega.z", &["'omega.x' is given twice"]),
        ("t=stamp,wx=omega.x", &["'wx' is none of t, sec"]),
        ("stamp", &["'stamp' is no pair"]),
    ] {
        let error = read_as("a.csv", text, &map(names)).unwrap_err();
        assert_eq!(error.exit_code(), 2);
        for part in parts {
            assert!(error.to_string().contains(part), "{error}");
        }
    }
    let error = read_as("a.csv", "0,1,2,3,4,5,6\n", &map("t=t")).unwrap_err();
    assert!(error.to_string().contains("no header"), "{error}");
}

#[test]
fn plain_rows_and_rows_with_blanks_and_quotes_are_the_same_numbers() {
    // The first are read in one pass, the others field by field.
    let mut values = Vec::new();
    for i in 0..5000_i64 {
        let v = (i as f64 * 0.7).sin() * 10_f64.powi((i % 40) as i32 - 20);
        values.push((i * 5_000_000, [v, 1.0 / v, -v], [v * 3.0, 9.81, 1e-9]));
    }
    let text = |between: &str| {
        let row = |(t, g, a): &(i64, [f64; 3], [f64; 3])| {
            let numbers: Vec<String> = g.iter().chain(a).map(|v| format!("{v:?}")).collect();
            format!("{t}{between}{}\n", numbers.join(between))
        };
        values.iter().map(row).collect::<String>()
    };
    let plain = read(text(","));
    assert_eq!(plain, read(text(" , ")));
    assert_eq!(plain.gyroscope.len(), values.len());
    for (sample, (stamp_ns, value, _)) in plain.gyroscope.iter().zip(&values) {
        assert_eq!(
            (sample.stamp_ns, sample.value.map(f64::to_bits)),
            (*stamp_ns, value.map(f64::to_bits))
        );
    }
}
