//! What the node does: it learns what its luminaires bring to the desks, and then
//! dims them as daylight comes and goes.
//!
//! Nothing here knows the device: the same code runs on the host, where the tests
//! compare.

use crate::control::{self, DESKS, LUMINAIRES, Response};

/// What every desk is to have, in lx.
pub(crate) const WANTED: f32 = 500.0;

/// The power of a luminaire at its most, in W.
pub(crate) const POWER: [f32; LUMINAIRES] = [36.0; LUMINAIRES];

/// Rounds of correction after which the levels are what they are.
const ROUNDS: u32 = 3;

/// The light of the office: what the node asks the kernel.
pub(crate) trait Office {
    /// Dims the luminaires to these levels, 1 being what they were baked with, and
    /// lights the office on.
    fn dim(&mut self, levels: &[f32; LUMINAIRES]);
    /// What the desks have of it, in lx.
    fn desks(&self) -> [f32; DESKS];
}

/// Each luminaire alone.
pub(crate) fn learn(office: &mut impl Office) -> Response {
    let mut response = [[0.0; LUMINAIRES]; DESKS];
    for on in 0..LUMINAIRES {
        let mut levels = [0.0; LUMINAIRES];
        if let Some(level) = levels.get_mut(on) {
            *level = 1.0;
        }
        office.dim(&levels);
        for (row, lit) in response.iter_mut().zip(office.desks()) {
            if let Some(place) = row.get_mut(on) {
                *place = lit;
            }
        }
    }
    response
}

/// What was decided for one state of the sky.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Decided {
    /// The levels of the luminaires.
    pub(crate) levels: [f32; LUMINAIRES],
    /// What the desks then have, daylight included, in lx.
    pub(crate) desks: [f32; DESKS],
    /// The power that it takes, in W.
    pub(crate) power: f32,
}

/// Dims the luminaires so that every desk has what is [`WANTED`] with the daylight
/// that its sensor tells of, in lx, at least power.
///
/// The office is lit with the levels, and where a desk still falls short of what is
/// wanted it is asked to have that much more.
pub(crate) fn decide(
    office: &mut impl Office,
    response: &Response,
    daylight: &[f32; DESKS],
) -> Decided {
    let mut needed = daylight.map(|daylight| WANTED - daylight);
    let mut round = 0;
    loop {
        let levels = control::levels(response, &needed, &POWER);
        office.dim(&levels);
        let mut desks = office.desks();
        for (desk, daylight) in desks.iter_mut().zip(daylight) {
            *desk += daylight;
        }
        round += 1;
        if round == ROUNDS || desks.iter().all(|&desk| desk >= WANTED) {
            let power = control::lit(&POWER, &levels);
            return Decided {
                levels,
                desks,
                power,
            };
        }
        for (needed, desk) in needed.iter_mut().zip(desks) {
            let short = WANTED - desk;
            if short > 0.0 {
                *needed += short;
            }
        }
    }
}

/// Daylight on the desks over a day, in lx: what the sensors would tell. The window
/// is beside the first two desks.
pub(crate) const DAY: [(u32, [f32; DESKS]); 6] = [
    (7, [0.0, 0.0, 0.0, 0.0]),
    (9, [140.0, 90.0, 80.0, 60.0]),
    (11, [390.0, 210.0, 180.0, 120.0]),
    (13, [620.0, 340.0, 260.0, 170.0]),
    (15, [510.0, 505.0, 530.0, 540.0]),
    (18, [30.0, 20.0, 15.0, 10.0]),
];
