//! Which triangle a place is in.

use glam::DVec2;

/// Triangles by the cells of a grid that their bounding rectangles meet.
#[derive(Clone, Debug)]
pub(super) struct Index {
    low: DVec2,
    /// Cells per metre.
    scale: DVec2,
    /// Cells along each side.
    side: usize,
    cells: Vec<Vec<usize>>,
}

impl Index {
    /// About as many cells as triangles.
    pub(super) fn new(triangles: Vec<[DVec2; 3]>) -> Self {
        let corners = || triangles.iter().flatten().copied();
        let low = corners().reduce(DVec2::min).unwrap_or_default();
        let high = corners().reduce(DVec2::max).unwrap_or_default();
        let side = (triangles.len() as f64).sqrt().ceil() as usize + 1;
        let mut index = Self {
            low,
            scale: side as f64 / (high - low).max(DVec2::splat(f64::MIN_POSITIVE)),
            side,
            cells: vec![Vec::new(); side * side],
        };
        for (number, [a, b, c]) in triangles.into_iter().enumerate() {
            let [i, j] = index.cell(a.min(b).min(c));
            let [k, l] = index.cell(a.max(b).max(c));
            for row in j..=l {
                for column in i..=k {
                    index.cells[row * side + column].push(number);
                }
            }
        }
        index
    }

    /// The cell of a place, the nearest one of those outside.
    fn cell(&self, place: DVec2) -> [usize; 2] {
        let last = (self.side - 1) as f64;
        let at = (place - self.low) * self.scale;
        at.to_array().map(|x| x.clamp(0.0, last) as usize)
    }

    /// Triangles that may hold a place, in ascending order.
    pub(super) fn near(&self, place: DVec2) -> &[usize] {
        let [column, row] = self.cell(place);
        &self.cells[row * self.side + column]
    }
}

/// The barycentric coordinates of a place.
pub(super) fn barycentric([a, b, c]: [DVec2; 3], place: DVec2) -> [f64; 3] {
    let whole = (b - a).perp_dot(c - a);
    let share = |from: DVec2, to: DVec2| (from - place).perp_dot(to - place) / whole;
    [share(b, c), share(c, a), share(a, b)]
}
