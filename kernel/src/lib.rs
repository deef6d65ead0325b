//! How much light reaches every surface of a scene, on a Cortex-M class part,
//! inside a budget of bytes and instructions that is fixed beforehand.
//!
//! The kernel starts from Drettakis & Fiume 1992, *Concrete Computation of
//! Global Illumination Using Structured Sampling*: the form factor of a
//! polygon seen from a point is a closed formula ([`form_factor`]), light is
//! shot from polygons to samples ([`shoot`]), and images are resampled from
//! the samples ([`resample`]). Where the paper's print is wrong, the item that
//! implements it says so.
//!
//! # Laws
//!
//! * `no_std`, no allocation, `forbid(unsafe_code)`; no panic is reachable
//!   (the project's tests prove it at link time); every loop has a bound that
//!   the tables state; the stack is bounded.
//! * What does not fit is refused on load, with what was needed and what there
//!   was ([`Error`]). Nothing is cut silently.
//! * No NaN leaves a public function.
//! * The same tables give the same bits on every target: no fused operation,
//!   no `f32::min`/`max`, no function of the platform's own math library.
//! * Features only add. The kernel does **not** know files or units
//!   beyond SI.
//!
//! # Rooms
//!
//! Each imports only those above it: [`error`], [`number`], [`geometry`],
//! [`clip`], [`form_factor`], [`luminance`], [`visibility`], [`scene`], [`transfer`], [`shoot`], [`resample`],
//! [`budget`]; with the feature `fixed` also `integers`, the whole way without floating point.
//!
//! # Example
//!
//! ```
//! use isolux::form_factor::{form_factor, Best};
//! use isolux::geometry::Receiver;
//! use isolux::number::SoftRoot;
//!
//! // A 2 m x 2 m ceiling light, 1 m above a point of the floor.
//! let light = [[-1.0, -1.0, 1.0], [-1.0, 1.0, 1.0], [1.0, 1.0, 1.0], [1.0, -1.0, 1.0]];
//! let floor = Receiver::new::<SoftRoot>([0.0, 0.0, 0.0], [0.0, 0.0, 1.0])?;
//! let f = form_factor::<Best, f32>(&floor, &light);
//! assert!((f - 0.554_126).abs() < 1e-6);
//! # Ok::<(), isolux::Error>(())
//! ```

#![no_std]
#![forbid(unsafe_code)]
#![cfg_attr(docsrs, feature(doc_cfg))]

#[cfg(target_endian = "big")]
compile_error!("isolux reads its tables in place and they are little-endian");

pub mod budget;
pub mod clip;
pub mod error;
pub mod form_factor;
pub mod geometry;
#[cfg(feature = "fixed")]
#[cfg_attr(docsrs, doc(cfg(feature = "fixed")))]
pub mod integers;
pub mod luminance;
pub mod number;
pub mod resample;
pub mod scene;
pub mod shoot;
pub mod transfer;
pub mod visibility;

pub use error::Error;
