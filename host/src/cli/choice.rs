//! Which rung of each accuracy ladder a command takes: the flag, else what a plan
//! file was made for, else what the scene asks for, else the default.

use super::failure::Failure;
use crate::plan::file::Saved;
use crate::plan::{Plan, SurfacePlan};
use crate::scene::requires::Requirements;
use crate::scene::rungs::LADDERS;
use crate::scene::{Rungs, Scene};
use crate::solve::{FormFactorRung, Sight};
use clap::Args;

/// The flags named after the ladders.
#[derive(Clone, Debug, Default, Args)]
#[command(next_help_heading = "Accuracy ladders")]
pub(super) struct RungArguments {
    /// Number type and edge term: libm, micromath, poly3, poly5, poly8, best;
    /// without floating point q24, q29: grey scenes in which nothing hides anything, and
    /// with --transfer matrix any grey scene.
    #[arg(long, value_name = "RUNG")]
    pub(super) arithmetic: Option<String>,
    /// How occlusion is found: exact (the default where something can occlude),
    /// vertex-rays, none (light passes through everything).
    #[arg(long, value_name = "RUNG")]
    pub(super) visibility: Option<String>,
    /// What shoots reflected light: points (the default of open scenes where they
    /// hold), few-points (as few as surfaces and named points are lit well by, for the
    /// light as it is), linear (of others), isolux (the paper's), layer-cake (nested
    /// outlines; the power is conserved).
    #[arg(long, value_name = "RUNG")]
    pub(super) emitters: Option<String>,
    /// How emitter-to-receiver terms are had: exact (the default), codes (written
    /// beforehand: no occluder is on the device), matrix (the terms themselves,
    /// rounded), vectors (what every sample receives of each luminaire in the end:
    /// for dimming alone).
    #[arg(long, value_name = "RUNG")]
    pub(super) transfer: Option<String>,
    /// How samples are placed: error (where they lessen the error most, the
    /// default), isolux (the paper's).
    #[arg(long, value_name = "RUNG")]
    pub(super) placement: Option<String>,
    /// How samples become an image: tensor (the default of open scenes), stencil,
    /// cone (the paper's).
    #[arg(long, value_name = "RUNG")]
    pub(super) reconstruction: Option<String>,
    /// Places samples for the scene's camera: what it sees larger gets more of them, and
    /// the predicted error is that of its pixels. Rooms by error only.
    #[arg(long)]
    pub(super) for_camera: bool,
    /// Whether light is only evaluated from the emitters and never reconstructed
    /// from samples: then a room is planned for its emitters alone.
    #[arg(skip)]
    pub(super) at_points: bool,
}

/// The rungs of this build, by ladder.
const BUILT: [(&str, &[&str]); 6] = [
    (
        "arithmetic",
        &[
            "libm",
            "micromath",
            "poly3",
            "poly5",
            "poly8",
            "best",
            "q24",
            "q29",
        ],
    ),
    ("visibility", &["none", "vertex-rays", "exact"]),
    (
        "emitters",
        &["isolux", "layer-cake", "points", "few-points", "linear"],
    ),
    ("transfer", &["exact", "codes", "matrix", "vectors"]),
    ("placement", &["isolux", "error"]),
    ("reconstruction", &["cone", "stencil", "tensor"]),
];

/// What shoots reflected light.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Emitters {
    /// The paper's: bands between isolux outlines.
    Isolux,
    /// The samples themselves, each for the area around it.
    Points,
    /// Few of them, each for an area that is fitted to what they light.
    FewPoints,
    /// What each isolux outline encloses.
    LayerCake,
    /// Patches with linear radiosity.
    Linear,
}

/// How samples are placed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Placement {
    /// The paper's: on isolux outlines.
    Isolux,
    /// Where they lessen the error most.
    Error,
}

impl Placement {
    /// Its name on the ladder.
    pub(super) fn name(self) -> &'static str {
        match self {
            Self::Isolux => "isolux",
            Self::Error => "error",
        }
    }
}

impl Emitters {
    /// Its name on the ladder.
    pub(super) fn name(self) -> &'static str {
        match self {
            Self::Isolux => "isolux",
            Self::Points => "points",
            Self::FewPoints => "few-points",
            Self::LayerCake => "layer-cake",
            Self::Linear => "linear",
        }
    }
}

/// How what a sample receives from an emitter is had on the device.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Transfer {
    /// It is computed, past the occluders in the tables.
    Exact,
    /// By codes that were written when the scene was baked.
    Codes,
    /// By terms that were rounded when the scene was baked.
    Matrix,
    /// By what every sample receives in the end of every luminaire.
    Vectors,
}

impl Transfer {
    /// Its name on the ladder.
    pub(super) fn name(self) -> &'static str {
        match self {
            Self::Exact => "exact",
            Self::Codes => "codes",
            Self::Matrix => "matrix",
            Self::Vectors => "vectors",
        }
    }
}

/// The rungs that a scene is solved with.
#[derive(Clone, Copy, Debug)]
pub(super) struct Choices {
    pub(super) arithmetic: FormFactorRung,
    pub(super) sight: Sight,
    pub(super) emitters: Emitters,
    pub(super) transfer: Transfer,
    pub(super) placement: Placement,
    /// Whether points were asked for, and not only taken where they hold.
    pub(super) points_asked: bool,
    /// Whether light is only evaluated from the emitters.
    pub(super) at_points: bool,
    /// Whether the camera says where samples go.
    pub(super) for_camera: bool,
}

/// Surfaces that reflect, above which light goes to and fro so much that a
/// scene is a room.
pub(super) const OPEN: usize = 2;

/// Checks every choice: the flag, else the scene's, else the default.
pub(super) fn choices(
    flags: &RungArguments,
    scene: &Scene,
    needs: &Requirements,
) -> Result<Choices, Failure> {
    let asked = |flag: &Option<String>, scene: &Option<String>| flag.clone().or(scene.clone());
    let rungs = Rungs {
        arithmetic: asked(&flags.arithmetic, &scene.rungs.arithmetic),
        visibility: asked(&flags.visibility, &scene.rungs.visibility),
        emitters: asked(&flags.emitters, &scene.rungs.emitters),
        transfer: asked(&flags.transfer, &scene.rungs.transfer),
        placement: asked(&flags.placement, &scene.rungs.placement),
        reconstruction: asked(&flags.reconstruction, &scene.rungs.reconstruction),
    };
    let choices = [
        &rungs.arithmetic,
        &rungs.visibility,
        &rungs.emitters,
        &rungs.transfer,
        &rungs.placement,
        &rungs.reconstruction,
    ];
    for ((ladder, built), choice) in BUILT.iter().zip(choices) {
        if let Some(name) = choice {
            has(ladder, built, name)?;
        }
    }
    let is_room = needs.visibility.is_some() || needs.reflectors.len() > OPEN;
    let transfer = match rungs.transfer.as_deref() {
        Some("codes") => Transfer::Codes,
        Some("matrix") => Transfer::Matrix,
        Some("vectors") => Transfer::Vectors,
        _ => Transfer::Exact,
    };
    let by_pairs = matches!(transfer, Transfer::Codes | Transfer::Matrix);
    if by_pairs {
        let linear = &["linear"];
        agree(transfer, "emitters", rungs.emitters.as_deref(), linear)?;
    }
    if transfer != Transfer::Exact {
        let looked = &["exact", "none"];
        agree(transfer, "visibility", rungs.visibility.as_deref(), looked)?;
    }
    let arithmetic = arithmetic(rungs.arithmetic.as_deref())?;
    let cone = rungs.reconstruction.as_deref() == Some("cone");
    let nested = ["isolux", "layer-cake"];
    let outlined = rungs
        .emitters
        .as_deref()
        .is_some_and(|name| nested.contains(&name));
    let placement = match rungs.placement.as_deref() {
        Some("isolux") => Placement::Isolux,
        Some(_) => Placement::Error,
        None if cone || outlined || arithmetic.is_integer() => Placement::Isolux,
        None if flags.at_points && (is_room || rungs.emitters.as_deref() == Some("linear")) => {
            Placement::Isolux
        }
        None => Placement::Error,
    };
    let choices = Choices {
        arithmetic,
        transfer,
        placement,
        points_asked: matches!(rungs.emitters.as_deref(), Some("points" | "few-points")),
        at_points: flags.at_points,
        for_camera: flags.for_camera,
        sight: match rungs.visibility.as_deref() {
            Some("vertex-rays") => Sight::VertexRays,
            Some("none") => Sight::None,
            Some(_) => Sight::Exact,
            None if needs.visibility.is_some() => Sight::Exact,
            None => Sight::None,
        },
        emitters: match rungs.emitters.as_deref() {
            Some("linear") => Emitters::Linear,
            Some("points") => Emitters::Points,
            Some("few-points") => Emitters::FewPoints,
            Some("layer-cake") => Emitters::LayerCake,
            Some(_) => Emitters::Isolux,
            None if is_room || by_pairs => Emitters::Linear,
            None if placement == Placement::Error => Emitters::Points,
            None => Emitters::Isolux,
        },
    };
    integers_suffice(&choices, needs)?;
    ladders_agree(&choices, &rungs, is_room)?;
    placed_for_camera(&choices, scene)?;
    Ok(choices)
}

/// Refuses `--for-camera` where it would change nothing.
fn placed_for_camera(choices: &Choices, scene: &Scene) -> Result<(), Failure> {
    let by_error = choices.placement == Placement::Error && choices.emitters == Emitters::Linear;
    let without = "leave out --for-camera";
    match choices.for_camera {
        true if scene.camera.is_none() => Err(Failure::usage(
            format!("scene `{}` has no camera to place samples for", scene.name),
            format!("add a [camera] to it, or {without}"),
        )),
        true if choices.at_points || !by_error => Err(Failure::usage(
            "only rooms whose samples are placed by error, and reconstructed from, have samples for a camera",
            without,
        )),
        _ => Ok(()),
    }
}

/// The name of the rung of reconstruction that a plan has.
pub(super) fn reconstruction(plan: &Plan) -> &'static str {
    let fields = || plan.surfaces.iter().flat_map(|s| &s.fields);
    match (fields().next(), fields().any(|field| field.mesh.is_some())) {
        (None, _) => "cone",
        (_, false) => "tensor",
        (_, true) => "stencil",
    }
}

/// What shoots in a plan; `None` where nothing reflects.
fn emitters(plan: &Plan) -> Option<Emitters> {
    let any = |holds: fn(&SurfacePlan) -> bool| plan.surfaces.iter().any(holds);
    let few = |surface: &SurfacePlan| (1..surface.samples.len()).contains(&surface.points.len());
    match () {
        () if plan.is_linear() => Some(Emitters::Linear),
        () if any(few) => Some(Emitters::FewPoints),
        () if any(|surface| !surface.points.is_empty()) => Some(Emitters::Points),
        () if plan.is_layered() => Some(Emitters::LayerCake),
        () => any(|surface| !surface.bands.is_empty()).then_some(Emitters::Isolux),
    }
}

/// The rungs of a plan file: those it names, else the scene's own, and those that its
/// samples and emitters are.
///
/// # Errors
/// Where a flag asks for what only another plan can have.
pub(super) fn of_saved(
    saved: &Saved,
    flags: &RungArguments,
    own: &Rungs,
) -> Result<Rungs, Failure> {
    let reconstruction = reconstruction(&saved.plan);
    let placement = match reconstruction {
        "cone" => Placement::Isolux,
        _ => Placement::Error,
    };
    let emitters = emitters(&saved.plan).map(Emitters::name);
    let fixed = [
        ("emitters", emitters, &flags.emitters),
        ("placement", Some(placement.name()), &flags.placement),
        (
            "reconstruction",
            Some(reconstruction),
            &flags.reconstruction,
        ),
    ];
    for (ladder, held, flag) in fixed {
        if let (Some(held), Some(flag)) = (held, flag)
            && held != flag
        {
            return Err(Failure::usage(
                format!("the plan has {ladder} `{held}`, and --{ladder} asks for `{flag}`"),
                format!("leave out --{ladder}, or make such a plan: isolux plan --{ladder} {flag}"),
            ));
        }
    }
    let named = |saved: &Option<String>, own: &Option<String>| saved.clone().or(own.clone());
    Ok(Rungs {
        arithmetic: named(&saved.rungs.arithmetic, &own.arithmetic),
        visibility: named(&saved.rungs.visibility, &own.visibility),
        transfer: named(&saved.rungs.transfer, &own.transfer),
        emitters: emitters.map(str::to_owned),
        placement: Some(placement.name().to_owned()),
        reconstruction: None,
    })
}

/// Refuses rungs that do not go together.
fn ladders_agree(choices: &Choices, rungs: &Rungs, is_room: bool) -> Result<(), Failure> {
    let by_error = choices.placement == Placement::Error;
    let cone = rungs.reconstruction.as_deref().map(|name| name == "cone");
    let (what, remedy) = match (by_error, choices.emitters, cone) {
        (true, Emitters::Isolux | Emitters::LayerCake, _) => (
            format!(
                "emitters `{}` with placement `error`",
                choices.emitters.name()
            ),
            "take placement `isolux`, or emitters `points` or `linear`",
        ),
        (false, Emitters::Points | Emitters::FewPoints, _) => (
            format!(
                "emitters `{}` with placement `isolux`",
                choices.emitters.name()
            ),
            "take placement `error`, or emitters `isolux`",
        ),
        (true, Emitters::Points | Emitters::FewPoints, _) if is_room => (
            format!("emitters `{}` in a room", choices.emitters.name()),
            "take emitters `linear`: points stand for surfaces that are far off and in full view",
        ),
        (true, _, Some(true)) => (
            "reconstruction `cone` with placement `error`".to_owned(),
            "take placement `isolux`, or reconstruction `tensor` or `stencil`",
        ),
        (false, _, Some(false)) => (
            "placement `isolux` without reconstruction `cone`".to_owned(),
            "take placement `error`, or reconstruction `cone`",
        ),
        (true, Emitters::Linear, _) if rungs.reconstruction.as_deref() == Some("tensor") => (
            "reconstruction `tensor` where light goes to and fro, or is hidden".to_owned(),
            "take reconstruction `stencil`, whose meshes follow the edges of light",
        ),
        _ => return Ok(()),
    };
    Err(Failure::limit(format!("{what} cannot be had"), remedy))
}

/// Refuses a rung that a transfer cannot be written for.
fn agree(
    transfer: Transfer,
    ladder: &str,
    chosen: Option<&str>,
    with_it: &[&str],
) -> Result<(), Failure> {
    match chosen {
        Some(name) if !with_it.contains(&name) => Err(Failure::limit(
            format!(
                "transfer `{}` cannot be had with {ladder} `{name}`",
                transfer.name()
            ),
            format!(
                "take {ladder} `{}`, or transfer `exact`",
                with_it.join("` or `")
            ),
        )),
        _ => Ok(()),
    }
}

/// Refuses an integer rung where light is what integers do not compute.
fn integers_suffice(choices: &Choices, needs: &Requirements) -> Result<(), Failure> {
    if !choices.arithmetic.is_integer() {
        return Ok(());
    }
    let matrix = choices.transfer == Transfer::Matrix;
    let (why, remedy) = if needs.channels > 1 {
        ("is in colour", "leave out --arithmetic")
    } else if matrix && choices.placement == Placement::Error {
        (
            "is to be put together from samples placed by error",
            "leave out --placement: the cone filter spreads what integers give",
        )
    } else if matrix {
        return Ok(());
    } else if choices.transfer != Transfer::Exact {
        let remedy = "leave out --arithmetic, or take --transfer matrix";
        ("is to have its transfer written down", remedy)
    } else if choices.sight != Sight::None {
        let remedy = "take --transfer matrix, which says what is hidden, or leave out --arithmetic";
        ("has occluders", remedy)
    } else if choices.emitters == Emitters::Linear {
        let remedy = "take --transfer matrix or --emitters isolux, or leave out --arithmetic";
        ("has linear radiosities", remedy)
    } else if matches!(choices.emitters, Emitters::Points | Emitters::FewPoints) {
        (
            "has points",
            "leave out --arithmetic, or take --emitters isolux",
        )
    } else if choices.emitters == Emitters::LayerCake {
        let remedy = "leave out --arithmetic, or take --emitters isolux";
        ("has increments of radiosity", remedy)
    } else {
        return Ok(());
    };
    Err(Failure::limit(
        format!(
            "the rung `{}` of arithmetic serves grey scenes with constant radiosities in which nothing hides anything, and others by the transfer `matrix`; this one {why}",
            choices.arithmetic.name()
        ),
        remedy,
    ))
}

/// The arithmetic rung of a name, or the default.
pub(super) fn arithmetic(name: Option<&str>) -> Result<FormFactorRung, Failure> {
    let Some(name) = name else {
        return Ok(FormFactorRung::default());
    };
    let (ladder, built) = BUILT[0];
    has(ladder, built, name)?;
    FormFactorRung::named(name).ok_or_else(|| lacking(ladder, built, name))
}

fn has(ladder: &str, built: &[&str], name: &str) -> Result<(), Failure> {
    if built.contains(&name) {
        return Ok(());
    }
    let known = LADDERS.iter().find(|known| known.name == ladder);
    match known {
        Some(known) if known.has(name) => Err(lacking(ladder, built, name)),
        Some(known) => Err(Failure::usage(
            format!("`{name}` is no rung of {ladder}"),
            format!("the rungs of {ladder} are {}", known.rungs.join(", ")),
        )),
        None => Err(Failure::usage(format!("there is no ladder `{ladder}`"), "")),
    }
}

fn lacking(ladder: &str, built: &[&str], name: &str) -> Failure {
    Failure::limit(
        format!("this build lacks the rung `{name}` of {ladder}"),
        format!("it has {}", built.join(", ")),
    )
}
