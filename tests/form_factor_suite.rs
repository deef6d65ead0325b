//! The suite of point-to-polygon form factors made by an independent system
//! with 80 digits, judged by class and by rung against the errors that
//! tests/data/form-factor-allowed.csv allows.
//!
//! What a class and a rung are allowed is data, so that a promise that changes
//! is one line of a diff:
//!
//! ```text
//! |F - exact| <= absolute + edge · u L/h      never above 2e-2
//! |F - exact| <= relative · exact             where `relative` is not empty
//! ```
//!
//! u is half an ulp of 1 in the rung's number, L the largest distance from the
//! point to a vertex, h its distance to the nearest edge. `--nocapture` prints
//! the table of what was measured.

use isolux::form_factor::fixed_point::{Q24, Q29};
use isolux::form_factor::{
    Arithmetic, Baked, Best, Edge, Libm, Outline, form_factor, of_baked_loops, of_loops,
};
use isolux::geometry::{Plane, Receiver};
use isolux::number::{Number, SoftRoot};
use isolux_host::solve::{FormFactorRung, fixed_form_factor};
use serde::Deserialize;
use std::collections::BTreeMap;
use std::fmt::Write;

#[derive(Deserialize)]
struct Case {
    id: String,
    #[serde(rename = "cls")]
    class: String,
    p: [f64; 3],
    n: [f64; 3],
    v: Vec<[f64; 3]>,
    #[serde(rename = "F")]
    f: String,
}

impl Case {
    /// The exact form factor. The class `onplane` documents the limit from the
    /// front; a receiver on the emitter's plane gets 0 by convention.
    fn exact(&self) -> f64 {
        if self.class == "onplane" {
            0.0
        } else {
            self.f.parse().expect("30 digits")
        }
    }

    /// L/h: the largest distance to a vertex over the one to the nearest edge.
    fn conditioning(&self) -> f64 {
        let sub = |a: [f64; 3], b: [f64; 3]| [a[0] - b[0], a[1] - b[1], a[2] - b[2]];
        let dot = |a: [f64; 3], b: [f64; 3]| a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
        let (mut far, mut near) = (0.0_f64, f64::INFINITY);
        for (i, &a) in self.v.iter().enumerate() {
            let b = self.v[(i + 1) % self.v.len()];
            let (along, to) = (sub(b, a), sub(self.p, a));
            let t = (dot(to, along) / dot(along, along).max(f64::MIN_POSITIVE)).clamp(0.0, 1.0);
            let off = sub(to, along.map(|x| x * t));
            far = far.max(dot(to, to).sqrt());
            near = near.min(dot(off, off).sqrt());
        }
        far / near
    }
}

/// A line of the table of allowed errors.
struct Allowed {
    absolute: f64,
    edge: f64,
    relative: Option<f64>,
}

/// What no law may allow more than, not even next to an edge.
const CEILING: f64 = 2e-2;

/// Half an ulp of 1 in the numbers that rungs compute in.
const SINGLE: f64 = f32::EPSILON as f64 / 2.0;
const DOUBLE: f64 = f64::EPSILON / 2.0;

fn cases() -> Vec<Case> {
    include_str!("data/form-factor.jsonl")
        .lines()
        .map(|line| serde_json::from_str(line).expect("a case a line"))
        .collect()
}

fn allowed() -> BTreeMap<(String, String), Allowed> {
    let lines = include_str!("data/form-factor-allowed.csv").lines();
    lines
        .filter(|line| !line.starts_with('#') && !line.starts_with("class,"))
        .map(|line| {
            let fields: Vec<&str> = line.splitn(6, ',').collect();
            let [class, rung, absolute, edge, relative, law] = fields[..] else {
                panic!("six fields a line: {line}");
            };
            assert!(!law.is_empty(), "no law behind {line}");
            let number = |text: &str| text.parse::<f64>().expect(line);
            let entry = Allowed {
                absolute: number(absolute),
                edge: number(edge),
                relative: (!relative.is_empty()).then(|| number(relative)),
            };
            ((class.to_owned(), rung.to_owned()), entry)
        })
        .collect()
}

fn single(v: [f64; 3]) -> [f32; 3] {
    v.map(|x| x as f32)
}

/// The answers of `best` and `libm` in single and in double precision, and of
/// the integer rungs.
fn answers(p: [f64; 3], n: [f64; 3], v: &[[f64; 3]]) -> [f64; 6] {
    let vertices: Vec<[f32; 3]> = v.iter().map(|&v| single(v)).collect();
    let r32 = Receiver::new::<SoftRoot>(single(p), single(n)).expect("a receiver");
    let r64 = Receiver::new::<SoftRoot>(p, n).expect("a receiver");
    [
        f64::from(form_factor::<Best, f32>(&r32, &vertices)),
        f64::from(form_factor::<Libm, f32>(&r32, &vertices)),
        form_factor::<Best, f64>(&r64, v),
        form_factor::<Libm, f64>(&r64, v),
        fixed_form_factor::<Q24>(single(p), single(n), &vertices)
            .expect("a receiver")
            .into(),
        fixed_form_factor::<Q29>(single(p), single(n), &vertices)
            .expect("a receiver")
            .into(),
    ]
}

/// The answer of `best` with a table of the emitter's edges.
fn baked(p: [f64; 3], n: [f64; 3], v: &[[f64; 3]]) -> f64 {
    let vertices: Vec<[f32; 3]> = v.iter().map(|&v| single(v)).collect();
    let receiver = Receiver::new::<SoftRoot>(single(p), single(n)).expect("a receiver");
    let edges: Vec<Edge> = Edge::of_loop(&vertices).collect();
    let baked = Baked::new(Outline::new(&vertices), &edges).expect("a table of its edges");
    let plane = Plane::of_polygon(&vertices);
    of_baked_loops::<SoftRoot>(&receiver, &plane, [baked].into_iter()).into()
}

/// The answers of every rung of the ladder, of `best` with a table, and those
/// in double precision, with half an ulp of 1.
fn all_answers(case: &Case) -> Vec<(String, f64, f64)> {
    let vertices: Vec<[f32; 3]> = case.v.iter().map(|&v| single(v)).collect();
    let ladder = FormFactorRung::ALL.into_iter().map(|rung| {
        let answer = rung.form_factor(single(case.p), single(case.n), &vertices);
        let (answer, _) = answer.expect("a receiver");
        match rung {
            FormFactorRung::Float(rung) => (format!("{} f32", rung.name()), answer, SINGLE),
            FormFactorRung::Q24 => (rung.name().to_owned(), answer, 1.0 / (1_u32 << 25) as f64),
            FormFactorRung::Q29 => (rung.name().to_owned(), answer, 1.0 / (1_u32 << 30) as f64),
        }
    });
    let [_, _, best, libm, ..] = answers(case.p, case.n, &case.v);
    let double = [("best f64", best), ("libm f64", libm)];
    let table = (
        "baked f32".to_owned(),
        baked(case.p, case.n, &case.v),
        SINGLE,
    );
    ladder
        .chain([table])
        .chain(double.map(|(name, answer)| (name.to_owned(), answer, DOUBLE)))
        .collect()
}

/// The worst case of a class on a rung.
#[derive(Default)]
struct Worst {
    cases: usize,
    absolute: (f64, String),
    /// The largest error as a part of what is allowed.
    used: (f64, String),
    relative: (f64, String),
}

fn note(worst: &mut (f64, String), value: f64, id: &str) {
    // A NaN must win: it is the worst there is.
    if value > worst.0 || value.is_nan() || worst.1.is_empty() {
        *worst = (value, id.to_owned());
    }
}

#[test]
fn every_class_keeps_what_every_rung_promises() {
    let allowed = allowed();
    let mut table: BTreeMap<(String, String), Worst> = BTreeMap::new();
    for case in cases() {
        let (exact, conditioning) = (case.exact(), case.conditioning());
        for (rung, got, u) in all_answers(&case) {
            let key = (case.class.clone(), rung);
            let law = allowed
                .get(&key)
                .unwrap_or_else(|| panic!("nothing allowed for {key:?}"));
            let error = (got - exact).abs();
            let mut bound = law.absolute;
            if law.edge > 0.0 {
                bound = (bound + law.edge * u * conditioning).min(CEILING);
            }
            let worst = table.entry(key).or_default();
            worst.cases += 1;
            note(&mut worst.absolute, error, &case.id);
            // Where nothing is allowed, nothing may be there.
            let used = if error == 0.0 { 0.0 } else { error / bound };
            note(&mut worst.used, used, &case.id);
            if exact > 0.0 {
                note(&mut worst.relative, error / exact, &case.id);
            }
        }
    }
    assert_eq!(
        table.len(),
        allowed.len(),
        "classes and rungs without a case"
    );
    let (mut text, mut broken) = (String::new(), 0);
    for ((class, rung), worst) in &table {
        let law = &allowed[&(class.clone(), rung.clone())];
        let too_far = !law
            .relative
            .is_none_or(|relative| worst.relative.0 <= relative);
        let fails = !matches!(worst.used.0, 0.0..=1.0) || too_far;
        broken += usize::from(fails);
        let relative = law.relative.map_or("-".to_owned(), |r| format!("{r:.1e}"));
        writeln!(
            text,
            "{} {class:12} {rung} {:4} cases  abs {:8.1e} of {:.1e}+{:.2}uL/h ({:5.1} % used, {:20}) rel {:8.1e} of {relative:8} ({})",
            if fails { "BROKEN" } else { "      " },
            worst.cases,
            worst.absolute.0,
            law.absolute,
            law.edge,
            100.0 * worst.used.0,
            worst.used.1,
            worst.relative.0,
            worst.relative.1,
        )
        .expect("a string takes it");
    }
    println!("{text}");
    assert_eq!(broken, 0, "errors above what is allowed:\n{text}");
}

/// A triangle whose edges are seen under up to 53°: it is small for a selector
/// that looks at half of its extent only, and its arc tangents then leave the
/// domain of their fit, by 1.2e-3 of F.
#[test]
fn a_small_triangle_with_a_long_edge_stays_in_the_domain_of_its_fit() {
    let triangle = [[0.0, 0.05, 1.0], [0.497, 0.0, 1.0], [-0.497, 0.0, 1.0]];
    let (p, n) = ([0.0; 3], [0.0, 0.6, 0.8]);
    let exact =
        isolux_host::reference::form_factor(p.into(), n.into(), &triangle.map(glam::DVec3::from));
    assert!((exact - 0.005943).abs() < 5e-7, "{exact}");
    // Any vertex may be the one that extents are measured from.
    for first in 0..3 {
        let mut turned = triangle;
        turned.rotate_left(first);
        let [best, libm, best_f64, libm_f64, q24, q29] = answers(p, n, &turned);
        assert!((best - exact).abs() <= 2.5e-7, "{best} {exact}");
        assert!((libm - exact).abs() <= 4e-7, "{libm} {exact}");
        assert!((best_f64 - exact).abs() <= 2e-8, "{best_f64} {exact}");
        assert!((libm_f64 - exact).abs() <= 1e-12, "{libm_f64} {exact}");
        assert!((q24 - exact).abs() <= 5e-6, "{q24} {exact}");
        assert!((q29 - exact).abs() <= 5e-8, "{q29} {exact}");
        // Seen from behind, there is no light.
        turned.reverse();
        assert_eq!(answers(p, n, &turned), [0.0; 6]);
    }
}

/// The square ring between two half edges, as one outer and one inner loop
/// that runs the other way.
fn ring<A: Arithmetic<N>, N: Number>(
    receiver: &Receiver<N>,
    outer: &[[N; 3]],
    hole: &[[N; 3]],
) -> N {
    let mut reversed = hole.to_vec();
    reversed.reverse();
    let plane = Plane::of_polygon(outer);
    let loops = [Outline::new(outer), Outline::new(&reversed)];
    of_loops::<A, N>(receiver, &plane, loops.into_iter())
}

#[test]
fn a_hole_takes_away_what_it_would_send() {
    let square = |half: f64| {
        [
            [-half, -half, 2.0],
            [-half, half, 2.0],
            [half, half, 2.0],
            [half, -half, 2.0],
        ]
    };
    // In front, beside, below the hole, and with the horizon across both.
    let receivers = [
        ([0.0; 3], [0.0, 0.0, 1.0]),
        ([3.0, -1.0, 0.5], [-0.5, 0.25, 1.0]),
        ([0.25, 0.125, 1.75], [0.0, 0.0, 1.0]),
        ([0.5, 0.0, 1.5], [1.0, 0.0, 0.0]),
        ([0.0, 0.0, 1.0], [1.0, 1.0, 0.25]),
    ];
    let single = |v: &[[f64; 3]]| v.iter().map(|&v| v.map(|x| x as f32)).collect::<Vec<_>>();
    for (p, n) in receivers {
        for half in [0.125, 0.5, 0.9375] {
            let (outer, hole) = (square(1.0), square(half));
            let r64 = Receiver::new::<SoftRoot>(p, n).expect("a receiver");
            let r32 = Receiver::new::<SoftRoot>(p.map(|x| x as f32), n.map(|x| x as f32))
                .expect("a receiver");
            let polygon = |v: [[f64; 3]; 4]| v.map(glam::DVec3::from);
            let reference =
                |v| isolux_host::reference::form_factor(p.into(), n.into(), &polygon(v));
            let exact = reference(outer) - reference(hole);
            assert!(exact > 1e-3, "the ring is in sight");
            let best = ring::<Best, f32>(&r32, &single(&outer), &single(&hole));
            let libm = ring::<Libm, f32>(&r32, &single(&outer), &single(&hole));
            let best_f64 = ring::<Best, f64>(&r64, &outer, &hole);
            let libm_f64 = ring::<Libm, f64>(&r64, &outer, &hole);
            // Each loop errs on its own.
            assert!(
                (f64::from(best) - exact).abs() <= 2.0 * 2.5e-7,
                "{best} {exact}"
            );
            assert!(
                (f64::from(libm) - exact).abs() <= 2.0 * 1.5e-5,
                "{libm} {exact}"
            );
            assert!((best_f64 - exact).abs() <= 2.0 * 2e-8, "{best_f64} {exact}");
            assert!((libm_f64 - exact).abs() <= 1e-12, "{libm_f64} {exact}");
        }
    }
}
