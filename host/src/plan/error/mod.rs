//! Error-driven placement: samples go where they lessen the error most.
//!
//! For every surface the planner tries many ways to reconstruct its irradiance,
//! measures each against the light it knows, and keeps those that no other beats
//! with as few samples. The budget then goes, a step at a time, to the surface whose
//! error weighs most: an error counts with the power that the surface receives.

mod few;
mod lit;
mod polish;
mod regions;
mod stand;

use super::fields::Field as Term;
use super::fields::tensor::{Nodes, Tensor};
use super::{
    Field, Part, Plan, Point, Predicted, PredictedAt, Sample, SurfacePlan, Tag, Unplannable,
    spacing,
};
use crate::scene::frame::Frame;
use crate::scene::{Budget, Scene};
use glam::DVec3;
use lit::Lit;
use stand::{grids_are_surfaces, points_are_far};
use std::f64::consts::PI;

/// Nodes along a side of a tensor grid.
const COUNTS: std::ops::RangeInclusive<usize> = 2..=12;

/// Places along each side of a surface at which a reconstruction is measured.
const MEASURED: usize = 28;

/// The largest relative error of a surface with which it needs no more samples
/// where the scene sets no budget.
const WELL: f64 = 0.005;

/// A relative error counts where there is more than this part of the surface's
/// largest irradiance.
const FAINT: f64 = 1e-3;

/// The largest relative error of what points light with which they stand for their
/// surface.
const GOOD: f64 = 0.003;

/// Surfaces up to which each of them is tried as what lights the others; in larger
/// scenes only luminaires are.
const FEW: usize = 4;

/// What is known of a way to reconstruct a surface.
#[derive(Clone, Debug)]
struct Candidate {
    tensor: Tensor,
    /// The largest relative error, and the largest that its points cause on what they
    /// light.
    error: f64,
    /// The same with what its points cause as a part of the surface's own power.
    loss: f64,
    /// The root of the mean square relative error over the surface.
    rms: f64,
    /// What its points cause, as a part of the surface's own power.
    caused: f64,
}

/// Plans a scene in which nothing hides anything from anything.
///
/// `total` gives the irradiance after all reflections. Samples are the nodes of
/// tensor grids ([`super::fields`]), and where they light every other surface to
/// within 0.3 %, and no named point or one of `places` is nearer to a surface than its
/// samples are to each other, they are also what shoots; else `None`: the scene wants
/// patches.
///
/// # Errors
/// [`Unplannable`] where the budget is too small, or too large for the tables.
pub fn error_driven(
    scene: &Scene,
    budget: &Budget,
    total: &Field<'_>,
    places: &[DVec3],
) -> Result<Option<Plan>, Unplannable> {
    let (plan, relative) = planned(scene, budget, total, |ladder| ladder.judge.power)?;
    let named = scene.points.iter().map(|point| point.position);
    let places: Vec<DVec3> = named.chain(places.iter().copied()).collect();
    let stand = grids_are_surfaces(scene, &plan) && points_are_far(scene, &plan, &places);
    Ok((relative <= GOOD && stand).then_some(plan))
}

/// Plans such a scene as [`error_driven`] does, with few of the samples as what shoots: as
/// many as light all other surfaces and the named points with twice the rms error that
/// these are reconstructed with, or 0.3 %, each for an area that is fitted to what arrives there.
///
/// The budget is divided by errors as the predicted error counts them, by area and not by
/// power: what shoots is few, and a sample more is dear on any surface. Areas of points are
/// those of the light that `total` gives, and of surfaces and named points alone:
/// what is elsewhere may be lit less well. `None` where no areas suffice.
///
/// # Errors
/// As [`error_driven`].
pub fn error_driven_with_few_points(
    scene: &Scene,
    budget: &Budget,
    total: &Field<'_>,
) -> Result<Option<Plan>, Unplannable> {
    let (mut plan, _) = planned(scene, budget, total, |ladder| ladder.area)?;
    let suffice = grids_are_surfaces(scene, &plan) && few::shoot(scene, &mut plan, total);
    Ok(suffice.then_some(plan))
}

/// The plan whose samples all shoot, and the largest relative error that they cause
/// on what they light. An error counts as much as `counts` says of its surface.
fn planned(
    scene: &Scene,
    budget: &Budget,
    total: &Field<'_>,
    counts: fn(&Ladder<'_>) -> f64,
) -> Result<(Plan, f64), Unplannable> {
    let ladders: Vec<Option<Ladder<'_>>> = scene
        .surfaces
        .iter()
        .enumerate()
        .map(|(k, surface)| surface.reflects().then(|| Ladder::new(scene, k, total)))
        .collect();
    let chosen = divide(&ladders, budget, counts)?;
    let mut most = 0.0_f64;
    let surfaces: Vec<SurfacePlan> = (scene.surfaces.iter().zip(&ladders))
        .zip(&chosen)
        .map(|((surface, ladder), &step)| match ladder {
            Some(ladder) => {
                let (planned, relative) = ladder.plan(step);
                most = most.max(relative);
                planned
            }
            None => SurfacePlan::without_samples(Frame::new(surface)),
        })
        .collect();
    Ok((Plan::from(surfaces), most))
}

/// The candidates of one surface, the number of samples rising and the error
/// falling.
struct Ladder<'a> {
    judge: Judge<'a>,
    area: f64,
    steps: Vec<Candidate>,
}

/// What reconstructions of a surface are judged by.
struct Judge<'a> {
    frame: Frame,
    total: &'a Field<'a>,
    places: Vec<[f64; 2]>,
    truth: Vec<f64>,
    tags: Vec<Tag>,
    lit: Lit,
    /// Power received in W.
    power: f64,
}

impl<'a> Judge<'a> {
    fn new(scene: &Scene, index: usize, total: &'a Field<'a>) -> Self {
        let frame = Frame::new(&scene.surfaces[index]);
        let places = measured(&frame, MEASURED);
        let truth = at(&frame, &places, total);
        let mean = truth.iter().sum::<f64>() / truth.len().max(1) as f64;
        Self {
            lit: Lit::by(scene, index, &frame, total),
            power: (mean * scene.surfaces[index].area).max(f64::MIN_POSITIVE),
            tags: regions::tags(scene, index, &frame, &places),
            frame,
            total,
            places,
            truth,
        }
    }

    /// The candidates that these nodes make, with every factor that is a way; none where a
    /// node stands for less than nothing, as among many that are drawn together: nothing
    /// could shoot from there.
    fn candidates(&self, grid: &Tensor, factors: &[Option<[f64; 3]>]) -> Vec<Candidate> {
        if !grid.areas().iter().all(|&area| area > 0.0) {
            return Vec::new();
        }
        let values = at(&self.frame, &grid.places(), self.total);
        let caused = self.lit.error(&self.frame, grid, &values) / self.power;
        let relative = self.lit.relative(&self.frame, grid, &values);
        let candidate = |&factor: &Option<[f64; 3]>| {
            let tensor = Tensor {
                factor,
                ..grid.clone()
            };
            let (worst, rms) = summed(&misfits(&tensor, &values, &self.places, &self.truth)?);
            Some(Candidate {
                tensor,
                error: worst + relative,
                loss: worst + caused,
                rms,
                caused,
            })
        };
        factors.iter().filter_map(candidate).collect()
    }
}

impl<'a> Ladder<'a> {
    fn new(scene: &Scene, index: usize, total: &'a Field<'a>) -> Self {
        let judge = Judge::new(scene, index, total);
        let factors = factors(scene, index, &judge.frame);
        let mut all = Vec::new();
        for nodes in Nodes::ALL {
            for along_u in COUNTS {
                for along_v in COUNTS {
                    let grid = Tensor::over(&judge.frame, nodes, [along_u, along_v], None);
                    all.extend(judge.candidates(&grid, &factors));
                }
            }
        }
        all.sort_by(|a, b| {
            let samples = a.tensor.samples().cmp(&b.tensor.samples());
            samples.then(a.error.total_cmp(&b.error))
        });
        let mut steps: Vec<Candidate> = Vec::new();
        for candidate in all {
            if steps.last().is_none_or(|last| candidate.error < last.error) {
                steps.push(candidate);
            }
        }
        Self {
            area: scene.surfaces[index].area,
            judge,
            steps,
        }
    }

    /// What the places of each tag err by; what its points cause counts everywhere alike.
    fn by_tag(&self, candidate: &Candidate, values: &[f64]) -> Vec<PredictedAt> {
        let judge = &self.judge;
        let misfits = misfits(&candidate.tensor, values, &judge.places, &judge.truth);
        let misfits = misfits.unwrap_or_default().into_iter();
        let caused = candidate.caused * candidate.caused;
        let places = judge.tags.iter().zip(misfits);
        let places = places.map(|(&tag, (error, weight))| (tag, error * error + caused, weight));
        PredictedAt::by_tag(self.area, &places.collect::<Vec<_>>())
    }

    /// With this step of the ladder; and the largest relative error that its points
    /// cause on what they light.
    fn plan(&self, step: usize) -> (SurfacePlan, f64) {
        let frame = self.judge.frame.clone();
        let Some(candidate) = self.steps.get(step) else {
            return (SurfacePlan::without_samples(frame), 0.0);
        };
        let candidate = &self.judge.polished(candidate);
        let tensor = candidate.tensor.clone();
        let sample = |place| Sample {
            place,
            vertex: place,
            tag: Tag::Grid,
        };
        let areas = tensor.areas().into_iter().enumerate();
        let of_part = |(part, rms)| Predicted {
            part,
            rms,
            area: self.area,
        };
        let predicted = [(Part::All, candidate.rms), (Part::Points, candidate.caused)];
        let values = at(&self.judge.frame, &tensor.places(), self.judge.total);
        let relative = self.judge.lit.relative(&self.judge.frame, &tensor, &values);
        let planned = SurfacePlan {
            predicted: predicted.map(of_part).into(),
            predicted_by_tag: self.by_tag(candidate, &values),
            samples: tensor.places().into_iter().map(sample).collect(),
            points: areas.map(|(sample, area)| Point { sample, area }).collect(),
            filter_radius: spacing::filter_radius(self.area, tensor.samples()),
            fields: vec![Term {
                tensor: Some(tensor),
                mesh: None,
            }],
            ..SurfacePlan::without_samples(frame)
        };
        (planned, relative)
    }
}

/// Places at which a surface's reconstruction is measured: `side` x `side` over the
/// bounding rectangle, closer towards its edges, where polynomials err most.
pub(super) fn measured(frame: &Frame, side: usize) -> Vec<[f64; 2]> {
    let part = |k: usize| 0.5 - 0.5 * ((k as f64 + 0.25) / (side as f64 - 0.5) * PI).cos();
    (0..side * side)
        .map(|k| [part(k % side) * frame.size_u, part(k / side) * frame.size_v])
        .filter(|&[u, v]| frame.contains(u, v))
        .collect()
}

/// The field at places of a surface.
fn at(frame: &Frame, places: &[[f64; 2]], field: &Field<'_>) -> Vec<f64> {
    let receiver = |&[u, v]: &[f64; 2]| (frame.to_world(u, v), frame.normal);
    let receivers: Vec<(DVec3, DVec3)> = places.iter().map(receiver).collect();
    field(&receivers)
}

/// The relative error of a tensor grid through these values at each place, and what
/// the place counts for; `None` where there is no grid through them.
fn misfits(
    tensor: &Tensor,
    values: &[f64],
    places: &[[f64; 2]],
    truth: &[f64],
) -> Option<Vec<(f64, f64)>> {
    let through = tensor.through(values)?;
    let faint = FAINT * truth.iter().copied().fold(0.0, f64::max);
    let misfit = |(&place, &truth): (&[f64; 2], &f64)| {
        let error = (through.at(place) - truth).abs() / truth.max(faint).max(f64::MIN_POSITIVE);
        // Places are closer towards the edges: each stands for less there.
        let weights = [0, 1].map(|axis| {
            let t = (place[axis] - tensor.center[axis]) / tensor.half[axis];
            (1.0 - t * t).max(0.0).sqrt()
        });
        (error, weights.iter().product())
    };
    Some(places.iter().zip(truth).map(misfit).collect())
}

/// The largest of errors that count for so much each, and the root of their mean square.
fn summed(misfits: &[(f64, f64)]) -> (f64, f64) {
    let worst = misfits
        .iter()
        .fold(0.0, |worst, (error, _)| error.max(worst));
    let squares: f64 = misfits
        .iter()
        .map(|(error, weight)| weight * error * error)
        .sum();
    let weights: f64 = misfits.iter().map(|(_, weight)| weight).sum();
    (worst, (squares / weights.max(f64::MIN_POSITIVE)).sqrt())
}

/// What polynomials may be of: E itself, E^(−1/2), and √(s/E) with the s of everything
/// that a surface may be lit by, (d·n_r)(−d·n_s), d being the way to its centroid.
pub(super) fn factors(scene: &Scene, index: usize, frame: &Frame) -> Vec<Option<[f64; 3]>> {
    let mut all = vec![None, Some([1.0, 0.0, 0.0])];
    for (other, source) in scene.surfaces.iter().enumerate() {
        if other == index || !(source.emits() || source.reflects() && scene.surfaces.len() <= FEW) {
            continue;
        }
        let d = source.center() - frame.origin;
        let height = d.dot(frame.normal);
        let factor = [
            height * -d.dot(source.normal),
            height * frame.u.dot(source.normal),
            height * frame.v.dot(source.normal),
        ];
        let largest = factor.iter().fold(0.0_f64, |most, x| most.max(x.abs()));
        if height > 0.0 && largest > 0.0 {
            all.push(Some(factor.map(|x| x / largest)));
        }
    }
    all
}

/// Which candidate every surface takes.
fn divide(
    ladders: &[Option<Ladder<'_>>],
    budget: &Budget,
    counts: fn(&Ladder<'_>) -> f64,
) -> Result<Vec<usize>, Unplannable> {
    let count = |chosen: &[usize]| -> u64 {
        let each = ladders.iter().zip(chosen).map(|(ladder, &step)| {
            let steps = ladder.as_ref().map(|ladder| &ladder.steps);
            steps
                .and_then(|steps| steps.get(step))
                .map_or(0, |c| c.tensor.samples())
        });
        each.sum::<usize>() as u64
    };
    let mut chosen = vec![0; ladders.len()];
    let allowed = budget.samples.unwrap_or(super::MOST_SAMPLES);
    if allowed > super::MOST_SAMPLES {
        return Err(Unplannable::TooMany {
            asked: allowed,
            most: super::MOST_SAMPLES,
        });
    }
    let needed = count(&chosen);
    if needed > allowed {
        return Err(Unplannable::Samples { allowed, needed });
    }
    // What cannot grow within the budget is left as it is; the others go on.
    let mut open: Vec<usize> = (0..ladders.len())
        .filter(|&k| ladders[k].is_some())
        .collect();
    let most = ladders.iter().flatten().map(counts).fold(0.0, f64::max);
    let loss = |k: usize, step: usize| {
        let ladder = ladders[k].as_ref();
        ladder.map_or(0.0, |ladder| {
            ladder.steps[step].loss * counts(ladder) / most.max(f64::MIN_POSITIVE)
        })
    };
    while let Some(&worst) = open
        .iter()
        .max_by(|&&a, &&b| loss(a, chosen[a]).total_cmp(&loss(b, chosen[b])))
    {
        let steps = ladders[worst]
            .as_ref()
            .map_or(0, |ladder| ladder.steps.len());
        let step = chosen[worst];
        let well = budget.samples.is_none()
            && ladders[worst]
                .as_ref()
                .is_some_and(|l| l.steps[step].error <= WELL);
        let mut tried = chosen.clone();
        tried[worst] = step + 1;
        if well || step + 1 >= steps || count(&tried) > allowed {
            open.retain(|&k| k != worst);
        } else {
            chosen = tried;
        }
    }
    Ok(chosen)
}
