//! Reflected light all over a surface, roughly: what errors of direct light are put in
//! proportion to.

use crate::plan::shadow::Floor;

/// Cells along each side of a surface.
const CELLS: usize = 20;

/// A value for every cell of a surface's bounding rectangle.
pub(super) struct Around<'a> {
    floor: &'a Floor,
    values: Vec<f64>,
}

impl<'a> Around<'a> {
    /// The middles of the cells that are on the surface.
    pub(super) fn places(floor: &Floor) -> Vec<[f64; 2]> {
        let on_it = cells(floor).filter(|&[u, v]| floor.frame.contains(u, v));
        on_it.collect()
    }

    /// From values at these places, in their order; cells that are not on the surface have
    /// the mean.
    pub(super) fn of(floor: &'a Floor, values: &[f64]) -> Self {
        let mean = values.iter().sum::<f64>() / values.len().max(1) as f64;
        let mut known = values.iter().copied();
        let value = |[u, v]: [f64; 2]| match floor.frame.contains(u, v) {
            true => known.next().unwrap_or(mean),
            false => mean,
        };
        Self {
            values: cells(floor).map(value).collect(),
            floor,
        }
    }

    /// The value of the cell that a place is in.
    pub(super) fn at(&self, [u, v]: [f64; 2]) -> f64 {
        let frame = &self.floor.frame;
        let cell = |x: f64, size: f64| ((x / size * CELLS as f64) as usize).min(CELLS - 1);
        self.values[cell(v, frame.size_v) * CELLS + cell(u, frame.size_u)]
    }
}

/// The middles of all cells, those along u first.
fn cells(floor: &Floor) -> impl Iterator<Item = [f64; 2]> + '_ {
    let middle = |k: usize| {
        let (u, v) = floor.frame.cell_center(k % CELLS, k / CELLS, CELLS, CELLS);
        [u, v]
    };
    (0..CELLS * CELLS).map(middle)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{file, shipped};

    #[test]
    fn a_place_has_the_value_of_its_cell() {
        let scene = file::parse("scene.toml", shipped::CORNELL).expect("a scene");
        let floor = Floor::of(&scene, 0).expect("a floor");
        let places = Around::places(&floor);
        let values: Vec<f64> = places.iter().map(|[u, v]| u + 100.0 * v).collect();
        let around = Around::of(&floor, &values);
        for (place, value) in places.iter().zip(values) {
            assert_eq!(around.at(*place), value);
        }
        assert!(around.at([-1.0, -1.0]).is_finite() && around.at([1e9, 1e9]).is_finite());
    }
}
