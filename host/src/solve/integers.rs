//! The kernel in integers on the host, with its words for comparison and their
//! values in W m⁻² for everything else.

use super::{At, Channels, EMITTERS, Lit, Origin, Place, SAMPLES};
use isolux::Error;
use isolux::integers::{Format, Light, Scene};
use isolux::shoot::{Solved, Stop};
use rayon::prelude::*;

/// The kernel's state for integer tables.
pub(super) fn dark<'t, F: Format + Send + Sync + 'static>(
    tables: &'t [u8],
) -> Result<Box<dyn Lit + 't>, Error> {
    let light = Light::<F, SAMPLES, EMITTERS>::new(Scene::load(tables)?)?;
    Ok(Box::new(light))
}

/// So many units of 2^`exponent` W m⁻², in every channel.
fn channels(count: u64, exponent: i32) -> Channels {
    [(count as f64 * 2.0_f64.powi(exponent)) as f32; 3]
}

/// A length in the tables' unit.
fn length(metres: f32, exponent: i32) -> i32 {
    (f64::from(metres) * 2.0_f64.powi(-exponent)).round() as i32
}

impl<F: Format + Send + Sync> Lit for Light<'_, F, SAMPLES, EMITTERS> {
    fn solve(&mut self, stop: Stop) -> Solved {
        Light::solve(self, stop)
    }

    fn channels(&self) -> usize {
        1
    }

    fn irradiance(&self) -> Vec<Channels> {
        let unit = self.scene().header().irradiance;
        let values = Light::irradiance(self).iter();
        values.map(|&e| channels(e.into(), unit)).collect()
    }

    fn irradiance_bits(&self) -> Vec<u32> {
        Light::irradiance(self).to_vec()
    }

    fn at(&self, _: &Origin<'_>, receivers: &[Place]) -> Result<Vec<At>, Error> {
        let unit = self.scene().header().irradiance;
        let one = |&(position, normal): &Place| {
            let receiver = self.scene().receiver(position, normal)?;
            Ok(At {
                value: channels(Light::at(self, &receiver), unit),
                is_exact: true,
            })
        };
        receivers.par_iter().map(one).collect()
    }

    fn radiosity(&self, emitter: usize) -> Channels {
        let header = self.scene().header();
        let shift = match self.scene().is_luminaire(emitter) {
            true => header.shift as i32,
            false => 0,
        };
        let radiosity = Light::radiosity(self, emitter);
        channels(radiosity.into(), header.irradiance + shift)
    }

    fn resampled(&self, surface: usize, place: [f32; 2]) -> Result<Option<Channels>, Error> {
        let scene = self.scene();
        let header = scene.header();
        let place = place.map(|x| length(x, header.length));
        let filtered = self.resample_at(surface, place)?;
        Ok(filtered.map(|filtered| channels(filtered.value.into(), header.irradiance)))
    }

    fn row(
        &self,
        surface: usize,
        grid: [u32; 2],
        row: u32,
        out: &mut [Channels],
        bits: &mut [u32],
    ) -> Result<u32, Error> {
        let unit = self.scene().header().irradiance;
        let row = self.resample_row(surface, grid, row, bits)?;
        for (out, &value) in out.iter_mut().zip(bits.iter()) {
            *out = channels(value.into(), unit);
        }
        Ok(row.out_of_reach)
    }
}
