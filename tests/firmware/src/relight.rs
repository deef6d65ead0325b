//! What it costs to light a scene on, after a luminaire was dimmed, beside the first
//! solution.

#![cfg_attr(target_os = "none", no_std)]
#![cfg_attr(target_os = "none", no_main)]

#[cfg(target_os = "none")]
#[allow(dead_code, reason = "the firmware takes the rest")]
mod clock;
#[cfg(target_os = "none")]
mod ending;
#[cfg(target_os = "none")]
#[allow(dead_code, reason = "the firmware takes the rest")]
mod job;
#[cfg(target_os = "none")]
#[allow(dead_code, reason = "the firmware takes the rest")]
mod meter;
#[cfg(target_os = "none")]
mod relight_target;
#[cfg(all(target_os = "none", not(integer_tables)))]
mod root;

#[cfg(not(target_os = "none"))]
fn main() {
    eprintln!("This program is for the device: `cargo test --test run_time` builds and runs it.");
    std::process::exit(2);
}
