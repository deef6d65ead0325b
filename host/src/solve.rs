//! The kernel on the host: the same code and the same bits as on the device.
//!
//! Between [`crate::bake`], which makes its tables, and [`crate::compare`],
//! which judges it. Independent samples are spread over the cores; no sum is
//! divided, so no bit depends on how many there are.

mod integers;

use crate::bake::Tables;
use isolux::Error;
use isolux::form_factor::fixed_point::{self, Format, Q24, Q29, Scale};
use isolux::form_factor::{Arithmetic, Best, Libm, Micromath, Poly3, Poly5, Poly8, form_factor};
use isolux::geometry::Receiver;
use isolux::luminance::{Colour, Constant, Linear, Luminance, Rgb};
use isolux::number::Root;
use isolux::scene::Scene;
use isolux::shoot::{Light, Solved, Stop};
use isolux::transfer::{Codes, Pair, Transfer};
use isolux::visibility::records::{Blocker, Occluders, Target};
use isolux::visibility::{Bracket, Capacities, Exact, Looked, Sum, VertexRays, Visibility};
use rayon::prelude::*;

/// The host's square root: an instruction, correctly rounded like every
/// other [`Root`].
#[derive(Clone, Copy, Debug, Default)]
pub struct HostRoot;

impl Root<f32> for HostRoot {
    #[inline]
    fn sqrt(x: f32) -> f32 {
        x.sqrt()
    }
}

/// The arithmetic rungs of this build.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Rung {
    /// [`Libm`].
    Libm,
    /// [`Micromath`].
    Micromath,
    /// [`Poly3`].
    Poly3,
    /// [`Poly5`].
    Poly5,
    /// [`Poly8`].
    Poly8,
    /// [`Best`].
    #[default]
    Best,
}

/// Evaluates an expression with `$kernel` as the kernel's type of a rung.
macro_rules! with_rung {
    ($rung:expr, $kernel:ident => $body:expr) => {
        match $rung {
            Rung::Libm => {
                type $kernel = Libm<HostRoot>;
                $body
            }
            Rung::Micromath => {
                type $kernel = Micromath;
                $body
            }
            Rung::Poly3 => {
                type $kernel = Poly3<HostRoot>;
                $body
            }
            Rung::Poly5 => {
                type $kernel = Poly5<HostRoot>;
                $body
            }
            Rung::Poly8 => {
                type $kernel = Poly8<HostRoot>;
                $body
            }
            Rung::Best => {
                type $kernel = Best<HostRoot>;
                $body
            }
        }
    };
}

impl Rung {
    /// All rungs, in the order of the ladder.
    pub const ALL: [Self; 6] = [
        Self::Libm,
        Self::Micromath,
        Self::Poly3,
        Self::Poly5,
        Self::Poly8,
        Self::Best,
    ];

    /// The rung of a name.
    pub fn named(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|rung| rung.name() == name)
    }

    /// Its name.
    pub fn name(self) -> &'static str {
        match self {
            Self::Libm => "libm",
            Self::Micromath => "micromath",
            Self::Poly3 => "poly3",
            Self::Poly5 => "poly5",
            Self::Poly8 => "poly8",
            Self::Best => "best",
        }
    }

    /// The form factor of a polygon in `f32`, as the device computes it.
    ///
    /// # Errors
    /// [`Error::Receiver`] where position or normal are no receiver.
    pub fn form_factor(
        self,
        position: [f32; 3],
        normal: [f32; 3],
        vertices: &[[f32; 3]],
    ) -> Result<f32, Error> {
        let receiver = Receiver::new::<HostRoot>(position, normal)?;
        Ok(self.form_factor_at(&receiver, vertices))
    }

    /// The form factor of a polygon from a receiver that is one already.
    pub fn form_factor_at(self, receiver: &Receiver<f32>, vertices: &[[f32; 3]]) -> f32 {
        with_rung!(self, Kernel => form_factor::<Kernel, f32>(receiver, vertices))
    }
}

/// What a form factor, and a scene baked for it, can be computed with: the
/// rungs in floating point, and the integer ones.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FormFactorRung {
    /// A rung in floating point, which every scene can be solved with.
    Float(Rung),
    /// [`Q24`].
    Q24,
    /// [`Q29`].
    Q29,
}

impl Default for FormFactorRung {
    fn default() -> Self {
        Rung::default().into()
    }
}

impl From<Rung> for FormFactorRung {
    fn from(rung: Rung) -> Self {
        Self::Float(rung)
    }
}

impl FormFactorRung {
    /// Whether a scene is baked in integers for it.
    pub fn is_integer(self) -> bool {
        !matches!(self, Self::Float(_))
    }

    /// All rungs, in the order of the ladder.
    pub const ALL: [Self; 8] = [
        Self::Float(Rung::Libm),
        Self::Float(Rung::Micromath),
        Self::Float(Rung::Poly3),
        Self::Float(Rung::Poly5),
        Self::Float(Rung::Poly8),
        Self::Float(Rung::Best),
        Self::Q24,
        Self::Q29,
    ];

    /// Its name.
    pub fn name(self) -> &'static str {
        match self {
            Self::Float(rung) => rung.name(),
            Self::Q24 => "q24",
            Self::Q29 => "q29",
        }
    }

    /// The form factor of a polygon as the device computes it, and its bits
    /// there.
    ///
    /// # Errors
    /// Those of [`Rung::form_factor`] and [`fixed_form_factor`].
    pub fn form_factor(
        self,
        position: [f32; 3],
        normal: [f32; 3],
        vertices: &[[f32; 3]],
    ) -> Result<(f64, u32), Error> {
        Ok(match self {
            Self::Float(rung) => {
                let found = rung.form_factor(position, normal, vertices)?;
                (found.into(), found.to_bits())
            }
            Self::Q24 => {
                let found = fixed_form_factor::<Q24>(position, normal, vertices)?;
                (found.into(), found.to_bits() as u32)
            }
            Self::Q29 => {
                let found = fixed_form_factor::<Q29>(position, normal, vertices)?;
                (found.into(), found.to_bits() as u32)
            }
        })
    }

    /// The rung of a name.
    pub fn named(name: &str) -> Option<Self> {
        match name {
            "q24" => Some(Self::Q24),
            "q29" => Some(Self::Q29),
            name => Rung::named(name).map(Self::Float),
        }
    }
}

/// The form factor of a polygon in integers, as a core without FPU computes
/// it; both its scale and everything after are the kernel's.
///
/// # Errors
/// [`Error::Receiver`] where position or normal are no receiver, or a vertex is
/// not finite.
pub fn fixed_form_factor<F: Format>(
    position: [f32; 3],
    normal: [f32; 3],
    vertices: &[[f32; 3]],
) -> Result<F, Error> {
    let places = vertices.iter().flatten().chain(&position);
    let scale = Scale::of(places.copied()).ok_or(Error::Receiver)?;
    let normal = Scale::of(normal).ok_or(Error::Receiver)?.place(normal);
    let receiver = fixed_point::Receiver::<F>::new(scale.place(position), normal)?;
    let vertices: Vec<[i64; 3]> = vertices.iter().map(|&v| scale.place(v)).collect();
    Ok(fixed_point::form_factor(&receiver, &vertices))
}

/// The most samples a solve on the host holds: 64 KiB of state.
const SAMPLES: usize = 1 << 14;

/// The most emitters a solve on the host holds.
const EMITTERS: usize = 1 << 12;

/// The rungs of visibility.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Sight {
    /// Nothing hides anything.
    #[default]
    None,
    /// [`VertexRays`].
    VertexRays,
    /// [`Exact`].
    Exact,
}

impl Sight {
    /// Its name on the ladder.
    pub fn name(self) -> &'static str {
        match self {
            Self::None => "none",
            Self::VertexRays => "vertex-rays",
            Self::Exact => "exact",
        }
    }
}

/// The host's workspace: room for some sixty occluders between one place and
/// one emitter.
type Workspace = Exact<32, 64, 256, 64>;

/// Any rung of visibility, looking from many samples at once. Every sample is
/// looked at by one core and no sum is divided: the bits are those of one after
/// the other. One type for all rungs keeps the program small: what a scene
/// requires is the device's concern.
#[derive(Clone, Debug, Default)]
enum Looking {
    Rays,
    #[default]
    None,
    Exact(Box<Workspace>),
}

impl Looking {
    fn with(sight: Sight) -> Self {
        match sight {
            Sight::None => Self::None,
            Sight::VertexRays => Self::Rays,
            Sight::Exact => Self::Exact(Box::default()),
        }
    }
}

impl Visibility for Looking {
    const CAPACITIES: Capacities = Workspace::CAPACITIES;

    fn form_factor<R: Root<f32> + Copy>(
        &mut self,
        receiver: &Receiver<f32>,
        target: &Target<'_>,
        occluders: &Occluders<'_>,
        blockers: impl Iterator<Item = Blocker>,
        unoccluded: impl FnOnce() -> f32,
    ) -> Bracket<f32> {
        match self {
            Self::None => Bracket::exactly(unoccluded()),
            Self::Rays => {
                VertexRays.form_factor::<R>(receiver, target, occluders, blockers, unoccluded)
            }
            Self::Exact(exact) => Visibility::form_factor::<R>(
                exact.as_mut(),
                receiver,
                target,
                occluders,
                blockers,
                unoccluded,
            ),
        }
    }

    fn look(
        &mut self,
        receiver: &Receiver<f32>,
        target: &Target<'_>,
        occluders: &Occluders<'_>,
        blockers: impl Iterator<Item = Blocker>,
        parts: &mut impl Sum<f32>,
    ) -> Looked<f32> {
        match self {
            Self::None => Looked::Whole,
            Self::Rays => VertexRays.look(receiver, target, occluders, blockers, parts),
            Self::Exact(exact) => exact.look(receiver, target, occluders, blockers, parts),
        }
    }
}

/// Any rung of transfer: codes where the tables have them, else what a look
/// finds. Samples are spread over the cores as [`Looking`] does.
#[derive(Clone, Debug, Default)]
struct Sending {
    sight: Looking,
    coded: bool,
}

impl Transfer for Sending {
    fn fits(scene: &Scene<'_>) -> Result<(), Error> {
        match scene.counts().codes {
            0 => <Looking as Transfer>::fits(scene),
            _ => Codes::fits(scene),
        }
    }

    fn received<A: Arithmetic<f32>, L: Luminance>(
        &mut self,
        scene: &Scene<'_>,
        receiver: &Receiver<f32>,
        pair: Pair,
        radiosity: L,
    ) -> L::Colour {
        match self.coded {
            true => Codes.received::<A, L>(scene, receiver, pair, radiosity),
            false => Transfer::received::<A, L>(&mut self.sight, scene, receiver, pair, radiosity),
        }
    }

    fn each<C: Send>(&mut self, values: &mut [C], value: impl Fn(&mut Self, usize, &mut C) + Sync) {
        spread(self, values, value);
    }
}

/// Sets every value, on all cores where there are enough of them.
fn spread<W: Clone + Send + Sync, C: Send>(
    workspace: &mut W,
    values: &mut [C],
    value: impl Fn(&mut W, usize, &mut C) + Sync,
) {
    /// Samples below which handing out work costs more than it saves.
    const FEW: usize = 64;
    if values.len() < FEW {
        for (index, place) in values.iter_mut().enumerate() {
            value(workspace, index, place);
        }
        return;
    }
    values
        .par_iter_mut()
        .enumerate()
        .with_min_len(FEW / 2)
        .for_each_init(
            || workspace.clone(),
            |workspace, (index, place)| value(workspace, index, place),
        );
}

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
}

/// A solved scene.
pub struct Solution<'t> {
    light: Box<dyn Lit + 't>,
    from: Origin<'t>,
    /// How the solve ended.
    pub solved: Solved,
}

/// [`Light`] with its rung, its channels and capacities out of sight.
trait Lit: Send + Sync {
    fn solve(&mut self, stop: Stop) -> Solved;
    fn channels(&self) -> usize;
    fn irradiance(&self) -> Vec<Channels>;
    fn irradiance_bits(&self) -> Vec<u32>;
    fn at(&self, from: &Origin<'_>, receivers: &[Place]) -> Result<Vec<At>, Error>;
    fn radiosity(&self, emitter: usize) -> Channels;
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

impl<A, L> Lit for Light<'_, A, SAMPLES, EMITTERS, L, Sending>
where
    A: Arithmetic<f32> + Send + Sync,
    L: Luminance<Colour: ToChannels>,
{
    fn solve(&mut self, stop: Stop) -> Solved {
        Light::solve(self, stop)
    }

    fn channels(&self) -> usize {
        L::Colour::CHANNELS
    }

    fn irradiance(&self) -> Vec<Channels> {
        let values = Light::irradiance(self).iter();
        values.map(|value| value.channels()).collect()
    }

    fn irradiance_bits(&self) -> Vec<u32> {
        let values = Light::irradiance(self).iter();
        values.flat_map(|&value| bits(value)).collect()
    }

    fn at(&self, from: &Origin<'_>, receivers: &[Place]) -> Result<Vec<At>, Error> {
        let one = |sight: &mut Looking, &(position, normal): &Place| {
            let receiver = Receiver::new::<HostRoot>(position, normal)?;
            let bracket = self.at_among(&from.scene, &receiver, sight);
            Ok(At {
                value: bracket.middle().channels(),
                is_exact: bracket.is_exact(),
            })
        };
        let sight = || Looking::with(from.sight);
        receivers.par_iter().map_init(sight, one).collect()
    }

    fn radiosity(&self, emitter: usize) -> Channels {
        Light::radiosity(self, emitter).mean().channels()
    }

    fn resampled(&self, surface: usize, place: [f32; 2]) -> Result<Option<Channels>, Error> {
        let filtered = self.resample_at::<HostRoot>(surface, place)?;
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
        let row = self.resample_row::<HostRoot>(surface, grid, row, &mut values)?;
        for (out, &value) in out.iter_mut().zip(&values) {
            *out = value.channels();
        }
        let words = values.into_iter().flat_map(self::bits);
        for (out, word) in bits.iter_mut().zip(words) {
            *out = word;
        }
        Ok(row.out_of_reach)
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
        let sending = Sending {
            sight: Looking::with(sight),
            coded: scene.counts().codes > 0,
        };
        let light = Light::<A, SAMPLES, EMITTERS, L, _>::with_sight(scene, sending)?;
        Ok(Box::new(light))
    }
    let counts = scene.counts();
    match (counts.channels, counts.coefficients) {
        (1, 1) => of::<A, Constant<f32>>(scene, sight),
        (1, _) => of::<A, Linear<f32>>(scene, sight),
        (_, 1) => of::<A, Constant<Rgb>>(scene, sight),
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
    };
    let mut light = match rung.into() {
        FormFactorRung::Float(rung) => {
            let scene = Scene::load(tables.bytes())?;
            from.scene = Scene::load(tables.computed().bytes())?;
            if from.scene.counts().occluders > 0 {
                from.sight = sight;
            }
            with_rung!(rung, Kernel => dark::<Kernel>(scene, from.sight)?)
        }
        FormFactorRung::Q24 => integers::dark::<Q24>(tables.bytes())?,
        FormFactorRung::Q29 => integers::dark::<Q29>(tables.bytes())?,
    };
    let solved = light.solve(stop);
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

    /// Mean radiosity that an emitter has shot.
    pub fn radiosity(&self, emitter: usize) -> Channels {
        self.light.radiosity(emitter)
    }

    /// Irradiance at places with their normals, evaluated from the emitters.
    ///
    /// # Errors
    /// [`Error::Receiver`] for a place or normal that is none.
    pub fn at(&self, receivers: &[([f32; 3], [f32; 3])]) -> Result<Vec<At>, Error> {
        self.light.at(&self.from, receivers)
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
