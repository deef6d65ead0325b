//! A room's exact transfer, and the light of every luminaire in it.

use crate::solve::HostRoot;
use isolux::form_factor::Best;
use isolux::geometry::Receiver;
use isolux::luminance::{Constant, Linear, Rgb};
use isolux::scene::Scene;
use isolux::scene::records::Surface;
use isolux::visibility::Exact;
use rayon::prelude::*;
use std::ops::Range;

/// The rung that terms are computed with; codes and terms hold for any
/// other as well.
pub(super) type Rung = Best<HostRoot>;

/// The workspace that looks.
type Workspace = Exact<32, 64, 256, 64>;

/// A sample as the planner knows it.
pub(super) struct Place {
    /// `None` where it is no receiver: it then gets nothing.
    pub(super) receiver: Option<Receiver<f32>>,
    /// Whether it receives from luminaires, and from what reflects.
    pub(super) direct: bool,
    pub(super) reflected: bool,
    /// Whether it looks past what occludes.
    unshadowed: bool,
}

/// All samples, in the order of the tables.
pub(super) fn places(scene: &Scene<'_>) -> Vec<Place> {
    let of_surface = |surface: &Surface| -> Vec<Place> {
        let (_, places) = scene.samples_of(surface);
        let direct = ..places.len() - surface.indirect as usize;
        let reflected = surface.direct as usize..;
        let places = places.iter().enumerate();
        places
            .map(|(k, &place)| Place {
                receiver: Receiver::new::<HostRoot>(surface.place(place).into(), surface.normal)
                    .ok(),
                direct: direct.contains(&k),
                reflected: reflected.contains(&k),
                unshadowed: k < surface.unshadowed as usize,
            })
            .collect()
    };
    let receiving = scene.surfaces().iter().chain(scene.points());
    receiving.flat_map(of_surface).collect()
}

/// What every sample sees of every luminaire, by luminaire: none where all of
/// them see all.
pub(super) fn fractions(scene: &Scene<'_>, places: &[Place]) -> Vec<u16> {
    let direct: Vec<&Place> = places.iter().filter(|place| place.direct).collect();
    let fractions: Vec<u16> = (0..scene.counts().luminaires as usize)
        .flat_map(|luminaire| {
            let of_sample = |place: &&Place| match place.unshadowed {
                true => u16::MAX,
                false => fraction(scene, luminaire, place.receiver.as_ref()),
            };
            let fractions: Vec<u16> = direct.par_iter().map(of_sample).collect();
            fractions
        })
        .collect();
    match fractions.iter().all(|&fraction| fraction == u16::MAX) {
        true => Vec::new(),
        false => fractions,
    }
}

/// The visible part of a luminaire's form factor in 65 535ths; what is below the
/// horizon counts as seen.
fn fraction(scene: &Scene<'_>, luminaire: usize, receiver: Option<&Receiver<f32>>) -> u16 {
    let (Some(receiver), Some(emitter)) = (receiver, scene.emitters().get(luminaire)) else {
        return u16::MAX;
    };
    let whole = scene.form_factor::<Rung>(receiver, emitter);
    if whole <= 0.0 {
        return u16::MAX;
    }
    let part = f64::from(seen(scene, luminaire, receiver)) / f64::from(whole);
    // The cast saturates.
    (part * f64::from(u16::MAX)).round() as u16
}

/// The form factor of what is seen of an emitter.
fn seen(scene: &Scene<'_>, emitter: usize, receiver: &Receiver<f32>) -> f32 {
    let mut sight = Workspace::new();
    let one = Constant(1.0_f32);
    let bracket = scene.received::<Rung, _, _>(receiver, emitter, one, &mut sight);
    bracket.middle()
}

/// The form factor of all of an emitter.
fn whole(scene: &Scene<'_>, emitter: usize, receiver: &Receiver<f32>) -> f32 {
    let emitter = scene.emitters().get(emitter);
    emitter.map_or(0.0, |emitter| scene.form_factor::<Rung>(receiver, emitter))
}

/// A term as the coefficients of a linear radiosity make it: E = Σ t_k B_k.
pub(super) type Term = [f32; 3];

/// Radiosities whose channels are the coefficients, so that what is received is
/// the term.
pub(super) const UNIT: Linear<Rgb> = Linear {
    mean: Rgb([1.0, 0.0, 0.0]),
    gradient: [Rgb([0.0, 1.0, 0.0]), Rgb([0.0, 0.0, 1.0])],
};

pub(super) fn received(term: &Term, radiosity: &[f64; 3]) -> f64 {
    let parts = term.iter().zip(radiosity);
    parts.map(|(&term, b)| f64::from(term) * b).sum()
}

/// One luminaire's light in one channel.
pub(super) struct Light {
    /// Of every patch.
    pub(super) radiosity: Vec<[f64; 3]>,
    /// What every sample with reflected light receives, direct light included.
    pub(super) irradiance: Vec<f64>,
}

/// A room's exact transfer, and its light.
pub(super) struct Room<'a> {
    pub(super) scene: &'a Scene<'a>,
    pub(super) places: &'a [Place],
    /// By sample with reflected light, then by patch.
    pub(super) terms: Vec<Vec<Term>>,
}

impl<'a> Room<'a> {
    pub(super) fn new(scene: &'a Scene<'a>, places: &'a [Place]) -> Self {
        let reflected = places.iter().filter(|place| place.reflected);
        let reflected: Vec<&Place> = reflected.collect();
        let patches = scene.counts().luminaires as usize..scene.emitters().len();
        let of_sample = |place: &&Place| -> Vec<Term> {
            let mut sight = Workspace::new();
            let mut term = |patch| {
                let receiver = place.receiver.as_ref()?;
                let found = scene.received::<Rung, _, _>(receiver, patch, UNIT, &mut sight);
                Some(found.middle().0)
            };
            let patches = patches.clone();
            patches.map(|p| term(p).unwrap_or_default()).collect()
        };
        let terms = reflected.par_iter().map(of_sample).collect();
        Self {
            scene,
            places,
            terms,
        }
    }

    /// The samples that receive reflected light, in the order of the terms.
    pub(super) fn reflected_places(&self) -> Vec<&'a Place> {
        self.places.iter().filter(|place| place.reflected).collect()
    }

    pub(super) fn patches(&self) -> Range<usize> {
        self.scene.counts().luminaires as usize..self.scene.emitters().len()
    }

    /// Every luminaire alone, in every channel alone.
    pub(super) fn lights(&self) -> Vec<Light> {
        let channels = self.scene.counts().channels as usize;
        (0..self.scene.counts().luminaires as usize)
            .flat_map(|luminaire| {
                let of_place = |place: &Place| {
                    let receiver = place.receiver.as_ref();
                    receiver.map_or(0.0, |receiver| match place.unshadowed {
                        true => whole(self.scene, luminaire, receiver).into(),
                        false => seen(self.scene, luminaire, receiver).into(),
                    })
                };
                let direct: Vec<f64> = self.places.par_iter().map(of_place).collect();
                (0..channels)
                    .filter_map(move |channel| self.light(luminaire, channel, &direct))
                    .collect::<Vec<Light>>()
            })
            .collect()
    }

    /// The light of a luminaire in a channel, its exitance 1: B = ρ W (D + T B)
    /// until it changes no more. `None` where the luminaire is dark.
    fn light(&self, luminaire: usize, channel: usize, direct: &[f64]) -> Option<Light> {
        let of_channel = |all: Rgb| all.0[channel];
        let exitance = match self.scene.counts().channels {
            1 => self.scene.exitance::<f32>(luminaire),
            _ => of_channel(self.scene.exitance::<Rgb>(luminaire)),
        };
        if exitance <= 0.0 {
            return None;
        }
        let mut light = Light {
            radiosity: vec![[0.0; 3]; self.patches().len()],
            irradiance: Vec::new(),
        };
        let reflected_direct: Vec<f64> = (self.places.iter().zip(direct))
            .filter(|(place, _)| place.reflected)
            .map(|(_, &direct)| direct)
            .collect();
        // Nothing is reflected in the first round.
        let mut before = -1.0;
        for _ in 0..ROUNDS {
            let reflected = self.reflected(&light.radiosity);
            light.irradiance = (reflected.iter().zip(&reflected_direct))
                .map(|(reflected, direct)| reflected + direct)
                .collect();
            light.radiosity = self.radiosity(channel, direct, &reflected);
            let now: f64 = reflected.iter().sum();
            if now - before <= SETTLED * now {
                break;
            }
            before = now;
        }
        Some(light)
    }

    /// What every sample with reflected light receives of it.
    fn reflected(&self, radiosity: &[[f64; 3]]) -> Vec<f64> {
        let of_sample = |terms: &Vec<Term>| {
            let pairs = terms.iter().zip(radiosity);
            pairs.map(|(term, b)| received(term, b)).sum()
        };
        self.terms.par_iter().map(of_sample).collect()
    }

    /// What every patch reflects of what its samples receive.
    fn radiosity(&self, channel: usize, direct: &[f64], reflected: &[f64]) -> Vec<[f64; 3]> {
        let mut reflected = reflected.iter();
        let all: Vec<f64> = (self.places.iter().zip(direct))
            .map(|(place, &direct)| {
                let mut sum = if place.direct { direct } else { 0.0 };
                if place.reflected {
                    sum += reflected.next().copied().unwrap_or(0.0);
                }
                sum
            })
            .collect();
        self.patches()
            .map(|patch| {
                let emitter = &self.scene.emitters()[patch];
                let surface = emitter.surface as usize;
                let rho = f64::from(match self.scene.counts().channels {
                    1 => self.scene.reflectance::<f32>(surface),
                    _ => self.scene.reflectance::<Rgb>(surface).0[channel],
                });
                let mut sum = [0.0; 3];
                for (sample, weights) in self.scene.members_of(emitter) {
                    for (sum, &weight) in sum.iter_mut().zip(weights) {
                        *sum += rho * f64::from(weight) * all[sample];
                    }
                }
                sum
            })
            .collect()
    }
}

/// Reflections after which light is as settled as it gets.
const ROUNDS: usize = 200;

/// The change of all reflected light at which it is settled.
const SETTLED: f64 = 1e-4;
