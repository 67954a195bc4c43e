//! What the averaging of F-bar takes of a body's particles.

/// Positions and volumes of all particles, and the rates of growth of consecutive ones, to write.
pub struct Dilations<'a, const D: usize> {
    position: [&'a [f64]; D],
    /// Volumes [m³].
    pub volume: &'a [f64],
    rates: &'a mut [f64],
    first: usize,
}

impl<'a, const D: usize> Dilations<'a, D> {
    /// Those of all particles.
    pub fn new(position: [&'a [f64]; D], volume: &'a [f64], rates: &'a mut [f64]) -> Self {
        Self { position, volume, rates, first: 0 }
    }

    /// Those of the particles before `at` and from there on.
    pub fn split(self, at: usize) -> (Self, Self) {
        let Self { position, volume, rates, first } = self;
        let (left, right) = rates.split_at_mut(at - first);
        let part = |rates, first| Self { position, volume, rates, first };
        (part(left, first), part(right, at))
    }

    /// Position of particle k [m].
    pub fn position(&self, k: usize) -> [f64; D] {
        self.position.map(|column| column[k])
    }

    /// Rate of growth of particle k [1/s].
    pub fn rate(&self, k: usize) -> f64 {
        self.rates[k - self.first]
    }

    /// The same, to write.
    pub fn rate_mut(&mut self, k: usize) -> &mut f64 {
        &mut self.rates[k - self.first]
    }
}
