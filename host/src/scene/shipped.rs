//! The scenes that come with isolux.

/// The simple scene of Drettakis and Fiume (1992), light 3 x 3.
pub const PAPER: &str = include_str!("../../scenes/paper.toml");

/// The same scene with a light of the same area and an aspect of 2.2.
pub const PAPER_ASPECT: &str = include_str!("../../scenes/paper-aspect.toml");

/// A light, a floor and a small occluder between them.
pub const PENUMBRA: &str = include_str!("../../scenes/penumbra.toml");

/// The Cornell box in grey.
pub const CORNELL: &str = include_str!("../../scenes/cornell.toml");

/// The Cornell box in colour.
pub const CORNELL_RGB: &str = include_str!("../../scenes/cornell-rgb.toml");

/// An office with four luminaires and a desk, photometric.
pub const OFFICE: &str = include_str!("../../scenes/office.toml");

/// Every shipped scene: its file name and its text.
pub const ALL: [(&str, &str); 6] = [
    ("paper.toml", PAPER),
    ("paper-aspect.toml", PAPER_ASPECT),
    ("penumbra.toml", PENUMBRA),
    ("cornell.toml", CORNELL),
    ("cornell-rgb.toml", CORNELL_RGB),
    ("office.toml", OFFICE),
];
