//! The rungs on generated form factors of the suite's classes, on several seeds:
//! what holds on the stored suite must hold on any like it.

use glam::DVec3;
use isolux_host::solve::FormFactorRung;
use isolux_host::trade::suite::{CLASSES, CONDITIONED, Case, RELATIVE, cases_of};

/// Seeds in the test command; more with `ISOLUX_SEEDS` in the environment.
const SEEDS: u64 = 4;

/// Half an ulp of 1 in single precision.
const U: f64 = f32::EPSILON as f64 / 2.0;

/// The largest |F − exact| of every class, by rung, and the factor of u L/h: next
/// to an edge for floating point, everywhere for words.
const LAWS: [(&str, f64, f64); 5] = [
    ("poly3", 1.5e-4, 0.03),
    ("poly5", 2.5e-6, 0.03),
    ("poly8", 2.5e-7, 0.03),
    ("best", 2.5e-7, 0.03),
    ("q24", 5e-6, 0.25),
];

/// L/h: the largest distance to a vertex over the one to the nearest edge.
fn conditioning(case: &Case) -> f64 {
    let double = |v: [f32; 3]| DVec3::from_array(v.map(f64::from));
    let p = double(case.position);
    let (mut far, mut near) = (0.0_f64, f64::INFINITY);
    for (i, &a) in case.vertices.iter().enumerate() {
        let (a, b) = (
            double(a),
            double(case.vertices[(i + 1) % case.vertices.len()]),
        );
        let along = b - a;
        let t = (p - a).dot(along) / along.length_squared().max(f64::MIN_POSITIVE);
        far = far.max(p.distance(a));
        near = near.min(p.distance(a + along * t.clamp(0.0, 1.0)));
    }
    far / near
}

/// The relative error allowed on a tiny emitter: 1.5e-6, and for a slender one
/// what rounding takes from D_i × D_{i+1}, 4 u over its slenderness.
fn relative(case: &Case) -> f64 {
    let double = |v: [f32; 3]| DVec3::from_array(v.map(f64::from));
    let corner = |k: usize| double(case.vertices[k % case.vertices.len()]);
    let count = case.vertices.len();
    let offset = |k: usize| corner(k) - corner(0);
    let area: DVec3 = (0..count).map(|k| offset(k).cross(offset(k + 1))).sum();
    let longest = (0..count).map(|k| (corner(k + 1) - corner(k)).length_squared());
    let slenderness = 0.5 * area.length() / longest.fold(0.0, f64::max);
    (4.0 * U / slenderness).max(1.5e-6)
}

fn seeds() -> u64 {
    let asked = std::env::var("ISOLUX_SEEDS").ok();
    asked.and_then(|count| count.parse().ok()).unwrap_or(SEEDS)
}

/// `--nocapture` prints the largest errors of every class and rung.
#[test]
fn other_seeds_keep_what_the_suite_keeps() {
    let mut broken = Vec::new();
    for class in CLASSES {
        let mut worst = [(0.0_f64, 0.0_f64, 0.0_f64, 0_u64, 0_usize); LAWS.len()];
        for seed in 2..2 + seeds() {
            for (number, case) in cases_of(class, seed).iter().enumerate() {
                for ((name, general, edge), worst) in LAWS.iter().zip(&mut worst) {
                    let rung = FormFactorRung::named(name).expect("a rung");
                    let (got, _) = rung
                        .form_factor(case.position, case.normal, &case.vertices)
                        .expect("a receiver");
                    let error = (got - case.exact).abs();
                    let bound = match class {
                        "backface" => f64::MIN_POSITIVE,
                        RELATIVE if *name == "best" => relative(case) * case.exact,
                        // The documented error of unit vectors in words.
                        _ if *name == "q24" => general + edge * U * conditioning(case),
                        CONDITIONED => (0.8 * general + edge * U * conditioning(case)).min(2e-2),
                        _ => *general,
                    };
                    if error > bound || !(0.0..=1.0).contains(&got) {
                        broken.push(format!("{name} {class} seed {seed} case {number}: {error:e} of {bound:e}: {case:?}"));
                    }
                    if error / bound >= worst.1 {
                        *worst = (worst.0.max(error), error / bound, case.exact, seed, number);
                    }
                    worst.0 = worst.0.max(error);
                }
            }
        }
        for ((name, ..), (error, used, exact, seed, number)) in LAWS.iter().zip(worst) {
            println!(
                "{class:12} {name:6} {error:9.2e} {:6.1} % used (F {exact:.3e}, seed {seed} case {number})",
                100.0 * used
            );
        }
    }
    for line in broken.iter().take(5) {
        println!("{line}");
    }
    assert!(broken.is_empty(), "{} errors above their law", broken.len());
}
