//! The bits of the paper's scenes, as they were when somebody last looked.
//!
//! tests/data/golden-*.tables are the baked scenes, golden-*.json what the
//! kernel makes of them: every sample, a coarse grid of every surface, and
//! points in space, after direct light and after all of it. The bits are the
//! same in debug and release builds, on every host and on the device.
//!
//! A change of bits is a decision: `ISOLUX_BLESS=1 cargo test --test golden`
//! writes the files anew, and the diff shows what moved.

use glam::DVec3;
use isolux::form_factor::{Arithmetic, Best, Libm};
use isolux::geometry::Receiver;
use isolux::number::SoftRoot;
use isolux::resample::Tensors;
use isolux::scene::Scene;
use isolux::shoot::{Light, Stop};
use isolux_host::bake::{self, Tables};
use isolux_host::plan;
use isolux_host::reference::{Reference, Reflections};
use isolux_host::scene::{file, shipped};
use isolux_host::solve::HostRoot;
use serde::{Deserialize, Serialize};
use std::fs;
use std::path::PathBuf;
use zerocopy::IntoBytes;

/// Cells along each side of a surface's grid.
const CELLS: u32 = 7;

/// What the kernel makes of a scene; irradiances as the hexadecimal digits of
/// their bits, with the value beside the first of each list for people.
#[derive(Debug, PartialEq, Serialize, Deserialize)]
struct Golden {
    scene: String,
    rungs: Vec<Solved>,
}

#[derive(Debug, PartialEq, Serialize, Deserialize)]
struct Solved {
    rung: String,
    stop: String,
    shots: u32,
    form_factors: u32,
    unshot: String,
    samples: Vec<String>,
    grids: Vec<Vec<String>>,
    points: Vec<String>,
}

fn bits(value: f32) -> String {
    format!("{:08x}", value.to_bits())
}

fn path(name: &str) -> PathBuf {
    let mut path = PathBuf::from(env!("CARGO_MANIFEST_DIR"));
    path.push("tests/data");
    path.push(name);
    path
}

fn blessing() -> bool {
    std::env::var_os("ISOLUX_BLESS").is_some_and(|set| set == "1")
}

/// How a scene is planned.
#[derive(Clone, Copy, PartialEq)]
enum Placement {
    Isolux,
    Error,
}

fn baked(source: (&str, &str), placement: Placement) -> Tables {
    let scene = file::parse(source.0, source.1).expect("a shipped scene");
    let once = Reference::new(&scene, Reflections::AtMost(1), &mut |_| {}).expect("a reference");
    let field = |places: &[(DVec3, DVec3)]| once.irradiance_at(places);
    let plan = match placement {
        Placement::Isolux => plan::isolux(&scene, &scene.budget, &field),
        Placement::Error => {
            let plan = plan::error_driven(&scene, &scene.budget, &field, &[]);
            plan.map(|plan| plan.expect("points that stand for their surfaces"))
        }
    };
    let plan = plan.expect("a plan");
    bake::bake(&scene, &plan, None).expect("tables")
}

/// The kernel with the soft root of the device, checked against the hardware's.
fn solved<A: Arithmetic<f32>, H: Arithmetic<f32>>(
    scene: Scene<'_>,
    rung: &str,
    stop: Stop,
) -> Solved {
    let mut light = Box::new(Light::<A, 256, 64>::new(scene).expect("room"));
    let mut hardware = Box::new(Light::<H, 256, 64>::new(scene).expect("room"));
    let ended = light.solve(stop);
    assert_eq!(ended, hardware.solve(stop), "the root changes no bit");
    assert_eq!(light.irradiance(), hardware.irradiance());
    let grids = (0..scene.surfaces().len()).map(|surface| {
        let mut cells = Vec::new();
        if scene.counts().fields > 0 {
            return reconstructed(&light, &hardware, surface);
        }
        for row in 0..CELLS {
            let (mut soft, mut hard) = ([0.0; CELLS as usize], [0.0; CELLS as usize]);
            let grid = [CELLS; 2];
            let a = light.resample_row::<SoftRoot>(surface, grid, row, &mut soft);
            let b = hardware.resample_row::<HostRoot>(surface, grid, row, &mut hard);
            assert_eq!((a, soft), (b, hard));
            cells.extend(soft.map(bits));
        }
        cells
    });
    let grids = grids.collect();
    let points = places().map(|(p, n)| {
        let receiver = Receiver::new::<SoftRoot>(p, n).expect("a receiver");
        bits(light.at(&receiver))
    });
    let points = points.collect();
    Solved {
        rung: rung.to_owned(),
        stop: format!("{stop:?}"),
        shots: ended.shots,
        form_factors: ended.form_factors,
        unshot: bits(ended.unshot),
        samples: light.irradiance().iter().map(|&e| bits(e)).collect(),
        grids,
        points,
    }
}

/// The bits of a surface's grid, put together from its fields.
fn reconstructed<A: Arithmetic<f32>, H: Arithmetic<f32>>(
    light: &Light<'_, A, 256, 64>,
    hardware: &Light<'_, H, 256, 64>,
    surface: usize,
) -> Vec<String> {
    let mut rooms = [[0.0; 256]; 2];
    let [soft_room, hard_room] = &mut rooms;
    let (soft, hard) = (
        light.reconstruct::<Tensors<SoftRoot>>(surface, soft_room),
        hardware.reconstruct::<Tensors<HostRoot>>(surface, hard_room),
    );
    let (Ok(soft), Ok(hard)) = (soft, hard) else {
        return Vec::new(); // a luminaire
    };
    let rows = (0..CELLS).flat_map(|row| {
        let (mut a, mut b) = ([0.0; CELLS as usize], [0.0; CELLS as usize]);
        let grid = [CELLS; 2];
        soft.row(grid, row, &mut a).expect("a row");
        hard.row(grid, row, &mut b).expect("a row");
        assert_eq!(a, b, "the root changes no bit");
        a.map(bits)
    });
    rows.collect()
}

/// Receivers on A, on B, between them, on edges, in corners, and far away.
fn places() -> impl Iterator<Item = ([f32; 3], [f32; 3])> {
    let up = [0.0, 0.0, 1.0];
    let down = [0.0, 0.0, -1.0];
    [
        ([0.0, 0.0, 0.0], up),
        ([1.2, 0.0, 0.0], up),
        ([-2.4, 2.4, 0.0], up),
        ([2.5, 2.5, 0.0], up),
        ([3.7, 0.0, 2.2], down),
        ([6.2, 0.1, 2.2], down),
        ([8.7, -2.5, 2.2], down),
        ([3.0, 0.3, 1.1], [-1.0, 0.0, 0.0]),
        ([1.2, 0.0, 2.199], up),
        ([-0.3, 1.5, 1.0], [0.3, -0.2, 0.9]),
        ([5.0, -4.0, 1.5], [-0.5, 0.5, 0.1]),
        ([300.0, 200.0, -100.0], [-3.0, -2.0, 1.0]),
    ]
    .into_iter()
}

fn golden(name: &str, tables: &[u8]) -> Golden {
    let words: Vec<u32> = tables.chunks_exact(4).map(word).collect();
    let scene = Scene::load(words.as_bytes()).expect("sound tables");
    let stops = [
        Stop::Reflections(0),
        Stop::Reflections(1),
        Stop::below(1e-3),
    ];
    let rungs = stops.into_iter().flat_map(|stop| {
        [
            solved::<Best, Best<HostRoot>>(scene, "best", stop),
            solved::<Libm, Libm<HostRoot>>(scene, "libm", stop),
        ]
    });
    Golden {
        scene: name.to_owned(),
        rungs: rungs.collect(),
    }
}

fn word(bytes: &[u8]) -> u32 {
    u32::from_le_bytes(bytes.try_into().expect("four bytes"))
}

/// Whether two tables say the same: the planner computes with the platform's
/// own `f64` functions, so its numbers may differ in their last digits from
/// host to host, and with them the checksum. Counts and indices may not.
fn alike(a: &[u8], b: &[u8]) -> bool {
    let differing = a.chunks_exact(4).zip(b.chunks_exact(4)).filter(|(a, b)| {
        let (a, b) = (word(a), word(b));
        let (x, y) = (f32::from_bits(a), f32::from_bits(b));
        a != b && !((x - y).abs() <= 1e-5 * (1.0 + x.abs()) && x.is_normal() && y.is_normal())
    });
    a.len() == b.len() && differing.count() <= 1
}

fn check(source: (&str, &str), placement: Placement) {
    let scene = source.0.trim_end_matches(".toml");
    let name = match placement {
        Placement::Isolux => scene.to_owned(),
        Placement::Error => format!("{scene}-error"),
    };
    let name = name.as_str();
    let (tables, values) = (
        path(&format!("golden-{name}.tables")),
        path(&format!("golden-{name}.json")),
    );
    let baked = baked(source, placement);
    if blessing() {
        let text = serde_json::to_string_pretty(&golden(name, baked.bytes())).expect("JSON");
        fs::write(&tables, baked.bytes()).expect("the tables are written");
        fs::write(&values, text + "\n").expect("the values are written");
    }
    let hint = "is missing: ISOLUX_BLESS=1 cargo test --test golden";
    let kept = fs::read(&tables).unwrap_or_else(|_| panic!("{} {hint}", tables.display()));
    let text =
        fs::read_to_string(&values).unwrap_or_else(|_| panic!("{} {hint}", values.display()));
    assert!(
        alike(&kept, baked.bytes()),
        "{name}: the planned and baked tables are not those of {}",
        tables.display()
    );
    let ours = golden(name, &kept);
    let kept: Golden = serde_json::from_str(&text).expect("golden values");
    for (ours, kept) in ours.rungs.iter().zip(&kept.rungs) {
        let at = format!("{name}, {} {}", kept.rung, kept.stop);
        assert_eq!(ours.samples, kept.samples, "{at}: samples");
        assert_eq!(ours.grids, kept.grids, "{at}: grids");
        assert_eq!(ours.points, kept.points, "{at}: points");
    }
    assert_eq!(ours, kept);
}

#[test]
fn the_paper_scene_keeps_its_bits() {
    check(shipped::ALL[0], Placement::Isolux);
}

#[test]
fn the_other_light_shape_keeps_its_bits() {
    check(shipped::ALL[1], Placement::Isolux);
}

#[test]
fn tensor_grids_and_points_keep_their_bits() {
    check(shipped::ALL[0], Placement::Error);
}
