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
//! [`scene`].

pub mod baseline;
pub mod reference;
pub mod scene;
