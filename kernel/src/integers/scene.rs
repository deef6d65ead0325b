//! The baked scene in integers: tables borrowed from flash, checked once.

use super::check;
use super::tables::{Emitter, Header, Loop, MAGIC, Surface, VERSION, required_bytes};
use crate::Error;
use crate::error::What;
use crate::form_factor::fixed_point::{Format, Plane, Receiver, Scale, of_loops};
use crate::scene::records::Counts;
use crate::scene::{check as common, section, slice};

/// A checked scene, borrowed from its tables. Copying it copies a few slices.
#[derive(Clone, Copy, Debug)]
pub struct Scene<'t> {
    header: &'t Header,
    surfaces: &'t [Surface],
    reflectances: &'t [u32],
    emitters: &'t [Emitter],
    exitances: &'t [u32],
    loops: &'t [Loop],
    vertices: &'t [[i32; 3]],
    samples: &'t [[i32; 2]],
    members: &'t [u16],
}

/// The largest coordinate of a receiver of its own: eight times that of any
/// scene the bake writes.
const REACH: i64 = 1 << 32;

/// Bits by which the finest scale that [`REACH`] leaves is finer than the
/// tables'.
const FINER: u32 = 25;

/// The plane of an emitter, as its receivers need it.
pub(super) struct Front {
    plane: Plane,
    normal: [i32; 3],
    point: [i32; 3],
    tolerance: i64,
}

impl Front {
    /// Whether a receiver lies in the plane and faces the same way: within the
    /// scene's tolerance the two cannot see each other, and rounding must not
    /// decide it.
    #[inline]
    fn is_of<F: Format>(&self, receiver: &Receiver<F>) -> bool {
        /// 0.99999, as among floats: 0.26°.
        const PARALLEL: i64 = (1 << 30) - 10_737;
        let normal = receiver.normal();
        let words = [normal.x, normal.y, normal.z].map(Format::to_bits);
        if product(self.normal, words.map(i64::from)) <= PARALLEL << F::FRACTION {
            return false;
        }
        let [x, y, z] = receiver.position();
        let to = [
            x.wrapping_sub(self.point[0].into()),
            y.wrapping_sub(self.point[1].into()),
            z.wrapping_sub(self.point[2].into()),
        ];
        // Receivers reach 2^32, so that this has less than 63 bits once halved.
        let height = product(self.normal, to.map(|x| x >> 2)) >> 28;
        height <= self.tolerance
    }
}

#[inline(always)]
fn product(a: [i32; 3], b: [i64; 3]) -> i64 {
    let each = |a: i32, b: i64| i64::from(a).wrapping_mul(b);
    each(a[0], b[0])
        .wrapping_add(each(a[1], b[1]))
        .wrapping_add(each(a[2], b[2]))
}

impl<'t> Scene<'t> {
    /// No scene at all.
    pub const EMPTY: Self = Self {
        header: &Header::EMPTY,
        surfaces: &[],
        reflectances: &[],
        emitters: &[],
        exitances: &[],
        loops: &[],
        vertices: &[],
        samples: &[],
        members: &[],
    };

    /// Reads and checks baked tables in place; nothing is copied.
    ///
    /// Time: in proportion to the length. Never panics.
    ///
    /// # Errors
    /// Every variant of [`Error`] that speaks of tables.
    pub fn load(tables: &'t [u8]) -> Result<Self, Error> {
        let required = |header: &Header| required_bytes(&header.counts);
        let (header, rest) = common::header(tables, &MAGIC, VERSION, required)?;
        let counts = &header.counts;
        let (surfaces, rest) = section::<Surface>(rest, counts.surfaces)?;
        let (reflectances, rest) = section::<u32>(rest, counts.surfaces)?;
        let (emitters, rest) = section::<Emitter>(rest, counts.emitters)?;
        let (exitances, rest) = section::<u32>(rest, counts.luminaires)?;
        let (loops, rest) = section::<Loop>(rest, counts.loops)?;
        let (vertices, rest) = section::<[i32; 3]>(rest, counts.vertices)?;
        let (samples, rest) = section::<[i32; 2]>(rest, counts.samples)?;
        let (members, _) = section::<u16>(rest, counts.members)?;
        let scene = Self {
            header,
            surfaces,
            reflectances,
            emitters,
            exitances,
            loops,
            vertices,
            samples,
            members,
        };
        check::records(&scene)?;
        Ok(scene)
    }

    /// The head of the tables: counts and units.
    pub fn header(&self) -> &'t Header {
        self.header
    }

    /// How many of everything there are.
    pub fn counts(&self) -> &'t Counts {
        &self.header.counts
    }

    /// The surfaces, in the order of the scene file.
    pub fn surfaces(&self) -> &'t [Surface] {
        self.surfaces
    }

    /// Luminaires, then secondary emitters.
    pub fn emitters(&self) -> &'t [Emitter] {
        self.emitters
    }

    /// All samples, ordered by surface, in the frame of their surface.
    pub fn samples(&self) -> &'t [[i32; 2]] {
        self.samples
    }

    pub(super) fn loops(&self) -> &'t [Loop] {
        self.loops
    }

    pub(super) fn vertices(&self) -> &'t [[i32; 3]] {
        self.vertices
    }

    pub(super) fn members(&self) -> &'t [u16] {
        self.members
    }

    /// One surface.
    ///
    /// # Errors
    /// [`Error::Unknown`] where there is no such surface.
    pub fn surface(&self, index: usize) -> Result<&'t Surface, Error> {
        self.surfaces.get(index).ok_or(Error::Unknown {
            what: What::Surfaces,
            asked: index as u32,
            have: self.surfaces.len() as u32,
        })
    }

    /// Whether an emitter emits by itself.
    pub fn is_luminaire(&self, emitter: usize) -> bool {
        emitter < self.exitances.len()
    }

    /// The emitted radiosity of an emitter in the unit of exitance; 0 for one
    /// that only reflects.
    pub fn exitance(&self, emitter: usize) -> u32 {
        self.exitances.get(emitter).copied().unwrap_or(0)
    }

    /// The diffuse reflectance of a surface in 2⁻³²; 0 where there is no such
    /// surface.
    pub fn reflectance(&self, surface: usize) -> u32 {
        self.reflectances.get(surface).copied().unwrap_or(0)
    }

    /// The samples of a surface, and where they begin among all.
    pub fn samples_of(&self, surface: &Surface) -> (usize, &'t [[i32; 2]]) {
        let first = surface.first_sample;
        let samples = slice(self.samples, first, surface.samples);
        (first as usize, samples)
    }

    /// Indices of the samples whose mean irradiance an emitter reflects; empty
    /// for a luminaire.
    pub fn members_of(&self, emitter: &Emitter) -> &'t [u16] {
        slice(self.members, emitter.first_member, emitter.members)
    }

    /// A receiver at a place in metres, with a normal of any length, both read
    /// by their bits: no floating-point operation. The place is rounded to the
    /// tables' unit of length.
    ///
    /// # Errors
    /// [`Error::Receiver`] where a coordinate is not finite, the normal is 0, or
    /// the place is farther than eight times the scene's largest coordinate.
    pub fn receiver<F: Format>(
        &self,
        position: [f32; 3],
        normal: [f32; 3],
    ) -> Result<Receiver<F>, Error> {
        let finite = |place: [f32; 3]| Scale::of(place).ok_or(Error::Receiver);
        finite(position)?;
        let normal = finite(normal)?.place(normal);
        let fine = Scale::with_exponent(self.header.length.saturating_sub(FINER as i32));
        let position = fine.place(position).map(|fine| {
            let halves = fine >> (FINER - 1);
            halves.wrapping_add(1) >> 1
        });
        self.receiver_at(position, normal)
    }

    /// A receiver at a place in the tables' unit of length, with a normal of any
    /// length.
    ///
    /// # Errors
    /// [`Error::Receiver`] as [`receiver`](Self::receiver).
    pub fn receiver_at<F: Format>(
        &self,
        position: [i64; 3],
        normal: [i64; 3],
    ) -> Result<Receiver<F>, Error> {
        if position.iter().any(|x| !(-REACH..=REACH).contains(x)) {
            return Err(Error::Receiver);
        }
        Receiver::new(position, normal)
    }

    /// The form factor of an emitter seen from a receiver, 0 ≤ F ≤ 1; 0 where
    /// the receiver lies in the emitter's plane within the tolerance and faces
    /// the same way.
    ///
    /// Cost and error: [`of_loops`]. Never panics.
    pub fn form_factor<F: Format>(&self, receiver: &Receiver<F>, emitter: &Emitter) -> F {
        self.front(emitter).map_or(F::ZERO, |front| {
            self.form_factor_before(receiver, &front, emitter)
        })
    }

    /// The plane of an emitter: that of its surface.
    pub(super) fn front(&self, emitter: &Emitter) -> Option<Front> {
        let surface = self.surfaces.get(emitter.surface as usize)?;
        Some(Front {
            plane: Plane::new(surface.origin, surface.normal),
            normal: surface.normal,
            point: surface.origin,
            tolerance: self.header.tolerance.into(),
        })
    }

    /// As [`form_factor`](Self::form_factor), with the emitter's plane known.
    #[inline]
    pub(super) fn form_factor_before<F: Format>(
        &self,
        receiver: &Receiver<F>,
        front: &Front,
        emitter: &Emitter,
    ) -> F {
        if front.is_of(receiver) {
            return F::ZERO;
        }
        let vertices = self.vertices;
        let loops = slice(self.loops, emitter.first_loop, emitter.loops).iter();
        let outlines =
            loops.map(move |outline| slice(vertices, outline.first_vertex, outline.vertices));
        of_loops(receiver, &front.plane, outlines)
    }
}
