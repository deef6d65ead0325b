//! Legends: a bar of colours with its numbers, and swatches with a word each.

use super::canvas::{Anchor, BODY, Canvas, Frame, GREY, INK, Rgb, SMALL, WHITE};
use super::scale::{self, Amounts, SignedErrors};
use super::text;

/// Width of the bar.
const BAR: f32 = 30.0;
/// Height of a line of a legend.
const LINE: f32 = 24.0;

/// Draws the bar of an amount: heading, then the bar as far as `room` goes.
/// The lines across it are the isolux levels.
pub(super) fn amounts(canvas: &mut Canvas, room: Frame, heading: &[&str], scale: &Amounts) {
    let bar = under_heading(canvas, room, heading);
    draw(canvas, bar, scale::viridis);
    let ticks: Vec<(f64, String)> = if scale.levels.is_empty() {
        [scale.low, scale.high]
            .map(|value| (scale.place(value), scale::label(value)))
            .to_vec()
    } else {
        scale
            .levels
            .iter()
            .map(|level| (scale.place(*level), scale::label(*level)))
            .collect()
    };
    label(canvas, bar, &ticks);
}

/// Draws the bar of a signed error, with the words for its ends.
pub(super) fn signed_errors(
    canvas: &mut Canvas,
    room: Frame,
    heading: &[&str],
    scale: &SignedErrors,
) {
    let bar = under_heading(canvas, room, heading);
    let limit = scale.limit;
    draw(canvas, bar, |place| {
        scale.colour((2.0 * place - 1.0) * limit)
    });
    let ticks: Vec<(f64, String)> = [-1.0, -0.5, 0.0, 0.5, 1.0]
        .into_iter()
        .map(|share| {
            let sign = if share > 0.0 { "+" } else { "" };
            let words = match share {
                1.0 => " too bright",
                -1.0 => " too dark",
                _ => "",
            };
            let number = scale::label(share * limit);
            ((share + 1.0) / 2.0, format!("{sign}{number}{words}"))
        })
        .collect();
    label(canvas, bar, &ticks);
}

/// Draws a swatch with its meaning, wrapped to the room; returns the top of
/// what comes beneath.
pub(super) fn swatch(
    canvas: &mut Canvas,
    room: Frame,
    top: f32,
    meaning: &str,
    colour: impl Fn(usize, usize) -> Rgb,
) -> f32 {
    let frame = Frame::new(room.x.round(), top.round() + 3.0, BAR, 18.0);
    canvas.image(frame, |column, row| Some(colour(column, row)));
    canvas.border(frame, GREY);
    let left = room.x + BAR + 12.0;
    let mut y = top + LINE / 2.0;
    for line in wrapped(meaning, room.right() - left, SMALL) {
        canvas.text(&line, [left, y], SMALL, Anchor::Left);
        y += 20.0;
    }
    y - 20.0 + LINE / 2.0 + 6.0
}

/// Breaks `meaning` between words so that each line fits; a word wider than
/// the room stands alone.
pub(super) fn wrapped(meaning: &str, room: f32, size: f32) -> Vec<String> {
    let mut lines: Vec<String> = Vec::new();
    for word in meaning.split_whitespace() {
        match lines.last_mut() {
            Some(line) if text::width(&format!("{line} {word}"), size) <= room => {
                line.push(' ');
                line.push_str(word);
            }
            _ => lines.push(word.to_owned()),
        }
    }
    lines
}

/// Writes the heading and returns the frame of the bar beneath it.
fn under_heading(canvas: &mut Canvas, room: Frame, heading: &[&str]) -> Frame {
    let mut y = room.y + 8.0;
    for line in heading {
        canvas.text(line, [room.x, y], BODY, Anchor::Left);
        y += LINE;
    }
    let top = (y + 4.0).round();
    Frame::new(room.x.round(), top, BAR, (room.bottom() - top).floor())
}

fn draw(canvas: &mut Canvas, bar: Frame, colour: impl Fn(f64) -> Rgb) {
    canvas.image(bar, |_, row| {
        Some(colour(1.0 - (row as f64 + 0.5) / f64::from(bar.height)))
    });
    canvas.border(bar, GREY);
}

/// Writes labels from the bottom up, leaving out those without room, but
/// never their lines.
fn label(canvas: &mut Canvas, bar: Frame, ticks: &[(f64, String)]) {
    let mut lowest_free = f32::INFINITY;
    for (place, text) in ticks {
        let y = bar.bottom() - *place as f32 * bar.height;
        let line = y.clamp(bar.y, bar.bottom() - 1.0).round();
        canvas.fill(Frame::new(bar.x, line - 1.0, BAR, 3.0), INK, 0.4);
        canvas.fill(Frame::new(bar.x, line, BAR, 1.0), WHITE, 1.0);
        canvas.fill(Frame::new(bar.right() + 1.0, line, 6.0, 1.0), GREY, 1.0);
        if y < lowest_free {
            let at = [bar.right() + 13.0, y];
            canvas.text(text, at, SMALL, Anchor::Left);
            lowest_free = y - SMALL - 3.0;
        }
    }
}
