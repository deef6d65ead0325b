//! The suite of form factors through exact visibility: pieces in the frame of
//! the emitter, with the horizon cut in that frame.

use crate::lit::{Lit, Roomy, scene, surface};
use glam::DVec3;
use isolux::geometry::Receiver;
use isolux::number::SoftRoot;
use isolux::visibility::Gathered;
use isolux_host::scene::polygon::measure;
use serde_json::Value;
use std::collections::BTreeMap;

/// The error of every case by pieces, per class: absolute, less what the
/// subtraction of coordinates next to an edge costs any method.
fn worst_by_class(with_irrelevant: bool) -> BTreeMap<String, (f64, usize)> {
    let mut worst = BTreeMap::new();
    let mut exact = Roomy::<f32>::new();
    for line in include_str!("../data/form-factor.jsonl").lines() {
        let case: Value = serde_json::from_str(line).expect("a case a line");
        let vector =
            |value: &Value| DVec3::from([0, 1, 2].map(|i| value[i].as_f64().expect("a number")));
        let vertices: Vec<DVec3> = case["v"]
            .as_array()
            .expect("a list")
            .iter()
            .map(vector)
            .collect();
        let (place, normal) = (vector(&case["p"]), vector(&case["n"]));
        let class = case["cls"].as_str().expect("a class").to_owned();
        let Ok(measured) = measure(&vertices) else {
            continue;
        };
        if class == "onplane" || (place - vertices[0]).dot(measured.normal) <= 0.0 {
            continue;
        }
        let light = surface(vertices.clone(), 1.0);
        let mut surfaces = vec![light];
        if with_irrelevant {
            // Behind the receiver's horizon, as wide as the emitter.
            let behind = |v: &DVec3| place - (*v - place);
            surfaces.push(surface(vertices.iter().map(behind).collect(), 0.0));
        }
        let lit = Lit::new(&scene(surfaces));
        let single = |v: DVec3| v.to_array().map(|x| x as f32);
        let at = Receiver::<f32>::new::<SoftRoot>(single(place), single(normal)).expect("one");
        let mut f = 0.0;
        for (_, emitter) in &lit.emitters {
            let list = emitter.blockers().iter().copied();
            let found = exact.gather(&at, &emitter.target(), &lit.occlusion.records(), list);
            assert!(matches!(found, Gathered::Dark | Gathered::Whole), "{line}");
            if found == Gathered::Whole {
                f += f64::from(exact.form_factor::<SoftRoot>().low);
            }
        }
        let truth: f64 = case["F"]
            .as_str()
            .expect("digits")
            .parse()
            .expect("30 digits");
        let error = (f - truth).abs();
        let entry: &mut (f64, usize) = worst.entry(class).or_default();
        entry.0 = entry.0.max(error);
        entry.1 += 1;
    }
    worst
}

#[test]
fn horizon_caps_survive_the_frame() {
    for with_irrelevant in [false, true] {
        let worst = worst_by_class(with_irrelevant);
        for (class, (error, count)) in &worst {
            println!("{class:16} {count:4} cases: {error:.1e}");
        }
        assert!(worst["near_plane"].0 <= 2.5e-7, "{:?}", worst["near_plane"]);
        assert!(worst["ordinary"].0 <= 2.5e-7, "{:?}", worst["ordinary"]);
    }
}
