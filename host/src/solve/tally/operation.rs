//! What is counted of a solve.

/// Names what is counted, each with the word that it has in committed costs.
macro_rules! operations {
    ($($(#[doc = $doc:literal])+ $operation:ident $name:literal,)+) => {
        /// What is counted.
        #[derive(Clone, Copy, Debug, PartialEq, Eq)]
        pub enum Operation {
            $($(#[doc = $doc])+ $operation,)+
        }

        impl Operation {
            /// All of them.
            pub const ALL: [Self; [$($name),+].len()] = [$(Self::$operation),+];

            /// What it is called in committed costs.
            pub fn name(self) -> &'static str {
                match self {
                    $(Self::$operation => $name,)+
                }
            }
        }
    };
}

operations! {
    /// Light is solved for to the end, after direct light.
    Solve "solve",
    /// An emitter shoots.
    Shot "shot",
    /// A surface is looked through for samples that it shoots at.
    ShotSurface "shot-surface",
    /// An emitter and a sample.
    Pair "pair",
    /// Those of them where the sample is in front of an emitter whose frame it is seen in.
    Facing "facing",
    /// Those of them where the emitter is a point.
    PointPair "point-pair",
    /// An emitter asked for all that it has not shot.
    Gather "gather",
    /// One of its members.
    GatherMember "gather-member",
    /// An emitter asked for the power that it has not shot.
    Unshot "unshot",
    /// One of its members.
    Member "member",
    /// A loop summed, wholly above the horizon.
    Loop "loop",
    /// A corner of such a loop.
    Corner "corner",
    /// An edge of such a loop that is seen under more than 90°; with `libm`, one whose arc
    /// cosine takes a root: under less than 60° or more than 120°.
    Obtuse "obtuse",
    /// In integers: an edge above the horizon.
    Edge "edge",
    /// In integers: an edge that crosses the horizon.
    Crossed "crossed-edge",
    /// A loop that is not wholly above the horizon.
    CutLoop "cut-loop",
    /// A sum or a difference in such a loop.
    CutSum "cut-sum",
    /// A product in such a loop.
    CutProduct "cut-product",
    /// A quotient in such a loop.
    CutQuotient "cut-quotient",
    /// A comparison in such a loop.
    CutComparison "cut-comparison",
    /// A root in such a loop.
    CutRoot "cut-root",
    /// A small loop: by the form without cancellation.
    SmallLoop "small-loop",
    /// A corner of such a loop.
    SmallCorner "small-corner",
    /// A small loop that is not wholly above the horizon.
    SmallCut "small-cut",
    /// A quotient in such a loop.
    SmallCutQuotient "small-cut-quotient",
    /// A polygon whose centre of gravity is had by a rule.
    Rule "rule",
    /// A parallelogram by the rule of few nodes.
    RuleFar "rule-far",
    /// A parallelogram by the rule of many.
    RuleNear "rule-near",
    /// A triangle of another polygon by the rule of few nodes.
    FanFar "fan-far",
    /// A triangle of another polygon by the rule of many.
    FanNear "fan-near",
    /// A look past occluders.
    Look "look",
    /// A blocker on the list of a look.
    Listed "listed",
    /// A number that a look takes from the tables.
    LookRead "look-read",
    /// A sum or a difference while a look finds what may hide.
    LookSum "look-sum",
    /// A product there.
    LookProduct "look-product",
    /// A comparison there.
    LookComparison "look-comparison",
    /// A quotient there.
    LookQuotient "look-quotient",
    /// A blocker that may hide something.
    Kept "kept",
    /// A line of such a blocker.
    Line "line",
    /// A sum or a difference while pieces are cut.
    SplitSum "split-sum",
    /// A product there.
    SplitProduct "split-product",
    /// A comparison there.
    SplitComparison "split-comparison",
    /// A quotient there: a crossing.
    SplitQuotient "split-quotient",
    /// A piece that is seen.
    Piece "piece",
    /// A corner of such a piece.
    PieceCorner "piece-corner",
    /// A sum or a difference in the form factor of a piece.
    PieceSum "piece-sum",
    /// A product there.
    PieceProduct "piece-product",
    /// A comparison there.
    PieceComparison "piece-comparison",
    /// A quotient there.
    PieceQuotient "piece-quotient",
    /// A root there.
    PieceRoot "piece-root",
    /// A code that says a point will do.
    PointCode "point-code",
    /// A code that asks for moments or contours.
    Code "code",
    /// An emitter and a surface that have terms.
    Sent "sent",
    /// An emitter and a sample that have a term.
    Entry "entry",
    /// A term that is not 0.
    Term "term",
}
