//! From samples to a grid in integers: the cone filter of
//! [`resample`](crate::resample), which see.
//!
//! The divisor of its weights 1 − d/r cancels, so a weight is r − d, in as many
//! bits as leave every sum of 64 bits exact.

use super::light::Light;
use super::scene::Scene;
use super::tables::Surface;
use super::transfer::{Transfer, saturated};
use crate::Error;
use crate::error::What;
use crate::form_factor::fixed_point::Format;
use crate::number::fixed_point::reciprocal_root;
use crate::resample::{DOUBLINGS, Filtered, Row};

/// √x of a whole number, rounded down but for an error of 2e-9 of it.
///
/// x is shifted until its upper word is from 2^30 up; x/√x follows from
/// [`reciprocal_root`]. 8 multiplications, no loop. Never panics.
#[inline]
fn root(x: u64) -> u64 {
    if x == 0 {
        return 0;
    }
    let shift = x.leading_zeros() & !1;
    let word = ((x << shift) >> 32) as u32;
    // word/2^32 times 1/√(word/2^32), in units of 2^−62; √x is 2^(32 − shift/2)
    // times as much.
    let root = u64::from(word).wrapping_mul(reciprocal_root(word) as u64);
    root >> (30 + shift / 2)
}

/// The cone-filtered value at (u, v) of samples at `places` with `values`, in
/// their units, rounded to nearest; lengths in one unit, radius > 0.
///
/// `None` where there is no sample at all. A weight has 32 bits less those of
/// the number of samples: 27 for 25 of them. Cost: one root per sample in reach,
/// one division. Never panics.
pub fn cone(
    places: &[[i32; 2]],
    values: &[i32],
    [u, v]: [i32; 2],
    radius: u32,
) -> Option<Filtered<i32>> {
    let count = if places.len() < values.len() {
        places.len()
    } else {
        values.len()
    } as u64;
    // Weights of so many bits, times so many words with a sign, are a sum of 64 bits.
    let bits = 32_u32.saturating_sub(64 - count.leading_zeros());
    let mut radius = u64::from(radius);
    for doublings in 0..DOUBLINGS {
        let reach = radius.saturating_mul(radius);
        let drop = (64 - radius.leading_zeros()).saturating_sub(bits);
        let (mut sum, mut weights) = (0_i64, 0_i64);
        for (&[u_i, v_i], &value) in places.iter().zip(values) {
            let square = |a: i32, b: i32| {
                let difference = u64::from(a.abs_diff(b));
                difference.wrapping_mul(difference)
            };
            let squared = square(u, u_i).saturating_add(square(v, v_i));
            if squared < reach {
                // Rounding may put a sample on the rim a hair beyond it.
                let weight = radius.saturating_sub(root(squared)) >> (drop & 63);
                let weight = i64::from(weight as i32); // it has 31 bits
                sum = sum.wrapping_add(weight.wrapping_mul(value.into()));
                weights = weights.wrapping_add(weight);
            }
        }
        if weights > 0 {
            let mean = sum.saturating_add(weights >> 1).checked_div_euclid(weights);
            return Some(Filtered {
                value: saturated(mean.unwrap_or(0)),
                doublings,
            });
        }
        radius = radius.saturating_mul(2);
    }
    None
}

impl<F: Format, const SAMPLES: usize, const EMITTERS: usize, T: Transfer>
    Light<'_, F, SAMPLES, EMITTERS, T>
{
    /// The cone-filtered irradiance at (u, v) in the frame of a surface, in the
    /// tables' units; `None` for a surface without samples.
    ///
    /// # Errors
    /// [`Error::Unknown`] for a surface that does not exist.
    pub fn resample_at(
        &self,
        surface: usize,
        place: [i32; 2],
    ) -> Result<Option<Filtered<i32>>, Error> {
        let scene = self.scene();
        Ok(self.filtered(&scene, scene.surface(surface)?, place))
    }

    /// Where direct and reflected light have samples of their own, each is filtered over
    /// its own, and the two are added.
    fn filtered(
        &self,
        scene: &Scene<'_>,
        surface: &Surface,
        place: [i32; 2],
    ) -> Option<Filtered<i32>> {
        let of = |is_luminaire| {
            let samples = scene.receivers(surface, is_luminaire);
            let places = scene.samples().get(samples.clone())?;
            let values = self.irradiance().get(samples)?;
            cone(places, values, place, surface.filter_radius.unsigned_abs())
        };
        let direct = of(true)?;
        if surface.direct == 0 && surface.indirect == 0 {
            return Some(direct);
        }
        let reflected = of(false)?;
        Some(Filtered {
            value: direct.value.saturating_add(reflected.value),
            doublings: direct.doublings.saturating_add(reflected.doublings),
        })
    }

    /// Row `row` of a `columns` × `rows` grid over the bounding rectangle of a
    /// surface: irradiance at the centres of the cells, the first `columns`
    /// values of `out`. Row 0 is at v = 0.
    ///
    /// A surface without samples (a pure luminaire) gives 0.
    ///
    /// # Errors
    /// [`Error::Unknown`] for a surface or row that does not exist,
    /// [`Error::Slice`] where `out` is shorter than `columns`.
    pub fn resample_row(
        &self,
        surface: usize,
        [columns, rows]: [u32; 2],
        row: u32,
        out: &mut [i32],
    ) -> Result<Row, Error> {
        let scene = self.scene();
        let surface = scene.surface(surface)?;
        let [width, height] = surface.size;
        if row >= rows {
            return Err(Error::Unknown {
                what: What::Rows,
                asked: row,
                have: rows,
            });
        }
        let have = out.len() as u32;
        let Some(out) = out.get_mut(..columns as usize) else {
            return Err(Error::Slice {
                needed: columns,
                have,
            });
        };
        let v = center(row, rows, height);
        let mut out_of_reach = 0_u32;
        for (column, cell) in (0_u32..).zip(out) {
            let u = center(column, columns, width);
            let filtered = self.filtered(&scene, surface, [u, v]);
            let grown = filtered.is_some_and(|filtered| filtered.doublings > 0);
            out_of_reach = out_of_reach.saturating_add(grown.into());
            *cell = filtered.map_or(0, |filtered| filtered.value);
        }
        Ok(Row { out_of_reach })
    }
}

/// The middle of a cell of so many along a length.
fn center(cell: u32, cells: u32, length: i32) -> i32 {
    let twice = u64::from(cell).wrapping_mul(2).wrapping_add(1);
    let along = twice.wrapping_mul(length.unsigned_abs().into()) >> 1;
    along.checked_div(cells.into()).unwrap_or(0) as i32
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn roots_keep_their_stated_error() {
        let words = [0, 1, 2, 3, 4, 99, 1 << 16, (1 << 31) + 7, u64::MAX];
        for x in words.into_iter().chain((0..64).map(|k| 3_u64 << k >> 1)) {
            let (exact, got) = (libm::sqrt(x as f64), root(x) as f64);
            assert!(got <= exact * (1.0 + 2e-9), "{x}: {got}");
            assert!(got >= exact * (1.0 - 2.1e-9) - 1.0, "{x}: {got}");
        }
    }

    #[test]
    fn a_constant_field_stays_constant() {
        let places = [[0, 0], [1 << 28, 5], [77, 1 << 28], [1 << 28, 1 << 28]];
        for value in [0, 1, -1, 1 << 30, i32::MAX] {
            for place in [[0, 0], [1 << 27, 1 << 27], [9, 1 << 28]] {
                for radius in [1, 1 << 20, 1 << 28, i32::MAX as u32] {
                    let filtered = cone(&places, &[value; 4], place, radius);
                    let found = filtered.map(|filtered| filtered.value);
                    assert_eq!(found, Some(value), "{place:?} {radius}");
                }
            }
        }
        assert_eq!(cone(&[], &[], [0, 0], 5), None);
    }
}
