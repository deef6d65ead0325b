//! Tables with terms and responses that somebody changed.

use crate::scenes;
use isolux::Error;
use isolux::error::What;
use isolux::form_factor::Best;
use isolux::luminance::{Constant, Linear, Luminance};
use isolux::scene::Scene;
use isolux::scene::records::{Counts, Header, checksum};
use isolux::shoot::{Light, Stop};
use isolux::transfer::{Matrix, Transfer, Vectors};
use isolux_host::bake::Tables;
use std::mem::offset_of;
use zerocopy::IntoBytes;

/// A copy of tables in which something is changed, with a checksum that is right.
fn changed(tables: &Tables, change: impl FnOnce(&mut [u8])) -> Vec<u32> {
    let mut words = vec![0_u32; tables.bytes().len() / 4];
    words.as_mut_bytes().copy_from_slice(tables.bytes());
    change(words.as_mut_bytes());
    let field = offset_of!(Header, checksum);
    words[field / 4] = checksum(&words.as_bytes()[field + 4..]);
    words
}

fn count(field: usize, by: i32) -> impl Fn(&mut [u8]) {
    let at = offset_of!(Header, counts) + field;
    move |bytes| {
        let word = &mut bytes[at..at + 4];
        let now = u32::from_le_bytes(word.try_into().expect("four bytes"));
        word.copy_from_slice(&now.wrapping_add_signed(by).to_le_bytes());
    }
}

fn refused(tables: &Tables, change: impl FnOnce(&mut [u8])) -> Option<Error> {
    let words = changed(tables, change);
    Scene::load(words.as_bytes()).err()
}

/// Counts that fit the length, but not the samples.
#[test]
fn other_counts_are_refused() {
    let planned = scenes::office();
    let (matrix, vectors) = (planned.matrix(4), planned.vectors());
    let range = |what| Some(Error::Range { what, record: 0 });
    // A surface less is a point more.
    let both = |bytes: &mut [u8]| {
        count(offset_of!(Counts, points), 1)(bytes);
        count(offset_of!(Counts, surfaces), -1)(bytes);
    };
    assert!(refused(&vectors, both).is_some());
    for by in [-1, 1] {
        let found = refused(&matrix, count(offset_of!(Counts, terms), by));
        assert!(found.is_some(), "terms {by}");
        let found = refused(&vectors, count(offset_of!(Counts, responses), by));
        assert!(found.is_some(), "responses {by}");
        assert!(refused(&matrix, count(offset_of!(Counts, bits), by)).is_some());
    }
    let responses = vectors.counts.responses;
    if responses % 2 == 0 {
        let found = refused(&vectors, count(offset_of!(Counts, responses), -1));
        assert_eq!(found, range(What::Responses));
    }
}

/// The end of the tables, up to the fields, is what was written down: any bits may
/// stand there.
fn any_bits_give_numbers<L: Luminance, V: Transfer + Default>(tables: &Tables, last: usize) {
    let sound = tables.bytes();
    let counts = &tables.counts;
    // What follows are the fields of a surface; this plan has none.
    assert_eq!((counts.fields, counts.nodes, counts.matrices), (0, 0, 0));
    let first = sound.len() - last;
    for seed in 1..=16_u32 {
        let mut state = seed;
        let words = changed(tables, |bytes| {
            for byte in &mut bytes[first..] {
                state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
                *byte = (state >> 24) as u8;
            }
        });
        let scene = Scene::load(words.as_bytes()).expect("any bits are terms");
        let mut light = Box::new(Light::<Best, 1024, 256, L, V>::new(scene).expect("room"));
        let stop = Stop::Below {
            fraction: 1e-3,
            shots: 2000,
        };
        assert!(light.solve(stop).unshot.is_finite(), "{seed}");
        for reflections in 0..20 {
            light.reflect();
            let mut values = light.irradiance().iter();
            let finite = values.all(|e| isolux::luminance::Colour::all(*e, f32::is_finite));
            assert!(finite, "{seed}, {reflections}");
        }
    }
}

#[test]
fn any_terms_and_responses_give_numbers() {
    let planned = scenes::office();
    let bytes = |bits: u32, tables: &Tables| (tables.counts.terms * 2 * bits).div_ceil(8) as usize;
    let tables = planned.matrix(4);
    any_bits_give_numbers::<Linear<f32>, Matrix<4>>(&tables, bytes(4, &tables));
    let tables = planned.matrix(6);
    any_bits_give_numbers::<Linear<f32>, Matrix<6>>(&tables, bytes(6, &tables));
    let tables = planned.matrix(8);
    any_bits_give_numbers::<Linear<f32>, Matrix<8>>(&tables, bytes(8, &tables));
    let tables = planned.vectors();
    let responses = tables.counts.responses as usize;
    any_bits_give_numbers::<Constant<f32>, Vectors>(&tables, 2 * responses);
}

#[test]
fn writing_twice_gives_the_same_bytes() {
    let planned = scenes::office();
    assert_eq!(planned.matrix(6).bytes(), planned.matrix(6).bytes());
    assert_eq!(planned.vectors().bytes(), planned.vectors().bytes());
}
