//! Tables as bytes, and what makes changed ones look sound.

use isolux::scene::records::{Header, checksum};
use std::mem::offset_of;

/// Bytes at an address that is a multiple of four.
pub(crate) struct Words(Vec<u32>);

impl Words {
    pub(crate) fn new(bytes: &[u8]) -> Self {
        let mut words = vec![0_u32; bytes.len().div_ceil(4)];
        zerocopy::IntoBytes::as_mut_bytes(&mut words[..])[..bytes.len()].copy_from_slice(bytes);
        Self(words)
    }

    pub(crate) fn bytes(&self, length: usize) -> &[u8] {
        &zerocopy::IntoBytes::as_bytes(&self.0[..])[..length]
    }
}

/// Makes the checksum that of the bytes behind it.
pub(crate) fn seal(bytes: &mut [u8]) {
    let field = offset_of!(Header, checksum);
    if bytes.len() >= field + 4 {
        let sum = checksum(&bytes[field + 4..]);
        bytes[field..field + 4].copy_from_slice(&sum.to_le_bytes());
    }
}

/// Makes the length that of the bytes.
pub(crate) fn lengthened(bytes: &mut [u8]) {
    let field = offset_of!(Header, bytes);
    let length = (bytes.len() as u32).to_le_bytes();
    if let Some(stored) = bytes.get_mut(field..field + 4) {
        stored.copy_from_slice(&length);
    }
}
