//! Regions of the page bounded by loops: what is inside, and where there is room.

use super::canvas::Frame;

/// Whether `at` lies inside an odd number of `loops`.
pub(super) fn inside(loops: &[Vec<[f32; 2]>], at: [f32; 2]) -> bool {
    edges(loops)
        .filter(|(a, b)| {
            (a[1] > at[1]) != (b[1] > at[1])
                && at[0] < a[0] + (at[1] - a[1]) / (b[1] - a[1]) * (b[0] - a[0])
        })
        .count()
        % 2
        == 1
}

/// The area inside: the loops' areas with their signs, so that reversed inner
/// loops count against the outer one.
pub(super) fn area(loops: &[Vec<[f32; 2]>]) -> f32 {
    let doubled: f32 = edges(loops).map(|(a, b)| a[0] * b[1] - a[1] * b[0]).sum();
    doubled.abs() / 2.0
}

/// The place of a grid over `map` that is inside `own` loops and outside of all
/// `above`, and has the largest circle free of their edges and of `obstacles`.
pub(super) fn roomiest(
    map: Frame,
    own: &[Vec<[f32; 2]>],
    above: &[Vec<Vec<[f32; 2]>>],
    obstacles: &[[f32; 2]],
) -> Option<[f32; 2]> {
    const STEPS: usize = 60;
    let mut best: Option<(f32, [f32; 2])> = None;
    for cell in 0..STEPS * STEPS {
        let at = [
            map.x + ((cell % STEPS) as f32 + 0.5) / STEPS as f32 * map.width,
            map.y + ((cell / STEPS) as f32 + 0.5) / STEPS as f32 * map.height,
        ];
        if !inside(own, at) || above.iter().any(|loops| inside(loops, at)) {
            continue;
        }
        let to_edges = edges(own)
            .chain(above.iter().flat_map(|loops| edges(loops)))
            .map(|(a, b)| distance_to_segment(at, a, b));
        let to_obstacles = obstacles
            .iter()
            .map(|obstacle| (at[0] - obstacle[0]).hypot(at[1] - obstacle[1]));
        let room = to_edges.chain(to_obstacles).fold(f32::INFINITY, f32::min);
        if best.is_none_or(|(most, _)| room > most) {
            best = Some((room, at));
        }
    }
    best.map(|(_, at)| at)
}

fn edges(loops: &[Vec<[f32; 2]>]) -> impl Iterator<Item = ([f32; 2], [f32; 2])> {
    loops.iter().flat_map(|points| {
        points
            .iter()
            .copied()
            .zip(points.iter().copied().cycle().skip(1))
    })
}

fn distance_to_segment(at: [f32; 2], a: [f32; 2], b: [f32; 2]) -> f32 {
    let along = [b[0] - a[0], b[1] - a[1]];
    let squared = along[0] * along[0] + along[1] * along[1];
    let share = if squared > 0.0 {
        (((at[0] - a[0]) * along[0] + (at[1] - a[1]) * along[1]) / squared).clamp(0.0, 1.0)
    } else {
        0.0
    };
    (at[0] - a[0] - share * along[0]).hypot(at[1] - a[1] - share * along[1])
}

#[cfg(test)]
mod tests {
    use super::*;

    fn square(r: f32) -> Vec<[f32; 2]> {
        vec![
            [50.0 - r, 50.0 - r],
            [50.0 + r, 50.0 - r],
            [50.0 + r, 50.0 + r],
            [50.0 - r, 50.0 + r],
        ]
    }

    fn reach(at: [f32; 2]) -> f32 {
        (at[0] - 50.0).abs().max((at[1] - 50.0).abs())
    }

    #[test]
    fn a_place_is_found_in_the_band_and_not_in_its_hole() {
        let map = Frame::new(0.0, 0.0, 100.0, 100.0);
        let holed = roomiest(map, &[square(45.0), square(25.0)], &[], &[]).unwrap();
        assert!(reach(holed) > 25.0 && reach(holed) < 45.0, "{holed:?}");
        let covered = roomiest(map, &[square(45.0)], &[vec![square(25.0)]], &[]).unwrap();
        assert!(reach(covered) > 25.0, "{covered:?}");
        assert!(roomiest(map, &[], &[], &[]).is_none());
    }

    #[test]
    fn a_reversed_inner_loop_is_a_hole() {
        let mut hole = square(10.0);
        hole.reverse();
        assert!((area(&[square(20.0), hole]) - (1600.0 - 400.0)).abs() < 0.1);
        assert_eq!(area(&[vec![[1.0, 1.0]], vec![]]), 0.0);
    }
}
