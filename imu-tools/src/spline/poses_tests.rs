use super::*;

/// A vehicle's poses, ten a second, that turns by a full turn in `count` of them; x y z qx qy qz qw.
fn rows(count: usize) -> Vec<[f64; 8]> {
    (0..count)
        .map(|k| {
            let half = PI * k as f64 / count as f64;
            [0.1 * k as f64, 0.2 * k as f64, 0.0, 0.0, 0.0, 0.0, half.sin(), half.cos()]
        })
        .collect()
}

fn read(rows: &[[f64; 8]]) -> Result<Given, String> {
    let file = tempfile::NamedTempFile::new().unwrap();
    let row = |row: &[f64; 8]| row.map(|x| x.to_string()).join(" ");
    let text: Vec<String> = rows.iter().map(row).collect();
    std::fs::write(file.path(), format!("# t x y z qx qy qz qw\n{}\n", text.join("\n"))).unwrap();
    Given::read(file.path()).map_err(|error| error.to_string())
}

fn warnings(rows: &[[f64; 8]]) -> Vec<String> {
    let notes = read(rows).unwrap().notes.into_iter();
    let text = notes.map(|note| match note {
        Note::Warning(text) => text,
        Note::Info(text) => format!("(info) {text}"),
    });
    text.collect()
}

#[test]
fn good_poses_and_signs_need_no_word() {
    let mut rows = rows(100);
    for row in rows.iter_mut().step_by(3) {
        row[4..].iter_mut().for_each(|q| *q = -*q);
    }
    assert_eq!(warnings(&rows), [""; 0]);
    assert_eq!(read(&rows).unwrap().poses.len(), 100);
}

#[test]
fn what_makes_no_curve_is_refused_with_its_line() {
    let with = |at: usize, column: usize, value: f64| {
        let mut rows = rows(50);
        rows[at][column] = value;
        read(&rows).unwrap_err()
    };
    for (error, words) in [
        (with(20, 2, f64::NAN), "line 22: the pose has a value that is no number"),
        (with(20, 7, f64::INFINITY), "line 22: the pose has a value that is no number"),
        (with(20, 0, 1.0), "line 22: the stamp is 0.9 s before"),
        (with(20, 4, 0.1), "line 22: the rotation has the length 1.00"),
        (with(20, 1, 1e12), "line 22: a position of 1000000000000"),
        (read(&rows(3)).unwrap_err(), "holds 3 poses of different instants, and a curve needs 4"),
    ] {
        assert!(error.contains(words), "{words}: {error}");
    }
    let mut turned = rows(50);
    let [.., qz, qw] = turned[20];
    turned[20][4..].copy_from_slice(&[qw, qz, 0.0, 0.0]);
    assert!(read(&turned).unwrap_err().contains("line 22: the pose is turned by 180.0°"));
}

#[test]
fn what_is_doubtful_is_told() {
    let mut bad = rows(100);
    bad[7][7] *= 1.0 + 2e-4;
    bad[50] = bad[49];
    bad.drain(60..63);
    bad[80][0] = bad[79][0];
    let told = warnings(&bad);
    assert_eq!(told.len(), 4, "{told:?}");
    for words in [
        "(info) a pose is there twice",
        "quaternions of 1 pose are not of unit length, by up to 1.9e-4 (the first in line 9)",
        "1 pose with the stamp of the one above and another place or attitude, by up to 0.200 m and",
        "5 poses missing, 3 holes (0.400 s after 5.900 s, ",
    ] {
        assert!(told.iter().any(|text| text.contains(words)), "{words}: {told:?}");
    }
    let mut jump = rows(8);
    jump.iter_mut().skip(4).for_each(|row| {
        let [.., qz, qw] = *row;
        let (s, c) = (0.4 * PI).sin_cos();
        (row[6], row[7]) = (qz * c + qw * s, qw * c - qz * s);
    });
    let told = warnings(&jump);
    assert!(told[0].contains("1 pose turned by more than a quarter turn"), "{told:?}");
}

#[test]
fn columns_in_another_order_are_recognised() {
    let mut first = rows(100);
    for row in &mut first {
        let [t, x, y, z, qx, qy, qz, qw] = *row;
        *row = [t, x, y, z, qw, qx, qy, qz];
    }
    let told = warnings(&first);
    let other_end = "if the scalar of its quaternions stood at their other end";
    assert!(told[0].contains(other_end) && told[0].contains("it would be 1.00 g"), "{told:?}");
    let mut last = rows(100);
    for row in &mut last {
        let [t, x, y, z, qx, qy, qz, qw] = *row;
        *row = [t, x, y, z, qy, qz, qw, qx];
    }
    let told = warnings(&last);
    assert!(told[0].contains(other_end), "{told:?}");
    // Leaning by half a radian, for what turns about the vertical alone is the same backwards.
    let mut inverse = rows(100);
    let leaning = Quaternion::new(0.25_f64.cos(), 0.25_f64.sin(), 0.0, 0.0);
    for row in &mut inverse {
        let [t, x, y, z, qx, qy, qz, qw] = *row;
        let q = so3::product(&Quaternion::new(qw, qx, qy, qz), &leaning);
        *row = [t, x, y, z, -q.i, -q.j, -q.k, q.w];
    }
    let told = warnings(&inverse);
    assert!(told[0].contains("if it held the world's poses as the body sees them"), "{told:?}");
    let mut swapped = rows(100);
    for row in &mut swapped {
        let [t, x, y, z, qx, qy, qz, qw] = *row;
        *row = [t, qx, qy, qz, qw, x, y, z];
    }
    let error = read(&swapped).unwrap_err();
    assert!(error.contains("position and rotation are swapped"), "{error}");
}
