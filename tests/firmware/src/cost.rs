//! What the kernel's operations cost in instructions, on the emulated device.
//!
//! Every call is measured by itself, less an empty call: the sum and the
//! largest over a fixed set of receivers are logged, with the sum of the
//! answers, which is the host's bit by bit.

#![cfg_attr(target_os = "none", no_std)]
#![cfg_attr(target_os = "none", no_main)]

#[cfg(target_os = "none")]
mod clock;
#[cfg(target_os = "none")]
mod cost_cases;
#[cfg(target_os = "none")]
mod cost_ready;
#[cfg(target_os = "none")]
mod cost_samples;
#[cfg(target_os = "none")]
mod cost_target;
#[cfg(target_os = "none")]
mod ending;
#[cfg(target_os = "none")]
mod meter;
#[cfg(target_os = "none")]
mod root;

#[cfg(not(target_os = "none"))]
fn main() {
    eprintln!(
        "This program is for the device: `cargo bench --bench instructions` builds and runs it."
    );
    std::process::exit(2);
}
