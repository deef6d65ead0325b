//! Sensor points as Radiance writes them: `x y z nx ny nz` a line.

use std::path::Path;

use glam::DVec3;

use super::diagnostic::Diagnostic;
use super::document::MAX_COORDINATE;

/// A place whose irradiance is asked for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SensorPoint {
    /// Position in metres.
    pub position: DVec3,
    /// Unit normal of the receiving side.
    pub normal: DVec3,
    /// The six numbers as the file gives them; its normal need not be of unit
    /// length.
    pub given: [f64; 6],
    /// The line of the file, counted from 1.
    pub line: usize,
}

/// Reads the sensor points of the file at `path`.
///
/// Fails with a [`Diagnostic`] where the file cannot be read or a line is not
/// six finite numbers with a normal other than zero. Never panics.
pub fn read_points(path: impl AsRef<Path>) -> Result<Vec<SensorPoint>, Diagnostic> {
    let path = path.as_ref();
    let text = super::file::read_text(path)?;
    parse_points(&path.display().to_string(), &text)
}

/// Reads sensor points from text; `name` is what diagnostics call it.
///
/// Blank lines are skipped and a `#` begins a comment. Fails as
/// [`read_points`] does.
pub fn parse_points(name: &str, source: &str) -> Result<Vec<SensorPoint>, Diagnostic> {
    let mut points = Vec::new();
    for (index, text) in source.lines().enumerate() {
        if let Some(point) = parse_line(name, index + 1, text)? {
            points.push(point);
        }
    }
    Ok(points)
}

/// One line; `None` where it holds no point.
fn parse_line(name: &str, line: usize, text: &str) -> Result<Option<SensorPoint>, Diagnostic> {
    let content = text.split('#').next().unwrap_or("");
    let words = words(content);
    if words.is_empty() {
        return Ok(None);
    }
    let fault = |(start, word): (usize, &str), message: String, remedy: &str| {
        Diagnostic::in_line(name, line, text, start..start + word.len(), message, remedy)
    };
    let count_remedy = "a line is `x y z nx ny nz`: position in metres, then the normal";
    let mut given = [0.0; 6];
    for (place, number) in words.iter().zip(&mut given) {
        *number = parse_number(place.1).map_err(|message| {
            fault(
                *place,
                message,
                "write six finite numbers, such as `1 1 0.8 0 0 1`",
            )
        })?;
    }
    if let Some(extra) = words.get(6) {
        let message = format!("a point has six numbers, not {}", words.len());
        return Err(fault(*extra, message, count_remedy));
    }
    if words.len() < 6 {
        let end = (content.trim_end().len(), "");
        let message = format!("a point has six numbers, not {}", words.len());
        return Err(fault(end, message, count_remedy));
    }
    let [x, y, z, nx, ny, nz] = given;
    if let Some(far) = (0..3).find(|&axis| given[axis].abs() > MAX_COORDINATE) {
        let message = format!(
            "the coordinate is beyond {MAX_COORDINATE} m, where the device's single precision ends"
        );
        return Err(fault(words[far], message, "coordinates are metres"));
    }
    let Some(normal) = super::unit(DVec3::new(nx, ny, nz)) else {
        let remedy = "give the direction the point faces, such as `0 0 1` for up";
        return Err(fault(words[3], "the normal is zero".to_owned(), remedy));
    };
    Ok(Some(SensorPoint {
        position: DVec3::new(x, y, z),
        normal,
        given,
        line,
    }))
}

fn parse_number(word: &str) -> Result<f64, String> {
    match word.parse::<f64>() {
        Ok(number) if number.is_finite() => Ok(number),
        Ok(_) => Err(format!("`{word}` is not a finite number")),
        Err(_) => Err(format!("`{word}` is not a number")),
    }
}

/// The words of a line with the byte each starts at.
fn words(line: &str) -> Vec<(usize, &str)> {
    line.split_whitespace()
        .map(|word| (word.as_ptr() as usize - line.as_ptr() as usize, word))
        .collect()
}
