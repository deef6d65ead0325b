//! `isolux check`: is the scene sound, and what does it require?

use super::failure::Failure;
use super::pipeline;
use super::{SceneArgument, choice::RungArguments};
use crate::scene::requires::{Need, requirements};
use clap::Args;
use serde::Serialize;
use std::io::Write;

/// Validates a scene and says what it requires and why: what must be modelled,
/// how many samples and emitters a firmware must hold, how many bytes that is.
#[derive(Debug, Args)]
pub(super) struct Arguments {
    #[command(flatten)]
    scene: SceneArgument,
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
}

pub(super) fn run(arguments: &Arguments, json: bool) -> Result<(), Failure> {
    let scene = pipeline::read(&arguments.scene.scene)?;
    let needs = requirements(&scene);
    let mut checked = Checked {
        surfaces: scene.surfaces.len(),
        emitters: needs.luminaires.len(),
        bodies: scene.bodies.len(),
        channels: needs.channels,
        requires: needs.needs(&scene),
        capacities: None,
        ram_bytes: None,
        flash_bytes: None,
        lacking: None,
        scene: scene.name.clone(),
    };
    // What this build lacks or a budget forbids is an answer here, no failure.
    match pipeline::plan(scene, &arguments.rungs, &[]) {
        Ok(planned) => {
            let counts = &planned.tables.counts;
            checked.capacities = Some(Capacities {
                samples: counts.samples as usize,
                emitters: counts.emitters as usize,
                loops: counts.loops as usize,
                vertices: counts.vertices as usize,
            });
            checked.ram_bytes = Some(isolux::budget::light_bytes(counts));
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
    }
    if let Some(lacking) = &checked.lacking {
        text.push_str(&format!("it cannot be planned by this build: {lacking}\n"));
    }
    text
}
