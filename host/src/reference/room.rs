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

use std::f64::consts::PI;

use glam::DVec3;
use rayon::prelude::*;

use super::gather::{Gather, Rules};
use super::luminaire::{self, Luminaire};
use super::patch::Receiver;
use super::polynomial::{Fit, Polynomial, TERMS};
use super::probes;
use super::rule::Rule;
use super::transfer::{Rows, Transfer};
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

/// Most cells of the first mesh, which scenes of many surfaces need; its
/// matrix then takes 2.3 GB.
const MOST_AT_FIRST: usize = 4000;

/// Share of the flux that the projection of direct light may miss on a cell,
/// on the first mesh.
const MISSED: f64 = 1e-4;

/// How much less it may be on the next.
const STRICTER: f64 = 0.25;

/// Error of a cell taken as a whole in a gather, relative to the mean
/// irradiance of the scene.
const NEGLIGIBLE: f64 = 1e-5;

/// Cells between two reports of progress.
const BATCH: usize = 64;

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

/// The nodes of a cell of the mesh with their areas, and the fit upon them.
type Nodes = (Vec<(DVec3, f64)>, Fit);

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
            scale: power
                .iter()
                .map(|p| p / tree.area.max(f64::MIN_POSITIVE))
                .collect(),
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
            sum.iter_mut()
                .zip(reflected)
                .for_each(|(s, r)| *s += r.max(0.0));
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
        let base = self.tree.even(FIRST);
        if base.len() > MOST_AT_FIRST && reflections != Reflections::AtMost(1) {
            return Err(Error::TooFine {
                cells: base.len(),
                most: MOST_AT_FIRST,
            });
        }
        self.tree.set_base(base);
        let probes = probes::spread(&self.tree);
        let mut missed = MISSED;
        let mut before: Option<Vec<[f64; 3]>> = None;
        loop {
            // The work grows as the square of the cells, and the last mesh is
            // the largest that fits.
            let cells = self.tree.base.len();
            let meshes = (MOST as f64 / cells as f64).max(1.0).log(GROWTH).floor();
            let last = cells as f64 * GROWTH.powf(meshes);
            let share = (cells as f64 / last).powi(2);
            let reached = share / (GROWTH * GROWTH - 1.0);
            let mut tell = |done: f64| progress((reached + share * done).min(1.0));
            let errors = self.solve_once(reflections, missed, &mut tell)?;
            if self.reflections == 0 {
                return Ok(());
            }
            let values: Vec<[f64; 3]> = probes
                .par_iter()
                .map(|probe| self.light(&probe.receiver))
                .collect();
            if let Some(before) = &before {
                self.accuracy = probes::disagreement(&probes, before, &values);
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
            let base = self.tree.finer(&errors, target);
            self.tree.set_base(base);
        }
        Ok(())
    }

    /// Solves on the present mesh; returns what the polynomials miss on each
    /// of its cells.
    fn solve_once(
        &mut self,
        reflections: Reflections,
        missed: f64,
        tell: &mut dyn FnMut(f64),
    ) -> Result<Vec<f64>, Error> {
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
        let (mut generation, errors) = self.first_generation(&fits, &mut |done| tell(0.5 * done));
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
            let transfer = transfer
                .get_or_insert_with(|| self.transfer(&fits, &mut |done| tell(0.5 + 0.5 * done)));
            generation = transfer.next(&radiance);
        }
        self.tree.add(&sum);
        Ok(errors)
    }

    /// The fit upon the nodes of each cell of the mesh.
    fn fits(&self) -> Vec<Nodes> {
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
                let reflectance =
                    self.tree.reflectors[self.tree.cells[*index].reflector].reflectance;
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
        fits: &[Nodes],
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
    fn first_generation(&self, fits: &[Nodes], tell: &mut dyn FnMut(f64)) -> (OnMesh, Vec<f64>) {
        let cells: Vec<(usize, &Nodes)> = self.tree.base.iter().copied().zip(fits).collect();
        let on_cell = |(index, (places, fit)): &(usize, &Nodes)| {
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
        };
        let mut found: Vec<(Vec<Polynomial>, f64)> = Vec::with_capacity(cells.len());
        for batch in cells.chunks(BATCH) {
            found.par_extend(batch.par_iter().map(on_cell));
            tell(found.len() as f64 / cells.len() as f64);
        }
        found.into_iter().unzip()
    }

    fn transfer(&self, fits: &[Nodes], tell: &mut dyn FnMut(f64)) -> Transfer {
        let mut column = vec![0; self.tree.cells.len()];
        for (place, &index) in self.tree.base.iter().enumerate() {
            column[index] = place;
        }
        let fill = |row: usize, out: &mut Rows| {
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
        };
        Transfer::new(self.tree.base.len(), BATCH, fill, tell)
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
