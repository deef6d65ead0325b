//! What of an emitter is seen, judged from outside the kernel: references made
//! by other systems, laws, degenerate placements, leaks, capacities.

#[path = "visibility/lit.rs"]
mod lit;
#[path = "visibility/references.rs"]
mod references;
