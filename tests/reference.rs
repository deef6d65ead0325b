//! The reference against results of other systems, laws and extremes.

use std::collections::BTreeMap;

use glam::DVec3;
use isolux_host::reference::form_factor;
use serde_json::Value;

fn number(value: &Value) -> f64 {
    value.as_f64().expect("a number")
}

fn vector(value: &Value) -> DVec3 {
    DVec3::new(number(&value[0]), number(&value[1]), number(&value[2]))
}

fn vertices(value: &Value) -> Vec<DVec3> {
    value
        .as_array()
        .expect("a list")
        .iter()
        .map(vector)
        .collect()
}

#[test]
fn the_suite_of_cases_is_met_class_by_class() {
    let mut worst: BTreeMap<String, (usize, f64, f64)> = BTreeMap::new();
    for line in include_str!("data/form-factor.jsonl").lines() {
        let case: Value = serde_json::from_str(line).expect("a case");
        let polygon = vertices(&case["v"]);
        let value = form_factor(vector(&case["p"]), vector(&case["n"]), &polygon);
        let exact: f64 = case["F"]
            .as_str()
            .and_then(|digits| digits.parse().ok())
            .expect("digits");
        let error = (value - exact).abs();
        let entry = worst
            .entry(case["cls"].as_str().expect("a class").to_owned())
            .or_default();
        entry.0 += 1;
        entry.1 = entry.1.max(error);
        if exact > 0.0 {
            entry.2 = entry.2.max(error / exact);
        }
    }
    for (class, (count, absolute, relative)) in &worst {
        println!("{class:<12} {count:>4} {absolute:9.1e} {relative:9.1e}");
    }
}
