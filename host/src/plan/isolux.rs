//! Isolux outlines of a surface, and the samples and emitters they give.

use super::map::{CELLS, Map, cell_center};
use super::pool::{Pool, Step};
use super::spacing::filter_radius;
use super::{Band, Sample, Shooters, SurfacePlan};
use glam::DVec3;
use isolux::form_factor::{Best, Outline, of_loops};
use isolux::geometry::{Plane, Receiver, Vector};
use isolux::number::SoftRoot;
use isolux::resample::cone;
use std::f64::consts::PI;

/// Emitters on the brightest surfaces: the paper's number.
const MOST_BANDS: usize = 4;

/// Vertices that an outline needs to be worth one.
const VERTICES_PER_OUTLINE: usize = 5;

/// Probes that get less than this part of what the brightest one gets say
/// nothing about an emitter.
const FAINT: f64 = 0.05;

/// An error of what the probes get that counts as none, as a part of all light
/// that is emitted.
const WELL: f64 = 0.005;

/// Every so many cells are looked at for what the cone filter errs by.
const BLUR_STEP: usize = 5;

/// Largest shift of the levels, in steps between them.
const LARGEST_SHIFT: f64 = 0.75;

/// Shifts that are tried on either side of none.
const SHIFTS: i32 = 15;

/// Places closer together than this part of the surface's width are one.
const WELD: f64 = 1e-6;

/// How far inside of the surface's outline its samples are evaluated, as a part
/// of the spacing that evenly spread samples would have.
const INSET: f64 = 0.01;

/// No sample is added closer to another one than this part of the spacing that
/// evenly spread samples would have.
const APART: f64 = 0.35;

impl Map {
    /// Places samples and makes emitters of them.
    ///
    /// The log-spaced levels are moved as a whole by up to [`LARGEST_SHIFT`] of
    /// their distance. A polygon inscribed in an outline encloses less than the
    /// outline, and the mean of two levels is not the mean between them: where
    /// the levels lie decides which of the two errors wins. Of the shifts with
    /// which the emitters light the `probes` well ([`WELL`]) the one is taken
    /// whose samples the cone filter spreads best; where there is none, the one
    /// that lights them best. `weight` is the power the surface reflects as a
    /// part of all that is emitted.
    pub(super) fn place(
        self,
        samples: usize,
        shooters: Shooters,
        probes: &[Probe],
        weight: f64,
    ) -> SurfacePlan {
        let lit = self.light(probes);
        let shifts = (-SHIFTS..=SHIFTS).map(|k| f64::from(k) / f64::from(SHIFTS) * LARGEST_SHIFT);
        let order = |placed: &Placed| {
            let loss = (placed.loss * weight - WELL).max(0.0);
            (loss, placed.blur)
        };
        let best = shifts
            .map(|shift| self.place_at(samples, shooters, shift, &lit))
            .min_by(|a, b| {
                let ((loss_a, blur_a), (loss_b, blur_b)) = (order(a), order(b));
                loss_a.total_cmp(&loss_b).then(blur_a.total_cmp(&blur_b))
            });
        let (samples, bands) = best
            .map(|placed| (placed.samples, placed.bands))
            .unwrap_or_default();
        SurfacePlan {
            filter_radius: filter_radius(self.area, samples.len()),
            samples,
            bands,
            ..SurfacePlan::without_samples(self.frame)
        }
    }

    fn place_at(&self, samples: usize, shooters: Shooters, shift: f64, lit: &[Lit]) -> Placed {
        let count = (samples / VERTICES_PER_OUTLINE).clamp(1, MOST_BANDS);
        let mut edge = self.edge();
        let peak = if self.peaks_inside() {
            Some(self.peak)
        } else {
            edge.choose_nearest(self.peak)
        };
        let mut steps = vec![Step {
            level: 0.0,
            loops: vec![edge],
        }];
        for level in self.levels(count, shift) {
            let loops = self.outlines(level);
            if !loops.is_empty() {
                steps.push(Step { level, loops });
            }
        }
        let near = [
            WELD * self.area.sqrt(),
            APART * (self.area / samples as f64).sqrt(),
        ];
        let pool = Pool::fill(&mut steps, samples, peak, near);
        let mut bands = pool.bands(&steps, |place| self.value(place));
        let outlines = pool.outlines(&steps);
        let inset = INSET * (self.area / samples as f64).sqrt();
        let samples = pool.into_samples(|vertex| self.inside(vertex, inset));
        if shooters == Shooters::Layers {
            bands = self.layers(outlines, &bands, &samples, lit);
        }
        let values: Vec<f64> = samples
            .iter()
            .map(|sample| self.value(sample.place))
            .collect();
        let radiosities: Vec<f64> = bands
            .iter()
            .map(|band| {
                let shares = band.shares();
                shares.map(|(member, share)| share * values[member]).sum()
            })
            .collect();
        Placed {
            loss: self.loss(&samples, &bands, &radiosities, lit),
            blur: self.blur(&samples, &values),
            samples,
            bands,
        }
    }

    /// What the cone filter makes of these samples: the root mean square of its
    /// error, relative to the irradiance with the mean one added, so that dark
    /// places count as far as they can be seen.
    fn blur(&self, samples: &[Sample], values: &[f64]) -> f64 {
        let places: Vec<[f32; 2]> = samples
            .iter()
            .map(|sample| sample.place.map(|x| x as f32))
            .collect();
        let values: Vec<f32> = values.iter().map(|&value| value as f32).collect();
        let radius = filter_radius(self.area, samples.len()) as f32;
        let mean = self.power / self.area;
        let (mut sum, mut count) = (0.0, 0);
        for (k, &exact) in self.values.iter().enumerate().step_by(BLUR_STEP) {
            let [u, v] = cell_center(&self.frame, k);
            if !self.frame.contains(u, v) || exact + mean <= 0.0 {
                continue;
            }
            let filtered = cone::<SoftRoot, f32>(&places, &values, [u as f32, v as f32], radius);
            if let Some(filtered) = filtered {
                let error = (f64::from(filtered.value) - exact) / (exact + mean);
                sum += error * error;
                count += 1;
            }
        }
        (sum / f64::from(count.max(1))).sqrt()
    }
}

/// A place elsewhere, with its normal, that a surface's light may reach.
pub(super) type Probe = (DVec3, DVec3);

/// A probe and the light that truly reaches it from a surface, per unit of
/// reflectance.
pub(super) struct Lit {
    receiver: Receiver<f64>,
    pub(super) irradiance: f64,
}

impl Map {
    /// The light that reaches the probes from the surface, by the midpoint rule
    /// over the grid; probes that get next to nothing are left out.
    fn light(&self, probes: &[Probe]) -> Vec<Lit> {
        let cell = self.frame.size_u * self.frame.size_v / (CELLS * CELLS) as f64;
        let mut lit: Vec<Lit> = probes
            .iter()
            .filter_map(|&(place, normal)| {
                let receiver = Receiver::new::<SoftRoot>(place.into(), normal.into()).ok()?;
                let mut irradiance = 0.0;
                for (k, &value) in self.values.iter().enumerate() {
                    let [u, v] = cell_center(&self.frame, k);
                    if self.frame.contains(u, v) {
                        let ray = self.frame.to_world(u, v) - place;
                        let (out, at) = (-ray.dot(self.frame.normal), ray.dot(normal));
                        let squared = ray.length_squared();
                        if out > 0.0 && at > 0.0 {
                            irradiance += value * cell * out * at / (PI * squared * squared);
                        }
                    }
                }
                Some(Lit {
                    receiver,
                    irradiance,
                })
            })
            .collect();
        let most = lit.iter().map(|lit| lit.irradiance).fold(0.0, f64::max);
        lit.retain(|lit| lit.irradiance > FAINT * most);
        lit
    }

    /// The largest relative error of the light that these emitters send to the
    /// probes; without probes, the relative error of their power.
    fn loss(&self, samples: &[Sample], bands: &[Band], radiosities: &[f64], lit: &[Lit]) -> f64 {
        if lit.is_empty() {
            let carried: f64 = bands.iter().zip(radiosities).map(|(b, r)| b.area * r).sum();
            return if self.power > 0.0 {
                (carried / self.power - 1.0).abs()
            } else {
                0.0
            };
        }
        let mut sent = vec![0.0; lit.len()];
        for (band, radiosity) in bands.iter().zip(radiosities) {
            let vertex = |&sample: &usize| samples[sample].vertex;
            let loops = band.loops.iter();
            let loops: Vec<Vec<[f64; 2]>> = loops.map(|l| l.iter().map(vertex).collect()).collect();
            for (sent, factor) in sent.iter_mut().zip(self.form_factors(&loops, lit)) {
                *sent += radiosity * factor;
            }
        }
        let errors = sent.iter().zip(lit);
        let errors = errors.map(|(sent, lit)| (sent / lit.irradiance - 1.0).abs());
        errors.fold(0.0, f64::max)
    }

    /// The form factors at the probes of what loops on the surface enclose.
    pub(super) fn form_factors(&self, loops: &[Vec<[f64; 2]>], lit: &[Lit]) -> Vec<f64> {
        let in_space = |&[u, v]: &[f64; 2]| <[f64; 3]>::from(self.frame.to_world(u, v));
        let loops = loops.iter();
        let loops: Vec<Vec<[f64; 3]>> = loops.map(|l| l.iter().map(in_space).collect()).collect();
        let plane = Plane {
            normal: Vector::from(<[f64; 3]>::from(self.frame.normal)),
            point: Vector::from(<[f64; 3]>::from(self.frame.origin)),
        };
        let factor = |lit: &Lit| {
            let outlines = loops.iter().map(|vertices| Outline::new(vertices));
            of_loops::<Best, f64>(&lit.receiver, &plane, outlines)
        };
        lit.iter().map(factor).collect()
    }
}

/// One way to place a surface's samples.
struct Placed {
    samples: Vec<Sample>,
    bands: Vec<Band>,
    /// What its emitters err by.
    loss: f64,
    /// What its samples err by when they are spread.
    blur: f64,
}
