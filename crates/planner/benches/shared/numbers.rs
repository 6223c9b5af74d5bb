//! Numbers from a seed.

/// Numbers from a seed: a linear congruential generator, its upper half.
pub struct Numbers(pub u64);

impl Numbers {
    /// The next number below `limit`.
    pub const fn below(&mut self, limit: usize) -> usize {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 33) as usize % limit
    }
}
