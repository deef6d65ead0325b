//! What a plan of patches promises.

use crate::fixtures::{file_scene, scene, surface};
use crate::planned;
use glam::{DVec2, DVec3};
use isolux_host::plan::Tag;
use isolux_host::scene::{Body, Scene};

/// A floor with a block on it, slantwise, and a light above.
fn block() -> Scene {
    let corner = |x: f64, y: f64, z: f64| DVec3::new(x, y, z);
    let (cos, sin) = (0.3_f64.cos(), 0.3_f64.sin());
    let at =
        |x: f64, y: f64, z: f64| DVec3::new(2.0 + cos * x - sin * y, 2.0 + sin * x + cos * y, z);
    let mut surfaces = vec![
        surface(
            "floor",
            vec![
                corner(0.0, 0.0, 0.0),
                corner(5.0, 0.0, 0.0),
                corner(4.0, 4.0, 0.0),
                corner(0.0, 4.0, 0.0),
            ],
            0.5,
            0.0,
        ),
        surface(
            "light",
            vec![
                corner(1.0, 1.0, 3.0),
                corner(1.0, 2.0, 3.0),
                corner(2.0, 2.0, 3.0),
                corner(2.0, 1.0, 3.0),
            ],
            0.0,
            1.0,
        ),
    ];
    let base = [[-0.5, -0.7], [0.5, -0.7], [0.5, 0.7], [-0.5, 0.7]];
    let top = base.map(|[x, y]| at(x, y, 1.0));
    surfaces.push(surface("top", top.to_vec(), 0.5, 0.0));
    for k in 0..4 {
        let ([a, b], [c, d]) = (base[k], base[(k + 1) % 4]);
        let side = vec![at(a, b, 0.0), at(c, d, 0.0), at(c, d, 1.0), at(a, b, 1.0)];
        surfaces.push(surface(&format!("side-{k}"), side, 0.5, 0.0));
    }
    let mut scene = scene(surfaces);
    scene.bodies.push(Body {
        name: "block".to_owned(),
        surfaces: (2..7).collect(),
    });
    scene
}

fn area(ring: &[[f64; 2]]) -> f64 {
    let next = ring.iter().cycle().skip(1);
    let twice = ring.iter().zip(next);
    twice
        .map(|(a, b)| 0.5 * DVec2::from(*a).perp_dot((*b).into()))
        .sum()
}

#[test]
fn patches_tile_what_is_exposed() {
    let scene = block();
    let plan = planned(&scene);
    for (surface, planned) in scene.surfaces.iter().zip(&plan.surfaces) {
        let exposed = match surface.name.as_str() {
            "floor" => surface.area - 1.4,
            "light" => 0.0,
            _ => surface.area,
        };
        let patches: f64 = planned.patches.iter().map(|patch| patch.area).sum();
        assert!(
            (patches - exposed).abs() < 1e-6,
            "{}: {patches}",
            surface.name
        );
        for patch in &planned.patches {
            let pieces: f64 = patch.pieces.iter().map(|piece| area(piece)).sum();
            assert!((pieces - patch.area).abs() < 1e-9);
            for corner in patch.pieces.iter().flatten() {
                let off = DVec2::from(*corner).distance(patch.center.into());
                assert!(off <= patch.scale * (1.0 + 1e-12));
            }
        }
    }
}

/// Every patch gets a constant field exactly from either kind of samples,
/// without a gradient, and a quadrilateral a linear one. Of a sliver the few places
/// may lie on a line and tell no gradient across it, so no more is promised there.
#[test]
fn weights_reproduce_constant_and_linear_fields() {
    let plan = planned(&block());
    let linear = |[u, v]: [f64; 2]| 3.0 + 0.7 * u - 0.4 * v;
    let constant = |_: [f64; 2]| 3.0;
    let mut quadrilaterals = 0;
    for planned in &plan.surfaces {
        for patch in &planned.patches {
            let whole = matches!(&patch.pieces[..], [piece] if piece.len() == 4);
            quadrilaterals += usize::from(whole);
            for tag in [Tag::Direct, Tag::Reflected] {
                let off = |field: &dyn Fn([f64; 2]) -> f64| -> f64 {
                    let own = patch.members.iter();
                    let own = own.filter(|(member, _)| planned.samples[*member].tag == tag);
                    let mut fit = [0.0; 3];
                    for (member, weights) in own {
                        let value = field(planned.samples[*member].place);
                        for (sum, weight) in fit.iter_mut().zip(weights) {
                            *sum += weight * value;
                        }
                    }
                    let [mean, along_a, along_b] = fit;
                    let corners = patch.pieces.iter().flatten();
                    let missed = corners.map(|corner| {
                        let own = DVec2::from(*corner) - DVec2::from(patch.center);
                        let own = own / patch.scale;
                        (mean + along_a * own.x + along_b * own.y - field(*corner)).abs()
                    });
                    missed.fold(0.0, f64::max)
                };
                assert!(off(&constant) <= 1e-9, "{tag:?}: constant in {patch:?}");
                if whole {
                    assert!(off(&linear) <= 1e-9, "{tag:?}: linear in {patch:?}");
                }
            }
        }
    }
    assert!(quadrilaterals > 50, "{quadrilaterals}");
}

#[test]
fn a_budget_of_samples_is_kept() {
    let text = include_str!("../data/references/c_cornell_grey.json");
    let mut scene = file_scene(&serde_json::from_str(text).expect("JSON"));
    for samples in [200, 687, 2000] {
        scene.budget.samples = Some(samples);
        let planned = planned(&scene).samples() as u64;
        assert!(planned <= samples, "{planned} of {samples}");
        assert!(planned > samples / 2, "{planned} of {samples}");
    }
}
