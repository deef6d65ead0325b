//! The kernel on the host: the same code and the same bits as on the device.
//!
//! Between [`crate::bake`], which makes its tables, and [`crate::compare`],
//! which judges it. Independent samples are spread over the cores; no sum is
//! divided, so no bit depends on how many there are.

mod integers;
mod looking;
mod rung;
pub mod tally;

pub use rung::{FormFactorRung, HostRoot, Rung, Sight, fixed_form_factor};

use crate::bake::Tables;
use isolux::Error;
use isolux::error::What;
use isolux::form_factor::Arithmetic;
use isolux::form_factor::fixed_point::{Q24, Q29};
use isolux::form_factor::{Best, Libm, Micromath, Poly3, Poly5, Poly8};
use isolux::geometry::Receiver;
use isolux::luminance::{Colour, Constant, Increment, Linear, Luminance, Rgb};
use isolux::resample::{Reconstructed, Stencils};
use isolux::scene::Scene;
use isolux::shoot::{Light, Solved, Stop};
use looking::{Looking, Sending};
use rayon::prelude::*;
use rung::with_rung;
use std::ops::Range;
use std::sync::OnceLock;

/// The most samples a solve on the host holds: 64 KiB of state.
const SAMPLES: usize = 1 << 14;

/// The most emitters a solve on the host holds.
const EMITTERS: usize = 1 << 12;

/// An answer at a place.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct At {
    /// The irradiance.
    pub value: Channels,
    /// Whether visibility was known in full; else the value is the middle of
    /// what is possible.
    pub is_exact: bool,
}

/// Light in the three channels; a grey scene has the same in all.
pub type Channels = [f32; 3];

/// A place and its normal, as the kernel takes them.
type Place = ([f32; 3], [f32; 3]);

/// What places are looked at from.
struct Origin<'t> {
    /// The scene with its occluders, which coded tables lack.
    scene: Scene<'t>,
    sight: Sight,
    /// The light that shines on them, where the tables' own knows samples alone.
    light: Option<Box<dyn Lit + 't>>,
}

/// A solved scene.
pub struct Solution<'t> {
    light: Box<dyn Lit + 't>,
    from: Origin<'t>,
    /// How the solve ended.
    pub solved: Solved,
}

/// A light with its rung, its channels and capacities out of sight.
trait Lit: Send + Sync {
    fn solve(&mut self, stop: Stop) -> Solved;
    fn channels(&self) -> usize;
    fn irradiance(&self) -> Vec<Channels>;
    fn irradiance_bits(&self) -> Vec<u32>;
    fn at(&self, from: &Origin<'_>, receivers: &[Place]) -> Result<Vec<At>, Error>;
    /// Not for integers: what asks for terms does so to plan.
    fn terms(
        &self,
        _: &Origin<'_>,
        _: &[Place],
        _: Range<usize>,
        _: Sight,
    ) -> Result<Vec<Vec<f32>>, Error> {
        Err(Error::Capacity {
            what: What::Coefficients,
            needed: 3,
            have: 1,
        })
    }
    fn radiosity(&self, emitter: usize) -> Channels;
    fn set_radiance(&mut self, luminaire: usize, radiance: Channels) -> Result<(), Error>;
    fn update(&mut self, stop: Stop) -> Solved;
    fn points(&self) -> Vec<Channels>;
    fn resampled(&self, surface: usize, place: [f32; 2]) -> Result<Option<Channels>, Error>;
    fn row(
        &self,
        surface: usize,
        grid: [u32; 2],
        row: u32,
        out: &mut [Channels],
        bits: &mut [u32],
    ) -> Result<u32, Error>;
}

/// A colour on the host.
trait ToChannels: Colour {
    fn channels(self) -> Channels;
}

impl ToChannels for f32 {
    fn channels(self) -> Channels {
        [self; 3]
    }
}

impl ToChannels for Rgb {
    fn channels(self) -> Channels {
        self.0
    }
}

/// The kernel's light, with what surfaces are put together from once it is asked
/// for.
struct Kept<'t, A, L: Luminance> {
    /// By itself: half a megabyte that is not to pass the stack again.
    light: Box<Light<'t, A, SAMPLES, EMITTERS, L, Sending>>,
    rooms: Vec<OnceLock<Vec<L::Colour>>>,
}

impl<'t, A, L> Kept<'t, A, L>
where
    A: Arithmetic<f32>,
    L: Luminance,
{
    fn new(light: Box<Light<'t, A, SAMPLES, EMITTERS, L, Sending>>) -> Self {
        let surfaces = light.scene().surfaces().len();
        Self {
            light,
            rooms: (0..surfaces).map(|_| OnceLock::new()).collect(),
        }
    }

    /// What surfaces were put together from is no more.
    fn forget(&mut self) {
        self.rooms
            .iter_mut()
            .for_each(|room| *room = OnceLock::new());
    }

    /// A surface put together from its fields; `None` where it has none, or does
    /// not exist.
    fn reconstructed(
        &self,
        index: usize,
    ) -> Option<Reconstructed<'t, '_, Stencils<HostRoot>, L::Colour>> {
        let scene = self.light.scene();
        let surface = scene.surface(index).ok().filter(|s| s.fields > 0)?;
        let room = self.rooms.get(index)?.get_or_init(|| {
            let mut room = vec![L::Colour::DARK; scene.fields().room(surface)];
            // The room is as large as it has to be.
            let _ = self
                .light
                .reconstruct::<Stencils<HostRoot>>(index, &mut room);
            room
        });
        self.light.reconstructed(index, room).ok()
    }
}

impl<A, L> Lit for Kept<'_, A, L>
where
    A: Arithmetic<f32> + Send + Sync,
    L: Luminance<Colour: ToChannels>,
{
    fn solve(&mut self, stop: Stop) -> Solved {
        self.forget();
        self.light.solve(stop)
    }

    fn set_radiance(&mut self, luminaire: usize, radiance: Channels) -> Result<(), Error> {
        let radiance = L::Colour::read(&radiance);
        self.light.set_radiance(luminaire, radiance)
    }

    fn update(&mut self, stop: Stop) -> Solved {
        self.forget();
        self.light.update(stop)
    }

    fn points(&self) -> Vec<Channels> {
        let points = 0..self.light.scene().points().len();
        let found = points.filter_map(|point| self.light.point(point).ok());
        found.map(ToChannels::channels).collect()
    }

    fn channels(&self) -> usize {
        L::Colour::CHANNELS
    }

    fn irradiance(&self) -> Vec<Channels> {
        let values = self.light.irradiance().iter();
        values.map(|value| value.channels()).collect()
    }

    fn irradiance_bits(&self) -> Vec<u32> {
        let values = self.light.irradiance().iter();
        values.flat_map(|&value| bits(value)).collect()
    }

    fn at(&self, from: &Origin<'_>, receivers: &[Place]) -> Result<Vec<At>, Error> {
        let one = |sight: &mut Looking, &(position, normal): &Place| {
            let receiver = Receiver::new::<HostRoot>(position, normal)?;
            let bracket = self.light.at_among(&from.scene, &receiver, sight);
            Ok(At {
                value: bracket.middle().channels(),
                is_exact: bracket.is_exact(),
            })
        };
        let sight = || Looking::with(from.sight);
        receivers.par_iter().map_init(sight, one).collect()
    }

    fn terms(
        &self,
        from: &Origin<'_>,
        receivers: &[Place],
        emitters: Range<usize>,
        sight: Sight,
    ) -> Result<Vec<Vec<f32>>, Error> {
        let one = |sight: &mut Looking, &(position, normal): &Place| {
            let receiver = Receiver::new::<HostRoot>(position, normal)?;
            let term = |emitter| {
                let radiosity = self.light.radiosity(emitter);
                let scene = &from.scene;
                let bracket = scene.received::<A, L, _>(&receiver, emitter, radiosity, sight);
                bracket.middle().total() / L::Colour::CHANNELS as f32
            };
            Ok(emitters.clone().map(term).collect())
        };
        let sight = || Looking::with(sight);
        receivers.par_iter().map_init(sight, one).collect()
    }

    fn radiosity(&self, emitter: usize) -> Channels {
        self.light.radiosity(emitter).mean().channels()
    }

    fn resampled(&self, surface: usize, place: [f32; 2]) -> Result<Option<Channels>, Error> {
        if let Some(reconstructed) = self.reconstructed(surface) {
            return Ok(Some(reconstructed.at(place).channels()));
        }
        let filtered = self.light.resample_at::<HostRoot>(surface, place)?;
        Ok(filtered.map(|filtered| filtered.value.channels()))
    }

    fn row(
        &self,
        surface: usize,
        grid: [u32; 2],
        row: u32,
        out: &mut [Channels],
        bits: &mut [u32],
    ) -> Result<u32, Error> {
        let mut values = vec![L::Colour::DARK; out.len()];
        let out_of_reach = match self.reconstructed(surface) {
            Some(reconstructed) => reconstructed.row(grid, row, &mut values).map(|()| 0)?,
            None => {
                let light = &self.light;
                let row = light.resample_row::<HostRoot>(surface, grid, row, &mut values)?;
                row.out_of_reach
            }
        };
        for (out, &value) in out.iter_mut().zip(&values) {
            *out = value.channels();
        }
        let words = values.into_iter().flat_map(self::bits);
        for (out, word) in bits.iter_mut().zip(words) {
            *out = word;
        }
        Ok(out_of_reach)
    }
}

/// The words of a value, one a channel, as the device has them.
fn bits<C: ToChannels>(value: C) -> impl Iterator<Item = u32> {
    let words = value.channels().map(f32::to_bits);
    words.into_iter().take(C::CHANNELS)
}

/// The kernel's state for a scene, of the type that its tables ask for.
fn dark<A>(scene: Scene<'_>, sight: Sight) -> Result<Box<dyn Lit + '_>, Error>
where
    A: Arithmetic<f32> + Send + Sync + 'static,
{
    fn of<'t, A, L>(scene: Scene<'t>, sight: Sight) -> Result<Box<dyn Lit + 't>, Error>
    where
        A: Arithmetic<f32> + Send + Sync + 'static,
        L: Luminance<Colour: ToChannels>,
    {
        let sending = Sending::of(&scene, sight);
        let light = Light::<A, SAMPLES, EMITTERS, L, _>::with_sight(scene, sending)?;
        Ok(Box::new(Kept::new(Box::new(light))))
    }
    let counts = scene.counts();
    match (counts.channels, counts.coefficients, counts.weights) {
        (1, 1, 0) => of::<A, Constant<f32>>(scene, sight),
        (1, 1, _) => of::<A, Increment<f32>>(scene, sight),
        (1, ..) => of::<A, Linear<f32>>(scene, sight),
        (_, 1, 0) => of::<A, Constant<Rgb>>(scene, sight),
        (_, 1, _) => of::<A, Increment<Rgb>>(scene, sight),
        _ => of::<A, Linear<Rgb>>(scene, sight),
    }
}

/// Loads tables that were baked for a rung and solves them until `stop`.
///
/// # Errors
/// Those of [`Scene::load`] and [`Light::new`].
pub fn solve(
    tables: &Tables,
    rung: impl Into<FormFactorRung>,
    sight: Sight,
    stop: Stop,
) -> Result<Solution<'_>, Error> {
    let mut from = Origin {
        scene: Scene::EMPTY,
        sight: Sight::None,
        light: None,
    };
    let mut light = match rung.into() {
        FormFactorRung::Float(rung) => {
            let scene = Scene::load(tables.bytes())?;
            from.scene = Scene::load(tables.computed().bytes())?;
            if from.scene.counts().occluders > 0 {
                from.sight = sight;
            }
            with_rung!(rung, Kernel => {
                if scene.counts().responses > 0 {
                    from.light = Some(dark::<Kernel>(from.scene, from.sight)?);
                }
                dark::<Kernel>(scene, from.sight)?
            })
        }
        integer => {
            // What was written down is not to be asked at other places.
            if tables.counts.coefficients > 1 {
                from.scene = Scene::load(tables.computed().bytes())?;
                if from.scene.counts().occluders > 0 {
                    from.sight = sight;
                }
            }
            match integer {
                FormFactorRung::Q24 => integers::dark::<Q24>(tables.bytes())?,
                _ => integers::dark::<Q29>(tables.bytes())?,
            }
        }
    };
    let solved = light.solve(stop);
    if let Some(light) = &mut from.light {
        light.solve(stop);
    }
    Ok(Solution {
        light,
        from,
        solved,
    })
}

/// A resampled surface.
#[derive(Clone, Debug)]
pub struct Grid {
    /// Irradiance row by row, row 0 at v = 0.
    pub values: Vec<Channels>,
    /// The words of the values, one a channel, as the device has them.
    pub bits: Vec<u32>,
    /// Places that had no sample within the filter's radius.
    pub out_of_reach: u32,
}

impl Solution<'_> {
    /// 1 or 3.
    pub fn channels(&self) -> usize {
        self.light.channels()
    }

    /// The words of every sample's irradiance, one a channel, as the device has
    /// them.
    pub fn irradiance_bits(&self) -> Vec<u32> {
        self.light.irradiance_bits()
    }

    /// Irradiance of every sample, in the order of the tables.
    pub fn irradiance(&self) -> Vec<Channels> {
        self.light.irradiance()
    }

    /// Sets the radiance of a luminaire, of those in the order of the scene; no light
    /// changes before [`update`](Self::update).
    ///
    /// # Errors
    /// Those of [`Light::set_radiance`], and of
    /// [`integers`](isolux::integers::Light::set_radiance), of which the first channel
    /// counts.
    pub fn set_radiance(&mut self, luminaire: usize, radiance: Channels) -> Result<(), Error> {
        if let Some(light) = &mut self.from.light {
            light.set_radiance(luminaire, radiance)?;
        }
        self.light.set_radiance(luminaire, radiance)
    }

    /// Shoots what has changed, until `stop`.
    pub fn update(&mut self, stop: Stop) {
        if let Some(light) = &mut self.from.light {
            light.update(stop);
        }
        self.solved = self.light.update(stop);
    }

    /// Irradiance at the scene's named points, as the device reports it.
    pub fn points(&self) -> Vec<Channels> {
        self.light.points()
    }

    /// Mean radiosity that an emitter has shot.
    pub fn radiosity(&self, emitter: usize) -> Channels {
        self.light.radiosity(emitter)
    }

    /// Irradiance at places with their normals, evaluated from the emitters.
    ///
    /// # Errors
    /// [`Error::Receiver`] for a place or normal that is none.
    pub fn at(&self, receivers: &[([f32; 3], [f32; 3])]) -> Result<Vec<At>, Error> {
        let light = self.from.light.as_ref().unwrap_or(&self.light);
        light.at(&self.from, receivers)
    }

    /// What every one of some emitters gives to places with their normals, as the
    /// mean of its channels: by place, then by emitter. With a sight of
    /// [`Sight::None`] as if nothing were in the way.
    ///
    /// # Errors
    /// [`Error::Receiver`] for a place or normal that is none.
    pub fn terms(
        &self,
        receivers: &[([f32; 3], [f32; 3])],
        emitters: Range<usize>,
        sight: Sight,
    ) -> Result<Vec<Vec<f32>>, Error> {
        let light = self.from.light.as_ref().unwrap_or(&self.light);
        light.terms(&self.from, receivers, emitters, sight)
    }

    /// Irradiance resampled at (u, v), metres in the frame of a surface; `None`
    /// for a surface without samples.
    ///
    /// # Errors
    /// [`Error::Unknown`] where there is no such surface.
    pub fn resampled(&self, surface: usize, place: [f32; 2]) -> Result<Option<Channels>, Error> {
        self.light.resampled(surface, place)
    }

    /// A surface resampled on `resolution` × `resolution` cells of its bounding
    /// rectangle.
    ///
    /// # Errors
    /// [`Error::Unknown`] where there is no such surface.
    pub fn resample(&self, surface: usize, resolution: u32) -> Result<Grid, Error> {
        let (cells, channels) = ((resolution * resolution) as usize, self.channels());
        let (mut values, mut bits) = (vec![[0.0; 3]; cells], vec![0; cells * channels]);
        let columns = resolution.max(1) as usize;
        let rows = values
            .par_chunks_mut(columns)
            .zip(bits.par_chunks_mut(columns * channels))
            .enumerate();
        let out_of_reach = rows
            .map(|(row, (out, bits))| {
                let grid = [resolution; 2];
                self.light.row(surface, grid, row as u32, out, bits)
            })
            .collect::<Result<Vec<u32>, Error>>()?
            .into_iter()
            .sum();
        Ok(Grid {
            values,
            bits,
            out_of_reach,
        })
    }
}
