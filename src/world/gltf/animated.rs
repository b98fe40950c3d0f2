//! Sets of nodes that the animations of a file move.

use std::collections::HashSet;

use super::Clip;
use crate::animation::Property;

/// Nodes that the animations of a file move, whether or not these are played.
#[derive(Default)]
pub struct Animated {
    /// Nodes with animated visibility.
    pub visibility: HashSet<usize>,
    /// Nodes with an animated transform.
    pub places: HashSet<usize>,
    /// Nodes whose weights of morph targets are animated.
    pub weights: HashSet<usize>,
}

impl Animated {
    /// Nodes that these animations move.
    pub fn by(clips: &[Clip]) -> Self {
        let mut animated = Self::default();
        for animation in clips.iter().filter_map(|c| c.animation.as_ref().ok()) {
            for channel in &animation.channels {
                let moved = match channel.property {
                    Property::Visible => &mut animated.visibility,
                    _ => &mut animated.places,
                };
                moved.insert(channel.node);
            }
            let weights = animation.weights.iter().map(|track| track.node);
            animated.weights.extend(weights);
        }
        animated
    }
}
