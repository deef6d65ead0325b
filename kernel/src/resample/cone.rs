//! The cone filter of the paper.
//!
//! ```text
//! E(u, v) = Σ (1 − d_i/r) E_i / Σ (1 − d_i/r)      over all d_i < r,
//! d_i = √((u − u_i)² + (v − v_i)²)
//! ```
//!
//! The paper prints Σ d_i as the divisor and misplaces the exponents; with that
//! divisor a constant field would not come out constant. Where no sample is
//! within r, r is doubled until there is one: a stated case, counted in what
//! the functions return, never 0/0.

use super::Row;
use crate::Error;
use crate::error::What;
use crate::form_factor::Arithmetic;
use crate::luminance::{Colour, Luminance};
use crate::number::Root;
use crate::scene::records::Surface;
use crate::shoot::Light;
use crate::transfer::Transfer;

/// Doublings of the radius after which the search for a sample ends: 2⁴⁰
/// spans every ratio of lengths that checked tables can hold.
pub(crate) const DOUBLINGS: u32 = 40;

/// The filtered value at a place.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Filtered<C> {
    /// The weighted mean.
    pub value: C,
    /// How often the radius had to be doubled before a sample was in reach.
    pub doublings: u32,
}

/// The cone-filtered value at (u, v) of samples at `places` with `values`.
///
/// `None` where there is no sample at all. Coordinates and `radius` in metres,
/// radius > 0. Cost on a Cortex-M4F: 24 instructions per sample in reach, 13 per
/// other one. Never panics, never NaN for finite input.
pub fn cone<R: Root<f32>, C: Colour>(
    places: &[[f32; 2]],
    values: &[C],
    [u, v]: [f32; 2],
    radius: f32,
) -> Option<Filtered<C>> {
    let mut radius = radius;
    for doublings in 0..DOUBLINGS {
        let (reach, inverse) = (radius * radius, 1.0 / radius);
        let (mut sum, mut weights) = (C::DARK, 0.0);
        for (&[u_i, v_i], &value) in places.iter().zip(values) {
            let (du, dv) = (u - u_i, v - v_i);
            let squared = du * du + dv * dv;
            if squared < reach {
                let weight = 1.0 - R::sqrt(squared) * inverse;
                // Rounding may put a sample on the rim a hair beyond it.
                if weight > 0.0 {
                    sum = sum.plus(value.times(weight));
                    weights += weight;
                }
            }
        }
        if weights > 0.0 {
            return Some(Filtered {
                value: sum.map(|sum| sum / weights),
                doublings,
            });
        }
        radius = radius + radius;
    }
    None
}

impl<A, const SAMPLES: usize, const EMITTERS: usize, L, V, const SURFACES: usize>
    Light<'_, A, SAMPLES, EMITTERS, L, V, SURFACES>
where
    A: Arithmetic<f32>,
    L: Luminance,
    V: Transfer,
{
    /// The cone-filtered irradiance in W m⁻² at (u, v), metres in the frame of a
    /// surface; `None` for a surface without samples.
    ///
    /// # Errors
    /// [`Error::Unknown`] for a surface that does not exist.
    pub fn resample_at<R: Root<f32>>(
        &self,
        surface: usize,
        place: [f32; 2],
    ) -> Result<Option<Filtered<L::Colour>>, Error> {
        let surface = self.scene().surface(surface)?;
        Ok(self.filtered::<R>(surface, place))
    }

    /// Where direct and reflected light have samples of their own, each is
    /// filtered over its own, and the two are added.
    fn filtered<R: Root<f32>>(
        &self,
        surface: &Surface,
        place: [f32; 2],
    ) -> Option<Filtered<L::Colour>> {
        let scene = self.scene();
        let of = |is_luminaire| {
            let samples = scene.receivers(surface, is_luminaire);
            let places = scene.samples().get(samples.clone())?;
            let values = self.irradiance().get(samples)?;
            cone::<R, L::Colour>(places, values, place, surface.filter_radius)
        };
        let direct = of(true)?;
        if surface.direct == 0 && surface.indirect == 0 {
            return Some(direct);
        }
        let reflected = of(false)?;
        Some(Filtered {
            value: direct.value.plus(reflected.value),
            doublings: direct.doublings.saturating_add(reflected.doublings),
        })
    }

    /// Row `row` of a `columns` × `rows` grid over the bounding rectangle of a
    /// surface: irradiance in W m⁻² at the centres of the cells, the first
    /// `columns` values of `out`. Row 0 is at v = 0.
    ///
    /// A row at a time, so that a picture never needs to be in RAM at once.
    /// A surface without samples (a pure luminaire) gives 0.
    ///
    /// # Errors
    /// [`Error::Unknown`] for a surface or row that does not exist,
    /// [`Error::Slice`] where `out` is shorter than `columns`.
    pub fn resample_row<R: Root<f32>>(
        &self,
        surface: usize,
        [columns, rows]: [u32; 2],
        row: u32,
        out: &mut [L::Colour],
    ) -> Result<Row, Error> {
        let scene = self.scene();
        let surface = scene.surface(surface)?;
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
        let [width, height] = surface.size;
        let v = (row as f32 + 0.5) * (height / rows as f32);
        let step = width / columns as f32;
        let mut out_of_reach = 0;
        for (column, cell) in (0_u32..).zip(out) {
            let u = (column as f32 + 0.5) * step;
            *cell = match self.filtered::<R>(surface, [u, v]) {
                Some(filtered) => {
                    let grown = u32::from(filtered.doublings > 0);
                    out_of_reach = grown.saturating_add(out_of_reach);
                    filtered.value
                }
                None => L::Colour::DARK,
            };
        }
        Ok(Row { out_of_reach })
    }
}
