//! The kernel on the emulated device gives the host's bits, at costs that do
//! not depend on the day.
//!
//! Skipped, loudly, where the emulator or the Rust target is missing; with
//! `ISOLUX_REQUIRE_QEMU=1` in the environment that is a failure instead.

use isolux::form_factor::Best;
use isolux::number::SoftRoot;
use isolux::scene::records::{self, Counts, Emitter, Header, Loop, Surface, checksum};
use isolux::scene::{Aligned, MAGIC, Scene, VERSION, required_bytes};
use isolux::shoot::{Light, Stop};
use isolux_host::device::{self, Core, Error, Job, Measured, Options};
use isolux_host::occlusion::Occlusion;
use isolux_host::reference::{Reference, Reflections};
use isolux_host::scene::{Budget, file, shipped};
use isolux_host::solve::{self, FormFactorRung, Rung, Sight};
use isolux_host::{bake, pilot, plan};
use zerocopy::IntoBytes;

const SAMPLES: usize = 50;
const EMITTERS: usize = 3;
const RESOLUTION: usize = 200;
const STOP: Stop = Stop::below(0.001);

/// Surfaces: a floor and a wall of 25 samples each that reflect half of the
/// light, and a luminaire above.
fn surfaces() -> [Surface; 3] {
    let floor = Surface {
        origin: [-2.5, -2.5, 0.0],
        axis_u: [1.0, 0.0, 0.0],
        axis_v: [0.0, 1.0, 0.0],
        normal: [0.0, 0.0, 1.0],
        size: [5.0, 5.0],
        direct: 0,
        indirect: 0,
        unshadowed: 0,
        first_field: 0,
        fields: 0,
        filter_radius: 1.5,
        first_sample: 0,
        samples: 25,
    };
    let wall = Surface {
        origin: [2.5, -2.5, 0.0],
        axis_u: [0.0, 1.0, 0.0],
        axis_v: [0.0, 0.0, 1.0],
        normal: [-1.0, 0.0, 0.0],
        first_sample: 25,
        ..floor
    };
    let luminaire = Surface {
        origin: [-1.0, -1.0, 3.0],
        axis_u: [0.0, 1.0, 0.0],
        axis_v: [1.0, 0.0, 0.0],
        normal: [0.0, 0.0, -1.0],
        size: [2.0, 2.0],
        direct: 0,
        indirect: 0,
        unshadowed: 0,
        first_field: 0,
        fields: 0,
        filter_radius: 0.0,
        first_sample: 50,
        samples: 0,
    };
    [floor, wall, luminaire]
}

/// A small scene as a bake would write it: each reflecting surface is one
/// emitter that all of its samples belong to.
fn tables() -> Vec<u8> {
    let surfaces = surfaces();
    let emitter = |surface: u32, first_member, members| Emitter {
        surface,
        first_loop: surface,
        loops: 1,
        first_member,
        members,
        area: surfaces[surface as usize].size.iter().product(),
    };
    let emitters = [emitter(2, 0, 0), emitter(0, 0, 25), emitter(1, 25, 25)];
    let (reflectances, exitances) = ([0.5_f32, 0.5, 0.0], [100.0_f32]);
    let loops = [0, 1, 2].map(|index| Loop {
        first_vertex: 4 * index,
        vertices: 4,
        reach_squared: surfaces[index as usize].size.iter().map(|x| x * x).sum(),
    });
    let vertices: Vec<[f32; 3]> = surfaces
        .iter()
        .flat_map(|surface| {
            let [width, height] = surface.size;
            let corners = [[0.0, 0.0], [width, 0.0], [width, height], [0.0, height]];
            corners.map(|corner| surface.place(corner).into())
        })
        .collect();
    let grid = |index: u16| [0.5 + f32::from(index % 5), 0.5 + f32::from(index / 5)];
    let samples: Vec<[f32; 2]> = (0..50).map(|index| grid(index % 25)).collect();
    let members: Vec<u16> = (0..50).collect();

    let counts = Counts {
        channels: 1,
        coefficients: 1,
        surfaces: 3,
        luminaires: 1,
        emitters: 3,
        loops: 3,
        vertices: 12,
        samples: 50,
        members: 50,
        ..Counts::default()
    };
    let mut header = Header {
        magic: MAGIC,
        version: VERSION,
        bytes: required_bytes(&counts).expect("far below 4 GiB"),
        checksum: 0,
        counts,
        sight: records::Sight::default(),
        tolerance: 5e-6,
        ahead: 0.0,
    };
    let sections = [
        surfaces.as_bytes(),
        reflectances.as_bytes(),
        emitters.as_bytes(),
        exitances.as_bytes(),
        loops.as_bytes(),
        vertices.as_bytes(),
        samples.as_bytes(),
        members.as_bytes(),
    ]
    .concat();
    let whole = [header.as_bytes(), &sections].concat();
    header.checksum = checksum(&whole[std::mem::offset_of!(Header, checksum) + 4..]);
    [header.as_bytes(), &sections].concat()
}

/// What the same kernel gives on the host.
fn expected(tables: &[u8]) -> Vec<u32> {
    let mut place = Aligned([0_u8; 4096]);
    let place = &mut place.0[..tables.len()];
    place.copy_from_slice(tables);
    let scene = Scene::load(place).expect("sound tables");
    let mut light = Light::<Best, SAMPLES, EMITTERS>::new(scene).expect("room for the scene");
    light.solve(STOP);
    let mut bits: Vec<u32> = light.irradiance().iter().map(|e| e.to_bits()).collect();
    let mut row = [0.0; RESOLUTION];
    for surface in 0..2 {
        for number in 0..RESOLUTION as u32 {
            light
                .resample_row::<SoftRoot>(surface, [RESOLUTION as u32; 2], number, &mut row)
                .expect("a row of a surface");
            bits.extend(row.map(f32::to_bits));
        }
    }
    bits
}

/// Runs the scene; `None` where the machine lacks what it takes.
fn run(tables: &[u8], expected: &[u32], options: &Options) -> Option<Measured> {
    let job = Job {
        scene: "corner",
        tables,
        arithmetic: "best",
        visibility: "none",
        stop: STOP,
        resolution: RESOLUTION,
        expected,
        budget: Budget::default(),
    };
    match device::run(&job, options) {
        Ok(measured) => Some(measured),
        Err(error) => skip(error),
    }
}

/// Runs a job with the FPU's root on every core, which must all give the host's
/// bits; `None` where the machine lacks what it takes.
fn on_every_core(job: &Job<'_>) -> Option<Measured> {
    let options = Options {
        software_root: false,
        ..Options::default()
    };
    let measured = match device::run(job, &options) {
        Ok(measured) => measured,
        Err(error) => return skip(error),
    };
    println!("{measured:#?}");
    assert!(measured.bits_equal);
    assert!(measured.stack_bytes <= measured.stack_bound_bytes);
    Some(measured)
}

/// Skips the test where something is missing and may be.
fn skip<T>(error: Error) -> Option<T> {
    let required = std::env::var_os("ISOLUX_REQUIRE_QEMU").is_some();
    assert!(error.is_missing() && !required, "{error}");
    eprintln!("SKIPPED: {error}");
    None
}

#[test]
fn every_core_gives_the_hosts_bits() {
    let tables = tables();
    let expected = expected(&tables);
    let Some(measured) = run(&tables, &expected, &Options::default()) else {
        return;
    };
    println!("{measured:#?}");
    assert!(measured.bits_equal);
    assert_eq!(measured.values, 50 + 2 * RESOLUTION * RESOLUTION);
    assert!(expected.iter().any(|&bits| bits != 0));
    assert!(measured.stack_bytes > 0);
    assert!(measured.stack_bytes <= measured.stack_bound_bytes);
    assert!(measured.budget.kept);
    assert_eq!(measured.flash_tables_bytes, tables.len() as u64);
    assert!(measured.instructions_software_root > Some(measured.instructions));
    let of = |name: &str| {
        let mut targets = measured.targets.iter();
        targets.find(|target| target.core == name)
    };
    let counts = Core::ALL.map(|core| of(core.name()).map(|target| target.instructions));
    assert_eq!(counts[0], Some(measured.instructions));
    assert!(counts[1] > Some(0));
    assert!(
        counts[2] > counts[0],
        "without FPU every operation is a call"
    );
}

/// The scene of the paper, planned and baked as `isolux device` does it.
#[test]
fn the_paper_scene_gives_the_hosts_bits_on_every_core() {
    let (_, source) = shipped::ALL
        .iter()
        .find(|(name, _)| *name == "paper.toml")
        .expect("shipped");
    let scene = file::parse("paper.toml", source).expect("a sound scene");
    let once = Reference::new(&scene, Reflections::AtMost(1), &mut |_| {}).expect("a reference");
    let field = |places: &[_]| once.irradiance_at(places);
    let plan = plan::isolux(&scene, &scene.budget, &field).expect("a plan");
    let tables = bake::bake(&scene, &plan, None).expect("tables");
    for rung in [Rung::Best, Rung::Libm] {
        let solution = solve::solve(&tables, rung, Sight::None, STOP).expect("a solution");
        let mut expected = solution.irradiance_bits();
        for (index, surface) in plan.surfaces.iter().enumerate() {
            if !surface.samples.is_empty() {
                let grid = solution.resample(index, RESOLUTION as u32).expect("a grid");
                expected.extend(grid.bits);
            }
        }
        let job = Job {
            scene: &scene.name,
            tables: tables.bytes(),
            arithmetic: rung.name(),
            visibility: "none",
            stop: STOP,
            resolution: RESOLUTION,
            expected: &expected,
            budget: scene.budget,
        };
        let options = Options {
            software_root: rung == Rung::Best,
            ..Options::default()
        };
        let measured = match device::run(&job, &options) {
            Ok(measured) => measured,
            Err(error) => return skip(error).unwrap_or_default(),
        };
        println!("{measured:#?}");
        assert!(measured.bits_equal, "{rung:?}");
        assert_eq!(
            measured.values,
            tables.counts.samples as usize + 2 * RESOLUTION * RESOLUTION
        );
        assert!(measured.budget.kept, "{rung:?}");
        assert!(measured.stack_bytes <= measured.stack_bound_bytes);
    }
}

/// Rows and columns of grids where few suffice.
const FEW: usize = 4;

/// The host's bits of every sample, and of a small grid of every surface that has samples.
fn few(solution: &solve::Solution<'_>, plan: &plan::Plan) -> Vec<u32> {
    let mut expected = solution.irradiance_bits();
    for (index, surface) in plan.surfaces.iter().enumerate() {
        if !surface.samples.is_empty() {
            let grid = solution.resample(index, FEW as u32).expect("a grid");
            expected.extend(grid.bits);
        }
    }
    expected
}

/// The paper's scene with nested emitters: members have weights of their own.
#[test]
fn layers_give_the_hosts_bits_on_every_core() {
    const ROWS: usize = 6;
    let mut sources = shipped::ALL.iter();
    let (name, source) = sources
        .find(|(name, _)| *name == "paper.toml")
        .expect("shipped");
    let scene = file::parse(name, source).expect("a sound scene");
    let once = Reference::new(&scene, Reflections::AtMost(1), &mut |_| {}).expect("a reference");
    let field = |places: &[_]| once.irradiance_at(places);
    let plan = plan::layer_cake(&scene, &scene.budget, &field).expect("a plan");
    let tables = bake::bake(&scene, &plan, None).expect("tables");
    let solution = solve::solve(&tables, Rung::Best, Sight::None, STOP).expect("a solution");
    let mut expected = solution.irradiance_bits();
    for (index, surface) in plan.surfaces.iter().enumerate() {
        if !surface.samples.is_empty() {
            let grid = solution.resample(index, ROWS as u32).expect("a grid");
            expected.extend(grid.bits);
        }
    }
    let job = Job {
        scene: &scene.name,
        tables: tables.bytes(),
        arithmetic: "best",
        visibility: "none",
        stop: STOP,
        resolution: ROWS,
        expected: &expected,
        budget: scene.budget,
    };
    on_every_core(&job);
}

/// The paper's scene on tensor grids, whose nodes shoot; and a penumbra, with meshes
/// and exact visibility.
#[test]
fn fields_give_the_hosts_bits_on_every_core() {
    const ROWS: usize = 9;
    let named = |name: &str| {
        let (name, source) = shipped::ALL
            .iter()
            .find(|(file, _)| *file == name)
            .expect("shipped");
        file::parse(name, source).expect("a sound scene")
    };
    let reference = |scene, times| Reference::new(scene, Reflections::AtMost(times), &mut |_| {});
    let open = named("paper.toml");
    let once = reference(&open, 1).expect("a reference");
    let field = |places: &[_]| once.irradiance_at(places);
    let plan = plan::error_driven(&open, &open.budget, &field, &[]).expect("a plan");
    let of_open = plan.expect("points stand for surfaces");
    let tables_of_open = bake::bake(&open, &of_open, None).expect("tables");
    let mut room = named("penumbra.toml");
    room.budget.samples = Some(40);
    let places = room.surfaces.iter().flat_map(|s| s.vertices.clone());
    let occlusion = Occlusion::for_receivers_within(&room, places).expect("occluders");
    let direct = reference(&room, 0).expect("a reference");
    let field = |places: &[_]| direct.irradiance_at(places);
    let looking = (Some(&occlusion), Sight::Exact);
    let of_room = pilot::room(
        &room,
        &room.budget,
        looking,
        pilot::Manner::default(),
        &field,
    )
    .expect("a plan");
    let tables_of_room = bake::bake(&room, &of_room, Some(occlusion)).expect("tables");
    for (scene, plan, tables, sight) in [
        (&open, &of_open, &tables_of_open, Sight::None),
        (&room, &of_room, &tables_of_room, Sight::Exact),
    ] {
        let solution = solve::solve(tables, Rung::Best, sight, STOP).expect("a solution");
        let mut expected = solution.irradiance_bits();
        for (index, surface) in plan.surfaces.iter().enumerate() {
            if !surface.samples.is_empty() {
                let grid = solution.resample(index, ROWS as u32).expect("a grid");
                expected.extend(grid.bits);
            }
        }
        let job = Job {
            scene: &scene.name,
            tables: tables.bytes(),
            arithmetic: "best",
            visibility: sight.name(),
            stop: STOP,
            resolution: ROWS,
            expected: &expected,
            budget: scene.budget,
        };
        on_every_core(&job);
    }
}

/// The Cornell box in few patches, with codes: no occluder is on the device.
#[test]
fn a_room_with_codes_gives_the_hosts_bits() {
    let mut sources = shipped::ALL.iter();
    let (name, source) = sources
        .find(|(name, _)| *name == "cornell.toml")
        .expect("shipped");
    let mut scene = file::parse(name, source).expect("a sound scene");
    scene.budget.samples = Some(200);
    let reference = Reference::new(&scene, Reflections::AtMost(0), &mut |_| {});
    let direct = reference.expect("a reference");
    let field = |places: &[_]| direct.irradiance_at(places);
    let plan = plan::patches::linear(&scene, &scene.budget, &field).expect("a plan");
    let places = scene.surfaces.iter().flat_map(|s| s.vertices.clone());
    let occlusion = Occlusion::for_receivers_within(&scene, places).expect("occluders");
    let tables = bake::bake_coded(&scene, &plan, Some(occlusion)).expect("tables");
    let solution = solve::solve(&tables, Rung::Best, Sight::Exact, STOP).expect("a solution");
    let expected = few(&solution, &plan);
    let job = Job {
        scene: &scene.name,
        tables: tables.bytes(),
        arithmetic: "best",
        visibility: "exact",
        stop: STOP,
        resolution: FEW,
        expected: &expected,
        budget: scene.budget,
    };
    on_every_core(&job);
}

/// The same scene in integers, where nothing is to be had from an FPU.
#[test]
fn integers_give_the_hosts_bits_on_every_core() {
    const ROWS: usize = 6;
    let (_, source) = shipped::ALL
        .iter()
        .find(|(name, _)| *name == "paper.toml")
        .expect("shipped");
    let scene = file::parse("paper.toml", source).expect("a sound scene");
    let once = Reference::new(&scene, Reflections::AtMost(1), &mut |_| {}).expect("a reference");
    let field = |places: &[_]| once.irradiance_at(places);
    let plan = plan::isolux(&scene, &scene.budget, &field).expect("a plan");
    let tables = bake::integers::bake(&scene, &plan).expect("tables");
    let rung = FormFactorRung::Q29;
    let solution = solve::solve(&tables, rung, Sight::None, STOP).expect("a solution");
    let mut expected = solution.irradiance_bits();
    for (index, _) in (0..)
        .zip(&plan.surfaces)
        .filter(|(_, s)| !s.samples.is_empty())
    {
        let grid = solution.resample(index, ROWS as u32).expect("a grid");
        expected.extend(grid.bits);
    }
    let job = Job {
        scene: &scene.name,
        tables: tables.bytes(),
        arithmetic: rung.name(),
        visibility: "none",
        stop: STOP,
        resolution: ROWS,
        expected: &expected,
        budget: scene.budget,
    };
    let Some(measured) = on_every_core(&job) else {
        return;
    };
    assert_eq!(measured.values, 58 + 2 * ROWS * ROWS);
    let counts: Vec<u64> = measured.targets.iter().map(|t| t.instructions).collect();
    let (least, most) = (counts.iter().min(), counts.iter().max());
    let (least, most) = (least.expect("cores"), most.expect("cores"));
    assert!(most * 10 < least * 11, "no core is at a loss: {counts:?}");
}

/// The office in few patches, with terms in integers: desks that hide, and no FPU.
#[test]
fn a_room_in_integers_gives_the_hosts_bits_on_every_core() {
    let mut scene = file::parse("office.toml", shipped::OFFICE).expect("a sound scene");
    scene.budget.samples = Some(400);
    let reference = Reference::new(&scene, Reflections::AtMost(0), &mut |_| {});
    let direct = reference.expect("a reference");
    let field = |places: &[_]| direct.irradiance_at(places);
    let plan = plan::patches::linear(&scene, &scene.budget, &field).expect("a plan");
    let occlusion = Occlusion::of(&scene).expect("few vertices");
    let tables = bake::integers::bake_matrix(&scene, &plan, Some(occlusion), 8);
    let tables = tables.expect("tables");
    let rung = FormFactorRung::Q29;
    let solution = solve::solve(&tables, rung, Sight::Exact, STOP).expect("a solution");
    let expected = few(&solution, &plan);
    let job = Job {
        scene: &scene.name,
        tables: tables.bytes(),
        arithmetic: rung.name(),
        visibility: "exact",
        stop: STOP,
        resolution: FEW,
        expected: &expected,
        budget: scene.budget,
    };
    on_every_core(&job);
}

#[test]
fn a_flipped_bit_is_seen() {
    let tables = tables();
    let options = Options {
        cores: vec![Core::CortexM4F],
        software_root: false,
        negative_control: true,
        ..Options::default()
    };
    let Some(measured) = run(&tables, &expected(&tables), &options) else {
        return;
    };
    assert!(!measured.bits_equal);
    assert_eq!(measured.targets[0].differences, 1);
    let first = measured.targets[0].first_difference.as_ref();
    let last_of_first_row = 50 + RESOLUTION - 1;
    assert_eq!(first.map(|first| first.index), Some(last_of_first_row));
}

#[test]
fn counts_do_not_depend_on_the_day() {
    let tables = tables();
    let expected = expected(&tables);
    let options = Options {
        cores: vec![Core::CortexM4F],
        software_root: false,
        ..Options::default()
    };
    let Some(once) = run(&tables, &expected, &options) else {
        return;
    };
    assert_eq!(Some(once), run(&tables, &expected, &options));
}

#[test]
fn changed_tables_are_refused_on_the_device() {
    let mut tables = tables();
    if let Some(last) = tables.last_mut() {
        *last ^= 1;
    }
    let job = Job {
        scene: "corner",
        tables: &tables,
        arithmetic: "best",
        visibility: "none",
        stop: STOP,
        resolution: RESOLUTION,
        expected: &[],
        budget: Budget::default(),
    };
    match device::run(&job, &Options::default()) {
        Err(Error::Firmware { status, said, .. }) => {
            assert_eq!(status, Some(1));
            assert!(said.contains("Checksum"), "{said}");
        }
        Err(error) => {
            skip::<()>(error);
        }
        Ok(measured) => panic!("{measured:?}"),
    }
}

#[test]
fn an_emulation_without_end_is_stopped() {
    let tables = tables();
    let options = Options {
        cores: vec![Core::CortexM4F],
        software_root: false,
        time_limit: std::time::Duration::from_millis(1),
        ..Options::default()
    };
    let job = Job {
        scene: "corner",
        tables: &tables,
        arithmetic: "best",
        visibility: "none",
        stop: STOP,
        resolution: RESOLUTION,
        expected: &[],
        budget: Budget::default(),
    };
    match device::run(&job, &options) {
        Err(Error::TimeLimit { .. }) => {}
        Err(error) => {
            skip::<()>(error);
        }
        Ok(measured) => panic!("{measured:?}"),
    }
}
