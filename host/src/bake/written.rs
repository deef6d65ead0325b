//! What stands in place of occluders.

/// What samples receive of emitters, as a host wrote it down.
#[derive(Clone, Debug, Default)]
pub(super) struct Written {
    /// How many codes there are.
    pub(super) codes: usize,
    /// How many terms of a matrix there are, and the bits of a factor.
    pub(super) terms: usize,
    pub(super) bits: u32,
    /// The codes, or the terms.
    pub(super) bytes: Vec<u8>,
    /// Visible fractions of luminaires; none where all is seen.
    pub(super) fractions: Vec<u16>,
    /// Responses, by luminaire, channel and sample.
    pub(super) responses: Vec<u16>,
    /// Of receivers, where there are terms, or of luminaires and channels.
    pub(super) scales: Vec<f32>,
}
