//! Few of a surface's samples that light the others as well as all of them would.

use super::super::{Field, Part, Plan, Point};
use super::lit::Lit;
use super::{GOOD, at};
use crate::scene::Scene;
use nalgebra::{DMatrix, DVector};

/// What points may cause by rms, as a multiple of what the lit surface is reconstructed
/// with; and at any one place, as a multiple of that.
const BESIDE: f64 = 2.0;
const AT_ONE: f64 = 2.0;

/// How often each of the chosen samples is tried to be exchanged for another.
const EXCHANGES: usize = 3;

/// What may be amiss in the power that all points send together; that may be all of
/// [`AT_ONE`]: it tells when to stop, and arrives nowhere by itself.
const POWER: f64 = 0.1;

/// Lets few samples of every surface shoot in place of all; whether they light
/// the other surfaces, and the named points, well enough: with an rms error of twice
/// what these are reconstructed with, or 0.3 %, at the most, and nowhere twice that.
///
/// Each stands for an area that is fitted to what arrives, and to the power sent, by least
/// squares: areas are those of the light that `total` gives, as corrections are, and what
/// is not a surface or a named point may be lit less well.
pub(super) fn shoot(scene: &Scene, plan: &mut Plan, total: &Field<'_>) -> bool {
    let mut suffice = true;
    let rms: Vec<f64> = (plan.surfaces.iter())
        .map(|surface| {
            let all = surface.predicted.iter().find(|p| p.part == Part::All);
            all.map_or(0.0, |all| all.rms)
        })
        .collect();
    for (index, surface) in plan.surfaces.iter_mut().enumerate() {
        let tensor = surface.fields.first().and_then(|f| f.tensor.as_ref());
        let Some(tensor) = tensor else { continue };
        let values = at(&surface.frame, &tensor.places(), total);
        let lit = Lit::by(scene, index, &surface.frame, total);
        let lit = lit.and_points(scene, index, &surface.frame, total);
        let allowed = |lit: usize| (BESIDE * rms.get(lit).copied().unwrap_or(0.0)).max(GOOD);
        let mut rows = lit.rows(&surface.frame, tensor, &values, &allowed);
        let areas = tensor.areas();
        let sent: f64 = areas.iter().zip(&values).map(|(a, v)| a * v).sum();
        let of_unit = values.iter().map(|value| value / (sent * POWER));
        rows.push(Row {
            of_samples: of_unit.collect(),
            wanted: 1.0 / POWER,
        });
        let fit = Fit::of(&rows, values.len(), scene.surfaces[index].area);
        match fit.few() {
            Some(points) => surface.points = points,
            None => suffice = false,
        }
    }
    suffice
}

/// What a place is lit with: by a unit of area of every sample, and what it should be, both
/// in units of the error it may have.
pub(super) struct Row {
    pub(super) of_samples: Vec<f64>,
    pub(super) wanted: f64,
}

/// The least squares of the areas.
struct Fit<'a> {
    rows: &'a [Row],
    gram: DMatrix<f64>,
    right: DVector<f64>,
    /// The area in m² that no point exceeds.
    largest: f64,
}

impl<'a> Fit<'a> {
    /// Of so many samples.
    fn of(rows: &'a [Row], count: usize, largest: f64) -> Self {
        let gram = DMatrix::from_fn(count, count, |i, j| {
            let places = rows.iter().map(|row| row.of_samples[i] * row.of_samples[j]);
            places.sum::<f64>()
        });
        let right = DVector::from_fn(count, |i, _| {
            let places = rows.iter().map(|row| row.of_samples[i] * row.wanted);
            places.sum::<f64>()
        });
        Self {
            rows,
            gram,
            right,
            largest,
        }
    }

    /// The fewest points found, one sample more at a time, that light every place as well
    /// as it may be lit.
    fn few(&self) -> Option<Vec<Point>> {
        let count = self.right.len();
        let mut chosen: Vec<usize> = Vec::new();
        while chosen.len() < count {
            let others = (0..count).filter(|k| !chosen.contains(k));
            let with = others.filter_map(|k| {
                let tried: Vec<usize> = chosen.iter().copied().chain([k]).collect();
                self.gain(&tried).map(|gain| (gain, k))
            });
            let (_, best) = with.max_by(|a, b| a.0.total_cmp(&b.0).then(b.1.cmp(&a.1)))?;
            chosen.push(best);
            self.exchange(&mut chosen);
            let areas = self.areas(&chosen)?;
            if self.is_good(&chosen, &areas) {
                chosen.sort_unstable();
                let areas = self.areas(&chosen)?;
                let points = chosen.into_iter().zip(areas.iter().copied());
                return Some(
                    points
                        .map(|(sample, area)| Point { sample, area })
                        .collect(),
                );
            }
        }
        None
    }

    /// Exchanges chosen samples for others as long as that lessens the squares.
    fn exchange(&self, chosen: &mut [usize]) {
        for _ in 0..EXCHANGES {
            let before = chosen.to_vec();
            for place in 0..chosen.len() {
                let mut best = self.gain(chosen).map(|gain| (gain, chosen[place]));
                for k in 0..self.right.len() {
                    if chosen.contains(&k) {
                        continue;
                    }
                    let mut tried = chosen.to_vec();
                    tried[place] = k;
                    let gain = self.gain(&tried).map(|gain| (gain, k));
                    if gain.map(|g| g.0) > best.map(|b| b.0) {
                        best = gain;
                    }
                }
                if let Some((_, k)) = best {
                    chosen[place] = k;
                }
            }
            if before == chosen {
                break;
            }
        }
    }

    /// The areas of some samples; `None` where one of them would be no area.
    fn areas(&self, chosen: &[usize]) -> Option<DVector<f64>> {
        let count = chosen.len();
        let gram = DMatrix::from_fn(count, count, |i, j| self.gram[(chosen[i], chosen[j])]);
        let right = DVector::from_fn(count, |i, _| self.right[chosen[i]]);
        let areas = gram.cholesky()?.solve(&right);
        let sound = |&area: &f64| area > 0.0 && area <= self.largest;
        areas.iter().all(sound).then_some(areas)
    }

    /// By how much they lessen the squares.
    fn gain(&self, chosen: &[usize]) -> Option<f64> {
        let areas = self.areas(chosen)?;
        let parts = chosen.iter().zip(areas.iter());
        Some(parts.map(|(&k, area)| self.right[k] * area).sum())
    }

    /// Whether they light the places well enough.
    fn is_good(&self, chosen: &[usize], areas: &DVector<f64>) -> bool {
        let error = |row: &Row| {
            let parts = chosen.iter().zip(areas.iter());
            let sent: f64 = parts.map(|(&k, area)| row.of_samples[k] * area).sum();
            sent - row.wanted
        };
        let (mut squares, mut most) = (0.0, 0.0_f64);
        for error in self.rows.iter().map(error) {
            squares += error * error;
            most = most.max(error.abs());
        }
        squares <= self.rows.len() as f64 && most <= AT_ONE
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// What two of five samples send exactly takes these two.
    #[test]
    fn what_few_samples_send_takes_no_more() {
        let sent = |place: f64, sample: f64| 1.0 / (1.0 + (place - sample).powi(2));
        let rows: Vec<Row> = (0..12)
            .map(|k| {
                let of_samples: Vec<f64> = (0..5).map(|s| sent(k as f64, s as f64)).collect();
                let wanted = 2.0 * of_samples[1] + 0.5 * of_samples[4];
                Row { of_samples, wanted }
            })
            .collect();
        let points = Fit::of(&rows, 5, 3.0).few().expect("points");
        let samples: Vec<usize> = points.iter().map(|point| point.sample).collect();
        assert!(samples.len() <= 5 && points.iter().all(|p| p.area > 0.0 && p.area <= 3.0));
        let error = |row: &Row| {
            let sent: f64 = points
                .iter()
                .map(|p| row.of_samples[p.sample] * p.area)
                .sum();
            (sent - row.wanted).abs()
        };
        assert!(
            rows.iter().map(error).fold(0.0, f64::max) <= 1.0,
            "{samples:?}"
        );
    }
}
