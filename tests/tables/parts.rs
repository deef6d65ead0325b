//! Tables loaded by a firmware that names the parts they have: all that are named load
//! as if all were, and what has another part is refused.

use crate::bytes::Words;
use crate::fuzz::kinds;
use isolux::Error;
use isolux::scene::{Scene, parts};

type Loading<'t> = fn(&'t [u8]) -> Result<Scene<'t>, Error>;

/// [`Scene::load_with`] of every set of parts.
fn loadings<'t>() -> [Loading<'t>; 16] {
    [
        Scene::load_with::<0>,
        Scene::load_with::<1>,
        Scene::load_with::<2>,
        Scene::load_with::<3>,
        Scene::load_with::<4>,
        Scene::load_with::<5>,
        Scene::load_with::<6>,
        Scene::load_with::<7>,
        Scene::load_with::<8>,
        Scene::load_with::<9>,
        Scene::load_with::<10>,
        Scene::load_with::<11>,
        Scene::load_with::<12>,
        Scene::load_with::<13>,
        Scene::load_with::<14>,
        Scene::load_with::<15>,
    ]
}

#[test]
fn tables_load_with_their_parts_and_with_no_fewer() {
    assert_eq!(parts::ALL as usize, loadings().len() - 1);
    for kind in kinds() {
        let words = Words::new(&kind.sound);
        let bytes = words.bytes(kind.sound.len());
        let whole = Scene::load(bytes).expect("sound tables");
        let its = parts::of(whole.counts());
        for (named, load) in (0..).zip(loadings()) {
            let (name, missing) = (kind.name, its & !named);
            match load(bytes) {
                Ok(scene) => {
                    assert_eq!(missing, 0, "{name} with {named}");
                    assert_eq!(format!("{scene:?}"), format!("{whole:?}"), "{name}");
                }
                Err(Error::Capacity { needed, have, .. }) => {
                    assert!(missing != 0, "{name} with {named}");
                    assert!(needed > 0 && have == 0, "{name} with {named}: {needed}");
                }
                Err(error) => panic!("{name} with {named}: {error}"),
            }
        }
    }
}

#[test]
fn every_part_is_in_some_tables_and_missing_in_others() {
    let its = kinds().into_iter().map(|kind| {
        let words = Words::new(&kind.sound);
        let scene = Scene::load(words.bytes(kind.sound.len())).expect("sound tables");
        parts::of(scene.counts())
    });
    let (any, every) = its.fold((0, parts::ALL), |(any, every), its| {
        (any | its, every & its)
    });
    assert_eq!(any, parts::ALL);
    assert_eq!(every & !parts::FIELDS, 0);
}
