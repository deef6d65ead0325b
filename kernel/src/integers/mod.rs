//! The whole way in integers: a scene baked for fixed point is loaded, lit,
//! resampled and asked on a core without FPU, with the same bits on every core.
//!
//! What [`scene`](crate::scene), [`shoot`](crate::shoot) and
//! [`resample`](crate::resample) are to the floating-point rungs, this room is to
//! [`Q29`] and [`Q24`]: [`Scene::load`] reads tables of whole numbers in place,
//! [`Light`] lets luminaires and reflectors shoot until the same
//! [`Stop`](crate::shoot::Stop), follows luminaires that are dimmed, and its rows are
//! filtered by the same cone. The form factors are those of
//! [`form_factor::fixed_point`](crate::form_factor::fixed_point).
//!
//! It serves grey scenes: with [`Computed`] those whose radiosities are constant over
//! an emitter and in which nothing hides anything, the scenes of the paper; with
//! [`Matrix`] rooms, whose radiosities are linear, and in which what hides what is in
//! the terms. Colour, occluders on the device, other reconstructions and reflectances
//! that change are **not** here; the bake refuses such scenes.
//!
//! # Units
//!
//! Everything is a whole number of a unit that is a power of two, stated in the
//! tables' [`Header`]:
//!
//! | quantity | type | unit |
//! | --- | --- | --- |
//! | lengths, coordinates | `i32` | 2^`length` m; the largest coordinate has 29 bits |
//! | irradiance, radiosity of what reflects | `i32` | 2^`irradiance` W m⁻² |
//! | emitted radiosity π L | `i32` | 2^(`irradiance` + `shift`) W m⁻² |
//! | axes and normals | `i32` | 2⁻³⁰ |
//! | reflectance | `u32` | 2⁻³² |
//! | weights of samples in a linear radiosity | `i32` | 2⁻²⁴ |
//!
//! The bake chooses the unit of irradiance so that what can arrive at a sample
//! has 30 bits: half of what a word with a sign holds, so that every luminaire may be set
//! to twice its radiance. Where tables lie about that, sums
//! saturate. So there is no energy too small or too large, and multiplying all
//! radiances, or all lengths, by a power of two changes the exponents and not
//! one other bit.
//!
//! # Errors
//!
//! Each shot adds M F: the form factor's error (5e-8 on `Q29`, 5e-6 on `Q24`,
//! absolute) times the emitter's radiosity M, and half a unit of irradiance of
//! rounding, so that n shots lose or make n/2 units at the most: 1e5 shots
//! 4.7e-5 of 2³⁰ units. A term's factor is rounded down to 2⁻³¹, which is 5e-10 of the
//! radiosity, and a radiosity's place by four units at the most. The form factor has no
//! digits below 2⁻²⁹ (2⁻²⁴):
//! luminaires that are seen under F < 1e-5 from everywhere want a rung in
//! floating point.

mod change;
mod check;
mod fraction;
mod light;
mod radiosity;
mod resample;
mod scene;
mod tables;
mod transfer;
mod unshot;

pub use crate::form_factor::fixed_point::{Format, Q24, Q29, Receiver};
pub use light::{Light, light_bytes};
pub use radiosity::Radiosity;
pub use resample::cone;
pub use scene::Scene;
pub use tables::{Emitter, Header, LARGEST_SHIFT, Loop, MAGIC, Surface, VERSION, required_bytes};
pub use transfer::{Computed, Matrix, Transfer};
