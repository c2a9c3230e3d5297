//! A generator of its own (PCG XSH-RR 64/32, O'Neill 2014): the tests share none with the crate.

pub(crate) struct Random(u64);

impl Random {
    pub(crate) fn new(seed: u64) -> Self {
        let mut random = Self(seed.wrapping_add(0x1405_7B7E_F767_814F));
        random.bits();
        random
    }

    pub(crate) fn bits(&mut self) -> u32 {
        let old = self.0;
        self.0 = old.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        let mixed = (((old >> 18) ^ old) >> 27) as u32;
        mixed.rotate_right((old >> 59) as u32)
    }

    /// Uniform in [0, 1).
    pub(crate) fn unit(&mut self) -> f64 {
        let bits = (u64::from(self.bits()) << 32 | u64::from(self.bits())) >> 11;
        bits as f64 / (1_u64 << 53) as f64
    }

    /// Uniform in [low, high).
    pub(crate) fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.unit()
    }

    /// Uniform in the cube of half side `half`.
    pub(crate) fn in_cube(&mut self, half: f64) -> [f64; 3] {
        std::array::from_fn(|_| self.between(-half, half))
    }

    /// Two different sorted numbers in [low, high).
    pub(crate) fn range(&mut self, low: f64, high: f64) -> [f64; 2] {
        let (a, b) = (self.between(low, high), self.between(low, high));
        [a.min(b), a.max(b) + 1e-3]
    }
}
