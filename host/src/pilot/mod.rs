//! Plans a room by its light: a first, cheap solution tells where it falls.
//!
//! Between [`crate::solve`], which solves the first plan, and the commands. The
//! kernel answers at any place; so what a few patches send is known all over the
//! scene, smoothly, and the patches of the plan proper follow it. Many more of them, on the
//! host alone, tell what those of the plan miss, and what it errs by in the end.

mod judge;
mod settle;

use crate::bake::{self, Tables};
use crate::occlusion::Occlusion;
use crate::plan::fields::shares;
use crate::plan::patches::{Light, Split};
use crate::plan::room::Room;
use crate::plan::{self, Field, Plan, Unplannable};
use crate::scene::memory::Memory;
use crate::scene::{Budget, Scene};
use crate::solve::{self, Rung, Sight, Solution};
use glam::DVec3;
use isolux::shoot::Stop;
use judge::Judge;
use std::ops::Range;

/// The part of the emitted power that the first solution leaves unshot.
const UNSHOT: f32 = 0.003;

/// The part that a device leaves unshot where nothing else is said.
const SETTLED: f32 = 0.001;

/// How often light is reflected at the most where every patch shoots in turn.
const REFLECTIONS: f64 = 40.0;

/// Patches of the solution that plans are judged by. With 600 of them reconstructed light
/// in the Cornell box errs by a sixth more.
const FINE_PATCHES: usize = 1000;

/// How often meshes are made coarser until the tables fit.
const THINNINGS: usize = 5;

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
    let following = |light: &Light<'_>| plan::patches::following(scene, budget, light);
    match flown(scene, looking, direct, &following) {
        Some(plan) => plan,
        None => plan::patches::linear(scene, budget, direct),
    }
}

/// Plans so many patches that follow the light of a first solution, for what they send
/// alone ([`plan::patches::fine`]).
///
/// # Errors
/// Those of [`plan::patches::linear`].
pub fn finely(
    scene: &Scene,
    patches: usize,
    looking: (Option<&Occlusion>, Sight),
    direct: &Field<'_>,
) -> Result<Plan, Unplannable> {
    let following = |light: &Light<'_>| plan::patches::fine(scene, patches, light, &|_, _| 1.0);
    match flown(scene, looking, direct, &following) {
        Some(plan) => plan,
        None => plan::patches::linear(scene, &Budget::default(), direct),
    }
}

/// What is planned by the light of a first solution; `None` where that has none on
/// the host.
fn flown<T>(
    scene: &Scene,
    (occlusion, sight): (Option<&Occlusion>, Sight),
    direct: &Field<'_>,
    then: &dyn Fn(&Light<'_>) -> T,
) -> Option<T> {
    let first = plan::patches::first(scene, direct).ok()?;
    let luminaires = scene.surfaces.iter().filter(|s| s.emits()).count();
    let groups = luminaires.clamp(1, LUMINAIRES);
    let lit = (0..groups).map(|group| with_some(scene, group, groups));
    let scenes = lit.chain((groups > 1).then(|| scene.clone()));
    let baked = scenes.map(|scene| bake::bake(&scene, &first, occlusion.cloned()).ok());
    let tables = baked.collect::<Option<Vec<Tables>>>()?;
    let solved = tables.iter().map(|tables| {
        let until = |stop| solve::solve(tables, Rung::default(), sight, stop).ok();
        Some(Solved {
            direct: until(Stop::Reflections(0))?,
            all: until(Stop::below(UNSHOT))?,
        })
    });
    let solved = solved.collect::<Option<Vec<Solved<'_>>>>()?;
    let splits: Vec<_> = solved
        .iter()
        .map(|solved| move |places: &[(DVec3, DVec3)]| solved.split(places))
        .collect();
    let splits: Vec<&Split<'_>> = splits.iter().map(|split| split as &Split<'_>).collect();
    let (&all, each) = (splits.last()?, splits.get(..groups)?);
    Some(then(&Light { all, each }))
}

/// Why a room has no plan.
#[derive(Debug)]
pub enum Error {
    /// The budget.
    Samples(Unplannable),
    /// A shadow, or the budget, in a room.
    Room(plan::room::Error),
    /// The draft of its patches is too large for the tables.
    TooLarge(bake::TooLarge),
    /// The kernel does not take the draft.
    Kernel(isolux::Error),
}

impl std::fmt::Display for Error {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Samples(error) => error.fmt(f),
            Self::Room(error) => error.fmt(f),
            Self::TooLarge(error) => error.fmt(f),
            Self::Kernel(error) => error.fmt(f),
        }
    }
}

impl std::error::Error for Error {}

/// Makes tables of a plan.
pub type Bake<'a> = dyn Fn(&Plan) -> Result<Tables, bake::TooLarge> + 'a;

/// How a room is planned.
#[derive(Clone, Copy, Default)]
pub struct Manner<'a> {
    /// How its tables will be made, so that they are as small as they have to be; with
    /// the occluders where it is `None`.
    pub bake: Option<&'a Bake<'a>>,
    /// Whether what the scene's camera sees larger counts more.
    pub for_camera: bool,
}

/// Plans a room by error ([`plan::room`]): a first solution tells where patches
/// belong, a second one, of these patches, what samples can tell of the light, and a third
/// one, of many more, what it is. The plan is tried: what it errs by at 256 places of
/// every surface, two and a half times, and a hundredth of what is reflected there is its prediction.
///
/// Meshes are made coarser until the tables take no more flash than the budget says,
/// or the device of `memory.x` has.
/// Where patches and the coarsest meshes take more the plan takes more.
///
/// # Errors
/// [`Error`].
pub fn room(
    scene: &Scene,
    budget: &Budget,
    looking: (Option<&Occlusion>, Sight),
    manner: Manner<'_>,
    direct: &Field<'_>,
) -> Result<Plan, Error> {
    let (occlusion, sight) = looking;
    let of_camera = match manner.for_camera {
        true => plan::room::view::importance(scene),
        false => None,
    };
    let importance = |place, normal| match &of_camera {
        Some(importance) => importance(place, normal),
        None => 1.0,
    };
    let drafted = |light: &Light<'_>| {
        let draft = plan::patches::draft(scene, budget, light, of_camera.is_some())?;
        let fine = plan::patches::fine(scene, FINE_PATCHES, light, &importance)?;
        Ok((draft, fine))
    };
    let drafts = match flown(scene, looking, direct, &drafted) {
        Some(drafts) => drafts,
        None => plan::patches::linear(scene, budget, direct).map(|plan| (plan.clone(), plan)),
    };
    let (draft, fine) = drafts.map_err(Error::Samples)?;
    let tables = bake::bake(scene, &draft, occlusion.cloned()).map_err(Error::TooLarge)?;
    let light = solve::solve(&tables, Rung::default(), sight, in_turn(scene));
    let light = light.map_err(Error::Kernel)?;
    let of_judge = judge::tables(scene, &fine, occlusion)?;
    let judge = Judge::of(&of_judge, sight, in_turn(scene))?;
    let luminaires = tables.counts.luminaires as usize;
    let all = tables.counts.emitters as usize;
    let terms = |places: &plan::room::Places, emitters: Range<usize>, sight| {
        let dark = || vec![vec![0.0; emitters.len()]; places.len()];
        // Places of surfaces are places: there is nothing to refuse.
        let found = light.terms(&receivers(places), emitters.clone(), sight);
        found.unwrap_or_else(|_| dark())
    };
    let known = plan::room::Known {
        importance: &importance,
        shares: match of_camera {
            Some(_) => shares::MOST_FOR_CAMERA,
            None => shares::MOST,
        },
        draft: &draft,
        unshadowed: &|places| terms(places, 0..luminaires, Sight::None),
        direct: &|places| terms(places, 0..luminaires, sight),
        reflected: &|places| terms(places, luminaires..all, sight),
        settled: &|places| judge.reflected(places),
    };
    let room = plan::room::look(scene, &known).map_err(Error::Room)?;
    let exact = |plan: &Plan| bake::bake(scene, plan, occlusion.cloned());
    let mut plan = fitting(&room, budget, manner.bake.unwrap_or(&exact))?;
    let tables = exact(&plan).map_err(Error::TooLarge)?;
    // As the device will stop.
    let light = solve::solve(&tables, Rung::default(), sight, Stop::below(SETTLED));
    let light = light.map_err(Error::Kernel)?;
    settle::scale(&mut plan, &room, &light, &known);
    let tables = exact(&plan).map_err(Error::TooLarge)?;
    judge::tried(scene, &mut plan, &tables, sight, &known)?;
    Ok(plan)
}

/// A plan with meshes as coarse as it takes for its tables to fit.
fn fitting(room: &Room<'_>, budget: &Budget, bake: &Bake<'_>) -> Result<Plan, Error> {
    let mut plan = room.plan(budget, None).map_err(Error::Room)?;
    let most = budget.flash;
    let most = most.unwrap_or_else(|| Memory::of_the_board().for_tables()) as usize;
    for _ in 0..THINNINGS {
        let bytes = bake(&plan).map_err(Error::TooLarge)?.bytes().len();
        if bytes <= most {
            break;
        }
        let of_meshes = plan.mesh_bytes().saturating_sub(bytes - most);
        plan = room.plan(budget, Some(of_meshes)).map_err(Error::Room)?;
    }
    Ok(plan)
}

/// When all patches have shot in turn until less than [`UNSHOT`] is left.
///
/// Where the brightest shoots, one that is small shoots once, early, and what its
/// radiosity varies by is then not what it becomes: at the foot of something, where the
/// nearest patch is all that is seen, light would be missing.
fn in_turn(scene: &Scene) -> Stop {
    let (mut area, mut reflecting) = (0.0, 0.0);
    for surface in scene.surfaces.iter().filter(|surface| surface.reflects()) {
        let most = surface.reflectance.into_iter().fold(0.0, f64::max);
        area += surface.area;
        reflecting += most * surface.area;
    }
    let mean = (reflecting / area.max(f64::MIN_POSITIVE)).clamp(0.01, 0.99);
    let times = (f64::from(UNSHOT).ln() / mean.ln()).ceil();
    Stop::Reflections(times.clamp(1.0, REFLECTIONS) as u32)
}

/// As the kernel takes places.
fn receivers(places: &[(DVec3, DVec3)]) -> Vec<([f32; 3], [f32; 3])> {
    let single = |v: DVec3| v.as_vec3().to_array();
    places
        .iter()
        .map(|&(p, n)| (single(p), single(n)))
        .collect()
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
    match solution.at(&receivers(places)) {
        Ok(found) => found
            .into_iter()
            .map(|at| at.value.into_iter().map(f64::from).sum::<f64>() / 3.0)
            .collect(),
        Err(_) => vec![0.0; places.len()],
    }
}
