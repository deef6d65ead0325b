//! Firmware.
fn main(){}
