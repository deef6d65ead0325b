//! Light that changes on the device: radiances and reflectances are set, and the
//! scene is lit on from what it was.

#[path = "command_line/program.rs"]
#[allow(dead_code, reason = "the command line's tests use the rest")]
mod program;

#[path = "run_time/changes.rs"]
mod changes;
#[path = "run_time/device.rs"]
mod device;
#[path = "run_time/integers.rs"]
mod integers;
#[path = "run_time/matrix.rs"]
mod matrix;
#[path = "run_time/points.rs"]
mod points;
#[path = "run_time/refusals.rs"]
mod refusals;
#[path = "run_time/scenes.rs"]
mod scenes;
#[path = "run_time/written.rs"]
mod written;
