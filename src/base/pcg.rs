//! Pseudo-random numbers that are the same on all machines and in the shaders: PCG, in the form RXS-M-XS of 32 bits
//! (O'Neill 2014), as a hash after Jarzynski & Olano 2020, "Hash Functions for GPU Rendering".

/// Hash of a number, the same as `hash` in `shaders/lib/hash.wgsl`. It maps the numbers of 32 bits one to one.
pub const fn hash(x: u32) -> u32 {
    let state = following(x);
    let word = ((state >> ((state >> 28) + 4)) ^ state).wrapping_mul(277_803_737);
    (word >> 22) ^ word
}

/// State after a state, of the linear congruential generator below the hash.
const fn following(state: u32) -> u32 {
    state.wrapping_mul(747_796_405).wrapping_add(2_891_336_453)
}

/// A sequence of numbers, which returns to its start after 2³² of them.
#[derive(Clone, Copy, Debug)]
pub struct Pcg(u32);

impl Pcg {
    /// The sequence that starts at a state: other states are other places in the same circle of numbers.
    pub const fn new(state: u32) -> Self {
        Self(state)
    }

    /// The next number.
    pub const fn number(&mut self) -> u32 {
        let number = hash(self.0);
        self.0 = following(self.0);
        number
    }

    /// The next number as one from 0 to below 1, a multiple of 2⁻³².
    pub fn unit(&mut self) -> f64 {
        f64::from(self.number()) / (f64::from(u32::MAX) + 1.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_sequence_is_the_hash_along_the_generator_below_it() {
        let mut sequence = Pcg::new(7);
        let states = std::iter::successors(Some(7), |state| Some(following(*state)));
        for state in states.take(100) {
            assert_eq!(sequence.number(), hash(state));
        }
    }

    #[test]
    fn numbers_fill_the_range_evenly() {
        let mut sequence = Pcg::new(1);
        let numbers: Vec<f64> = (0..10_000).map(|_| sequence.unit()).collect();
        assert!(numbers.iter().all(|n| (0.0..1.0).contains(n)));
        // Expected: 625 in each sixteenth, with a standard deviation of 24.
        for part in 0..16 {
            let range = f64::from(part) / 16.0..f64::from(part + 1) / 16.0;
            let count = numbers.iter().filter(|n| range.contains(n)).count();
            assert!((505..745).contains(&count), "part {part}: {count}");
        }
    }
}
