//! The camera's picture: radiance under one exposure.

use super::axes::fitted;
use super::canvas::{Anchor, BODY, Canvas, Frame, GREY, Rgb};
use super::view::drawn_size;
use super::{CameraView, Picture, PictureError};
use crate::report::quantity;
use crate::scene::Quantity;

/// What the exposure's reference radiance becomes on the linear scale: nearly
/// white, so that the brightest surfaces still show their shape.
const NEARLY_WHITE: f64 = 0.9;

/// The background on the linear scale: a dark blue, so that dark and grey surfaces
/// keep their shape before it.
const BACKGROUND: [f64; 3] = [0.020, 0.034, 0.070];

/// Draws the view as a camera would: linear exposure that makes the 99th
/// percentile of the lit pixels nearly white, then the sRGB transfer function
/// (IEC 61966-2-1). Luminaires are clipped to
/// white, the background is a dark blue. One pixel of the view is
/// one of the picture.
///
/// # Errors
/// [`PictureError::Inconsistent`] where the view has not as many pixels as it
/// says, [`PictureError::Size`] where it is empty or too large.
pub fn camera_picture(view: &CameraView) -> Result<Picture, PictureError> {
    view.check()?;
    let mut canvas = Canvas::new(view.width, view.height)?;
    let frame = Frame::new(0.0, 0.0, view.width as f32, view.height as f32);
    draw(&mut canvas, frame, view, exposure(view));
    Ok(Picture { canvas })
}

/// Draws several views beside each other under the exposure of the first, with
/// a caption beneath each. The views should show the same scene at the same
/// size; the first is the reference.
///
/// # Errors
/// As [`camera_picture`], and [`PictureError::Inconsistent`] without a view.
pub fn side_by_side(
    panels: &[(&str, &CameraView)],
    quantity_shown: Quantity,
) -> Result<Picture, PictureError> {
    let Some((_, first)) = panels.first() else {
        return Err(PictureError::Inconsistent("no views to show".to_owned()));
    };
    for (_, view) in panels {
        view.check()?;
    }
    let exposure = exposure(first);
    let gap = 16;
    let room = ((1400 - gap) / panels.len()).saturating_sub(gap).max(240);
    let sizes: Vec<_> = panels
        .iter()
        .map(|(_, view)| drawn_size(view, room))
        .collect();
    let cells: Vec<usize> = sizes.iter().map(|(width, _)| (*width).max(240)).collect();
    let width = gap + cells.iter().map(|cell| cell + gap).sum::<usize>();
    let tallest = sizes.iter().map(|(_, height)| *height).max().unwrap_or(1);
    let mut canvas = Canvas::new(width, gap + tallest + 74)?;
    let mut left = gap;
    for (((caption, view), (width, height)), cell) in panels.iter().zip(&sizes).zip(&cells) {
        let frame = Frame::new(
            (left + (cell - width) / 2) as f32,
            gap as f32,
            *width as f32,
            *height as f32,
        );
        draw(&mut canvas, frame, view, exposure);
        canvas.border(frame, GREY);
        let at = [
            left as f32 + *cell as f32 / 2.0,
            (gap + tallest) as f32 + 20.0,
        ];
        let size = fitted(caption, *cell as f32, BODY + 2.0);
        canvas.text(caption, at, size, Anchor::Middle);
        left += cell + gap;
    }
    let note = exposure_note(exposure, quantity_shown);
    let at = [width as f32 / 2.0, (gap + tallest) as f32 + 50.0];
    let size = fitted(&note, width as f32 - 24.0, BODY - 1.0);
    canvas.text(&note, at, size, Anchor::Middle);
    Ok(Picture { canvas })
}

fn exposure_note(exposure: f64, quantity_shown: Quantity) -> String {
    let unit = match quantity_shown {
        Quantity::Radiometric => "W/(m² sr)",
        Quantity::Photometric => "cd/m²",
    };
    format!("white is {} {unit} and more", quantity(1.0 / exposure))
}

/// The factor from radiance to the linear scale.
fn exposure(view: &CameraView) -> f64 {
    let brightest = |radiance: &[f64; 3]| radiance.iter().fold(0.0, |a: f64, b| a.max(*b));
    let mut lit: Vec<f64> = view
        .lit()
        .map(|pixel| brightest(&pixel.radiance))
        .filter(|radiance| *radiance > 0.0 && radiance.is_finite())
        .collect();
    if lit.is_empty() {
        // Nothing but luminaires, or darkness: any exposure tells that.
        return 1.0;
    }
    let rank = (0.99 * (lit.len() - 1) as f64).round() as usize;
    let (_, white, _) = lit.select_nth_unstable_by(rank, f64::total_cmp);
    NEARLY_WHITE / *white
}

/// Draws the view into `frame`; where the view is larger, each pixel is the mean
/// of the linear values it covers, so that edges are smooth and no light is lost.
fn draw(canvas: &mut Canvas, frame: Frame, view: &CameraView, exposure: f64) {
    let across = view.width as f64 / f64::from(frame.width);
    let down = view.height as f64 / f64::from(frame.height);
    canvas.image(frame, |column, row| {
        let (x0, x1) = covered(column, across, view.width);
        let (y0, y1) = covered(row, down, view.height);
        let mut sum = [0.0; 3];
        for y in y0..y1 {
            for pixel in &view.pixels[y * view.width + x0..y * view.width + x1] {
                let Some(pixel) = pixel else {
                    sum.iter_mut().zip(BACKGROUND).for_each(|(s, b)| *s += b);
                    continue;
                };
                for (sum, radiance) in sum.iter_mut().zip(pixel.radiance) {
                    // Clipped before the mean: a luminaire's rim is not wider than it.
                    *sum += linear(radiance, exposure, pixel.luminaire);
                }
            }
        }
        let count = ((x1 - x0) * (y1 - y0)) as f64;
        Some(sum.map(|sum| srgb(sum / count)) as Rgb)
    });
}

/// The source pixels of one drawn pixel: at least one.
fn covered(index: usize, ratio: f64, count: usize) -> (usize, usize) {
    let from = ((index as f64 * ratio) as usize).min(count - 1);
    let to = (((index + 1) as f64 * ratio) as usize).clamp(from + 1, count);
    (from, to)
}

fn linear(radiance: f64, exposure: f64, luminaire: bool) -> f64 {
    if luminaire {
        return 1.0;
    }
    let value = radiance * exposure;
    if value.is_nan() {
        0.0
    } else {
        value.clamp(0.0, 1.0)
    }
}

/// The sRGB transfer function of a linear value in [0, 1], in 8 bits.
fn srgb(linear: f64) -> u8 {
    let encoded = if linear <= 0.003_130_8 {
        12.92 * linear
    } else {
        1.055 * linear.powf(1.0 / 2.4) - 0.055
    };
    (encoded * 255.0).round().clamp(0.0, 255.0) as u8
}

#[cfg(test)]
mod tests {
    use super::super::Pixel;
    use super::*;

    #[test]
    fn the_transfer_function_is_srgb() {
        // By hand from the standard's formula; 0.0031308 is its knee.
        assert_eq!(srgb(0.0), 0);
        assert_eq!(srgb(1.0), 255);
        assert_eq!(srgb(0.5), 188);
        assert_eq!(srgb(0.01), 25);
        assert_eq!(srgb(0.003_130_8), 10);
    }

    fn pixel(radiance: f64, luminaire: bool) -> Option<Pixel> {
        Some(Pixel {
            surface: 0,
            luminaire,
            irradiance: 0.0,
            radiance: [radiance; 3],
        })
    }

    #[test]
    fn luminaires_are_white_and_do_not_darken_the_rest() {
        let mut pixels = vec![pixel(2.0, false); 90];
        pixels.extend(vec![pixel(1000.0, true); 10]);
        let view = CameraView {
            width: 10,
            height: 10,
            pixels,
        };
        let picture = camera_picture(&view).unwrap();
        assert_eq!(picture.pixel(0, 0), Some([srgb(0.9); 3]));
        assert_eq!(picture.pixel(0, 9), Some([255; 3]));
    }

    #[test]
    fn the_exposure_does_not_depend_on_the_unit() {
        let view = |scale: f64| CameraView {
            width: 2,
            height: 2,
            pixels: vec![
                pixel(scale, false),
                pixel(0.2 * scale, false),
                None,
                pixel(0.0, false),
            ],
        };
        let pictures = [1.0, 683.0].map(|scale| camera_picture(&view(scale)).unwrap());
        for (x, y) in [(0, 0), (1, 0), (0, 1), (1, 1)] {
            assert_eq!(pictures[0].pixel(x, y), pictures[1].pixel(x, y));
        }
    }
}
