//! What a solve in integers does, counted: the kernel is solved once more, with a type
//! around its rung of transfer that notes who shoots at what; what form factors and terms
//! that takes is told from the tables.

use super::super::{EMITTERS, SAMPLES};
use super::{Operation, Tally};
use glam::DVec3;
use isolux::Error;
use isolux::integers::{
    Computed, Emitter, Format, Light, Matrix, Q24, Q29, Radiosity, Scene, Surface, Transfer,
};
use isolux::scene::Term;
use isolux::shoot::Stop;
use std::cell::RefCell;
use std::collections::BTreeMap;
use std::marker::PhantomData;

/// What was shot: how often every emitter sent to the samples of a surface, by the first
/// of these among all that receive.
#[derive(Clone, Debug, Default)]
struct Sent {
    computed: BTreeMap<(usize, u32), u64>,
    /// Surfaces sent to by terms, terms read, and those of them that are not 0.
    terms: [u64; 3],
    /// The emitter that was read last, and how often an earlier one came after it.
    last: Option<usize>,
    sweeps: u64,
}

thread_local! {
    /// The kernel's rungs are types without state: what they count is here.
    static SENT: RefCell<Sent> = RefCell::default();
}

/// A rung of transfer, counted.
struct Counted<T>(PhantomData<T>);

impl<T: Transfer> Transfer for Counted<T> {
    type Radiosity = T::Radiosity;
    const SWEEPS: bool = T::SWEEPS;

    fn fits(scene: &Scene<'_>) -> Result<(), Error> {
        T::fits(scene)
    }

    fn fractions<'t>(scene: &Scene<'t>, emitter: usize, first: u32) -> &'t [u16] {
        SENT.with_borrow_mut(|sent| *sent.computed.entry((emitter, first)).or_insert(0) += 1);
        T::fractions(scene, emitter, first)
    }

    fn add(
        scene: &Scene<'_>,
        emitter: usize,
        first: u32,
        radiosity: T::Radiosity,
        values: &mut [i32],
    ) -> bool {
        let added = T::add(scene, emitter, first, radiosity, values);
        if added {
            let filled = scene.terms_of(emitter, first).take(values.len());
            let filled = filled.filter(|term: &Term| term.factor > 0.0).count();
            SENT.with_borrow_mut(|sent| {
                sent.terms[0] += 1;
                sent.terms[1] += values.len() as u64;
                sent.terms[2] += filled as u64;
                if sent.last.is_none_or(|last| emitter < last) {
                    sent.sweeps += 1;
                }
                sent.last = Some(emitter);
            });
        }
        added
    }
}

/// What direct light and a whole solve take, counted.
///
/// # Errors
/// Those of [`Scene::load`] and [`Light::new`].
pub(crate) fn tally(tables: &[u8], is_short: bool, stop: Stop) -> Result<[Tally; 2], Error> {
    let scene = Scene::load(tables)?;
    let counts = scene.counts();
    match (counts.coefficients, counts.bits, is_short) {
        (1, _, true) => of::<Q24, Computed>(scene, stop),
        (1, _, false) => of::<Q29, Computed>(scene, stop),
        (_, 4, _) => of::<Q29, Matrix<4>>(scene, stop),
        (_, 6, _) => of::<Q29, Matrix<6>>(scene, stop),
        (_, _, true) => of::<Q24, Matrix<8>>(scene, stop),
        _ => of::<Q29, Matrix<8>>(scene, stop),
    }
}

fn of<F: Format, T: Transfer>(scene: Scene<'_>, stop: Stop) -> Result<[Tally; 2], Error> {
    type Room<'t, F, T> = Light<'t, F, SAMPLES, EMITTERS, Counted<T>>;
    let mut light = Box::new(Room::<F, T>::new(scene)?);
    let counts = scene.counts();
    let coefficients = u64::from(T::Radiosity::COEFFICIENTS);
    let (emitters, members) = (u64::from(counts.emitters), u64::from(counts.members));
    SENT.take();
    let first = u64::from(light.direct());
    let direct = SENT.take();
    let shots = u64::from(light.solve(stop).shots);
    let all = SENT.take();
    let tally = |sent: &Sent, shots: u64, gathers: u64, looks: u64| {
        let mut tally = [0; Operation::ALL.len()];
        let mut add = |operation: Operation, times: u64| tally[operation as usize] += times;
        add(Operation::Shot, shots);
        add(Operation::Gather, gathers * emitters);
        add(Operation::GatherMember, gathers * members * coefficients);
        add(Operation::Unshot, looks * emitters);
        add(Operation::Member, looks * members);
        let [surfaces, entries, terms] = sent.terms;
        add(Operation::Sent, surfaces);
        add(Operation::Entry, entries);
        add(Operation::Term, terms);
        for (&(emitter, first), &times) in &sent.computed {
            add(Operation::ShotSurface, times);
            let fractions = T::fractions(&scene, emitter, first);
            form_factors(
                &scene,
                (emitter, first),
                fractions,
                &mut |operation, count| {
                    add(operation, times * count);
                },
            );
        }
        tally
    };
    // Direct light asks all emitters; then every sweep or generation does, and looks what
    // is left, or every shot looks.
    let (gathers, looks) = match stop {
        Stop::Reflections(times) => (1 + u64::from(times), 1),
        _ if T::SWEEPS => (1 + all.sweeps, all.sweeps + 2),
        _ => (1, shots.saturating_sub(first) + 2),
    };
    Ok([
        tally(&direct, first, 1, 0),
        tally(&all, shots, gathers, looks),
    ])
}

/// What an emitter's form factors take for the samples of the surface of which this is the
/// first among all that receive from its kind.
fn form_factors(
    scene: &Scene<'_>,
    (index, first): (usize, u32),
    fractions: &[u16],
    add: &mut dyn FnMut(Operation, u64),
) {
    let is_luminaire = scene.is_luminaire(index);
    let emitter = &scene.emitters()[index];
    let mut next = 0;
    for surface in scene.surfaces().iter().chain(scene.points()) {
        let samples = scene.receivers(surface, is_luminaire);
        if next == first && !samples.is_empty() {
            let mut fractions = fractions.iter();
            for &place in &scene.samples()[samples] {
                add(Operation::Pair, 1);
                // Of what is not seen nothing is computed.
                if fractions.next() != Some(&0) {
                    form_factor(scene, emitter, surface, place, add);
                }
            }
            return;
        }
        next += samples.len() as u32;
    }
}

/// As the kernel decides: nothing behind the plane, a loop whole or cut by the horizon.
fn form_factor(
    scene: &Scene<'_>,
    emitter: &Emitter,
    surface: &Surface,
    place: [i32; 2],
    add: &mut dyn FnMut(Operation, u64),
) {
    let wide = |v: [i32; 3]| DVec3::from(v.map(f64::from));
    let position = DVec3::from(surface.place(place).map(|x| x as f64));
    let plane = &scene.surfaces()[emitter.surface as usize];
    if wide(plane.normal).dot(position - wide(plane.origin)) <= 0.0 {
        return;
    }
    add(Operation::Facing, 1);
    for vertices in scene.loops_of(emitter) {
        let seen: Vec<DVec3> = { vertices.iter() }
            .map(|&vertex| wide(vertex) - position)
            .collect();
        let above = |to: &DVec3| wide(surface.normal).dot(*to) > 0.0;
        let next = seen.iter().cycle().skip(1);
        let (mut edges, mut crossed, mut obtuse) = (0, 0, 0);
        for (from, to) in seen.iter().zip(next) {
            edges += u64::from(above(from) && above(to));
            crossed += u64::from(above(from) != above(to));
            obtuse += u64::from((above(from) || above(to)) && from.dot(*to) < 0.0);
        }
        add(Operation::Loop, 1);
        add(Operation::Corner, seen.len() as u64);
        add(Operation::Edge, edges);
        add(Operation::Crossed, crossed);
        add(Operation::Obtuse, obtuse);
        add(Operation::CutLoop, u64::from(crossed > 0));
    }
}
