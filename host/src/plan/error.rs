//! Error-driven placement: samples go where they lessen the error most.
//!
//! For every surface the planner tries many ways to reconstruct its irradiance,
//! measures each against the light it knows, and keeps those that no other beats
//! with as few samples. The budget then goes, a step at a time, to the surface whose
//! error weighs most: an error counts with the power that the surface receives.

use super::fields::tensor::{Nodes, Tensor};
use super::fields::Field as Term;
use super::{Field, Part, Plan, Point, Predicted, Sample, SurfacePlan, Tag, Unplannable, spacing};
use crate::scene::frame::Frame;
use crate::scene::{Budget, Scene};
use glam::DVec3;
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

/// Places along each side of a surface at which another one's points are judged, and
/// nodes along each side that say what they should give.
const PROBED: usize = 6;
const DENSE: usize = 24;

/// Distance of points that shoot from what they light, in distances between them,
/// from which on they stand for their surface to within 0.3 %.
const FAR: f64 = 1.2;

/// Surfaces up to which each of them is tried as what lights the others; in larger
/// scenes only luminaires are.
const FEW: usize = 4;

/// What is known of a way to reconstruct a surface.
#[derive(Clone, Debug)]
struct Candidate {
    tensor: Tensor,
    /// The largest relative error, and that which its points cause on what they
    /// light, as far as that counts beside the surface itself.
    error: f64,
    /// The root of the mean square relative error over the surface.
    rms: f64,
    /// What its points cause.
    caused: f64,
}

/// Plans a scene in which nothing hides anything from anything.
///
/// `total` gives the irradiance after all reflections. Samples are the nodes of
/// tensor grids ([`super::fields`]), and where no surface is nearer to another one
/// than its samples are to each other they are also what shoots; else `None`: the
/// scene wants patches.
///
/// # Errors
/// [`Unplannable`] where the budget is too small, or too large for the tables.
pub fn error_driven(
    scene: &Scene,
    budget: &Budget,
    total: &Field<'_>,
) -> Result<Option<Plan>, Unplannable> {
    let ladders: Vec<Option<Ladder>> = scene
        .surfaces
        .iter()
        .enumerate()
        .map(|(k, surface)| surface.reflects().then(|| Ladder::new(scene, k, total)))
        .collect();
    let chosen = divide(&ladders, budget)?;
    let surfaces: Vec<SurfacePlan> = (scene.surfaces.iter().zip(&ladders))
        .zip(&chosen)
        .map(|((surface, ladder), &step)| match ladder {
            Some(ladder) => ladder.plan(step),
            None => SurfacePlan::without_samples(Frame::new(surface)),
        })
        .collect();
    let plan = Plan { surfaces };
    Ok(points_stand_for_surfaces(scene, &plan).then_some(plan))
}

/// The candidates of one surface, the number of samples rising and the error
/// falling.
struct Ladder {
    frame: Frame,
    area: f64,
    /// Power received in W.
    power: f64,
    steps: Vec<Candidate>,
}

impl Ladder {
    fn new(scene: &Scene, index: usize, total: &Field<'_>) -> Self {
        let surface = &scene.surfaces[index];
        let frame = Frame::new(surface);
        let measured = measured(&frame, MEASURED);
        let truth = at(&frame, &measured, total);
        let mean = truth.iter().sum::<f64>() / truth.len().max(1) as f64;
        let factors = factors(scene, index, &frame);
        let power = mean * surface.area;
        let lit = Lit::by(scene, index, &frame, total);
        let mut all = Vec::new();
        for nodes in Nodes::ALL {
            for along_u in COUNTS {
                for along_v in COUNTS {
                    let grid = Tensor::over(&frame, nodes, [along_u, along_v], None);
                    let values = at(&frame, &grid.places(), total);
                    let caused = lit.error(&frame, &grid, &values) / power;
                    all.extend(factors.iter().filter_map(|&factor| {
                        let tensor = Tensor { factor, ..grid.clone() };
                        let (worst, rms) = errors(&tensor, &values, &measured, &truth)?;
                        Some(Candidate {
                            tensor,
                            error: worst + caused,
                            rms,
                            caused,
                        })
                    }));
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
            frame,
            area: surface.area,
            power,
            steps,
        }
    }

    fn plan(&self, step: usize) -> SurfacePlan {
        let frame = self.frame.clone();
        let Some(candidate) = self.steps.get(step) else {
            return SurfacePlan::without_samples(frame);
        };
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
        SurfacePlan {
            predicted: predicted.map(of_part).into(),
            samples: tensor.places().into_iter().map(sample).collect(),
            points: areas.map(|(sample, area)| Point { sample, area }).collect(),
            filter_radius: spacing::filter_radius(self.area, tensor.samples()),
            fields: vec![Term {
                tensor: Some(tensor),
                mesh: None,
            }],
            ..SurfacePlan::without_samples(frame)
        }
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

/// What a surface's points light.
struct Lit {
    /// Places with their normals on other surfaces that reflect, what they receive
    /// in all, of this surface, and the power of theirs.
    probes: Vec<Probe>,
}

struct Probe {
    position: DVec3,
    normal: DVec3,
    total: f64,
    exact: f64,
    power: f64,
}

impl Lit {
    /// By a surface, which reflects what reaches it.
    fn by(scene: &Scene, index: usize, frame: &Frame, total: &Field<'_>) -> Self {
        let dense = Tensor::over(frame, Nodes::Gauss, [DENSE; 2], None);
        let values = at(frame, &dense.places(), total);
        let mut probes = Vec::new();
        for (other, surface) in scene.surfaces.iter().enumerate() {
            if other == index || !surface.reflects() {
                continue;
            }
            let its = Frame::new(surface);
            let cells = (0..PROBED * PROBED)
                .map(|k| its.cell_center(k % PROBED, k / PROBED, PROBED, PROBED))
                .filter(|&(u, v)| its.contains(u, v));
            let places: Vec<[f64; 2]> = cells.map(|(u, v)| [u, v]).collect();
            let totals = at(&its, &places, total);
            let mean = totals.iter().sum::<f64>() / totals.len().max(1) as f64;
            probes.extend(places.iter().zip(totals).map(|(&[u, v], total)| {
                let (position, normal) = (its.to_world(u, v), its.normal);
                Probe {
                    position,
                    normal,
                    total,
                    exact: sent(frame, &dense, &values, position, normal),
                    power: mean * surface.area,
                }
            }));
        }
        // Beside what arrives in all, it gives that much times its reflectance.
        let rho = scene.surfaces[index].reflectance[0];
        for probe in &mut probes {
            probe.total /= rho;
        }
        Self { probes }
    }

    /// The largest relative error that points with these values cause, times the
    /// power it is an error of, in W.
    fn error(&self, frame: &Frame, tensor: &Tensor, values: &[f64]) -> f64 {
        let errors = self.probes.iter().map(|probe| {
            let sent = sent(frame, tensor, values, probe.position, probe.normal);
            let error = (sent - probe.exact).abs() / probe.total.max(f64::MIN_POSITIVE);
            error * probe.power
        });
        errors.fold(0.0, f64::max)
    }
}

/// What the nodes of a tensor grid give to a place, as points of these radiosities.
fn sent(frame: &Frame, tensor: &Tensor, values: &[f64], place: DVec3, normal: DVec3) -> f64 {
    let nodes = tensor.places().into_iter().zip(tensor.areas()).zip(values);
    nodes
        .map(|(([u, v], area), value)| {
            let to = frame.to_world(u, v) - place;
            let cosines = to.dot(normal).max(0.0) * (-to.dot(frame.normal)).max(0.0);
            value * area * cosines / (PI * to.length_squared().powi(2))
        })
        .sum()
}

/// The field at places of a surface.
fn at(frame: &Frame, places: &[[f64; 2]], field: &Field<'_>) -> Vec<f64> {
    let receiver = |&[u, v]: &[f64; 2]| (frame.to_world(u, v), frame.normal);
    let receivers: Vec<(DVec3, DVec3)> = places.iter().map(receiver).collect();
    field(&receivers)
}

/// The largest relative error of a tensor grid through these values, and the root of
/// the mean square over the area; `None` where there is none through them.
fn errors(
    tensor: &Tensor,
    values: &[f64],
    places: &[[f64; 2]],
    truth: &[f64],
) -> Option<(f64, f64)> {
    let through = tensor.through(values)?;
    let faint = FAINT * truth.iter().copied().fold(0.0, f64::max);
    let (mut worst, mut squares, mut weights) = (0.0_f64, 0.0, 0.0);
    for (&place, &truth) in places.iter().zip(truth) {
        let error = (through.at(place) - truth).abs() / truth.max(faint).max(f64::MIN_POSITIVE);
        // Places are closer towards the edges: each stands for less there.
        let weight: f64 = [0, 1]
            .map(|axis| {
                let t = (place[axis] - tensor.center[axis]) / tensor.half[axis];
                (1.0 - t * t).max(0.0).sqrt()
            })
            .iter()
            .product();
        worst = worst.max(error);
        squares += weight * error * error;
        weights += weight;
    }
    Some((worst, (squares / weights.max(f64::MIN_POSITIVE)).sqrt()))
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
fn divide(ladders: &[Option<Ladder>], budget: &Budget) -> Result<Vec<usize>, Unplannable> {
    let count = |chosen: &[usize]| -> u64 {
        let each = ladders.iter().zip(chosen).map(|(ladder, &step)| {
            let steps = ladder.as_ref().map(|ladder| &ladder.steps);
            steps.and_then(|steps| steps.get(step)).map_or(0, |c| c.tensor.samples())
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
    let mut open: Vec<usize> = (0..ladders.len()).filter(|&k| ladders[k].is_some()).collect();
    let most = ladders.iter().flatten().map(|l| l.power).fold(0.0, f64::max);
    let loss = |k: usize, step: usize| {
        let ladder = ladders[k].as_ref();
        ladder.map_or(0.0, |ladder| {
            ladder.steps[step].error * ladder.power / most.max(f64::MIN_POSITIVE)
        })
    };
    while let Some(&worst) = open
        .iter()
        .max_by(|&&a, &&b| loss(a, chosen[a]).total_cmp(&loss(b, chosen[b])))
    {
        let steps = ladders[worst].as_ref().map_or(0, |ladder| ladder.steps.len());
        let step = chosen[worst];
        let well = budget.samples.is_none()
            && ladders[worst].as_ref().is_some_and(|l| l.steps[step].error <= WELL);
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

/// Whether the points are farther from everything they light than [`FAR`] times
/// their distance from each other.
fn points_stand_for_surfaces(scene: &Scene, plan: &Plan) -> bool {
    plan.surfaces.iter().enumerate().all(|(index, planned)| {
        let Some(tensor) = planned.fields.first().and_then(|field| field.tensor.as_ref()) else {
            return true;
        };
        let rectangle = planned.frame.size_u * planned.frame.size_v;
        if (scene.surfaces[index].area - rectangle).abs() > 1e-6 * rectangle {
            return false;
        }
        let gap = |axis: usize| {
            let nodes = tensor.nodes[axis].windows(2);
            nodes.map(|pair| pair[1] - pair[0]).fold(0.0, f64::max) * tensor.half[axis]
        };
        let near = FAR * gap(0).max(gap(1));
        let points: Vec<DVec3> = tensor
            .places()
            .iter()
            .map(|&[u, v]| planned.frame.to_world(u, v))
            .collect();
        let normal = planned.frame.normal;
        scene.surfaces.iter().zip(&plan.surfaces).enumerate().all(|(other, (lit, its))| {
            let in_front = lit.vertices.iter().any(|&v| (v - planned.frame.origin).dot(normal) > 0.0);
            let faced = || {
                let height = |&point: &DVec3| (point - its.frame.origin).dot(its.frame.normal);
                points.iter().any(|point| height(point) > 0.0)
            };
            if other == index || !lit.reflects() || !in_front || !faced() {
                return true;
            }
            points.iter().all(|&point| distance(point, &its.frame) >= near)
        })
    })
}

/// The distance of a place from the bounding rectangle of a surface.
fn distance(place: DVec3, frame: &Frame) -> f64 {
    let (u, v) = frame.to_local(place);
    let nearest = frame.to_world(u.clamp(0.0, frame.size_u), v.clamp(0.0, frame.size_v));
    place.distance(nearest)
}
