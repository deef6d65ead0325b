//! What changes nothing: moving, turning and scaling everything, naming
//! another vertex first, and cutting an edge or the polygon in two.

use crate::shapes::{STEP, View, convex_view, view};
use crate::{Real, Rung, factor};
use glam::{DMat3, DQuat, DVec3};
use isolux::form_factor::{Best, Libm};
use isolux::number::{Root, SoftRoot};
use proptest::prelude::*;

fn value<A: Rung<N>, N: Real>(view: &View) -> f64
where
    SoftRoot: Root<N>,
{
    factor::<A, N>(view.p, view.n, &view.v).into()
}

/// Both within the rung's own error of the truth, which may differ by `more`.
fn same<A: Rung<N>, N: Real>(a: &View, b: &View, more: f64) -> Result<(), TestCaseError>
where
    SoftRoot: Root<N>,
{
    let own = |view: &View| A::own_error(view.v.len(), view.conditioning());
    let allowed = own(a) + own(b) + more;
    let (x, y) = (value::<A, N>(a), value::<A, N>(b));
    prop_assert!(
        (x - y).abs() <= allowed,
        "{x:e} and {y:e}, {allowed:e} allowed"
    );
    Ok(())
}

fn same_on_all(a: &View, b: &View) -> Result<(), TestCaseError> {
    same::<Best, f32>(a, b, 0.0)?;
    same::<Best, f64>(a, b, 0.0)?;
    same::<Libm, f32>(a, b, 0.0)?;
    same::<Libm, f64>(a, b, 0.0)
}

fn same_bits<A: Rung<N>, N: Real>(a: &View, b: &View) -> Result<(), TestCaseError>
where
    SoftRoot: Root<N>,
{
    let bits = |view: &View| factor::<A, N>(view.p, view.n, &view.v).bits();
    prop_assert_eq!(bits(a), bits(b));
    Ok(())
}

fn same_bits_on_all(a: &View, b: &View) -> Result<(), TestCaseError> {
    same_bits::<Best, f32>(a, b)?;
    same_bits::<Best, f64>(a, b)?;
    same_bits::<Libm, f32>(a, b)?;
    same_bits::<Libm, f64>(a, b)
}

pub(crate) fn moved(view: &View, p: impl Fn(DVec3) -> DVec3, n: impl Fn(DVec3) -> DVec3) -> View {
    View {
        p: p(view.p.into()).to_array(),
        n: n(view.n.into()).to_array(),
        v: view.v.iter().map(|&v| p(v.into()).to_array()).collect(),
    }
}

/// What rounding moved coordinates to a number of half an ulp `u` may change:
/// every vertex and the receiver by √3 u of the largest coordinate, and the
/// normal by 2 u.
fn rounded(view: &View, u: f64) -> f64 {
    let all = view.v.iter().chain([&view.p]);
    let largest = all.flatten().fold(0.0_f64, |most, x| most.max(x.abs()));
    let far = view
        .v
        .iter()
        .map(|&v| DVec3::from(v).distance(view.p.into()));
    let nearest_edge = far.fold(0.0, f64::max) / view.conditioning();
    let moves = 2.0 * 3.0_f64.sqrt() * u * largest;
    view.v.len() as f64 * moves / nearest_edge + 4.0 * u
}

/// The 24 turns that map the axes to each other.
pub(crate) fn quarter_turns() -> Vec<DMat3> {
    let axes = [
        DVec3::X,
        DVec3::Y,
        DVec3::Z,
        -DVec3::X,
        -DVec3::Y,
        -DVec3::Z,
    ];
    let mut all = Vec::new();
    for a in axes {
        for b in axes {
            if a.dot(b) == 0.0 {
                all.push(DMat3::from_cols(a, b, a.cross(b)));
            }
        }
    }
    all
}

fn turn() -> impl Strategy<Value = DQuat> {
    prop::array::uniform4(-1.0..1.0_f64)
        .prop_filter("a rotation", |q| {
            q.iter().map(|x| x * x).sum::<f64>() > 0.01
        })
        .prop_map(|[x, y, z, w]| DQuat::from_xyzw(x, y, z, w).normalize())
}

/// Rounded coordinates may put the receiver behind a plane that it lies close
/// to, where F jumps: the law holds where rounding cannot decide that.
fn clear_of_the_plane(view: &View, u: f64) -> bool {
    let largest = view
        .v
        .iter()
        .flatten()
        .fold(0.0_f64, |most, x| most.max(x.abs()));
    let far = view
        .v
        .iter()
        .map(|&v| DVec3::from(v).distance(view.p.into()));
    let far = far.fold(0.0, f64::max);
    view.flatness() * (1.0 + largest / far) * u < 1e-3
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(2000))]

    #[test]
    fn lattice_steps_change_no_bit(view in view(), by in prop::array::uniform3(-65536..65536_i32)) {
        let by = DVec3::from(by.map(f64::from)) * STEP;
        same_bits_on_all(&view, &moved(&view, |x| x + by, |n| n))?;
    }

    #[test]
    fn powers_of_two_change_no_bit(view in view(), exponent in -20..20_i32) {
        let factor = 2.0_f64.powi(exponent);
        same_bits_on_all(&view, &moved(&view, |x| x * factor, |n| n))?;
    }

    #[test]
    fn the_length_of_the_normal_changes_nothing(view in view(), exponent in -60..60_i32) {
        let factor = 2.0_f64.powi(exponent);
        same_bits_on_all(&view, &moved(&view, |x| x, |n| n * factor))?;
    }

    #[test]
    fn quarter_turns_change_nothing(view in view(), turn in prop::sample::select(quarter_turns())) {
        same_on_all(&view, &moved(&view, |x| turn * x, |n| turn * n))?;
    }

    #[test]
    fn turns_change_what_rounding_does(view in view(), turn in turn()) {
        let turned = moved(&view, |x| turn * x, |n| turn * n);
        if clear_of_the_plane(&view, f32::U) {
            same::<Best, f32>(&view, &turned, rounded(&turned, f32::U))?;
            same::<Libm, f32>(&view, &turned, rounded(&turned, f32::U))?;
        }
        same::<Best, f64>(&view, &turned, rounded(&turned, f64::U))?;
        same::<Libm, f64>(&view, &turned, rounded(&turned, f64::U))?;
    }

    #[test]
    fn moves_change_what_rounding_does(view in view(), by in prop::array::uniform3(-1e3..1e3_f64)) {
        let by = DVec3::from(by);
        let away = moved(&view, |x| x + by, |n| n);
        if clear_of_the_plane(&away, f32::U) {
            same::<Best, f32>(&view, &away, rounded(&away, f32::U))?;
            same::<Libm, f32>(&view, &away, rounded(&away, f32::U))?;
        }
        same::<Best, f64>(&view, &away, rounded(&away, f64::U))?;
        same::<Libm, f64>(&view, &away, rounded(&away, f64::U))?;
    }

    #[test]
    fn any_vertex_may_be_the_first(view in view(), by in 1..12_usize) {
        let mut shifted = view.clone();
        shifted.v.rotate_left(by % view.v.len());
        same_on_all(&view, &shifted)?;
    }

    #[test]
    fn an_edge_may_be_two(view in view(), edge in 0..12_usize) {
        let (mut split, edge) = (view.clone(), edge % view.v.len());
        let (a, b) = (DVec3::from(view.v[edge]), DVec3::from(view.v[(edge + 1) % view.v.len()]));
        split.v.insert(edge + 1, ((a + b) / 2.0).to_array());
        same_on_all(&view, &split)?;
    }

    #[test]
    fn a_polygon_is_the_sum_of_its_parts(view in convex_view(), from in 0..8_usize, over in 0..8_usize) {
        let count = view.v.len();
        prop_assume!(count > 3);
        let mut shifted = view.clone();
        shifted.v.rotate_left(from % count);
        let chord = 2 + over % (count - 3);
        let first = View { v: shifted.v[..=chord].to_vec(), ..view.clone() };
        let mut v = shifted.v[chord..].to_vec();
        v.push(shifted.v[0]);
        let second = View { v, ..view.clone() };
        parts::<Best, f32>(&view, &first, &second)?;
        parts::<Best, f64>(&view, &first, &second)?;
        parts::<Libm, f32>(&view, &first, &second)?;
        parts::<Libm, f64>(&view, &first, &second)?;
    }
}

fn parts<A: Rung<N>, N: Real>(all: &View, a: &View, b: &View) -> Result<(), TestCaseError>
where
    SoftRoot: Root<N>,
{
    let allowed: f64 = [all, a, b]
        .map(|view| A::own_error(view.v.len(), view.conditioning()))
        .iter()
        .sum();
    let (whole, sum) = (value::<A, N>(all), value::<A, N>(a) + value::<A, N>(b));
    prop_assert!(
        (whole - sum).abs() <= allowed,
        "{whole:e} and {sum:e}, {allowed:e} allowed"
    );
    Ok(())
}
