//! Isolux contours by marching squares, and their labels.
//!
//! The marching squares are the `contour` crate's, which draws rings closed
//! along the border of the grid. Here the grid is extended beyond the surface by
//! repeating its border values, and whatever runs outside of the surface is
//! dropped again, so that lines end where the surface does.

use contour::ContourBuilder;

use super::canvas::{Anchor, Canvas, Frame, INK, Pen, SMALL, WHITE};
use super::{PictureError, scale, text};

/// Cells added on each side of the grid.
const PADDING: usize = 2;

/// The lines of one level, in cells from the grid's corner: the middle of the
/// first cell is (0.5, 0.5).
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Isoline {
    pub(super) level: f64,
    pub(super) lines: Vec<Vec<[f64; 2]>>,
}

/// The lines of one level in pixels of the page.
pub(super) struct DrawnIsoline {
    pub(super) level: f64,
    pub(super) lines: Vec<Vec<[f32; 2]>>,
}

impl Isoline {
    /// The same lines on the page, where `pixel` says each place lies.
    pub(super) fn drawn(&self, pixel: impl Fn([f64; 2]) -> [f32; 2]) -> DrawnIsoline {
        let line = |line: &Vec<[f64; 2]>| line.iter().map(|at| pixel(*at)).collect();
        DrawnIsoline {
            level: self.level,
            lines: self.lines.iter().map(line).collect(),
        }
    }
}

/// The isolines of a grid where `inside`; both slices hold columns · rows
/// cells, row by row.
pub(super) fn isolines(
    values: &[f64],
    inside: &[bool],
    columns: usize,
    rows: usize,
    levels: &[f64],
) -> Result<Vec<Isoline>, PictureError> {
    if columns == 0 || rows == 0 {
        return Ok(Vec::new());
    }
    let extended = extend(values, inside, columns, rows);
    let (wide, high) = (columns + 2 * PADDING, rows + 2 * PADDING);
    let contours = ContourBuilder::new(wide, high, true)
        .lines(&extended, levels)
        .map_err(|error| PictureError::Inconsistent(format!("contours: {error}")))?;
    let padding = PADDING as f64;
    let keep = |at: [f64; 2]| {
        let column = at[0].floor();
        let row = at[1].floor();
        column >= 0.0
            && row >= 0.0
            && column < columns as f64
            && row < rows as f64
            && inside[row as usize * columns + column as usize]
    };
    Ok(contours
        .into_iter()
        .map(|contour| {
            let (rings, level) = contour.into_inner();
            let lines = rings
                .into_iter()
                .flat_map(|ring| {
                    let points: Vec<_> = ring
                        .into_iter()
                        .map(|point| [point.x - padding, point.y - padding])
                        .collect();
                    // A line's last segment may reach half a cell beyond the grid.
                    let mut pieces = split(&points, keep);
                    for point in pieces.iter_mut().flatten() {
                        point[0] = point[0].clamp(0.0, columns as f64);
                        point[1] = point[1].clamp(0.0, rows as f64);
                    }
                    pieces
                })
                .collect();
            Isoline { level, lines }
        })
        .collect())
}

/// The pieces of a line whose segments have their middle where `keep`.
fn split(points: &[[f64; 2]], keep: impl Fn([f64; 2]) -> bool) -> Vec<Vec<[f64; 2]>> {
    let mut pieces: Vec<Vec<[f64; 2]>> = Vec::new();
    let mut running = false;
    for pair in points.windows(2) {
        let middle = [
            (pair[0][0] + pair[1][0]) / 2.0,
            (pair[0][1] + pair[1][1]) / 2.0,
        ];
        let kept = keep(middle);
        match pieces.last_mut() {
            Some(piece) if kept && running => piece.push(pair[1]),
            _ if kept => pieces.push(pair.to_vec()),
            _ => {}
        }
        running = kept;
    }
    pieces
}

/// The grid with [`PADDING`] more cells on each side; cells within two of the
/// surface repeat the mean of its nearest cells, the rest hold nothing that a
/// level could pass between.
fn extend(values: &[f64], inside: &[bool], columns: usize, rows: usize) -> Vec<f64> {
    let (wide, high) = (columns + 2 * PADDING, rows + 2 * PADDING);
    let mut grid: Vec<Option<f64>> = vec![None; wide * high];
    for row in 0..rows {
        for column in 0..columns {
            let from = row * columns + column;
            if inside[from] && values[from].is_finite() {
                grid[(row + PADDING) * wide + column + PADDING] = Some(values[from]);
            }
        }
    }
    for _ in 0..PADDING {
        let known = grid.clone();
        for row in 0..high {
            for column in 0..wide {
                if known[row * wide + column].is_some() {
                    continue;
                }
                let (mut sum, mut count) = (0.0, 0_u32);
                for y in row.saturating_sub(1)..(row + 2).min(high) {
                    for x in column.saturating_sub(1)..(column + 2).min(wide) {
                        if let Some(value) = known[y * wide + x] {
                            sum += value;
                            count += 1;
                        }
                    }
                }
                if count > 0 {
                    grid[row * wide + column] = Some(sum / f64::from(count));
                }
            }
        }
    }
    let lowest = grid.iter().flatten().fold(f64::INFINITY, |a, b| a.min(*b));
    let lowest = if lowest.is_finite() { lowest } else { 0.0 };
    grid.into_iter()
        .map(|cell| cell.unwrap_or(lowest))
        .collect()
}

/// Draws isolines, white with a dark rim so that
/// they stand out on every colour of the map.
pub(super) fn draw_lines(canvas: &mut Canvas, isolines: &[DrawnIsoline]) {
    for pen in [Pen::new(INK, 3.2, 0.45), Pen::new(WHITE, 1.5, 1.0)] {
        for isoline in isolines {
            for line in &isoline.lines {
                canvas.stroke(line, false, pen);
            }
        }
    }
}

/// A second label of one level is at least this many pixels from the first.
const APART: f32 = 260.0;

/// Writes each level on its lines, at most twice, where the label stays within
/// `frame` and where `free`, off the labels in `taken` and, as far as can be,
/// off other lines. A level without such a place goes without: its colour is
/// in the legend.
pub(super) fn draw_labels(
    canvas: &mut Canvas,
    isolines: &[DrawnIsoline],
    frame: Frame,
    free: impl Fn([f32; 2]) -> bool,
    taken: &mut Vec<Frame>,
) {
    for isoline in isolines {
        let label = scale::label(isoline.level);
        let size = [text::width(&label, SMALL) + 8.0, SMALL + 4.0];
        let mut own: Vec<[f32; 2]> = Vec::new();
        for _ in 0..2 {
            let fits = |at: [f32; 2]| {
                let place = around(at, size);
                // With room above and beneath, so that narrow surfaces are not
                // covered by their labels.
                let (top, bottom) = (place.y - size[1] / 2.0, place.bottom() + size[1] / 2.0);
                frame.holds(&place, 12.0)
                    && !taken.iter().any(|other| place.meets(other, 5.0))
                    && own.iter().all(|other| distance(*other, at) > APART)
                    && [place.x, place.right()]
                        .iter()
                        .all(|x| free([*x, top]) && free([*x, bottom]))
            };
            let Some(at) = best_place(isolines, isoline, size, fits) else {
                break;
            };
            let place = around(at, size);
            canvas.fill(place, WHITE, 0.88);
            canvas.text(&label, at, SMALL, Anchor::Middle);
            taken.push(place);
            own.push(at);
        }
    }
}

fn around(at: [f32; 2], size: [f32; 2]) -> Frame {
    Frame::new(
        at[0] - size[0] / 2.0,
        at[1] - size[1] / 2.0,
        size[0],
        size[1],
    )
}

/// Where on the lines of one level a label of `size` that `fits` crosses the
/// fewest other lines; of equals the one on the longest line.
fn best_place(
    isolines: &[DrawnIsoline],
    isoline: &DrawnIsoline,
    size: [f32; 2],
    fits: impl Fn([f32; 2]) -> bool,
) -> Option<[f32; 2]> {
    let mut best: Option<(f32, [f32; 2])> = None;
    for line in &isoline.lines {
        let length = length(line);
        // A label must not hide the line it names.
        if length < 2.5 * size[0] {
            continue;
        }
        for step in 1..24 {
            let Some(at) = along(line, length * step as f32 / 24.0).filter(|at| fits(*at)) else {
                continue;
            };
            let crossed = crossings(isolines, isoline.level, &around(at, size));
            let cost = crossed as f32 - 1e-4 * length;
            if best.is_none_or(|(least, _)| cost < least) {
                best = Some((cost, at));
            }
        }
    }
    best.map(|(_, at)| at)
}

/// How many points of other levels' lines a label would hide.
fn crossings(isolines: &[DrawnIsoline], level: f64, label: &Frame) -> usize {
    isolines
        .iter()
        .filter(|other| other.level != level)
        .flat_map(|other| other.lines.iter().flatten())
        .filter(|point| label.meets(&Frame::new(point[0], point[1], 0.0, 0.0), 3.0))
        .count()
}

fn length(line: &[[f32; 2]]) -> f32 {
    line.windows(2).map(|pair| distance(pair[0], pair[1])).sum()
}

fn distance(a: [f32; 2], b: [f32; 2]) -> f32 {
    (a[0] - b[0]).hypot(a[1] - b[1])
}

/// The place `way` along the line.
fn along(line: &[[f32; 2]], way: f32) -> Option<[f32; 2]> {
    let mut gone = 0.0;
    for pair in line.windows(2) {
        let step = distance(pair[0], pair[1]);
        if gone + step >= way && step > 0.0 {
            let share = (way - gone) / step;
            return Some(std::array::from_fn(|axis| {
                pair[0][axis] + share * (pair[1][axis] - pair[0][axis])
            }));
        }
        gone += step;
    }
    None
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A cone whose isolines are circles about (10, 10) of radius 10 - level.
    fn cone(columns: usize, rows: usize) -> Vec<f64> {
        (0..rows * columns)
            .map(|cell| {
                let x = (cell % columns) as f64 + 0.5 - 10.0;
                let y = (cell / columns) as f64 + 0.5 - 10.0;
                10.0 - x.hypot(y)
            })
            .collect()
    }

    #[test]
    fn a_cone_has_circles() {
        let lines = isolines(&cone(20, 20), &[true; 400], 20, 20, &[4.0]).unwrap();
        assert_eq!(lines.len(), 1);
        assert_eq!(lines[0].lines.len(), 1);
        for point in &lines[0].lines[0] {
            let radius = (point[0] - 10.0).hypot(point[1] - 10.0);
            assert!((radius - 6.0).abs() < 0.05, "{radius}");
        }
    }

    #[test]
    fn lines_end_at_the_surface_and_do_not_follow_its_border() {
        // Only the left half is surface: a half circle that ends at x = 10.
        let inside: Vec<bool> = (0..400).map(|cell| cell % 20 < 10).collect();
        let lines = isolines(&cone(20, 20), &inside, 20, 20, &[4.0]).unwrap();
        let points: Vec<_> = lines[0].lines.iter().flatten().collect();
        assert!(points.iter().all(|point| point[0] <= 10.5));
        let length: f64 = lines[0]
            .lines
            .iter()
            .flat_map(|line| line.windows(2))
            .map(|pair| (pair[0][0] - pair[1][0]).hypot(pair[0][1] - pair[1][1]))
            .sum();
        let half_circle = std::f64::consts::PI * 6.0;
        assert!((length - half_circle).abs() < 1.2, "{length} {half_circle}");
    }

    #[test]
    fn lines_reach_the_edge_of_the_grid() {
        // A ramp along x: each level is one straight line from edge to edge.
        let ramp: Vec<f64> = (0..50).map(|cell| (cell % 10) as f64).collect();
        let lines = isolines(&ramp, &[true; 50], 10, 5, &[4.5]).unwrap();
        let heights: Vec<f64> = lines[0].lines.iter().flatten().map(|p| p[1]).collect();
        let low = heights.iter().fold(9.0, |a: f64, b| a.min(*b));
        let high = heights.iter().fold(0.0, |a: f64, b| a.max(*b));
        assert!(low <= 0.5 && high >= 4.5, "{low} {high}");
        assert!(
            lines[0]
                .lines
                .iter()
                .flatten()
                .all(|p| (p[0] - 5.0).abs() < 1e-9)
        );
    }

    #[test]
    fn nothing_has_no_lines() {
        assert!(isolines(&[], &[], 0, 0, &[1.0]).unwrap().is_empty());
        let lines = isolines(&[f64::NAN; 4], &[true; 4], 2, 2, &[1.0]).unwrap();
        assert!(lines[0].lines.is_empty());
    }
}
