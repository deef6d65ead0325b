//! The samples of a surface in a plan file.

use super::super::{Receives, Sample, Tag};
use super::surfaces::place;
use crate::scene::diagnostic::{Diagnostic, nearest_name};
use crate::scene::document::{Field, Table, listed};
use crate::scene::frame::Frame;

/// The samples of a surface, and where each stands in the file.
pub(super) struct Samples<'d> {
    pub(super) all: Vec<Sample>,
    lines: Vec<Field<'d>>,
}

/// The order of samples by what they receive; all light goes with nothing else.
fn rank(tag: Tag) -> Option<usize> {
    match tag.receives() {
        Receives::All => None,
        Receives::Unshadowed => Some(0),
        Receives::Direct => Some(1),
        Receives::Reflected => Some(2),
    }
}

impl<'d> Samples<'d> {
    pub(super) fn read(table: &Table<'d>, frame: &Frame) -> Result<Self, Diagnostic> {
        let example = "`[0.5, 1.25, \"grid\"]`";
        let lines = match table.optional("samples") {
            Some(field) => field.elements("a list of samples", example)?,
            None => Vec::new(),
        };
        let mut all: Vec<Sample> = Vec::with_capacity(lines.len());
        for line in &lines {
            let sample = sample(line, frame, example)?;
            if let Some(before) = all.last() {
                let (before, now) = (rank(before.tag), rank(sample.tag));
                if before.is_some() != now.is_some() || before > now {
                    return Err(line.error(
                        format!("a sample tagged \"{}\" cannot stand here", sample.tag.name()),
                        "samples of unshadowed light come first, then of direct, then of reflected light; those of all light stand alone",
                    ));
                }
            }
            all.push(sample);
        }
        Ok(Self { all, lines })
    }

    /// A fault of one sample.
    pub(super) fn error(&self, sample: usize, message: String, remedy: &str) -> Option<Diagnostic> {
        let line = self.lines.get(sample);
        line.map(|line| line.error(message, remedy))
    }
}

fn sample(line: &Field<'_>, frame: &Frame, example: &str) -> Result<Sample, Diagnostic> {
    let parts = line.elements("a sample [u, v, tag]", example)?;
    let (u, v, name, vertex) = match parts.as_slice() {
        [u, v, name] => (u, v, name, None),
        [u, v, name, vertex_u, vertex_v] => (u, v, name, Some([vertex_u, vertex_v])),
        _ => {
            return Err(line.error(
                format!("a sample is [u, v, tag], or [u, v, tag, u, v] with its vertex; this has {} parts", parts.len()),
                format!("write it like {example}"),
            ));
        }
    };
    let place_of_sample = place(u, v, frame)?;
    let text = name.string(example)?;
    let tag = Tag::named(text).ok_or_else(|| {
        let known = Tag::ALL.map(Tag::name);
        let guess = nearest_name(text, known)
            .map_or(String::new(), |near| format!("did you mean `{near}`? "));
        name.error(
            format!("unknown tag `{text}`"),
            format!("{guess}the tags are {}", listed(&known)),
        )
    })?;
    Ok(Sample {
        place: place_of_sample,
        vertex: match vertex {
            Some([u, v]) => place(u, v, frame)?,
            None => place_of_sample,
        },
        tag,
    })
}
