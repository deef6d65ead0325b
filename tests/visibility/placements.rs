//! Degenerate placements: occluders that touch, coincide, straddle, cover;
//! receivers on them and in them.

use crate::lit::{Lit, Roomy, receiver, scene, surface, unoccluded};
use crate::random::faces_of_box;
use glam::DVec3;
use isolux::visibility::Bracket;
use isolux_host::scene::Surface;

fn rectangle([x0, x1]: [f64; 2], [y0, y1]: [f64; 2], z: f64) -> Surface {
    let corners = [[x0, y0], [x1, y0], [x1, y1], [x0, y1]];
    surface(corners.map(|[x, y]| DVec3::new(x, y, z)).to_vec(), 0.0)
}

/// A 2 m x 2 m luminaire 2 m up that looks down.
fn light() -> Surface {
    let corners = [[-1.0, 1.0], [1.0, 1.0], [1.0, -1.0], [-1.0, -1.0]];
    surface(corners.map(|[x, y]| DVec3::new(x, y, 2.0)).to_vec(), 1.0)
}

fn wall(x: f64, [y0, y1]: [f64; 2], [z0, z1]: [f64; 2]) -> Surface {
    let corners = [[y0, z0], [y1, z0], [y1, z1], [y0, z1]];
    surface(corners.map(|[y, z]| DVec3::new(x, y, z)).to_vec(), 0.0)
}

fn seen(occluders: Vec<Surface>, place: [f64; 3], normal: DVec3) -> (f32, f32) {
    let lit = Lit::new(&scene([vec![light()], occluders].concat()));
    let at = receiver::<f32>(place.into(), normal);
    let emitter = &lit.emitters[0].1;
    let f: Bracket<f32> = lit.form_factor(&mut Roomy::new(), &at, emitter);
    assert!(f.is_exact() && f.low >= 0.0, "{f:?}");
    (f.low, unoccluded(&at, emitter))
}

const WIDE: [f64; 2] = [-9.0, 9.0];
const ORIGIN: [f64; 3] = [0.0; 3];

#[track_caller]
fn assert_part(occluders: Vec<Surface>, place: [f64; 3], part: f32) {
    let (f, whole) = seen(occluders, place, DVec3::Z);
    assert!(
        (f - part * whole).abs() <= 1e-6 * whole,
        "{f} of {whole}, not {part}"
    );
}

#[test]
fn occluders_larger_than_the_emitter_hide_all_of_it() {
    for z in [1e-3, 0.1, 1.0, 1.999, 1.999_99] {
        assert_part(vec![rectangle(WIDE, WIDE, z)], ORIGIN, 0.0);
        assert_part(vec![rectangle([-9.0, 0.0], WIDE, z)], ORIGIN, 0.5);
    }
}

#[test]
fn occluders_on_the_emitter_or_behind_it_hide_nothing() {
    assert_part(vec![rectangle(WIDE, WIDE, 2.0)], ORIGIN, 1.0);
    assert_part(vec![rectangle(WIDE, WIDE, 2.5)], ORIGIN, 1.0);
    assert_part(vec![rectangle([1.0, 9.0], WIDE, 2.0)], ORIGIN, 1.0);
}

#[test]
fn a_wall_that_touches_or_pierces_the_emitter_hides_one_side() {
    // Seen from x < 0 the wall at x = 0 hides the half beyond it, if tall.
    for top in [2.0, 2.5] {
        let (f, _) = seen(
            vec![wall(0.0, WIDE, [-1.0, top])],
            [-0.5, 0.0, 0.0],
            DVec3::Z,
        );
        let half = {
            let corners = [[-1.0, 1.0], [0.0, 1.0], [0.0, -1.0], [-1.0, -1.0]];
            let half = surface(corners.map(|[x, y]| DVec3::new(x, y, 2.0)).to_vec(), 1.0);
            let lit = Lit::new(&scene(vec![half]));
            unoccluded::<f32>(
                &receiver([-0.5, 0.0, 0.0].into(), DVec3::Z),
                &lit.emitters[0].1,
            )
        };
        assert!((f - half).abs() < 2e-7, "{f} {half}");
    }
}

#[test]
fn a_receiver_on_an_occluder_or_its_plane_sees_past_it() {
    let sheet = || vec![rectangle([-0.5, 0.5], [-0.5, 0.5], 0.0)];
    for place in [
        ORIGIN,
        [0.5, 0.0, 0.0],
        [0.5, 0.5, 0.0],
        [3.0, 0.0, 0.0],
        [0.1, 0.1, 1e-6],
    ] {
        assert_part(sheet(), place, 1.0);
    }
    // Below it, all is hidden.
    assert_part(sheet(), [0.0, 0.0, -1e-2], 0.0);
}

#[test]
fn a_receiver_in_the_plane_of_a_wall_sees_past_its_edge() {
    for z in [0.0, 0.5, 1.0] {
        assert_part(
            vec![wall(0.0, [-0.5, 0.5], [0.0, 1.0])],
            [0.0, -0.7, z],
            1.0,
        );
        assert_part(vec![wall(0.0, [-0.5, 0.5], [0.0, 1.0])], [0.0, 0.5, z], 1.0);
    }
}

/// A box of 1 m about a place, outwards.
fn block(place: DVec3) -> Vec<Surface> {
    let faces = faces_of_box([0.5; 3]).into_iter();
    faces
        .map(|face| surface(face.iter().map(|&v| v + place).collect(), 0.0))
        .collect()
}

#[test]
fn receivers_on_a_body_see_past_it_and_inside_nothing() {
    let body = || block(DVec3::new(0.0, 0.0, 0.0));
    assert_part(body(), [0.1, 0.2, 0.5], 1.0); // on its top
    assert_part(body(), [0.5, 0.5, 0.5], 1.0); // on a corner
    assert_part(body(), [0.0, 0.0, 0.0], 0.0); // inside
    assert_part(body(), [0.0, 0.0, -0.5], 0.0); // under it
    assert_part(body(), [0.2, 0.1, -0.6], 0.0);
    // On its side, looking outwards and up: half of the sky.
    let (f, whole) = seen(body(), [0.5, 0.0, 0.0], DVec3::X);
    assert_eq!(f, whole);
    let (f, whole) = seen(body(), [0.5, 0.0, 0.0], DVec3::Z);
    assert!(f > 0.0 && f < 0.6 * whole, "{f} {whole}");
}

#[test]
fn a_body_without_its_base_is_closed_where_it_stands() {
    let mut open = block(DVec3::new(0.0, 0.0, 0.5));
    open.remove(0); // its base
    let floor = rectangle(WIDE, WIDE, 0.0);
    let lit = |surfaces: &[Surface]| Lit::new(&scene([&[light()], surfaces].concat()));
    let standing = lit(&[open.clone(), vec![floor]].concat());
    assert_eq!(standing.emitters[0].1.blockers().len(), 2, "one body");
    assert_eq!(lit(&open).emitters[0].1.blockers().len(), 5, "an open box");
}

#[test]
fn a_closed_case_with_a_luminaire_in_it_is_not_dark() {
    let mut case = Vec::new();
    for face in faces_of_box([3.0; 3]) {
        case.push(surface(face.iter().map(|&v| v + DVec3::Z).collect(), 0.0));
    }
    assert_part(case, ORIGIN, 1.0);
}

#[test]
fn a_body_that_reaches_behind_the_emitter_enters_as_its_faces() {
    let (f, whole) = seen(block(DVec3::new(0.5, 0.0, 1.9)), [-0.8, 0.0, 0.0], DVec3::Z);
    let (only_below, _) = seen(
        [
            vec![rectangle([0.0, 1.0], [-0.5, 0.5], 1.4)],
            vec![wall(0.0, [-0.5, 0.5], [1.4, 2.0])],
        ]
        .concat(),
        [-0.8, 0.0, 0.0],
        DVec3::Z,
    );
    assert!((f - only_below).abs() < 1e-6 * whole, "{f} {only_below}");
}

#[test]
fn coplanar_and_equal_occluders_hide_once() {
    let half = || rectangle([-9.0, 0.0], WIDE, 1.0);
    assert_part(vec![half(), half(), half()], ORIGIN, 0.5);
    let overlapping = vec![half(), rectangle([-9.0, 0.0], [-3.0, 3.0], 1.0)];
    assert_part(overlapping, ORIGIN, 0.5);
    let beside = vec![half(), rectangle([0.0, 9.0], [0.0, 9.0], 1.0)];
    assert_part(beside, ORIGIN, 0.25);
    let apart_by_ulps = vec![half(), rectangle([-9.0, 0.0], WIDE, 1.0 + 1e-7)];
    assert_part(apart_by_ulps, ORIGIN, 0.5);
}

#[test]
fn slivers_hide_slivers() {
    for width in [1e-2, 1e-4, 1e-6] {
        let sliver = rectangle([-width, width], WIDE, 1.0);
        let (f, whole) = seen(vec![sliver], ORIGIN, DVec3::Z);
        // At twice the height it hides twice its width.
        let strip = rectangle([-2.0 * width, 2.0 * width], [-1.0, 1.0], 2.0);
        let corners: Vec<DVec3> = strip.vertices.iter().rev().copied().collect();
        let lit = Lit::new(&scene(vec![surface(corners, 1.0)]));
        let hidden: f32 = unoccluded(&receiver(DVec3::ZERO, DVec3::Z), &lit.emitters[0].1);
        assert!(
            (whole - f - hidden).abs() < 1e-6 * whole,
            "{f} {whole} {hidden}"
        );
    }
}

#[test]
fn an_emitter_wholly_behind_the_receiver_gives_nothing() {
    let (f, _) = seen(
        vec![rectangle([-0.1, 0.1], [-0.1, 0.1], 1.0)],
        ORIGIN,
        DVec3::NEG_Z,
    );
    assert_eq!(f, 0.0);
    let (f, _) = seen(vec![], [0.0, 0.0, 2.5], DVec3::NEG_Z);
    assert_eq!(f, 0.0);
}
