//! Hashes of the bits of many form factors on every rung, to be compared with
//! the host's.

#![cfg_attr(target_os = "none", no_std)]
#![cfg_attr(target_os = "none", no_main)]

#[cfg(target_os = "none")]
mod ending;
#[cfg(target_os = "none")]
mod hash_cases;
#[cfg(target_os = "none")]
mod hash_target;
#[cfg(target_os = "none")]
mod root;

#[cfg(not(target_os = "none"))]
fn main() {
    eprintln!("This program is for the device: `cargo bench --bench hashes` builds and runs it.");
    std::process::exit(2);
}
