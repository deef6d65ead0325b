//! Form factors whose bits must be the same everywhere: the same inputs on the
//! device and on the host, from integers alone.

/// A receiver and an emitter of up to [`Case::MOST`] vertices.
pub(crate) struct Case {
    /// Position of the receiver.
    pub(crate) position: [f32; 3],
    /// Its normal, of any length.
    pub(crate) normal: [f32; 3],
    corners: [[f32; 3]; Self::MOST],
    count: usize,
}

impl Case {
    /// The most vertices.
    pub(crate) const MOST: usize = 8;

    /// The emitter.
    pub(crate) fn vertices(&self) -> &[[f32; 3]] {
        self.corners.split_at(self.count).0
    }
}

/// xorshift64 (Marsaglia 2003).
pub(crate) struct Cases(u64);

impl Cases {
    /// The first case onwards.
    pub(crate) const fn new() -> Self {
        Self(0x1505_1993_0521_1992)
    }

    fn bits(&mut self) -> u32 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        (self.0 >> 32) as u32
    }

    /// On [-1, 1): 24 bits, exact in `f32`.
    fn signed(&mut self) -> f32 {
        (self.bits() as i32 >> 8) as f32 / 8_388_608.0
    }

    fn vector(&mut self, scale: f32) -> [f32; 3] {
        [
            self.signed() * scale,
            self.signed() * scale,
            self.signed() * scale,
        ]
    }

    /// The next case: 3 to 8 vertices around a place about 2 from the receiver,
    /// 2⁻¹² to 2¹ across, in any order and no plane, so that every branch of
    /// every rung is taken, also those for loops that are none.
    pub(crate) fn following(&mut self) -> Case {
        let position = self.vector(0.5);
        let normal = self.vector(1.0);
        let centre = self.vector(2.0);
        let scale = (1_u32 << (self.bits() % 14)) as f32 / 4096.0;
        let mut corners = [[0.0; 3]; Case::MOST];
        for corner in &mut corners {
            let [x, y, z] = self.vector(scale);
            *corner = [centre[0] + x, centre[1] + y, centre[2] + z];
        }
        Case {
            position,
            normal,
            corners,
            count: 3 + (self.bits() % 6) as usize,
        }
    }
}

/// FNV-1a of 64 bits over the bits of answers, four bytes each, low first.
pub(crate) struct Hash(pub(crate) u64);

impl Hash {
    /// Of nothing.
    pub(crate) const fn new() -> Self {
        Self(0xcbf2_9ce4_8422_2325)
    }

    /// Takes the bits of an answer in.
    pub(crate) fn add(&mut self, answer: u32) {
        for byte in answer.to_le_bytes() {
            self.0 = (self.0 ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3);
        }
    }
}
