//! A dense closed curve, and the few of its points that stand for it.

/// A closed curve as a dense loop of places, with some of them chosen.
#[derive(Clone, Debug)]
pub(super) struct Outline {
    points: Vec<[f64; 2]>,
    /// Irradiance at each point.
    values: Vec<f64>,
    /// Length of the curve up to each point.
    lengths: Vec<f64>,
    total: f64,
    /// Indices of the chosen points, ascending.
    chosen: Vec<usize>,
}

/// Deviation, as a fraction of the curve's length, below which a chord counts
/// as the curve itself.
const STRAIGHT: f64 = 1e-3;

impl Outline {
    /// A curve of which the three points that span the most are chosen.
    pub(super) fn new(points: Vec<[f64; 2]>, value: impl Fn([f64; 2]) -> f64) -> Self {
        let mut outline = Self::bare(points, value);
        let first = outline.farthest(|p| p[0] + p[1]);
        let [u, v] = outline.points[first];
        let second = outline.farthest(|p| (p[0] - u).hypot(p[1] - v));
        outline.chosen = vec![first, second];
        outline.chosen.sort_unstable();
        outline.refine(|_| true);
        outline
    }

    /// A curve of which some points must be chosen: the corners of a polygon.
    pub(super) fn with_corners(
        points: Vec<[f64; 2]>,
        corners: Vec<usize>,
        value: impl Fn([f64; 2]) -> f64,
    ) -> Self {
        Self {
            chosen: corners,
            ..Self::bare(points, value)
        }
    }

    fn bare(points: Vec<[f64; 2]>, value: impl Fn([f64; 2]) -> f64) -> Self {
        let mut total = 0.0;
        let lengths = (0..points.len())
            .map(|index| {
                let before = total;
                let next = (index + 1) % points.len();
                total += distance(points[index], points[next]);
                before
            })
            .collect();
        Self {
            values: points.iter().map(|&point| value(point)).collect(),
            points,
            lengths,
            total,
            chosen: Vec::new(),
        }
    }

    fn farthest(&self, measure: impl Fn([f64; 2]) -> f64) -> usize {
        let by = |&a: &usize, &b: &usize| {
            measure(self.points[a])
                .total_cmp(&measure(self.points[b]))
                .then(b.cmp(&a))
        };
        (0..self.points.len()).max_by(by).unwrap_or(0)
    }

    /// The chosen places, in the order of the curve.
    pub(super) fn places(&self) -> impl Iterator<Item = [f64; 2]> + '_ {
        self.chosen.iter().map(|&index| self.points[index])
    }

    /// How many are chosen.
    pub(super) fn len(&self) -> usize {
        self.chosen.len()
    }

    /// Chooses one more: the point farthest from the chord that passes it by;
    /// where all chords follow the curve, the point whose irradiance is farthest
    /// from what lies between its neighbours'; where that is nothing either,
    /// the middle of the longest chord. Only places that are `free` come into
    /// question. Returns whether there was one left.
    pub(super) fn refine(&mut self, free: impl Fn([f64; 2]) -> bool) -> bool {
        let free: Vec<bool> = self.points.iter().map(|&point| free(point)).collect();
        let index = self
            .most_deviating(&free)
            .or_else(|| self.most_curved(&free))
            .or_else(|| self.middle_of_longest(&free));
        let Some(index) = index else { return false };
        let at = self.chosen.partition_point(|&chosen| chosen < index);
        self.chosen.insert(at, index);
        true
    }

    /// Chords as (first index, last index), the last one wrapping round.
    fn chords(&self) -> impl Iterator<Item = (usize, usize)> + '_ {
        let count = self.chosen.len();
        (0..count).map(move |k| {
            let from = self.chosen[k];
            let to = if k + 1 < count {
                self.chosen[k + 1]
            } else {
                self.chosen[0] + self.points.len()
            };
            (from, to)
        })
    }

    fn most_deviating(&self, free: &[bool]) -> Option<usize> {
        let count = self.points.len();
        let mut best = (STRAIGHT * self.total, None);
        for (from, to) in self.chords() {
            let (a, b) = (self.points[from], self.points[to % count]);
            for index in (from + 1..to).filter(|index| free[index % count]) {
                let deviation = distance_to_segment(self.points[index % count], a, b);
                if deviation > best.0 {
                    best = (deviation, Some(index % count));
                }
            }
        }
        best.1
    }

    fn most_curved(&self, free: &[bool]) -> Option<usize> {
        let count = self.points.len();
        let largest = self.values.iter().copied().fold(0.0, f64::max);
        let mut best = (STRAIGHT * largest, None);
        for (from, to) in self.chords() {
            let length = self.along(to) - self.along(from);
            for index in (from + 1..to).filter(|index| free[index % count]) {
                let t = (self.along(index) - self.along(from)) / length;
                let between = self.values[from] * (1.0 - t) + self.values[to % count] * t;
                let deviation = (self.values[index % count] - between).abs();
                if deviation > best.0 {
                    best = (deviation, Some(index % count));
                }
            }
        }
        best.1
    }

    /// Length of the curve up to a point; indices past the end have gone round.
    fn along(&self, index: usize) -> f64 {
        let count = self.points.len();
        self.lengths[index % count] + if index >= count { self.total } else { 0.0 }
    }

    /// Chooses the point nearest to a place, unless it is chosen already, and
    /// gives its place.
    pub(super) fn choose_nearest(&mut self, place: [f64; 2]) -> Option<[f64; 2]> {
        let by = |&a: &usize, &b: &usize| {
            distance(self.points[a], place).total_cmp(&distance(self.points[b], place))
        };
        let index = (0..self.points.len()).min_by(by)?;
        if let Err(at) = self.chosen.binary_search(&index) {
            self.chosen.insert(at, index);
        }
        Some(self.points[index])
    }

    fn middle_of_longest(&self, free: &[bool]) -> Option<usize> {
        let count = self.points.len();
        let mut best = (0.0, None);
        for (from, to) in self.chords().filter(|(from, to)| to - from > 1) {
            let length = self.along(to) - self.along(from);
            // A hair's preference for the earlier of equal chords keeps the
            // choice independent of rounding.
            if length > best.0 * (1.0 + 1e-9) {
                let middle = (self.along(from) + self.along(to)) / 2.0;
                let between = (from + 1..to).filter(|index| free[index % count]);
                let nearest = between.min_by(|&i, &j| {
                    (self.along(i) - middle)
                        .abs()
                        .total_cmp(&(self.along(j) - middle).abs())
                });
                if let Some(index) = nearest {
                    best = (length, Some(index % count));
                }
            }
        }
        best.1
    }
}

fn distance([a, b]: [f64; 2], [c, d]: [f64; 2]) -> f64 {
    (a - c).hypot(b - d)
}

pub(super) fn distance_to_segment(p: [f64; 2], a: [f64; 2], b: [f64; 2]) -> f64 {
    let (e, f) = ([b[0] - a[0], b[1] - a[1]], [p[0] - a[0], p[1] - a[1]]);
    let squared = e[0] * e[0] + e[1] * e[1];
    let t = if squared > 0.0 {
        (f[0] * e[0] + f[1] * e[1]) / squared
    } else {
        0.0
    };
    let t = t.clamp(0.0, 1.0);
    distance(p, [a[0] + t * e[0], a[1] + t * e[1]])
}

/// The signed area of a loop in m²: positive where it runs
/// counter-clockwise.
pub(super) fn signed_area(places: &[[f64; 2]]) -> f64 {
    let next = places.iter().cycle().skip(1);
    places
        .iter()
        .zip(next)
        .map(|(a, b)| a[0] * b[1] - a[1] * b[0])
        .sum::<f64>()
        / 2.0
}
