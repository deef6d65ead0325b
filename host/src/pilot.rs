//! Plans a room by its light: a first, cheap solution tells where it falls.
//!
//! Between [`crate::solve`], which solves the first plan, and the commands. The
//! kernel answers at any place; so what a few patches send is known all over the
//! scene, smoothly, and the patches of the plan proper follow it.

use crate::bake::{self, Tables};
use crate::occlusion::Occlusion;
use crate::plan::patches::{Light, Split};
use crate::plan::{self, Field, Plan, Unplannable};
use crate::scene::{Budget, Scene};
use crate::solve::{self, Rung, Sight, Solution};
use glam::DVec3;
use isolux::shoot::Stop;

/// The part of the emitted power that the first solution leaves unshot.
const UNSHOT: f32 = 0.003;

/// Luminaires that are looked at each for itself; where there are more they share.
const LUMINAIRES: usize = 8;

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
    looking: (Option<&Occlusion>, Sight),
    direct: &Field<'_>,
) -> Result<Plan, Unplannable> {
    let plain = || plan::patches::linear(scene, budget, direct);
    let Ok(first) = plan::patches::first(scene, direct) else {
        return plain();
    };
    let luminaires = scene.surfaces.iter().filter(|s| s.emits()).count();
    let groups = luminaires.clamp(1, LUMINAIRES);
    let lit = (0..groups).map(|group| with_some(scene, group, groups));
    let scenes = lit.chain((groups > 1).then(|| scene.clone()));
    let baked = scenes.map(|scene| bake::bake(&scene, &first, looking.0.cloned()));
    let Ok(tables) = baked.collect::<Result<Vec<Tables>, _>>() else {
        return plain();
    };
    let solved = tables.iter().map(|tables| {
        Ok(Solved {
            direct: solve::solve(tables, Rung::default(), looking.1, Stop::Reflections(0))?,
            all: solve::solve(tables, Rung::default(), looking.1, Stop::below(UNSHOT))?,
        })
    });
    let Ok(solved) = solved.collect::<Result<Vec<Solved<'_>>, isolux::Error>>() else {
        return plain();
    };
    let splits: Vec<_> = solved
        .iter()
        .map(|solved| move |places: &[(DVec3, DVec3)]| solved.split(places))
        .collect();
    let splits: Vec<&Split<'_>> = splits.iter().map(|split| split as &Split<'_>).collect();
    let (Some(&all), Some(each)) = (splits.last(), splits.get(..groups)) else {
        return plain();
    };
    plan::patches::following(scene, budget, &Light { all, each })
}

/// The scene with every so many of its luminaires on, the others off.
fn with_some(scene: &Scene, group: usize, groups: usize) -> Scene {
    let mut scene = scene.clone();
    let luminaires = scene.surfaces.iter_mut().filter(|s| s.emits()).enumerate();
    for (_, surface) in luminaires.filter(|(index, _)| index % groups != group) {
        surface.radiance = [0.0; 3];
    }
    scene
}

/// What some luminaires cause, by the first plan.
struct Solved<'t> {
    direct: Solution<'t>,
    all: Solution<'t>,
}

impl Solved<'_> {
    /// Direct and reflected light.
    fn split(&self, places: &[(DVec3, DVec3)]) -> Vec<[f64; 2]> {
        let [direct, all] = [&self.direct, &self.all].map(|solution| means(solution, places));
        let pairs = direct.into_iter().zip(all);
        pairs.map(|(direct, all)| [direct, all - direct]).collect()
    }
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
