//! Whatever the numbers are: a form factor is a number from 0 to 1.

use crate::shapes::{View, view};
use crate::{Real, all_of, factor, of};
use glam::DVec3;
use isolux::form_factor::{Arithmetic, Best, Libm, Outline, form_factor, of_loops};
use isolux::geometry::{Plane, Receiver};
use isolux::number::{Root, SoftRoot};
use proptest::prelude::*;

fn bounded<A: Arithmetic<N>, N: Real>(p: [N; 3], n: [N; 3], v: &[[N; 3]])
where
    SoftRoot: Root<N>,
{
    // A receiver that is none is refused; that is an answer, too.
    let Ok(receiver) = Receiver::new::<SoftRoot>(p, n) else {
        return;
    };
    let f: f64 = form_factor::<A, N>(&receiver, v).into();
    assert!((0.0..=1.0).contains(&f), "{f} for {p:?} {n:?} {v:?}");
    // The plane may be anything at all, too.
    for point in [p, n] {
        let plane = Plane {
            normal: n.into(),
            point: point.into(),
        };
        let outlines = [Outline::new(v), Outline::new(v)].into_iter();
        let f: f64 = of_loops::<A, N>(&receiver, &plane, outlines).into();
        assert!((0.0..=1.0).contains(&f), "{f} for {p:?} {n:?} {v:?}");
    }
}

fn bounded_on_both<N: Real>(p: [N; 3], n: [N; 3], v: &[[N; 3]])
where
    SoftRoot: Root<N>,
    Libm: Arithmetic<N>,
    Best: Arithmetic<N>,
{
    bounded::<Best, N>(p, n, v);
    bounded::<Libm, N>(p, n, v);
}

/// Numbers at which arithmetic changes its ways.
const EDGES: [f64; 17] = [
    0.0,
    -0.0,
    1.0,
    -1.0,
    1e-45,
    -1e-45,
    1e-38,
    1e-20,
    1e-8,
    -1e8,
    1e19,
    -1e19,
    1e38,
    -1e38,
    f64::INFINITY,
    f64::NEG_INFINITY,
    f64::NAN,
];

pub(crate) fn edge() -> impl Strategy<Value = [f64; 3]> {
    prop::array::uniform3(prop::sample::select(&EDGES[..]))
}

pub(crate) fn bits() -> impl Strategy<Value = [f32; 3]> {
    prop::array::uniform3(any::<u32>().prop_map(f32::from_bits))
}

fn double_bits() -> impl Strategy<Value = [f64; 3]> {
    prop::array::uniform3(any::<u64>().prop_map(f64::from_bits))
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(5000))]

    #[test]
    fn any_bits_at_all(p in bits(), n in bits(), v in prop::collection::vec(bits(), 0..9)) {
        bounded_on_both(p, n, &v);
    }

    #[test]
    fn any_double_bits_at_all(p in double_bits(), n in double_bits(), v in prop::collection::vec(double_bits(), 0..9)) {
        bounded_on_both(p, n, &v);
    }

    #[test]
    fn the_edges_of_arithmetic(p in edge(), n in edge(), v in prop::collection::vec(edge(), 0..9)) {
        bounded_on_both::<f32>(of(p), of(n), &all_of(&v));
        bounded_on_both::<f64>(p, n, &v);
    }

    #[test]
    fn one_bad_number_in_a_sound_polygon(view in view(), at in 0..12_usize, bad in edge()) {
        let mut v = view.v.clone();
        let at = at % v.len();
        v[at] = bad;
        bounded_on_both::<f32>(of(view.p), of(view.n), &all_of(&v));
        bounded_on_both::<f64>(view.p, view.n, &v);
    }

    #[test]
    fn any_scale_at_any_offset(view in view(), scale in -6.0..6.0_f64, offset in prop::array::uniform3(-1e6..1e6_f64)) {
        let scale = 10.0_f64.powf(scale);
        let put = |x: [f64; 3]| (DVec3::from(x) * scale + DVec3::from(offset)).to_array();
        let v: Vec<_> = view.v.iter().map(|&v| put(v)).collect();
        bounded_on_both::<f32>(of(put(view.p)), of(view.n), &all_of(&v));
        bounded_on_both::<f64>(put(view.p), view.n, &v);
    }

    #[test]
    fn flat_and_folded_polygons(view in view(), to in prop::collection::vec(0..12_usize, 3..33)) {
        // Corners in any order and as often as one likes: self-crossing,
        // degenerate, running to and fro.
        let v: Vec<_> = to.iter().map(|k| view.v[k % view.v.len()]).collect();
        bounded_on_both::<f32>(of(view.p), of(view.n), &all_of(&v));
        bounded_on_both::<f64>(view.p, view.n, &v);
    }

    #[test]
    fn receivers_in_corners_and_on_edges(view in view(), corner in 0..12_usize, t in 0..=4_i32, lift in -1..=1_i32) {
        let count = view.v.len();
        let (a, b) = (DVec3::from(view.v[corner % count]), DVec3::from(view.v[(corner + 1) % count]));
        let p = a + (b - a) * (f64::from(t) / 4.0) + DVec3::from(view.n) * (f64::from(lift) * 1e-7);
        bounded_on_both::<f32>(of(p.to_array()), of(view.n), &all_of(&view.v));
        bounded_on_both::<f64>(p.to_array(), view.n, &view.v);
    }

    #[test]
    fn powers_of_ten_keep_the_value(view in view(), exponent in -6..=6_i32) {
        // From micrometres to thousands of kilometres; in f64 the rounding of
        // the scaled coordinates is far below the rung's error.
        let put = |x: [f64; 3]| x.map(|x| x * 10.0_f64.powi(exponent));
        let v: Vec<_> = view.v.iter().map(|&v| put(v)).collect();
        let plain = factor::<Best, f64>(view.p, view.n, &view.v);
        let scaled = factor::<Best, f64>(put(view.p), view.n, &v);
        prop_assert!((plain - scaled).abs() <= 2.0 * 2e-8, "{plain:e} {scaled:e}");
    }
}

#[test]
fn polygons_of_fewer_than_three_corners_are_none() {
    let view = View {
        p: [0.0; 3],
        n: [0.0, 0.0, 1.0],
        v: vec![[0.0, 0.0, 1.0], [1.0, 0.0, 1.0]],
    };
    for count in 0..=2 {
        assert_eq!(factor::<Best, f32>(view.p, view.n, &view.v[..count]), 0.0);
        assert_eq!(factor::<Libm, f32>(view.p, view.n, &view.v[..count]), 0.0);
    }
}
