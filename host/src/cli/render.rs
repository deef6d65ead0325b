//! `isolux render`: plan, solve, judge, draw.

mod drawing;
mod words;

use super::choice::RungArguments;
use super::failure::Failure;
use super::pipeline::{self, Planned};
use super::{BouncesArgument, PlanArgument, SceneArgument};
use crate::baseline::{self, Baseline, Parameters, Stop};
use crate::compare::{
    self, Answers, Balance, Compared, Errors, Regions, Seen, Tagged, effort, errors_by_scale,
};
use crate::occlusion::Solids;
use crate::reference::Reference;
use crate::report::Progress;
use crate::scene::camera::View;
use crate::scene::requires::requirements;
use crate::solve::Solution;
use clap::Args;
use serde::Serialize;
use std::io::Write;
use std::path::{Path, PathBuf};

/// Plans a scene, solves it with the kernel, compares it with the reference,
/// and writes pictures and the error table.
#[derive(Debug, Args)]
pub(super) struct Arguments {
    #[command(flatten)]
    scene: SceneArgument,
    /// The directory for the pictures; made where it does not exist.
    #[arg(short, long, value_name = "DIR")]
    output: PathBuf,
    /// Pixels along each side of the camera's picture.
    #[arg(long, value_name = "PIXELS", default_value_t = PIXELS, value_parser = clap::value_parser!(u32).range(16..=4096))]
    resolution: u32,
    #[command(flatten)]
    bounces: BouncesArgument,
    #[command(flatten)]
    plan: PlanArgument,
    #[command(flatten)]
    rungs: RungArguments,
}

/// Pixels along each side of the camera's picture.
const PIXELS: u32 = 600;

/// Cells along each side of a surface's grid.
pub(super) const GRID: usize = 200;

impl Arguments {
    /// What `isolux` alone does.
    pub(super) fn of_the_paper() -> Self {
        Self {
            scene: SceneArgument {
                scene: "paper.toml".into(),
            },
            output: "isolux-out".into(),
            resolution: PIXELS,
            bounces: BouncesArgument { bounces: None },
            plan: PlanArgument::default(),
            rungs: RungArguments::default(),
        }
    }
}

/// Everything that was found out about a scene.
struct Judged<'a> {
    planned: &'a Planned,
    solution: &'a Solution<'a>,
    reference: &'a Reference,
    baseline: Option<&'a Baseline>,
    surfaces: Vec<Compared>,
    camera: Option<(View, Seen)>,
    tags: ByTag,
    balance: Balance,
}

/// Errors by the tags of places.
struct ByTag {
    /// Of each surface, with how many of its samples are there.
    surfaces: Vec<Vec<(Tagged, usize)>>,
    camera: Vec<Tagged>,
}

#[derive(Serialize)]
struct Rendered<'a> {
    scene: &'a str,
    quantity: &'static str,
    bounces: Option<u32>,
    rungs: Chosen,
    form_factor_samples: usize,
    form_factor_evaluations: u32,
    free_samples: usize,
    shots: u32,
    unshot: f32,
    surfaces: Vec<SurfaceErrors<'a>>,
    error: Errors,
    /// The same by the tags of the pixels; none without a camera.
    tags: Vec<TagErrors>,
    /// The kernel's answer at each pixel, without resampling: in rooms.
    #[serde(skip_serializing_if = "Option::is_none")]
    evaluated: Option<AtPixels>,
    resolution: Option<[u32; 2]>,
    balance: Balance,
    reference: Judge,
    baseline: Option<Classical<'a>>,
    files: Vec<String>,
}

#[derive(Serialize)]
struct Chosen {
    arithmetic: &'static str,
    visibility: &'static str,
    emitters: &'static str,
    transfer: &'static str,
    placement: &'static str,
    reconstruction: &'static str,
}

#[derive(Serialize)]
struct SurfaceErrors<'a> {
    name: &'a str,
    samples: usize,
    emitters: usize,
    error: Errors,
    tags: Vec<TagErrors>,
    out_of_reach: u32,
}

/// What the places of one tag err by.
#[derive(Serialize)]
struct TagErrors {
    tag: &'static str,
    /// How many of the places these are, in percent.
    share: f64,
    /// How many samples are there; `null` over pixels.
    samples: Option<usize>,
    error: Errors,
}

#[derive(Serialize)]
struct AtPixels {
    error: Errors,
    /// Pixels at which visibility met a bound of the workspace.
    inexact: usize,
}

#[derive(Serialize)]
struct Judge {
    name: &'static str,
    reflections: usize,
    accuracy: f64,
}

#[derive(Serialize)]
struct Classical<'a> {
    delta_form_factors: u64,
    surfaces: Vec<ClassicalErrors<'a>>,
    error: Errors,
}

#[derive(Serialize)]
struct ClassicalErrors<'a> {
    name: &'a str,
    vertices: usize,
    error: Errors,
}

pub(super) fn run(arguments: &Arguments, json: bool) -> Result<(), Failure> {
    let planned = pipeline::plan_or_read(
        pipeline::read(&arguments.scene.scene)?,
        &arguments.rungs,
        arguments.plan.plan.as_deref(),
        &[],
    )?;
    let bounces = arguments.bounces.bounces;
    // A directory that cannot be made is found out before the work is done.
    make(&arguments.output)?;
    let solution = planned.solve(bounces)?;
    let reference = pipeline::judge(&planned.scene, pipeline::all_light(bounces))?;
    let baseline = classical(&planned, &reference);
    let answers = Answers {
        scene: &planned.scene,
        plan: &planned.plan,
        reference: &reference,
        solution: &solution,
        baseline: baseline.as_ref(),
    };
    let judged = judge(&answers, &planned, arguments.resolution)?;
    let files = drawing::draw(&judged, &arguments.output)?;
    let rendered = rendered(&judged, bounces, files);
    let mut out = std::io::stdout().lock();
    if json {
        serde_json::to_writer(&mut out, &rendered).map_err(std::io::Error::from)?;
        writeln!(out)?;
    } else {
        out.write_all(words::table(&judged, &rendered, &arguments.output).as_bytes())?;
    }
    Ok(())
}

pub(super) fn make(directory: &Path) -> Result<(), Failure> {
    std::fs::create_dir_all(directory).map_err(|error| {
        Failure::usage(
            format!("cannot make the directory {}: {error}", directory.display()),
            "give one that can be written with -o DIR",
        )
    })
}

/// The classical method, where every surface is a parallelogram, nothing
/// occludes and all is grey; as many reflections as the reference followed.
fn classical(planned: &Planned, reference: &Reference) -> Option<Baseline> {
    let needs = requirements(&planned.scene);
    if needs.visibility.is_some() || needs.channels > 1 {
        return None;
    }
    let parameters = Parameters {
        stop: Stop::Reflections(reference.reflections()),
        ..Parameters::default()
    };
    // A scene it cannot do has no such column: no error of the user's.
    baseline::solve(&planned.scene, &parameters).ok()
}

fn judge<'a>(
    answers: &Answers<'a>,
    planned: &'a Planned,
    resolution: u32,
) -> Result<Judged<'a>, Failure> {
    let surfaces = &planned.scene.surfaces;
    let reflecting: Vec<usize> = (0..surfaces.len())
        .filter(|&k| surfaces[k].reflects())
        .collect();
    let camera = planned.scene.camera.as_ref();
    let view = camera.map(|camera| View::new(camera, resolution, resolution));
    let pixels = view.as_ref().map_or(0, |view| effort(answers, view));
    let places = (reflecting.len() * GRID * GRID) as u64 + pixels;
    let progress = Progress::start("comparing", places);
    let mut done = |places: usize| progress.advance(places as u64);
    let unknown = |error: isolux::Error| Failure::limit(error, "");
    let solids = Solids::of(&planned.scene);
    let mut compared = Vec::new();
    let mut full_scale = vec![0.0; surfaces.len()];
    for index in reflecting {
        let surface =
            compare::surface(answers, &solids, index, GRID, &mut done).map_err(unknown)?;
        full_scale[index] = surface.full_scale;
        compared.push(surface);
    }
    let camera = match view {
        Some(view) => {
            let seen = compare::camera(answers, &view, &full_scale, &mut done).map_err(unknown)?;
            Some((view, seen))
        }
        None => None,
    };
    Ok(Judged {
        tags: by_tag(planned, &compared, camera.as_ref(), &full_scale)?,
        planned,
        solution: answers.solution,
        reference: answers.reference,
        baseline: answers.baseline,
        surfaces: compared,
        camera,
        balance: compare::balance(&planned.scene, &planned.plan, answers.solution),
    })
}

fn by_tag(
    planned: &Planned,
    surfaces: &[Compared],
    camera: Option<&(View, Seen)>,
    full_scale: &[f64],
) -> Result<ByTag, Failure> {
    let regions = Regions::of(&planned.scene).map_err(|error| Failure::limit(error, ""))?;
    let cells = surfaces.iter().flat_map(|compared| &compared.inside);
    let pixels = camera.map_or(0, |(_, seen)| seen.hits.iter().flatten().count());
    let places = cells.filter(|&&inside| inside).count() + pixels;
    let progress = Progress::start("telling shadows from light", places as u64);
    let done = |places: usize| progress.advance(places as u64);
    let of_surface = |compared: &Compared| {
        let index = compared.surface;
        let samples = regions.of_samples(index, &planned.plan.surfaces[index]);
        let tagged = regions.of_surface(compared, &done).into_iter();
        let count = |tag| samples.iter().filter(|&&its| its == tag).count();
        tagged.map(|tagged| (tagged, count(tagged.tag))).collect()
    };
    Ok(ByTag {
        surfaces: surfaces.iter().map(of_surface).collect(),
        camera: camera.map_or(Vec::new(), |(_, seen)| {
            regions.of_camera(seen, full_scale, &done)
        }),
    })
}

fn tag_errors(tagged: &Tagged, samples: Option<usize>) -> TagErrors {
    TagErrors {
        tag: tagged.tag.name(),
        share: tagged.share,
        samples,
        error: tagged.errors,
    }
}

impl Judged<'_> {
    fn name(&self, surface: usize) -> &str {
        &self.planned.scene.surfaces[surface].name
    }

    /// The errors over the camera's pixels, or over all surfaces where there is
    /// no camera.
    fn overall(&self) -> Errors {
        let of = |compared: &Compared| compared.structured.clone();
        self.camera
            .as_ref()
            .map_or_else(|| self.over_surfaces(of), |(_, seen)| seen.errors)
    }

    fn overall_baseline(&self) -> Option<Errors> {
        self.baseline?;
        let of = |compared: &Compared| compared.baseline.clone().unwrap_or_default();
        match &self.camera {
            Some((_, seen)) => seen.baseline_errors,
            None => Some(self.over_surfaces(of)),
        }
    }

    fn over_surfaces(&self, values: impl Fn(&Compared) -> Vec<f64>) -> Errors {
        errors_by_scale(self.surfaces.iter().flat_map(|compared| {
            let values = values(compared);
            let inside: Vec<_> = (0..values.len())
                .filter(|&k| compared.inside[k])
                .map(|k| (values[k], compared.reference[k], compared.full_scale))
                .collect();
            inside
        }))
    }
}

fn rendered<'a>(judged: &'a Judged<'a>, bounces: Option<u32>, files: Vec<String>) -> Rendered<'a> {
    let solved = judged.solution.solved;
    let surfaces = judged.surfaces.iter().zip(&judged.tags.surfaces);
    let surfaces = surfaces.map(|(compared, tags)| {
        let planned = &judged.planned.plan.surfaces[compared.surface];
        SurfaceErrors {
            name: judged.name(compared.surface),
            samples: planned.samples.len(),
            emitters: planned.outlines().len(),
            error: compared.errors,
            tags: tags
                .iter()
                .map(|(tagged, samples)| tag_errors(tagged, Some(*samples)))
                .collect(),
            out_of_reach: compared.out_of_reach,
        }
    });
    let classical = judged.baseline.map(|baseline| Classical {
        delta_form_factors: baseline.evaluations(),
        surfaces: judged
            .surfaces
            .iter()
            .filter_map(|compared| {
                Some(ClassicalErrors {
                    name: judged.name(compared.surface),
                    vertices: baseline.vertices(compared.surface)?,
                    error: compared.baseline_errors?,
                })
            })
            .collect(),
        error: judged.overall_baseline().unwrap_or_default(),
    });
    Rendered {
        scene: &judged.planned.scene.name,
        quantity: judged.planned.scene.quantity.irradiance_unit(),
        bounces,
        rungs: Chosen {
            arithmetic: judged.planned.rung.name(),
            visibility: judged.planned.sight.name(),
            emitters: judged.planned.emitters.name(),
            transfer: judged.planned.transfer.name(),
            placement: judged.planned.placement.name(),
            reconstruction: judged.planned.reconstruction(),
        },
        form_factor_samples: judged.planned.plan.samples(),
        form_factor_evaluations: solved.form_factors,
        free_samples: judged.planned.plan.free_samples(),
        shots: solved.shots,
        unshot: solved.unshot,
        surfaces: surfaces.collect(),
        error: judged.overall(),
        tags: judged
            .tags
            .camera
            .iter()
            .map(|tagged| tag_errors(tagged, None))
            .collect(),
        evaluated: judged.camera.as_ref().and_then(|(_, seen)| {
            let evaluated = seen.evaluated.as_ref()?;
            Some(AtPixels {
                error: evaluated.errors,
                inexact: evaluated.inexact,
            })
        }),
        balance: judged.balance,
        resolution: judged
            .camera
            .as_ref()
            .map(|(view, _)| [view.width(), view.height()]),
        reference: Judge {
            name: "f64, direct light analytic, reflections by adaptive quadrature or Galerkin radiosity",
            reflections: judged.reference.reflections(),
            accuracy: judged.reference.accuracy(),
        },
        baseline: classical,
        files,
    }
}
