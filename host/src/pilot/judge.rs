//! What a plan errs by, found out before it is given away.
//!
//! The same room in many more patches than a plan can afford is solved once on the
//! host. It tells the plan's reconstruction what the plan's own patches miss of
//! reflected light, and the plan what it errs by in the end.

use super::{Error, UNSHOT, receivers};
use crate::bake::{self, Tables};
use crate::occlusion::Occlusion;
use crate::plan::fields::counted;
use crate::plan::room::{Known, Places};
use crate::plan::shadow::Floor;
use crate::plan::{Part, Plan, Predicted, PredictedAt, Seen, SurfacePlan, Tag};
use crate::scene::{Scene, Surface};
use crate::solve::{self, Rung, Sight, Solution};
use glam::DVec3;
use isolux::shoot::Stop;

/// Places of a surface at which a plan is tried.
const PLACES: usize = 256;

/// Light below this part of a surface's brightest place counts as that much.
const DARK: f64 = 1e-3;

/// What a surface is said to err by, as a multiple of what it errs by at the places:
/// between them it may be more.
const SAFE: f64 = 2.5;

/// What the judge itself is taken to miss, of reflected light.
const MISSED: f64 = 0.01;

/// The part of a luminaire that is nothing in single precision.
const NOTHING: f32 = 1e-5;

/// Reflected light as many patches know it.
pub(super) struct Judge<'t> {
    light: Solution<'t>,
    sight: Sight,
    luminaires: usize,
    emitters: usize,
}

/// The tables of a judge.
pub(super) fn tables(
    scene: &Scene,
    fine: &Plan,
    occlusion: Option<&Occlusion>,
) -> Result<Tables, Error> {
    bake::bake(scene, fine, occlusion.cloned()).map_err(Error::TooLarge)
}

impl<'t> Judge<'t> {
    /// Lit until `stop`, which is to let every patch shoot in turn ([`super::in_turn`]).
    pub(super) fn of(tables: &'t Tables, sight: Sight, stop: Stop) -> Result<Self, Error> {
        let solved = solve::solve(tables, Rung::default(), sight, stop);
        Ok(Self {
            light: solved.map_err(Error::Kernel)?,
            sight,
            luminaires: tables.counts.luminaires as usize,
            emitters: tables.counts.emitters as usize,
        })
    }

    /// Irradiance from all that reflects; 0 at what is no place.
    pub(super) fn reflected(&self, places: &Places) -> Vec<f64> {
        let emitters = self.luminaires..self.emitters;
        let terms = self.light.terms(&receivers(places), emitters, self.sight);
        let sum = |terms: &Vec<f32>| terms.iter().map(|&term| f64::from(term)).sum();
        terms.map_or(vec![0.0; places.len()], |terms| {
            terms.iter().map(sum).collect()
        })
    }
}

/// Tries a plan whose tables are these on the host, and says what every surface errs by:
/// by tag as it was found, and its parts in the proportion that they were predicted in.
pub(super) fn tried(
    scene: &Scene,
    plan: &mut Plan,
    tables: &Tables,
    sight: Sight,
    known: &Known<'_>,
) -> Result<(), Error> {
    let stop = Stop::below(UNSHOT);
    let light = solve::solve(tables, Rung::default(), sight, stop).map_err(Error::Kernel)?;
    for (index, surface) in scene.surfaces.iter().enumerate() {
        let planned = &mut plan.surfaces[index];
        if planned.fields.is_empty() {
            continue;
        }
        let floor = Floor::of(scene, index).map_err(|error| Error::Room(error.into()))?;
        if let Some(by_tag) = errors(&light, (index, surface.area), &floor, known) {
            planned.predicted_by_tag = by_tag;
            said(planned, surface);
        }
    }
    Ok(())
}

/// What a surface may err by at its places, by their tags; `None` where it is dark.
fn errors(
    light: &Solution<'_>,
    (index, area): (usize, f64),
    floor: &Floor,
    known: &Known<'_>,
) -> Option<Vec<PredictedAt>> {
    let frame = &floor.frame;
    let places = spread(floor);
    let in_space: Vec<(DVec3, DVec3)> = places
        .iter()
        .map(|&[u, v]| (frame.to_world(u, v), frame.normal))
        .collect();
    let reflected = (known.settled)(&in_space);
    let direct = (known.direct)(&in_space);
    let whole = (known.unshadowed)(&in_space);
    let truth: Vec<f64> = (reflected.iter().zip(&direct))
        .map(|(reflected, direct)| reflected + direct.iter().map(|&x| f64::from(x)).sum::<f64>())
        .collect();
    let brightest = truth.iter().copied().fold(0.0, f64::max);
    let mut found = Vec::with_capacity(places.len());
    for (k, (&place, &(at, normal))) in places.iter().zip(&in_space).enumerate() {
        let value = light.resampled(index, place.map(|x| x as f32)).ok()??;
        let value = value.into_iter().map(f64::from).sum::<f64>() / 3.0;
        let scale = truth[k].max(DARK * brightest);
        let missed = MISSED * reflected[k] / scale;
        let square = SAFE * SAFE * counted((value - truth[k]) / scale) + missed * missed;
        let tag = Tag::of_place(floor.is_at_foot(place.into()), seen(&direct[k], &whole[k]));
        found.push((tag, square, (known.importance)(at, normal)));
    }
    let by_tag = PredictedAt::by_tag(area, &found);
    (brightest > 0.0 && !by_tag.is_empty()).then_some(by_tag)
}

/// How the luminaires are seen that a place faces, of which so much arrives and so much
/// would if nothing hid them.
fn seen<'a>(direct: &'a [f32], whole: &'a [f32]) -> impl Iterator<Item = Seen> + 'a {
    let faced = direct.iter().zip(whole).filter(|(_, whole)| **whole > 0.0);
    faced.map(|(direct, whole)| match direct / whole {
        part if part >= 1.0 - NOTHING => Seen::Wholly,
        part if part <= NOTHING => Seen::Hidden,
        _ => Seen::Partly,
    })
}

/// Places all over what nothing covers of a surface, evenly: the additive sequence of the plastic number, the
/// real root of x³ = x + 1 (M. Roberts 2018).
fn spread(floor: &Floor) -> Vec<[f64; 2]> {
    const PLASTIC: f64 = 1.324_717_957_244_746;
    let frame = &floor.frame;
    let steps = [1.0 / PLASTIC, 1.0 / (PLASTIC * PLASTIC)];
    let place = |k: usize| {
        let [a, b] = steps.map(|step| (0.5 + k as f64 * step).fract());
        [a * frame.size_u, b * frame.size_v]
    };
    // What is free fills more than a hundredth of the rectangle, or hardly counts.
    let all = (0..100 * PLACES).map(place);
    all.filter(|&place| floor.is_exposed(place.into()))
        .take(PLACES)
        .collect()
}

/// Makes the parts of a surface's prediction together what its tags are.
fn said(planned: &mut SurfacePlan, surface: &Surface) {
    let by_tag = planned.predicted_by_tag.iter();
    let loss: f64 = by_tag.map(|at| at.rms * at.rms * at.area).sum();
    let rms = (loss / surface.area).sqrt();
    match planned.predicted_error(surface.area) {
        Some(before) if before > 0.0 => {
            for part in &mut planned.predicted {
                part.rms *= rms / before;
            }
        }
        _ => {
            planned.predicted = vec![Predicted {
                part: Part::All,
                rms,
                area: surface.area,
            }];
        }
    }
}
