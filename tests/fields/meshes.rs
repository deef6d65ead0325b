//! Laws of grids and meshes: what is linear stays linear, a row says what the places
//! in it say, and what the host models is what the kernel does.

use crate::{open, room, shipped_scene};
use glam::DVec2;
use isolux::form_factor::Best;
use isolux::luminance::Linear;
use isolux::number::SoftRoot;
use isolux::resample::{Stencils, Tensors};
use isolux::scene::Scene;
use isolux::shoot::{Light, Stop};
use isolux::visibility::Exact;
use isolux_host::plan::fields::split::{Fine, Found, split};
use isolux_host::plan::fields::{shares, spline};
use proptest::prelude::*;

/// Rows and columns.
const SIDE: usize = 60;

/// A row gives what the places in it give, on grids and on meshes.
#[test]
fn a_row_says_what_its_places_say() {
    let scene = shipped_scene("penumbra.toml");
    let (_, tables) = room(&scene);
    let kernel = Scene::load(tables.bytes()).expect("sound tables");
    type Seeing = Exact<32, 16, 64, 32>;
    let light = Light::<Best, 256, 64, Linear<f32>, Seeing>::with_sight(kernel, Seeing::new());
    let mut light = Box::new(light.expect("room"));
    light.solve(Stop::below(1e-3));
    let index = scene.surface_named("receiver").expect("a surface");
    let mut room = vec![0.0; kernel.counts().room as usize];
    let surface = light
        .reconstruct::<Stencils<SoftRoot>>(index, &mut room)
        .expect("fields");
    let [width, height] = kernel.surface(index).expect("a surface").size;
    let mut row = [0.0; SIDE];
    for number in 0..SIDE {
        let grid = [SIDE as u32; 2];
        surface.row(grid, number as u32, &mut row).expect("a row");
        for (column, &value) in row.iter().enumerate() {
            let place = [(column, width), (number, height)]
                .map(|(k, size)| (k as f32 + 0.5) * (size / SIDE as f32));
            let at = surface.at(place);
            let most = 1e-4 * at.max(0.1);
            assert!(
                (at - value).abs() <= most,
                "{place:?}: {at} alone, {value} in its row"
            );
        }
    }
}

/// The kernel's tensor grid is the planner's.
#[test]
fn the_kernels_polynomials_are_the_planners() {
    let scene = shipped_scene("paper.toml");
    let (plan, tables) = open(&scene);
    let kernel = Scene::load(tables.bytes()).expect("sound tables");
    let mut light = Box::new(Light::<Best, 256, 128>::new(kernel).expect("room"));
    light.solve(Stop::below(1e-3));
    let mut room = vec![0.0; kernel.counts().room as usize];
    for (index, planned) in plan.surfaces.iter().enumerate() {
        let Some(tensor) = planned
            .fields
            .first()
            .and_then(|field| field.tensor.as_ref())
        else {
            continue;
        };
        let (first, _) = kernel.samples_of(kernel.surface(index).expect("a surface"));
        let values = light.irradiance()[first..][..tensor.samples()].iter();
        let values: Vec<f64> = values.map(|&value| f64::from(value)).collect();
        let through = tensor.through(&values).expect("light");
        let surface = light
            .reconstruct::<Tensors<SoftRoot>>(index, &mut room)
            .expect("a grid");
        for k in 0..400 {
            let (x, y) = ((k % 20) as f64 / 19.0, (k / 20) as f64 / 19.0);
            let place = [x * planned.frame.size_u, y * planned.frame.size_v];
            let (ours, theirs) = (
                through.at(place),
                f64::from(surface.at(place.map(|x| x as f32))),
            );
            assert!(
                (ours - theirs).abs() <= 2e-5 * ours,
                "{place:?}: {ours} and {theirs}"
            );
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 200, failure_persistence: None, ..ProptestConfig::default() })]

    /// A spline goes through every plane.
    #[test]
    fn splines_reproduce_planes(
        places in prop::collection::vec([-1.0..1.0_f64, -1.0..1.0_f64], 6..40),
        at in [-0.8..0.8_f64, -0.8..0.8_f64],
        plane in [-1.0..1.0_f64, -1.0..1.0_f64, -1.0..1.0_f64],
    ) {
        let value = |[u, v]: [f64; 2]| plane[0] + plane[1] * u + plane[2] * v;
        let weights = spline::weights(&places, at);
        let sum: f64 = weights.iter().map(|&(k, weight)| weight * value(places[k])).sum();
        // Where weights would be large the nearest place counts alone.
        prop_assume!(weights.len() > 1);
        prop_assert!((sum - value(at)).abs() < 1e-6, "{} for {}", sum, value(at));
    }

    /// Weights find a target that is made of samples.
    #[test]
    fn shares_reproduce_sums_of_samples(
        rows in prop::collection::vec(prop::collection::vec(0.1..1.0_f64, 12), 5..20),
        parts in prop::collection::vec(0.1..1.0_f64, 3),
    ) {
        let rows: Vec<Vec<f64>> = rows.iter().map(|parts| shares::row(parts, &[5, 7])).collect();
        let target: Vec<f64> = (0..rows[0].len())
            .map(|j| parts.iter().enumerate().map(|(k, part)| part * rows[k][j]).sum())
            .collect();
        let offered: Vec<(usize, &[f64])> = rows.iter().map(Vec::as_slice).enumerate().collect();
        let mut sum = vec![0.0; target.len()];
        for (k, weight) in shares::fit(&target, &offered, shares::MOST) {
            for (sum, x) in sum.iter_mut().zip(&rows[k]) {
                *sum += weight * x;
            }
        }
        // Within what samples may err by themselves.
        let length = |row: &[f64]| row.iter().map(|x| x * x).sum::<f64>().sqrt();
        let left: Vec<f64> = sum.iter().zip(&target).map(|(a, b)| a - b).collect();
        prop_assert!(length(&left) <= 0.02 * length(&target));
    }

    /// However triangles are split, they cover the same, and no corner lies on an
    /// edge.
    #[test]
    fn split_triangles_cover_what_they_did(bend in [0.1..0.9_f64, 0.1..0.9_f64]) {
        let places = vec![[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];
        let look = |places: &[[f64; 2]]| -> Vec<Found> {
            let value = |place: &[f64; 2]| DVec2::from(*place).distance(bend.into());
            places.iter().map(|place| Found { value: value(place), counts: 1.0, weight: 1.0 }).collect()
        };
        let fine = Fine { tolerance: 0.01, shortest: 0.01, most: 200 };
        let split = split(places, vec![[0, 1, 2], [0, 2, 3]], &look, fine);
        prop_assert!((split.areas().iter().sum::<f64>() - 1.0).abs() < 1e-12);
        for &[a, b, c] in &split.triangles {
            for [a, b] in [[a, b], [b, c], [c, a]] {
                let [a, b] = [a, b].map(|k| DVec2::from(split.places[k]));
                let middle: [f64; 2] = a.midpoint(b).into();
                prop_assert!(!split.places.contains(&middle), "a corner on an edge");
            }
        }
    }
}
