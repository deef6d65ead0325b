//! Loops on both sides of 22.5°, where the polynomial rungs change from a form
//! without a root to one with a root an edge: in double precision both are as good
//! as their fit.

use glam::{DVec2, DVec3};
use isolux::form_factor::{Poly3, Poly5, Poly8, form_factor};
use isolux::geometry::Receiver;
use isolux::number::SoftRoot;
use isolux_host::reference;

/// Squared sine of 22.5°, to which a loop's reach from its first vertex is small.
const SMALL: f64 = 0.1464;

/// A regular polygon facing down whose first corner sees the farthest under this
/// squared reach, as a part of the squared distance from the receiver at (0, 0, 0).
fn polygon(count: usize, reach: f64, turn: f64) -> Vec<[f64; 3]> {
    let corner = |k: usize| {
        let angle = turn - std::f64::consts::TAU * k as f64 / count as f64;
        DVec2::from_angle(angle)
    };
    let first = corner(0);
    let farthest = (0..count).map(|k| (corner(k) - first).length());
    let diameter = farthest.fold(0.0, f64::max);
    // The first corner is at (first, height) from the receiver.
    let height = (diameter * diameter / reach - 1.0).sqrt();
    (0..count)
        .map(|k| [corner(k).x, corner(k).y, height])
        .collect()
}

#[test]
fn loops_of_narrow_edges_are_as_exact_as_their_fit() {
    let parts = [1e-4, 0.01, 0.3, 0.9, 0.9999, 1.0001, 1.1];
    let (mut worst, mut clipped) = ([0.0_f64; 3], 0);
    for count in 3..=8 {
        for part in parts {
            for turn in [0.1, 0.9, 2.0, 4.4] {
                let v = polygon(count, part * SMALL, turn);
                let places: Vec<DVec3> = v.iter().map(|&v| v.into()).collect();
                let middle = places.iter().sum::<DVec3>();
                // Facing it, leaning, and with the horizon through it.
                for n in [DVec3::Z, DVec3::new(0.5, -0.4, 0.2), middle.cross(DVec3::Y)] {
                    let receiver = Receiver::new::<SoftRoot>([0.0; 3], n.into());
                    let receiver = receiver.expect("a receiver");
                    let below = places.iter().filter(|v| v.dot(n) < 0.0).count();
                    clipped += usize::from(below > 0 && below < count);
                    let exact = reference::form_factor(DVec3::ZERO, n, &places);
                    let found = [
                        form_factor::<Poly3, f64>(&receiver, &v),
                        form_factor::<Poly5, f64>(&receiver, &v),
                        form_factor::<Poly8, f64>(&receiver, &v),
                    ];
                    for (worst, found) in worst.iter_mut().zip(found) {
                        *worst = worst.max((found - exact).abs());
                    }
                }
            }
        }
    }
    // The fits' relative errors, of angles that add up to a third of a turn.
    let stated = [1.6e-5, 1.3e-7, 2e-11];
    for (worst, stated) in worst.into_iter().zip(stated) {
        assert!(
            worst <= stated && worst > 0.01 * stated,
            "{worst:e} {stated:e}"
        );
    }
    assert!(clipped > 100, "{clipped}");
}
