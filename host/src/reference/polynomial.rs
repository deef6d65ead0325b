//! Light on a cell as a polynomial of second degree in the cell's own
//! coordinates.

use glam::DVec3;

use super::convex;

/// Coefficients of 1, a, b, a², ab, b².
pub(super) type Polynomial = [f64; TERMS];

/// Terms of a polynomial.
pub(super) const TERMS: usize = 6;

/// A term whose share outside the span of the others is smaller than this is
/// left out: the places cannot tell them apart.
const DEPENDENT: f64 = 1e-7;

/// Coordinates on a surface: a and b run over -1 to 1 on a cell's bounding
/// rectangle.
#[derive(Clone, Copy, Debug)]
pub(super) struct Frame {
    origin: DVec3,
    /// Directions divided by half extents.
    scaled: [DVec3; 2],
}

impl Frame {
    /// The frame of a polygon, along perpendicular unit `axes` of its plane.
    pub(super) fn of(polygon: &[DVec3], axes: [DVec3; 2]) -> Self {
        let anchor = polygon.first().copied().unwrap_or_default();
        let mut origin = anchor;
        let scaled = axes.map(|axis| {
            let (low, high) = convex::extent(polygon, axis);
            origin += axis * (0.5 * (low + high) - axis.dot(anchor));
            axis * (2.0 / (high - low).max(f64::MIN_POSITIVE))
        });
        Self { origin, scaled }
    }

    /// The terms at a place relative to `receiver`'s position.
    pub(super) fn terms(&self, offset: DVec3) -> Polynomial {
        let [a, b] = self.scaled.map(|axis| axis.dot(offset));
        [1.0, a, b, a * a, a * b, b * b]
    }

    /// What to add to a place to get the `offset` of [`Frame::terms`].
    pub(super) fn origin(&self) -> DVec3 {
        self.origin
    }

    /// A polynomial of this frame as one of `other`, which shares its axes.
    pub(super) fn carried(&self, polynomial: &Polynomial, other: &Self) -> Polynomial {
        let shift = other.origin - self.origin;
        let [(a0, a1), (b0, b1)] = [0, 1].map(|axis| {
            let scaled = self.scaled[axis];
            let ratio = scaled.length() / other.scaled[axis].length();
            (scaled.dot(shift), ratio)
        });
        let [c, p, q, pp, pq, qq] = *polynomial;
        [
            c + p * a0 + q * b0 + pp * a0 * a0 + pq * a0 * b0 + qq * b0 * b0,
            (p + 2.0 * pp * a0 + pq * b0) * a1,
            (q + 2.0 * qq * b0 + pq * a0) * b1,
            pp * a1 * a1,
            pq * a1 * b1,
            qq * b1 * b1,
        ]
    }
}

/// Value of a polynomial whose terms have the value `terms`.
pub(super) fn value(polynomial: &Polynomial, terms: &Polynomial) -> f64 {
    polynomial.iter().zip(terms).map(|(c, t)| c * t).sum()
}

/// Least squares upon places of a cell: turns values there into the
/// polynomial nearest to them.
pub(super) struct Fit {
    /// One row of coefficients for each place.
    rows: Vec<Polynomial>,
    terms: Vec<Polynomial>,
    weights: Vec<f64>,
}

impl Fit {
    /// The fit upon places with these weights (areas).
    pub(super) fn new(frame: &Frame, places: &[(DVec3, f64)]) -> Self {
        let at = |place: &(DVec3, f64)| frame.terms(place.0 - frame.origin());
        let terms: Vec<Polynomial> = places.iter().map(at).collect();
        let weights: Vec<f64> = places.iter().map(|place| place.1).collect();
        let dot = |a: &Polynomial, b: &Polynomial| -> f64 {
            let places = terms.iter().zip(&weights);
            places.map(|(t, w)| w * value(a, t) * value(b, t)).sum()
        };
        // Gram and Schmidt, twice over for the rounding of slivers.
        let mut base: Vec<Polynomial> = Vec::with_capacity(TERMS);
        for index in 0..TERMS {
            let mut unit = [0.0; TERMS];
            unit[index] = 1.0;
            let before = dot(&unit, &unit).sqrt();
            for _ in 0..2 {
                for other in &base {
                    let share = dot(&unit, other);
                    unit.iter_mut()
                        .zip(other)
                        .for_each(|(u, o)| *u -= share * o);
                }
            }
            let length = dot(&unit, &unit).sqrt();
            if length > DEPENDENT * before {
                unit.iter_mut().for_each(|u| *u /= length);
                base.push(unit);
            }
        }
        let rows = terms.iter().zip(&weights).map(|(terms, weight)| {
            let mut row = [0.0; TERMS];
            for polynomial in &base {
                let share = weight * value(polynomial, terms);
                row.iter_mut()
                    .zip(polynomial)
                    .for_each(|(r, p)| *r += share * p);
            }
            row
        });
        let rows = rows.collect();
        Self {
            rows,
            terms,
            weights,
        }
    }

    /// Coefficients that each place's value of 1 stands for.
    pub(super) fn rows(&self) -> &[Polynomial] {
        &self.rows
    }

    /// The polynomial nearest to `values`.
    pub(super) fn polynomial(&self, values: impl Iterator<Item = f64>) -> Polynomial {
        let mut sum = [0.0; TERMS];
        for (row, value) in self.rows.iter().zip(values) {
            sum.iter_mut().zip(row).for_each(|(s, r)| *s += value * r);
        }
        sum
    }

    /// Root of the mean square by which `values` differ from a polynomial.
    pub(super) fn residual(
        &self,
        polynomial: &Polynomial,
        values: impl Iterator<Item = f64>,
    ) -> f64 {
        let mut sum = 0.0;
        for ((terms, weight), given) in self.terms.iter().zip(&self.weights).zip(values) {
            sum += weight * (value(polynomial, terms) - given).powi(2);
        }
        (sum / self.area().max(f64::MIN_POSITIVE)).sqrt()
    }

    /// Integral of a polynomial over the cell.
    pub(super) fn integral(&self, polynomial: &Polynomial) -> f64 {
        let places = self.terms.iter().zip(&self.weights);
        places.map(|(terms, w)| w * value(polynomial, terms)).sum()
    }

    fn area(&self) -> f64 {
        self.weights.iter().sum()
    }
}

#[cfg(test)]
mod tests {
    use glam::DVec3;

    use super::{Fit, Frame, value};

    #[test]
    fn fits_reproduce_and_frames_carry() {
        let axes = [DVec3::X, DVec3::Y];
        let square = |x: f64, y: f64, size: f64| {
            [(0., 0.), (1., 0.), (1., 1.), (0., 1.)]
                .map(|(u, v)| DVec3::new(x + size * u, y + 0.5 * size * v, 3.0))
        };
        let f = |p: DVec3| 2.0 - p.x + 0.5 * p.y + p.x * p.y - 0.7 * p.x * p.x + p.y * p.y;
        let (large, small) = (square(-1.0, 2.0, 4.0), square(0.3, 2.5, 0.7));
        let places: Vec<(DVec3, f64)> = (0..16)
            .map(|k| {
                (
                    large[0] + DVec3::new(f64::from(k % 4), f64::from(k / 4) * 0.4, 0.0),
                    1.0,
                )
            })
            .collect();
        let (frame, other) = (Frame::of(&large, axes), Frame::of(&small, axes));
        let fit = Fit::new(&frame, &places);
        let found = fit.polynomial(places.iter().map(|place| f(place.0)));
        assert!(fit.residual(&found, places.iter().map(|place| f(place.0))) < 1e-13);
        let carried = frame.carried(&found, &other);
        for corner in small {
            let terms = other.terms(corner - other.origin());
            assert!((value(&carried, &terms) - f(corner)).abs() < 1e-12);
        }
    }
}
