//! The std side of isolux: reads scenes, plans and bakes them for the device,
//! and judges the kernel's answers against a full-precision reference.
//!
//! Data flows one way:
//!
//! ```text
//! scene file -> scene -> plan -> bake -> tables -> isolux (kernel) -> compare -> picture, report
//!                     -> reference ------------------------------^
//! ```
//!
//! Rooms, ground floor first; each imports only those above it in this list:
//! [`scene`], [`mod@reference`], [`occlusion`], [`baseline`], [`plan`], [`bake`], [`solve`], [`pilot`],
//! [`compare`], [`report`], [`picture`], [`device`], [`trade`], [`cli`]. The kernel is a
//! library to all of them but the reference, which shares no formula with what
//! it judges.

pub mod bake;
pub mod baseline;
pub mod cli;
pub mod compare;
pub mod device;
pub mod occlusion;
pub mod picture;
pub mod pilot;
pub mod plan;
pub mod reference;
pub mod report;
pub mod scene;
pub mod solve;
pub mod trade;
