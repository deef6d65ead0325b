//! Any simple polygon, concave or not, against the f64 reference; the bounds
//! of F; the horizon; the back.

use crate::shapes::{STEP, View, convex_view, normal, upright_view, view};
use crate::{Real, Rung, factor};
use glam::DVec3;
use isolux::form_factor::{Best, Libm};
use isolux::number::{Root, SoftRoot};
use isolux_host::reference;
use proptest::prelude::*;

fn exact(view: &View) -> f64 {
    let polygon: Vec<DVec3> = view.v.iter().map(|&v| v.into()).collect();
    reference::form_factor(view.p.into(), view.n.into(), &polygon)
}

fn judge<A: Rung<N>, N: Real>(view: &View) -> Result<(), TestCaseError>
where
    SoftRoot: Root<N>,
{
    let (got, exact): (f64, f64) = (factor::<A, N>(view.p, view.n, &view.v).into(), exact(view));
    prop_assert!((0.0..=1.0).contains(&got), "{got}");
    let allowed = A::own_error(view.v.len(), view.conditioning());
    prop_assert!(
        (got - exact).abs() <= allowed,
        "{got:e} for {exact:e}: {:e} of {allowed:e}",
        (got - exact).abs()
    );
    Ok(())
}

fn dark<A: Rung<N>, N: Real>(view: &View) -> Result<(), TestCaseError>
where
    SoftRoot: Root<N>,
{
    prop_assert_eq!(factor::<A, N>(view.p, view.n, &view.v).bits(), 0);
    Ok(())
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(3000))]

    #[test]
    fn concave_polygons_are_the_references(view in view()) {
        judge::<Best, f32>(&view)?;
        judge::<Best, f64>(&view)?;
        judge::<Libm, f32>(&view)?;
        judge::<Libm, f64>(&view)?;
    }

    #[test]
    fn convex_polygons_are_the_references(view in convex_view()) {
        judge::<Best, f32>(&view)?;
        judge::<Best, f64>(&view)?;
        judge::<Libm, f32>(&view)?;
        judge::<Libm, f64>(&view)?;
    }

    #[test]
    fn the_back_of_a_polygon_sends_nothing(view in view()) {
        let view = view.reversed();
        dark::<Best, f32>(&view)?;
        dark::<Libm, f32>(&view)?;
        dark::<Best, f64>(&view)?;
        dark::<Libm, f64>(&view)?;
    }

    #[test]
    fn what_is_wholly_below_the_horizon_sends_nothing(view in view()) {
        // Lattice heights are exact: below means below by a step at least.
        let below = |n: DVec3| view.v.iter().all(|&v| n.dot(DVec3::from(v) - DVec3::from(view.p)) < 0.0);
        // Facing away from the polygon's plane, and facing as given where that is below.
        for n in [normal(&view.v), DVec3::from(view.n)] {
            if below(n) {
                let away = View { n: n.to_array(), ..view.clone() };
                dark::<Best, f32>(&away)?;
                dark::<Libm, f32>(&away)?;
                dark::<Best, f64>(&away)?;
                dark::<Libm, f64>(&away)?;
            }
        }
    }

    #[test]
    fn points_on_the_plane_receive_nothing(view in view(), corner in 0..12_usize, t in 0..=64_i32) {
        // On an edge's line, which lies in the plane exactly. In f32 the plane
        // of a leaning polygon is rounded; the tables have a tolerance for that.
        let corner = corner % view.v.len();
        let (a, b) = (DVec3::from(view.v[corner]), DVec3::from(view.v[(corner + 1) % view.v.len()]));
        let on = View { p: (a + (b - a) * f64::from(t)).to_array(), ..view };
        dark::<Best, f64>(&on)?;
        dark::<Libm, f64>(&on)?;
    }

    #[test]
    fn points_on_an_upright_plane_receive_nothing(view in upright_view(), at in prop::array::uniform3(-512..=512_i32)) {
        // Anywhere on the plane: on the polygon, beside it, on its edges.
        let normal = normal(&view.v);
        let mut p = at.map(|x| f64::from(x) * STEP);
        for axis in 0..3 {
            if normal[axis] != 0.0 {
                p[axis] = view.v[0][axis];
            }
        }
        let corner = view.v[at[0].unsigned_abs() as usize % view.v.len()];
        for p in [p, corner] {
            for on in [View { p, ..view.clone() }, View { p, ..view.reversed() }] {
                dark::<Best, f32>(&on)?;
                dark::<Libm, f32>(&on)?;
                dark::<Best, f64>(&on)?;
                dark::<Libm, f64>(&on)?;
            }
        }
    }
}
