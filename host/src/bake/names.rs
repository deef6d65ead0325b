//! Names of a scene as constants of a firmware.

use crate::scene::{Quantity, Scene};
use std::collections::BTreeSet;

/// What a scene calls its surfaces, luminaires and points, in the order of the
/// tables.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Names {
    /// Of every surface.
    pub surfaces: Vec<String>,
    /// Of the surfaces that emit, which are the first emitters.
    pub luminaires: Vec<String>,
    /// Named places: name, position in metres, unit normal.
    pub points: Vec<(String, [f64; 3], [f64; 3])>,
    /// Units of radiance and of irradiance; empty where nobody said.
    pub units: [&'static str; 2],
}

impl Names {
    /// Those of a scene.
    pub fn of(scene: &Scene) -> Self {
        let name = |surface: &crate::scene::Surface| surface.name.clone();
        let emitting = scene.surfaces.iter().filter(|surface| surface.emits());
        let point = |point: &crate::scene::Point| {
            let (position, normal) = (point.position, point.normal);
            (point.name.clone(), position.to_array(), normal.to_array())
        };
        Self {
            surfaces: scene.surfaces.iter().map(name).collect(),
            luminaires: emitting.map(name).collect(),
            points: scene.points.iter().map(point).collect(),
            units: match scene.quantity {
                Quantity::Radiometric => ["W/m²/sr", scene.quantity.irradiance_unit()],
                Quantity::Photometric => ["cd/m²", scene.quantity.irradiance_unit()],
            },
        }
    }
}

/// The modules and constants that say them.
pub(super) fn listed(names: &Names) -> String {
    let mut text = String::new();
    let [radiance, irradiance] = names.units;
    if !irradiance.is_empty() {
        text += &format!(
            "\n/// The unit of irradiance.\npub const IRRADIANCE_UNIT: &str = {irradiance:?};\n\
             \n/// The unit of radiance.\npub const RADIANCE_UNIT: &str = {radiance:?};\n"
        );
    }
    text += &indices("surfaces", "Surfaces, by name.", &names.surfaces);
    let about = "Luminaires, by name: indices among the emitters.";
    text += &indices("luminaires", about, &names.luminaires);
    if names.points.is_empty() {
        return text;
    }
    let points: Vec<String> = names.points.iter().map(|point| point.0.clone()).collect();
    text += &indices("points", "Named points: indices in `POINTS`.", &points);
    text += &format!(
        "\n/// Position in metres and unit normal of every named point.\npub const POINTS: [[[f32; 3]; 2]; {}] = [\n",
        points.len()
    );
    for (_, position, normal) in &names.points {
        let [position, normal] = [position, normal].map(|v| v.map(|x| x as f32));
        text += &format!("    [{position:?}, {normal:?}],\n");
    }
    text + "];\n"
}

/// A module of indices.
fn indices(module: &str, about: &str, names: &[String]) -> String {
    if names.is_empty() {
        return String::new();
    }
    let mut text = format!("\n/// {about}\npub mod {module} {{\n");
    let mut taken = BTreeSet::new();
    for (index, name) in names.iter().enumerate() {
        let mut constant = identifier(name);
        while !taken.insert(constant.clone()) {
            constant += &format!("_{index}");
        }
        text += &format!("    /// {name:?}.\n    pub const {constant}: usize = {index};\n");
    }
    text + "}\n"
}

/// A name as that of a constant: what is no ASCII letter or digit becomes `_`.
fn identifier(name: &str) -> String {
    let letter = |c: char| match c {
        c if c.is_ascii_alphanumeric() => c.to_ascii_uppercase(),
        _ => '_',
    };
    let constant: String = name.chars().map(letter).collect();
    match constant.chars().next() {
        Some(first) if first.is_ascii_alphabetic() => constant,
        // `_` alone names nothing, and no name begins with a digit.
        _ => format!("N_{constant}"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_become_constants_that_differ() {
        assert_eq!(identifier("desk-1"), "DESK_1");
        assert_eq!(identifier("2nd floor"), "N_2ND_FLOOR");
        assert_eq!(identifier("für"), "F_R");
        assert_eq!(identifier(""), "N_");
        let names = ["a-b", "a b", "a_b", "a_b_1"].map(str::to_owned);
        let text = indices("surfaces", "", &names);
        for constant in ["A_B: usize = 0", "A_B_1: usize = 1", "A_B_2: usize = 2"] {
            assert!(text.contains(constant), "{text}");
        }
        assert!(text.contains("A_B_1_3: usize = 3"), "{text}");
    }

    #[test]
    fn no_name_ends_its_line() {
        let text = indices("surfaces", "", &["a\n/* \" */".to_owned()]);
        assert_eq!(text.lines().count(), 6, "{text}");
    }
}
