//! Convex polygons in an emitter's plane, and their cut in two.

use super::line::{Line, unit_roundoff};
use crate::number::Floating;
use heapless::Vec;

/// A convex polygon of at most `VERTICES` corners, counter-clockwise.
#[derive(Clone, Debug)]
pub(super) struct Polygon<N, const VERTICES: usize> {
    corners: Vec<[N; 2], VERTICES>,
    /// The corner at which the edge along the horizon begins.
    horizon: Option<u8>,
    /// Nothing has been cut off but by the horizon.
    uncut: bool,
}

/// On which side of a line a polygon is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Side {
    /// No corner is outside.
    Inside,
    /// No corner is inside, some are outside.
    Outside,
    /// All corners are on the line: the polygon has no width.
    On,
    /// Some are, some are not.
    Both,
}

impl Side {
    #[inline(always)]
    fn of(any_inside: bool, any_outside: bool) -> Self {
        match (any_inside, any_outside) {
            (false, false) => Self::On,
            (false, true) => Self::Outside,
            (true, false) => Self::Inside,
            (true, true) => Self::Both,
        }
    }
}

/// A part has more corners than its buffer.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Full;

impl<N: Floating, const VERTICES: usize> Polygon<N, VERTICES> {
    /// A polygon without corners.
    pub(super) const fn new() -> Self {
        Self {
            corners: Vec::new(),
            horizon: None,
            uncut: false,
        }
    }

    /// Becomes the polygon with these corners.
    pub(super) fn set(&mut self, corners: impl Iterator<Item = [N; 2]>) -> Result<(), Full> {
        self.clear();
        for corner in corners {
            self.corners.push(corner).map_err(|_| Full)?;
        }
        self.uncut = true;
        Ok(())
    }

    /// Becomes a copy.
    #[cfg_attr(feature = "small", inline(never))]
    #[cfg_attr(not(feature = "small"), inline)]
    pub(super) fn copy_from(&mut self, other: &Self) {
        self.corners.clone_from(&other.corners);
        self.horizon = other.horizon;
        self.uncut = other.uncut;
    }

    pub(super) fn corners(&self) -> &[[N; 2]] {
        &self.corners
    }

    /// The corner at which the edge along the horizon begins.
    pub(super) fn horizon(&self) -> Option<usize> {
        self.horizon.map(usize::from)
    }

    /// Whether nothing has been cut off but by the horizon.
    pub(super) fn is_uncut(&self) -> bool {
        self.uncut
    }

    /// Whether it is narrower than what rounding leaves between two lines that
    /// are one: 16 u of the half extents, at most 5e-7 of the target.
    ///
    /// Such slivers are left over where occluders meet. No light leaks through
    /// them, and what is lost where they are real gaps is rounding.
    pub(super) fn is_thin(&self) -> bool {
        let Some((&[a0, b0], rest)) = self.corners.split_first() else {
            return true;
        };
        let (mut area, mut extent) = (N::ZERO, N::ZERO);
        let mut before = [N::ZERO; 2];
        for &[a, b] in rest {
            let offset = [a - a0, b - b0];
            let ([c, d], [e, f]) = (before, offset);
            area = area + (c * f - d * e);
            let squared = e * e + f * f;
            if squared > extent {
                extent = squared;
            }
            before = offset;
        }
        let width = N::of(16.0) * unit_roundoff::<N>();
        area <= N::ZERO || area * area <= width * width * extent
    }

    fn clear(&mut self) {
        self.corners.clear();
        self.horizon = None;
        self.uncut = false;
    }

    #[inline(always)]
    fn push(&mut self, corner: [N; 2], begins_horizon: bool) -> Result<(), Full> {
        if begins_horizon {
            self.horizon = u8::try_from(self.corners.len()).ok();
        }
        self.corners.push(corner).map_err(|_| Full)
    }

    /// On which side of a line the polygon is; corners within its tolerance are
    /// on neither.
    #[inline]
    pub(super) fn side(&self, line: &Line<N>) -> Side {
        self.side_within(line, line.tolerance())
    }

    #[cfg_attr(feature = "small", inline(never))]
    #[cfg_attr(not(feature = "small"), inline(always))]
    fn side_within(&self, line: &Line<N>, tolerance: N) -> Side {
        let (mut any_inside, mut any_outside) = (false, false);
        for &corner in &self.corners {
            let height = line.height(corner);
            any_inside |= height > tolerance;
            any_outside |= height < -tolerance;
        }
        Side::of(any_inside, any_outside)
    }

    /// The parts inside and outside of a line that has corners on both sides.
    /// Corners on the line belong to both; a crossing is computed once.
    #[inline]
    pub(super) fn split(
        &self,
        line: &Line<N>,
        inside: &mut Self,
        outside: &mut Self,
    ) -> Result<(), Full> {
        inside.clear();
        outside.clear();
        self.walk(line, line.tolerance(), |corner| {
            if corner.inside {
                inside.push(corner.place, corner.inner_horizon)?;
            }
            if corner.outside {
                outside.push(corner.place, corner.outer_horizon)?;
            }
            Ok(())
        })
    }

    /// The part inside alone, and on which side of the line the polygon is: a
    /// part only where it is on both.
    #[inline]
    pub(super) fn clip(&self, line: &Line<N>, inside: &mut Self) -> Result<Side, Full> {
        inside.clear();
        let (mut any_inside, mut any_outside) = (false, false);
        self.walk(line, line.tolerance(), |corner| {
            any_inside |= corner.inside && !corner.outside;
            any_outside |= corner.outside && !corner.inside;
            if corner.inside {
                inside.push(corner.place, corner.inner_horizon)?;
            }
            Ok(())
        })?;
        Ok(Side::of(any_inside, any_outside))
    }

    /// The part above the horizon, with the edge along it marked. Exact: the
    /// horizon has no tolerance, since nothing shares it.
    pub(super) fn clip_to_horizon(&self, line: &Line<N>, above: &mut Self) -> Result<Side, Full> {
        let side = self.side_within(line, N::ZERO);
        if side == Side::Both {
            above.clear();
            self.walk(line, N::ZERO, |corner| {
                if corner.inside {
                    above.push(corner.place, corner.leaves)?;
                }
                Ok(())
            })?;
            above.uncut = true;
        }
        Ok(side)
    }

    /// Goes round and hands over every corner of both parts, in order.
    #[inline(always)]
    fn walk(
        &self,
        line: &Line<N>,
        tolerance: N,
        mut each: impl FnMut(Corner<N>) -> Result<(), Full>,
    ) -> Result<(), Full> {
        let Some(&first) = self.corners.first() else {
            return Ok(());
        };
        let horizon = self.horizon();
        let next = self.corners.iter().skip(1).chain(core::iter::once(&first));
        let (mut from, mut from_height) = (first, line.height(first));
        let mut index = 0_usize;
        for &to in next {
            let to_height = line.height(to);
            let on_horizon = horizon == Some(index);
            let begins = Sides::of(from_height, tolerance);
            let ends = Sides::of(to_height, tolerance);
            let crosses = begins.apart(ends);
            each(Corner {
                place: from,
                inside: begins.inside,
                outside: begins.outside,
                // The horizon goes with the parts that hold more of its edge
                // than this corner.
                inner_horizon: on_horizon && (!begins.outside || ends.inside),
                outer_horizon: on_horizon && (!begins.inside || ends.outside),
                leaves: begins.inside && begins.outside && !ends.inside,
            })?;
            if crosses {
                each(Corner {
                    place: crossing([from, to], [from_height, to_height]),
                    inside: true,
                    outside: true,
                    inner_horizon: on_horizon && ends.inside,
                    outer_horizon: on_horizon && ends.outside,
                    leaves: ends.outside,
                })?;
            }
            (from, from_height) = (to, to_height);
            index = index.wrapping_add(1);
        }
        Ok(())
    }
}

/// A corner of the parts on both sides of a line.
struct Corner<N> {
    place: [N; 2],
    /// It belongs to the part inside.
    inside: bool,
    /// It belongs to the part outside.
    outside: bool,
    /// The horizon's edge begins here in the part inside.
    inner_horizon: bool,
    /// The horizon's edge begins here in the part outside.
    outer_horizon: bool,
    /// It is on the line, and the loop leaves the inside here.
    leaves: bool,
}

/// To which parts a corner belongs: both where it is on the line.
#[derive(Clone, Copy)]
struct Sides {
    inside: bool,
    outside: bool,
}

impl Sides {
    #[inline(always)]
    fn of<N: Floating>(height: N, tolerance: N) -> Self {
        Self {
            inside: height >= -tolerance,
            outside: height <= tolerance,
        }
    }

    #[inline(always)]
    fn apart(self, other: Self) -> bool {
        (self.inside && !self.outside && !other.inside)
            || (self.outside && !self.inside && !other.outside)
    }
}

/// Where an edge crosses a line, computed from the end nearer to it.
#[cfg_attr(feature = "small", inline(never))]
#[cfg_attr(not(feature = "small"), inline(always))]
fn crossing<N: Floating>([from, to]: [[N; 2]; 2], [from_height, to_height]: [N; 2]) -> [N; 2] {
    let drop = from_height - to_height;
    let between = |[a, b]: [N; 2], [c, d]: [N; 2], t: N| [a + (c - a) * t, b + (d - b) * t];
    if from_height.abs() <= to_height.abs() {
        between(from, to, from_height / drop)
    } else {
        between(to, from, -to_height / drop)
    }
}
