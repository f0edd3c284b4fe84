//! `imu tradeoff`: what it prints and writes, and what it refuses.

use imu_tests::command::run;
use imu_tests::recordings::{Folder, number};
use serde_json::Value;

const SHORT: [&str; 8] =
    ["tradeoff", "allan", "--records", "2", "--duration", "1000s", "--rate", "4"];

#[test]
fn estimators_are_compared() {
    let folder = Folder::new();
    let page = folder.put("tradeoff.md", "# Mine\n\nWords.\n");
    let output = folder.path().to_str().unwrap();
    let said = run(&[&SHORT[..], &["--json", "-o", output]].concat());
    assert_eq!((said.code, said.err.as_str()), (0, ""));
    let value: Value = serde_json::from_str(&said.out).expect("one JSON object");
    let estimators = value["estimators"].as_array().unwrap();
    assert_eq!(estimators.len(), 11);
    for (k, estimator) in estimators.iter().enumerate() {
        let at = format!("/estimators/{k}");
        for key in ["state_bytes", "accuracy/0/noise_density/rms"] {
            assert!(number(&value, &format!("{at}/{key}")) > 0.0, "{estimator}");
        }
        assert!(number(&value, &format!("{at}/ns_per_value")) >= 0.0, "{estimator}");
    }
    // √(2·300 s/1000 s)
    let limit = number(&value, "/noises/0/limit_of_random_walk");
    assert!((limit - 0.6_f64.sqrt()).abs() < 1e-12, "{limit}");
    let text = std::fs::read_to_string(&page).unwrap();
    assert!(text.starts_with("# Mine\n\nWords.\n") && text.contains("| 4 windows | f64 | fit |"));
    let picture = std::fs::read_to_string(folder.at("tradeoff-allan.svg")).unwrap();
    assert!(picture.starts_with("<svg") && picture.contains("disjoint, f32, fit"));
    // The same errors again, whatever the prices are.
    let again = run(&[&SHORT[..], &["--json"]].concat());
    let again: Value = serde_json::from_str(&again.out).expect("one JSON object");
    for k in 0..11 {
        let at = format!("/estimators/{k}/accuracy");
        assert_eq!(value.pointer(&at), again.pointer(&at));
    }
}

#[test]
fn what_cannot_be_simulated_is_refused() {
    for (arguments, words) in [
        (&["--rate", "0.01"][..], "from 1000 to 10 million samples"),
        (&["--rate", "-5"], "from 1000 to 10 million samples"),
        (&["--rate", "inf"], "from 1000 to 10 million samples"),
        (&["--duration", "4 parsecs"], "4 parsecs"),
        (&["--records", "0"], "0"),
        (&["--records", "10001"], "10001"),
        (&["-o", "-"], "no pipe"),
    ] {
        let said = run(&[&["tradeoff", "allan"], arguments].concat());
        assert_eq!((said.code, said.out.as_str()), (2, ""), "{}", said.err);
        assert!(said.err.contains(words) && said.err.lines().count() == 1, "{}", said.err);
    }
}

const FEW: [&str; 8] =
    ["tradeoff", "rules", "--rates", "200,100", "--noisy-rates", "100", "--records", "2"];

#[test]
fn rules_are_compared() {
    let folder = Folder::new();
    let output = folder.path().to_str().unwrap();
    let said = run(&[&FEW[..], &["--json", "-o", output]].concat());
    assert_eq!((said.code, said.err.as_str()), (0, ""));
    let value: Value = serde_json::from_str(&said.out).expect("one JSON object");
    // Rates in order; five motions, two rates, four kinds of numbers, six rules.
    assert_eq!(value["rates_hz"], serde_json::json!([100, 200]));
    let clean = value["clean"].as_array().unwrap();
    assert_eq!(clean.len(), 5 * 2 * 4 * 6);
    let of = |rate: u64, rule: &str| {
        let row = clean.iter().find(|row| {
            (&row["motion"], &row["rule"], &row["numbers"])
                == (&"ellipse".into(), &rule.into(), &"f64".into())
                && row["rate_hz"] == rate
        });
        row.unwrap()["largest"]["attitude_deg"].as_f64().unwrap()
    };
    // The published order of each: 1, 2, 3.
    for (rule, order) in [("Euler", 1.0), ("midpoint", 2.0), ("three samples", 3.0)] {
        let measured = (of(100, rule) / of(200, rule)).log2();
        assert!((measured - order).abs() < 0.15, "{rule}: {measured}");
    }
    let page = std::fs::read_to_string(folder.at("tradeoff.md")).unwrap();
    assert!(page.contains("--rates 100,200 --noisy-rates 100 --records 2"), "{page}");
    let picture = std::fs::read_to_string(folder.at("tradeoff-rules.svg")).unwrap();
    assert!(picture.starts_with("<svg") && picture.contains("three samples"));
    // The same errors again, whatever the prices are.
    let again = run(&[&FEW[..], &["--json"]].concat());
    let again: Value = serde_json::from_str(&again.out).expect("one JSON object");
    assert_eq!(value["noisy"], again["noisy"]);
}

#[test]
fn rates_that_make_no_sense_are_refused() {
    for (arguments, words) in [
        (&["--rates", "0"][..], "from 1 to 32000"),
        (&["--rates", "fast"], "fast"),
        (&["--noisy-rates", "64000"], "from 1 to 32000"),
        (&["--records", "0"], "0"),
        (&["-o", "-"], "no pipe"),
    ] {
        let said = run(&[&["tradeoff", "rules"], arguments].concat());
        assert_eq!((said.code, said.out.as_str()), (2, ""), "{}", said.err);
        assert!(said.err.contains(words) && said.err.lines().count() == 1, "{}", said.err);
    }
}

#[test]
fn splines_are_compared() {
    let folder = Folder::new();
    let output = folder.path().to_str().unwrap();
    let few = ["tradeoff", "spline", "--spacings", "0.0125,0.025,0.0125", "--motion", "ellipse"];
    let said = run(&[&few[..], &["--json", "-o", output]].concat());
    assert_eq!((said.code, said.err.as_str()), (0, ""));
    let value: Value = serde_json::from_str(&said.out).expect("one JSON object");
    // The widest first; eight ways to a curve, in four kinds of numbers.
    assert_eq!(value["spacings_s"], serde_json::json!([0.025, 0.0125]));
    assert_eq!(value["runs"].as_array().unwrap().len(), 2 * 8 * 4);
    assert_eq!(value["prices"].as_array().unwrap().len(), 3 * 4);
    let orders = value["orders"].as_array().unwrap();
    // Rotation, ω, position and acceleration; at these steps as close to what they come to as the third digit.
    for (form, control, expected) in [
        ("plain", "interpolation", [3.0, 2.0, 4.0, 2.0]),
        ("plain", "quasi-interpolant", [3.0, 2.0, 4.0, 2.0]),
        ("symmetric", "interpolation", [4.0, 3.0, 4.0, 2.0]),
        ("symmetric", "quasi-interpolant", [4.0, 3.0, 4.0, 2.0]),
        ("plain", "poses as control points", [2.0; 4]),
    ] {
        let of = |row: &&Value| row["form"] == form && row["control_points"] == control;
        let row = orders.iter().find(of).unwrap();
        for (key, expected) in
            ["rotation", "angular_rate", "position", "acceleration"].into_iter().zip(expected)
        {
            let order: f64 = row[key].as_f64().unwrap();
            assert!((order - expected).abs() < 0.05, "{form}, {control}, {key}: {order}");
        }
    }
    let page = std::fs::read_to_string(folder.at("tradeoff.md")).unwrap();
    assert!(page.contains("--spacings 0.025,0.0125 --motion ellipse"), "{page}");
    for name in ["tradeoff-spline-orders", "tradeoff-spline-price"] {
        let picture = std::fs::read_to_string(folder.at(&format!("{name}.svg"))).unwrap();
        assert!(picture.starts_with("<svg") && picture.contains("symmetric"));
        let pixels = std::fs::read(folder.at(&format!("{name}.png"))).unwrap();
        assert!(pixels.starts_with(b"\x89PNG") && page.contains(&format!("({name}.svg)")));
    }
    // The same errors again, whatever the prices are; and the orders in the table.
    let again = run(&few);
    assert_eq!((again.code, again.err.as_str()), (0, ""));
    let row = |line: &&str| line.starts_with("symmetric  interpolation") && line.ends_with("4.00");
    assert!(again.out.lines().any(|line| row(&line)), "{}", again.out);
}

#[test]
fn knots_that_make_no_sense_are_refused() {
    for (arguments, words) in [
        (&["--spacings", "0"][..], "from 0.001 to 4 s"),
        (&["--spacings", "-0.1"], "from 0.001 to 4 s"),
        (&["--spacings", "NaN"], "from 0.001 to 4 s"),
        (&["--spacings", "61"], "from 0.001 to 4 s"),
        (&["--spacings", "0.1,3.5", "--motion", "spin"], "leave spin, of 10 s"),
        (&["--spacings", "close"], "close"),
        (&["--motion", "jump"], "ellipse, gait, coning, spin, rest"),
        (&["-o", "-"], "no pipe"),
    ] {
        let said = run(&[&["tradeoff", "spline"], arguments].concat());
        assert_eq!((said.code, said.out.as_str()), (2, ""), "{}", said.err);
        assert!(said.err.contains(words) && said.err.lines().count() == 1, "{}", said.err);
    }
}
