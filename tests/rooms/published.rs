//! Against irradiances by other systems.

use crate::fixtures::{file_scene, triple, vector};
use crate::{Place, baked, followed, planned, single};
use glam::{DQuat, DVec3};
use isolux::shoot::Stop;
use isolux_host::bake::{self, Tables};
use isolux_host::occlusion::Occlusion;
use isolux_host::plan::Plan;
use isolux_host::scene::{Point, Scene};
use isolux_host::solve::{self, FormFactorRung, Rung, Sight};
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

    /// As the host plans it, within so many samples.
    fn planned(mut self, samples: Option<u64>) -> (Self, Tables) {
        self.scene.budget.samples = samples;
        let occlusion = Occlusion::of(&self.scene).expect("few vertices");
        let plan = followed(&self.scene);
        let tables = bake::bake(&self.scene, &plan, Some(occlusion)).expect("tables");
        (self, tables)
    }

    /// Every channel of every point: kernel, published, the published
    /// uncertainty.
    fn solved(&self, tables: &Tables, stop: Stop, keys: [&str; 2]) -> Vec<[f64; 3]> {
        let solution = solve::solve(tables, Rung::Best, Sight::Exact, stop).expect("a solution");
        let answers = solution.at(&single(&self.places)).expect("receivers");
        let [value, uncertainty] = keys;
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
            let tables = baked(&file.scene);
            let found = file.solved(&tables, Stop::Reflections(0), ["E_direct", "-"]);
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

/// All light, with the patches that the host chooses and with those that the
/// budgets of the shipped rooms allow. What the patches err by is 5.0e-3 (cornell) and
/// 5.9e-3 (in colour) once next to nothing is unshot; a thousandth of the light that is
/// still missing can hide as much of it or add to it.
#[test]
fn all_light_is_that_of_the_references() {
    for (name, text, samples, allowed) in [
        ("cornell", CORNELL, None, 6.5e-3),
        ("cornell, 687 samples", CORNELL, Some(687), 1.5e-2),
        ("rgb", CORNELL_RGB, None, 6.5e-3),
        ("rgb, 687 samples", CORNELL_RGB, Some(687), 1.6e-2),
        ("office", OFFICE, None, 5e-3),
        ("office, 800 samples", OFFICE, Some(800), 1e-2),
    ] {
        let (file, tables) = read(text).planned(samples);
        let found = file.solved(&tables, Stop::below(1e-3), ["E_total", "u_total"]);
        let beyond = |[got, exact, unsure]: [f64; 3]| {
            ((got - exact).abs() - 3.0 * unsure - 1e-3 * exact).max(0.0) / exact
        };
        let errors: Vec<f64> = found.into_iter().map(beyond).collect();
        let [median, p95, max] = [0.5, 0.95, 1.0].map(|q| quantile(errors.clone(), q));
        println!(
            "{name}: {} emitters, beyond 3 u + 0.1 %: median {median:.2e}, p95 {p95:.2e}, max {max:.2e}",
            tables.counts.emitters
        );
        assert!(median <= 1e-3, "{name}: median {median:e}");
        assert!(p95 <= allowed, "{name}: p95 {p95:e}");
    }
}

/// The places themselves as samples, lit in integers by rounded terms: what a core without
/// FPU says of them.
#[test]
fn terms_in_integers_are_near_the_references() {
    for (name, text, samples, allowed) in [
        ("cornell, 687 samples", CORNELL, 687, 1.5e-2),
        ("office, 800 samples", OFFICE, 800, 1e-2),
    ] {
        let mut file = read(text);
        let places = file.places.iter().enumerate();
        file.scene.points = places
            .map(|(index, &(position, normal))| Point {
                name: index.to_string(),
                position,
                normal,
            })
            .collect();
        file.scene.budget.samples = Some(samples);
        let occlusion = Some(Occlusion::of(&file.scene).expect("few vertices"));
        let plan = followed(&file.scene);
        let tables = bake::integers::bake_matrix(&file.scene, &plan, occlusion, 8);
        let tables = tables.expect("tables");
        for rung in [FormFactorRung::Q29, FormFactorRung::Q24] {
            let stop = Stop::below(1e-3);
            let solution = solve::solve(&tables, rung, Sight::Exact, stop).expect("a solution");
            let pairs = solution.points().into_iter().zip(&file.points);
            let errors: Vec<f64> = pairs
                .map(|(got, point)| {
                    let exact = triple(point.get("E_total").unwrap_or(&point["E"]))[0];
                    let unsure = point.get("u_total").map_or(0.0, |u| triple(u)[0]);
                    let beyond = (f64::from(got[0]) - exact).abs() - 3.0 * unsure - 1e-3 * exact;
                    beyond.max(0.0) / exact
                })
                .collect();
            let [median, p95, max] = [0.5, 0.95, 1.0].map(|q| quantile(errors.clone(), q));
            println!(
                "{name}, {}: beyond 3 u + 0.1 %: median {median:.2e}, p95 {p95:.2e}, max {max:.2e}",
                rung.name()
            );
            assert!(median <= 1e-3, "{name}: median {median:e}");
            assert!(p95 <= allowed, "{name}: p95 {p95:e}");
        }
    }
}

/// A plan for all luminaires of the office at full power serves no worse than one
/// that knows direct light alone when only one of them shines: judged by a finer
/// plan made for that light.
#[test]
fn a_plan_serves_when_luminaires_are_switched() {
    let mut file = read(OFFICE);
    let occlusion = Occlusion::of(&file.scene).expect("few vertices");
    file.scene.budget.samples = Some(800);
    let plans = [followed(&file.scene), planned(&file.scene)];
    let surfaces = file.scene.surfaces.iter().enumerate();
    let luminaires = surfaces.filter(|(_, surface)| surface.emits());
    let switched: Vec<usize> = luminaires.map(|(index, _)| index).skip(1).collect();
    for index in switched {
        file.scene.surfaces[index].radiance = [0.0; 3];
    }
    file.scene.budget.samples = None;
    let answers = |plan: &Plan| -> Vec<f64> {
        let tables = bake::bake(&file.scene, plan, Some(occlusion.clone())).expect("tables");
        let stop = Stop::below(1e-3);
        let solution = solve::solve(&tables, Rung::Best, Sight::Exact, stop).expect("a solution");
        let answers = solution.at(&single(&file.places)).expect("receivers");
        answers.iter().map(|at| f64::from(at.value[0])).collect()
    };
    let finer = answers(&followed(&file.scene));
    let [followed, planned] = plans.map(|plan| {
        let pairs = answers(&plan).into_iter().zip(&finer);
        let errors: Vec<f64> = pairs
            .map(|(got, finer)| (got / finer - 1.0).abs())
            .collect();
        [0.5, 0.95].map(|q| quantile(errors.clone(), q))
    });
    println!("office, one luminaire: median and p95 {followed:?}, by direct light {planned:?}");
    assert!(followed[0] <= 1.1 * planned[0], "{followed:?} {planned:?}");
    assert!(followed[1] <= 1.1 * planned[1], "{followed:?} {planned:?}");
    assert!(followed[1] <= 5e-2, "{followed:?}");
}
