//! The plan that meets the wishes, by trying numbers of samples.

use crate::cli::choice::RungArguments;
use crate::cli::failure::Failure;
use crate::cli::pipeline::{self, Planned};
use crate::cli::sheet;
use crate::device::model::Model;
use crate::device::operations::Operations;
use crate::report::percent;
use crate::scene::{Budget, Scene};

/// What is wished for; `None` is no limit.
#[derive(Clone, Copy, Debug)]
pub(super) struct Wishes {
    /// Samples at the most.
    pub(super) samples: Option<u64>,
    /// Bytes of RAM at the most.
    pub(super) ram: Option<u64>,
    /// Bytes of tables at the most.
    pub(super) flash: Option<u64>,
    /// Instructions of direct light and all shots at the most, as they are predicted.
    pub(super) instructions: Option<u64>,
    /// Predicted error at the most, relative.
    pub(super) error: Option<f64>,
}

/// A plan and what it takes.
pub(super) struct Found {
    pub(super) planned: Planned,
    /// Bytes of RAM of the kernel's state.
    ram: usize,
    /// Predicted error, relative.
    error: Option<f64>,
    /// What it does on the device, where instructions are wished for and their costs known.
    pub(super) operations: Option<Operations>,
}

/// A search ends where the number of samples is known to one part in so many.
const FINE: u64 = 32;

/// Where more samples are tried than a scene without a budget takes: as often as this
/// doubled.
const DOUBLINGS: u32 = 3;

/// Where a plan errs too much, those with down to half as many samples are tried in
/// steps of this part.
const SIXTEENTHS: u64 = 16;

impl Found {
    fn of(planned: Planned, wishes: &Wishes) -> Result<Self, Failure> {
        let (ram, _) = planned.ram()?;
        let areas = planned.scene.surfaces.iter().map(|surface| surface.area);
        let operations = match wishes.instructions {
            Some(_) => Some(sheet::operations(&planned, pipeline::stop(None))?),
            None => None,
        };
        let known = |operations: &Operations| Model::committed().knows(operations);
        Ok(Self {
            ram,
            error: planned.plan.predicted_error(areas),
            operations: operations.filter(known),
            planned,
        })
    }

    fn samples(&self) -> u64 {
        self.planned.plan.samples() as u64
    }

    fn ram(&self) -> u64 {
        self.ram as u64
    }

    fn flash(&self) -> u64 {
        self.planned.tables.bytes().len() as u64
    }

    /// Instructions of direct light and all shots, with what the model errs by.
    fn instructions(&self) -> Option<u64> {
        let steps = Model::committed().steps(self.operations.as_ref()?);
        Some(steps.direct.at_most + steps.shoot.at_most)
    }

    fn fits(&self, wishes: &Wishes) -> bool {
        let instructions = self.instructions();
        wishes.ram.is_none_or(|most| self.ram() <= most)
            && wishes.flash.is_none_or(|most| self.flash() <= most)
            && wishes
                .instructions
                .is_none_or(|most| instructions.is_some_and(|count| count <= most))
    }

    fn errs_within(&self, most: f64) -> bool {
        self.error.is_some_and(|error| error <= most)
    }

    /// What it takes, in words.
    fn cost(&self) -> String {
        let (samples, ram, flash) = (self.samples(), self.ram(), self.flash());
        match self.instructions() {
            Some(count) => format!(
                "{samples} samples, {ram} bytes of RAM, {flash} bytes of tables and {count} instructions"
            ),
            None => format!("{samples} samples, {ram} bytes of RAM and {flash} bytes of tables"),
        }
    }
}

/// Plans a scene within the wishes: with as many samples as they allow, or with a
/// wished error with as few as that takes. The same scene and wishes give the same
/// plan.
///
/// # Errors
/// [`Failure::Limit`] that says which wish cannot be met, and what the nearest is.
pub(super) fn plan(
    scene: &Scene,
    rungs: &RungArguments,
    repaint: bool,
    wishes: &Wishes,
) -> Result<Found, Failure> {
    let attempt = |samples: Option<u64>| -> Result<Found, Failure> {
        let scene = Scene {
            budget: Budget {
                samples,
                ram: None,
                flash: wishes.flash,
            },
            ..scene.clone()
        };
        let mut planned = pipeline::attempt(scene, rungs, &[])?;
        planned.repaint(repaint)?;
        Found::of(planned, wishes)
    };
    let mut first = attempt(wishes.samples)?;
    if wishes.instructions.is_some() && first.operations.is_none() {
        return Err(without_costs(&first));
    }
    if let Some(most) = wishes.error {
        if first.error.is_none() {
            return Err(Failure::limit(
                format!(
                    "placement `{}` predicts no error",
                    first.planned.placement.name()
                ),
                "leave out --max-error, or take --placement error",
            ));
        }
        if wishes.samples.is_none() {
            first = more(first, most, &attempt)?;
        }
    }
    let wanted = (
        first.cost(),
        wishes.error.is_some_and(|most| first.errs_within(most)),
    );
    let largest = match first.fits(wishes) {
        true => first,
        false => largest_that_fits(first, wishes, &attempt)?,
    };
    let Some(most) = wishes.error else {
        return Ok(largest);
    };
    let nearest = nearest(largest, most, wishes, &attempt)?;
    match nearest.errs_within(most) {
        true => smallest_within(nearest, most, wishes, &attempt),
        false => Err(unmet(&nearest, most, wishes, wanted)),
    }
}

/// Why nothing is known of the instructions of a plan.
fn without_costs(found: &Found) -> Failure {
    let planned = &found.planned;
    Failure::limit(
        format!(
            "no instructions are predicted of arithmetic `{}`, visibility `{}`, emitters `{}` and transfer `{}` in scene `{}`",
            planned.rung.name(),
            planned.sight.name(),
            planned.emitters.name(),
            planned.transfer.name(),
            planned.scene.name
        ),
        "leave out --instructions, or take arithmetic `best`, visibility `exact` and transfer `exact` or `codes`",
    )
}

type Attempt<'a> = dyn Fn(Option<u64>) -> Result<Found, Failure> + 'a;

/// More samples than a scene without a budget takes, while that lessens the error.
fn more(mut best: Found, most: f64, attempt: &Attempt<'_>) -> Result<Found, Failure> {
    for _ in 0..DOUBLINGS {
        if best.errs_within(most) {
            break;
        }
        let next = match attempt(Some(2 * best.samples())) {
            Ok(next) => next,
            // As many samples cannot be had.
            Err(Failure::Limit { .. }) => break,
            Err(failure) => return Err(failure),
        };
        if next.error >= best.error {
            break;
        }
        best = next;
    }
    Ok(best)
}

/// The plan that errs least among `largest`, where that does not err too much already,
/// and some with fewer samples: a budget that is a little smaller is sometimes divided
/// better.
fn nearest(
    largest: Found,
    most: f64,
    wishes: &Wishes,
    attempt: &Attempt<'_>,
) -> Result<Found, Failure> {
    let samples = largest.samples();
    let mut best = largest;
    for parts in (SIXTEENTHS / 2..SIXTEENTHS).rev() {
        if best.errs_within(most) {
            break;
        }
        match attempt(Some(samples * parts / SIXTEENTHS)) {
            Ok(found) if found.fits(wishes) && found.error < best.error => best = found,
            Ok(_) | Err(Failure::Limit { .. }) => {}
            Err(failure) => return Err(failure),
        }
    }
    Ok(best)
}

/// The plan with the most samples whose bytes are within the wishes, fewer than those
/// of `large`, which are not.
fn largest_that_fits(
    large: Found,
    wishes: &Wishes,
    attempt: &Attempt<'_>,
) -> Result<Found, Failure> {
    let (mut low, mut high) = (0, large.samples());
    let (mut fitting, mut smallest) = (None, large);
    while high.saturating_sub(low) > (high / FINE).max(1) {
        let middle = low.midpoint(high);
        match attempt(Some(middle)) {
            Ok(found) if found.fits(wishes) => {
                low = middle;
                fitting = Some(found);
            }
            Ok(found) => {
                high = middle.min(found.samples());
                smallest = found;
            }
            // So few do not make a plan.
            Err(Failure::Limit { .. }) => low = middle,
            Err(failure) => return Err(failure),
        }
    }
    fitting.ok_or_else(|| {
        let beyond = |most: Option<u64>, takes: u64| most.is_some_and(|most| takes > most);
        let flag = match () {
            () if beyond(wishes.ram, smallest.ram()) => "--ram",
            () if beyond(wishes.flash, smallest.flash()) => "--flash",
            () => "--instructions",
        };
        Failure::limit(
            format!(
                "no plan of scene `{}` meets the wish {flag}: the smallest takes {}",
                smallest.planned.scene.name,
                smallest.cost()
            ),
            format!("raise {flag} to that, or split the scene"),
        )
    })
}

/// The plan with the fewest samples whose predicted error is within the wish, as that
/// of `large` is.
fn smallest_within(
    large: Found,
    most: f64,
    wishes: &Wishes,
    attempt: &Attempt<'_>,
) -> Result<Found, Failure> {
    let (mut low, mut high) = (0, large.samples());
    let mut best = large;
    while high.saturating_sub(low) > (high / FINE).max(1) {
        let middle = low.midpoint(high);
        match attempt(Some(middle)) {
            Ok(found) if found.errs_within(most) && found.fits(wishes) => {
                high = middle.min(found.samples());
                best = found;
            }
            Ok(_) | Err(Failure::Limit { .. }) => low = middle,
            Err(failure) => return Err(failure),
        }
    }
    Ok(best)
}

/// Why an error is out of reach, and what is nearest to it. `wanted` is what was tried
/// first takes, and whether that met the wish.
fn unmet(nearest: &Found, most: f64, wishes: &Wishes, (wanted, met): (String, bool)) -> Failure {
    let error = 100.0 * nearest.error.unwrap_or(f64::INFINITY);
    // Three digits of it are not below it.
    let (predicted, enough) = (percent(error), percent(1.01 * error));
    let limits = match wishes.instructions {
        Some(_) => "--ram, --flash or --instructions",
        None => "--ram or --flash",
    };
    let remedy = match met {
        true => format!(
            "the error takes {wanted}: raise {limits} to that, or take --max-error {enough}%"
        ),
        false => format!("raise --samples, or take --max-error {enough}%"),
    };
    Failure::limit(
        format!(
            "the wish --max-error {}% cannot be met: the nearest plan within the others has a predicted error of {predicted} % with {}",
            percent(100.0 * most),
            nearest.cost()
        ),
        remedy,
    )
}
