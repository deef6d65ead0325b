//! The least power that lights every desk.
//!
//! Light is linear: luminaire l at a level x_l, 0 ≤ x_l ≤ 1, brings R_dl x_l to desk
//! d. With what daylight leaves to be done, n_d,
//!
//! ```text
//! minimise  Σ_l p_l x_l   where   Σ_l R_dl x_l ≥ n_d,   0 ≤ x_l ≤ 1:
//! ```
//!
//! a linear programme, whose least is at a corner of what is allowed (Dantzig 1951).
//! A corner is where four of the twelve conditions hold with equality: there are 495
//! of them at the most, and all are tried. No power of a luminaire is so small that
//! it would not count, and no order of trying decides but the least power.

/// Luminaires.
pub(crate) const LUMINAIRES: usize = 4;

/// Desks.
pub(crate) const DESKS: usize = 4;

/// What a level that is nothing, or all, may be off by.
const ROUNDING: f32 = 1e-5;

/// What each luminaire, alone and at full power, brings to each desk, in lx.
pub(crate) type Response = [[f32; LUMINAIRES]; DESKS];

/// Conditions: a desk is lit enough, a luminaire is off, a luminaire is at its most.
const CONDITIONS: usize = DESKS + 2 * LUMINAIRES;

/// By what part of what it needs a desk may fall short: the rounding of a corner.
const SHORT: f32 = 1e-4;

/// The levels of least power that bring every desk what it needs, in lx; everything
/// at its most where no levels do. `power` is that of each luminaire at its most.
///
/// Takes 495 systems of four equations, about 200 000 instructions on a Cortex-M4F.
pub(crate) fn levels(
    response: &Response,
    needed: &[f32; DESKS],
    power: &[f32; LUMINAIRES],
) -> [f32; LUMINAIRES] {
    let mut best = [1.0; LUMINAIRES];
    let mut least = f32::INFINITY;
    for chosen in 0_u32..1 << CONDITIONS {
        if chosen.count_ones() as usize != LUMINAIRES {
            continue;
        }
        let Some(levels) = corner(response, needed, chosen) else {
            continue;
        };
        let sum: f32 = levels.iter().zip(power).map(|(x, p)| x * p).sum();
        if sum < least && is_enough(response, needed, &levels) {
            (best, least) = (levels, sum);
        }
    }
    best
}

/// Whether every desk has what it needs.
pub(crate) fn is_enough(
    response: &Response,
    needed: &[f32; DESKS],
    levels: &[f32; LUMINAIRES],
) -> bool {
    let mut desks = response.iter().zip(needed);
    desks.all(|(row, &needed)| lit(row, levels) >= needed - SHORT * needed.abs())
}

/// What a desk has of these levels.
pub(crate) fn lit(row: &[f32; LUMINAIRES], levels: &[f32; LUMINAIRES]) -> f32 {
    row.iter().zip(levels).map(|(r, x)| r * x).sum()
}

/// One of four equations, with its right side.
type Equation = [f32; LUMINAIRES + 1];

/// The levels at which the chosen conditions hold with equality; `None` where no
/// single ones do, or some luminaire would be below nothing or above its most.
fn corner(response: &Response, needed: &[f32; DESKS], chosen: u32) -> Option<[f32; LUMINAIRES]> {
    let mut system = [[0.0; LUMINAIRES + 1]; LUMINAIRES];
    let mut rows = system.iter_mut();
    for condition in (0..CONDITIONS).filter(|condition| chosen >> condition & 1 == 1) {
        *rows.next()? = equation(response, needed, condition)?;
    }
    let levels = solved(system)?;
    let within = |&level: &f32| (-ROUNDING..=1.0 + ROUNDING).contains(&level);
    let held = |level: f32| match level {
        level if level < ROUNDING => 0.0,
        level if level > 1.0 - ROUNDING => 1.0,
        level => level,
    };
    levels.iter().all(within).then(|| levels.map(held))
}

/// One condition as an equation.
fn equation(response: &Response, needed: &[f32; DESKS], condition: usize) -> Option<Equation> {
    let mut equation = [0.0; LUMINAIRES + 1];
    if let (Some(row), Some(&needed)) = (response.get(condition), needed.get(condition)) {
        for (place, &x) in equation.iter_mut().zip(row) {
            *place = x;
        }
        *equation.last_mut()? = needed;
        return Some(equation);
    }
    let bound = condition.checked_sub(DESKS)?;
    *equation.get_mut(bound % LUMINAIRES)? = 1.0;
    *equation.last_mut()? = if bound < LUMINAIRES { 0.0 } else { 1.0 };
    Some(equation)
}

/// Gauss's elimination with the largest pivot of each column; `None` for a system
/// that is singular to single precision.
fn solved(mut system: [Equation; LUMINAIRES]) -> Option<[f32; LUMINAIRES]> {
    for column in 0..LUMINAIRES {
        let size = |row: &Equation| row.get(column).map_or(0.0, |x| x.abs());
        let rows = system.get(column..)?.iter().enumerate();
        let (offset, largest) = rows.fold((0, 0.0), |(at, most), (row, equation)| {
            let here = size(equation);
            if here > most { (row, here) } else { (at, most) }
        });
        if largest < 1e-6 {
            return None;
        }
        system.swap(column, column + offset);
        let pivot = *system.get(column)?;
        let by = *pivot.get(column)?;
        for (row, equation) in system.iter_mut().enumerate() {
            if row == column {
                continue;
            }
            let factor = *equation.get(column)? / by;
            for (x, p) in equation.iter_mut().zip(&pivot) {
                *x -= factor * p;
            }
        }
    }
    let mut levels = [0.0; LUMINAIRES];
    for (index, (level, row)) in levels.iter_mut().zip(&system).enumerate() {
        *level = row.last()? / row.get(index)?;
    }
    Some(levels)
}
