//! Critical lines: where a place sees two things begin to cover each other.
//!
//! All sight lines of one event pass through one vertex, its apex, and lie in
//! one plane. On the receiver's plane this is a segment. It matters where the
//! sight line meets no other occluder on its way, which is decided exactly: a
//! convex occluder cuts a convex part out of the event's plane, and hides what
//! this covers as seen through the apex.

use glam::{DVec2, DVec3};

use super::Kind;
use super::cast::Shadow;
use super::setting::{Occluder, Setting};

/// A segment of the receiver's plane and its event.
#[derive(Clone, Copy, Debug)]
pub(super) struct Event {
    pub(super) kind: Kind,
    pub(super) ends: [DVec2; 2],
    /// What all sight lines pass through.
    apex: DVec3,
    /// Whether the sight lines go on beyond the apex.
    passes: bool,
    /// Whether two edges lie in the event's plane, so that it has sight lines
    /// beside the apex.
    is_broad: bool,
}

/// The events of one occluder with the luminaire: a vertex of the luminaire on
/// an edge of the occluder, a vertex of the occluder on an edge of the
/// luminaire.
pub(super) fn of_occluder(setting: &Setting, occluder: &Occluder, shadow: &Shadow) -> Vec<Event> {
    let light = &setting.light;
    let mut events = Vec::new();
    for &apex in &light.apexes {
        for &edge in &occluder.edges {
            if let Some(ends) = trace(setting, apex, edge, Part::Below) {
                let event = Event::new(Kind::Event, apex, ends);
                let name = [Kind::Umbra, Kind::Outer];
                events.extend(event.named(setting, occluder, name, &shadow.umbra));
            }
        }
    }
    for &apex in &occluder.apexes {
        for &edge in &light.edges {
            if let Some(ends) = trace(setting, apex, edge, Part::Above) {
                let event = Event::new(Kind::Event, apex, ends).passing();
                let name = [Kind::Antumbra, Kind::Outer];
                events.extend(event.named(setting, occluder, name, &shadow.antumbra));
            }
        }
    }
    events
}

/// The events of two occluders before the luminaire: a vertex of one on an
/// edge of the other.
pub(super) fn of_pair(setting: &Setting, first: &Occluder, second: &Occluder) -> Vec<Event> {
    let mut events = Vec::new();
    for (one, other) in [(first, second), (second, first)] {
        for &apex in &one.apexes {
            for &edge in &other.edges {
                for part in [Part::Below, Part::Above] {
                    let ends = trace(setting, apex, edge, part);
                    let event = ends.map(|ends| Event::new(Kind::Overlap, apex, ends).passing());
                    events.extend(event.into_iter().flat_map(|e| e.before(setting)));
                }
            }
        }
    }
    events
}

/// The segments in the planes of an occluder's faces from which some of the
/// luminaire is seen past the face, edge on: V bends where its near side gives
/// way to its far side.
pub(super) fn of_faces(setting: &Setting, occluder: &Occluder) -> Vec<[DVec2; 2]> {
    let faces = occluder.faces.iter();
    faces.flat_map(|face| of_face(setting, face)).collect()
}

fn of_face(setting: &Setting, face: &[DVec3]) -> Vec<[DVec2; 2]> {
    let normal = newell(face);
    let steep = normal.truncate().length();
    if steep < 1e-6 {
        return Vec::new();
    }
    // The line in which the face's plane meets the receiver's.
    let direction = normal.truncate().perp() / steep;
    let foot = face[0].truncate() + normal.truncate() * (normal.z * face[0].z / (steep * steep));
    let ends = [foot, foot + direction];
    let chords = chords(setting, normal, face[0], direction.extend(0.0));
    let segment = |chord: [DVec3; 2]| {
        let over = |&apex: &DVec3| {
            let event = Event::new(Kind::Face, apex, ends);
            event.covered(setting, &chord, Part::Above)
        };
        let under = |&apex: &DVec3| {
            let event = Event::new(Kind::Face, apex, ends);
            event.covered(setting, face, Part::Below)
        };
        let ranges = face
            .iter()
            .filter_map(over)
            .chain(chord.iter().filter_map(under));
        let [low, high] = ranges.reduce(|a, b| [a[0].min(b[0]), a[1].max(b[1])])?;
        Some([low, high].map(|t| foot + direction * t))
    };
    chords.into_iter().filter_map(segment).collect()
}

/// The unit normal of a polygon; 0 for one without area.
fn newell(polygon: &[DVec3]) -> DVec3 {
    let count = polygon.len();
    let doubled: DVec3 = (0..count)
        .map(|i| (polygon[i] - polygon[0]).cross(polygon[(i + 1) % count] - polygon[0]))
        .sum();
    doubled.normalize_or_zero()
}

/// The part of something below an apex, or above it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Part {
    Below,
    Above,
}

/// Where the lines through an apex and the part of a segment below or above it
/// meet the receiver's plane.
fn trace(setting: &Setting, apex: DVec3, edge: [DVec3; 2], part: Part) -> Option<[DVec2; 2]> {
    let [from, to] = edge.map(|end| match part {
        Part::Below => apex.z - end.z,
        Part::Above => end.z - apex.z,
    });
    // Not too near to the apex' height: what is there reaches too far.
    let least = 1e3 * setting.nothing;
    if from < least && to < least {
        return None;
    }
    let at_least = |here: f64, there: f64, end: DVec3, other: DVec3| {
        if here >= least {
            end
        } else {
            end.lerp(other, (least - here) / (there - here))
        }
    };
    let clipped = [
        at_least(from, to, edge[0], edge[1]),
        at_least(to, from, edge[1], edge[0]),
    ];
    let project = |place: DVec3| {
        let along = place - apex;
        apex.truncate() - along.truncate() * (apex.z / along.z)
    };
    Some(clipped.map(project))
}

impl Event {
    fn new(kind: Kind, apex: DVec3, ends: [DVec2; 2]) -> Self {
        Self {
            kind,
            ends,
            apex,
            passes: false,
            is_broad: false,
        }
    }

    fn passing(self) -> Self {
        Self {
            passes: true,
            ..self
        }
    }

    /// The same event on another part of the segment.
    pub(super) fn part(&self, [from, to]: [f64; 2]) -> Self {
        let [a, b] = self.ends;
        Self {
            ends: [from, to].map(|t| a.lerp(b, t)),
            ..*self
        }
    }

    /// Unit normal of the plane of its sight lines; `None` where it has none.
    fn plane(&self) -> Option<DVec3> {
        let [a, b] = self.ends.map(|end| end.extend(0.0));
        let (along, up) = (b - a, self.apex - a);
        let normal = along.cross(up);
        let size = normal.length();
        (size > 1e-9 * along.length() * up.length()).then(|| normal / size)
    }

    /// The event with its kind: `names` are what it is where the luminaire and
    /// the occluder are on one side of its plane, and where they are not. The
    /// first only on the outline of `region`: the event in two or three parts.
    fn named(
        self,
        setting: &Setting,
        occluder: &Occluder,
        names: [Kind; 2],
        region: &[[f64; 2]],
    ) -> Vec<Self> {
        let Some(normal) = self.plane() else {
            return Vec::new();
        };
        let side = |points: &[DVec3]| {
            let (low, high) = extent(points, normal, self.apex);
            let nothing = setting.nothing;
            (low >= -nothing, high <= nothing)
        };
        let is_broad = self.holds_edge(setting, &setting.light.points)
            && self.holds_edge(setting, &occluder.points);
        let this = Self { is_broad, ..self };
        match (side(&setting.light.points), side(&occluder.points)) {
            (_, (true, true)) => Vec::new(),
            ((true, _), (_, true)) | ((_, true), (true, _)) => vec![Self {
                kind: names[1],
                ..this
            }],
            ((true, _), (true, _)) | ((_, true), (_, true)) => {
                this.split(setting, names[0], region)
            }
            _ => vec![this],
        }
    }

    /// Whether two of these places or more lie in its plane.
    fn holds_edge(&self, setting: &Setting, points: &[DVec3]) -> bool {
        let Some(normal) = self.plane() else {
            return false;
        };
        let height = |point: &&DVec3| normal.dot(**point - self.apex).abs();
        let on = points.iter().filter(|p| height(p) <= setting.nothing);
        on.count() >= 2
    }

    fn split(self, setting: &Setting, kind: Kind, region: &[[f64; 2]]) -> Vec<Self> {
        let Some([from, to]) = self.inside(region, setting.nothing) else {
            return vec![self];
        };
        let outline = Self {
            kind,
            ..self.part([from, to])
        };
        let mut parts = vec![outline];
        parts.extend((from > 0.0).then(|| self.part([0.0, from])));
        parts.extend((to < 1.0).then(|| self.part([to, 1.0])));
        parts
    }

    /// The part inside of a convex ring or within `nothing` of it.
    fn inside(&self, ring: &[[f64; 2]], nothing: f64) -> Option<[f64; 2]> {
        let (mut from, mut to) = (0.0_f64, 1.0_f64);
        if ring.len() < 3 {
            return None;
        }
        for i in 0..ring.len() {
            let corner = DVec2::from(ring[i]);
            let along = (DVec2::from(ring[(i + 1) % ring.len()]) - corner).normalize_or_zero();
            let [a, b] = self.ends.map(|end| along.perp_dot(end - corner));
            if a < -nothing && b < -nothing {
                return None;
            }
            if a < -nothing {
                from = from.max(a / (a - b));
            } else if b < -nothing {
                to = to.min(a / (a - b));
            }
        }
        (to > from).then_some([from, to])
    }

    /// The parts on which the sight lines end on the luminaire.
    fn before(self, setting: &Setting) -> Vec<Self> {
        let Some(normal) = self.plane() else {
            return Vec::new();
        };
        let [a, b] = self.ends;
        let along = (b - a).extend(0.0);
        chords(setting, normal, self.apex, along)
            .into_iter()
            .filter_map(|chord| {
                let [from, to] = self.covered(setting, &chord, Part::Above)?;
                let (from, to) = (from.max(0.0), to.min(1.0));
                (to > from).then(|| self.part([from, to]))
            })
            .collect()
    }

    /// The part of the segment, as parameters, whose lines through the apex
    /// meet the hull of places in its plane on one side of the apex.
    fn covered(&self, setting: &Setting, places: &[DVec3], part: Part) -> Option<[f64; 2]> {
        let [a, b] = self.ends;
        let along = (b - a) / (b - a).length_squared();
        let mut range: Option<[f64; 2]> = None;
        let mut add = |p: DVec2| {
            let t = (p - a).dot(along);
            let [low, high] = range.unwrap_or([t, t]);
            range = Some([low.min(t), high.max(t)]);
        };
        for (i, &from) in places.iter().enumerate() {
            for &to in &places[i + 1..] {
                if let Some(ends) = trace(setting, self.apex, [from, to], part) {
                    ends.into_iter().for_each(&mut add);
                }
            }
        }
        range
    }

    /// Whether some sight lines may be seen of what [`seen`](Self::seen) leaves
    /// out.
    pub(super) fn is_broad(&self) -> bool {
        self.is_broad
    }

    /// The parts whose sight lines no occluder hides.
    pub(super) fn seen(self, setting: &Setting) -> Vec<Self> {
        let Some(normal) = self.plane() else {
            return Vec::new();
        };
        let mut hidden: Vec<[f64; 2]> = Vec::new();
        for occluder in &setting.occluders {
            let (low, high) = extent(&occluder.points, normal, self.apex);
            if low >= -setting.nothing || high <= setting.nothing {
                continue;
            }
            let section = section(&occluder.faces, normal, self.apex, setting.nothing);
            hidden.extend(self.covered(setting, &section, Part::Below));
            if self.passes {
                hidden.extend(self.covered(setting, &section, Part::Above));
            }
        }
        hidden.sort_by(|a, b| a[0].total_cmp(&b[0]));
        let mut seen = Vec::new();
        let mut from = 0.0;
        let shortest = setting.nothing / self.ends[0].distance(self.ends[1]);
        for [low, high] in hidden.into_iter().chain([[1.0, 1.0]]) {
            let to = low.min(1.0);
            if to - from > shortest {
                seen.push(self.part([from, to]));
            }
            from = high.max(from);
        }
        seen
    }
}

/// The parts of a plane's section of the luminaire, in the order of `along`.
fn chords(setting: &Setting, normal: DVec3, place: DVec3, along: DVec3) -> Vec<[DVec3; 2]> {
    let height = |point: DVec3| normal.dot(point - place);
    let mut crossings: Vec<DVec3> = Vec::new();
    let outline = &setting.light.points;
    for (i, &from) in outline.iter().enumerate() {
        let to = outline[(i + 1) % outline.len()];
        let (a, b) = (height(from), height(to));
        if (a > 0.0) != (b > 0.0) {
            crossings.push(from.lerp(to, a / (a - b)));
        }
    }
    crossings.sort_by(|p, q| p.dot(along).total_cmp(&q.dot(along)));
    let pairs = crossings.chunks_exact(2);
    pairs.map(|pair| [pair[0], pair[1]]).collect()
}

/// The range of distances of places from a plane through `place`.
fn extent(points: &[DVec3], normal: DVec3, place: DVec3) -> (f64, f64) {
    points
        .iter()
        .map(|&point| normal.dot(point - place))
        .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), height| {
            (low.min(height), high.max(height))
        })
}

/// The corners of a plane's section of a convex occluder.
fn section(faces: &[Vec<DVec3>], normal: DVec3, place: DVec3, nothing: f64) -> Vec<DVec3> {
    let height = |point: DVec3| normal.dot(point - place);
    let mut corners: Vec<DVec3> = Vec::new();
    let mut add = |corner: DVec3| {
        if corners.iter().all(|c| c.distance(corner) > nothing) {
            corners.push(corner);
        }
    };
    for face in faces {
        for (i, &from) in face.iter().enumerate() {
            let to = face[(i + 1) % face.len()];
            let (a, b) = (height(from), height(to));
            if a.abs() <= nothing {
                add(from);
            }
            if (a > nothing && b < -nothing) || (a < -nothing && b > nothing) {
                add(from.lerp(to, a / (a - b)));
            }
        }
    }
    corners
}
