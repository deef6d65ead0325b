//! The job this firmware was built for, as build.rs wrote it.

/// The square root that the baked scene takes.
#[cfg(not(integer_tables))]
pub(crate) use crate::root::Chosen as Root;

include!(concat!(env!("OUT_DIR"), "/job.rs"));
