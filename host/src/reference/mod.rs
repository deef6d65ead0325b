//! The judge: irradiance in f64.

mod form_factor;

pub use form_factor::{form_factor, form_factor_signed};
