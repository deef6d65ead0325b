//! Nested emitters: their shapes, their power, and light that is even.

use crate::fixtures::{scene, surface};
use crate::{Place, single};
use glam::DVec3;
use isolux::Error;
use isolux::error::What;
use isolux::form_factor::Best;
use isolux::luminance::{Constant, Increment};
use isolux::scene::Scene as Loaded;
use isolux::shoot::{Light, Stop};
use isolux_host::bake::Tables;
use isolux_host::plan::{self, Plan, SurfacePlan};
use isolux_host::reference::{Reference, Reflections};
use isolux_host::scene::{Scene, file, shipped};
use isolux_host::solve::{self, Rung, Sight};
use isolux_host::{bake, compare};

/// The paper's scene, planned with layers by its light after one reflection.
fn layered() -> (Scene, Plan, Reference) {
    let (name, source) = shipped::ALL[0];
    let scene = file::parse(name, source).expect("a shipped scene");
    let once = Reference::new(&scene, Reflections::AtMost(1), &mut |_| {}).expect("a reference");
    let field = |places: &[Place]| once.irradiance_at(places);
    let plan = plan::layer_cake(&scene, &scene.budget, &field).expect("a plan");
    (scene, plan, once)
}

/// Twice the signed area of a loop.
fn doubled(at: &[[f64; 2]]) -> f64 {
    let next = at.iter().cycle().skip(1);
    let turns = at.iter().zip(next);
    turns.map(|(a, b)| a[0] * b[1] - a[1] * b[0]).sum()
}

/// How far a place lies outside of a convex loop, in metres.
fn outside(at: &[[f64; 2]], [u, v]: [f64; 2]) -> f64 {
    let next = at.iter().cycle().skip(1);
    let beyond = at.iter().zip(next).map(|(a, b)| {
        let along = [b[0] - a[0], b[1] - a[1]];
        (along[1] * (u - a[0]) - along[0] * (v - a[1])) / along[0].hypot(along[1])
    });
    beyond.fold(f64::NEG_INFINITY, f64::max)
}

/// Every layer is one loop without a hole, and lies in the one before.
#[test]
fn layers_are_nested_and_have_no_inner_loops() {
    let (_, plan, _) = layered();
    assert!(plan.is_layered());
    for planned in plan.surfaces.iter().filter(|s| !s.bands.is_empty()) {
        let outlines = planned.outlines();
        assert!(outlines.len() >= 2);
        for (layer, outline) in planned.bands.iter().zip(&outlines) {
            assert_eq!(outline.len(), 1);
            let area = doubled(&outline[0]) / 2.0;
            assert!((area / layer.area - 1.0).abs() < 1e-3, "{area} {layer:?}");
        }
        // The chords of a coarse outline cut off a little of the next.
        let chord = 0.02 * planned.frame.size_u;
        for pair in outlines.windows(2) {
            let out = pair[1][0].iter().map(|&place| outside(&pair[0][0], place));
            let most = out.fold(f64::NEG_INFINITY, f64::max);
            assert!(most <= chord, "a layer sticks out by {most} m");
        }
    }
}

/// What a surface sends for this light at its samples, where it reflects all.
fn sent(planned: &SurfacePlan, light: impl Fn([f64; 2]) -> f64) -> f64 {
    let layers = planned.shares().into_iter().zip(planned.areas());
    let of = |(shares, area): (Vec<(usize, f64)>, f64)| {
        let at = |(sample, share): (usize, f64)| share * light(planned.samples[sample].place);
        area * shares.into_iter().map(at).sum::<f64>()
    };
    layers.map(of).sum()
}

/// Of the light that is planned for, a surface sends all that it receives; and
/// light that is even is sent evenly, by the outermost layer alone.
#[test]
fn layers_send_all_power() {
    const SIDE: usize = 200;
    let (scene, plan, once) = layered();
    for (surface, planned) in scene.surfaces.iter().zip(&plan.surfaces) {
        if planned.bands.is_empty() {
            continue;
        }
        let frame = &planned.frame;
        let at = |u, v| once.irradiance_at(&[(frame.to_world(u, v), frame.normal)])[0];
        let cells = (0..SIDE * SIDE).map(|k| frame.cell_center(k % SIDE, k / SIDE, SIDE, SIDE));
        let mean = cells.map(|(u, v)| at(u, v)).sum::<f64>() / (SIDE * SIDE) as f64;
        let off = sent(planned, |[u, v]| at(u, v)) / (mean * surface.area) - 1.0;
        println!("{}: sends {off:+.1e} more than it receives", surface.name);
        assert!(off.abs() < 2e-3, "{}: {off:e}", surface.name);
        for (k, shares) in planned.shares().iter().enumerate() {
            let sum: f64 = shares.iter().map(|(_, share)| share).sum();
            let wanted = if k == 0 { 1.0 } else { 0.0 };
            assert!((sum - wanted).abs() < 1e-9, "layer {k}: {sum}");
        }
    }
}

/// What was shot is accounted for, where the paper's bands make a hundredth more;
/// and light reflected once reaches B as it truly does.
#[test]
fn light_of_layers_arrives() {
    const SIDE: usize = 20;
    let (scene, plan, once) = layered();
    let tables = bake::bake(&scene, &plan, None).expect("tables");
    let solve = |stop| solve::solve(&tables, Rung::Best, Sight::None, stop).expect("a solution");
    let all = solve(Stop::below(1e-3));
    assert!(all.solved.unshot < 1e-3);
    let balance = compare::balance(&scene, &plan, &all);
    let missing = balance.missing / balance.shot;
    let frame = &plan.surfaces[2].frame;
    let places: Vec<Place> = (0..SIDE * SIDE)
        .map(|k| frame.cell_center(k % SIDE, k / SIDE, SIDE, SIDE))
        .map(|(u, v)| (frame.to_world(u, v), frame.normal))
        .collect();
    let found = solve(Stop::Reflections(1)).at(&single(&places));
    let exact = once.irradiance_at(&places);
    let errors = found.expect("receivers").into_iter().zip(exact);
    let squares = errors.map(|(at, exact)| (f64::from(at.value[0]) / exact - 1.0).powi(2));
    let rms = (squares.sum::<f64>() / places.len() as f64).sqrt();
    println!("missing {missing:+.1e} of what was shot; B: rms {rms:.1e}");
    assert!(missing.abs() < 2e-3, "{missing:e}");
    assert!(rms < 3e-3, "{rms:e}");
}

/// Tables of layers are for increments alone, and no other tables are for them.
#[test]
fn layers_are_taken_by_increments_alone() {
    type Of<'t, L> = Light<'t, Best, 64, 16, L>;
    let (scene, plan, once) = layered();
    let field = |places: &[Place]| once.irradiance_at(places);
    let bands = plan::isolux(&scene, &scene.budget, &field).expect("a plan");
    let [layers, bands] = [&plan, &bands].map(|plan| bake::bake(&scene, plan, None));
    let [layers, bands] = [layers, bands].map(|tables| tables.expect("tables"));
    let loaded = |tables: &'_ Tables| Loaded::load(tables.bytes()).map(|s| s.counts().weights);
    let weights = loaded(&layers).expect("sound tables");
    assert!(weights > 0 && loaded(&bands) == Ok(0));
    let of_layers = Loaded::load(layers.bytes()).expect("sound tables");
    let of_bands = Loaded::load(bands.bytes()).expect("sound tables");
    assert!(Of::<Increment<f32>>::new(of_layers).is_ok());
    assert!(Of::<Constant<f32>>::new(of_bands).is_ok());
    let refused = |error: Option<Error>, needed, have| {
        let what = What::Weights;
        assert_eq!(error, Some(Error::Capacity { what, needed, have }));
    };
    refused(Of::<Constant<f32>>::new(of_layers).err(), weights, 0);
    let members = of_bands.counts().members;
    refused(Of::<Increment<f32>>::new(of_bands).err(), 0, members);
}

/// Where light is even there is one layer, the surface itself: what it sends has
/// the surface's own form factor.
#[test]
fn even_light_makes_one_layer_of_a_surface() {
    let at = |x: f64, y: f64, z: f64| DVec3::new(x, y, z);
    let floor = vec![
        at(0.0, 0.0, 0.0),
        at(4.0, 0.0, 0.0),
        at(4.0, 3.0, 0.0),
        at(0.0, 3.0, 0.0),
    ];
    let light = vec![
        at(0.0, 3.0, 2.0),
        at(4.0, 3.0, 2.0),
        at(4.0, 0.0, 2.0),
        at(0.0, 0.0, 2.0),
    ];
    let room = scene(vec![
        surface("floor", floor, 0.5, 0.0),
        surface("light", light, 0.0, 1.0),
    ]);
    let even = |places: &[Place]| vec![1.0; places.len()];
    let plan = plan::layer_cake(&room, &room.budget, &even).expect("a plan");
    let planned = &plan.surfaces[0];
    assert_eq!(planned.bands.len(), 1);
    let corners = [[0.0, 0.0], [4.0, 0.0], [4.0, 3.0], [0.0, 3.0]];
    let outline = &planned.outlines()[0][0];
    assert!((doubled(outline) - doubled(&corners)).abs() < 1e-12);
    assert!(corners.iter().all(|corner| outline.contains(corner)));
    assert!((sent(planned, |_| 2.0) - 2.0 * 12.0).abs() < 1e-5);
}
