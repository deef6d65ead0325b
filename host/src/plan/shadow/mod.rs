//! The shadows of one luminaire on one surface: where they begin and end,
//! exactly, and meshes that follow them.
//!
//! A place of the receiver sees all of the luminaire, a part of it or nothing.
//! Its visible fraction V = F_visible / F is smooth but on the critical lines
//! (Heckbert 1992; Drettakis & Fiume 1994), which a [`ShadowMap`] holds: V is
//! continuous across all of them except the foot of what stands on the
//! receiver, where it jumps. A [`Mesh`] has these lines as edges, so that V can
//! be interpolated within its triangles, with V = 1 and V = 0 known beforehand
//! on the outlines.
//!
//! Everything is in metres in the receiver's [`Frame`](crate::scene::frame::Frame). Nothing of it is
//! random, parallel in an order that shows, or hashed: the same scene gives the
//! same lines.
//!
//! # Which lines
//!
//! * vertices of the luminaire on edges of an occluder and the reverse; the
//!   penumbra's outer outline, the umbra's and the antumbra's are among them;
//! * the planes of an occluder's faces, where its near side gives way to its
//!   far side;
//! * vertices of an occluder on edges of another one, before the luminaire;
//! * the luminaire's own plane.
//!
//! A line counts only where its sight lines reach the luminaire (exactly: each
//! occluder hides an interval), and where V bends or curves across it by more
//! than 1e-9 at a thousandth of the surface's size.
//!
//! What is left out: the curved events of three edges (one of the luminaire,
//! two of different occluders). Within the penumbras of two bodies V's second
//! derivatives may jump along them; in rooms crowded with random bodies that is
//! every twentieth jump, in the shipped scenes none.

mod arrangement;
mod cast;
mod events;
mod floor;
mod locate;
mod mesh;
mod refine;
mod setting;
mod significance;

use std::fmt;

use glam::DVec2;
use rayon::prelude::*;

use crate::occlusion::TooLarge;
use crate::reference::{self, Looked, Lookout};
use crate::scene::Scene;
pub use cast::Shadow;
use events::Event;
pub use floor::Floor;
pub use mesh::{Border, Lines, Mesh, Options, Tag};
use setting::Setting;

/// What a line is, the most important first.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Kind {
    /// The outline of the surface.
    Boundary,
    /// The foot of what stands on the surface: V jumps.
    Contact,
    /// Where the luminaire's plane cuts the surface: no light behind it.
    Horizon,
    /// The outer outline of an occluder's penumbra.
    Outer,
    /// The outline of an occluder's umbra.
    Umbra,
    /// The outline of the region that sees an occluder wholly within the
    /// luminaire.
    Antumbra,
    /// In the plane of an occluder's face, which is seen edge on before the
    /// luminaire: V bends.
    Face,
    /// A vertex of the luminaire on an edge of an occluder, or the reverse.
    Event,
    /// A vertex of an occluder on an edge of another one.
    Overlap,
}

/// A critical line, a segment.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Line {
    /// What it is.
    pub kind: Kind,
    /// Both ends.
    pub ends: [[f64; 2]; 2],
    /// How much V departs from a smooth function across the line, at a
    /// thousandth of the surface's size; 0 where that is not asked (boundary,
    /// contact and horizon).
    pub strength: f64,
}

/// A segment that may be a line.
type Candidate = (Kind, [DVec2; 2]);

impl Line {
    /// Whether it is the next piece of the same segment.
    fn continues(&self, before: &Self) -> bool {
        let [a, b] = before.ends.map(DVec2::from);
        let [c, d] = self.ends.map(DVec2::from);
        let (one, other) = (b - a, d - c);
        let straight = one.perp_dot(other).abs() <= 1e-9 * one.length() * other.length();
        self.kind == before.kind && b == c && straight && one.dot(other) > 0.0
    }

    /// Its strength times its length: how much it matters among its kind.
    pub(super) fn weight(&self) -> f64 {
        let [a, b] = self.ends.map(DVec2::from);
        self.strength * a.distance(b)
    }
}

/// The parts of an event that may matter.
fn seen(setting: &Setting, event: Event) -> Vec<Candidate> {
    let candidate = |event: Event| (event.kind, event.ends);
    let (kind, ends) = candidate(event);
    let seen: Vec<Candidate> = event.seen(setting).into_iter().map(candidate).collect();
    if event.is_broad() && seen != [(kind, ends)] {
        return pieces(kind, ends);
    }
    seen
}

/// A segment in pieces that matter or not each by itself: of what hides it all
/// is not known.
fn pieces(kind: Kind, [a, b]: [DVec2; 2]) -> Vec<Candidate> {
    const PIECES: usize = 8;
    let at = |k: usize| a.lerp(b, k as f64 / PIECES as f64);
    (0..PIECES).map(|k| (kind, [at(k), at(k + 1)])).collect()
}

/// What a place sees of the luminaire.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Class {
    /// All of it that is above the horizon.
    Lit,
    /// Some of it.
    Penumbra,
    /// Nothing, behind occluders.
    Umbra,
    /// Nothing: the place is on or behind the luminaire's plane, or the
    /// luminaire is behind the receiver.
    Behind,
}

/// A shadow map could not be made.
#[derive(Clone, Debug)]
pub enum Error {
    /// A polygon has no convex parts.
    Outline(reference::Error),
    /// Too many vertices.
    TooLarge(TooLarge),
}

impl fmt::Display for Error {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Outline(error) => error.fmt(formatter),
            Self::TooLarge(error) => error.fmt(formatter),
        }
    }
}

impl std::error::Error for Error {}

/// The critical lines of one luminaire on one surface.
pub struct ShadowMap {
    /// The surface.
    pub floor: Floor,
    /// One for each occluder that hides something from some place of the
    /// surface's bounding rectangle.
    pub shadows: Vec<Shadow>,
    /// The lines within the surface, without its outline and what is
    /// [`contact`](Floor::contacts); the most important first.
    pub lines: Vec<Line>,
    /// Segments that were found but do not matter to V.
    pub dropped: usize,
    lookout: Lookout,
}

impl ShadowMap {
    /// The map of a surface for a luminaire, both by index.
    ///
    /// Costs some tens of looks at the luminaire (10 µs to 50 µs each) a line.
    ///
    /// # Errors
    /// [`Error`] where a polygon has no convex parts, or there are too many
    /// vertices.
    pub fn of(scene: &Scene, receiver: usize, luminaire: usize) -> Result<Self, Error> {
        let floor = Floor::of(scene, receiver)?;
        let setting = Setting::new(scene, &floor.frame, luminaire).map_err(Error::TooLarge)?;
        let lookout = Lookout::new(scene, luminaire).map_err(Error::Outline)?;
        let mut map = Self {
            floor,
            shadows: Vec::new(),
            lines: Vec::new(),
            dropped: 0,
            lookout,
        };
        let candidates = map.cast(&setting);
        map.keep(&setting, candidates);
        Ok(map)
    }

    /// Finds the shadows, and all segments within the surface that may matter.
    fn cast(&mut self, setting: &Setting) -> Vec<Candidate> {
        let size = DVec2::new(self.floor.frame.size_u, self.floor.frame.size_v);
        let margin = 1e-3 * size;
        let bounds = [-margin, size + margin];
        let mut casting = Vec::new();
        let mut events = Vec::new();
        let mut candidates = Vec::new();
        if setting.light.apexes.is_empty() {
            return candidates;
        }
        for occluder in &setting.occluders {
            if let Some(shadow) = Shadow::new(setting, occluder, bounds) {
                events.extend(events::of_occluder(setting, occluder, &shadow));
                let faces = events::of_faces(setting, occluder).into_iter();
                let within = faces.flat_map(|[a, b]| {
                    let parts = self.floor.within([a, b]).into_iter();
                    parts.flat_map(move |part| pieces(Kind::Face, part.map(|t| a.lerp(b, t))))
                });
                candidates.extend(within);
                casting.push((occluder, shadow));
            }
        }
        for (i, (first, shadow)) in casting.iter().enumerate() {
            for (second, other) in &casting[i + 1..] {
                if shadow.meets(other) {
                    events.extend(events::of_pair(setting, first, second));
                }
            }
        }
        self.shadows = casting.into_iter().map(|(_, shadow)| shadow).collect();
        let seen = events.into_par_iter().flat_map_iter(|event| {
            let parts = self.floor.within(event.ends).into_iter();
            let parts = parts.map(|part| event.part(part));
            parts
                .flat_map(|part| seen(setting, part))
                .collect::<Vec<_>>()
        });
        let seen: Vec<Candidate> = seen.collect();
        candidates.extend(seen);
        candidates
    }

    /// Keeps those segments that matter, and the horizon.
    fn keep(&mut self, setting: &Setting, candidates: Vec<Candidate>) {
        let found = candidates.len();
        let shortest = self.floor.resolution();
        let measured = candidates.into_par_iter().map(|(kind, ends)| {
            let [a, b] = ends;
            let long = a.distance(b) > shortest;
            let strength = long.then(|| significance::of(self, ends)).flatten()?;
            let ends = ends.map(Into::into);
            Some(Line {
                kind,
                ends,
                strength,
            })
        });
        let measured: Vec<Option<Line>> = measured.collect();
        let mut lines: Vec<Line> = Vec::new();
        let mut kept = 0;
        for line in measured.into_iter().flatten() {
            kept += 1;
            match lines.last_mut() {
                Some(last) if line.continues(last) => {
                    last.ends[1] = line.ends[1];
                    last.strength = last.strength.max(line.strength);
                }
                _ => lines.push(line),
            }
        }
        self.dropped = found - kept;
        let middle = DVec2::new(self.floor.frame.size_u, self.floor.frame.size_v) / 2.0;
        if let Some([a, b]) = cast::horizon(&setting.light, middle, setting.far) {
            lines.extend(self.floor.within([a, b]).into_iter().map(|part| Line {
                kind: Kind::Horizon,
                ends: part.map(|t| a.lerp(b, t).into()),
                strength: 0.0,
            }));
        }
        lines.sort_by(|a, b| {
            let by_kind = a.kind.cmp(&b.kind);
            by_kind.then(b.weight().total_cmp(&a.weight()))
        });
        self.lines = lines;
    }

    /// What the luminaire gives to a place of the surface's plane.
    pub fn look(&self, u: f64, v: f64) -> Looked {
        let frame = &self.floor.frame;
        self.lookout.look(frame.to_world(u, v), frame.normal)
    }

    /// The visible fraction V; `None` where even without occluders there is no
    /// light.
    pub fn fraction(&self, u: f64, v: f64) -> Option<f64> {
        self.look(u, v).fraction()
    }

    /// What a place sees.
    pub fn class(&self, u: f64, v: f64) -> Class {
        let looked = self.look(u, v);
        match (looked.whole > 0.0, looked.is_whole, looked.is_hidden) {
            (false, ..) => Class::Behind,
            (_, true, _) => Class::Lit,
            (_, _, true) => Class::Umbra,
            _ => Class::Penumbra,
        }
    }
}
