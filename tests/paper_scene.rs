//! The paper's simple scene, both light shapes, against irradiances made by an
//! independent system: direct light on A to the rounding of `f32`, one bounce
//! to B within the isolux rung, and the same through the program.

#[path = "command_line/program.rs"]
mod program;

use glam::DVec3;
use isolux::shoot::Stop;
use isolux_host::bake;
use isolux_host::plan::{self, Plan};
use isolux_host::reference::{Reference, Reflections};
use isolux_host::scene::{Scene, file, shipped};
use isolux_host::solve::{self, FormFactorRung, Rung, Sight};
use program::isolux;
use serde::Deserialize;
use std::fmt::Write;

#[derive(Deserialize)]
struct Document {
    points: Vec<Point>,
}

#[derive(Deserialize)]
struct Point {
    surface: String,
    p: [f64; 3],
    n: [f64; 3],
    #[serde(rename = "E")]
    irradiance: f64,
}

/// The shipped scenes with their references.
fn scenes() -> [(&'static str, &'static str, Vec<Point>); 2] {
    let texts = [
        include_str!("data/references/b_simple_3x3.json"),
        include_str!("data/references/b_simple_4.4497x2.0226.json"),
    ];
    let mut shipped = shipped::ALL.iter();
    texts.map(|text| {
        let (name, source) = *shipped.next().expect("two shipped scenes");
        let document: Document = serde_json::from_str(text).expect("a reference");
        (name, source, document.points)
    })
}

fn on<'a>(points: &'a [Point], surface: &'a str) -> impl Iterator<Item = &'a Point> {
    points.iter().filter(move |point| point.surface == surface)
}

fn planned(name: &str, source: &str) -> (Scene, Plan) {
    let scene = file::parse(name, source).expect("a shipped scene");
    let once = Reference::new(&scene, Reflections::AtMost(1), &mut |_| {}).expect("a reference");
    let field = |places: &[(DVec3, DVec3)]| once.irradiance_at(places);
    let plan = plan::isolux(&scene, &scene.budget, &field).expect("a plan");
    (scene, plan)
}

fn worst<'a>(answers: impl Iterator<Item = (f64, &'a Point)>) -> f64 {
    answers
        .map(|(got, point)| (got / point.irradiance - 1.0).abs())
        .fold(0.0, f64::max)
}

#[test]
fn the_reference_agrees_to_nine_digits() {
    for (name, source, points) in scenes() {
        let scene = file::parse(name, source).expect("a shipped scene");
        for (surface, reflections) in [("A", 0), ("B", 1)] {
            let judge = Reference::new(&scene, Reflections::AtMost(reflections), &mut |_| {});
            let judge = judge.expect("a reference");
            let places: Vec<_> = on(&points, surface)
                .map(|point| (point.p.into(), point.n.into()))
                .collect();
            assert!(places.len() >= 20, "points on {surface}");
            let answers = judge.irradiance_at(&places);
            let off = worst(answers.into_iter().zip(on(&points, surface)));
            println!("{name}, {surface}: reference off by {off:.1e}");
            assert!(off <= 1e-9, "{name}, {surface}: {off:e}");
        }
    }
}

#[test]
fn the_kernel_agrees_within_the_rungs_errors() {
    for (name, source, points) in scenes() {
        let (scene, plan) = planned(name, source);
        let tables = bake::bake(&scene, &plan, None).expect("tables");
        let off = |surface: &str, rung, bounces| {
            let solution = solve::solve(&tables, rung, Sight::None, Stop::Reflections(bounces));
            let single = |v: [f64; 3]| v.map(|x| x as f32);
            let asked: Vec<_> = on(&points, surface)
                .map(|point| (single(point.p), single(point.n)))
                .collect();
            let answers = solution.expect("a solution").at(&asked).expect("receivers");
            worst(
                answers
                    .into_iter()
                    .map(|at| f64::from(at.value[0]))
                    .zip(on(&points, surface)),
            )
        };
        let (direct, letter) = (off("A", Rung::Best, 0), off("A", Rung::Libm, 0));
        let bounced = off("B", Rung::Best, 1);
        println!(
            "{name}: A best {direct:.1e}, libm {letter:.1e}; B {:.2} %",
            100.0 * bounced
        );
        assert!(direct <= 2e-6, "{name}, A, best: {direct:e}");
        assert!(letter <= 1e-4, "{name}, A, libm: {letter:e}");
        assert!(bounced <= 0.03, "{name}, B: {bounced}");
        // B sees the light's plane edge on: no direct light, exactly.
        let solution = solve::solve(&tables, Rung::Best, Sight::None, Stop::Reflections(0))
            .expect("a solution");
        let asked: Vec<_> = on(&points, "B")
            .map(|point| (point.p.map(|x| x as f32), point.n.map(|x| x as f32)))
            .collect();
        assert!(
            solution
                .at(&asked)
                .expect("receivers")
                .iter()
                .all(|at| at.value == [0.0; 3])
        );
    }
}

/// In integers the light is that of `best` but for the form factors' own
/// errors: as parts of the brightest place's.
#[test]
fn integers_add_no_more_than_their_rungs_error() {
    for (name, source, points) in scenes() {
        let (scene, plan) = planned(name, source);
        let floats = bake::bake(&scene, &plan, None).expect("tables");
        let whole = bake::integers::bake(&scene, &plan).expect("tables");
        for (surface, bounces) in [("A", 0), ("B", 1)] {
            let single = |v: [f64; 3]| v.map(|x| x as f32);
            let asked: Vec<_> = on(&points, surface)
                .map(|point| (single(point.p), single(point.n)))
                .collect();
            let exact: Vec<f64> = on(&points, surface).map(|p| p.irradiance).collect();
            let brightest = exact.iter().copied().fold(0.0, f64::max);
            let stop = Stop::Reflections(bounces);
            let answers = |tables, rung: FormFactorRung| -> Vec<f64> {
                let solution = solve::solve(tables, rung, Sight::None, stop);
                let answers = solution.expect("a solution").at(&asked);
                let answers = answers.expect("receivers").into_iter();
                answers.map(|at| f64::from(at.value[0])).collect()
            };
            let off = |of: &[f64], from: &[f64]| {
                let off = of.iter().zip(from).map(|(a, b)| (a - b).abs());
                off.fold(0.0, f64::max) / brightest
            };
            let best = answers(&floats, Rung::Best.into());
            let own = off(&best, &exact);
            println!("{name}, {surface}: best {own:.1e} from the reference");
            for (rung, allowed) in [(FormFactorRung::Q29, 1e-6), (FormFactorRung::Q24, 1e-4)] {
                let got = answers(&whole, rung);
                let (exact, apart) = (off(&got, &exact), off(&got, &best));
                println!(
                    "{name}, {surface}: {} {exact:.1e} from the reference, {apart:.1e} from best",
                    rung.name()
                );
                assert!(apart <= allowed, "{name}, {surface}: {apart:e}");
                assert!(exact <= own + allowed, "{name}, {surface}: {exact:e}");
            }
        }
    }
}

#[test]
fn the_plan_is_the_papers() {
    for (name, source, _) in scenes() {
        let (scene, plan) = planned(name, source);
        let [a, light, b] = &plan.surfaces[..] else {
            panic!("three surfaces");
        };
        assert_eq!((a.samples.len(), b.samples.len()), (48, 10), "{name}");
        assert!(light.samples.is_empty() && light.bands.is_empty(), "{name}");
        assert_eq!(a.bands.len(), 4, "{name}");
        assert!(plan.samples() <= 59, "{name}");
        for (surface, planned) in scene.surfaces.iter().zip(&plan.surfaces) {
            if planned.bands.is_empty() {
                continue;
            }
            let sum: f64 = planned.bands.iter().map(|band| band.area).sum();
            let off = (sum / surface.area - 1.0).abs();
            assert!(
                off <= 1e-9,
                "{name}, {}: band areas off by {off:e}",
                surface.name
            );
            assert!(planned.filter_radius > 0.0, "{name}");
            for band in &planned.bands {
                nested(&surface.name, planned, band);
            }
        }
    }
}

/// Twice the signed area of a loop of samples.
fn doubled(at: &[[f64; 2]]) -> f64 {
    (0..at.len())
        .map(|i| {
            let (a, b) = (at[i], at[(i + 1) % at.len()]);
            a[0] * b[1] - a[1] * b[0]
        })
        .sum()
}

/// Whether a place is inside a loop, or on it to 1e-8 m (outlines are cut at
/// the surface's edge to within that): an odd number of
/// edges on its right, or an edge within reach.
fn inside(at: &[[f64; 2]], [u, v]: [f64; 2]) -> bool {
    let edges = (0..at.len()).map(|i| (at[i], at[(i + 1) % at.len()]));
    let on = |(a, b): ([f64; 2], [f64; 2])| {
        let (along, to) = ([b[0] - a[0], b[1] - a[1]], [u - a[0], v - a[1]]);
        let squared = along[0] * along[0] + along[1] * along[1];
        let t = ((to[0] * along[0] + to[1] * along[1]) / squared).clamp(0.0, 1.0);
        (to[0] - t * along[0]).hypot(to[1] - t * along[1]) < 1e-8
    };
    let right = |(a, b): ([f64; 2], [f64; 2])| {
        (a[1] > v) != (b[1] > v) && u < a[0] + (v - a[1]) / (b[1] - a[1]) * (b[0] - a[0])
    };
    edges.clone().any(on) || edges.filter(|&edge| right(edge)).count() % 2 == 1
}

/// The band's area is the sum of its loops' signed areas, every inner loop
/// runs clockwise inside an outer one, and its members are of its vertices.
fn nested(surface: &str, planned: &plan::SurfacePlan, band: &plan::Band) {
    let places: Vec<Vec<[f64; 2]>> = band
        .loops
        .iter()
        .map(|outline| outline.iter().map(|&k| planned.samples[k].vertex).collect())
        .collect();
    let sum: f64 = places.iter().map(|at| doubled(at) / 2.0).sum();
    assert!(
        (sum - band.area).abs() <= 1e-9 * band.area,
        "{surface}: a band of area {} whose loops enclose {sum}",
        band.area
    );
    let outer: Vec<_> = places.iter().filter(|at| doubled(at) > 0.0).collect();
    assert!(!outer.is_empty(), "{surface}: a band without an outer loop");
    for hole in places.iter().filter(|at| doubled(at) < 0.0) {
        let holds = |outer: &&&Vec<[f64; 2]>| hole.iter().all(|&place| inside(outer, place));
        assert_eq!(
            outer.iter().filter(holds).count(),
            1,
            "{surface}: a hole outside"
        );
    }
    // Vertices brighter than the band's inner outline are left out of its mean;
    // the peak belongs to the brightest band.
    assert!(
        !band.members.is_empty(),
        "{surface}: a band that knows no irradiance"
    );
    for member in &band.members {
        let vertex = band.loops.iter().flatten().any(|vertex| vertex == member);
        let peak = planned.samples[*member].tag == plan::Tag::Peak;
        assert!(
            vertex || peak,
            "{surface}: sample {member} is no vertex of its band"
        );
    }
}

#[test]
fn the_program_gives_the_same() {
    let directory = tempfile::tempdir().expect("a temporary directory");
    for (name, _, points) in scenes() {
        let scene = name.trim_end_matches(".toml");
        for (surface, bounces, reference, allowed) in [
            ("A", "0", false, 2e-6),
            ("B", "1", false, 0.03),
            ("A", "0", true, 1e-9),
            ("B", "1", true, 1e-9),
        ] {
            let mut text = String::new();
            for Point { p, n, .. } in on(&points, surface) {
                writeln!(
                    text,
                    "{} {} {} {} {} {}",
                    p[0], p[1], p[2], n[0], n[1], n[2]
                )
                .expect("a string takes it");
            }
            let file = directory.path().join("f.pts");
            std::fs::write(&file, text).expect("points");
            let mut arguments = vec!["solve", scene, "--points", file.to_str().expect("UTF-8")];
            arguments.extend(["--bounces", bounces]);
            if reference {
                arguments.push("--reference");
            }
            let ran = isolux(&arguments, directory.path(), "");
            assert_eq!(ran.code, 0, "{}", ran.stderr);
            let mut rows = ran.stdout.lines();
            assert_eq!(rows.next(), Some("x,y,z,nx,ny,nz,E"));
            let answers = rows.map(|row| {
                row.rsplit(',')
                    .next()
                    .and_then(|e| e.parse::<f64>().ok())
                    .expect("a number")
            });
            let answers: Vec<f64> = answers.collect();
            assert_eq!(answers.len(), on(&points, surface).count());
            let off = worst(answers.into_iter().zip(on(&points, surface)));
            assert!(off <= allowed, "{arguments:?}: {off:e}");
        }
    }
}
