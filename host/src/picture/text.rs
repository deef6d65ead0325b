//! Text in an embedded font.

use std::sync::OnceLock;

use ab_glyph::{Font, FontRef, Glyph, PxScale, ScaleFont, point};

/// The typeface: Hack (MIT, Bitstream Vera licence), made for small sizes.
/// `None` never happens with the embedded bytes; text is then left out rather
/// than the picture.
fn font() -> Option<&'static FontRef<'static>> {
    static FONT: OnceLock<Option<FontRef<'static>>> = OnceLock::new();
    FONT.get_or_init(|| FontRef::try_from_slice(epaint_default_fonts::HACK_REGULAR).ok())
        .as_ref()
}

/// The width in pixels of `text` at `size` pixels a line.
pub(super) fn width(text: &str, size: f32) -> f32 {
    font().map_or(0.0, |font| {
        let font = font.as_scaled(PxScale::from(size));
        text.chars()
            .map(|letter| font.h_advance(font.glyph_id(letter)))
            .sum()
    })
}

/// The height of a capital letter at `size`, by which text is centred.
pub(super) fn cap_height(size: f32) -> f32 {
    size * 0.62
}

/// Calls `ink(x, y, coverage)` for every pixel that `text` touches, with its
/// baseline starting at (0, 0), x to the right and y downwards.
pub(super) fn draw(text: &str, size: f32, mut ink: impl FnMut(i32, i32, f32)) {
    let Some(font) = font() else { return };
    let scale = PxScale::from(size);
    let scaled = font.as_scaled(scale);
    let mut x = 0.0;
    for letter in text.chars() {
        let id = font.glyph_id(letter);
        let glyph: Glyph = id.with_scale_and_position(scale, point(x, 0.0));
        x += scaled.h_advance(id);
        if let Some(outline) = font.outline_glyph(glyph) {
            let corner = outline.px_bounds().min;
            outline.draw(|column, row, coverage| {
                ink(
                    corner.x as i32 + column as i32,
                    corner.y as i32 + row as i32,
                    coverage.min(1.0),
                );
            });
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_sign_we_print_is_in_the_font() {
        let font = font().unwrap();
        for letter in "AZaz09 ²±·×≤≥–°(),./%+-<>=".chars() {
            assert_ne!(font.glyph_id(letter).0, 0, "{letter}");
        }
    }

    #[test]
    fn text_is_as_wide_as_said() {
        let mut right = 0;
        draw("irradiance", 16.0, |x, _, _| right = right.max(x));
        let said = width("irradiance", 16.0);
        assert!((right as f32 - said).abs() < 3.0, "{right} {said}");
    }
}
