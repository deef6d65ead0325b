//! The reference against results of other systems, laws and extremes.

mod brute_force;
mod fixtures;
mod form_factor;
mod irradiance;
mod occlusion;
mod rooms;
