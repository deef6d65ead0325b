//! The same laws on every rung of the ladder, as the device computes it, and on
//! `best` with a table of the emitter's edges.

use crate::NEAREST_EDGE;
use crate::exchange::{facing, inside, room};
use crate::extremes::{bits, edge};
use crate::shapes::{View, convex_view, many_cornered_view, upright_view, view};
use crate::symmetry::{moved, quarter_turns};
use glam::DVec3;
use isolux::Error;
use isolux::form_factor::{Baked, Edge, Outline, of_baked_loops};
use isolux::geometry::{Plane, Receiver};
use isolux::number::SoftRoot;
use isolux_host::reference;
use isolux_host::solve::FormFactorRung;
use proptest::prelude::*;

/// The rungs, and `None` for `best` with a table.
fn ladder() -> impl Iterator<Item = Option<FormFactorRung>> {
    FormFactorRung::ALL.into_iter().map(Some).chain([None])
}

/// A form factor and its bits on the device.
fn answer(
    rung: Option<FormFactorRung>,
    p: [f32; 3],
    n: [f32; 3],
    v: &[[f32; 3]],
) -> Result<(f64, u32), Error> {
    if let Some(rung) = rung {
        return rung.form_factor(p, n, v);
    }
    let receiver = Receiver::new::<SoftRoot>(p, n)?;
    let edges: Vec<Edge> = Edge::of_loop(v).collect();
    let baked = Baked::new(Outline::new(v), &edges);
    let found = of_baked_loops::<SoftRoot>(&receiver, &Plane::of_polygon(v), baked.into_iter());
    Ok((found.into(), found.to_bits()))
}

fn single(v: [f64; 3]) -> [f32; 3] {
    v.map(|x| x as f32)
}

fn seen(rung: Option<FormFactorRung>, view: &View) -> (f64, u32) {
    let v: Vec<_> = view.v.iter().map(|&v| single(v)).collect();
    answer(rung, single(view.p), single(view.n), &v).expect("a receiver")
}

/// What a rung may err by at L/h: its documented bound, and what happens next
/// to an edge.
fn allowed(rung: Option<FormFactorRung>, view: &View) -> f64 {
    let (count, conditioning) = (view.v.len() as f64, view.conditioning());
    let single = f64::from(f32::EPSILON) / 2.0;
    let near = NEAREST_EDGE * single * conditioning;
    match rung.map_or("baked", FormFactorRung::name) {
        "libm" => count * (6.0 * single).sqrt() / std::f64::consts::TAU + near,
        // A root that errs by 6 % and an arc tangent by 3e-3, of every edge.
        "micromath" => 2e-2 * count + near,
        "poly3" => 5e-5 * turns(view) + near,
        "poly5" => 6.5e-7 * turns(view) + near,
        "q24" => 5e-6 * turns(view),
        "q29" => 5e-8 * turns(view),
        _ => 2.5e-7 * turns(view) + near,
    }
}

/// The bounds are for angles that add up to one turn, as those of a convex
/// polygon do; a star's edges run to and fro.
fn turns(view: &View) -> f64 {
    let to = |k: usize| DVec3::from(view.v[k % view.v.len()]) - DVec3::from(view.p);
    let angles = (0..view.v.len()).map(|k| to(k).angle_between(to(k + 1)));
    (angles.sum::<f64>() / std::f64::consts::TAU).max(1.0)
}

fn exact(view: &View) -> f64 {
    let polygon: Vec<DVec3> = view.v.iter().map(|&v| v.into()).collect();
    reference::form_factor(view.p.into(), view.n.into(), &polygon)
}

fn judge(view: &View) -> Result<(), TestCaseError> {
    let exact = exact(view);
    for rung in ladder() {
        let ((got, _), allowed) = (seen(rung, view), allowed(rung, view));
        prop_assert!(
            (0.0..=1.0).contains(&got) && (got - exact).abs() <= allowed,
            "{rung:?}: {got:e} for {exact:e}, {:e} of {allowed:e}",
            (got - exact).abs()
        );
    }
    Ok(())
}

/// A form factor from 0 to 1, or a refusal.
fn bounded(p: [f32; 3], n: [f32; 3], v: &[[f32; 3]]) -> Result<(), TestCaseError> {
    for rung in ladder() {
        if let Ok((got, _)) = answer(rung, p, n, v) {
            prop_assert!((0.0..=1.0).contains(&got), "{rung:?}: {got}");
        }
    }
    Ok(())
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(3000))]

    #[test]
    fn any_bits_give_a_fraction(p in bits(), n in bits(), v in prop::collection::vec(bits(), 0..9)) {
        bounded(p, n, &v)?;
    }

    #[test]
    fn the_edges_of_arithmetic_give_a_fraction(p in edge(), n in edge(), v in prop::collection::vec(edge(), 0..9)) {
        let v: Vec<_> = v.into_iter().map(single).collect();
        bounded(single(p), single(n), &v)?;
    }

    #[test]
    fn what_is_not_finite_arrives_as_nothing_or_is_refused(view in view(), at in 0..12_usize, axis in 0..3_usize, bad in prop::sample::select(&[f32::NAN, f32::INFINITY, -f32::INFINITY][..])) {
        let mut v: Vec<_> = view.v.iter().map(|&v| single(v)).collect();
        let count = v.len();
        v[at % count][axis] = bad;
        bounded(single(view.p), single(view.n), &v)?;
        for rung in ladder() {
            let v: Vec<_> = view.v.iter().map(|&v| single(v)).collect();
            let mut p = single(view.p);
            p[axis] = bad;
            prop_assert!(answer(rung, p, single(view.n), &v).is_err(), "{rung:?}");
        }
    }

    #[test]
    fn three_to_thirty_two_corners(view in many_cornered_view()) {
        judge(&view)?;
    }

    #[test]
    fn corners_twice_and_edges_without_length(view in view(), twice in prop::collection::vec(0..12_usize, 1..6)) {
        let mut more = view.clone();
        for at in twice {
            let at = at % more.v.len();
            more.v.insert(at, more.v[at]);
        }
        judge(&more)?;
    }

    #[test]
    fn the_horizon_through_corners_and_edges(view in view(), corner in 0..12_usize, through in prop::array::uniform3(-8..=8_i32)) {
        // Lattice products are exact: the corner's height is 0, with a whole
        // edge where the next corner is `through`.
        let to = |k: usize| DVec3::from(view.v[k % view.v.len()]) - DVec3::from(view.p);
        for other in [DVec3::from(through.map(f64::from)), to(corner + 1)] {
            let n = to(corner).cross(other);
            if n != DVec3::ZERO {
                judge(&View { n: n.to_array(), ..view.clone() })?;
                judge(&View { n: (-n).to_array(), ..view.clone() })?;
            }
        }
    }

    #[test]
    fn corners_edges_and_the_plane_itself(view in upright_view(), corner in 0..12_usize, t in 0..=4_i32) {
        let at = |k: usize| DVec3::from(view.v[k % view.v.len()]);
        let p = at(corner) + (at(corner + 1) - at(corner)) * (f64::from(t) / 4.0);
        for rung in ladder() {
            for on in [View { p: p.to_array(), ..view.clone() }, View { p: p.to_array(), ..view.reversed() }] {
                prop_assert_eq!(seen(rung, &on).1, 0, "{:?}", rung);
            }
        }
    }

    #[test]
    fn powers_of_two_from_a_millionth_to_a_million(view in view(), exponent in -20..=20_i32) {
        let scaled = moved(&view, |x| x * 2.0_f64.powi(exponent), |n| n);
        for rung in ladder() {
            prop_assert_eq!(seen(rung, &view).1, seen(rung, &scaled).1, "{:?}", rung);
        }
    }

    #[test]
    fn offsets_to_a_million(view in view(), by in prop::array::uniform3(-1_000_000..=1_000_000_i32)) {
        // On a lattice of 1 m, where coordinates up to 2^24 are exact.
        let wide = moved(&view, |x| x * 64.0, |n| n);
        let away = moved(&wide, |x| x + DVec3::from(by.map(f64::from)), |n| n);
        for rung in ladder() {
            let (near, far) = (seen(rung, &wide), seen(rung, &away));
            // Floating point subtracts the place first; integers see a larger
            // scene, on another scale.
            match rung.map_or("", FormFactorRung::name) {
                "q24" | "q29" => {
                    let allowed = 2.0 * allowed(rung, &view);
                    prop_assert!((near.0 - far.0).abs() <= allowed, "{rung:?}");
                }
                _ => prop_assert_eq!(near.1, far.1, "{:?}", rung),
            }
        }
    }

    #[test]
    fn quarter_turns_change_nothing(view in view(), turn in prop::sample::select(quarter_turns())) {
        let turned = moved(&view, |x| turn * x, |n| turn * n);
        for rung in ladder() {
            let allowed = allowed(rung, &view) + allowed(rung, &turned);
            let (one, other) = (seen(rung, &view).0, seen(rung, &turned).0);
            prop_assert!((one - other).abs() <= allowed, "{rung:?}: {one} {other}");
        }
    }

    #[test]
    fn parts_add_up(view in convex_view(), from in 0..8_usize, over in 0..8_usize) {
        let count = view.v.len();
        prop_assume!(count > 3);
        let mut whole = view;
        whole.v.rotate_left(from % count);
        let chord = 2 + over % (count - 3);
        let part = |v: Vec<[f64; 3]>| View { v, ..whole.clone() };
        let first = part(whole.v[..=chord].to_vec());
        let second = part([&whole.v[chord..], &whole.v[..1]].concat());
        for rung in ladder() {
            let [all, one, other] = [&whole, &first, &second].map(|view| seen(rung, view).0);
            let allowed: f64 = [&whole, &first, &second].map(|view| allowed(rung, view)).iter().sum();
            prop_assert!((all - one - other).abs() <= allowed, "{rung:?}: {all} {one} {other}");
        }
    }

    #[test]
    fn a_closed_room_is_all_there_is(at in inside(), size in prop::array::uniform3(1..=64_i32), n in prop::array::uniform3(-8..=8_i32)) {
        prop_assume!(n != [0; 3]);
        let size = DVec3::from(size.map(f64::from)) / 8.0;
        for rung in ladder() {
            let (mut sum, mut most) = (0.0, 0.0);
            for face in room(size) {
                prop_assert!(facing(&face).length() > 0.5);
                let view = View {
                    p: (at * size).to_array(),
                    n: n.map(f64::from),
                    v: face.iter().map(|v| v.to_array()).collect(),
                };
                sum += seen(rung, &view).0;
                most += allowed(rung, &view);
            }
            prop_assert!((sum - 1.0).abs() <= most, "{rung:?}: {sum}, {most:e} allowed");
        }
    }
}
