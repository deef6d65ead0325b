//! How far a filter must reach, from the spacing of samples alone.

/// The radius in metres of a cone filter over `samples` samples on `area` m²:
/// √(2 area/samples), so that a circle of that radius holds 2π samples on
/// average. It knows nothing of the light, and nothing of the reference.
///
/// 0 where there are no samples. Where samples are sparser than average the
/// kernel widens the filter by itself.
pub(super) fn filter_radius(area: f64, samples: usize) -> f64 {
    if samples == 0 {
        0.0
    } else {
        (2.0 * area / samples as f64).sqrt()
    }
}
