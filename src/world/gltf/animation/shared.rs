//! Samplers that channels share: each is decoded once.

use std::sync::Arc;

use glam::DVec4;

use super::{Fault, Reader, accessor, fault, finite};
use crate::{
    animation::{Interpolation, Property, Sampler},
    gltf::{schema, uri::shorten},
};

/// Kind of values that are read from an accessor.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(super) enum Kind {
    /// Values of a node.
    Node(Property),
    /// Weights of so many morph targets.
    Weights(usize),
    /// Numbers of so many components, times the bits of a factor.
    Numbers(usize, u64),
}

/// Accessors of the times and values of a sampler, its interpolation and the kind of its values.
pub(super) type SamplerKey = (usize, usize, Option<String>, Kind);

/// Values of the keys of a sampler, and their interpolation.
pub(super) type Keys = (Vec<DVec4>, Interpolation);

impl Reader<'_> {
    /// The samplers that `read` makes of the key times and values of a file's sampler, once for all channels that share
    /// it: their keys are taken from the budget.
    pub(super) fn once(
        &mut self,
        sampler: &schema::AnimationSampler,
        kind: Kind,
        read: impl FnOnce(&Self, &[f32], Interpolation) -> Result<Vec<Keys>, Fault>,
    ) -> Result<Arc<[Sampler]>, Fault> {
        let key = (
            sampler.input,
            sampler.output,
            sampler.interpolation.clone(),
            kind,
        );
        if let Some(known) = self.samplers.get(&key) {
            return Ok(known.clone());
        }
        let interpolation = interpolation(sampler)?;
        let times_s = self.times(sampler.input).map_err(|f| f.placed("input"))?;
        let keys = read(self, &times_s, interpolation)?;
        let bytes: usize = keys
            .iter()
            .map(|(values, _)| size_of_val(values.as_slice()))
            .sum();
        self.data.budget.take(bytes as u64)?;
        let sampler = |(values, interpolation): Keys| Sampler {
            times_s: times_s.clone(),
            values: values.into(),
            interpolation,
        };
        let samplers: Arc<[Sampler]> = keys.into_iter().map(sampler).collect();
        self.samplers.insert(key, samplers.clone());
        Ok(samplers)
    }

    fn times(&mut self, input: usize) -> Result<Arc<[f32]>, Fault> {
        if let Some(known) = self.times.get(&input) {
            return Ok(known.clone());
        }
        let times = self.data.floats::<1>(input, accessor::float_only)?;
        let times: Arc<[f32]> = times.into_iter().map(|[t]| t).collect();
        if !finite(&times) || times.first().is_some_and(|t| *t < 0.0) {
            return Err(fault("times must be finite and not negative"));
        }
        if let Some(i) = times.windows(2).position(|pair| pair[1] <= pair[0]) {
            return Err(fault(format!(
                "times must increase, but {} follows {} at position {}",
                times[i + 1],
                times[i],
                i + 1
            )));
        }
        self.times.insert(input, times.clone());
        Ok(times)
    }
}

/// Checks that a sampler has as many values as its keys need.
pub(super) fn check_count(
    values: &[DVec4],
    times_s: &[f32],
    interpolation: Interpolation,
) -> Result<(), Fault> {
    let (keys, found) = (times_s.len(), values.len());
    let expected = keys.saturating_mul(interpolation.values_per_key());
    match found == expected {
        true => Ok(()),
        false => Err(fault(format!(
            "{keys} keys need {expected} output values, there are {found}"
        ))),
    }
}

fn interpolation(sampler: &schema::AnimationSampler) -> Result<Interpolation, Fault> {
    match sampler.interpolation.as_deref() {
        None | Some("LINEAR") => Ok(Interpolation::Linear),
        Some("STEP") => Ok(Interpolation::Step),
        Some("CUBICSPLINE") => Ok(Interpolation::Cubic),
        Some(other) => {
            let text = format!("interpolation \"{}\" is unknown", shorten(other));
            Err(fault(text))
        }
    }
}
