//! The suite of point-to-polygon form factors made by an independent system
//! with 80 digits, per class and per rung.

use isolux::form_factor::{Best, Libm, form_factor};
use isolux::geometry::Receiver;
use isolux::number::SoftRoot;
use serde::Deserialize;
use std::collections::BTreeMap;

#[derive(Deserialize)]
struct Case {
    cls: String,
    p: [f64; 3],
    n: [f64; 3],
    v: Vec<[f64; 3]>,
    #[serde(rename = "F")]
    f: String,
}

fn cases() -> Vec<Case> {
    include_str!("data/form-factor.jsonl")
        .lines()
        .map(|line| serde_json::from_str(line).expect("a case a line"))
        .collect()
}

fn single(v: [f64; 3]) -> [f32; 3] {
    v.map(|x| x as f32)
}

#[test]
fn print() {
    let mut worst: BTreeMap<String, [(f64, f64); 4]> = BTreeMap::new();
    for case in cases() {
        let exact: f64 = case.f.parse().unwrap();
        let vertices: Vec<[f32; 3]> = case.v.iter().map(|&v| single(v)).collect();
        let r32 = Receiver::new::<SoftRoot>(single(case.p), single(case.n)).unwrap();
        let r64 = Receiver::new::<SoftRoot>(case.p, case.n).unwrap();
        let got = [
            f64::from(form_factor::<Best, f32>(&r32, &vertices)),
            f64::from(form_factor::<Libm, f32>(&r32, &vertices)),
            form_factor::<Best, f64>(&r64, &case.v),
            form_factor::<Libm, f64>(&r64, &case.v),
        ];
        let row = worst.entry(case.cls).or_default();
        for (w, g) in row.iter_mut().zip(got) {
            w.0 = w.0.max((g - exact).abs());
            if exact > 0.0 {
                w.1 = w.1.max((g / exact - 1.0).abs());
            }
        }
    }
    for (class, row) in worst {
        print!("{class:12}");
        for (a, r) in row {
            print!("  {a:8.1e} {r:8.1e}");
        }
        println!();
    }
}
