//! A lighting node for an office with four luminaires: it keeps 500 lx on every desk
//! at least power, whatever daylight does.
//!
//! ```sh
//! cargo run --release -- bake office --transfer vectors -o target/office
//! OFFICE=$PWD/target/office cargo build -p isolux-office-node \
//!     --target thumbv7em-none-eabihf --profile firmware
//! ```
//!
//! The scene's module brings the tables and the types they take; `control` is the
//! decision, `node` the loop, and this file all that is the device's.

#![cfg_attr(target_os = "none", no_std)]
#![cfg_attr(target_os = "none", no_main)]

#[cfg(target_os = "none")]
mod control;
#[cfg(target_os = "none")]
mod device;
#[cfg(target_os = "none")]
mod node;

#[cfg(target_os = "none")]
include!(concat!(env!("OUT_DIR"), "/office.rs"));

/// The square root that the baked scene takes: the kernel's own, in software.
#[cfg(target_os = "none")]
use isolux::number::SoftRoot as Root;

#[cfg(not(target_os = "none"))]
fn main() {
    eprintln!(
        "This program is for the device: `cargo test --test office_node` builds and runs it."
    );
    std::process::exit(2);
}
