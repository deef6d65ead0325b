//! Every refusal, by name, with what was needed and what there was.

use crate::bytes::{Words, seal};
use crate::{paper, planned, put};
use isolux::Error;
use isolux::error::What;
use isolux::form_factor::Best;
use isolux::scene::records::{Counts, Emitter, Header, Loop, Surface};
use isolux::scene::{Aligned, Scene, VERSION};
use isolux::shoot::{Light, Stop};
use std::mem::{offset_of, size_of};

fn load(bytes: &[u8]) -> Result<(), Error> {
    let words = Words::new(bytes);
    Scene::load(words.bytes(bytes.len())).map(|_| ())
}

/// The paper's tables after a change, with a checksum that agrees.
fn changed(change: impl FnOnce(&mut [u8], &Sections)) -> Result<(), Error> {
    let mut bytes = paper().2.bytes().to_vec();
    change(&mut bytes, &Sections::of(paper().2.bytes()));
    seal(&mut bytes);
    load(&bytes)
}

/// Where the sections begin.
struct Sections {
    surfaces: usize,
    reflectances: usize,
    emitters: usize,
    exitances: usize,
    loops: usize,
    vertices: usize,
    samples: usize,
    members: usize,
}

impl Sections {
    /// Of tables in grey with constant radiosities.
    fn of(bytes: &[u8]) -> Self {
        let count = |field: usize| {
            let at = offset_of!(Header, counts) + field;
            u32::from_le_bytes(bytes[at..at + 4].try_into().expect("four bytes")) as usize
        };
        let surfaces = size_of::<Header>();
        let reflectances = surfaces + count(offset_of!(Counts, surfaces)) * size_of::<Surface>();
        let emitters = reflectances + count(offset_of!(Counts, surfaces)) * 4;
        let exitances = emitters + count(offset_of!(Counts, emitters)) * size_of::<Emitter>();
        let loops = exitances + count(offset_of!(Counts, luminaires)) * 4;
        let vertices = loops + count(offset_of!(Counts, loops)) * size_of::<Loop>();
        let samples = vertices + count(offset_of!(Counts, vertices)) * size_of::<[f32; 3]>();
        let members = samples + count(offset_of!(Counts, samples)) * size_of::<[f32; 2]>();
        Self {
            surfaces,
            reflectances,
            emitters,
            exitances,
            loops,
            vertices,
            samples,
            members,
        }
    }
}

#[test]
fn what_is_no_table_is_none() {
    for bytes in [
        &b""[..],
        b"isolux",
        b"isolux\n\0",
        b"\x7fELF 32-bit LSB and so on",
    ] {
        assert_eq!(load(bytes), Err(Error::NotTables), "{bytes:?}");
    }
    assert_eq!(changed(|bytes, _| bytes[0] ^= 1), Err(Error::NotTables));
}

#[test]
fn other_versions_are_named() {
    for found in [0, VERSION + 1, u32::MAX] {
        let refused = changed(|bytes, _| put(bytes, offset_of!(Header, version), found));
        let supported = VERSION;
        assert_eq!(refused, Err(Error::Version { found, supported }));
    }
}

#[test]
fn tables_off_by_a_byte_are_misaligned() {
    let bytes = paper().2.bytes();
    for by in 1..4 {
        let words = Words::new(&[&vec![0; by][..], bytes].concat());
        let refused = Scene::load(&words.bytes(by + bytes.len())[by..]).map(|_| ());
        assert_eq!(refused, Err(Error::Misaligned));
    }
    // What the kernel offers for static tables is aligned.
    let aligned = Aligned(*b"isolux\r\n");
    assert!(matches!(Scene::load(&aligned.0), Err(Error::Length { .. })));
}

#[test]
fn every_other_length_is_refused_with_both_numbers() {
    let bytes = paper().2.bytes();
    let needed = bytes.len() as u32;
    for length in 0..bytes.len() {
        let have = length as u32;
        const HEADER: u32 = size_of::<Header>() as u32;
        let expected = match have {
            0..8 => Error::NotTables,
            8..HEADER => Error::Length {
                needed: HEADER,
                have,
            },
            _ => Error::Length { needed, have },
        };
        assert_eq!(load(&bytes[..length]), Err(expected));
    }
    for extra in [1, 4, 1000] {
        let longer = [bytes, &vec![0; extra]].concat();
        let have = needed + extra as u32;
        assert_eq!(load(&longer), Err(Error::Length { needed, have }));
    }
    // A count that disagrees with the length, in a header that is else sound.
    for field in [
        offset_of!(Counts, channels),
        offset_of!(Counts, surfaces),
        offset_of!(Counts, luminaires),
        offset_of!(Counts, emitters),
        offset_of!(Counts, loops),
        offset_of!(Counts, vertices),
        offset_of!(Counts, samples),
    ] {
        for count in [0, u32::MAX, 1 << 31] {
            let at = offset_of!(Header, counts) + field;
            let refused = changed(|bytes, _| put(bytes, at, count));
            assert!(matches!(refused, Err(Error::Length { have, .. }) if have == needed));
        }
    }
}

/// Every pair of counts at once, so that no product of two overflows before it is checked.
#[test]
fn counts_without_bounds_are_refused() {
    const COUNTS: usize = size_of::<Counts>() / 4;
    let at = |field: usize| offset_of!(Header, counts) + 4 * field;
    for (one, other) in (0..COUNTS).flat_map(|one| (0..one).map(move |other| (one, other))) {
        for count in [u32::MAX, 1 << 31, 1 << 16] {
            let refused = changed(|bytes, _| {
                put(bytes, at(one), count);
                put(bytes, at(other), count);
            });
            assert!(refused.is_err(), "counts {one} and {other}: {count}");
        }
    }
}

#[test]
fn every_changed_bit_is_found() {
    let sound = paper().2.bytes();
    let behind = offset_of!(Header, checksum) + 4;
    for at in behind..sound.len() {
        let mut bytes = sound.to_vec();
        bytes[at] ^= 1 << (at % 8);
        // A changed count already disagrees with the length.
        let refused = load(&bytes);
        let found = matches!(
            refused,
            Err(Error::Checksum { stored, computed }) if stored != computed
        ) || matches!(refused, Err(Error::Length { .. }));
        assert!(found, "byte {at}: {refused:?}");
    }
}

#[test]
fn numbers_outside_of_their_domain_are_named() {
    let number = |what, record| Err(Error::Number { what, record });
    let float = |at: fn(&Sections) -> usize, value: f32| {
        changed(|bytes, sections| put(bytes, at(sections), value.to_bits()))
    };
    let never = [f32::NAN, f32::INFINITY, f32::NEG_INFINITY];
    for bad in never {
        assert_eq!(
            float(|_| offset_of!(Header, tolerance), bad),
            number(What::Header, 0)
        );
        assert_eq!(
            float(|s| s.vertices + 12 * 5 + 4, bad),
            number(What::Vertices, 5)
        );
        assert_eq!(float(|s| s.samples + 8 * 7, bad), number(What::Samples, 7));
        assert_eq!(float(|s| s.loops + 12 + 8, bad), number(What::Loops, 1));
    }
    let surface = |field: usize, value: f32| {
        changed(|bytes, sections| put(bytes, sections.surfaces + field, value.to_bits()))
    };
    for (field, bad) in [
        (offset_of!(Surface, origin), 2e8),
        (offset_of!(Surface, axis_u), 0.5),
        (offset_of!(Surface, axis_v), f32::NAN),
        (offset_of!(Surface, normal) + 8, -2.0),
        (offset_of!(Surface, size), 0.0),
        (offset_of!(Surface, size) + 4, -1.0),
        (offset_of!(Surface, filter_radius), f32::INFINITY),
        (offset_of!(Surface, filter_radius), 0.0),
    ] {
        assert_eq!(
            surface(field, bad),
            number(What::Surfaces, 0),
            "{field} {bad}"
        );
    }
    let emitter = |field: usize, value: f32| {
        changed(|bytes, sections| put(bytes, sections.emitters + field, value.to_bits()))
    };
    for (field, bad) in [
        (offset_of!(Emitter, area), -1.0),
        (offset_of!(Emitter, area), f32::NAN),
        (offset_of!(Emitter, area), 1e18),
    ] {
        assert_eq!(
            emitter(field, bad),
            number(What::Emitters, 0),
            "{field} {bad}"
        );
    }
    for bad in [1.0, -0.5, f32::NAN] {
        let refused = float(|s| s.reflectances + 4, bad);
        assert_eq!(refused, number(What::Reflectances, 1), "{bad}");
    }
    for bad in [-1.0, 1e22, f32::NAN] {
        let refused = float(|s| s.exitances, bad);
        assert_eq!(refused, number(What::Exitances, 0), "{bad}");
    }
    // Fewer than three vertices are no loop.
    let refused = changed(|bytes, s| put(bytes, s.loops + offset_of!(Loop, vertices), 2));
    assert_eq!(refused, number(What::Loops, 0));
}

#[test]
fn indices_outside_of_the_tables_are_named() {
    let range = |what, record| Err(Error::Range { what, record });
    for bad in [1000, u32::MAX, u32::MAX - 3] {
        for field in [
            offset_of!(Emitter, surface),
            offset_of!(Emitter, first_loop),
            offset_of!(Emitter, loops),
            offset_of!(Emitter, first_member),
            offset_of!(Emitter, members),
        ] {
            let at = size_of::<Emitter>() + field;
            let refused = changed(|bytes, s| put(bytes, s.emitters + at, bad));
            assert_eq!(refused, range(What::Emitters, 1), "{field} {bad}");
        }
        for field in [offset_of!(Loop, first_vertex), offset_of!(Loop, vertices)] {
            let refused = changed(|bytes, s| put(bytes, s.loops + field, bad));
            assert_eq!(refused, range(What::Loops, 0), "{field} {bad}");
        }
        let field = offset_of!(Surface, first_sample);
        let refused = changed(|bytes, s| put(bytes, s.surfaces + field, bad));
        assert_eq!(refused, range(What::Surfaces, 0));
    }
    let field = offset_of!(Surface, samples);
    let refused = changed(|bytes, s| put(bytes, s.surfaces + field, 1));
    assert_eq!(
        refused,
        range(What::Surfaces, 1),
        "samples between two surfaces"
    );
    let refused = changed(|bytes, s| bytes[s.members + 6..][..2].fill(0xff));
    assert_eq!(refused, range(What::Members, 3));
}

#[test]
fn light_that_does_not_fit_says_what_it_needs() {
    let tables = &paper().2;
    let scene = Scene::load(tables.bytes()).expect("sound tables");
    let (samples, emitters) = (tables.counts.samples, tables.counts.emitters);
    let refused = Light::<Best, 40, 64>::new(scene).map(|_| ());
    let expected = Error::Capacity {
        what: What::Samples,
        needed: samples,
        have: 40,
    };
    assert_eq!(refused, Err(expected));
    let refused = Light::<Best, 64, 2>::new(scene).map(|_| ());
    let expected = Error::Capacity {
        what: What::Emitters,
        needed: emitters,
        have: 2,
    };
    assert_eq!(refused, Err(expected));
    assert!(Light::<Best, 64, 64>::new(scene).is_ok());
}

#[test]
fn what_a_caller_asks_for_wrongly_is_refused() {
    let scene = Scene::load(paper().2.bytes()).expect("sound tables");
    let mut light = Light::<Best, 64, 64>::new(scene).expect("room");
    light.solve(Stop::Reflections(0));
    let mut out = [f32::NAN; 8];
    let row = |surface, row, columns, out: &mut [f32]| {
        light.resample_row::<isolux::number::SoftRoot>(surface, [columns, 8], row, out)
    };
    let unknown = |what, asked, have| Err(Error::Unknown { what, asked, have });
    assert_eq!(row(3, 0, 8, &mut out), unknown(What::Surfaces, 3, 3));
    assert_eq!(row(0, 8, 8, &mut out), unknown(What::Rows, 8, 8));
    let short = Err(Error::Slice { needed: 9, have: 8 });
    assert_eq!(row(0, 0, 9, &mut out), short);
    assert!(
        out.iter().all(|x| x.is_nan()),
        "a refused row writes nothing"
    );
    assert!(row(0, 0, 8, &mut out).is_ok());
    assert!(out.iter().all(|x| *x > 0.0));
}

#[test]
fn baking_twice_gives_the_same_bytes() {
    let (name, source) = isolux_host::scene::shipped::ALL[0];
    let again = planned(name, source).2;
    assert_eq!(paper().2.bytes(), again.bytes());
    assert_eq!(paper().2.counts, again.counts);
}
