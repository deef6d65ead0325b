//! The job this firmware was built for, as build.rs wrote it.

include!(concat!(env!("OUT_DIR"), "/job.rs"));
