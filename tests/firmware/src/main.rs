//! The kernel on a baked scene, on the emulated device.
//!
//! Loads the tables in place from flash, gathers direct light, shoots until the
//! scene's stop rule, resamples every receiving surface, and logs every value
//! bit by bit with what each step cost in instructions and stack. It exits 0
//! when it ran to its end; whether the bits are the host's is the host's to say.

#![cfg_attr(target_os = "none", no_std)]
#![cfg_attr(target_os = "none", no_main)]

#[cfg(target_os = "none")]
mod clock;
#[cfg(target_os = "none")]
mod ending;
#[cfg(target_os = "none")]
mod job;
#[cfg(target_os = "none")]
#[cfg_attr(integer_tables, path = "integers.rs")]
#[cfg_attr(not(integer_tables), path = "floats.rs")]
mod kernel;
#[cfg(target_os = "none")]
mod meter;
#[cfg(all(target_os = "none", not(integer_tables)))]
mod root;
#[cfg(target_os = "none")]
mod target;

#[cfg(not(target_os = "none"))]
fn main() {
    eprintln!("This program is for the device: `isolux device SCENE` builds and runs it.");
    std::process::exit(2);
}
