//! Laws that hold in every scene, over random ones.

use crate::lit::{Lit, Roomy, receiver, scene, surface, unoccluded};
use crate::random::Random;
use glam::DVec3;
use isolux::form_factor::SeenPlane;
use isolux::number::SoftRoot;
use isolux::visibility::records::Blocker;
use isolux::visibility::{Exact, Gathered};
use isolux_host::occlusion::Emitter;

/// Numbers of occluders, and their size in metres.
const SETTINGS: [(usize, f64); 6] = [
    (1, 0.5),
    (3, 0.6),
    (6, 0.4),
    (20, 0.3),
    (40, 0.3),
    (60, 0.12),
];

/// One case per random scene and receiver: calls `judge` with both and the
/// unoccluded form factor.
fn in_random_scenes(seed: u64, mut judge: impl FnMut(&Lit, (DVec3, DVec3), &Emitter)) {
    let mut random = Random(seed);
    for (occluders, size) in SETTINGS {
        for _ in 0..60 {
            let lit = random.lit(occluders, size);
            for _ in 0..8 {
                let at = random.receiver();
                for (_, emitter) in &lit.emitters {
                    judge(&lit, at, emitter);
                }
            }
        }
    }
}

/// What of an error, as a part of F, is not the form factor's own: half angles
/// err by up to 2.5e-8 whatever F is (2.5e-7 is what `Best` promises), which is
/// more than 1e-6 of it for a receiver that sees a large emitter at a glance.
fn beyond_own(error: f64, whole: f64) -> f64 {
    (error - 2.5e-8) / whole.max(1e-12)
}

#[test]
fn single_precision_stays_within_a_millionth_of_f() {
    let (mut single, mut double) = (Roomy::<f32>::new(), Roomy::<f64>::new());
    let (mut worst, mut count) = (0.0_f64, 0);
    in_random_scenes(1, |lit, (place, normal), emitter| {
        let at = receiver::<f32>(place, normal);
        // The truth takes the normal that single precision rounded.
        let exact_normal = DVec3::from(<[f32; 3]>::from(at.normal()).map(f64::from));
        let at64 = receiver::<f64>(place, exact_normal);
        let f = lit.form_factor(&mut single, &at, emitter);
        let truth = lit.form_factor(&mut double, &at64, emitter);
        assert!(f.is_exact() && truth.is_exact());
        let whole = unoccluded(&at64, emitter);
        let error = (f64::from(f.low) - truth.low).abs();
        worst = worst.max(beyond_own(error, whole));
        count += usize::from(truth.low < 0.999 * whole);
    });
    println!("f32 against f64: {worst:.1e} of F over {count} receivers in shadow");
    assert!(count > 1000 && worst < 1e-6, "{worst:e}");
}

#[test]
fn what_is_seen_is_between_nothing_and_all() {
    let mut exact = Roomy::<f32>::new();
    in_random_scenes(2, |lit, (place, normal), emitter| {
        let at = receiver::<f32>(place, normal);
        let f = lit.form_factor(&mut exact, &at, emitter);
        assert!(f.low >= 0.0 && f.high <= unoccluded(&at, emitter), "{f:?}");
    });
}

/// F behind these blockers, as pieces, so that no ceiling hides a mistake.
fn pieces(
    exact: &mut Roomy,
    lit: &Lit,
    at: (DVec3, DVec3),
    emitter: &Emitter,
    list: &[Blocker],
) -> f32 {
    let at = receiver::<f32>(at.0, at.1);
    let (target, occluders) = (emitter.target(), lit.occlusion.records());
    match exact.gather(&at, &target, &occluders, list.iter().copied()) {
        Gathered::Dark => 0.0,
        Gathered::Whole | Gathered::Partly => exact.form_factor::<SoftRoot>().low,
        Gathered::Overflow => panic!("room for all"),
    }
}

#[test]
fn another_occluder_never_adds_light() {
    let mut exact = Roomy::new();
    let mut worst = 0.0_f64;
    in_random_scenes(3, |lit, at, emitter| {
        let list = emitter.blockers();
        let whole = pieces(&mut exact, lit, at, emitter, &[]);
        let mut before = whole;
        for count in 1..=list.len() {
            let f = pieces(&mut exact, lit, at, emitter, &list[..count]);
            worst = worst.max(beyond_own((f - before).into(), whole.into()));
            before = f;
        }
    });
    println!("another occluder adds at most {worst:.1e} of F");
    assert!(worst < 1e-6, "{worst:e}");
}

#[test]
fn the_order_of_occluders_matters_to_rounding_only() {
    let mut exact = Roomy::new();
    let mut random = Random(11);
    let mut worst = 0.0_f64;
    in_random_scenes(4, |lit, at, emitter| {
        let mut list = emitter.blockers().to_vec();
        let whole = pieces(&mut exact, lit, at, emitter, &[]);
        let f = pieces(&mut exact, lit, at, emitter, &list);
        for i in (1..list.len()).rev() {
            list.swap(i, random.below(i + 1));
        }
        let shuffled = pieces(&mut exact, lit, at, emitter, &list);
        worst = worst.max(beyond_own((f - shuffled).abs().into(), whole.into()));
    });
    println!("another order changes at most {worst:.1e} of F");
    assert!(worst < 1e-6, "{worst:e}");
}

/// Whether the segment from `from` to `to` meets a convex polygon.
fn meets(polygon: &[DVec3], normal: DVec3, from: DVec3, to: DVec3) -> bool {
    let (a, b) = (
        (from - polygon[0]).dot(normal),
        (to - polygon[0]).dot(normal),
    );
    let place = from + (to - from) * (a / (a - b));
    a * b < 0.0
        && (0..polygon.len()).all(|i| {
            let along = polygon[(i + 1) % polygon.len()] - polygon[i];
            normal.cross(along).dot(place - polygon[i]) >= 0.0
        })
}

#[test]
fn pieces_are_those_that_rays_find() {
    // Shares nothing with the kernel: a triangle fan of the emitter, sampled.
    let mut random = Random(21);
    let mut exact = Roomy::<f64>::new();
    for round in 0..60 {
        let mut surfaces = vec![random.emitter()];
        surfaces.extend((0..1 + round % 8).map(|_| random.occluder(0.6)));
        if round % 3 == 0 {
            surfaces.extend(random.block(0.6));
        }
        let lit = Lit::new(&scene(surfaces.clone()));
        let (place, normal) = random.receiver();
        let f = lit.irradiance(&mut exact, place, normal) / std::f64::consts::PI;
        let (light, occluders) = surfaces.split_first().expect("an emitter");
        let (mut sum, samples) = (0.0, 20_000);
        let fan: Vec<_> = light.vertices[1..].windows(2).collect();
        for pair in &fan {
            let (u, v) = (pair[0] - light.vertices[0], pair[1] - light.vertices[0]);
            let area = 0.5 * u.cross(v).length();
            for i in 0..samples {
                // The additive recurrence of Roberts 2018.
                let (mut s, mut t) = (
                    (i as f64 * 0.754_877_666_246_692_8).fract(),
                    (i as f64 * 0.569_840_290_998_053_2).fract(),
                );
                if s + t > 1.0 {
                    (s, t) = (1.0 - s, 1.0 - t);
                }
                let to = light.vertices[0] + u * s + v * t;
                let ray = to - place;
                let cosines = normal.dot(ray).max(0.0) * (-light.normal.dot(ray)).max(0.0);
                let hidden = occluders
                    .iter()
                    .any(|o| meets(&o.vertices, o.normal, place, to));
                if !hidden {
                    sum += area / f64::from(samples) * cosines
                        / (std::f64::consts::PI * ray.length_squared().powi(2));
                }
            }
        }
        let whole: f64 = unoccluded(&receiver(place, normal), &lit.emitters[0].1);
        assert!(
            (f - sum).abs() < 3e-3 * whole,
            "round {round}: {f} {sum} of {whole}"
        );
    }
}

#[test]
fn exchange_is_reciprocal_behind_an_occluder() {
    // A_i F_ij = A_j F_ji, integrated over 48 x 48 places of either square.
    let square = |z: f64, side: f64, up: bool| -> Vec<DVec3> {
        let mut corners = vec![
            DVec3::new(-side, -side, z),
            DVec3::new(side, -side, z),
            DVec3::new(side, side, z),
            DVec3::new(-side, side, z),
        ];
        if !up {
            corners.reverse();
        }
        corners
    };
    let tilted = [[-0.4, -0.5, 0.8], [0.5, -0.4, 1.0], [0.3, 0.6, 1.3]].map(DVec3::from);
    let exchange = |from: (f64, f64, bool), to: (f64, f64, bool)| {
        let light = surface(square(to.0, to.1, to.2), 1.0);
        let lit = Lit::new(&scene(vec![light, surface(tilted.to_vec(), 0.0)]));
        let mut exact = Roomy::<f32>::new();
        let (steps, mut sum) = (48, 0.0);
        for i in 0..steps {
            for j in 0..steps {
                let step = |k: i32| (f64::from(k) + 0.5) / f64::from(steps) * 2.0 - 1.0;
                let place = DVec3::new(from.1 * step(i), from.1 * step(j), from.0);
                let normal = if from.2 { DVec3::Z } else { DVec3::NEG_Z };
                sum += lit.irradiance(&mut exact, place, normal);
            }
        }
        sum * 4.0 * from.1 * from.1 / f64::from(steps * steps)
    };
    let (floor, ceiling) = ((0.0, 1.0, true), (2.0, 0.7, false));
    let (there, back) = (exchange(floor, ceiling), exchange(ceiling, floor));
    assert!((there / back - 1.0).abs() < 2e-4, "{there} {back}");
}

#[test]
fn a_body_hides_what_its_faces_hide() {
    let mut random = Random(31);
    let mut exact = Roomy::<f32>::new();
    let mut worst = 0.0_f64;
    for round in 0..200 {
        let light = random.emitter();
        let blocks: Vec<_> = (0..1 + round % 3).flat_map(|_| random.block(0.6)).collect();
        let mut faces = vec![light.clone()];
        // Inside out, they do not make a body.
        faces.extend(
            blocks
                .iter()
                .map(|face| surface(face.vertices.iter().rev().copied().collect(), 0.0)),
        );
        let mut bodies = vec![light];
        bodies.extend(blocks);
        let (bodies, faces) = (Lit::new(&scene(bodies)), Lit::new(&scene(faces)));
        let count = |lit: &Lit| lit.emitters[0].1.blockers().len();
        assert!(count(&bodies) < count(&faces));
        for _ in 0..10 {
            let (place, normal) = random.receiver();
            let at = receiver::<f32>(place, normal);
            let as_bodies = bodies.form_factor(&mut exact, &at, &bodies.emitters[0].1);
            let as_faces = faces.form_factor(&mut exact, &at, &faces.emitters[0].1);
            let whole = unoccluded(&at, &bodies.emitters[0].1);
            let error = (as_bodies.low - as_faces.low).abs();
            worst = worst.max(beyond_own(error.into(), whole.into()));
        }
    }
    println!("bodies and their faces differ by at most {worst:.1e} of F");
    assert!(worst < 1e-6, "{worst:e}");
}

#[test]
fn pieces_come_as_polygons_in_the_frame_of_the_target() {
    // Their areas add up to the target's, and their edges are straight.
    let mut random = Random(41);
    let mut exact = Roomy::<f64>::new();
    for _ in 0..200 {
        let lit = random.lit(6, 0.4);
        let (_, emitter) = &lit.emitters[0];
        let (place, normal) = random.receiver();
        let at = receiver::<f64>(place, normal);
        let list = emitter.blockers().iter().copied();
        if exact.gather(&at, &emitter.target(), &lit.occlusion.records(), list) != Gathered::Partly
        {
            continue;
        }
        let seen = exact.fold((0.0, 0.0), |sum, piece| {
            let corners: Vec<[f64; 2]> = piece.corners().to_vec();
            let plane: &SeenPlane<f64> = piece.plane();
            assert!(plane.facing.dot(plane.normal) < 2.0);
            for i in 0..corners.len() {
                let ([a, b], [c, d]) = (corners[i], corners[(i + 1) % corners.len()]);
                sum.0 += 0.5 * (a * d - b * c);
                assert!(a.abs() <= 1.0 + 1e-9 && b.abs() <= 1.0 + 1e-9);
            }
            sum.1 += piece.form_factor::<SoftRoot>();
        });
        assert!(seen.is_complete());
        let f = lit.form_factor(&mut exact, &at, emitter);
        assert!(seen.visible.0 >= 0.0 && seen.visible.0 <= 4.0);
        assert!((f.low - seen.visible.1).abs() < 2e-8, "{f:?} {seen:?}");
    }
}

#[test]
fn where_a_bound_is_met_the_truth_is_in_the_bracket() {
    fn judge<const V: usize, const P: usize, const L: usize, const B: usize>() -> (usize, usize) {
        let (mut roomy, mut tight) = (Roomy::<f32>::new(), Exact::<V, P, L, B>::new());
        let (mut met, mut all) = (0, 0);
        in_random_scenes(5, |lit, (place, normal), emitter| {
            let at = receiver::<f32>(place, normal);
            let truth = lit.form_factor(&mut roomy, &at, emitter);
            let f = lit.form_factor(&mut tight, &at, emitter);
            let slack = 2e-6 * unoccluded(&at, emitter);
            assert!(
                f.low <= truth.low + slack && f.high >= truth.low - slack,
                "{f:?} {truth:?}"
            );
            met += usize::from(!f.is_exact());
            all += 1;
        });
        (met, all)
    }
    for (met, all) in [
        judge::<8, 16, 64, 16>(),
        judge::<16, 4, 64, 16>(),
        judge::<16, 3, 64, 16>(),
        judge::<16, 1, 256, 64>(),
        judge::<12, 8, 32, 8>(),
        judge::<12, 8, 16, 4>(),
        judge::<12, 8, 3, 64>(),
        judge::<3, 8, 64, 16>(),
        judge::<0, 0, 0, 0>(),
    ] {
        println!("{met} of {all} answers are brackets");
        assert!(met > 0);
    }
}
