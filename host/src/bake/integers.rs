//! A plan becomes integer tables, for cores without FPU: what
//! [`isolux::integers`] reads.

mod matrix;

pub use matrix::bake_matrix;

use super::{TOLERANCE, Tables, TooLarge, largest_coordinate};
use crate::plan::{Band, Plan, SurfacePlan};
use crate::scene::requires::requirements;
use crate::scene::{self, Point, Scene};
use glam::DVec3;
use isolux::form_factor::{self, Best, Outline};
use isolux::geometry::{Plane, Receiver};
use isolux::integers::{
    Emitter, Header, LARGEST_SHIFT, Loop, MAGIC, Surface, VERSION, required_bytes,
};
use isolux::number::SoftRoot;
use isolux::scene::records::{Counts, checksum};
use std::f64::consts::PI;
use std::mem::offset_of;
use zerocopy::IntoBytes;

/// Why a plan cannot be baked in integers.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Refused {
    /// The scene is not grey.
    Colour,
    /// The plan's radiosities are linear, not constant.
    Linear,
    /// The plan's emitters are nested, of increments, not means.
    Layers,
    /// The plan's radiosities are constant, and a matrix is of linear ones.
    Constant,
    /// The plan has fields that surfaces are put together from.
    Fields,
    /// A count does not fit the tables.
    TooLarge(TooLarge),
}

impl From<TooLarge> for Refused {
    fn from(error: TooLarge) -> Self {
        Self::TooLarge(error)
    }
}

impl std::fmt::Display for Refused {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Colour => f.write_str("tables in integers hold grey light alone"),
            Self::Linear => {
                f.write_str("tables in integers hold linear radiosities with a matrix alone")
            }
            Self::Layers => f.write_str("tables in integers hold plain means alone"),
            Self::Constant => f.write_str("a matrix in integers is of linear radiosities alone"),
            Self::Fields => f.write_str("surfaces in integers are spread by the cone filter alone"),
            Self::TooLarge(error) => error.fmt(f),
        }
    }
}

impl std::error::Error for Refused {}

/// Bakes a planned scene in which nothing hides anything.
///
/// The units are powers of two: of length, so that the largest coordinate has
/// 29 bits; of irradiance, so that the most that can arrive at a sample,
///
/// ```text
/// E ≤ max_i Σ_luminaires M F_i / (1 − max ρ · max_i Σ_reflectors F_i),
/// ```
///
/// has 30 bits, half of what a word with a sign holds.
///
/// # Errors
/// See [`Refused`].
pub fn bake(scene: &Scene, plan: &Plan) -> Result<Tables, Refused> {
    if requirements(scene).channels > 1 {
        return Err(Refused::Colour);
    }
    if plan.is_linear() {
        return Err(Refused::Linear);
    }
    if plan.is_layered() {
        return Err(Refused::Layers);
    }
    let planned = Shooters::new(scene, plan);
    let units = Units::new(scene, plan, &planned);
    let mut content = Content {
        coefficients: 1,
        ..Content::default()
    };
    for (surface, plan) in scene.surfaces.iter().zip(&plan.surfaces) {
        content.surface(&units, surface, plan);
    }
    for point in &scene.points {
        content.point(&units, point);
    }
    let largest = planned.largest_area();
    for shooter in &planned.0 {
        content.shooter(&units, shooter, largest)?;
    }
    let tolerance = units.length(TOLERANCE * largest_coordinate(scene));
    Ok(content.into_tables(tolerance, &units)?)
}

/// What shoots light, in double precision: luminaires first.
struct Shooter<'a> {
    surface: usize,
    loops: Vec<Vec<DVec3>>,
    area: f64,
    /// Emitted radiosity; `None` for what only reflects.
    exitance: Option<f64>,
    /// Samples among all, the first of the surface's and those among them.
    members: (usize, &'a [usize]),
}

struct Shooters<'a>(Vec<Shooter<'a>>);

impl<'a> Shooters<'a> {
    fn new(scene: &Scene, plan: &'a Plan) -> Self {
        let surfaces = scene.surfaces.iter().enumerate();
        let emits = |(_, surface): &(usize, &scene::Surface)| surface.emits();
        let mut shooters: Vec<Shooter<'a>> = surfaces
            .filter(emits)
            .map(|(index, surface)| Shooter {
                surface: index,
                loops: vec![surface.vertices.clone()],
                area: surface.area,
                exitance: Some(PI * surface.radiance[0]),
                members: (0, &[]),
            })
            .collect();
        let mut first = 0;
        for (index, planned) in plan.surfaces.iter().enumerate() {
            let bands = planned.bands.iter();
            shooters.extend(bands.map(|band| of_band(index, planned, band, first)));
            first += planned.samples.len();
        }
        Self(shooters)
    }

    fn largest_area(&self) -> f64 {
        let areas = self.0.iter().map(|shooter| shooter.area);
        areas.fold(f64::MIN_POSITIVE, f64::max)
    }

    /// The most that can arrive at a sample in W m⁻².
    fn brightest(&self, scene: &Scene, plan: &Plan) -> f64 {
        let (mut direct, mut reflecting) = (0.0_f64, 0.0_f64);
        for (index, planned) in plan.surfaces.iter().enumerate() {
            for sample in &planned.samples {
                let place = planned.frame.to_world(sample.place[0], sample.place[1]);
                let normal = planned.frame.normal;
                let (from_luminaires, from_reflectors) = self.at(scene, place, normal, Some(index));
                direct = direct.max(from_luminaires);
                reflecting = reflecting.max(from_reflectors);
            }
        }
        for point in &scene.points {
            let (position, normal) = (point.position, point.normal);
            let (from_luminaires, from_reflectors) = self.at(scene, position, normal, None);
            direct = direct.max(from_luminaires);
            reflecting = reflecting.max(from_reflectors);
        }
        let reflectances = scene.surfaces.iter().map(|surface| surface.reflectance[0]);
        // Without occlusion the sum may exceed 1, and the series its bound: then
        // words saturate rather than wrap.
        let kept = (reflectances.fold(0.0, f64::max) * reflecting).min(0.999);
        direct / (1.0 - kept)
    }

    /// What arrives at a place from luminaires in W m⁻², and the form factors of all that
    /// reflects, but for what lies on its own surface.
    fn at(&self, scene: &Scene, place: DVec3, normal: DVec3, surface: Option<usize>) -> (f64, f64) {
        let (mut from_luminaires, mut from_reflectors) = (0.0, 0.0);
        let Ok(receiver) = Receiver::new::<SoftRoot>(place.into(), normal.into()) else {
            return (0.0, 0.0);
        };
        let others = |shooter: &&Shooter<'_>| Some(shooter.surface) != surface;
        for shooter in self.0.iter().filter(others) {
            let factor = shooter.form_factor(&receiver, scene);
            match shooter.exitance {
                Some(exitance) => from_luminaires += exitance * factor,
                None => from_reflectors += factor,
            }
        }
        (from_luminaires, from_reflectors)
    }
}

fn of_band<'a>(surface: usize, planned: &SurfacePlan, band: &'a Band, first: usize) -> Shooter<'a> {
    let vertex = |&sample: &usize| {
        let [u, v] = planned.samples[sample].vertex;
        planned.frame.to_world(u, v)
    };
    let loops = band.loops.iter();
    Shooter {
        surface,
        loops: loops.map(|l| l.iter().map(vertex).collect()).collect(),
        area: band.area.max(0.0),
        exitance: None,
        members: (first, &band.members),
    }
}

impl Shooter<'_> {
    fn form_factor(&self, receiver: &Receiver<f64>, scene: &Scene) -> f64 {
        let surface = &scene.surfaces[self.surface];
        let plane = Plane {
            normal: surface.normal.to_array().into(),
            point: surface.vertices[0].to_array().into(),
        };
        let arrays = self.loops.iter();
        let arrays: Vec<Vec<[f64; 3]>> = arrays
            .map(|outline| outline.iter().map(|v| v.to_array()).collect())
            .collect();
        let outlines = arrays.iter().map(|outline| Outline::new(outline));
        form_factor::of_loops::<Best<SoftRoot>, f64>(receiver, &plane, outlines)
    }
}

/// The powers of two that one is worth in the tables.
struct Units {
    length: i32,
    irradiance: i32,
    shift: i32,
}

impl Units {
    fn new(scene: &Scene, plan: &Plan, shooters: &Shooters<'_>) -> Self {
        let frames = plan.surfaces.iter().map(|planned| &planned.frame);
        // Places on a surface are told from its corner: twice as far at most.
        let farthest = frames
            .map(|frame| {
                let size = frame.size_u.max(frame.size_v) / 2.0;
                frame.origin.abs().max_element().max(size)
            })
            .chain(
                scene
                    .points
                    .iter()
                    .map(|point| point.position.abs().max_element()),
            )
            .fold(largest_coordinate(scene), f64::max);
        let exitances = shooters.0.iter().filter_map(|shooter| shooter.exitance);
        let brightest = exitances.fold(0.0, f64::max);
        Self::of(farthest, brightest, shooters.brightest(scene, plan))
    }

    /// Those for the largest coordinate, exitance and irradiance: both of light have 30
    /// bits, half of what a word with a sign holds.
    fn of(farthest: f64, exitance: f64, irradiance: f64) -> Self {
        let emitted = bits(exitance) - 30;
        let received = match irradiance {
            most if most > 0.0 => bits(most) - 30,
            _ => emitted,
        };
        let shift = (emitted - received).clamp(0, LARGEST_SHIFT as i32);
        Self {
            length: bits(farthest) - 29,
            irradiance: emitted.max(received) - shift,
            shift,
        }
    }

    fn length(&self, metres: f64) -> i32 {
        scaled(metres, self.length) as i32
    }

    fn place(&self, place: DVec3) -> [i32; 3] {
        place.to_array().map(|x| self.length(x))
    }
}

/// The exponent of the smallest power of two above x > 0; 0 for 0.
fn bits(x: f64) -> i32 {
    match x {
        x if x > f64::MIN_POSITIVE => ((x.to_bits() >> 52) & 0x7ff) as i32 - 1022,
        _ => 0,
    }
}

/// x in units of 2^`exponent`, rounded to nearest.
fn scaled(x: f64, exponent: i32) -> f64 {
    (x * 2.0_f64.powi(-exponent)).round()
}

/// A coordinate of a unit vector.
fn direction(v: DVec3) -> [i32; 3] {
    v.to_array().map(|x| scaled(x, -30) as i32)
}

/// Every section, as it grows.
#[derive(Default)]
struct Content {
    coefficients: u32,
    /// Named points: the last of the surfaces.
    points: usize,
    surfaces: Vec<Surface>,
    reflectances: Vec<u32>,
    emitters: Vec<Emitter>,
    exitances: Vec<i32>,
    loops: Vec<Loop>,
    vertices: Vec<[i32; 3]>,
    samples: Vec<[i32; 2]>,
    weights: Vec<[i32; 3]>,
    members: Vec<u16>,
    scales: Vec<u32>,
    fractions: Vec<u16>,
    /// How many terms there are, and the bits of a factor.
    terms: usize,
    bits: u32,
    /// The terms.
    bytes: Vec<u8>,
}

impl Content {
    fn surface(&mut self, units: &Units, surface: &scene::Surface, planned: &SurfacePlan) {
        let frame = &planned.frame;
        let at_least_one = |metres| units.length(metres).max(1);
        self.surfaces.push(Surface {
            origin: units.place(frame.origin),
            axis_u: direction(frame.u),
            axis_v: direction(frame.v),
            normal: direction(frame.normal),
            size: [frame.size_u, frame.size_v].map(at_least_one),
            filter_radius: match planned.samples.is_empty() {
                true => 0,
                false => at_least_one(planned.filter_radius),
            },
            first_sample: self.samples.len() as u32,
            samples: planned.samples.len() as u32,
            direct: 0,
            indirect: 0,
        });
        self.reflectances
            .push(scaled(surface.reflectance[0], -32) as u32);
        let places = planned.samples.iter();
        self.samples
            .extend(places.map(|sample| sample.place.map(|x| units.length(x))));
    }

    /// A named point, as a surface of which its one sample's corner alone counts.
    fn point(&mut self, units: &Units, point: &Point) {
        let normal = point.normal.normalize();
        let (axis_u, axis_v) = normal.any_orthonormal_pair();
        self.surfaces.push(Surface {
            origin: units.place(point.position),
            axis_u: direction(axis_u),
            axis_v: direction(axis_v),
            normal: direction(normal),
            size: [1; 2],
            filter_radius: 1,
            first_sample: self.samples.len() as u32,
            samples: 1,
            direct: 0,
            indirect: 0,
        });
        self.samples.push([0; 2]);
        self.points += 1;
    }

    fn shooter(
        &mut self,
        units: &Units,
        shooter: &Shooter<'_>,
        largest_area: f64,
    ) -> Result<(), TooLarge> {
        let (first, members) = shooter.members;
        self.emitters.push(Emitter {
            surface: shooter.surface as u32,
            first_loop: self.loops.len() as u32,
            loops: shooter.loops.len() as u32,
            first_member: self.members.len() as u32,
            members: members.len() as u32,
            area: scaled(shooter.area / largest_area, -31) as u32,
        });
        if let Some(exitance) = shooter.exitance {
            let exitance = scaled(exitance, units.irradiance + units.shift);
            self.exitances.push(exitance as i32);
        }
        for outline in &shooter.loops {
            self.loops.push(Loop {
                first_vertex: self.vertices.len() as u32,
                vertices: outline.len() as u32,
            });
            let places = outline.iter().map(|&vertex| units.place(vertex));
            self.vertices.extend(places);
        }
        for member in members {
            let sample = u16::try_from(first + member);
            self.members
                .push(sample.map_err(|_| TooLarge { what: "samples" })?);
        }
        Ok(())
    }

    fn into_tables(self, tolerance: i32, units: &Units) -> Result<Tables, TooLarge> {
        let count = |n: usize, what| u32::try_from(n).map_err(|_| TooLarge { what });
        let counts = Counts {
            channels: 1,
            coefficients: self.coefficients,
            surfaces: count(self.surfaces.len() - self.points, "surfaces")?,
            luminaires: count(self.exitances.len(), "luminaires")?,
            emitters: count(self.emitters.len(), "emitters")?,
            loops: count(self.loops.len(), "loops")?,
            vertices: count(self.vertices.len(), "vertices")?,
            samples: count(self.samples.len(), "samples")?,
            members: count(self.members.len(), "members")?,
            weights: count(3 * self.weights.len(), "weights")?,
            fractions: count(self.fractions.len(), "fractions")?,
            points: count(self.points, "points")?,
            terms: count(self.terms, "terms")?,
            bits: self.bits,
            ..Counts::default()
        };
        let header = Header {
            magic: MAGIC,
            version: VERSION,
            bytes: required_bytes(&counts).ok_or(TooLarge { what: "bytes" })?,
            checksum: 0,
            counts,
            length: units.length,
            irradiance: units.irradiance,
            shift: units.shift as u32,
            tolerance,
        };
        let half_words = |all: Vec<u16>| {
            let mut bytes = all.as_bytes().to_vec();
            bytes.resize(bytes.len().next_multiple_of(4), 0);
            bytes
        };
        let (members, fractions) = (half_words(self.members), half_words(self.fractions));
        let sections = [
            header.as_bytes(),
            self.surfaces.as_bytes(),
            self.reflectances.as_bytes(),
            self.emitters.as_bytes(),
            self.exitances.as_bytes(),
            self.loops.as_bytes(),
            self.vertices.as_bytes(),
            self.samples.as_bytes(),
            self.weights.as_bytes(),
            &members,
            self.scales.as_bytes(),
            &fractions,
            &self.bytes,
        ];
        let bytes = sections.concat();
        let mut words = vec![0_u32; bytes.len() / 4];
        words.as_mut_bytes().copy_from_slice(&bytes);
        let field = offset_of!(Header, checksum) / 4;
        words[field] = checksum(words[field + 1..].as_bytes());
        Ok(Tables {
            words,
            counts,
            computed: None,
        })
    }
}
