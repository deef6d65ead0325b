//! What a receiver gets from one emitter.

use super::{Scene, slice};
use crate::form_factor::{self, Arithmetic, Outline, SeenPlane};
use crate::geometry::{Plane, Receiver, Vector};
use crate::luminance::{self, Colour, Luminance, View};
use crate::number::Root;
use crate::scene::records::{Emitter, Shape, Surface};
use crate::visibility::records::{Blocker, Target};
use crate::visibility::{Bracket, Looked, Piece, Sum, Visibility};
use core::marker::PhantomData;

impl<'t> Scene<'t> {
    /// The irradiance in W m⁻² at a receiver from an emitter of this radiosity:
    /// B F of what is seen of it, and for a linear radiosity the B(ā, b̄) F of
    /// [`luminance`](mod@crate::luminance), with (ā, b̄) by the rule there.
    ///
    /// A bracket of two different values where `sight` had to stop early.
    /// Cost: [`Scene::form_factor`], and for a linear radiosity the rule; the rule
    /// alone where a parallelogram is far; with occluders what
    /// [`Visibility`] says. Never panics.
    #[inline]
    pub fn received<A: Arithmetic<f32>, L: Luminance, V: Visibility>(
        &self,
        receiver: &Receiver<f32>,
        index: usize,
        radiosity: L,
        sight: &mut V,
    ) -> Bracket<L::Colour> {
        let point = if V::POINTS {
            self.point_source(index)
        } else {
            None
        };
        match point {
            Some(point) => {
                let parallel = point.is_parallel(receiver.normal());
                let factor = point.factor(receiver, parallel);
                Bracket::exactly(radiosity.received(factor, || [0.0; 2]))
            }
            None => self.received_past::<A, L, V>(receiver, index, radiosity, sight, false),
        }
    }

    /// As [`received`](Self::received) from what is no point; past all occluders where
    /// `unshadowed`. One function for both: two would be twice the code.
    #[inline]
    pub(crate) fn received_past<A: Arithmetic<f32>, L: Luminance, V: Visibility>(
        &self,
        receiver: &Receiver<f32>,
        index: usize,
        radiosity: L,
        sight: &mut V,
        unshadowed: bool,
    ) -> Bracket<L::Colour> {
        let dark = Bracket::exactly(L::Colour::DARK);
        let Some(emitter) = self.emitters.get(index) else {
            return dark;
        };
        let shape = self.shapes.get(index);
        let occluded =
            V::CAPACITIES.occluders && !unshadowed && shape.is_some_and(|shape| shape.blockers > 0);
        if L::COEFFICIENTS == 1 && !occluded {
            let factor = self.form_factor::<A>(receiver, emitter);
            return Bracket::exactly(radiosity.received(factor, || [0.0; 2]));
        }
        let (Some(facing), Some(shape)) = (self.facing(receiver, emitter), shape) else {
            return dark;
        };
        let (origin, axes) = facing.frame(shape);
        let whole = facing.whole(receiver, shape, self.is_luminaire(index));
        let mut total = dark;
        for (outline, corners) in self.loops_of(emitter).zip(self.corners_of(emitter)) {
            if !occluded {
                let (_, value) = whole.received::<A, L>(outline, corners, radiosity);
                total = total.plus(Bracket::exactly(value));
                continue;
            }
            let target = Target {
                origin: origin.into(),
                axes: axes.map(Into::into),
                normal: facing.plane.normal.into(),
                radius: shape.scale,
                corners,
            };
            let mut parts = Received::<A::Root, L> {
                view: &whole.view,
                radiosity,
                low: L::Colour::DARK,
                high: L::Colour::DARK,
                root: PhantomData,
            };
            let blockers = self.blockers_of(shape).iter().copied();
            let looked = sight.look(receiver, &target, &self.occluders, blockers, &mut parts);
            total = total.plus(whole.of::<A, L>(looked, parts, outline, corners, radiosity));
        }
        total
    }

    /// What can hide an emitter.
    fn blockers_of(&self, shape: &Shape) -> &'t [Blocker] {
        slice(self.blockers, shape.first_blocker, shape.blockers)
    }

    /// An emitter's plane, where a receiver is in front of it and not in it.
    #[inline(always)]
    pub(super) fn facing(&self, receiver: &Receiver<f32>, emitter: &Emitter) -> Option<Facing<'t>> {
        let (surface, plane) = self.plane_facing(receiver, emitter)?;
        let height = plane.height(receiver.position());
        (height > 0.0).then_some(Facing {
            surface,
            plane,
            height,
        })
    }

    /// The corners of an emitter's loops, in its own coordinates.
    pub(super) fn corners_of(
        &self,
        emitter: &Emitter,
    ) -> impl Iterator<Item = &'t [[f32; 2]]> + use<'t> {
        let corners = self.corners;
        slice(self.loops, emitter.first_loop, emitter.loops)
            .iter()
            .map(move |outline| slice(corners, outline.first_vertex, outline.vertices))
    }
}

/// An emitter's plane with a receiver in front of it.
pub(super) struct Facing<'t> {
    surface: &'t Surface,
    plane: Plane<f32>,
    /// The receiver's height over it in metres.
    pub(super) height: f32,
}

impl Facing<'_> {
    /// The origin and the axes of an emitter's own coordinates, in metres.
    #[inline(always)]
    fn frame(&self, shape: &Shape) -> (Vector<f32>, [Vector<f32>; 2]) {
        let axes = [&self.surface.axis_u, &self.surface.axis_v];
        (
            self.surface.place(shape.center),
            axes.map(|&axis| Vector::from(axis) * shape.scale),
        )
    }

    /// The form factor of a small area at the centroid of an emitter: A cos θ_r
    /// cos θ_e / (π r²), 0 where the receiver faces away.
    #[inline(always)]
    pub(super) fn point(&self, receiver: &Receiver<f32>, shape: &Shape, area: f32) -> f32 {
        let to = self.surface.place(shape.center) - receiver.position();
        let height = receiver.normal().dot(to);
        if height <= 0.0 {
            return 0.0;
        }
        // Twice by the distance: its square could leave the range.
        let inverse = 1.0 / to.norm_squared();
        (area * core::f32::consts::FRAC_1_PI * self.height * inverse) * (height * inverse)
    }

    #[inline(always)]
    pub(super) fn whole<'a>(
        &'a self,
        receiver: &'a Receiver<f32>,
        shape: &Shape,
        is_luminaire: bool,
    ) -> Whole<'a> {
        let (origin, axes) = self.frame(shape);
        let seen = SeenPlane {
            origin: origin - receiver.position(),
            axes,
            facing: self.plane.normal,
            normal: receiver.normal(),
        };
        Whole {
            receiver,
            plane: &self.plane,
            view: View::new(&seen, shape.scale, self.height),
            is_luminaire,
        }
    }
}

/// An emitter as a receiver in front of its plane sees it.
pub(super) struct Whole<'a> {
    receiver: &'a Receiver<f32>,
    plane: &'a Plane<f32>,
    pub(super) view: View,
    is_luminaire: bool,
}

impl Whole<'_> {
    pub(super) fn form_factor<A: Arithmetic<f32>>(&self, outline: Outline<'_, f32>) -> f32 {
        let outlines = core::iter::once(outline);
        form_factor::of_loops::<A, f32>(self.receiver, self.plane, outlines)
    }

    /// From all of a loop: its form factor, and what is received.
    ///
    /// Of what reflects, and is far, the rule's own form factor will do: the fit
    /// of its radiosity errs by more.
    #[inline]
    fn received<A: Arithmetic<f32>, L: Luminance>(
        &self,
        outline: Outline<'_, f32>,
        corners: &[[f32; 2]],
        radiosity: L,
    ) -> (f32, L::Colour) {
        if L::COEFFICIENTS == 1 || self.is_luminaire {
            let factor = self.form_factor::<A>(outline);
            return (factor, radiosity.received(factor, || [0.0; 2]));
        }
        let moments = self.view.moments(corners);
        let factor = if self.view.is_far() && luminance::is_parallelogram(corners) {
            moments.factor
        } else {
            self.form_factor::<A>(outline)
        };
        let value = radiosity.received(factor, || moments.place(middle(corners)));
        (factor, value)
    }

    /// What is received from what a look found of a loop.
    fn of<A: Arithmetic<f32>, L: Luminance>(
        &self,
        looked: Looked<f32>,
        parts: Received<'_, A::Root, L>,
        outline: Outline<'_, f32>,
        corners: &[[f32; 2]],
        radiosity: L,
    ) -> Bracket<L::Colour> {
        let (low, high) = (parts.low, parts.high);
        match looked {
            Looked::Dark => Bracket::exactly(L::Colour::DARK),
            Looked::Whole => {
                let (_, value) = self.received::<A, L>(outline, corners, radiosity);
                Bracket::exactly(value)
            }
            Looked::Fraction(fraction) => {
                let (_, value) = self.received::<A, L>(outline, corners, radiosity);
                Bracket::exactly(value.times(fraction))
            }
            Looked::Parts if self.is_luminaire => {
                // 0 ≤ F_visible ≤ F exactly: the sum of pieces may exceed the
                // whole by rounding. A radiosity below 0 is light taken away.
                let limit = self.form_factor::<A>(outline);
                let whole = radiosity.received(limit, || [0.0; 2]);
                let within = |x: f32, whole: f32| {
                    let beyond = if whole < 0.0 { x < whole } else { x > whole };
                    if beyond { whole } else { x }
                };
                Bracket {
                    low: low.zip(whole, within),
                    high: high.zip(whole, within),
                }
            }
            Looked::Parts => Bracket { low, high },
            Looked::AtMost => Bracket {
                low: low.map(negative),
                high,
            },
            Looked::Unknown => {
                let (_, value) = self.received::<A, L>(outline, corners, radiosity);
                Bracket {
                    low: value.map(negative),
                    high: value.map(positive),
                }
            }
        }
    }
}

/// What has been received from the parts of one loop.
struct Received<'a, R, L: Luminance> {
    view: &'a View,
    radiosity: L,
    low: L::Colour,
    high: L::Colour,
    root: PhantomData<R>,
}

impl<R, L: Luminance> Received<'_, R, L> {
    /// From one piece.
    #[inline(never)]
    fn of(&self, piece: &Piece<'_, f32>, factor: f32) -> L::Colour {
        self.radiosity.received(factor, || {
            let corners = piece.corners();
            self.view.moments(corners).place(middle(corners))
        })
    }

    fn add(&mut self, value: L::Colour) {
        self.low = self.low.plus(value);
        self.high = self.high.plus(value);
    }
}

impl<R: Root<f32> + Copy, L: Luminance> Sum<f32> for Received<'_, R, L> {
    fn visible(&mut self, piece: &Piece<'_, f32>) {
        self.add(self.of(piece, piece.form_factor::<R>()));
    }

    /// Anything between nothing and this piece.
    fn unresolved(&mut self, piece: &Piece<'_, f32>) {
        let value = self.of(piece, piece.form_factor::<R>());
        self.low = self.low.plus(value.map(negative));
        self.high = self.high.plus(value.map(positive));
    }

    fn difference(&mut self, piece: &Piece<'_, f32>, hidden: &Piece<'_, f32>) -> bool {
        let all = piece.form_factor::<R>();
        let part = hidden.form_factor::<R>();
        let clear = part < 0.75 * all;
        if clear {
            self.add(self.of(piece, all).zip(self.of(hidden, part), |a, b| a - b));
        }
        clear
    }
}

fn negative(x: f32) -> f32 {
    if x < 0.0 { x } else { 0.0 }
}

fn positive(x: f32) -> f32 {
    if x > 0.0 { x } else { 0.0 }
}

/// The mean of the corners.
pub(super) fn middle(corners: &[[f32; 2]]) -> [f32; 2] {
    let (mut sum, mut count) = ([0.0; 2], 0.0);
    for [a, b] in corners {
        sum = [sum[0] + a, sum[1] + b];
        count += 1.0;
    }
    if count > 0.0 {
        sum.map(|x| x / count)
    } else {
        sum
    }
}
