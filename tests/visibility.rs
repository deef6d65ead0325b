//! What of an emitter is seen, judged from outside the kernel: references made
//! by other systems, laws, degenerate placements, leaks, capacities.

#[path = "visibility/laws.rs"]
mod laws;
#[path = "visibility/leaks.rs"]
mod leaks;
#[path = "visibility/lit.rs"]
mod lit;
#[path = "visibility/placements.rs"]
mod placements;
#[path = "visibility/published.rs"]
mod published;
#[path = "visibility/random.rs"]
mod random;
#[path = "visibility/references.rs"]
mod references;
#[path = "visibility/suite.rs"]
mod suite;
