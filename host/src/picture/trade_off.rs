//! Error against cost, both logarithmic, with the Pareto front.

use super::axes::{heading, heading_height};
use super::canvas::{Anchor, BODY, Canvas, Frame, GREY, Pen, Rgb, SMALL};
use super::{Picture, PictureError, text};

/// One panel of the plot.
#[derive(Clone, Debug)]
pub struct TradePanel {
    /// What the cost is, with its unit.
    pub cost: String,
    /// What the error is, with its unit.
    pub error: String,
    /// What is placed.
    pub marks: Vec<TradeMark>,
    /// What is placed and belongs together.
    pub lines: Vec<TradeLine>,
}

/// One way of doing it with rising effort.
#[derive(Clone, Debug)]
pub struct TradeLine {
    /// Its label, at its last point.
    pub name: String,
    /// Cost and error, each above 0.
    pub points: Vec<[f64; 2]>,
}

/// A choice with its cost and error.
#[derive(Clone, Debug)]
pub struct TradeMark {
    /// Its label.
    pub name: String,
    /// What it costs, above 0.
    pub cost: f64,
    /// How wrong it is, above 0.
    pub error: f64,
    /// Whether it is on the Pareto front.
    pub on_front: bool,
}

const FRONT: Rgb = [0, 98, 155];
const BEATEN: Rgb = [190, 84, 24];
/// Colours of lines, one after the other.
const LINES: [Rgb; 6] = [
    BEATEN,
    FRONT,
    [0, 128, 90],
    [120, 70, 160],
    [86, 180, 233],
    [120, 120, 120],
];
const FAINT: Rgb = [226, 226, 226];

/// Size of a panel's map in pixels.
const SIDE: [f32; 2] = [560.0, 470.0];
/// Left of a map: labels and name of the axis.
const LEFT: f32 = 108.0;
const BELOW: f32 = 76.0;
const RIGHT: f32 = 30.0;
/// Radius of a mark, and of a line's point.
const RADIUS: f32 = 6.5;
const POINT: f32 = 4.0;

/// Draws panels side by side. A mark or point whose cost or error is not above 0 has no
/// place on a logarithmic axis and is left out.
///
/// # Errors
/// [`PictureError::Inconsistent`] where a panel has nothing to place;
/// [`PictureError::Size`] with too many panels.
pub fn trade_off(
    title: &str,
    captions: &[String],
    panels: &[TradePanel],
) -> Result<Picture, PictureError> {
    let top = heading_height(captions.len());
    let width = panels.len() as f32 * (LEFT + SIDE[0] + RIGHT);
    let height = top + SIDE[1] + BELOW;
    let mut canvas = Canvas::new(width as usize, height as usize)?;
    heading(&mut canvas, title, captions);
    for (index, panel) in panels.iter().enumerate() {
        let left = LEFT + index as f32 * (LEFT + SIDE[0] + RIGHT);
        Panel::new(panel, Frame::new(left, top, SIDE[0], SIDE[1]))?.draw(&mut canvas);
    }
    Ok(Picture { canvas })
}

/// A logarithmic axis.
#[derive(Clone, Copy)]
struct Axis {
    low: f64,
    high: f64,
}

impl Axis {
    /// Room for the values and a margin on both sides, in decades.
    fn fit(values: impl Iterator<Item = f64>) -> Option<Self> {
        let (low, high) = values.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), x| {
            (low.min(x.log10()), high.max(x.log10()))
        });
        let margin = (0.12 * (high - low)).max(0.05);
        (low.is_finite() && high.is_finite()).then_some(Self {
            low: low - margin,
            high: high + margin,
        })
    }

    fn place(&self, value: f64) -> f32 {
        ((value.log10() - self.low) / (self.high - self.low)) as f32
    }

    /// Whole decades where there are three or more, else 1, 2 and 5 of each,
    /// else every digit.
    fn ticks(&self) -> Vec<f64> {
        let span = self.high - self.low;
        let digits: &[f64] = match span {
            2.5.. => &[1.0],
            0.8.. => &[1.0, 2.0, 5.0],
            0.4.. => &[1.0, 1.5, 2.0, 3.0, 4.0, 5.0, 6.0, 8.0],
            _ => &[
                1.0, 1.2, 1.4, 1.6, 1.8, 2.0, 2.5, 3.0, 3.5, 4.0, 4.5, 5.0, 5.5, 6.0, 7.0, 8.0, 9.0,
            ],
        };
        let decades = (self.low.floor() as i32)..=(self.high.ceil() as i32);
        // Too many decades are thinned.
        let step = (span / 9.0).ceil().max(1.0) as i32;
        decades
            .filter(|decade| decade.rem_euclid(step) == 0)
            .flat_map(|decade| digits.iter().map(move |digit| digit * 10_f64.powi(decade)))
            .filter(|tick| (0.0..=1.0).contains(&self.place(*tick)))
            .collect()
    }
}

/// A value at a tick: as people write it.
fn label(value: f64) -> String {
    if (0.01..100_000.0).contains(&value) {
        format!("{}", (value * 1e6).round() / 1e6)
    } else {
        format!("{value:.0e}")
    }
}

struct Panel<'a> {
    source: &'a TradePanel,
    marks: Vec<&'a TradeMark>,
    /// Colour, name and places of each line.
    lines: Vec<(Rgb, &'a str, Vec<[f64; 2]>)>,
    map: Frame,
    cost: Axis,
    error: Axis,
}

impl<'a> Panel<'a> {
    fn new(source: &'a TradePanel, map: Frame) -> Result<Self, PictureError> {
        let has_place = |at: &[f64; 2]| at.iter().all(|x| *x > 0.0 && x.is_finite());
        let marks = source.marks.iter();
        let marks: Vec<_> = marks.filter(|m| has_place(&[m.cost, m.error])).collect();
        let colours = LINES.iter().copied().cycle();
        let lines = source.lines.iter().zip(colours).map(|(line, colour)| {
            let points = line.points.iter().copied().filter(has_place);
            (colour, line.name.as_str(), points.collect::<Vec<_>>())
        });
        let lines: Vec<_> = lines.filter(|(.., at)| !at.is_empty()).collect();
        let all = || {
            let of_lines = lines.iter().flat_map(|(.., at)| at.iter().copied());
            marks
                .iter()
                .map(|mark| [mark.cost, mark.error])
                .chain(of_lines)
        };
        let cost = Axis::fit(all().map(|[cost, _]| cost));
        let error = Axis::fit(all().map(|[_, error]| error));
        let (Some(cost), Some(error)) = (cost, error) else {
            return Err(PictureError::Inconsistent(format!(
                "nothing has a place on the axes of {} and {}",
                source.cost, source.error
            )));
        };
        Ok(Self {
            source,
            marks,
            lines,
            map,
            cost,
            error,
        })
    }

    fn pixel(&self, mark: &TradeMark) -> [f32; 2] {
        self.pixel_of([mark.cost, mark.error])
    }

    fn pixel_of(&self, [cost, error]: [f64; 2]) -> [f32; 2] {
        [
            self.map.x + self.map.width * self.cost.place(cost),
            self.map.bottom() - self.map.height * self.error.place(error),
        ]
    }

    fn draw(&self, canvas: &mut Canvas) {
        self.axes(canvas);
        let mut front: Vec<&TradeMark> =
            self.marks.iter().copied().filter(|m| m.on_front).collect();
        front.sort_by(|a, b| a.cost.total_cmp(&b.cost).then(b.error.total_cmp(&a.error)));
        let steps = self.steps(&front);
        canvas.stroke(&steps, false, Pen::new(FRONT, 2.0, 0.55));
        let mut taken: Vec<Frame> = self
            .marks
            .iter()
            .map(|mark| around(self.pixel(mark), RADIUS))
            .collect();
        // The front's own line is no place for a label either.
        taken.extend(steps.windows(2).map(|pair| {
            let (low, high) = (
                [0, 1].map(|k| pair[0][k].min(pair[1][k])),
                [0, 1].map(|k| pair[0][k].max(pair[1][k])),
            );
            Frame::new(low[0], low[1], high[0] - low[0], high[1] - low[1])
        }));
        for mark in &self.marks {
            self.mark(canvas, mark, &mut taken);
        }
        self.draw_lines(canvas, &mut taken);
    }

    fn draw_lines(&self, canvas: &mut Canvas, taken: &mut Vec<Frame>) {
        let pixels = |points: &[[f64; 2]]| points.iter().map(|&at| self.pixel_of(at)).collect();
        let lines: Vec<Vec<[f32; 2]>> = self.lines.iter().map(|(.., at)| pixels(at)).collect();
        for (points, &(colour, ..)) in lines.iter().zip(&self.lines) {
            canvas.stroke(points, false, Pen::new(colour, 2.0, 0.8));
            for &point in points {
                canvas.fill_loops(&[circle(point, POINT)], colour, 1.0);
                taken.push(around(point, POINT));
            }
            // The line itself is no place for a name.
            for pair in points.windows(2) {
                let along = |t: f32| [0, 1].map(|k| pair[0][k] + t * (pair[1][k] - pair[0][k]));
                let parts = (1..16_u8).map(|k| along(f32::from(k) / 16.0));
                taken.extend(parts.map(|at| around(at, 1.0)));
            }
        }
        for ((_, name, _), points) in self.lines.iter().zip(&lines) {
            if let Some(&last) = points.last() {
                self.name(canvas, name, last, taken);
            }
        }
    }

    /// The front as a staircase: what a cost buys at the most.
    fn steps(&self, front: &[&TradeMark]) -> Vec<[f32; 2]> {
        let mut points: Vec<[f32; 2]> = Vec::new();
        for mark in front {
            let [x, y] = self.pixel(mark);
            if let Some(&[_, before]) = points.last() {
                points.push([x, before]);
            }
            points.push([x, y]);
        }
        points
    }

    fn mark(&self, canvas: &mut Canvas, mark: &TradeMark, taken: &mut Vec<Frame>) {
        let [x, y] = self.pixel(mark);
        let colour = if mark.on_front { FRONT } else { BEATEN };
        let circle = circle([x, y], RADIUS);
        if mark.on_front {
            canvas.fill_loops(&[circle], colour, 1.0);
        } else {
            canvas.stroke(&circle, true, Pen::new(colour, 2.0, 1.0));
        }
        self.name(canvas, &mark.name, [x, y], taken);
    }

    /// Writes a name beside a place.
    fn name(&self, canvas: &mut Canvas, name: &str, [x, y]: [f32; 2], taken: &mut Vec<Frame>) {
        let half = [text::width(name, BODY) / 2.0, 0.5 * BODY];
        let (place, far) = self.free(&[x, y], half, taken);
        taken.push(Frame::new(
            place[0] - half[0],
            place[1] - half[1],
            2.0 * half[0],
            2.0 * half[1],
        ));
        if far {
            let near = x.clamp(place[0] - half[0], place[0] + half[0]);
            let end = [near, place[1] + half[1].copysign(y - place[1])];
            canvas.stroke(&[[x, y], end], false, Pen::new(GREY, 1.0, 0.8));
        }
        canvas.text(name, place, BODY, Anchor::Middle);
    }

    /// The middle of the first free place for a label, to the right first, and
    /// whether it needs a line to its mark because it is not beside it.
    fn free(&self, mark: &[f32; 2], half: [f32; 2], taken: &[Frame]) -> ([f32; 2], bool) {
        const TURNS: [[f32; 2]; 8] = [
            [1.0, 0.0],
            [1.0, -1.0],
            [1.0, 1.0],
            [-1.0, 0.0],
            [-1.0, -1.0],
            [-1.0, 1.0],
            [0.0, -1.0],
            [0.0, 1.0],
        ];
        let place = |ring: usize, turn: [f32; 2]| {
            let gap = RADIUS + 7.0 + 13.0 * ring as f32;
            [0, 1].map(|k| mark[k] + turn[k] * (half[k] + gap * if k == 0 { 1.0 } else { 0.8 }))
        };
        let free = |at: [f32; 2]| {
            let frame = Frame::new(
                at[0] - half[0],
                at[1] - half[1],
                2.0 * half[0],
                2.0 * half[1],
            );
            let inside = self.map.holds(&frame, 2.0);
            inside && !taken.iter().any(|other| other.meets(&frame, 5.0))
        };
        // Beside its own mark a label must not be as close to another's.
        let told_apart = |at: [f32; 2]| {
            let distance = |mark: [f32; 2]| {
                let gap = [0, 1].map(|k| ((at[k] - mark[k]).abs() - half[k]).max(0.0));
                gap[0].hypot(gap[1])
            };
            let others = self.marks.iter().map(|other| self.pixel(other));
            let mut others = others.filter(|other| other != mark);
            others.all(|other| distance(other) > distance(*mark) + 3.0)
        };
        let beside = TURNS.map(|turn| place(0, turn));
        if let Some(found) = beside.into_iter().find(|&at| free(at) && told_apart(at)) {
            return (found, false);
        }
        // Straight above or below first, as far inside as it takes: short lines that cross
        // nothing.
        let inside = |at: [f32; 2]| {
            let (low, high) = (self.map.x + half[0] + 3.0, self.map.right() - half[0] - 3.0);
            [at[0].clamp(low, high.max(low)), at[1]]
        };
        let turns = [0.0, -0.5, 0.5, -1.0, 1.0].map(|x| [[x, 1.0], [x, -1.0]]);
        let turns = turns.into_iter().flatten();
        let rings = (1..16).flat_map(|ring| turns.clone().map(move |turn| place(ring, turn)));
        let found = rings.map(inside).find(|&at| free(at));
        (found.unwrap_or(inside(beside[0])), true)
    }

    fn axes(&self, canvas: &mut Canvas) {
        let map = self.map;
        let mut free_from = f32::NEG_INFINITY;
        for tick in self.cost.ticks() {
            let x = map.x + map.width * self.cost.place(tick);
            canvas.fill(Frame::new(x.round(), map.y, 1.0, map.height), FAINT, 1.0);
            let name = label(tick);
            let half = text::width(&name, SMALL) / 2.0;
            if x - half > free_from {
                canvas.text(&name, [x, map.bottom() + 19.0], SMALL, Anchor::Middle);
                free_from = x + half + 8.0;
            }
        }
        for tick in self.error.ticks() {
            let y = map.bottom() - map.height * self.error.place(tick);
            canvas.fill(Frame::new(map.x, y.round(), map.width, 1.0), FAINT, 1.0);
            canvas.text(&label(tick), [map.x - 10.0, y], SMALL, Anchor::Right);
        }
        canvas.border(map, GREY);
        let below = [map.x + map.width / 2.0, map.bottom() + 48.0];
        canvas.text(&self.source.cost, below, BODY, Anchor::Middle);
        let beside = [map.x - 82.0, map.y + map.height / 2.0];
        canvas.text_upwards(&self.source.error, beside, BODY);
    }
}

/// The outline of a disc.
fn circle([x, y]: [f32; 2], radius: f32) -> Vec<[f32; 2]> {
    let at = |k: u8| std::f32::consts::TAU * f32::from(k) / 24.0;
    let place = |angle: f32| [x + radius * angle.cos(), y + radius * angle.sin()];
    (0..24).map(at).map(place).collect()
}

fn around([x, y]: [f32; 2], radius: f32) -> Frame {
    Frame::new(x - radius, y - radius, 2.0 * radius, 2.0 * radius)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn panel(marks: &[(f64, f64)]) -> TradePanel {
        let mark = |(index, &(cost, error)): (usize, &(f64, f64))| TradeMark {
            name: format!("rung{index}"),
            cost,
            error,
            on_front: index % 2 == 0,
        };
        TradePanel {
            cost: "cost".to_owned(),
            error: "error".to_owned(),
            marks: marks.iter().enumerate().map(mark).collect(),
            lines: Vec::new(),
        }
    }

    #[test]
    fn ticks_are_few_and_inside() {
        for (low, high) in [(400.0, 900.0), (1e-8, 1.0), (1e-30, 1e30), (5.0, 5.0)] {
            let axis = Axis::fit([low, high].into_iter()).expect("a range");
            let ticks = axis.ticks();
            assert!((1..=20).contains(&ticks.len()), "{low} {high} {ticks:?}");
        }
    }

    #[test]
    fn labels_of_marks_in_one_place_are_apart() {
        let source = panel(&[(1.0, 1.0); 6]);
        let frame = Frame::new(0.0, 0.0, 560.0, 470.0);
        let panel = Panel::new(&source, frame).expect("marks");
        let mut taken: Vec<Frame> = vec![around(panel.pixel(panel.marks[0]), RADIUS)];
        let mut canvas = Canvas::new(600, 500).expect("a page");
        for mark in &panel.marks {
            panel.mark(&mut canvas, mark, &mut taken);
        }
        for (index, one) in taken.iter().enumerate() {
            let others = &taken[index + 1..];
            assert!(
                others.iter().all(|other| !one.meets(other, 0.0)),
                "{taken:?}"
            );
        }
    }

    #[test]
    fn names_of_lines_stay_inside_and_apart() {
        // The last line ends in the corner, between others and the frame.
        let lines: [(&str, &[[f64; 2]]); 4] = [
            (
                "cone, linear",
                &[[1768.0, 61.9], [5536.0, 42.0], [10832.0, 14.5]],
            ),
            (
                "tensor, points",
                &[[3684.0, 0.32], [6676.0, 0.105], [12816.0, 0.139]],
            ),
            (
                "few-points",
                &[[1052.0, 26.8], [1660.0, 0.45], [4072.0, 0.16]],
            ),
            (
                "stencil, linear",
                &[
                    [7160.0, 3.2],
                    [8748.0, 0.58],
                    [10656.0, 0.237],
                    [21456.0, 0.233],
                ],
            ),
        ];
        let source = TradePanel {
            lines: lines
                .map(|(name, points)| TradeLine {
                    name: name.to_owned(),
                    points: points.to_vec(),
                })
                .into(),
            ..panel(&[])
        };
        let frame = Frame::new(0.0, 0.0, SIDE[0], SIDE[1]);
        let panel = Panel::new(&source, frame).expect("lines");
        let mut taken = Vec::new();
        panel.draw_lines(&mut Canvas::new(600, 500).expect("a page"), &mut taken);
        let names = &taken[taken.len() - lines.len()..];
        for (index, name) in names.iter().enumerate() {
            assert!(frame.holds(name, 0.0), "{name:?}");
            let others = taken[..taken.len() - lines.len() + index].iter();
            assert!(
                !others.clone().any(|other| name.meets(other, 0.0)),
                "{name:?}"
            );
        }
    }

    #[test]
    fn what_has_no_place_is_left_out_or_refused() {
        let drawn = trade_off("t", &[], &[panel(&[(1.0, 0.0), (2.0, 1e-7)])]);
        assert!(drawn.is_ok(), "{drawn:?}");
        for marks in [&[][..], &[(0.0, 1.0)], &[(1.0, f64::NAN)]] {
            assert!(trade_off("t", &[], &[panel(marks)]).is_err(), "{marks:?}");
        }
        assert!(trade_off("t", &[], &[]).is_err());
    }
}
