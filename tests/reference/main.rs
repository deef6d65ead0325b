//! The reference against results of other systems, laws and extremes.

mod fixtures;
mod form_factor;
mod irradiance;
