//! Tags: why a sample is where it is, and what light does at a place.

/// Why a sample is where it is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Tag {
    /// On the surface's own outline, a vertex of the darkest emitter.
    Edge,
    /// On an isolux outline, a vertex of two emitters.
    Isolux,
    /// At the largest irradiance.
    Peak,
    /// Inside a patch, for direct light.
    Direct,
    /// Inside a patch, for reflected light.
    Reflected,
    /// At a node of a tensor grid, for all light.
    Grid,
    /// At a node of a tensor grid, for what luminaires would send if nothing
    /// occluded.
    Lit,
    /// Where a luminaire is seen in part.
    Penumbra,
    /// Near the line where something touches the surface, for reflected light.
    Contact,
    /// Where luminaires would be seen and all of them are hidden, for reflected light: all
    /// light there is.
    Umbra,
    /// For the camera, for reflected light: without it the sample would be elsewhere.
    View,
}

/// Which light reaches a sample.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Receives {
    /// All of it.
    All,
    /// From luminaires, past what occludes.
    Unshadowed,
    /// From luminaires.
    Direct,
    /// From what reflects.
    Reflected,
}

impl Tag {
    /// All of them.
    pub const ALL: [Self; 11] = [
        Self::Edge,
        Self::Isolux,
        Self::Peak,
        Self::Direct,
        Self::Reflected,
        Self::Grid,
        Self::Lit,
        Self::Penumbra,
        Self::Contact,
        Self::Umbra,
        Self::View,
    ];

    /// Those that any place has, sample or not, in the order of tables.
    pub const OF_PLACES: [Self; 5] = [
        Self::Lit,
        Self::Penumbra,
        Self::Umbra,
        Self::Contact,
        Self::Reflected,
    ];

    /// The tag of a place, by whether it is at the foot of something
    /// ([`is_at_foot`](super::shadow::Floor::is_at_foot)) and how much is seen of the
    /// luminaires that it faces:
    ///
    /// * `contact` at a foot, else
    /// * `lit` where nothing hides any part of a luminaire that it faces, `umbra` where all of
    ///   them are hidden, `penumbra` where some part is, and
    /// * `reflected` where it faces none.
    pub fn of_place(at_foot: bool, luminaires: impl IntoIterator<Item = Seen>) -> Self {
        if at_foot {
            return Self::Contact;
        }
        let mut all = None;
        for seen in luminaires {
            all = match all {
                None => Some(seen),
                Some(before) if before == seen => all,
                Some(_) => Some(Seen::Partly),
            };
        }
        match all {
            None => Self::Reflected,
            Some(Seen::Wholly) => Self::Lit,
            Some(Seen::Partly) => Self::Penumbra,
            Some(Seen::Hidden) => Self::Umbra,
        }
    }

    /// The tag of that name.
    pub fn named(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|tag| tag.name() == name)
    }

    /// What the tag is called in plan files, pictures and tables.
    pub fn name(self) -> &'static str {
        match self {
            Self::Edge => "edge",
            Self::Isolux => "isolux",
            Self::Peak => "peak",
            Self::Direct => "direct",
            Self::Reflected => "reflected",
            Self::Grid => "grid",
            Self::Lit => "lit",
            Self::Penumbra => "penumbra",
            Self::Contact => "contact",
            Self::Umbra => "umbra",
            Self::View => "view",
        }
    }

    /// Which light reaches a sample with this tag.
    pub fn receives(self) -> Receives {
        match self {
            Self::Edge | Self::Isolux | Self::Peak | Self::Grid => Receives::All,
            Self::Lit => Receives::Unshadowed,
            Self::Direct | Self::Penumbra => Receives::Direct,
            Self::Reflected | Self::Contact | Self::Umbra | Self::View => Receives::Reflected,
        }
    }
}

/// How much is seen of a luminaire that a place faces.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Seen {
    /// All of it that is above the horizon.
    Wholly,
    /// Some of it.
    Partly,
    /// Nothing.
    Hidden,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn places_have_tags_by_what_they_see() {
        use Seen::{Hidden, Partly, Wholly};
        for (seen, tag) in [
            (&[][..], Tag::Reflected),
            (&[Wholly, Wholly], Tag::Lit),
            (&[Hidden, Hidden], Tag::Umbra),
            (&[Wholly, Hidden], Tag::Penumbra),
            (&[Hidden, Wholly, Wholly], Tag::Penumbra),
            (&[Partly], Tag::Penumbra),
        ] {
            assert_eq!(Tag::of_place(false, seen.iter().copied()), tag, "{seen:?}");
            assert_eq!(Tag::of_place(true, seen.iter().copied()), Tag::Contact);
        }
        assert!(Tag::OF_PLACES.iter().all(|tag| Tag::ALL.contains(tag)));
    }
}
