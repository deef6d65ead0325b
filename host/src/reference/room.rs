//! Any scene: everything occludes, light is reflected as often as asked.
//!
//! Radiosity by Galerkin's method. Surfaces are cut into cells on which
//! irradiance is a polynomial of second degree. Direct light is exact at any
//! point and projected from 36 points a cell, on cells halved until the
//! polynomials miss little. Light reflected once is gathered from it at nine
//! nodes of each cell of a coarser mesh; what one cell of that mesh gives to
//! another is a matrix, which makes each generation of light from the one
//! before. An asked point gathers from all cells, near ones in pieces, each
//! clipped by what stands between. The whole is repeated on a finer mesh until
//! two answers agree.
//!
//! Sources: Zatz, "Galerkin Radiosity", SIGGRAPH 1993; Reichert's final
//! gather; Lambert's contour formula for every visible piece.

use std::collections::BinaryHeap;
use std::f64::consts::PI;

use rayon::prelude::*;

use super::gather::{Gather, Rules};
use super::luminaire::{self, Luminaire};
use super::patch::Receiver;
use super::polynomial::{Fit, Polynomial, TERMS};
use super::rule::Rule;
use super::transfer::Transfer;
use super::tree::{Cell, Role, Tree, places};
use super::visible::Occluders;
use super::{Error, Reflections};
use crate::scene::Scene;

/// Cells of the first mesh.
const FIRST: usize = 160;

/// How many times as many cells the next mesh has.
const GROWTH: f64 = 2.5;

/// Most cells of a mesh; its matrix then takes 576 MB.
const MOST: usize = 2000;

/// What halving a cell is taken to leave of its error, for each half.
const HALVED: f64 = 0.2;

/// Share of the flux that the projection of direct light may miss on a cell,
/// on the first mesh.
const MISSED: f64 = 1e-4;

/// How much less it may be on the next.
const STRICTER: f64 = 0.25;

/// Error of a cell taken as a whole in a gather, relative to the mean
/// irradiance of the scene.
const NEGLIGIBLE: f64 = 1e-5;

/// Points at which two meshes are compared.
const PROBES: usize = 200;

/// A probe darker than this share of the brightest is compared with that share.
const DARK: f64 = 1e-3;

/// A solved scene.
pub(super) struct Room {
    occluders: Occluders,
    luminaires: Vec<Luminaire>,
    pub(super) tree: Tree,
    rules: Rules,
    /// Mean irradiance of each channel, were all emitted power spread evenly.
    scale: Vec<f64>,
    /// Emitted power of each channel.
    power: Vec<f64>,
    /// Reflections counted; cells hold light if there is one.
    pub(super) reflections: usize,
    /// Disagreement of the last two meshes.
    pub(super) accuracy: f64,
}

/// Irradiance on the mesh, for each cell and channel.
type OnMesh = Vec<Vec<Polynomial>>;

/// A cell that could be halved, by what that gains.
#[derive(PartialEq)]
struct Candidate {
    error: f64,
    cell: usize,
}

impl Eq for Candidate {}

impl Ord for Candidate {
    fn cmp(&self, other: &Self) -> std::cmp::Ordering {
        let by_error = self.error.total_cmp(&other.error);
        by_error.then(other.cell.cmp(&self.cell))
    }
}

impl PartialOrd for Candidate {
    fn partial_cmp(&self, other: &Self) -> Option<std::cmp::Ordering> {
        Some(self.cmp(other))
    }
}

impl Room {
    /// A scene of which only the direct light is known.
    pub(super) fn new(scene: &Scene, channels: usize) -> Result<Self, Error> {
        let luminaires = luminaire::luminaires(scene)?;
        let tree = Tree::new(scene)?;
        let power: Vec<f64> = (0..channels)
            .map(|channel| {
                let power = luminaires.iter().map(|l| PI * l.radiance[channel] * l.area);
                power.sum()
            })
            .collect();
        Ok(Self {
            occluders: Occluders::new(scene)?,
            luminaires,
            scale: power.iter().map(|p| p / tree.area.max(f64::MIN_POSITIVE)).collect(),
            power,
            tree,
            rules: Rules::new(),
            reflections: 0,
            accuracy: super::PROMISED,
        })
    }

    /// Direct light at a receiver.
    pub(super) fn direct(&self, receiver: &Receiver) -> [f64; 3] {
        luminaire::direct(&self.luminaires, &self.occluders.seen_from(*receiver))
    }

    /// All light at a receiver.
    pub(super) fn light(&self, receiver: &Receiver) -> [f64; 3] {
        let sight = self.occluders.seen_from(*receiver);
        let mut sum = luminaire::direct(&self.luminaires, &sight);
        if self.reflections > 0 {
            let gather = Gather {
                tree: &self.tree,
                sight: &sight,
                rules: &self.rules,
            };
            let reflected = gathered(&gather, true);
            sum.iter_mut().zip(reflected).for_each(|(s, r)| *s += r.max(0.0));
        }
        sum
    }

    /// Follows the reflected light, on finer and finer meshes until two differ
    /// by at most `agreement` (root of the mean square over points spread over
    /// the scene, relative).
    pub(super) fn solve(
        &mut self,
        reflections: Reflections,
        agreement: f64,
        progress: &mut dyn FnMut(f64),
    ) -> Result<(), Error> {
        if self.tree.base.is_empty() {
            let base = self.tree.even(FIRST);
            self.tree.set_base(base);
        }
        let probes = self.probes();
        let mut missed = MISSED;
        let mut before: Option<Vec<[f64; 3]>> = None;
        for level in 0.. {
            let errors = self.solve_once(reflections, missed)?;
            progress(1.0 - 0.5_f64.powi(level + 1));
            if self.reflections == 0 {
                return Ok(());
            }
            let values: Vec<[f64; 3]> = probes.par_iter().map(|probe| self.light(probe)).collect();
            if let Some(before) = &before {
                self.accuracy = self.disagreement(before, &values);
                if self.accuracy <= agreement {
                    break;
                }
            }
            before = Some(values);
            let target = (GROWTH * self.tree.base.len() as f64) as usize;
            if target > MOST {
                break;
            }
            missed *= STRICTER;
            let base = self.finer(&errors, target);
            self.tree.set_base(base);
        }
        Ok(())
    }

    /// Solves on the present mesh; returns what the polynomials miss on each
    /// of its cells.
    fn solve_once(&mut self, reflections: Reflections, missed: f64) -> Result<Vec<f64>, Error> {
        let mut tree = std::mem::replace(&mut self.tree, Tree::empty());
        tree.light(missed, &self.scale, &|receiver| self.direct(receiver));
        self.tree = tree;
        let fits = self.fits();
        let direct = self.direct_on_mesh();
        self.reflections = 0;
        if self.enough(reflections, 0, &direct, &fits) {
            return Ok(Vec::new());
        }
        self.reflections = 1;
        let channels = self.scale.len();
        let dark = vec![vec![[0.0; TERMS]; channels]; self.tree.base.len()];
        self.tree.add(&dark);
        if reflections == Reflections::AtMost(1) {
            return Ok(vec![0.0; self.tree.base.len()]);
        }
        let (mut generation, errors) = self.first_generation(&fits);
        let mut sum = dark;
        let mut transfer: Option<Transfer> = None;
        while !self.enough(reflections, self.reflections, &generation, &fits) {
            if self.reflections == super::MOST_GENERATIONS {
                return Err(Error::DoesNotDieOut {
                    generations: self.reflections,
                });
            }
            let radiance = self.radiance(&generation);
            for (total, more) in sum.iter_mut().flatten().zip(radiance.iter().flatten()) {
                total.iter_mut().zip(more).for_each(|(t, m)| *t += m);
            }
            self.reflections += 1;
            if reflections == Reflections::AtMost(self.reflections) {
                break;
            }
            let transfer = transfer.get_or_insert_with(|| self.transfer(&fits));
            generation = transfer.next(&radiance);
        }
        self.tree.add(&sum);
        Ok(errors)
    }

    /// The fit upon the nodes of each cell of the mesh.
    fn fits(&self) -> Vec<(Vec<(glam::DVec3, f64)>, Fit)> {
        let rule = Rule::new(3);
        let cells = self.tree.base.iter().map(|index| &self.tree.cells[*index]);
        cells
            .map(|cell| {
                let places = places(&cell.outline, &rule);
                let fit = Fit::new(&cell.frame, &places);
                (places, fit)
            })
            .collect()
    }

    /// Irradiance by direct light, on the mesh (0 where nothing is reflected).
    fn direct_on_mesh(&self) -> OnMesh {
        let cells = self.tree.base.iter().map(|index| &self.tree.cells[*index]);
        cells
            .map(|cell| {
                let reflectance = self.tree.reflectors[cell.reflector].reflectance;
                let light = cell.light.as_ref().map_or(&[][..], |light| &light.direct);
                let channels = light.iter().zip(reflectance);
                channels
                    .map(|(radiance, share)| {
                        let factor = if share > 0.0 { PI / share } else { 0.0 };
                        radiance.map(|coefficient| factor * coefficient)
                    })
                    .collect()
            })
            .collect()
    }

    /// `ρ/π` times the irradiance on the mesh.
    fn radiance(&self, irradiance: &OnMesh) -> OnMesh {
        let cells = self.tree.base.iter().zip(irradiance);
        cells
            .map(|(index, channels)| {
                let reflectance = self.tree.reflectors[self.tree.cells[*index].reflector].reflectance;
                let channels = channels.iter().zip(reflectance);
                channels
                    .map(|(polynomial, share)| polynomial.map(|c| share / PI * c))
                    .collect()
            })
            .collect()
    }

    /// Whether the generation that was reflected `count` times is the last to
    /// count: in every channel.
    fn enough(
        &self,
        reflections: Reflections,
        count: usize,
        generation: &OnMesh,
        fits: &[(Vec<(glam::DVec3, f64)>, Fit)],
    ) -> bool {
        let radiance = self.radiance(generation);
        self.power.iter().enumerate().all(|(channel, power)| {
            let cells = radiance.iter().zip(fits);
            let unshot: f64 = cells
                .map(|(channels, (_, fit))| PI * fit.integral(&channels[channel]))
                .sum();
            reflections.enough(count, unshot, *power)
        })
    }

    /// Light reflected once, on the mesh, and what its polynomials miss on
    /// each cell: in flux, relative to the mean irradiance.
    fn first_generation(&self, fits: &[(Vec<(glam::DVec3, f64)>, Fit)]) -> (OnMesh, Vec<f64>) {
        let cells: Vec<(usize, &(Vec<(glam::DVec3, f64)>, Fit))> =
            self.tree.base.iter().copied().zip(fits).collect();
        let found = cells.par_iter().map(|(index, (places, fit))| {
            let cell = &self.tree.cells[*index];
            let reflector = &self.tree.reflectors[cell.reflector];
            let values: Vec<[f64; 3]> = places
                .iter()
                .map(|(place, _)| {
                    let sight = self.occluders.seen_from(reflector.receiver(*place));
                    let gather = Gather {
                        tree: &self.tree,
                        sight: &sight,
                        rules: &self.rules,
                    };
                    gathered(&gather, false)
                })
                .collect();
            let mut missed = 0.0_f64;
            let channels = self.scale.iter().enumerate().map(|(channel, scale)| {
                let values = || values.iter().map(|value| value[channel]);
                let polynomial = fit.polynomial(values());
                if *scale > 0.0 {
                    let residual = fit.residual(&polynomial, values());
                    let share = reflector.reflectance[channel];
                    missed = missed.max(share * residual / scale * cell.area);
                }
                polynomial
            });
            let channels: Vec<Polynomial> = channels.collect();
            (channels, missed)
        });
        found.unzip()
    }

    fn transfer(&self, fits: &[(Vec<(glam::DVec3, f64)>, Fit)]) -> Transfer {
        let mut column = vec![0; self.tree.cells.len()];
        for (place, &index) in self.tree.base.iter().enumerate() {
            column[index] = place;
        }
        Transfer::new(self.tree.base.len(), |row, out| {
            let cell = &self.tree.cells[self.tree.base[row]];
            let reflector = &self.tree.reflectors[cell.reflector];
            let (places, fit) = &fits[row];
            for ((place, _), share) in places.iter().zip(fit.rows()) {
                let sight = self.occluders.seen_from(reflector.receiver(*place));
                let gather = Gather {
                    tree: &self.tree,
                    sight: &sight,
                    rules: &self.rules,
                };
                gather.visit(&|_, _| true, &mut |index, moments| {
                    out.add(column[index], share, moments);
                });
            }
        })
    }

    /// The mesh with the cells halved that miss most, up to `target` cells.
    fn finer(&mut self, errors: &[f64], target: usize) -> Vec<usize> {
        let pairs = self.tree.base.iter().zip(errors);
        let mut heap: BinaryHeap<Candidate> = pairs
            .map(|(&cell, &error)| Candidate { error, cell })
            .collect();
        let mut done = Vec::new();
        while done.len() + heap.len() < target
            && let Some(Candidate { error, cell }) = heap.pop()
        {
            match self.tree.halve(cell) {
                Some(halves) => heap.extend(halves.map(|cell| Candidate {
                    error: HALVED * error,
                    cell,
                })),
                None => done.push(cell),
            }
        }
        done.extend(heap.into_iter().map(|candidate| candidate.cell));
        done.sort_unstable();
        done
    }

    /// Points spread over the reflecting surfaces, none at a node.
    fn probes(&self) -> Vec<Receiver> {
        let base = &self.tree.base;
        let stride = base.len().div_ceil(PROBES).max(1);
        let rounds = (PROBES / base.len().max(1)).max(1);
        let mut probes = Vec::new();
        for (number, &index) in base.iter().enumerate().step_by(stride) {
            let cell = &self.tree.cells[index];
            for round in 0..rounds {
                // A place between a corner and the middle, by the golden ratio.
                let spin = (number * rounds + round) as f64;
                let share = (0.618_033_988_749_895 * spin).fract();
                let corner = cell.outline[(number + round) % cell.outline.len()];
                let next = cell.outline[(number + round + 1) % cell.outline.len()];
                let rim = corner.lerp(next, (0.754_877_666_246_693 * spin).fract());
                let place = cell.centre.lerp(rim, 0.95 * share.sqrt());
                probes.push(self.tree.reflectors[cell.reflector].receiver(place));
            }
        }
        probes
    }

    fn disagreement(&self, before: &[[f64; 3]], after: &[[f64; 3]]) -> f64 {
        let mut worst = 0.0_f64;
        for channel in 0..self.scale.len() {
            let brightest = after.iter().map(|value| value[channel]).fold(0.0, f64::max);
            if brightest <= 0.0 {
                continue;
            }
            let pairs = before.iter().zip(after);
            let squares: f64 = pairs
                .map(|(a, b)| {
                    let full = b[channel].max(DARK * brightest);
                    ((a[channel] - b[channel]) / full).powi(2)
                })
                .sum();
            worst = worst.max((squares / after.len().max(1) as f64).sqrt());
        }
        worst
    }
}

/// Irradiance by reflected light: of all generations, or of direct light alone.
fn gathered(gather: &Gather<'_>, all: bool) -> [f64; 3] {
    let whole = |cell: &Cell, bound: f64| {
        let roughness = cell.light.as_ref().map_or(0.0, |light| light.roughness);
        cell.role != Role::Above && roughness / PI * bound <= NEGLIGIBLE
    };
    let mut sum = [0.0; 3];
    gather.visit(&whole, &mut |index, moments| {
        let Some(light) = &gather.tree.cells[index].light else {
            return;
        };
        let polynomials = if all { &light.total } else { &light.direct };
        for (sum, polynomial) in sum.iter_mut().zip(polynomials) {
            *sum += super::polynomial::value(polynomial, moments);
        }
    });
    sum
}
