//! The kernel in integers on the host, with its words for comparison and their
//! values in W m⁻² for everything else.

use super::{At, Channels, EMITTERS, HostRoot, Lit, Looking, Origin, Place, SAMPLES, ToChannels};
use isolux::Error;
use isolux::form_factor::Best;
use isolux::geometry;
use isolux::integers::{Computed, Format, Light, Matrix, Radiosity, Scene, Transfer};
use isolux::luminance::Linear;
use isolux::shoot::{Solved, Stop};
use isolux::visibility::Bracket;
use rayon::prelude::*;

/// The kernel's state for integer tables, of the type that they ask for.
pub(super) fn dark<'t, F: Format + Send + Sync + 'static>(
    tables: &'t [u8],
) -> Result<Box<dyn Lit + 't>, Error> {
    fn of<'t, F, T>(scene: Scene<'t>) -> Result<Box<dyn Lit + 't>, Error>
    where
        F: Format + Send + Sync + 'static,
        T: Asked,
    {
        Ok(Box::new(Light::<F, SAMPLES, EMITTERS, T>::new(scene)?))
    }
    let scene = Scene::load(tables)?;
    let counts = scene.counts();
    match (counts.coefficients, counts.bits) {
        (1, _) => of::<F, Computed>(scene),
        (_, 4) => of::<F, Matrix<4>>(scene),
        (_, 6) => of::<F, Matrix<6>>(scene),
        _ => of::<F, Matrix<8>>(scene),
    }
}

/// So many units of 2^`exponent` W m⁻², in every channel.
fn channels(count: i64, exponent: i32) -> Channels {
    [watts(count, exponent); 3]
}

fn watts(count: i64, exponent: i32) -> f32 {
    (count as f64 * 2.0_f64.powi(exponent)) as f32
}

/// A length in the tables' unit.
fn length(metres: f32, exponent: i32) -> i32 {
    (f64::from(metres) * 2.0_f64.powi(-exponent)).round() as i32
}

/// A light with a rung of transfer.
type Of<'t, F, T> = Light<'t, F, SAMPLES, EMITTERS, T>;

/// A rung of transfer that any place can be asked for.
trait Asked: Transfer + Send + Sync + Sized + 'static {
    fn at<F: Format + Send + Sync>(
        light: &Of<'_, F, Self>,
        from: &Origin<'_>,
        receivers: &[Place],
    ) -> Result<Vec<At>, Error>;
}

impl Asked for Computed {
    fn at<F: Format + Send + Sync>(
        light: &Of<'_, F, Self>,
        _: &Origin<'_>,
        receivers: &[Place],
    ) -> Result<Vec<At>, Error> {
        let unit = light.scene().header().irradiance;
        let one = |&(position, normal): &Place| {
            let receiver = light.scene().receiver(position, normal)?;
            let sum = i64::try_from(light.at(&receiver)).unwrap_or(i64::MAX);
            Ok(At {
                value: channels(sum, unit),
                is_exact: true,
            })
        };
        receivers.par_iter().map(one).collect()
    }
}

/// The samples alone are known: every place looks at the emitters past the occluders that
/// the terms were written for, in floating point.
impl<const BITS: u32> Asked for Matrix<BITS> {
    fn at<F: Format + Send + Sync>(
        light: &Of<'_, F, Self>,
        from: &Origin<'_>,
        receivers: &[Place],
    ) -> Result<Vec<At>, Error> {
        let radiosities: Vec<Linear<f32>> = (0..light.scene().emitters().len())
            .map(|emitter| {
                let unit = unit(light, emitter);
                let [mean, a, b] = light.coefficients(emitter).map(|x| watts(x.into(), unit));
                let gradient = [a, b];
                Linear { mean, gradient }
            })
            .collect();
        let one = |sight: &mut Looking, &(position, normal): &Place| {
            let receiver = geometry::Receiver::new::<HostRoot>(position, normal)?;
            let mut sum = Bracket::exactly(0.0);
            for (index, &radiosity) in radiosities.iter().enumerate() {
                type Rung = Best<HostRoot>;
                let scene = &from.scene;
                sum = sum.plus(scene.received::<Rung, _, _>(&receiver, index, radiosity, sight));
            }
            Ok(At {
                value: sum.middle().max(0.0).channels(),
                is_exact: sum.is_exact(),
            })
        };
        let sight = || Looking::with(from.sight);
        receivers.par_iter().map_init(sight, one).collect()
    }
}

/// The exponent of the unit of an emitter's radiosity.
fn unit<F: Format, T: Transfer>(light: &Of<'_, F, T>, emitter: usize) -> i32 {
    let scene = light.scene();
    let header = scene.header();
    let shift = match scene.is_luminaire(emitter) {
        true => header.shift as i32,
        false => 0,
    };
    header.irradiance + shift
}

impl<F, T> Lit for Of<'_, F, T>
where
    F: Format + Send + Sync,
    T: Asked,
{
    fn solve(&mut self, stop: Stop) -> Solved {
        Light::solve(self, stop)
    }

    fn set_radiance(&mut self, luminaire: usize, [radiance, ..]: Channels) -> Result<(), Error> {
        Light::set_radiance(self, luminaire, radiance)
    }

    fn update(&mut self, stop: Stop) -> Solved {
        Light::update(self, stop)
    }

    fn points(&self) -> Vec<Channels> {
        let unit = self.scene().header().irradiance;
        let points = 0..self.scene().points().len();
        let found = points.filter_map(|point| self.point(point).ok());
        found.map(|e| channels(e.into(), unit)).collect()
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
        let values = Light::irradiance(self).iter();
        values.map(|e| e.cast_unsigned()).collect()
    }

    fn at(&self, from: &Origin<'_>, receivers: &[Place]) -> Result<Vec<At>, Error> {
        T::at(self, from, receivers)
    }

    fn radiosity(&self, emitter: usize) -> Channels {
        channels(
            self.coefficients(emitter).mean().into(),
            unit(self, emitter),
        )
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
        let mut values = vec![0; out.len()];
        let row = self.resample_row(surface, grid, row, &mut values)?;
        for ((out, bits), value) in out.iter_mut().zip(bits).zip(values) {
            *out = channels(value.into(), unit);
            *bits = value.cast_unsigned();
        }
        Ok(row.out_of_reach)
    }
}
