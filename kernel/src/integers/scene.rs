//! The baked scene in integers: tables borrowed from flash, checked once.

use super::check;
use super::tables::{Emitter, Header, Loop, MAGIC, Surface, VERSION, required_bytes};
use crate::Error;
use crate::error::What;
use crate::form_factor::fixed_point::{Format, Plane, Receiver, Scale, of_loops};
use crate::scene::records::Counts;
use crate::scene::{Term, check as common, even, matrix, receiving, section, slice};
use core::ops::Range;

/// A checked scene, borrowed from its tables. Copying it copies a few slices.
#[derive(Clone, Copy, Debug)]
pub struct Scene<'t> {
    header: &'t Header,
    surfaces: &'t [Surface],
    reflectances: &'t [u32],
    emitters: &'t [Emitter],
    exitances: &'t [i32],
    loops: &'t [Loop],
    vertices: &'t [[i32; 3]],
    samples: &'t [[i32; 2]],
    weights: &'t [[i32; 3]],
    members: &'t [u16],
    scales: &'t [u32],
    fractions: &'t [u16],
    terms: &'t [u8],
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
        weights: &[],
        members: &[],
        scales: &[],
        fractions: &[],
        terms: &[],
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
        let (surfaces, rest) = section::<Surface>(rest, receiving(counts))?;
        let (reflectances, rest) = section::<u32>(rest, counts.surfaces)?;
        let (emitters, rest) = section::<Emitter>(rest, counts.emitters)?;
        let (exitances, rest) = section::<i32>(rest, counts.luminaires)?;
        let (loops, rest) = section::<Loop>(rest, counts.loops)?;
        let (vertices, rest) = section::<[i32; 3]>(rest, counts.vertices)?;
        let (samples, rest) = section::<[i32; 2]>(rest, counts.samples)?;
        let weighted = if counts.weights > 0 {
            counts.members
        } else {
            0
        };
        let (weights, rest) = section::<[i32; 3]>(rest, weighted)?;
        let (members, rest) = section::<u16>(rest, even(counts.members))?;
        let (scales, rest) = section::<u32>(rest, matrix::scales(counts))?;
        let (fractions, rest) = section::<u16>(rest, even(counts.fractions))?;
        let bytes = u32::try_from(matrix::bytes(counts)).unwrap_or(u32::MAX);
        let (terms, _) = section::<u8>(rest, bytes)?;
        let scene = Self {
            header,
            surfaces,
            reflectances,
            emitters,
            exitances,
            loops,
            vertices,
            samples,
            weights,
            members: slice(members, 0, counts.members),
            scales,
            fractions: slice(fractions, 0, counts.fractions),
            terms,
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
        slice(self.surfaces, 0, self.header.counts.surfaces)
    }

    /// The named points, in the order of the scene file: the place is the origin.
    pub fn points(&self) -> &'t [Surface] {
        let counts = &self.header.counts;
        slice(self.surfaces, counts.surfaces, counts.points)
    }

    /// Surfaces and named points: all that has samples.
    pub(super) fn receiving(&self) -> &'t [Surface] {
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

    pub(super) fn exitances(&self) -> &'t [i32] {
        self.exitances
    }

    /// Which of all samples receive, on one surface or named point, from luminaires or from
    /// what reflects.
    #[inline]
    pub fn receivers(&self, surface: &Surface, is_luminaire: bool) -> Range<usize> {
        let first = surface.first_sample as usize;
        let end = first.saturating_add(surface.samples as usize);
        if is_luminaire {
            first..end.saturating_sub(surface.indirect as usize)
        } else {
            first.saturating_add(surface.direct as usize)..end
        }
    }

    /// The scales of the terms, one a receiver.
    pub(super) fn scales(&self) -> &'t [u32] {
        self.scales
    }

    /// The terms, and which of them is that of an emitter for a receiver, counted among
    /// all samples that receive reflected light.
    #[inline(always)]
    pub(super) fn terms(&self, emitter: usize, receiver: u32) -> (u32, &'t [u8]) {
        let nth = (emitter as u32).wrapping_sub(self.header.counts.luminaires);
        let before = nth.wrapping_mul(self.scales.len() as u32);
        (before.wrapping_add(receiver), self.terms)
    }

    /// The terms of an emitter for a receiver and those that follow it, without their
    /// scales. Cost: some 20 instructions a term; the kernel itself reads them otherwise.
    pub fn terms_of(&self, emitter: usize, receiver: u32) -> impl Iterator<Item = Term> + use<'t> {
        let (first, terms) = self.terms(emitter, receiver);
        let bits = self.header.counts.bits;
        (first..).map_while(move |index| {
            // A word can be read wherever a term begins.
            let at = u64::from(index).wrapping_mul(u64::from(bits) << 1);
            let word = terms.get((at >> 3) as usize..)?.first_chunk()?;
            Some(Term::of(bits, u32::from_le_bytes(*word) >> (at & 7)))
        })
    }

    /// The parts of a luminaire's form factor that receivers see, from this one on, counted
    /// among all samples that receive direct light; in 65 535ths. Empty where all of them
    /// see all.
    #[inline(always)]
    pub(super) fn fractions(&self, luminaire: usize, receiver: u32) -> &'t [u16] {
        let luminaires = self.header.counts.luminaires;
        let receivers = self.header.counts.fractions.checked_div(luminaires);
        let before = (luminaire as u32).wrapping_mul(receivers.unwrap_or(0));
        let first = before.wrapping_add(receiver) as usize;
        self.fractions.get(first..).unwrap_or(&[])
    }

    /// One surface.
    ///
    /// # Errors
    /// [`Error::Unknown`] where there is no such surface.
    pub fn surface(&self, index: usize) -> Result<&'t Surface, Error> {
        let surfaces = self.surfaces();
        surfaces.get(index).ok_or(Error::Unknown {
            what: What::Surfaces,
            asked: index as u32,
            have: surfaces.len() as u32,
        })
    }

    /// Whether an emitter emits by itself.
    pub fn is_luminaire(&self, emitter: usize) -> bool {
        emitter < self.exitances.len()
    }

    /// The emitted radiosity of an emitter in the unit of exitance; 0 for one
    /// that only reflects.
    pub fn exitance(&self, emitter: usize) -> i32 {
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

    /// Indices of the samples whose irradiance an emitter reflects; empty for a
    /// luminaire.
    pub fn members_of(&self, emitter: &Emitter) -> &'t [u16] {
        slice(self.members, emitter.first_member, emitter.members)
    }

    /// What these weigh in the coefficients of a linear radiosity; empty where it is
    /// their mean.
    pub(super) fn weights_of(&self, emitter: &Emitter) -> &'t [[i32; 3]] {
        slice(self.weights, emitter.first_member, emitter.members)
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
        of_loops(receiver, &front.plane, self.loops_of(emitter))
    }

    /// The loops of an emitter's polygon: pieces counter-clockwise, holes clockwise.
    #[inline(always)]
    pub fn loops_of(&self, emitter: &Emitter) -> impl Iterator<Item = &'t [[i32; 3]]> + use<'t> {
        let vertices = self.vertices;
        let loops = slice(self.loops, emitter.first_loop, emitter.loops).iter();
        loops.map(move |outline| slice(vertices, outline.first_vertex, outline.vertices))
    }
}
