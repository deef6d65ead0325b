//! Which rungs are worth their cost.

/// Which of some (cost, error) are on the Pareto front: nothing else is both
/// as cheap and as good, and better in one of the two. A NaN is on no front.
#[must_use]
pub fn pareto(points: &[(f64, f64)]) -> Vec<bool> {
    let beats =
        |a: &(f64, f64), b: &(f64, f64)| a.0 <= b.0 && a.1 <= b.1 && (a.0 < b.0 || a.1 < b.1);
    points
        .iter()
        .map(|point| {
            !point.0.is_nan()
                && !point.1.is_nan()
                && !points.iter().any(|other| beats(other, point))
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn the_front_is_what_nothing_beats() {
        let points = [(1.0, 9.0), (2.0, 3.0), (2.0, 4.0), (3.0, 3.0), (9.0, 1.0)];
        assert_eq!(pareto(&points), [true, true, false, false, true]);
        assert_eq!(pareto(&[(1.0, 1.0), (1.0, 1.0)]), [true, true]);
        assert_eq!(pareto(&[(f64::NAN, 0.0)]), [false]);
        assert!(pareto(&[]).is_empty());
    }

    proptest! {
        #[test]
        fn along_the_front_more_cost_buys_less_error(
            points in prop::collection::vec((0.0..10.0, 0.0..10.0), 1..20)
        ) {
            let mut front: Vec<(f64, f64)> = points
                .iter()
                .zip(pareto(&points))
                .filter_map(|(point, on)| on.then_some(*point))
                .collect();
            prop_assert!(!front.is_empty());
            front.sort_by(|a, b| a.0.total_cmp(&b.0));
            for pair in front.windows(2) {
                prop_assert!(pair[1].1 <= pair[0].1);
            }
        }
    }
}
