//! The clip: what comes out lies inside, is no larger, needs no more room than
//! its type says, and is what the walk without a buffer hands over.

use crate::shapes::{View, convex_view, view};
use glam::DVec3;
use isolux::Error;
use isolux::clip::{Corners, Edges, Place, convex_capacity, polygon, simple_capacity, walk};
use isolux::error::What;
use isolux::geometry::Vector;
use proptest::prelude::*;

/// Corners of 32-gons after one clip.
const ROOM: usize = simple_capacity(32);

fn places(view: &View) -> Vec<Place<f64>> {
    let n = Vector::from(view.n);
    let corner = |&v: &[f64; 3]| {
        let position = Vector::from(v) - Vector::from(view.p);
        Place {
            position,
            height: n.dot(position),
        }
    };
    view.v.iter().map(corner).collect()
}

fn clipped(places: &[Place<f64>]) -> Vec<Place<f64>> {
    let mut corners = Corners::<f64, ROOM>::new();
    polygon(places.iter().copied(), &mut corners).expect("room for any 32-gon");
    corners.iter().copied().collect()
}

/// Twice the area as a vector.
fn area(places: &[Place<f64>]) -> DVec3 {
    let at = |i: usize| DVec3::from(<[f64; 3]>::from(places[i % places.len()].position));
    (0..places.len()).map(|i| at(i).cross(at(i + 1))).sum()
}

/// The other half: the same corners with their heights turned round.
fn beyond(places: &[Place<f64>]) -> Vec<Place<f64>> {
    let turned = |place: &Place<f64>| Place {
        height: -place.height,
        ..*place
    };
    places.iter().map(turned).collect()
}

/// Keeps every edge that a walk hands over, with its kind.
struct Keep;

type Kept = Vec<(char, Place<f64>, Place<f64>)>;

impl Edges<f64, Place<f64>> for Keep {
    type Sum = Kept;

    fn whole(&self, mut kept: Kept, from: Place<f64>, to: Place<f64>) -> Kept {
        kept.push(('w', from, to));
        kept
    }

    fn cut(&self, mut kept: Kept, [from, to]: [Place<f64>; 2], _: [Place<f64>; 2]) -> Kept {
        kept.push(('c', from, to));
        kept
    }

    fn cap(&self, mut kept: Kept, from: Place<f64>, to: Place<f64>) -> Kept {
        kept.push(('b', from, to));
        kept
    }
}

fn sound(view: &View, most: usize) -> Result<(), TestCaseError> {
    let before = places(view);
    let after = clipped(&before);
    prop_assert!(
        after.len() <= most,
        "{} corners of at most {most}",
        after.len()
    );
    let far = before.iter().map(|p| p.position.norm_squared().sqrt());
    let reach = far.fold(0.0, f64::max) * Vector::from(view.n).norm_squared().sqrt();
    for corner in &after {
        prop_assert!(corner.height >= 0.0);
        // The stored height is that of the place, to a few roundings.
        let height = Vector::from(view.n).dot(corner.position);
        prop_assert!(
            (height - corner.height).abs() <= 8.0 * f64::EPSILON * reach,
            "{height:e}"
        );
    }
    // Both halves together are the whole, and neither is larger.
    let (whole, inner) = (area(&before), area(&after));
    let outer = area(&clipped(&beyond(&before)));
    let rounding = 1e-12 * before.len() as f64 * (whole.length() + reach * reach);
    prop_assert!(inner.length() <= whole.length() + rounding);
    prop_assert!(
        (inner + outer - whole).length() <= rounding,
        "{inner} {outer} {whole}"
    );
    prop_assert_eq!(clipped(&after), after);
    Ok(())
}

fn walked(view: &View) -> Result<(), TestCaseError> {
    let before = places(view);
    let kept = walk(before.iter().copied(), &Keep, Kept::new());
    let starts: Vec<Place<f64>> = kept.iter().map(|edge| edge.1).collect();
    prop_assert_eq!(starts, clipped(&before));
    for (index, (kind, from, to)) in kept.iter().enumerate() {
        // Edges join: each ends where the next begins.
        let next = &kept[(index + 1) % kept.len()];
        prop_assert_eq!(*to, next.1);
        let on = |place: &Place<f64>| place.height == 0.0;
        match kind {
            'b' => prop_assert!(on(from) && on(to)),
            'c' => prop_assert!(on(from) || on(to)),
            _ => prop_assert!(before.contains(from) && before.contains(to)),
        }
    }
    Ok(())
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(3000))]

    #[test]
    fn simple_polygons(view in view()) {
        sound(&view, simple_capacity(view.v.len()))?;
    }

    #[test]
    fn convex_polygons(view in convex_view()) {
        sound(&view, convex_capacity(view.v.len()))?;
    }

    #[test]
    fn the_walk_hands_over_the_polygon(view in view()) {
        walked(&view)?;
    }

    /// Any heights at all, belonging to no plane: the capacity holds for them
    /// as well.
    #[test]
    fn any_heights_fit(heights in prop::collection::vec(-3..=3_i32, 0..=32)) {
        let corners = heights.iter().zip(0_u8..).map(|(&height, x)| Place {
            position: Vector { x: f64::from(x), y: f64::from(height), z: 1.0 },
            height: f64::from(height),
        });
        let mut kept = Corners::<f64, ROOM>::new();
        prop_assert_eq!(polygon(corners, &mut kept), Ok(()));
        prop_assert!(kept.len() <= simple_capacity(heights.len()));
    }
}

/// Teeth: every edge crosses the boundary.
fn zigzag(count: usize) -> impl Iterator<Item = Place<f64>> {
    (0..count).map(|i| {
        let y = if i % 2 == 0 { -1.0 } else { 1.0 };
        Place {
            position: Vector {
                x: i as f64,
                y,
                z: 0.0,
            },
            height: y,
        }
    })
}

#[test]
fn zigzags_need_all_of_the_stated_capacity() {
    for count in (4..=32).step_by(2) {
        let mut kept = Corners::<f64, ROOM>::new();
        assert_eq!(polygon(zigzag(count), &mut kept), Ok(()));
        assert_eq!(kept.len(), simple_capacity(count), "{count} corners");
    }
    // One less than needed is refused, with both numbers.
    let mut short = Corners::<f64, { simple_capacity(32) - 1 }>::new();
    let refused = Error::Capacity {
        what: What::Corners,
        needed: simple_capacity(32) as u32,
        have: simple_capacity(32) as u32 - 1,
    };
    assert_eq!(polygon(zigzag(32), &mut short), Err(refused));
}

#[test]
fn a_cut_corner_needs_all_of_the_convex_capacity() {
    for count in 3..=32_usize {
        let corners = (0..count).map(|i| {
            let angle = std::f64::consts::TAU * i as f64 / count as f64;
            let (y, x) = angle.sin_cos();
            // Only the corner at angle 0 is outside.
            let height = (angle / 2.0).sin() - 1e-3;
            Place {
                position: Vector { x, y, z: 0.0 },
                height: if i == 0 { -1e-3 } else { height.abs() },
            }
        });
        let mut kept = Corners::<f64, ROOM>::new();
        assert_eq!(polygon(corners, &mut kept), Ok(()));
        assert_eq!(kept.len(), convex_capacity(count));
    }
}
