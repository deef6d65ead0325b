//! The integer rungs on random polygons, at the extremes and where there is
//! nothing to compute with, against the reference in double precision.

use glam::DVec3;
use isolux::Error;
use isolux::form_factor::fixed_point::{
    Format, Plane, Q24, Q29, Receiver, Scale, form_factor, of_loops,
};
use isolux_host::reference;
use isolux_host::solve::fixed_form_factor;
use proptest::prelude::*;

type Point = [f32; 3];

fn exact(p: Point, n: Point, v: &[Point]) -> f64 {
    let wide = |v: Point| DVec3::from(v.map(f64::from));
    let polygon: Vec<DVec3> = v.iter().map(|&v| wide(v)).collect();
    reference::form_factor(wide(p), wide(n), &polygon)
}

fn on<F: Format + Into<f64>>(p: Point, n: Point, v: &[Point]) -> f64 {
    fixed_form_factor::<F>(p, n, v).expect("a receiver").into()
}

/// What the rungs promise, next to an edge too.
const BOUNDS: [f64; 2] = [5e-6, 5e-8];

/// A convex polygon of `count` corners with its centre and two axes.
fn polygon(count: usize, centre: Point, axes: [Point; 2]) -> Vec<Point> {
    (0..count)
        .map(|index| {
            let turn = std::f32::consts::TAU * index as f32 / count as f32;
            let (sine, cosine) = turn.sin_cos();
            std::array::from_fn(|i| centre[i] + cosine * axes[0][i] + sine * axes[1][i])
        })
        .collect()
}

fn check(p: Point, n: Point, v: &[Point]) -> Result<(), TestCaseError> {
    let exact = exact(p, n, v);
    let [allowed_24, allowed_29] = BOUNDS;
    let (q24, q29) = (on::<Q24>(p, n, v), on::<Q29>(p, n, v));
    prop_assert!((0.0..=1.0).contains(&q24) && (0.0..=1.0).contains(&q29));
    prop_assert!(
        (q24 - exact).abs() <= allowed_24,
        "{q24} {exact} {allowed_24:e}"
    );
    prop_assert!(
        (q29 - exact).abs() <= allowed_29,
        "{q29} {exact} {allowed_29:e}"
    );
    Ok(())
}

fn coordinate() -> impl Strategy<Value = f32> {
    -1.0_f32..1.0
}

fn point() -> impl Strategy<Value = Point> {
    [coordinate(), coordinate(), coordinate()]
}

/// A receiver's normal that is one.
fn normal() -> impl Strategy<Value = Point> {
    point().prop_filter("a direction", |n| n.iter().any(|x| x.abs() > 0.1))
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(4000))]

    #[test]
    fn random_polygons_keep_the_promise(
        count in 3_usize..=32,
        centre in point(),
        axes in [point(), point()],
        p in point(),
        n in normal(),
        reverse in any::<bool>(),
    ) {
        let mut v = polygon(count, centre, axes);
        if reverse {
            v.reverse();
        }
        // Which side a receiver within rounding of the plane is on, the two
        // may decide differently: its single-precision corners span none.
        let plane = isolux::geometry::Plane::of_polygon(
            &v.iter().map(|v| v.map(f64::from)).collect::<Vec<_>>(),
        );
        let height = plane.height(p.map(f64::from).into()) / plane.normal.norm_squared().sqrt();
        prop_assume!(height.abs() > 1e-6);
        check(p, n, &v)?;
    }

    #[test]
    fn size_and_place_do_not_matter(
        exponent in -100_i32..100,
        p in point(),
        n in normal(),
        centre in point(),
        axes in [point(), point()],
    ) {
        let v = polygon(5, centre, axes);
        let power = 2.0_f32.powi(exponent);
        let scaled = |point: Point| point.map(|x| x * power);
        let larger: Vec<Point> = v.iter().map(|&v| scaled(v)).collect();
        // Powers of two are exact unless they meet a subnormal number.
        let normal = larger.iter().flatten().chain(&scaled(p)).all(|x| *x == 0.0 || x.is_normal());
        prop_assume!(normal);
        prop_assert_eq!(
            fixed_form_factor::<Q29>(p, n, &v),
            fixed_form_factor::<Q29>(scaled(p), scaled(n), &larger)
        );
    }

    #[test]
    fn whole_numbers_may_be_anything(
        p in any::<[i64; 3]>(),
        n in any::<[i64; 3]>(),
        v in prop::collection::vec(any::<[i64; 3]>(), 0..40),
    ) {
        if let Ok(receiver) = Receiver::<Q29>::new(p, n) {
            let f = form_factor(&receiver, &v);
            prop_assert!((Q29::from_bits(0)..=Q29::from_bits(1 << 29)).contains(&f));
        }
        if let Ok(receiver) = Receiver::<Q24>::new(p, n) {
            let f = form_factor(&receiver, &v);
            prop_assert!((Q24::from_bits(0)..=Q24::from_bits(1 << 24)).contains(&f));
        }
    }

    #[test]
    fn any_bits_are_refused_or_answered(bits in prop::collection::vec(any::<[u32; 3]>(), 2..12)) {
        let points: Vec<Point> = bits.iter().map(|v| v.map(f32::from_bits)).collect();
        let (p, n, v) = (points[0], points[1], &points[2..]);
        let finite = points.iter().flatten().all(|x| x.is_finite());
        match fixed_form_factor::<Q29>(p, n, v) {
            Ok(f) => {
                prop_assert!(finite);
                prop_assert!((0.0..=1.0).contains(&f64::from(f)));
            }
            Err(error) => prop_assert!(error == Error::Receiver && (!finite || n == [0.0; 3])),
        }
    }

    #[test]
    fn words_and_long_words_give_the_same_bits(
        p in any::<[i32; 3]>(),
        n in any::<[i32; 3]>(),
        v in prop::collection::vec(any::<[i32; 3]>(), 3..9),
    ) {
        prop_assume!(n != [0; 3]);
        let receiver = Receiver::<Q29>::new(p, n).expect("a normal");
        let long: Vec<[i64; 3]> = v.iter().map(|v| v.map(i64::from)).collect();
        prop_assert_eq!(form_factor(&receiver, &v), form_factor(&receiver, &long));
    }
}

/// A square of side 2 at height 1, facing down, about the origin.
const ABOVE: [Point; 4] = [
    [-1.0, -1.0, 1.0],
    [-1.0, 1.0, 1.0],
    [1.0, 1.0, 1.0],
    [1.0, -1.0, 1.0],
];

const UP: Point = [0.0, 0.0, 1.0];

#[test]
fn extremes_of_size_and_offset() {
    for size in [1e-6_f32, 1e-3, 1.0, 1e3, 1e6] {
        for offset in [0.0_f32, 1.0, 1e3, 1e6] {
            let place = |v: Point| v.map(|x| x * size + offset);
            let v = ABOVE.map(place);
            for n in [UP, [0.5, 0.25, 1.0], [1.0, 0.0, 0.0], [1.0, -2.0, 1e-3]] {
                let p = place([0.0; 3]);
                if v[0][2] <= p[2] {
                    continue; // the offset has swallowed the polygon
                }
                check(p, n, &v).unwrap_or_else(|error| panic!("{size} {offset}: {error}"));
            }
        }
    }
}

#[test]
fn degenerate_polygons_send_what_they_cover() {
    let p = [0.25, -0.125, 0.0];
    let whole = on::<Q29>(p, UP, &ABOVE);
    let [a, b, c, d] = ABOVE;
    // Repeated vertices and edges of no length add nothing.
    for repeated in [
        vec![a, a, b, c, d],
        vec![a, b, b, b, c, d, d],
        vec![a, b, c, d, a],
    ] {
        assert_eq!(on::<Q29>(p, UP, &repeated), whole, "{repeated:?}");
    }
    // Lines and points cover nothing.
    for nothing in [vec![a, b], vec![a; 5], vec![a], vec![], vec![a, b, a, b]] {
        assert_eq!(on::<Q29>(p, UP, &nothing), 0.0, "{nothing:?}");
        assert_eq!(on::<Q24>(p, UP, &nothing), 0.0, "{nothing:?}");
    }
}

#[test]
fn receivers_on_the_polygon_see_nothing_of_it() {
    let on_it = [
        [-1.0, -1.0, 1.0],    // a vertex
        [0.0, -1.0, 1.0],     // an edge
        [0.25, 0.5, 1.0],     // inside
        [7.0, 3.0, 1.0],      // on the plane beside it
        [0.0, 0.0, 1.000001], // behind
    ];
    for p in on_it {
        for n in [UP, [0.0, 0.0, -1.0], [1.0, 0.5, 0.0]] {
            assert_eq!(on::<Q29>(p, n, &ABOVE), 0.0, "{p:?} {n:?}");
        }
    }
}

#[test]
fn next_to_the_polygon_the_hemisphere_is_full() {
    for height in [1e-3_f32, 1e-5, 1e-7] {
        let p = [0.25, 0.5, 1.0 - height];
        check(p, UP, &ABOVE).expect("inside, close to the plane");
        check([1.0 - height, 0.25, 1.0 - height], [0.5, 0.0, 1.0], &ABOVE).expect("by an edge");
        check([1.0 - height, 1.0 - height, 1.0 - height], UP, &ABOVE).expect("by a vertex");
    }
    assert!(on::<Q29>([0.0, 0.0, 0.999_999_9], UP, &ABOVE) > 0.999_999);
}

#[test]
fn a_receiver_whose_horizon_holds_the_polygon_sees_nothing() {
    // Edges and vertices in the horizon plane, the rest above or below.
    assert_eq!(on::<Q29>([5.0, 0.0, 1.0], UP, &ABOVE), 0.0);
    for n in [
        [1.0, 0.0, 1.0],
        [-1.0, 0.0, 1.0],
        [1.0, 1.0, 2.0],
        [1.0, 0.0, 0.0],
    ] {
        check([0.0; 3], n, &ABOVE).expect("clipped through edge or vertex");
    }
}

#[test]
fn a_hole_takes_away_what_it_would_send() {
    let scale = Scale::of([2.0]).expect("finite");
    let places = |v: &[Point]| v.iter().map(|&v| scale.place(v)).collect::<Vec<_>>();
    let inner = ABOVE.map(|[x, y, z]| [0.5 * x, 0.5 * y, z]);
    let outline = places(&ABOVE);
    let mut hole = places(&inner);
    hole.reverse();
    let plane = Plane::of_polygon(&outline);
    for n in [UP, [1.0, 0.5, 0.25], [1.0, 0.0, 0.0]] {
        let p = [0.25, 0.125, 0.25];
        let receiver = Receiver::<Q29>::new(scale.place(p), scale.place(n)).expect("a normal");
        let ring = of_loops(&receiver, &plane, [&outline[..], &hole[..]].into_iter());
        let exact = exact(p, n, &ABOVE) - exact(p, n, &inner);
        assert!((f64::from(ring) - exact).abs() < 5e-8, "{ring:?} {exact}");
    }
}

#[test]
fn the_scale_holds_every_bit_it_can() {
    let scale = Scale::of([3.0, -0.001, 1e-38, 0.0]).expect("finite");
    let metre = 2.0_f64.powi(-scale.exponent());
    let [x, y, z] = scale.place([3.0, -0.001, 0.0]);
    assert_eq!(
        (x as f64, y as f64, z),
        (3.0 * metre, f64::from(-0.001_f32) * metre, 0)
    );
    assert!((1_i64 << 57..1 << 58).contains(&x));
    // Below the scale's resolution: rounded; above its reach: saturated.
    assert_eq!(scale.place([1e-38, -1e-45, 1e30]), [0, 0, 1 << 58]);
    for none in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY] {
        assert_eq!(Scale::of([1.0, none]), None);
    }
    let tiny = Scale::of([f32::from_bits(1)]).expect("finite");
    assert!(tiny.place([f32::from_bits(1), 0.0, -0.0])[0] > 0);
    assert_eq!(
        Receiver::<Q29>::new([0_i32; 3], [0; 3]),
        Err(Error::Receiver)
    );
}
