//! `isolux form-factor`: JSON lines in, JSON lines out.

use super::choice;
use super::failure::Failure;
use crate::reference;
use crate::scene::diagnostic::Diagnostic;
use crate::solve::{FormFactorRung, fixed_form_factor};
use clap::Args;
use glam::DVec3;
use isolux::form_factor::fixed_point::{Q24, Q29};
use rayon::prelude::*;
use serde::{Deserialize, Serialize};
use serde_json::value::RawValue;
use std::io::{Read, Write};

/// Reads lines `{"id","p":[3],"n":[3],"v":[[3],..]}` on stdin: a receiver at p
/// facing along n, and a polygon of 3 to 32 vertices, counter-clockwise seen
/// from its emitting side. Writes lines `{"id","F"}` in the same order.
#[derive(Debug, Args)]
pub(super) struct Arguments {
    /// Number type and edge term: libm, micromath, poly3, poly5, poly8, best,
    /// q24, q29.
    #[arg(long, value_name = "RUNG", conflicts_with = "reference")]
    arithmetic: Option<String>,
    /// Answer from the f64 reference.
    #[arg(long)]
    reference: bool,
}

/// The most vertices of a polygon.
const MOST_VERTICES: usize = 32;

/// The fewest.
const LEAST_VERTICES: usize = 3;

#[derive(Deserialize)]
struct Question {
    /// Kept as the text it is: digits and escapes come back as given.
    id: Box<RawValue>,
    p: [f64; 3],
    n: [f64; 3],
    v: Vec<[f64; 3]>,
}

#[derive(Serialize)]
struct Answer<F> {
    id: Box<RawValue>,
    #[serde(rename = "F")]
    form_factor: F,
}

/// A rung's answer, printed with the digits it has.
#[derive(Serialize)]
#[serde(untagged)]
enum Kernel {
    Single(f32),
    Fixed(f64),
}

pub(super) fn run(arguments: &Arguments, json: bool) -> Result<(), Failure> {
    let rung = choice::arithmetic(arguments.arithmetic.as_deref())?;
    let mut bytes = Vec::new();
    let whole = |error: std::io::Error| Diagnostic::of_file("stdin", error.to_string(), "");
    std::io::stdin().read_to_end(&mut bytes).map_err(whole)?;
    let text = String::from_utf8(bytes).map_err(|error| {
        let line = 1 + error.as_bytes()[..error.utf8_error().valid_up_to()]
            .iter()
            .filter(|&&byte| byte == b'\n')
            .count();
        Diagnostic::of_file(
            "stdin",
            format!("line {line} is not UTF-8"),
            "JSON is UTF-8",
        )
    })?;
    // Everything is answered before anything is written: a bad line leaves no
    // half of an answer behind.
    let lines: Vec<&str> = text.lines().collect();
    let answers = lines
        .par_iter()
        .enumerate()
        .filter(|(_, line)| !line.trim().is_empty())
        .map(|(index, line)| {
            let question = parse(index + 1, line)?;
            answer(question, rung, arguments.reference)
                .map_err(|message| bad(index + 1, line, 0, &message))
        })
        .collect::<Result<Vec<String>, Diagnostic>>()?;
    let mut out = std::io::stdout().lock();
    if json {
        writeln!(out, "[{}]", answers.join(","))?;
    } else {
        for answer in answers {
            writeln!(out, "{answer}")?;
        }
    }
    Ok(())
}

fn bad(number: usize, line: &str, column: usize, message: &str) -> Diagnostic {
    let start = column.saturating_sub(1);
    Diagnostic::in_line(
        "stdin",
        number,
        line,
        start..line.len(),
        format!("line {number}: {message}"),
        r#"a line is {"id":..,"p":[x,y,z],"n":[x,y,z],"v":[[x,y,z],..]} with 3 to 32 vertices"#,
    )
}

fn parse(number: usize, line: &str) -> Result<Question, Diagnostic> {
    let question: Question = serde_json::from_str(line).map_err(|error| {
        let text = error.to_string();
        // serde_json counts lines of its own, of which there is one.
        let message = text.split(" at line ").next().unwrap_or(&text);
        bad(number, line, error.column(), message)
    })?;
    let vertices = question.v.len();
    if !(LEAST_VERTICES..=MOST_VERTICES).contains(&vertices) {
        return Err(bad(
            number,
            line,
            0,
            &format!("a polygon of {vertices} vertices"),
        ));
    }
    Ok(question)
}

fn answer(question: Question, rung: FormFactorRung, reference: bool) -> Result<String, String> {
    let single = |v: [f64; 3]| v.map(|x| x as f32);
    let Question { id, p, n, v } = question;
    // Both judges refuse the same input.
    let vertices: Vec<[f32; 3]> = v.iter().map(|&v| single(v)).collect();
    if vertices
        .iter()
        .flatten()
        .chain(&single(p))
        .any(|x| !x.is_finite())
    {
        return Err("a coordinate is too large for single precision".into());
    }
    let (p32, n32) = (single(p), single(n));
    let kernel = match rung {
        FormFactorRung::Float(rung) => rung.form_factor(p32, n32, &vertices).map(Kernel::Single),
        FormFactorRung::Q24 => {
            fixed_form_factor::<Q24>(p32, n32, &vertices).map(|f| Kernel::Fixed(f.into()))
        }
        FormFactorRung::Q29 => {
            fixed_form_factor::<Q29>(p32, n32, &vertices).map(|f| Kernel::Fixed(f.into()))
        }
    };
    let kernel = kernel.map_err(|e| e.to_string())?;
    let line = if reference {
        let polygon: Vec<DVec3> = v.into_iter().map(DVec3::from).collect();
        let form_factor = reference::form_factor(p.into(), n.into(), &polygon);
        serde_json::to_string(&Answer { id, form_factor })
    } else {
        serde_json::to_string(&Answer {
            id,
            form_factor: kernel,
        })
    };
    line.map_err(|error| error.to_string())
}
