//! `isolux solve`: irradiance at points.

use super::choice::RungArguments;
use super::failure::Failure;
use super::pipeline::{self, Planned};
use super::{BouncesArgument, PlanArgument, SceneArgument};
use crate::compare::{self, Balance};
use crate::reference::Reference;
use crate::report;
use crate::scene::Scene;
use crate::scene::diagnostic::Diagnostic;
use crate::scene::points::{self, SensorPoint};
use crate::scene::requires::requirements;
use crate::solve::{At, Solution};
use clap::Args;
use serde::Serialize;
use std::collections::BTreeMap;
use std::io::Write;
use std::path::PathBuf;

/// Prints the irradiance at points as CSV: `x,y,z,nx,ny,nz,E`, in W/m² (lx in a
/// photometric scene), or `E_r,E_g,E_b` where the scene has colour, rows in the
/// order of the points.
///
/// The kernel evaluates every point from the emitters, without resampling.
#[derive(Debug, Args)]
pub(super) struct Arguments {
    #[command(flatten)]
    scene: SceneArgument,
    /// Sensor points, `x y z nx ny nz` a line. Default: the scene's named points.
    #[arg(long, value_name = "FILE.pts")]
    points: Option<PathBuf>,
    #[command(flatten)]
    bounces: BouncesArgument,
    /// Answer from the f64 reference.
    #[arg(long, conflicts_with_all = ["reconstructed", "plan"])]
    reference: bool,
    /// Answer from the planned samples: points must lie on planned surfaces.
    #[arg(long)]
    reconstructed: bool,
    #[command(flatten)]
    plan: PlanArgument,
    #[command(flatten)]
    rungs: RungArguments,
}

#[derive(Serialize)]
struct Solved<'a> {
    scene: &'a str,
    unit: &'static str,
    method: &'static str,
    bounces: Option<u32>,
    /// Points at which visibility met a bound of the workspace.
    #[serde(skip_serializing_if = "Option::is_none")]
    inexact: Option<usize>,
    /// Where the light went that the kernel shot.
    #[serde(skip_serializing_if = "Option::is_none")]
    balance: Option<Balance>,
    points: Vec<Answer>,
}

#[derive(Serialize)]
struct Answer {
    #[serde(skip_serializing_if = "Option::is_none")]
    name: Option<String>,
    position: [f64; 3],
    normal: [f64; 3],
    /// `E`, or `E_r`, `E_g`, `E_b`.
    #[serde(flatten)]
    irradiance: BTreeMap<&'static str, Value>,
}

/// What irradiance is called in one channel and in three.
const GREY: [&str; 1] = ["E"];
const COLOUR: [&str; 3] = ["E_r", "E_g", "E_b"];

/// A number in the digits of its own precision.
#[derive(Clone, Copy, Serialize)]
#[serde(untagged)]
enum Value {
    Single(f32),
    Double(f64),
}

impl std::fmt::Display for Value {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Single(value) => value.fmt(f),
            Self::Double(value) => value.fmt(f),
        }
    }
}

/// A point that is asked for, with what is needed to complain about it.
struct Asked {
    name: Option<String>,
    point: SensorPoint,
}

/// What one of the methods found.
struct Answers {
    values: Vec<[Value; 3]>,
    inexact: Option<usize>,
    balance: Option<Balance>,
}

impl Answers {
    fn of(values: Vec<[Value; 3]>) -> Self {
        Self {
            values,
            inexact: None,
            balance: None,
        }
    }
}

pub(super) fn run(arguments: &Arguments, json: bool) -> Result<(), Failure> {
    let scene = pipeline::read(&arguments.scene.scene)?;
    let unit = scene.quantity.irradiance_unit();
    let asked = asked(arguments, &scene)?;
    let bounces = arguments.bounces.bounces;
    let name = scene.name.clone();
    let columns: &[&str] = match requirements(&scene).channels {
        1 => &GREY,
        _ => &COLOUR,
    };
    let places: Vec<glam::DVec3> = asked.iter().map(|a| a.point.position).collect();
    let answers = if arguments.reference {
        super::choice::choices(&arguments.rungs, &scene, &requirements(&scene))?;
        referred(
            &pipeline::judge(&scene, pipeline::same_light(bounces))?,
            &asked,
        )
    } else {
        let rungs = RungArguments {
            at_points: !arguments.reconstructed,
            ..arguments.rungs.clone()
        };
        let planned =
            pipeline::plan_or_read(scene, &rungs, arguments.plan.plan.as_deref(), &places)?;
        let solution = planned.solve(bounces)?;
        let mut answers = if arguments.reconstructed {
            reconstructed(&planned, &solution, &asked, arguments)?
        } else {
            evaluated(&solution, &asked)?
        };
        if json {
            let balance = compare::balance(&planned.scene, &planned.plan, &solution);
            answers.balance = Some(balance);
        }
        answers
    };
    let Answers {
        values,
        inexact,
        balance,
    } = answers;
    let method = match (arguments.reference, arguments.reconstructed) {
        (true, _) => "reference",
        (_, true) => "reconstructed",
        _ => "evaluated",
    };
    let mut out = std::io::stdout().lock();
    if json {
        let points = asked.into_iter().zip(values);
        let points = points.map(|(asked, value)| answer(asked, columns, value));
        let points = points.collect();
        let solved = Solved {
            scene: &name,
            unit,
            method,
            bounces,
            inexact,
            balance,
            points,
        };
        serde_json::to_writer(&mut out, &solved).map_err(std::io::Error::from)?;
        writeln!(out)?;
    } else {
        writeln!(out, "x,y,z,nx,ny,nz,{}", columns.join(","))?;
        for (asked, values) in asked.iter().zip(values) {
            let [x, y, z, nx, ny, nz] = asked.point.given;
            write!(out, "{x},{y},{z},{nx},{ny},{nz}")?;
            for value in &values[..columns.len()] {
                write!(out, ",{value}")?;
            }
            writeln!(out)?;
        }
    }
    out.flush()?;
    Ok(())
}

fn answer(asked: Asked, columns: &[&'static str], values: [Value; 3]) -> Answer {
    let [x, y, z, nx, ny, nz] = asked.point.given;
    Answer {
        name: asked.name,
        position: [x, y, z],
        normal: [nx, ny, nz],
        irradiance: columns.iter().copied().zip(values).collect(),
    }
}

fn asked(arguments: &Arguments, scene: &Scene) -> Result<Vec<Asked>, Failure> {
    if let Some(path) = &arguments.points {
        let points = points::read_points(path)?;
        return Ok(points
            .into_iter()
            .map(|point| Asked { name: None, point })
            .collect());
    }
    if scene.points.is_empty() {
        return Err(Failure::usage(
            format!("scene `{}` names no points", scene.name),
            "give points with --points FILE.pts, `x y z nx ny nz` a line",
        ));
    }
    let named = scene.points.iter().map(|point| {
        let ([x, y, z], [nx, ny, nz]) = (point.position.to_array(), point.normal.to_array());
        let given = [x, y, z, nx, ny, nz];
        let (position, normal) = (point.position, point.normal);
        Asked {
            name: Some(point.name.clone()),
            point: SensorPoint {
                position,
                normal,
                given,
                line: 0,
            },
        }
    });
    Ok(named.collect())
}

fn referred(reference: &Reference, asked: &[Asked]) -> Answers {
    let places: Vec<_> = asked
        .iter()
        .map(|asked| (asked.point.position, asked.point.normal))
        .collect();
    let values = reference.light_at(&places).into_iter();
    Answers::of(values.map(|value| value.map(Value::Double)).collect())
}

fn evaluated(solution: &Solution<'_>, asked: &[Asked]) -> Result<Answers, Failure> {
    let receivers: Vec<_> = asked
        .iter()
        .map(|asked| {
            let single = |v: glam::DVec3| v.as_vec3().to_array();
            (single(asked.point.position), single(asked.point.normal))
        })
        .collect();
    let values = solution
        .at(&receivers)
        .map_err(|error| Failure::usage(error, ""))?;
    let inexact = values.iter().filter(|at| !at.is_exact).count();
    if inexact > 0 {
        report::warn(&format!(
            "at {inexact} of {} points visibility met a bound of the workspace: the middle of what is possible is given",
            values.len()
        ));
    }
    let single = |at: At| at.value.map(Value::Single);
    Ok(Answers {
        inexact: Some(inexact),
        ..Answers::of(values.into_iter().map(single).collect())
    })
}

/// How far a normal may lean from its surface's: 0.1°.
const SAME_NORMAL: f64 = 0.999_998;

fn reconstructed(
    planned: &Planned,
    solution: &Solution<'_>,
    asked: &[Asked],
    arguments: &Arguments,
) -> Result<Answers, Failure> {
    let tolerance = planned.scene.plane_tolerance();
    let one = |asked: &Asked| {
        let point = &asked.point;
        let on = |(index, surface): (usize, &crate::plan::SurfacePlan)| {
            let frame = &surface.frame;
            let (u, v) = frame.to_local(point.position);
            let height = (point.position - frame.origin).dot(frame.normal).abs();
            let here = !surface.samples.is_empty()
                && height <= tolerance
                && point.normal.dot(frame.normal) >= SAME_NORMAL
                && frame.contains(u, v);
            here.then_some((index, [u as f32, v as f32]))
        };
        let found = planned.plan.surfaces.iter().enumerate().find_map(on);
        let value =
            found.and_then(|(index, place)| solution.resampled(index, place).ok().flatten());
        value
            .map(|values| values.map(Value::Single))
            .ok_or_else(|| off_surface(asked, arguments))
    };
    let values: Result<_, Failure> = asked.iter().map(one).collect();
    values.map(Answers::of)
}

fn off_surface(asked: &Asked, arguments: &Arguments) -> Failure {
    let message = "the point lies on no surface that has samples, or faces another way";
    let remedy = "leave out --reconstructed to evaluate any point in space";
    match (&arguments.points, &asked.name) {
        (Some(path), _) => {
            let line = asked.point.given.map(|x| x.to_string()).join(" ");
            let whole = 0..line.len();
            let file = path.display().to_string();
            Diagnostic::in_line(&file, asked.point.line, &line, whole, message, remedy).into()
        }
        (None, name) => Failure::usage(
            format!("point `{}`: {message}", name.as_deref().unwrap_or_default()),
            remedy,
        ),
    }
}
