//! From outlines to samples and emitters.

use super::outline::{Outline, signed_area};
use super::{Band, Sample, Tag};

/// The outlines of one level: together they enclose what is at least as bright.
pub(super) struct Step {
    /// Irradiance on the outlines, W m⁻²; 0 for the surface's own outline.
    pub(super) level: f64,
    /// Outer loops counter-clockwise, holes clockwise.
    pub(super) loops: Vec<Outline>,
}

/// A vertex this much brighter than a band's upper level is not the band's: it
/// lies where the surface's outline runs through a brighter one.
const BRIGHTER: f64 = 1.02;

/// The distinct places that the outlines and the peak choose.
pub(super) struct Pool {
    samples: Vec<Sample>,
    /// Distance in metres within which two places are one.
    weld: f64,
    peak: Option<usize>,
}

impl Pool {
    /// Refines the outlines in turn, the one with the fewest vertices first,
    /// until their vertices and the peak are `budget` distinct places; drops
    /// the brightest outlines if even the coarsest are too many. Places within
    /// `weld` metres are one; no new place is added within `apart` of another.
    pub(super) fn fill(
        steps: &mut Vec<Step>,
        budget: usize,
        peak: Option<[f64; 2]>,
        [weld, apart]: [f64; 2],
    ) -> Self {
        while Self::collect(steps, peak, weld).samples.len() > budget && steps.len() > 1 {
            steps.pop();
        }
        loop {
            let taken = Self::collect(steps, peak, weld);
            let before: Vec<Vec<Outline>> = steps.iter().map(|step| step.loops.clone()).collect();
            let mut turns = turns(steps).into_iter();
            let free = |place| taken.leaves_free(place, apart);
            let refined = turns.any(|(k, l)| steps[k].loops[l].refine(free));
            if !refined {
                break;
            }
            if Self::collect(steps, peak, weld).samples.len() > budget {
                for (step, loops) in steps.iter_mut().zip(before) {
                    step.loops = loops;
                }
                break;
            }
        }
        Self::collect(steps, peak, weld)
    }

    fn collect(steps: &[Step], peak: Option<[f64; 2]>, weld: f64) -> Self {
        let mut pool = Self {
            samples: Vec::new(),
            weld,
            peak: None,
        };
        for (k, step) in steps.iter().enumerate() {
            let tag = if k == 0 { Tag::Edge } else { Tag::Isolux };
            for place in step.loops.iter().flat_map(Outline::places) {
                pool.add(place, tag);
            }
        }
        pool.peak = peak.map(|place| pool.add(place, Tag::Peak));
        if let Some(peak) = pool.peak {
            pool.samples[peak].tag = Tag::Peak;
        }
        pool
    }

    /// Whether a place is a sample already, or far enough from all of them.
    fn leaves_free(&self, place: [f64; 2], apart: f64) -> bool {
        let [u, v] = place;
        let far = |sample: &Sample| (sample.vertex[0] - u).hypot(sample.vertex[1] - v) > apart;
        self.samples.iter().all(far) || self.find(place).is_some()
    }

    fn find(&self, place: [f64; 2]) -> Option<usize> {
        let near = |sample: &Sample| {
            (sample.vertex[0] - place[0]).hypot(sample.vertex[1] - place[1]) <= self.weld
        };
        self.samples.iter().position(near)
    }

    fn add(&mut self, place: [f64; 2], tag: Tag) -> usize {
        self.find(place).unwrap_or_else(|| {
            self.samples.push(Sample {
                place,
                vertex: place,
                tag,
            });
            self.samples.len() - 1
        })
    }

    fn indices(&self, step: &Step) -> Vec<Vec<usize>> {
        let find = |outline: &Outline| {
            let places = outline.places();
            places.filter_map(|place| self.find(place)).collect()
        };
        step.loops.iter().map(find).collect()
    }

    /// The loops of every step.
    pub(super) fn outlines(&self, steps: &[Step]) -> Vec<Vec<Vec<usize>>> {
        steps.iter().map(|step| self.indices(step)).collect()
    }

    /// One band between each outline and the next brighter one; the last one is
    /// what the brightest outline encloses.
    ///
    /// A band's members are the vertices of both its outlines. The peak is an
    /// outline shrunk to a point: it counts as often as the outline around it
    /// has vertices.
    pub(super) fn bands(&self, steps: &[Step], value: impl Fn([f64; 2]) -> f64) -> Vec<Band> {
        let outlines = self.outlines(steps);
        (0..steps.len())
            .map(|k| {
                let brighter = outlines.get(k + 1);
                let limit = steps
                    .get(k + 1)
                    .map_or(f64::INFINITY, |step| step.level * BRIGHTER);
                let mut loops = outlines[k].clone();
                let mut members: Vec<usize> = loops.iter().flatten().copied().collect();
                members.retain(|&member| value(self.samples[member].vertex) <= limit);
                match brighter {
                    Some(inner) => {
                        members.extend(inner.iter().flatten());
                        loops.extend(inner.iter().map(|l| l.iter().rev().copied().collect()));
                    }
                    None => {
                        let vertices = members.len();
                        members.extend(self.peak.iter().flat_map(|&p| vec![p; vertices]));
                    }
                }
                let area = loops.iter().map(|indices| self.signed_area(indices)).sum();
                Band {
                    loops,
                    members,
                    weights: Vec::new(),
                    area,
                }
            })
            .collect()
    }

    fn signed_area(&self, indices: &[usize]) -> f64 {
        let places: Vec<[f64; 2]> = indices.iter().map(|&k| self.samples[k].vertex).collect();
        signed_area(&places)
    }

    /// The samples, each evaluated where `place` puts its vertex.
    pub(super) fn into_samples(self, place: impl Fn([f64; 2]) -> [f64; 2]) -> Vec<Sample> {
        let mut samples = self.samples;
        for sample in &mut samples {
            sample.place = place(sample.vertex);
        }
        samples
    }
}

/// All loops by step and place in it, those with the fewest vertices first.
fn turns(steps: &[Step]) -> Vec<(usize, usize)> {
    let positions = steps.iter().enumerate().flat_map(|(k, step)| {
        let loops = step.loops.iter().enumerate();
        loops.map(move |(l, outline)| (outline.len(), k, l))
    });
    let mut sorted: Vec<_> = positions.collect();
    sorted.sort_unstable();
    sorted.into_iter().map(|(_, k, l)| (k, l)).collect()
}
