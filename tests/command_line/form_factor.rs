//! `isolux form-factor`.

use crate::program::{Ran, isolux, isolux_bytes};
use crate::refused;
use serde_json::Value;
use std::path::Path;

fn ask(arguments: &[&str], lines: &str) -> Ran {
    let arguments = [&["form-factor"], arguments].concat();
    isolux(&arguments, Path::new("."), lines)
}

/// Parallel to the receiver's plane, 1 above it: F = 0.554126.
const LIGHT: &str = r#""p":[0,0,0],"n":[0,0,1],"v":[[-1,-1,1],[-1,1,1],[1,1,1],[1,-1,1]]}"#;

fn question(id: &str) -> String {
    format!("{{\"id\":{id},{LIGHT}\n")
}

#[test]
fn answers_come_in_order_with_ids_as_given() {
    let ids = [
        "\"plain\"",
        "\"\\u00e9 \\\"quoted\\\"\"",
        "7",
        "-7",
        "1.5",
        "null",
        "true",
        "[1,\"a\"]",
        "{\"b\":1,\"a\":2}",
        "9007199254740993",
        "18446744073709551615",
        "\"\"",
        "\"plain\"",
    ];
    let lines: String = ids.iter().map(|id| question(id)).collect();
    let ran = ask(&[], &lines);
    assert_eq!((ran.code, ran.stderr.as_str()), (0, ""));
    let answers: Vec<Value> = ran
        .stdout
        .lines()
        .map(|line| serde_json::from_str(line).expect("JSON"))
        .collect();
    assert_eq!(answers.len(), ids.len());
    for (answer, id) in answers.iter().zip(ids) {
        let given: Value = serde_json::from_str(id).expect("JSON");
        assert_eq!(answer["id"], given);
        assert_eq!(answer.as_object().expect("an object").len(), 2);
        let f = answer["F"].as_f64().expect("a number");
        assert!((f - 0.554_126).abs() < 1e-6, "{f}");
    }
}

/// Digits that no number type of a parser holds are given back unchanged.
#[test]
fn ids_keep_their_digits() {
    for id in [
        "123456789012345678901234567890",
        "1.50",
        "1e3",
        "[ 1,  2 ]",
        "0.1000000000000000055511151231257827",
    ] {
        let ran = ask(&[], &question(id));
        assert_eq!(ran.code, 0);
        let kept = format!("{{\"id\":{id},");
        assert!(ran.stdout.starts_with(&kept), "{} for {id}", ran.stdout);
    }
}

#[test]
fn digits_are_the_shortest_that_round_trip() {
    let digits = |arguments: &[&str]| {
        let ran = ask(arguments, &question("0"));
        let (_, f) = ran
            .stdout
            .trim()
            .trim_end_matches('}')
            .rsplit_once(':')
            .expect("F");
        f.to_owned()
    };
    let single = digits(&[]);
    assert_eq!(single, single.parse::<f32>().expect("a number").to_string());
    let double = digits(&["--reference"]);
    assert_eq!(double, double.parse::<f64>().expect("a number").to_string());
    assert!(double.len() > single.len(), "{double} {single}");
}

#[test]
fn rungs_differ_and_agree() {
    let skew = r#"{"id":1,"p":[0.1,0.2,0.3],"n":[0.3,0.2,1],"v":[[-1,-1,1],[-1,1,1.5],[2,1,1.5],[2,-1,1]]}"#;
    let value = |arguments: &[&str]| {
        let ran = ask(arguments, skew);
        let answer: Value = serde_json::from_str(&ran.stdout).expect("JSON");
        answer["F"].as_f64().expect("a number")
    };
    let reference = value(&["--reference"]);
    assert_eq!(value(&[]), value(&["--arithmetic", "best"]));
    assert!((value(&["--arithmetic", "best"]) - reference).abs() < 2.5e-7);
    assert!((value(&["--arithmetic", "libm"]) - reference).abs() < 1e-6);
    // The flag comes before the answer: it is checked without a question.
    refused(&ask(&["--arithmetic", "bset"], ""), 2);
    // The integer rungs: clamped and cut to whole units of 2^−24 and 2^−29.
    for (rung, bits, error) in [("q24", 24, 5e-6), ("q29", 29, 5e-8)] {
        let fixed = value(&["--arithmetic", rung]);
        assert!((fixed - reference).abs() < error, "{rung} {fixed}");
        assert_eq!((fixed * f64::from(1_u32 << bits)).fract(), 0.0);
    }
    refused(&ask(&["--arithmetic", "best", "--reference"], ""), 2);
}

#[test]
fn empty_input_has_an_empty_answer() {
    for input in ["", "\n", "  \n\r\n"] {
        let ran = ask(&[], input);
        assert_eq!(
            (ran.code, ran.stdout.as_str(), ran.stderr.as_str()),
            (0, "", "")
        );
    }
    let ran = ask(&["--json"], "");
    assert_eq!((ran.code, ran.stdout.as_str()), (0, "[]\n"));
}

#[test]
fn json_is_one_document() {
    let ran = ask(&["--json"], &(question("1") + "\n" + &question("2")));
    let answers: Vec<Value> = serde_json::from_str(&ran.stdout).expect("one document");
    assert_eq!(answers.len(), 2);
    assert_eq!(
        (&answers[0]["id"], &answers[1]["id"]),
        (&1.into(), &2.into())
    );
}

#[test]
fn lines_of_other_systems_and_a_last_one_without_end() {
    let crlf = question("1").replace('\n', "\r\n") + question("2").trim_end();
    let ran = ask(&[], &crlf);
    assert_eq!((ran.code, ran.stdout.lines().count()), (0, 2));
}

#[test]
fn a_bad_line_is_named_and_nothing_is_answered() {
    let polygon = |n: usize| {
        let corners: Vec<String> = (0..n).map(|k| format!("[{k},{},1]", k * k)).collect();
        format!(
            r#"{{"id":1,"p":[0,0,0],"n":[0,0,1],"v":[{}]}}"#,
            corners.join(",")
        )
    };
    let bad = [
        "nonsense",
        "[]",
        "{}",
        r#"{"id":1}"#,
        r#"{"id":1,"p":[0,0],"n":[0,0,1],"v":[[0,0,1],[1,0,1],[0,1,1]]}"#,
        r#"{"id":1,"p":[0,0,0,0],"n":[0,0,1],"v":[[0,0,1],[1,0,1],[0,1,1]]}"#,
        r#"{"id":1,"p":["0",0,0],"n":[0,0,1],"v":[[0,0,1],[1,0,1],[0,1,1]]}"#,
        r#"{"id":1,"p":[0,0,0],"n":[0,0,0],"v":[[0,0,1],[1,0,1],[0,1,1]]}"#,
        r#"{"id":1,"p":[NaN,0,0],"n":[0,0,1],"v":[[0,0,1],[1,0,1],[0,1,1]]}"#,
        r#"{"id":1,"p":[1e39,0,0],"n":[0,0,1],"v":[[0,0,1],[1,0,1],[0,1,1]]}"#,
        r#"{"id":1,"p":[1e400,0,0],"n":[0,0,1],"v":[[0,0,1],[1,0,1],[0,1,1]]}"#,
        r#"{"id":1,"p":[0,0,0],"n":[0,0,1],"v":[[0,0,1],[1,0,1],[0,1,1]]} x"#,
        r#"{"p":[0,0,0],"n":[0,0,1],"v":[[0,0,1],[1,0,1],[0,1,1]]}"#,
        &polygon(2),
        &polygon(0),
        &polygon(33),
    ];
    for line in bad {
        for arguments in [&[][..], &["--reference"], &["--arithmetic", "libm"]] {
            let ran = ask(
                arguments,
                &(question("1") + "\n" + &question("2") + line + "\n" + &question("3")),
            );
            refused(&ran, 2);
            assert!(ran.stderr.contains("line 4"), "{line}: {}", ran.stderr);
            assert!(ran.stderr.contains("help"), "{line}: {}", ran.stderr);
        }
    }
    // Three and thirty-two are the limits.
    for n in [3, 32] {
        assert_eq!(ask(&[], &polygon(n)).code, 0);
    }
}

#[test]
fn bytes_that_are_no_text_are_refused_with_their_line() {
    let input = [question("1").as_bytes(), b"\xff\xfe\n"].concat();
    let ran = isolux_bytes(&["form-factor"], Path::new("."), &input);
    refused(&ran, 2);
    assert!(ran.stderr.contains("line 2"), "{}", ran.stderr);
}
