//! The scenes that come with isolux.

/// The simple scene of Drettakis and Fiume (1992), light 3 x 3.
pub const PAPER: &str = include_str!("../../scenes/paper.toml");

/// The same scene with a light of the same area and an aspect of 2.2.
pub const PAPER_ASPECT: &str = include_str!("../../scenes/paper-aspect.toml");

/// Every shipped scene: its file name and its text.
pub const ALL: [(&str, &str); 2] = [("paper.toml", PAPER), ("paper-aspect.toml", PAPER_ASPECT)];
