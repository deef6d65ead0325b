//! Against irradiances by other systems.

use crate::fixtures::{file_scene, triple, vector};
use crate::{Place, baked, single};
use glam::{DQuat, DVec3};
use isolux::shoot::Stop;
use isolux_host::scene::Scene;
use isolux_host::solve::{self, Rung, Sight};
use serde_json::Value;

const PENUMBRA: &str = include_str!("../data/references/d_penumbra_h0.5.json");
const CORNELL: &str = include_str!("../data/references/c_cornell_grey.json");
const CORNELL_RGB: &str = include_str!("../data/references/c_cornell_rgb.json");
const OFFICE: &str = include_str!("../data/references/e_office.json");

struct File {
    scene: Scene,
    places: Vec<Place>,
    points: Vec<Value>,
}

fn read(text: &str) -> File {
    let file: Value = serde_json::from_str(text).expect("JSON");
    let points = file["points"].as_array().expect("points").clone();
    File {
        scene: file_scene(&file),
        places: points
            .iter()
            .map(|point| (vector(&point["p"]), vector(&point["n"])))
            .collect(),
        points,
    }
}

impl File {
    fn turned(mut self, turn: DQuat) -> Self {
        for surface in &mut self.scene.surfaces {
            surface.normal = turn * surface.normal;
            for vertex in &mut surface.vertices {
                *vertex = turn * *vertex;
            }
        }
        for (place, normal) in &mut self.places {
            (*place, *normal) = (turn * *place, turn * *normal);
        }
        self
    }

    /// Every channel of every point: kernel, published, the published
    /// uncertainty.
    fn solved(&self, stop: Stop, value: &str, uncertainty: &str) -> Vec<[f64; 3]> {
        let tables = baked(&self.scene);
        let solution = solve::solve(&tables, Rung::Best, Sight::Exact, stop).expect("a solution");
        let answers = solution.at(&single(&self.places)).expect("receivers");
        answers
            .iter()
            .zip(&self.points)
            .flat_map(|(at, point)| {
                assert!(at.is_exact);
                let exact = triple(point.get(value).unwrap_or(&point["E"]));
                let unsure = point.get(uncertainty).map_or([0.0; 3], triple);
                (0..3).map(move |c| [f64::from(at.value[c]), exact[c], unsure[c]])
            })
            .collect()
    }
}

fn quantile(mut errors: Vec<f64>, q: f64) -> f64 {
    errors.sort_by(f64::total_cmp);
    errors[((errors.len() - 1) as f64 * q) as usize]
}

#[test]
fn direct_light_is_that_of_the_references_also_turned() {
    let turn = DQuat::from_axis_angle(DVec3::new(0.3, -0.5, 0.8).normalize(), 1.1);
    for (name, text) in [
        ("penumbra", PENUMBRA),
        ("cornell", CORNELL),
        ("office", OFFICE),
    ] {
        for file in [read(text), read(text).turned(turn)] {
            let found = file.solved(Stop::Reflections(0), "E_direct", "-");
            let largest = found.iter().map(|v| v[1]).fold(0.0, f64::max);
            let lit = found.iter().filter(|v| v[1] > 1e-3 * largest);
            let errors: Vec<f64> = lit.map(|v| (v[0] - v[1]).abs() / v[1]).collect();
            let (p95, max) = (quantile(errors.clone(), 0.95), quantile(errors, 1.0));
            assert!(p95 <= 1e-5, "{name}: p95 {p95:e}");
            assert!(max <= 1e-3, "{name}: max {max:e}");
            for dark in found.iter().filter(|v| v[1] == 0.0) {
                assert!(dark[0] <= 1e-6 * largest, "{name}: {dark:?} should be dark");
            }
        }
    }
}

#[test]
fn all_light_is_that_of_the_references() {
    for (name, text) in [
        ("cornell", CORNELL),
        ("rgb", CORNELL_RGB),
        ("office", OFFICE),
    ] {
        let found = read(text).solved(Stop::below(1e-3), "E_total", "u_total");
        let beyond = |[got, exact, unsure]: [f64; 3]| {
            ((got - exact).abs() - 3.0 * unsure - 1e-3 * exact).max(0.0) / exact
        };
        let errors: Vec<f64> = found.into_iter().map(beyond).collect();
        let [median, p95, max] = [0.5, 0.95, 1.0].map(|q| quantile(errors.clone(), q));
        println!("{name}: beyond 3 u + 0.1 %: median {median:.2e}, p95 {p95:.2e}, max {max:.2e}");
        assert!(median <= 5e-3, "{name}: median {median:e}");
        assert!(p95 <= 2e-2, "{name}: p95 {p95:e}");
    }
}
