//! The tables between host and kernel: what is refused and why, what happens
//! to tables that somebody changed, and the energy in what they describe.

#[path = "tables/coded.rs"]
mod coded;
#[path = "tables/endurance.rs"]
mod endurance;
#[path = "tables/energy.rs"]
mod energy;
#[path = "tables/fuzz.rs"]
mod fuzz;
#[path = "tables/integers.rs"]
mod integers;
#[path = "tables/mutation.rs"]
mod mutation;
#[path = "tables/refusals.rs"]
mod refusals;

use glam::DVec3;
use isolux::scene::records::{Header, checksum};
use isolux_host::bake::{self, Tables};
use isolux_host::plan::{self, Plan};
use isolux_host::reference::{Reference, Reflections};
use isolux_host::scene::{Scene, file, shipped};
use std::mem::offset_of;
use std::sync::OnceLock;

/// A scene, planned and baked for light reflected once.
fn planned(name: &str, source: &str) -> (Scene, Plan, Tables) {
    let scene = file::parse(name, source).unwrap_or_else(|error| panic!("{error}"));
    let once = Reference::new(&scene, Reflections::AtMost(1), &mut |_| {}).expect("a reference");
    let field = |places: &[(DVec3, DVec3)]| once.irradiance_at(places);
    let plan = plan::isolux(&scene, &scene.budget, &field).expect("a plan");
    let tables = bake::bake(&scene, &plan, None).expect("tables");
    (scene, plan, tables)
}

/// The paper's scene, planned once for all tests.
fn paper() -> &'static (Scene, Plan, Tables) {
    static PAPER: OnceLock<(Scene, Plan, Tables)> = OnceLock::new();
    PAPER.get_or_init(|| {
        let (name, source) = shipped::ALL[0];
        assert_eq!(name, "paper.toml");
        planned(name, source)
    })
}

/// Bytes at an address that is a multiple of four.
struct Words(Vec<u32>);

impl Words {
    fn new(bytes: &[u8]) -> Self {
        let mut words = vec![0_u32; bytes.len().div_ceil(4)];
        zerocopy::IntoBytes::as_mut_bytes(&mut words[..])[..bytes.len()].copy_from_slice(bytes);
        Self(words)
    }

    fn bytes(&self, length: usize) -> &[u8] {
        &zerocopy::IntoBytes::as_bytes(&self.0[..])[..length]
    }
}

/// Makes the checksum that of the bytes behind it.
fn seal(bytes: &mut [u8]) {
    let field = offset_of!(Header, checksum);
    if bytes.len() >= field + 4 {
        let sum = checksum(&bytes[field + 4..]);
        bytes[field..field + 4].copy_from_slice(&sum.to_le_bytes());
    }
}

fn put(bytes: &mut [u8], at: usize, value: u32) {
    bytes[at..at + 4].copy_from_slice(&value.to_le_bytes());
}
