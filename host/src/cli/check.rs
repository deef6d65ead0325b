//! `isolux check`: is the scene sound, and what does it require?

use super::choice::{self, Emitters, RungArguments};
use super::failure::Failure;
use super::pipeline;
use super::{PlanArgument, SceneArgument};
use crate::occlusion::Solids;
use crate::scene::requires::{Need, Requirements, requirements};
use crate::scene::{Body, Scene};
use clap::Args;
use isolux::scene::records::{Counts, Sight};
use serde::Serialize;
use std::io::Write;

/// Validates a scene and says what it requires and why: what must be modelled,
/// how many samples and emitters a firmware must hold, how many bytes that is.
#[derive(Debug, Args)]
pub(super) struct Arguments {
    #[command(flatten)]
    scene: SceneArgument,
    #[command(flatten)]
    plan: PlanArgument,
    #[command(flatten)]
    rungs: RungArguments,
}

#[derive(Serialize)]
struct Checked {
    scene: String,
    surfaces: usize,
    emitters: usize,
    bodies: usize,
    channels: usize,
    requires: Vec<Need>,
    /// `null` where this build cannot plan the scene.
    capacities: Option<Capacities>,
    ram_bytes: Option<usize>,
    flash_bytes: Option<usize>,
    /// Why this build cannot plan the scene.
    #[serde(skip_serializing_if = "Option::is_none")]
    lacking: Option<String>,
}

#[derive(Serialize)]
struct Capacities {
    samples: usize,
    emitters: usize,
    loops: usize,
    vertices: usize,
    occluders: usize,
    /// Entries of the emitters' lists of what can hide them.
    blockers: usize,
    /// What the workspace of exact visibility must hold; all 0 without it.
    sight: Workspace,
}

/// The capacities of the workspace, as the kernel's `Exact` takes them.
#[derive(Serialize)]
struct Workspace {
    vertices: u32,
    pieces: u32,
    lines: u32,
    blockers: u32,
}

impl Capacities {
    fn of(counts: &Counts, sight: Sight) -> Self {
        Self {
            samples: counts.samples as usize,
            emitters: counts.emitters as usize,
            loops: counts.loops as usize,
            vertices: counts.vertices as usize,
            occluders: counts.occluders as usize,
            blockers: counts.blockers as usize,
            sight: Workspace {
                vertices: sight.vertices,
                pieces: sight.pieces,
                lines: sight.lines,
                blockers: sight.blockers,
            },
        }
    }
}

pub(super) fn run(arguments: &Arguments, json: bool) -> Result<(), Failure> {
    let scene = pipeline::read(&arguments.scene.scene)?;
    let needs = requirements(&scene);
    let solids = Solids::of(&scene);
    let mut required = needs.needs(&scene);
    required.extend(recognised(&scene, &solids));
    required.extend(linear(&scene, &needs, &arguments.rungs));
    let mut checked = Checked {
        surfaces: scene.surfaces.len(),
        emitters: needs.luminaires.len(),
        bodies: solids.surfaces().len(),
        channels: needs.channels,
        requires: required,
        capacities: None,
        ram_bytes: None,
        flash_bytes: None,
        lacking: None,
        scene: scene.name.clone(),
    };
    // What this build lacks or a budget forbids is an answer here, no failure.
    let planned =
        pipeline::plan_or_read(scene, &arguments.rungs, arguments.plan.plan.as_deref(), &[]);
    match planned.and_then(|planned| Ok((planned.ram()?, planned))) {
        Ok(((ram, sight), planned)) => {
            checked.capacities = Some(Capacities::of(&planned.tables.counts, sight));
            checked.ram_bytes = Some(ram);
            checked.flash_bytes = Some(planned.tables.bytes().len());
        }
        Err(Failure::Limit { message, remedy }) => {
            checked.lacking = Some(format!("{message}: {remedy}"));
        }
        Err(failure) => return Err(failure),
    }
    let mut out = std::io::stdout().lock();
    if json {
        serde_json::to_writer(&mut out, &checked).map_err(std::io::Error::from)?;
        writeln!(out)?;
    } else {
        write!(out, "{}", in_words(&checked))?;
    }
    Ok(())
}

/// Which surfaces make closed convex bodies, where something can hide anything.
fn recognised(scene: &Scene, solids: &Solids) -> Option<Need> {
    let bodies = solids.surfaces().map(|surfaces| {
        let own = |body: &&Body| body.surfaces == surfaces;
        match scene.bodies.iter().find(own) {
            Some(body) => format!("`{}`", body.name),
            None => {
                let names = surfaces.iter().map(|&index| &scene.surfaces[index].name);
                let names: Vec<_> = names.map(|name| format!("`{name}`")).collect();
                format!("the loose {}", names.join(", "))
            }
        }
    });
    let bodies: Vec<String> = bodies.collect();
    (!bodies.is_empty()).then(|| Need {
        what: "bodies".to_owned(),
        why: format!(
            "{}: closed and convex, one silhouette each",
            bodies.join("; ")
        ),
    })
}

/// Why reflected light needs patches with linear radiosity, where it does.
fn linear(scene: &Scene, needs: &Requirements, rungs: &RungArguments) -> Option<Need> {
    let choices = choice::choices(rungs, scene, needs).ok()?;
    if choices.emitters != Emitters::Linear || needs.reflectors.is_empty() {
        return None;
    }
    let why = if needs.visibility.is_some() {
        "shadows follow no isolux outline"
    } else if needs.reflectors.len() > choice::OPEN {
        "light goes to and fro between more than two reflecting surfaces"
    } else {
        "asked for by `emitters`"
    };
    Some(Need {
        what: "linear emitters".to_owned(),
        why: why.to_owned(),
    })
}

fn in_words(checked: &Checked) -> String {
    let count =
        |n: usize, one: &str, many: &str| format!("{n} {}", if n == 1 { one } else { many });
    let mut text = format!(
        "scene `{}` is sound: {}, {}, {}, {}\n",
        checked.scene,
        count(checked.surfaces, "surface", "surfaces"),
        count(checked.emitters, "luminaire", "luminaires"),
        count(checked.bodies, "body", "bodies"),
        count(checked.channels, "channel", "channels"),
    );
    text.push_str("it requires\n");
    for need in &checked.requires {
        text.push_str(&format!("  {}: {}\n", need.what, need.why));
    }
    if let (Some(capacities), Some(ram), Some(flash)) =
        (&checked.capacities, checked.ram_bytes, checked.flash_bytes)
    {
        text.push_str(&format!(
            "a firmware needs\n  room for {} samples and {} emitters: {ram} bytes of RAM\n  \
             tables of {} loops with {} vertices: {flash} bytes of flash\n",
            capacities.samples, capacities.emitters, capacities.loops, capacities.vertices,
        ));
        let Workspace {
            vertices,
            pieces,
            lines,
            blockers,
        } = capacities.sight;
        if vertices > 0 {
            text.push_str(&format!(
                "  of the RAM a workspace for {} occluders: Exact<{vertices}, {pieces}, {lines}, {blockers}>\n",
                capacities.occluders,
            ));
        }
    }
    if let Some(lacking) = &checked.lacking {
        text.push_str(&format!("it cannot be planned by this build: {lacking}\n"));
    }
    text
}
