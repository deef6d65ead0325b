//! The samples and emitter polygons of a plan over their surface, as Figure 4 of
//! Drettakis & Fiume (1992) shows them.

use super::axes::Page;
use super::canvas::{Anchor, BODY, Canvas, Frame, GREY, Pen, Rgb, SMALL, WHITE, mix};
use super::scale::Amounts;
use super::{
    EmitterShape, Picture, PictureError, SampleMark, SamplePlan, SurfaceField, check_rectangle,
    colour_bar, region, scale, text,
};
use crate::report::quantity;

/// More emitters than this are told apart by their tint alone.
const MAX_NUMBERED: usize = 9;
/// How much of its colour an emitter's tint keeps, so that marks stand out.
const TINT: f64 = 0.34;

/// The loops of one emitter, in pixels of the page.
type Loops = Vec<Vec<[f32; 2]>>;

/// Draws a plan: emitters tinted by radiosity and numbered in its order, samples
/// as marks that differ by tag in shape and colour, the irradiance in faint grey
/// beneath where it is given, a legend and axes in metres.
///
/// # Errors
/// [`PictureError::Inconsistent`] where the rectangle or the field is unsound.
pub fn samples(plan: &SamplePlan) -> Result<Picture, PictureError> {
    check_rectangle(&plan.name, plan.low, plan.size)?;
    let title = format!("{}: samples and emitters", plan.name);
    let captions = [format!(
        "{}, {}",
        counted(plan.samples.len(), "sample"),
        counted(plan.emitters.len(), "emitter")
    )];
    let mut page = Page::new(&title, &captions, plan.low, plan.size)?;
    if let Some(field) = &plan.field {
        field.check()?;
        let amounts = Amounts::fit(field.lit());
        let sources = page.sources(field);
        page.field(field, &sources, |cell, _, _| {
            grey(amounts.place(field.values[cell]))
        });
    }
    let tints = tints(&plan.emitters);
    let stacked = stacked(&page, &plan.emitters);
    draw_emitters(&mut page.canvas, &stacked, &tints);
    let rectangle = [
        plan.low,
        [plan.low[0] + plan.size[0], plan.low[1]],
        [plan.low[0] + plan.size[0], plan.low[1] + plan.size[1]],
        [plan.low[0], plan.low[1] + plan.size[1]],
    ];
    page.outline(if plan.outline.is_empty() {
        &rectangle
    } else {
        &plan.outline
    });
    page.axes();
    let tags = tags(plan);
    let size = mark_size(page.map, plan.samples.len());
    for sample in &plan.samples {
        let kind = kind(&tags, &sample.tag);
        let at = page.pixel(sample.position);
        if page.map.meets(&Frame::new(at[0], at[1], 0.0, 0.0), 1.0) {
            Mark::of(kind).draw(&mut page.canvas, at, size);
        }
    }
    if plan.emitters.len() <= MAX_NUMBERED {
        number_emitters(&mut page, &stacked, &plan.samples);
    }
    let shown = plan
        .field
        .as_ref()
        .filter(|field| field_shows(&page, field, &stacked));
    legend(&mut page, plan, &tags, &tints, shown);
    Ok(Picture {
        canvas: page.canvas,
    })
}

/// How large marks are drawn: smaller where there are so many that they would
/// cover each other.
fn mark_size(map: Frame, count: usize) -> f32 {
    // A mark and the space about it are 24 pixels wide.
    let room = (map.width * map.height / count.max(1) as f32).sqrt() / 24.0;
    room.clamp(0.16, 1.0)
}

fn counted(count: usize, what: &str) -> String {
    match count {
        0 => format!("no {what}s"),
        1 => format!("1 {what}"),
        _ => format!("{count} {what}s"),
    }
}

/// The tags in order of appearance.
fn tags(plan: &SamplePlan) -> Vec<&str> {
    let mut tags: Vec<&str> = Vec::new();
    for sample in &plan.samples {
        if !tags.contains(&sample.tag.as_str()) {
            tags.push(&sample.tag);
        }
    }
    tags
}

/// The tags of rooms, each with a mark of its own whatever else is there.
const OF_ROOMS: [&str; 6] = ["lit", "penumbra", "reflected", "contact", "umbra", "view"];

/// Which mark a tag has; others than those of rooms in the order of appearance.
fn kind(tags: &[&str], tag: &str) -> usize {
    let place = |all: &[&str]| all.iter().position(|one| *one == tag);
    place(&OF_ROOMS).or(place(tags)).unwrap_or(0)
}

/// Faint grey from dim (darker) to bright (nearly white).
fn grey(place: f64) -> Rgb {
    [(196.0 + 52.0 * place).round() as u8; 3]
}

/// Viridis by rank of radiosity: equal steps, so that neighbours differ.
fn tints(emitters: &[EmitterShape]) -> Vec<Rgb> {
    let mut order: Vec<usize> = (0..emitters.len()).collect();
    order.sort_by(|a, b| emitters[*a].radiosity.total_cmp(&emitters[*b].radiosity));
    let steps = emitters.len().saturating_sub(1).max(1) as f64;
    let mut tints = vec![WHITE; emitters.len()];
    for (rank, emitter) in order.into_iter().enumerate() {
        tints[emitter] = mix(scale::viridis(rank as f64 / steps), WHITE, TINT);
    }
    tints
}

/// The emitters in the order in which they are drawn, with their loops on the
/// page: larger ones first, so that nested ones stay visible.
fn stacked(page: &Page, emitters: &[EmitterShape]) -> Vec<(usize, Loops)> {
    let mut stacked: Vec<(usize, Loops)> = emitters
        .iter()
        .map(|emitter| emitter.loops.iter().map(|points| page.pixels(points)))
        .map(Iterator::collect)
        .enumerate()
        .collect();
    stacked.sort_by(|a, b| region::area(&b.1).total_cmp(&region::area(&a.1)));
    stacked
}

fn draw_emitters(canvas: &mut Canvas, stacked: &[(usize, Loops)], tints: &[Rgb]) {
    for (index, loops) in stacked {
        canvas.fill_loops(loops, tints[*index], 1.0);
    }
    for points in stacked.iter().flat_map(|(_, loops)| loops) {
        canvas.stroke(points, true, Pen::new([70, 70, 70], 1.3, 1.0));
    }
}

/// Writes each emitter's number where it is farthest from edges, samples and
/// other numbers.
fn number_emitters(page: &mut Page, stacked: &[(usize, Loops)], samples: &[SampleMark]) {
    let mut obstacles: Vec<[f32; 2]> = samples
        .iter()
        .map(|sample| page.pixel(sample.position))
        .collect();
    for (depth, (index, loops)) in stacked.iter().enumerate() {
        let above: Vec<Loops> = stacked[depth + 1..]
            .iter()
            .map(|(_, loops)| loops.clone())
            .collect();
        if let Some(at) = region::roomiest(page.map, loops, &above, &obstacles) {
            let label = (index + 1).to_string();
            let radius = 4.0 + text::width(&label, BODY) / 2.0 + 3.0;
            disc(&mut page.canvas, at, radius, WHITE);
            ring(&mut page.canvas, at, radius, Pen::new(GREY, 1.0, 1.0));
            page.canvas.text(&label, at, BODY, Anchor::Middle);
            obstacles.push(at);
        }
    }
}

/// Whether some of the field is not covered by emitters and so to be explained.
fn field_shows(page: &Page, field: &SurfaceField, stacked: &[(usize, Loops)]) -> bool {
    (0..field.values.len())
        .filter(|cell| field.inside[*cell])
        .any(|cell| {
            let at = page.pixel(field.middle(cell));
            !stacked.iter().any(|(_, loops)| region::inside(loops, at))
        })
}

/// How a kind of sample is drawn. Shapes and colours (Okabe & Ito) differ
/// together, and one inside another stays readable where two tags share a place.
#[derive(Clone, Copy)]
enum Mark {
    Disc(Rgb),
    Ring(Rgb),
    Cross(Rgb),
    Square(Rgb),
    Triangle(Rgb),
    Plus(Rgb),
}

impl Mark {
    /// The mark of a [`kind`] of tag.
    fn of(kind: usize) -> Self {
        const MARKS: [Mark; 6] = [
            Mark::Disc([0, 114, 178]),
            Mark::Ring([213, 94, 0]),
            Mark::Cross([0, 0, 0]),
            Mark::Square([204, 121, 167]),
            Mark::Triangle([0, 158, 115]),
            Mark::Plus([230, 159, 0]),
        ];
        MARKS[kind % MARKS.len()]
    }

    /// Draws it at `size`, 1 being the legend's.
    fn draw(self, canvas: &mut Canvas, at: [f32; 2], size: f32) {
        let offset = |x: f32, y: f32| [at[0] + size * x, at[1] + size * y];
        let pen = |colour, width: f32| Pen::new(colour, size * width, 1.0);
        match self {
            Self::Disc(colour) => {
                disc(canvas, at, size * 5.5, WHITE);
                disc(canvas, at, size * 4.5, colour);
            }
            Self::Ring(colour) => {
                ring(canvas, at, size * 7.0, pen(WHITE, 4.0));
                ring(canvas, at, size * 7.0, pen(colour, 2.2));
            }
            Self::Cross(colour) | Self::Plus(colour) => {
                let arm = 5.5;
                let strokes = if matches!(self, Self::Cross(_)) {
                    [
                        [offset(-arm, -arm), offset(arm, arm)],
                        [offset(-arm, arm), offset(arm, -arm)],
                    ]
                } else {
                    [
                        [offset(-7.0, 0.0), offset(7.0, 0.0)],
                        [offset(0.0, -7.0), offset(0.0, 7.0)],
                    ]
                };
                for pen in [pen(WHITE, 4.2), pen(colour, 2.2)] {
                    for stroke in &strokes {
                        canvas.stroke(stroke, false, pen);
                    }
                }
            }
            Self::Square(colour) => {
                let r = 6.0;
                let points = [offset(-r, -r), offset(r, -r), offset(r, r), offset(-r, r)];
                canvas.stroke(&points, true, pen(WHITE, 4.0));
                canvas.stroke(&points, true, pen(colour, 2.2));
            }
            Self::Triangle(colour) => {
                let points = vec![offset(0.0, -7.0), offset(6.2, 4.5), offset(-6.2, 4.5)];
                canvas.stroke(&points, true, pen(WHITE, 2.5));
                canvas.fill_loops(&[points], colour, 1.0);
            }
        }
    }
}

/// A circle as a polygon fine enough for marks.
fn circle(at: [f32; 2], radius: f32) -> Vec<[f32; 2]> {
    (0..32)
        .map(|step| {
            let (sin, cos) = (step as f32 / 32.0 * std::f32::consts::TAU).sin_cos();
            [at[0] + radius * cos, at[1] + radius * sin]
        })
        .collect()
}

fn disc(canvas: &mut Canvas, at: [f32; 2], radius: f32, colour: Rgb) {
    canvas.fill_loops(&[circle(at, radius)], colour, 1.0);
}

fn ring(canvas: &mut Canvas, at: [f32; 2], radius: f32, pen: Pen) {
    canvas.stroke(&circle(at, radius), true, pen);
}

fn legend(
    page: &mut Page,
    plan: &SamplePlan,
    tags: &[&str],
    tints: &[Rgb],
    field: Option<&SurfaceField>,
) {
    let room = page.legend;
    let canvas = &mut page.canvas;
    let mut y = room.y + 8.0;
    let heading = |canvas: &mut Canvas, y: &mut f32, text: &str| {
        canvas.text(text, [room.x, *y], BODY, Anchor::Left);
        *y += 28.0;
    };
    if !tags.is_empty() {
        heading(canvas, &mut y, "samples");
    }
    for tag in tags {
        let kind = kind(tags, tag);
        let count = plan.samples.iter().filter(|mark| mark.tag == *tag).count();
        Mark::of(kind).draw(canvas, [room.x + 12.0, y], 1.0);
        let left = room.x + 30.0;
        for line in colour_bar::wrapped(&format!("{tag} ({count})"), room.right() - left, SMALL) {
            canvas.text(&line, [left, y], SMALL, Anchor::Left);
            y += 20.0;
        }
        y += 6.0;
    }
    y += 12.0;
    if !plan.emitters.is_empty() {
        let heading_text = format!("emitters, {}", plan.quantity.radiosity_unit());
        heading(canvas, &mut y, &heading_text);
        y = emitter_legend(
            canvas,
            Frame {
                y: y - 12.0,
                ..room
            },
            plan,
            tints,
        );
    }
    if let Some(field) = field {
        let meaning = format!(
            "grey: {}, the brighter the lighter",
            field.quantity.irradiance_name()
        );
        colour_bar::swatch(canvas, room, y + 6.0, &meaning, |column, _| {
            grey(column as f64 / 29.0)
        });
    }
}

/// The emitters with their radiosities, or only the range of many; returns the
/// height beneath.
fn emitter_legend(canvas: &mut Canvas, room: Frame, plan: &SamplePlan, tints: &[Rgb]) -> f32 {
    let mut y = room.y;
    if plan.emitters.len() <= MAX_NUMBERED {
        for (index, (emitter, tint)) in plan.emitters.iter().zip(tints).enumerate() {
            let meaning = format!("{}: {}", index + 1, quantity(emitter.radiosity));
            y = colour_bar::swatch(canvas, room, y, &meaning, |_, _| *tint);
        }
        return y;
    }
    let radiosities = || plan.emitters.iter().map(|emitter| emitter.radiosity);
    let low = radiosities().fold(f64::INFINITY, f64::min);
    let high = radiosities().fold(f64::NEG_INFINITY, f64::max);
    for (value, place, word) in [(high, 1.0, "brightest"), (low, 0.0, "dimmest")] {
        let meaning = format!("{word}: {}", quantity(value));
        let tint = mix(scale::viridis(place), WHITE, TINT);
        y = colour_bar::swatch(canvas, room, y, &meaning, |_, _| tint);
    }
    y
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn equal_steps_of_tint_follow_radiosity() {
        let emitters: Vec<_> = [3.0, 1.0, 2.0]
            .map(|radiosity| EmitterShape {
                loops: Vec::new(),
                radiosity,
            })
            .to_vec();
        let tints = tints(&emitters);
        assert_eq!(tints[0], mix(scale::viridis(1.0), WHITE, TINT));
        assert_eq!(tints[1], mix(scale::viridis(0.0), WHITE, TINT));
        assert_eq!(tints[2], mix(scale::viridis(0.5), WHITE, TINT));
    }
}
