use super::*;
use crate::spline::{Options, Spacing, TimedPose, fit};
use imu_core::so3;

/// Attitudes all over the sphere.
fn fitted() -> Fit {
    let poses: Vec<_> = (0..3000_i64)
        .map(|k| {
            let t = k as f64;
            let turn = Vector3::new((0.37 * t).sin(), (0.23 * t).cos(), 1.3 * (0.11 * t).sin());
            let place = Vector3::new(0.1 * t, (0.2 * t).sin() / 3.0, -1e-9 * t);
            let pose = Pose::new(so3::exp(turn), place).unwrap();
            TimedPose { stamp_ns: 1_403_715_273_262_140_000 + 50_000_000 * k, pose }
        })
        .collect();
    fit(&poses, &Options { spacing: Spacing::AsPoses, ..Options::default() }).unwrap()
}

#[test]
fn a_curve_is_read_as_it_was_written() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.spline");
    let fit = fitted();
    write(&path, &fit).unwrap().finish().unwrap();
    let Opened::Curve(route) = open(&path).unwrap() else { panic!("a curve") };
    // With a mark before and blank lines behind, and compressed, it is the same.
    let text = std::fs::read(&path).unwrap();
    let marked = [BOM, &text, b"\n \r\n"].concat();
    let mut packed = flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::fast());
    std::io::Write::write_all(&mut packed, &marked).unwrap();
    std::fs::write(&path, packed.finish().unwrap()).unwrap();
    let Opened::Curve(same) = open(&path).unwrap() else { panic!("a curve") };
    assert_eq!(same, route);
    assert_eq!((route.form(), route.knots()), (fit.form, &fit.knots));
    assert_eq!(route.span_ns(), fit.span_ns);
    let settled: Vec<_> = fit.control.iter().copied().map(settled).collect();
    for ((read, a), b) in route.control().zip(&settled).zip(&fit.control) {
        assert_eq!(read, *a);
        // Seven steps of the largest component at most.
        assert!((a.rotation().coords - b.rotation().coords).abs().max() <= 7.8e-16);
    }
}

#[test]
fn what_is_no_curve_is_refused_with_its_line() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.spline");
    write(&path, &fitted()).unwrap().finish().unwrap();
    let text = std::fs::read_to_string(&path).unwrap();
    let lines: Vec<&str> = text.lines().collect();
    let changed = |line: usize, to: &str| {
        let mut lines = lines.clone();
        lines[line] = to;
        lines.join("\n") + "\n"
    };
    for (text, words) in [
        (changed(0, "# imu spline 2: x"), "line 1: a curve of another version"),
        (changed(1, "# form: odd"), "line 2: the form of a curve is plain or symmetric"),
        (changed(2, "# start: 5"), "line 3: here a curve has a line `# start_ns: …`"),
        (changed(3, "# step_ns: 5e7"), "line 4: step_ns is a whole number"),
        (changed(4, "# control_points: many"), "line 5: control_points is a whole number"),
        (changed(5, "# end_ns: 5 s"), "line 6: end_ns is a whole number"),
        (changed(5, "# end_ns: 9"), "no curve: end_ns, 9, is not within their time"),
        (changed(3, "# step_ns: 0"), "no curve: step_ns is 0"),
        (
            changed(2, "# start_ns: 9223372036854775800"),
            "no curve: they end behind the last instant",
        ),
        (changed(9, "1,2,3,0,0,0,1"), "no curve: two neighbours are half a turn apart"),
        (
            changed(4, "# control_points: 3").lines().take(10).collect::<Vec<_>>().join("\n")
                + "\n",
            "no curve: there are 3, and a curve needs 4 or more",
        ),
        (changed(6, "x,y,z"), "line 7: the columns are c_x [m]"),
        (changed(9, "1,2,3,1,0,0"), "line 10: this is no control point"),
        (changed(9, "1,2,nan,1,0,0,0"), "line 10: this is no control point"),
        (changed(9, "1,2,3,0.9,0,0,0"), "line 10: this is no control point"),
        (lines[..20].join("\n"), "is cut off or was changed: it holds 13 of 3002"),
        (text.trim_end().into(), "is cut off or was changed: it holds 3002 of 3002"),
        (lines[..1].join("\n"), "line 2: here a curve has a line `# form"),
    ] {
        std::fs::write(&path, text).unwrap();
        let error = open(&path).err().unwrap().to_string();
        assert!(error.contains(words), "{words}: {error}");
    }
    let error = read("it", &[lines[0].as_bytes(), b"\n# form: \xff\n"].concat()[..]).err().unwrap();
    assert_eq!(error.to_string(), "it, line 2: it is not text in UTF-8");
    std::fs::write(&path, "# timestamp tx").unwrap();
    assert!(open(&path).err().unwrap().to_string().contains("holds no poses"));
    assert!(open(folder.path()).is_err());
}
