//! Divides a sample budget among surfaces.

use super::Unplannable;

/// What a surface asks for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Demand {
    /// Power received, W (lm).
    pub(super) power: f64,
    /// The least number of samples: its corners and one more.
    pub(super) least: usize,
}

/// Samples that every reflecting surface gets first: three span a plane.
const BASE: f64 = 3.0;

/// How many samples each surface gets, `demands` in order; `None` demands none.
///
/// The error of a surface with n samples falls about as 1/n, and counts with
/// the power the surface handles; the sum of power/n for a given total is
/// least where n grows as the square root of the power. So every surface gets
/// [`BASE`] samples and its part of the rest, fractions dropped, but never less
/// than it needs at least.
pub(super) fn samples(demands: &[Option<Demand>], budget: u64) -> Result<Vec<usize>, Unplannable> {
    let needed: u64 = demands
        .iter()
        .flatten()
        .map(|demand| demand.least as u64)
        .sum();
    if budget < needed {
        return Err(Unplannable::Samples {
            allowed: budget,
            needed,
        });
    }
    let count = demands.iter().flatten().count() as f64;
    let weight: f64 = demands
        .iter()
        .flatten()
        .map(|demand| demand.power.sqrt())
        .sum();
    let rest = budget as f64 - BASE * count;
    let mut shares: Vec<usize> = demands
        .iter()
        .map(|demand| {
            demand.map_or(0, |demand| {
                let part = if weight > 0.0 {
                    demand.power.sqrt() / weight
                } else {
                    1.0 / count
                };
                demand.least.max((BASE + rest * part) as usize)
            })
        })
        .collect();
    // Where least numbers were handed out the sum may be too large: take the
    // excess from those that have the most.
    while shares.iter().sum::<usize>() as u64 > budget {
        let spare = |index: usize| demands[index].map_or(0, |d| shares[index] - d.least);
        let richest = (0..shares.len())
            .max_by_key(|&index| spare(index))
            .unwrap_or(0);
        shares[richest] -= 1;
    }
    Ok(shares)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn demand(power: f64) -> Option<Demand> {
        Some(Demand { power, least: 5 })
    }

    #[test]
    fn brighter_surfaces_get_more() {
        assert_eq!(
            samples(&[demand(38.0), None, demand(1.0)], 59),
            Ok(vec![48, 0, 10])
        );
    }

    #[test]
    fn equal_surfaces_get_equal_shares() {
        assert_eq!(samples(&[demand(2.0), demand(2.0)], 40), Ok(vec![20, 20]));
        assert_eq!(samples(&[demand(0.0), demand(0.0)], 40), Ok(vec![20, 20]));
    }

    #[test]
    fn no_surface_falls_below_its_least_and_no_budget_is_exceeded() {
        let shares = samples(&[demand(1e6), demand(1.0), demand(1.0)], 20).unwrap();
        assert!(shares.iter().all(|&share| share >= 5));
        assert!(shares.iter().sum::<usize>() <= 20);
    }

    #[test]
    fn too_small_a_budget_is_refused() {
        assert_eq!(
            samples(&[demand(1.0), demand(1.0)], 9),
            Err(Unplannable::Samples {
                allowed: 9,
                needed: 10
            })
        );
    }
}
