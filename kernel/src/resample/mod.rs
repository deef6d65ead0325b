//! From samples to a grid, or to any place between them.
//!
//! Two ways, for two kinds of plan. The paper's is the [`cone`] filter: every
//! place is the weighted mean of the samples around it. In a plan that knows the
//! light's structure a surface's irradiance is a sum of *fields*, each of them
//!
//! * a tensor grid: polynomials through samples of √(s/E), for light that nothing
//!   hides;
//! * a mesh: triangles with linear values, whose corners are sums of samples by the
//!   planner's weights, and which no edge of light crosses;
//! * or the product of both: unoccluded light times the fraction of it that is
//!   seen, for shadows.
//!
//! [`Light::reconstruct`] makes what depends on the samples alone, once; after that
//! a pixel costs little. What a scene's plan does not use is not linked: it is a
//! type, a [`Reconstruction`].

mod cone;
mod mesh;
mod tensor;

#[cfg(feature = "fixed")]
pub(crate) use cone::DOUBLINGS;
pub use cone::{Filtered, cone};

use crate::Error;
use crate::error::What;
use crate::form_factor::Arithmetic;
use crate::luminance::{Colour, Luminance};
use crate::number::Root;
use crate::scene::Scene;
use crate::scene::fields::{Fields, Mesh, Tensor};
use crate::scene::records::Surface;
use crate::shoot::Light;
use crate::transfer::Transfer;
use core::marker::PhantomData;
use mesh::{END, Valued};
use tensor::Line;

/// How a row was resampled.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Row {
    /// Places that had no sample within the filter's radius.
    pub out_of_reach: u32,
}

/// How the fields of a surface are put together again.
pub trait Reconstruction {
    /// The square root that tensor grids take.
    type Root: Root<f32>;
    /// Whether fields may have meshes.
    const MESHES: bool;
}

/// Fields that are tensor grids: scenes in which nothing casts a shadow.
#[derive(Clone, Copy, Debug, Default)]
pub struct Tensors<R>(PhantomData<R>);

impl<R: Root<f32>> Reconstruction for Tensors<R> {
    type Root = R;
    const MESHES: bool = false;
}

/// Fields of every kind.
#[derive(Clone, Copy, Debug, Default)]
pub struct Stencils<R>(PhantomData<R>);

impl<R: Root<f32>> Reconstruction for Stencils<R> {
    type Root = R;
    const MESHES: bool = true;
}

impl<'t, A, const SAMPLES: usize, const EMITTERS: usize, L, V, const SURFACES: usize>
    Light<'t, A, SAMPLES, EMITTERS, L, V, SURFACES>
where
    A: Arithmetic<f32>,
    L: Luminance,
    V: Transfer,
{
    /// Puts a surface together from the fields it was planned as.
    ///
    /// `room` must have as many values as [`Fields::room`] says; they are the
    /// answer's until it is dropped. Cost: for a tensor grid of n × n a root, a
    /// division and 2 n multiplications a sample, for a mesh a multiplication a share,
    /// where both are multiplied 2 n more a sample.
    ///
    /// # Errors
    /// [`Error::Unknown`] for a surface that does not exist, or has no fields;
    /// [`Error::Capacity`] where the plan has meshes and `Q` none;
    /// [`Error::Slice`] where `room` is too short.
    pub fn reconstruct<'a, Q: Reconstruction>(
        &self,
        surface: usize,
        room: &'a mut [L::Colour],
    ) -> Result<Reconstructed<'t, 'a, Q, L::Colour>, Error> {
        let scene = self.scene();
        let (surface, needed) = self.planned::<Q>(surface)?;
        let have = room.len() as u32;
        let Some(room) = room.get_mut(..needed) else {
            let needed = needed as u32;
            return Err(Error::Slice { needed, have });
        };
        let fields = scene.fields();
        let mut rest = &mut *room;
        for (tensor, mesh) in fields.of(surface) {
            rest = prepare::<Q, L::Colour>(&scene, self.irradiance(), tensor, mesh, rest);
        }
        Ok(Reconstructed {
            fields,
            surface,
            room,
            way: PhantomData,
        })
    }

    /// As [`reconstruct`](Self::reconstruct), of a room that it has filled before,
    /// for the same surface in the same light.
    ///
    /// # Errors
    /// As [`reconstruct`](Self::reconstruct).
    pub fn reconstructed<'a, Q: Reconstruction>(
        &self,
        surface: usize,
        room: &'a [L::Colour],
    ) -> Result<Reconstructed<'t, 'a, Q, L::Colour>, Error> {
        let (surface, needed) = self.planned::<Q>(surface)?;
        let have = room.len() as u32;
        match room.get(..needed) {
            Some(room) => Ok(Reconstructed {
                fields: self.scene().fields(),
                surface,
                room,
                way: PhantomData,
            }),
            None => Err(Error::Slice {
                needed: needed as u32,
                have,
            }),
        }
    }

    /// A surface that has fields of the kinds that `Q` knows, and the room they
    /// need.
    fn planned<Q: Reconstruction>(&self, surface: usize) -> Result<(&'t Surface, usize), Error> {
        let scene = self.scene();
        let (index, surface) = (surface as u32, scene.surface(surface)?);
        if surface.fields == 0 {
            return Err(Error::Unknown {
                what: What::Fields,
                asked: index,
                have: 0,
            });
        }
        let meshes = scene.counts().meshes;
        if !Q::MESHES && meshes > 0 {
            return Err(Error::Capacity {
                what: What::Meshes,
                needed: meshes,
                have: 0,
            });
        }
        Ok((surface, scene.fields().room(surface)))
    }
}

/// Makes what a field's places need of its samples; what is left of the room.
fn prepare<'r, Q: Reconstruction, C: Colour>(
    scene: &Scene<'_>,
    irradiance: &[C],
    tensor: Option<&Tensor>,
    mesh: Option<&Mesh>,
    room: &'r mut [C],
) -> &'r mut [C] {
    let fields = scene.fields();
    let (grid, rest) = split(room, tensor.map_or(0, |tensor| tensor.values() + 1));
    if let Some(tensor) = tensor {
        let places = from(scene.samples(), tensor.first_sample);
        let values = from(irradiance, tensor.first_sample);
        tensor::coefficients::<Q::Root, C>(tensor, fields, places, values, grid);
    }
    let Some(mesh) = mesh.filter(|_| Q::MESHES) else {
        return rest;
    };
    let of_samples = from(irradiance, mesh.first_sample);
    match tensor {
        Some(tensor) => {
            let (fractions, rest) = split(rest, mesh.samples as usize);
            let places = from(scene.samples(), mesh.first_sample);
            for ((fraction, &[u, v]), &seen) in fractions.iter_mut().zip(places).zip(of_samples) {
                let all = Line::at(tensor, grid, v).value(u);
                *fraction = seen.zip(all, part);
            }
            let (nodes, rest) = split(rest, mesh.nodes as usize);
            mesh::values(mesh, fields, fractions, nodes);
            rest
        }
        None => {
            let (nodes, rest) = split(rest, mesh.nodes as usize);
            mesh::values(mesh, fields, of_samples, nodes);
            rest
        }
    }
}

/// The fraction of all light that is seen, from 0 to 1.
#[inline(always)]
fn part(seen: f32, all: f32) -> f32 {
    // As many as are right for light that is there, none where there is none.
    let fraction = if all > 0.0 { seen / all } else { 0.0 };
    held(fraction)
}

/// A fraction, from 0 to 1.
#[inline(always)]
fn held(fraction: f32) -> f32 {
    if fraction > 0.0 {
        if fraction < 1.0 { fraction } else { 1.0 }
    } else {
        0.0
    }
}

/// The first `count` of a slice, or what there is, and the others.
fn split<T>(all: &mut [T], count: usize) -> (&mut [T], &mut [T]) {
    let count = if count < all.len() { count } else { all.len() };
    all.split_at_mut_checked(count).unwrap_or_default()
}

fn from<T>(all: &[T], first: u32) -> &[T] {
    all.get(first as usize..).unwrap_or(&[])
}

/// A surface that has been put together: irradiance at any place of it.
pub struct Reconstructed<'t, 'a, Q, C> {
    fields: Fields<'t>,
    surface: &'t Surface,
    room: &'a [C],
    way: PhantomData<Q>,
}

/// A field with what was made of its samples.
struct Made<'a, 't, C> {
    tensor: Option<(&'t Tensor, &'a [C])>,
    mesh: Option<(&'t Mesh, Valued<'a, 't, C>)>,
}

impl<'t, 'a, Q: Reconstruction, C: Colour> Reconstructed<'t, 'a, Q, C> {
    fn made(&self) -> impl Iterator<Item = Made<'a, 't, C>> {
        let (fields, surface) = (self.fields, self.surface);
        let mut rest = self.room;
        fields.of(surface).map(move |(tensor, mesh)| {
            let mut take = |count: usize| {
                let (taken, others) = rest.split_at_checked(count).unwrap_or_default();
                rest = others;
                taken
            };
            let grid = take(tensor.map_or(0, |tensor| tensor.values() + 1));
            let mesh = mesh.filter(|_| Q::MESHES).map(|mesh| {
                if tensor.is_some() {
                    take(mesh.samples as usize);
                }
                let valued = Valued {
                    nodes: fields.nodes(mesh),
                    triangles: fields.triangles(mesh),
                    values: take(mesh.nodes as usize),
                };
                (mesh, valued)
            });
            Made {
                tensor: tensor.map(|tensor| (tensor, grid)),
                mesh,
            }
        })
    }

    /// The irradiance in W m⁻² at (u, v), metres in the surface's frame; at least 0.
    ///
    /// Cost: for a tensor grid 2 operations a sample, for a mesh 60 instructions a
    /// triangle.
    pub fn at(&self, [u, v]: [f32; 2]) -> C {
        let [width, height] = self.surface.size;
        let place = [u / width * END, v / height * END];
        let mut sum = C::DARK;
        for Made { tensor, mesh } in self.made() {
            let whole = tensor.map(|(tensor, grid)| Line::at(tensor, grid, v).value(u));
            let value = match (whole, mesh) {
                (Some(whole), None) => whole,
                (Some(whole), Some((mesh, valued))) => {
                    let (fraction, inside) = valued.at(place);
                    let fraction = fraction.map(held);
                    if inside || mesh.outside < 0.0 {
                        whole.zip(fraction, |all, fraction| all * fraction)
                    } else {
                        whole.times(mesh.outside)
                    }
                }
                (None, Some((_, valued))) => valued.at(place).0.map(lit),
                (None, None) => C::DARK,
            };
            sum = sum.plus(value);
        }
        sum
    }

    /// Row `row` of a `columns` × `rows` grid over the bounding rectangle of the
    /// surface: irradiance in W m⁻² at the centres of the cells, the first `columns`
    /// values of `out`. Row 0 is at v = 0. 0 where no triangle of a mesh is: below
    /// what stands on the surface.
    ///
    /// Cost a pixel: for a tensor grid of n × n 3 n operations and a division, for a
    /// mesh two operations; and a row 60 instructions a triangle.
    ///
    /// # Errors
    /// [`Error::Unknown`] for a row that does not exist, [`Error::Slice`] where
    /// `out` is shorter than `columns`.
    pub fn row(&self, [columns, rows]: [u32; 2], row: u32, out: &mut [C]) -> Result<(), Error> {
        if row >= rows {
            return Err(Error::Unknown {
                what: What::Rows,
                asked: row,
                have: rows,
            });
        }
        let have = out.len() as u32;
        let Some(out) = out.get_mut(..columns as usize) else {
            let needed = columns;
            return Err(Error::Slice { needed, have });
        };
        out.fill(C::DARK);
        let [width, height] = self.surface.size;
        let v = (row as f32 + 0.5) * (height / rows as f32);
        let step = width / columns as f32;
        for Made { tensor, mesh } in self.made() {
            let line = tensor.map(|(tensor, grid)| Line::at(tensor, grid, v));
            let outside = match (&mesh, &line) {
                (Some((mesh, _)), Some(_)) if mesh.outside >= 0.0 => mesh.outside,
                (None, Some(_)) => 1.0,
                _ => 0.0,
            };
            if let Some(line) = line.as_ref().filter(|_| outside > 0.0) {
                for (column, cell) in (0_u32..).zip(&mut *out) {
                    let whole = line.value((column as f32 + 0.5) * step);
                    *cell = cell.plus(whole.times(outside));
                }
            }
            let Some((_, valued)) = mesh else {
                continue;
            };
            let line_of_mesh = (row as f32 + 0.5) / rows as f32 * END;
            valued.spans(line_of_mesh, columns, |span, first, slope| {
                let mut value = first;
                let start = span.start as u32;
                let cells = out.get_mut(span).unwrap_or_default();
                for (column, cell) in (start..).zip(cells) {
                    *cell = cell.plus(match &line {
                        Some(line) => {
                            let whole = line.value((column as f32 + 0.5) * step);
                            whole.zip(value, |all, part| all * (held(part) - outside))
                        }
                        None => value.map(lit),
                    });
                    value = value.plus(slope);
                }
            });
        }
        // What was taken away again where something is seen in part may leave a
        // rounding below nothing.
        for cell in out {
            *cell = cell.map(lit);
        }
        Ok(())
    }
}

/// Not below 0.
#[inline(always)]
fn lit(value: f32) -> f32 {
    if value > 0.0 { value } else { 0.0 }
}
