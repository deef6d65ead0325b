//! The way from a scene file to a solved scene, shared by the commands.

use super::choice::{self, Choices, Emitters, Placement, RungArguments, Transfer};
use super::failure::Failure;
use crate::bake::{self, Tables};
use crate::occlusion::Occlusion;
use crate::pilot;
use crate::plan::{self, Plan};
use crate::reference::{self, Reference, Reflections};
use crate::report::Progress;
use crate::scene::diagnostic::Diagnostic;
use crate::scene::requires::requirements;
use crate::scene::{Scene, file, shipped};
use crate::solve::{self, FormFactorRung, Sight, Solution};
use glam::DVec3;
use isolux::scene::records;
use isolux::shoot::Stop;
use std::path::Path;

/// The fraction of the emitted power below which light is left unshot where no
/// number of reflections is asked for.
pub(super) const UNSHOT: f32 = 0.001;

/// Bits of a term's factor in the rung `matrix`.
const TERM_BITS: u32 = 8;

/// The fraction at which a reference counts as converged.
const CONVERGED: f64 = 1e-5;

/// Reads a scene by path, or by the name of a shipped one where there is no
/// such file.
pub(super) fn read(path: &Path) -> Result<Scene, Failure> {
    if !path.exists() {
        let named = |(file, _): &&(&str, &str)| {
            path == Path::new(file) || path == Path::new(file.trim_end_matches(".toml"))
        };
        if let Some((file, source)) = shipped::ALL.iter().find(named) {
            return Ok(file::parse(file, source)?);
        }
    }
    Ok(file::read(path)?)
}

/// A scene, planned and baked.
pub(super) struct Planned {
    pub(super) scene: Scene,
    pub(super) rung: FormFactorRung,
    pub(super) sight: Sight,
    pub(super) emitters: Emitters,
    pub(super) transfer: Transfer,
    pub(super) placement: Placement,
    pub(super) plan: Plan,
    pub(super) tables: Tables,
}

/// Plans and bakes a scene after checking that this build can, for receivers
/// within the convex hull of the scene and of `places`.
pub(super) fn plan(
    scene: Scene,
    rungs: &RungArguments,
    places: &[DVec3],
) -> Result<Planned, Failure> {
    let planned = attempt(scene, rungs, places)?;
    planned.affordable()?;
    Ok(planned)
}

/// As [`plan`], whether it is within the scene's budget of bytes or not.
pub(super) fn attempt(
    scene: Scene,
    rungs: &RungArguments,
    places: &[DVec3],
) -> Result<Planned, Failure> {
    let needs = requirements(&scene);
    let choices = choice::choices(rungs, &scene, &needs)?;
    let occlusion = occlusion(&scene, &choices, places)?;
    let plan = place(&scene, &choices, occlusion.as_ref(), places)?;
    baked(scene, &choices, plan, occlusion)
}

/// As [`plan`], with a plan that is made already where a file is given.
///
/// The rungs of the file go before the scene's own, and flags before both; a flag that
/// asks for other samples or emitters than it holds is refused.
pub(super) fn plan_or_read(
    scene: Scene,
    rungs: &RungArguments,
    file: Option<&Path>,
    places: &[DVec3],
) -> Result<Planned, Failure> {
    let Some(file) = file else {
        return plan(scene, rungs, places);
    };
    let saved = plan::file::read(file, &scene)?;
    let asking = Scene {
        rungs: choice::of_saved(&saved, rungs, &scene.rungs)?,
        ..scene.clone()
    };
    let choices = choice::choices(rungs, &asking, &requirements(&scene))?;
    let occlusion = occlusion(&scene, &choices, places)?;
    let planned = baked(scene, &choices, saved.plan, occlusion)?;
    planned.affordable()?;
    Ok(planned)
}

fn baked(
    scene: Scene,
    choices: &Choices,
    plan: Plan,
    occlusion: Option<Occlusion>,
) -> Result<Planned, Failure> {
    let tables = match (choices.arithmetic.is_integer(), choices.transfer) {
        (true, Transfer::Matrix) => {
            let baked = bake::integers::bake_matrix(&scene, &plan, occlusion, TERM_BITS);
            baked.map_err(too_large)?
        }
        (true, _) => bake::integers::bake(&scene, &plan).map_err(too_large)?,
        (false, _) => tables(&scene, choices, &plan, occlusion).map_err(too_large)?,
    };
    let planned = Planned {
        scene,
        rung: choices.arithmetic,
        sight: choices.sight,
        // Where points do not stand for surfaces patches do.
        emitters: match plan.is_linear() {
            true => Emitters::Linear,
            false => choices.emitters,
        },
        transfer: choices.transfer,
        placement: choices.placement,
        plan,
        tables,
    };
    Ok(planned)
}

/// Tables in floating point.
fn tables(
    scene: &Scene,
    choices: &Choices,
    plan: &Plan,
    occlusion: Option<Occlusion>,
) -> Result<Tables, bake::TooLarge> {
    match choices.transfer {
        Transfer::Exact => bake::bake(scene, plan, occlusion),
        Transfer::Codes => bake::bake_coded(scene, plan, occlusion),
        Transfer::Matrix => bake::bake_matrix(scene, plan, occlusion, TERM_BITS),
        Transfer::Vectors => bake::bake_vectors(scene, plan, occlusion),
    }
}

/// Decides where samples are and what shoots.
fn place(
    scene: &Scene,
    choices: &Choices,
    occlusion: Option<&Occlusion>,
    places: &[DVec3],
) -> Result<Plan, Failure> {
    if choices.emitters == Emitters::FewPoints && choices.at_points && !places.is_empty() {
        return Err(Failure::usage(
            "few points light surfaces and named points, and not any place that is asked for",
            "ask with --reconstructed, or take --emitters points",
        ));
    }
    let mean = |[r, g, b]: [f64; 3]| (r + g + b) / 3.0;
    let light = |reflections| judge(scene, Reflections::AtMost(reflections));
    let remedy = "change [budget] samples in the scene";
    if choices.emitters != Emitters::Linear {
        // The samples follow the light after one reflection: it has the shape of all
        // of it.
        let once = light(1)?;
        let progress = Progress::start("planning", 0);
        let field = |places: &[(DVec3, DVec3)]| -> Vec<f64> {
            once.light_at(places).into_iter().map(mean).collect()
        };
        let plan = match choices.emitters {
            Emitters::Isolux => plan::isolux(scene, &scene.budget, &field).map(Some),
            Emitters::LayerCake => plan::layer_cake(scene, &scene.budget, &field).map(Some),
            Emitters::FewPoints => plan::error_driven_with_few_points(scene, &scene.budget, &field),
            _ => plan::error_driven(scene, &scene.budget, &field, places),
        };
        progress.finish();
        match plan.map_err(|error| Failure::limit(error, remedy))? {
            Some(plan) => return Ok(plan),
            None if choices.emitters == Emitters::FewPoints => {
                return Err(Failure::limit(
                    "no areas of few points light every surface as well as it is reconstructed",
                    "raise [budget] samples, or leave out --emitters",
                ));
            }
            None if choices.points_asked => {
                return Err(Failure::limit(
                    "some surface is nearer to another one than its samples are to each other: points do not stand for it",
                    "raise [budget] samples, or leave out --emitters",
                ));
            }
            None => {}
        }
    }
    let direct = light(0)?;
    let field = |places: &[(DVec3, DVec3)]| -> Vec<f64> {
        direct.light_at(places).into_iter().map(mean).collect()
    };
    let progress = Progress::start("planning", 0);
    let looking = (occlusion, choices.sight);
    let bake = |plan: &Plan| tables(scene, choices, plan, occlusion.cloned());
    let manner = pilot::Manner {
        bake: Some(&bake),
        for_camera: choices.for_camera,
    };
    let plan = match choices.placement {
        Placement::Error if !choices.at_points => {
            pilot::room(scene, &scene.budget, looking, manner, &field)
                .map_err(|error| Failure::limit(error, remedy))
        }
        _ => pilot::linear(scene, &scene.budget, looking, &field)
            .map_err(|error| Failure::limit(error, remedy)),
    };
    progress.finish();
    plan
}

/// What can hide something from receivers on the surfaces, at the named points, and at
/// `places`.
fn occlusion(
    scene: &Scene,
    choices: &Choices,
    places: &[DVec3],
) -> Result<Option<Occlusion>, Failure> {
    match choices.sight {
        Sight::None => Ok(None),
        Sight::VertexRays | Sight::Exact => {
            let found = Occlusion::for_receivers_within(scene, reach(scene, places));
            found
                .map(Some)
                .map_err(|error| Failure::limit(error, "split the scene"))
        }
    }
}

/// A plan that the tables cannot hold.
fn too_large(error: impl std::fmt::Display) -> Failure {
    Failure::limit(error, "lower [budget] samples or split the scene")
}

/// Where receivers may be: on the surfaces, at the named points, and at
/// `places`. What cannot hide anything from any of these is on no list.
fn reach(scene: &Scene, places: &[DVec3]) -> Vec<DVec3> {
    let surfaces = scene.surfaces.iter().flat_map(|surface| &surface.vertices);
    let points = scene.points.iter().map(|point| &point.position);
    surfaces.chain(points).chain(places).copied().collect()
}

impl Planned {
    /// The name of the rung of reconstruction.
    pub(super) fn reconstruction(&self) -> &'static str {
        choice::reconstruction(&self.plan)
    }

    /// Bytes of RAM that the kernel's state takes on the device: the light, the room
    /// in which surfaces are reconstructed, and the workspace of exact visibility
    /// with what it must hold.
    pub(super) fn ram(&self) -> Result<(usize, records::Sight), Failure> {
        let (counts, bytes) = (&self.tables.counts, self.tables.bytes());
        if self.rung.is_integer() {
            let light = isolux::integers::light_bytes(counts);
            return Ok((light, records::Sight::default()));
        }
        let scene = isolux::scene::Scene::load(bytes).map_err(refused)?;
        let workspace = match self.sight {
            Sight::Exact => *scene.sight(),
            _ => records::Sight::default(),
        };
        let reflectances = match self.plan.repaint {
            true => isolux::budget::reflectance_bytes(counts),
            false => 0,
        };
        let light = isolux::budget::light_bytes(counts) + reflectances;
        let room = isolux::budget::room_bytes(counts);
        let bytes = light + room + isolux::budget::sight_bytes(&workspace);
        Ok((bytes, workspace))
    }

    /// Leaves room for reflectances that change on the device, where that is asked for or
    /// the plan says so.
    pub(super) fn repaint(&mut self, asked: bool) -> Result<(), Failure> {
        self.plan.repaint |= asked;
        let holds = !self.rung.is_integer() && self.transfer != Transfer::Vectors;
        match self.plan.repaint && !holds {
            true => Err(Failure::usage(
                "reflectances change neither in integers nor with the transfer `vectors`, which holds for those that are baked",
                "leave out --repaint, or take another --arithmetic or --transfer",
            )),
            false => Ok(()),
        }
    }

    /// Refuses what a scene's own budget cannot hold: the kernel's state in RAM
    /// and the tables in flash. Code and stack are known once a firmware is
    /// linked.
    pub(super) fn affordable(&self) -> Result<(), Failure> {
        let (scene, tables) = (&self.scene, &self.tables);
        let limits = [
            ("ram", "RAM", scene.budget.ram, self.ram()?.0 as u64),
            (
                "flash",
                "flash",
                scene.budget.flash,
                tables.bytes().len() as u64,
            ),
        ];
        for (key, name, limit, needed) in limits {
            if let Some(limit) = limit.filter(|&limit| needed > limit) {
                return Err(Failure::limit(
                    format!(
                        "scene `{}` needs {needed} bytes of {name} for {} samples and {} emitters, its budget is {limit}",
                        scene.name, tables.counts.samples, tables.counts.emitters
                    ),
                    format!("raise [budget] {key} or lower [budget] samples"),
                ));
            }
        }
        Ok(())
    }

    /// Solves it on the host, with the kernel.
    pub(super) fn solve(&self, bounces: Option<u32>) -> Result<Solution<'_>, Failure> {
        solve::solve(&self.tables, self.rung, self.sight, stop(bounces)).map_err(refused)
    }
}

/// Tables that the kernel does not take.
fn refused(error: isolux::Error) -> Failure {
    Failure::limit(error, "lower [budget] samples or split the scene")
}

/// When the kernel stops.
pub(super) fn stop(bounces: Option<u32>) -> Stop {
    bounces.map_or(Stop::below(UNSHOT), Stop::Reflections)
}

/// The light that a picture is judged by: all of it, or what `--bounces` asks
/// for.
pub(super) fn all_light(bounces: Option<u32>) -> Reflections {
    bounces.map_or(Reflections::UntilUnshot(CONVERGED), |n| {
        Reflections::AtMost(n as usize)
    })
}

/// The light that `solve --reference` answers with: what the kernel shoots.
pub(super) fn same_light(bounces: Option<u32>) -> Reflections {
    bounces.map_or(Reflections::UntilUnshot(f64::from(UNSHOT)), |n| {
        Reflections::AtMost(n as usize)
    })
}

/// The f64 reference, with progress.
pub(super) fn judge(scene: &Scene, reflections: Reflections) -> Result<Reference, Failure> {
    const STEPS: f64 = 1000.0;
    let progress = Progress::start("reference", STEPS as u64);
    let mut tell = |done: f64| {
        let done = (done.clamp(0.0, 1.0) * STEPS) as u64;
        progress.advance(done.saturating_sub(progress.done()));
    };
    Reference::new(scene, reflections, &mut tell).map_err(|error| match error {
        reference::Error::Outline { .. } => {
            Failure::Input(Diagnostic::of_file(&scene.name, error.to_string(), ""))
        }
        _ => Failure::limit(error, ""),
    })
}
