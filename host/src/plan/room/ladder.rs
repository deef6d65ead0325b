//! Ladders of plans, and how a budget climbs them.

use super::super::{MOST_SAMPLES, Unplannable};

/// One plan of a term.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Step {
    /// Samples it takes.
    pub(super) samples: usize,
    /// The integral in m² of the squared predicted error over its surface.
    pub(super) loss: f64,
    /// The area in m² that it is predicted over.
    pub(super) area: f64,
}

impl Step {
    /// The root of the mean square.
    pub(super) fn error(&self) -> f64 {
        if self.area > 0.0 {
            (self.loss / self.area).sqrt()
        } else {
            0.0
        }
    }
}

/// Which step each ladder is taken to; 0 for an empty one.
///
/// From the first steps on always the ladder goes on where a sample more lessens the
/// loss most, looking ahead over steps that bring little; until the samples are used
/// up, or where there is no budget until every term errs by no more than `well`.
///
/// # Errors
/// [`Unplannable`] where the budget does not suffice for the first steps, or
/// is larger than the tables.
pub(super) fn divide(
    ladders: &[&[Step]],
    budget: Option<u64>,
    well: f64,
) -> Result<Vec<usize>, Unplannable> {
    let allowed = budget.unwrap_or(MOST_SAMPLES);
    if allowed > MOST_SAMPLES {
        return Err(Unplannable::TooMany {
            asked: allowed,
            most: MOST_SAMPLES,
        });
    }
    let first = ladders.iter().filter_map(|ladder| ladder.first());
    let mut used: u64 = first.map(|step| step.samples as u64).sum();
    if used > allowed {
        return Err(Unplannable::Samples {
            allowed,
            needed: used,
        });
    }
    let mut chosen = vec![0; ladders.len()];
    loop {
        let mut best: Option<(f64, usize, usize)> = None;
        for (k, ladder) in ladders.iter().enumerate() {
            let Some(now) = ladder.get(chosen[k]) else {
                continue;
            };
            if budget.is_none() && now.error() <= well {
                continue;
            }
            for (step, next) in ladder.iter().enumerate().skip(chosen[k] + 1) {
                let more = next.samples.saturating_sub(now.samples).max(1);
                let gain = (now.loss - next.loss) / more as f64;
                let affordable = used + more as u64 <= allowed;
                if affordable && gain > 0.0 && best.is_none_or(|(most, ..)| gain > most) {
                    best = Some((gain, k, step));
                }
            }
        }
        let Some((_, k, step)) = best else {
            return Ok(chosen);
        };
        used += (ladders[k][step].samples - ladders[k][chosen[k]].samples) as u64;
        chosen[k] = step;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn ladder(losses: &[(usize, f64)]) -> Vec<Step> {
        let step = |&(samples, loss): &(usize, f64)| Step {
            samples,
            loss,
            area: 1.0,
        };
        losses.iter().map(step).collect()
    }

    #[test]
    fn samples_go_where_they_lessen_the_loss_most() {
        let flat = ladder(&[(1, 0.1), (2, 0.099), (3, 0.001)]);
        let steep = ladder(&[(1, 1.0), (2, 0.5), (4, 0.45)]);
        let chosen = divide(&[&flat, &steep, &[]], Some(5), 0.0);
        assert_eq!(chosen, Ok(vec![2, 1, 0]), "looks over the flat step");
    }

    #[test]
    fn without_a_budget_it_ends_where_all_is_well() {
        let steps = ladder(&[(1, 1.0), (2, 1e-4), (3, 1e-8)]);
        assert_eq!(divide(&[&steps], None, 0.02), Ok(vec![1]));
    }

    #[test]
    fn a_budget_below_the_first_steps_is_refused() {
        let steps = ladder(&[(4, 1.0)]);
        let refused = divide(&[&steps, &steps], Some(7), 0.0);
        let needed = Unplannable::Samples {
            allowed: 7,
            needed: 8,
        };
        assert_eq!(refused, Err(needed));
    }
}
