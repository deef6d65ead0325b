//! Solved scenes, kept on disk.
//!
//! A file holds the light on every cell, never the matrix. Its name is a hash
//! of all that the solution depends on, and it repeats that, so that a hash
//! shared by two scenes does no harm. It is written under another name and
//! renamed: a reader never sees half of it. What cannot be read, or does not
//! match its own check, is as good as absent and written anew.

use std::hash::{DefaultHasher, Hasher};
use std::io::Write;
use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};

use super::polynomial::Polynomial;
use super::room::Room;
use super::tree::Light;
use super::{AGREEMENT, Reflections};
use crate::scene::Scene;

/// Counts up when the same scene would be solved otherwise.
const SCHEME: u64 = 1;

/// The variable that names another directory.
const VARIABLE: &str = "ISOLUX_CACHE";

/// What a solution depends on, number by number.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct Key(Vec<u64>);

/// What is kept.
#[derive(Serialize, Deserialize)]
struct Stored {
    key: Key,
    reflections: usize,
    accuracy: f64,
    halved: Vec<usize>,
    base: Vec<usize>,
    cells: Vec<StoredCell>,
}

/// The light of one cell.
#[derive(Serialize, Deserialize)]
struct StoredCell {
    cell: usize,
    roughness: f64,
    total: Vec<Polynomial>,
}

/// Where solutions are kept: `ISOLUX_CACHE`, or `isolux` in the user's cache
/// directory; `None` where there is neither.
pub(super) fn directory() -> Option<PathBuf> {
    match std::env::var_os(VARIABLE) {
        Some(given) if !given.is_empty() => Some(given.into()),
        _ => dirs::cache_dir().map(|cache| cache.join("isolux")),
    }
}

impl Key {
    /// The key of a scene and what is asked of it.
    pub(super) fn new(scene: &Scene, reflections: Reflections) -> Self {
        let mut numbers = vec![SCHEME, AGREEMENT.to_bits()];
        numbers.extend(match reflections {
            Reflections::AtMost(count) => [0, count as u64],
            Reflections::UntilUnshot(fraction) => [1, fraction.to_bits()],
        });
        for surface in &scene.surfaces {
            numbers.push(surface.vertices.len() as u64);
            let vertices = surface.vertices.iter().flat_map(|vertex| vertex.to_array());
            let properties = surface.reflectance.into_iter().chain(surface.radiance);
            numbers.extend(vertices.chain(properties).map(f64::to_bits));
        }
        Self(numbers)
    }

    fn path(&self, directory: &Path) -> PathBuf {
        let bytes: Vec<u8> = self
            .0
            .iter()
            .flat_map(|number| number.to_le_bytes())
            .collect();
        directory.join(format!("reference-{:016x}.json", hash(&bytes)))
    }
}

/// A hash that is the same in every run of one build; one that changed with
/// the standard library would only cost a solution.
fn hash(bytes: &[u8]) -> u64 {
    let mut hasher = DefaultHasher::new();
    hasher.write(bytes);
    hasher.finish()
}

/// Puts a kept solution into `room`, which is of the same scene and not yet
/// solved; false, and the room to be thrown away, where there is none.
pub(super) fn load(directory: &Path, key: &Key, room: &mut Room) -> bool {
    read(directory, key).is_some_and(|stored| restore(stored, room).is_some())
}

fn read(directory: &Path, key: &Key) -> Option<Stored> {
    let text = std::fs::read_to_string(key.path(directory)).ok()?;
    let (check, body) = text.split_once('\n')?;
    if check != format!("{:016x}", hash(body.as_bytes())) {
        return None;
    }
    let stored: Stored = serde_json::from_str(body).ok()?;
    (stored.key == *key).then_some(stored)
}

fn restore(stored: Stored, room: &mut Room) -> Option<()> {
    let tree = &mut room.tree;
    for index in stored.halved {
        if index >= tree.cells.len() {
            return None;
        }
        tree.halve(index)?;
    }
    if stored.base.iter().any(|index| *index >= tree.cells.len()) {
        return None;
    }
    tree.set_base(stored.base);
    for kept in stored.cells {
        tree.cells.get_mut(kept.cell)?.light = Some(Light {
            direct: Vec::new(),
            total: kept.total,
            roughness: kept.roughness,
        });
    }
    room.reflections = stored.reflections;
    room.accuracy = stored.accuracy;
    Some(())
}

/// Keeps the solution of `room`. A directory that cannot be written to is no
/// error: the scene is then solved again the next time.
pub(super) fn store(directory: &Path, key: Key, room: &Room) {
    let path = key.path(directory);
    let cells = room
        .tree
        .cells
        .iter()
        .enumerate()
        .filter_map(|(cell, kept)| {
            let light = kept.light.as_ref()?;
            Some(StoredCell {
                cell,
                roughness: light.roughness,
                total: light.total.clone(),
            })
        });
    let stored = Stored {
        key,
        reflections: room.reflections,
        accuracy: room.accuracy,
        halved: room.tree.halved.clone(),
        base: room.tree.base.clone(),
        cells: cells.collect(),
    };
    if let Ok(body) = serde_json::to_string(&stored) {
        // Nothing depends on whether this succeeds.
        let _ = write(directory, &path, &body);
    }
}

fn write(directory: &Path, path: &Path, body: &str) -> std::io::Result<()> {
    std::fs::create_dir_all(directory)?;
    let mut file = tempfile::NamedTempFile::new_in(directory)?;
    writeln!(file, "{:016x}", hash(body.as_bytes()))?;
    file.write_all(body.as_bytes())?;
    file.persist(path)?;
    Ok(())
}
