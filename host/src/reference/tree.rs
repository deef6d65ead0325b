//! Reflecting surfaces as trees of cells, halved where their light asks for
//! it.

use std::f64::consts::PI;

use glam::DVec3;
use rayon::prelude::*;

use super::Error;
use super::convex::{self, Loop};
use super::exposed::exposed;
use super::patch::Receiver;
use super::polynomial::{Fit, Frame, Polynomial, TERMS};
use super::rule::Rule;
use super::surface::Outline;
use crate::scene::Scene;

/// Nodes in a direction of the fit of direct light.
const DENSE: usize = 6;

/// Halvings below a part of a surface.
const DEEPEST: u32 = 40;

/// A convex part of a surface.
pub(super) struct Cell {
    /// Index in [`Tree::reflectors`].
    pub(super) reflector: usize,
    /// Vertices.
    pub(super) outline: Loop,
    /// Coordinates of its polynomials.
    pub(super) frame: Frame,
    /// Mean of the vertices.
    pub(super) centre: DVec3,
    /// Largest distance of a vertex from it.
    pub(super) radius: f64,
    /// Area in m².
    pub(super) area: f64,
    /// Its halves.
    pub(super) children: Option<[usize; 2]>,
    /// Which cells carry the interreflection.
    pub(super) role: Role,
    /// Its light.
    pub(super) light: Option<Light>,
    depth: u32,
}

/// Where a cell stands in the mesh of the interreflection.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Role {
    /// Its descendants are cells of the mesh.
    Above,
    /// A cell of the mesh.
    Base,
    /// A part of a cell of the mesh, where direct light needs it.
    Below,
}

/// What a cell sends out.
pub(super) struct Light {
    /// Radiance by direct light, for each channel.
    pub(super) direct: Vec<Polynomial>,
    /// Radiance by all light so far.
    pub(super) total: Vec<Polynomial>,
    /// Root of the mean square of what the polynomials miss of direct
    /// radiosity, relative to the mean irradiance of the scene.
    pub(super) roughness: f64,
}

/// A reflecting surface.
pub(super) struct Reflector {
    /// Where it is.
    pub(super) outline: Outline,
    /// Reflectance of each channel.
    pub(super) reflectance: [f64; 3],
    /// Perpendicular unit directions on it.
    pub(super) axes: [DVec3; 2],
    /// Its convex parts, as cells.
    pub(super) roots: Vec<usize>,
}

/// All cells of all reflecting surfaces.
pub(super) struct Tree {
    /// The cells; a cell comes before its children.
    pub(super) cells: Vec<Cell>,
    /// The surfaces.
    pub(super) reflectors: Vec<Reflector>,
    /// Cells of the mesh.
    pub(super) base: Vec<usize>,
    /// Cells that were halved, in this order: halving them again in it makes
    /// the same tree.
    pub(super) halved: Vec<usize>,
    /// Area of all reflecting surfaces in m².
    pub(super) area: f64,
    dense: Rule,
}

impl Tree {
    /// No surface at all.
    pub(super) fn empty() -> Self {
        Self {
            cells: Vec::new(),
            reflectors: Vec::new(),
            base: Vec::new(),
            halved: Vec::new(),
            area: 0.0,
            dense: Rule::new(DENSE),
        }
    }

    /// The reflecting surfaces, each convex part of them one cell.
    pub(super) fn new(scene: &Scene) -> Result<Self, Error> {
        let mut tree = Self::empty();
        for exposed in exposed(scene)? {
            let surface = &scene.surfaces[exposed.surface];
            tree.reflectors.push(Reflector {
                outline: Outline::new(scene, surface),
                reflectance: surface.reflectance,
                axes: exposed.axes,
                roots: Vec::new(),
            });
            let reflector = tree.reflectors.len() - 1;
            for part in exposed.parts {
                let root = tree.push(reflector, part, 0);
                tree.area += tree.cells[root].area;
                tree.reflectors[reflector].roots.push(root);
            }
        }
        Ok(tree)
    }

    /// Halves the parts of surfaces into about `count` cells of like size and
    /// returns them.
    pub(super) fn even(&mut self, count: usize) -> Vec<usize> {
        let size = (self.area / count as f64).sqrt();
        let mut pending: Vec<usize> = self
            .reflectors
            .iter()
            .flat_map(|r| r.roots.clone())
            .collect();
        let mut cells = Vec::new();
        while let Some(index) = pending.pop() {
            let large = self.longest(index) > 1.5 * size;
            match large.then(|| self.halve(index)).flatten() {
                Some(halves) => pending.extend(halves),
                None => cells.push(index),
            }
        }
        cells.sort_unstable();
        cells
    }

    fn push(&mut self, reflector: usize, outline: Loop, depth: u32) -> usize {
        let surface = &self.reflectors[reflector];
        let (centre, radius) = convex::ball(&outline);
        self.cells.push(Cell {
            reflector,
            frame: Frame::of(&outline, surface.axes),
            area: convex::area(&outline, surface.outline.normal),
            outline,
            centre,
            radius,
            children: None,
            role: Role::Above,
            light: None,
            depth,
        });
        self.cells.len() - 1
    }

    /// The longer extent of a cell.
    fn longest(&self, index: usize) -> f64 {
        let cell = &self.cells[index];
        let extents = self.reflectors[cell.reflector].axes.map(|axis| {
            let (low, high) = convex::extent(&cell.outline, axis);
            high - low
        });
        extents[0].max(extents[1])
    }

    /// The halves of a cell; `None` where it is too small to have any.
    pub(super) fn halve(&mut self, index: usize) -> Option<[usize; 2]> {
        let cell = &self.cells[index];
        if cell.children.is_none() && cell.depth < DEEPEST {
            let (reflector, depth) = (cell.reflector, cell.depth + 1);
            let halves = convex::halves(&cell.outline, self.reflectors[reflector].axes);
            if halves.iter().all(|half| half.len() >= 3) {
                let children = halves.map(|half| self.push(reflector, half, depth));
                self.cells[index].children = Some(children);
                self.halved.push(index);
            }
        }
        self.cells[index].children
    }

    /// Makes `base` the mesh.
    pub(super) fn set_base(&mut self, base: Vec<usize>) {
        for cell in &mut self.cells {
            cell.role = Role::Above;
        }
        for &index in &base {
            self.cells[index].role = Role::Base;
        }
        // A cell comes before its children.
        for index in 0..self.cells.len() {
            let cell = &self.cells[index];
            if let (Role::Base | Role::Below, Some(children)) = (cell.role, cell.children) {
                children
                    .into_iter()
                    .for_each(|child| self.cells[child].role = Role::Below);
            }
        }
        self.base = base;
    }

    /// Learns the direct light on every cell of the mesh and halves what a
    /// polynomial misses by more than `allowed`: roughness times the share in
    /// the area of all surfaces. `direct` is the irradiance at a place,
    /// `scale` the mean irradiance of each channel.
    pub(super) fn light(
        &mut self,
        allowed: f64,
        scale: &[f64],
        direct: &(dyn Fn(&Receiver) -> [f64; 3] + Sync),
    ) {
        let mut frontier = self.base.clone();
        while !frontier.is_empty() {
            let found: Vec<Option<Light>> = frontier
                .par_iter()
                .map(|&index| {
                    let dark = self.cells[index].light.is_none();
                    dark.then(|| self.learn(index, scale, direct))
                })
                .collect();
            let mut next = Vec::new();
            for (&index, light) in frontier.iter().zip(found) {
                if light.is_some() {
                    self.cells[index].light = light;
                }
                let cell = &self.cells[index];
                let roughness = cell.light.as_ref().map_or(0.0, |light| light.roughness);
                if roughness * cell.area > allowed * self.area
                    && let Some(children) = self.halve(index)
                {
                    children
                        .into_iter()
                        .for_each(|child| self.cells[child].role = Role::Below);
                    next.extend(children);
                }
            }
            frontier = next;
        }
    }

    fn learn(
        &self,
        index: usize,
        scale: &[f64],
        direct: &(dyn Fn(&Receiver) -> [f64; 3] + Sync),
    ) -> Light {
        let cell = &self.cells[index];
        let reflector = &self.reflectors[cell.reflector];
        let places = places(&cell.outline, &self.dense);
        let fit = Fit::new(&cell.frame, &places);
        let values: Vec<[f64; 3]> = places
            .iter()
            .map(|place| direct(&reflector.receiver(place.0)))
            .collect();
        let mut roughness = 0.0_f64;
        let polynomials = scale.iter().enumerate().map(|(channel, scale)| {
            let values = || values.iter().map(|value| value[channel]);
            let irradiance = fit.polynomial(values());
            let share = reflector.reflectance[channel];
            if *scale > 0.0 {
                roughness = roughness.max(share * fit.residual(&irradiance, values()) / scale);
            }
            irradiance.map(|coefficient| share / PI * coefficient)
        });
        let direct: Vec<Polynomial> = polynomials.collect();
        Light {
            total: direct.clone(),
            direct,
            roughness,
        }
    }

    /// Adds `radiance` (for each cell of the mesh the polynomials of each
    /// channel) to the direct light of the mesh and of all cells below.
    pub(super) fn add(&mut self, radiance: &[Vec<Polynomial>]) {
        let mut pending: Vec<(usize, usize)> = self.base.iter().copied().zip(0..).collect();
        while let Some((index, base)) = pending.pop() {
            let root = self.cells[self.base[base]].frame;
            let cell = &mut self.cells[index];
            let frame = cell.frame;
            let Some(light) = &mut cell.light else {
                continue;
            };
            light.total = light
                .direct
                .iter()
                .zip(&radiance[base])
                .map(|(direct, more)| {
                    let more = root.carried(more, &frame);
                    let mut sum = [0.0; TERMS];
                    let parts = direct.iter().zip(more);
                    sum.iter_mut().zip(parts).for_each(|(s, (d, m))| *s = d + m);
                    sum
                })
                .collect();
            let children = cell.children.into_iter().flatten();
            pending.extend(children.map(|child| (child, base)));
        }
    }
}

impl Reflector {
    /// A place of the surface as a receiver.
    pub(super) fn receiver(&self, position: DVec3) -> Receiver {
        Receiver {
            position,
            normal: self.outline.normal,
        }
    }
}

/// The nodes of a polygon with their areas.
pub(super) fn places(polygon: &[DVec3], rule: &Rule) -> Vec<(DVec3, f64)> {
    let mut places = Vec::new();
    convex::nodes(polygon, rule, |place, weight| places.push((place, weight)));
    places
}
