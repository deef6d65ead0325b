//! The secondary emitters of a surface in a plan file.

use super::super::patches::Patch;
use super::super::patches::shapes::{is_convex, own_frame, signed_area};
use super::super::{Band, Point};
use super::samples::Samples;
use super::surfaces::{index, indices, place, within};
use crate::scene::diagnostic::Diagnostic;
use crate::scene::document::{Field, Table};
use crate::scene::frame::Frame;

/// The largest weight that tables hold.
const HEAVIEST: f64 = 64.0;

/// What the emitters of a plan are made of: tables hold one kind.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Kind {
    /// Plain means: bands and points.
    Plain,
    /// Bands with weights.
    Weighted,
    /// Patches.
    Linear,
}

/// The emitters of one surface.
pub(super) struct Emitters {
    pub(super) bands: Vec<Band>,
    pub(super) patches: Vec<Patch>,
    pub(super) points: Vec<Point>,
}

pub(super) fn read(
    table: &Table<'_>,
    samples: &Samples<'_>,
    area: f64,
    frame: &Frame,
    kind: &mut Option<Kind>,
) -> Result<Emitters, Diagnostic> {
    let of = Surface {
        samples: samples.all.len(),
        area,
        frame,
    };
    let mut emitters = Emitters {
        bands: Vec::new(),
        patches: Vec::new(),
        points: Vec::new(),
    };
    if let Some(field) = table.optional("points") {
        for line in field.elements("a list of points", POINT)? {
            emitters.points.push(of.point(&line)?);
            agrees(&line, Kind::Plain, kind)?;
        }
    }
    if let Some(field) = table.optional("band") {
        for (band, line) in field
            .tables("a band")?
            .iter()
            .zip(field.elements("bands", "")?)
        {
            let band = of.band(band)?;
            let its = match band.weights.is_empty() {
                true => Kind::Plain,
                false => Kind::Weighted,
            };
            if !band.members.is_empty() {
                agrees(&line, its, kind)?;
            }
            emitters.bands.push(band);
        }
    }
    if let Some(field) = table.optional("patch") {
        for (patch, line) in field
            .tables("a patch")?
            .iter()
            .zip(field.elements("patches", "")?)
        {
            emitters.patches.push(of.patch(patch)?);
            agrees(&line, Kind::Linear, kind)?;
        }
    }
    Ok(emitters)
}

/// Refuses an emitter of another kind than those before it.
fn agrees(field: &Field<'_>, its: Kind, kind: &mut Option<Kind>) -> Result<(), Diagnostic> {
    match kind.replace(its) {
        Some(before) if before != its => Err(field.error(
            "this emitter is of another kind than those before it",
            "a plan has points and bands without weights, or bands with weights, or patches",
        )),
        _ => Ok(()),
    }
}

const POINT: &str = "`[0, 0.52]`";
const MEMBER: &str = "`[0, 0.25, -0.5, 0.5]`";
const PIECES: &str = "`pieces = [[[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]]]`";

/// What the emitters of a surface are checked against.
struct Surface<'a> {
    samples: usize,
    area: f64,
    frame: &'a Frame,
}

impl Surface<'_> {
    fn index(&self, field: &Field<'_>) -> Result<usize, Diagnostic> {
        index(field, self.samples, "samples of this surface")
    }

    /// An area no larger than the surface.
    fn area(&self, field: &Field<'_>, least: f64, example: &str) -> Result<f64, Diagnostic> {
        within(field, least..=self.area * (1.0 + 1e-6), example)
    }

    fn point(&self, line: &Field<'_>) -> Result<Point, Diagnostic> {
        let parts = line.elements("a point [sample, area]", POINT)?;
        let [sample, area] = parts.as_slice() else {
            return Err(line.error(
                "a point is [sample, area]",
                format!("write it like {POINT}"),
            ));
        };
        Ok(Point {
            sample: self.index(sample)?,
            area: self.area(area, 0.0, POINT)?,
        })
    }

    fn band(&self, table: &Table<'_>) -> Result<Band, Diagnostic> {
        let table = table.only(&["area", "loops", "members", "weights"])?;
        let area = table.required("area", "area = 2.5")?;
        // What lies between two outlines may be nothing, up to rounding.
        let area = self.area(&area, -1e-6 * self.area, "`area = 2.5`")?;
        let mut loops = Vec::new();
        let field = table.required("loops", "loops = [[0, 1, 2]]")?;
        for line in field.elements("a list of loops", "`loops = [[0, 1, 2]]`")? {
            let outline = indices(&line, self.samples, "samples of this surface")?;
            if outline.len() < 3 {
                return Err(line.error(
                    "a loop has at least three vertices",
                    "write it like `[0, 1, 2]`",
                ));
            }
            loops.push(outline);
        }
        let members = table.required("members", "members = [0, 1, 2]")?;
        let members = indices(&members, self.samples, "samples of this surface")?;
        let mut weights = Vec::new();
        if let Some(field) = table.optional("weights") {
            for weight in field.elements("a list of weights", "`weights = [0.5, 0.5]`")? {
                weights.push(within(&weight, -HEAVIEST..=HEAVIEST, "`0.5`")?);
            }
            if weights.len() != members.len() {
                return Err(field.error(
                    format!("{} weights for {} members", weights.len(), members.len()),
                    "give one for each member, or leave out `weights`",
                ));
            }
        }
        Ok(Band {
            loops,
            members,
            weights,
            area,
        })
    }

    fn patch(&self, table: &Table<'_>) -> Result<Patch, Diagnostic> {
        let table = table.only(&["area", "pieces", "members"])?;
        let area = table.required("area", "area = 2.5")?;
        let area = self.area(&area, 0.0, "`area = 2.5`")?;
        let field = table.required("pieces", PIECES)?;
        let pieces = field.elements("a list of polygons", PIECES)?;
        let pieces: Vec<Vec<[f64; 2]>> = pieces
            .iter()
            .map(|line| self.piece(line))
            .collect::<Result<_, _>>()?;
        if pieces.is_empty() {
            return Err(field.error(
                "a patch has at least one piece",
                format!("write it like {PIECES}"),
            ));
        }
        let (center, scale) = own_frame(&pieces);
        let field = table.required("members", "members = [[0, 1.0, 0.0, 0.0]]")?;
        let mut members = Vec::new();
        for line in field.elements("a list of members", MEMBER)? {
            let parts = line.elements("a member [sample, mean, gradient, gradient]", MEMBER)?;
            let [sample, mean, along_u, along_v] = parts.as_slice() else {
                return Err(line.error(
                    "a member is [sample, weight of the mean, weights of both gradients]",
                    format!("write it like {MEMBER}"),
                ));
            };
            let weight = |field| within(field, -HEAVIEST..=HEAVIEST, MEMBER);
            let weights = [weight(mean)?, weight(along_u)?, weight(along_v)?];
            members.push((self.index(sample)?, weights));
        }
        Ok(Patch {
            pieces,
            center,
            scale,
            area,
            members,
        })
    }

    fn piece(&self, line: &Field<'_>) -> Result<Vec<[f64; 2]>, Diagnostic> {
        let corner = |field: &Field<'_>| {
            let parts = field.elements("a corner [u, v]", "`[0.0, 0.0]`")?;
            match parts.as_slice() {
                [u, v] => place(u, v, self.frame),
                _ => Err(field.error("a corner is [u, v]", "write it like `[0.0, 0.0]`")),
            }
        };
        let corners = line.elements("a polygon", PIECES)?;
        let corners: Vec<[f64; 2]> = corners.iter().map(corner).collect::<Result<_, _>>()?;
        if corners.len() < 3 || signed_area(&corners) <= 0.0 || !is_convex(&corners) {
            return Err(line.error(
                "a piece of a patch must be a convex polygon whose corners run counter-clockwise",
                "cut what is not convex into pieces; reverse what runs clockwise",
            ));
        }
        Ok(corners)
    }
}
