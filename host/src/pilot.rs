//! Plans a room by its light: a first, cheap solution tells where it falls.
//!
//! Between [`crate::solve`], which solves the first plan, and the commands. The
//! kernel answers at any place; so what a few patches send is known all over the
//! scene, smoothly, and the patches of the plan proper follow it.

use crate::bake;
use crate::occlusion::Occlusion;
use crate::plan::{self, Field, Plan, Unplannable};
use crate::scene::{Budget, Scene};
use crate::solve::{self, Rung, Sight, Solution};
use glam::DVec3;
use isolux::shoot::Stop;

/// The part of the emitted power that the first solution leaves unshot.
const UNSHOT: f32 = 0.003;

/// Plans a scene with linear patches that follow the light of a first solution
/// ([`plan::patches::following`]), seen past `occlusion` by this rung of
/// visibility. `direct` gives direct light, which the first plan follows.
///
/// Where the first plan has no solution on the host, the plan is that of
/// [`plan::patches::linear`].
///
/// # Errors
/// Those of [`plan::patches::linear`].
pub fn linear(
    scene: &Scene,
    budget: &Budget,
    (occlusion, sight): (Option<&Occlusion>, Sight),
    direct: &Field<'_>,
) -> Result<Plan, Unplannable> {
    let plain = || plan::patches::linear(scene, budget, direct);
    let Ok(first) = plan::patches::first(scene, direct) else {
        return plain();
    };
    let Ok(tables) = bake::bake(scene, &first, occlusion.cloned()) else {
        return plain();
    };
    let until = |stop| solve::solve(&tables, Rung::default(), sight, stop);
    let (Ok(once), Ok(all)) = (until(Stop::Reflections(0)), until(Stop::below(UNSHOT))) else {
        return plain();
    };
    let light = |places: &[(DVec3, DVec3)]| -> Vec<[f64; 2]> {
        let [direct, all] = [&once, &all].map(|solution| means(solution, places));
        let pairs = direct.into_iter().zip(all);
        pairs.map(|(direct, all)| [direct, all - direct]).collect()
    };
    plan::patches::following(scene, budget, &light)
}

/// Means of the channels; 0 at what is no place.
fn means(solution: &Solution<'_>, places: &[(DVec3, DVec3)]) -> Vec<f64> {
    let single = |v: DVec3| v.as_vec3().to_array();
    let asked: Vec<_> = places
        .iter()
        .map(|&(p, n)| (single(p), single(n)))
        .collect();
    match solution.at(&asked) {
        Ok(found) => found
            .into_iter()
            .map(|at| at.value.into_iter().map(f64::from).sum::<f64>() / 3.0)
            .collect(),
        Err(_) => vec![0.0; places.len()],
    }
}
