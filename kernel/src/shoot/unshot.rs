//! What has not been shot yet.

use super::Light;
use crate::form_factor::Arithmetic;
use crate::luminance::{Colour, Luminance};
use crate::scene::BRIGHTEST;
use crate::transfer::Transfer;

/// A power of two that changes no digit of a fraction keeps the largest powers
/// finite: 1e21 W m⁻² from 1e17 m² of 65 536 emitters.
const SCALE: f32 = 1.0 / (1 << 24) as f32;

/// What has not been shot.
pub(super) struct Left<C> {
    /// Its power as a fraction of the emitted power.
    pub(super) fraction: f32,
    /// The emitted power, [`SCALE`]d.
    emitted: f32,
    /// The emitter that has most of it; `None` where nothing is left.
    pub(super) brightest: Option<usize>,
    /// A [part](crate::scene::records::Header::ahead) of the irradiance in W m⁻² that
    /// all of it would come to, spread evenly over the surfaces that reflect:
    /// Σ ΔB_j A_j / Σ (1 − ρ_j) A_j. Dark unless emitters may shoot ahead.
    pub(super) ahead: C,
}

impl<A, const SAMPLES: usize, const EMITTERS: usize, L, V, const SURFACES: usize>
    Light<'_, A, SAMPLES, EMITTERS, L, V, SURFACES>
where
    A: Arithmetic<f32>,
    L: Luminance,
    V: Transfer,
{
    /// Power not yet shot, Σ |B − shot| A by the [strength](Luminance::strength) of what is
    /// left, as a fraction of the emitted power; 0 in
    /// a dark scene, 1 where nothing emits any more and light is still about.
    pub fn unshot_fraction(&self) -> f32 {
        self.left(L::Colour::DARK).fraction
    }

    /// What has not been shot. Emitters are compared by it and by what they reflect of
    /// the irradiance `ahead`.
    pub(super) fn left(&self, ahead: L::Colour) -> Left<L::Colour> {
        let (mut unshot, mut emitted, mut most) = (0.0, 0.0, 0.0);
        let mut brightest = None;
        let (mut flux, mut absorbed) = (L::Colour::DARK, L::Colour::DARK);
        for (index, emitter) in self.tables().emitters().iter().enumerate() {
            let mut pending = self.unshot(index);
            let radiosity = pending.strength();
            unshot += radiosity * SCALE * emitter.area;
            if L::AHEAD && emitter.members > 0 {
                let reflectance = self.reflectance(emitter.surface as usize);
                let area = SCALE * emitter.area;
                flux = flux.plus(pending.mean().times(area));
                absorbed = absorbed.plus(reflectance.map(|rho| (1.0 - rho) * area));
                let to_come = L::uniform(ahead.zip(reflectance, |e, rho| rho * e));
                pending = pending.zip(to_come, Colour::plus);
            }
            // Not scaled: the smallest powers must be told apart.
            let power = pending.strength() * emitter.area;
            if power > most {
                (brightest, most) = (Some(index), power);
            }
            emitted += self.exitance(index).total() * SCALE * emitter.area;
        }
        Left {
            fraction: match (emitted > 0.0, unshot > 0.0) {
                (true, _) => unshot / emitted,
                (false, left) => f32::from(u8::from(left)),
            },
            emitted,
            brightest,
            ahead: flux.zip(absorbed, |flux, absorbed| match absorbed > 0.0 {
                true => held(self.tables().ahead() * flux / absorbed, 0.0),
                false => 0.0,
            }),
        }
    }

    /// What an emitter is to have shot grows by what it reflects of the irradiance
    /// `ahead`, which is still to come.
    pub(super) fn anticipate(&mut self, index: usize, ahead: L::Colour) {
        let Some(emitter) = self.tables().emitters().get(index) else {
            return;
        };
        if emitter.members == 0 {
            return;
        }
        let reflectance = self.reflectance(emitter.surface as usize);
        let to_come = L::uniform(ahead.zip(reflectance, |e, rho| rho * e));
        if let Some(state) = self.emitters.get_mut(index) {
            state.due = state.due.zip(to_come, Colour::plus);
        }
    }

    /// Lets every emitter shoot in turn, what has reached it up to then, but for those
    /// whose part in what is unshot may stay: if none has more, all of it is below
    /// three quarters of the fraction. The number of shots, at most `most`; 0 once it is below the
    /// fraction.
    pub(super) fn sweep(&mut self, fraction: f32, most: u32) -> u32 {
        let left = self.left(L::Colour::DARK);
        if left.fraction <= fraction {
            return 0;
        }
        let emitters = self.emitters.len();
        let least = 0.75 * fraction * left.emitted / emitters as f32;
        let mut shots = 0_u32;
        for (index, emitter) in self.tables().emitters().iter().enumerate() {
            if shots >= most {
                break;
            }
            self.settle(index);
            let state = self.emitters.get(index);
            let pending = state.map_or(L::DARK, |state| difference(state.due, state.shot));
            if pending.strength() * SCALE * emitter.area > least {
                shots = shots.saturating_add(u32::from(self.send(index)));
            }
        }
        shots
    }

    /// What an emitter is to have shot becomes what its samples receive now makes it
    /// reflect. A luminaire emits what it was set to.
    pub(super) fn settle(&mut self, index: usize) {
        if self.tables().is_luminaire(index) {
            return;
        }
        let due = self.reflected(index);
        if let Some(state) = self.emitters.get_mut(index) {
            state.due = due;
        }
    }

    /// What an emitter has not yet shot.
    fn unshot(&self, index: usize) -> L {
        let Some(state) = self.emitters.get(index) else {
            return L::DARK;
        };
        match self.tables().is_luminaire(index) {
            true => difference(state.due, state.shot),
            false => difference(self.reflected(index), state.shot),
        }
    }

    /// ρ times the irradiance of the emitter's members: their mean, or what
    /// their weights make of it.
    ///
    /// By itself: its sums are not on the stack while it shoots.
    #[inline(never)]
    fn reflected(&self, index: usize) -> L {
        let Some(emitter) = self.tables().emitters().get(index) else {
            return L::DARK;
        };
        if emitter.members == 0 {
            return L::DARK;
        }
        let mut sum = L::DARK;
        let stride = if L::WEIGHTED { L::COEFFICIENTS } else { 0 };
        for (sample, weights) in self.tables().members_with(emitter, stride as u32) {
            let irradiance = self.irradiance.get(sample).copied();
            sum = sum.gather(irradiance.unwrap_or(L::Colour::DARK), weights);
        }
        let reflectance = self.reflectance(emitter.surface as usize);
        sum.gathered(emitter.members as usize)
            .zip(L::DARK, |all, _| all.zip(reflectance, |e, rho| rho * e))
    }
}

/// `due` less `shot`: what is unshot; below 0 what is to be taken away again, where
/// a luminaire was dimmed.
///
/// In tables of an impossible scene more may arrive than was sent, and grow: it is
/// held where every sum of it is finite.
pub(super) fn difference<L: Luminance>(due: L, shot: L) -> L {
    due.zip(shot, |due, shot| due.zip(shot, held))
}

/// `all` less `shot`, held where sums of it are finite.
fn held(all: f32, shot: f32) -> f32 {
    let value = all - shot;
    if value > BRIGHTEST {
        BRIGHTEST
    } else if value > -BRIGHTEST {
        value
    } else {
        -BRIGHTEST
    }
}
