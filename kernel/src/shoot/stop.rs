//! When shooting ends, the same for every state that light is shot in.

/// When to stop.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Stop {
    /// When the unshot power is below this fraction of the emitted power, or
    /// after so many shots at the latest: a fixed budget needs the second
    /// number.
    Below {
        /// Fraction of the emitted power.
        fraction: f32,
        /// Shots at the most.
        shots: u32,
    },
    /// After so many shots.
    Shots(u32),
    /// When all light reflected at most so many times has arrived; 0 is direct
    /// light only.
    Reflections(u32),
}

impl Stop {
    /// Below this fraction of the emitted power, within 4096 shots.
    pub const fn below(fraction: f32) -> Self {
        Self::Below {
            fraction,
            shots: 4096,
        }
    }
}

/// How a [`Light::solve`](super::Light::solve) ended.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Solved {
    /// Shots taken.
    pub shots: u32,
    /// Form factors evaluated: one for each shot and each sample that is not on
    /// the emitter's own surface.
    pub form_factors: u32,
    /// Unshot power as a fraction of the emitted power; 0 in a dark scene.
    pub unshot: f32,
}

/// A state that light is shot in, whatever its numbers.
pub(crate) trait Shooting {
    /// Light that is still to come, where it is sent ahead.
    type Ahead: Copy;
    /// None of it.
    const NOTHING: Self::Ahead;
    /// Direct light alone; the number of shots.
    fn direct(&mut self) -> u32;
    /// One more reflection of all light; the number of shots.
    fn reflect(&mut self) -> u32;
    /// One shot of the emitter with the largest unshot power; whether there was
    /// one.
    fn shoot(&mut self) -> bool;
    /// As many shots, `most` of them, as follow each other without a new look at what
    /// is left; how many there were, 0 once that is below this fraction of the emitted
    /// power. What is `ahead` is sent as well, and then what the look has found.
    fn shoot_some(&mut self, fraction: f32, most: u32, ahead: &mut Self::Ahead) -> u32;
    /// How many shots may be ahead of their light: a bound, so that the rest
    /// converges whatever they did.
    fn most_ahead(&self) -> u32 {
        0
    }
}

/// Lights a scene from darkness until `stop`; the number of shots.
#[inline]
pub(crate) fn until(stop: Stop, light: &mut impl Shooting) -> u32 {
    let direct = light.direct();
    onwards(stop, direct, light)
}

/// Lights a scene that has seen so many `shots` until `stop`; the number of shots
/// in all.
#[inline]
pub(crate) fn onwards<S: Shooting>(stop: Stop, mut shots: u32, light: &mut S) -> u32 {
    match stop {
        Stop::Reflections(times) => {
            for _ in 0..times {
                let more = light.reflect();
                shots = shots.saturating_add(more);
                if more == 0 {
                    break;
                }
            }
        }
        Stop::Shots(limit) => {
            while shots < limit && light.shoot() {
                shots = shots.saturating_add(1);
            }
        }
        Stop::Below {
            fraction,
            shots: limit,
        } => {
            let last = shots.saturating_add(light.most_ahead());
            let mut ahead = S::NOTHING;
            while shots < limit {
                if shots >= last {
                    ahead = S::NOTHING;
                }
                let most = limit.saturating_sub(shots);
                let more = light.shoot_some(fraction, most, &mut ahead);
                if more == 0 {
                    break;
                }
                shots = shots.saturating_add(more);
            }
        }
    }
    shots
}
