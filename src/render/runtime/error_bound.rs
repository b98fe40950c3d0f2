//! Number of sub-frames that a picture's error bound takes: `samples = { error = … }`.

use super::{Session, ViewOverrides};
use crate::{ErrorEstimate, PendingPicture, PictureRequest, RenderError, SoFar};
use reflet_scene::desc::{ErrorBound, Samples};

/// Number of sub-frames of the first picture. From it on, all counts share their pipelines.
const FIRST: u32 = 16;

impl Session {
    /// Error bound of the scene, unless the view has a number of its own.
    pub(super) fn error_bound(&self) -> Option<ErrorBound> {
        match (
            self.view.samples,
            self.view.draft,
            self.loaded.scene.image.samples,
        ) {
            (None, None, Samples::UntilError(bound)) => Some(bound),
            _ => None,
        }
    }

    /// Renders the picture with more and more sub-frames, each time from the first, until its estimated error is within
    /// the bound: a picture of a written number of sub-frames has the same bytes. The counts follow from the posed
    /// frame alone.
    pub(super) fn begin_within(
        &mut self,
        bound: ErrorBound,
        request: PictureRequest,
    ) -> Result<PendingPicture, RenderError> {
        let view = self.view.clone();
        let picture = self.search(bound, request, &view);
        // The renderer keeps the count, for measurements of this picture.
        self.view = view;
        picture
    }

    fn search(
        &mut self,
        bound: ErrorBound,
        request: PictureRequest,
        view: &ViewOverrides,
    ) -> Result<PendingPicture, RenderError> {
        let gpu = self.gpu.clone();
        let mut count = FIRST.min(bound.at_most);
        let mut error = None;
        loop {
            self.set_view(ViewOverrides {
                samples: Some(count),
                ..view.clone()
            })?;
            let with_error = |so_far: &SoFar<'_>| {
                let each_sample = request.each_sample;
                each_sample.map_or(Ok(()), |told| told(&SoFar { error, ..*so_far }))
            };
            let mut picture = self.begin_counted(PictureRequest {
                estimates_error: true,
                each_sample: Some(&with_error),
                ..request
            })?;
            let Some(estimate) = picture.estimate_error(&gpu)? else {
                return Ok(picture);
            };
            error = Some(estimate);
            match next_count(count, estimate, bound) {
                Some(next) => count = next,
                None => return Ok(picture),
            }
        }
    }
}

/// Number of sub-frames to try after one whose error is too large; `None` where the bound is reached, or there may be
/// no more. Errors of random numbers fall with the square root of their number, errors of evenly spread numbers faster.
fn next_count(count: u32, estimate: ErrorEstimate, bound: ErrorBound) -> Option<u32> {
    if estimate.error <= bound.error || count >= bound.at_most {
        return None;
    }
    let needed = f64::from(count) * f64::from(estimate.error / bound.error).powi(2);
    let (least, most) = (count + count / 2, 4 * count);
    let next = (needed as u32).clamp(least, most).next_multiple_of(8);
    Some(next.min(bound.at_most))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn next(count: u32, error: f32) -> Option<u32> {
        let bound = ErrorBound {
            error: 0.01,
            at_most: 1000,
        };
        let estimate = ErrorEstimate {
            error,
            tile: [0, 0],
            specks: 0,
        };
        next_count(count, estimate, bound)
    }

    #[test]
    fn counts_grow_by_the_square_of_the_missing_accuracy() {
        assert_eq!(next(16, 0.01), None);
        assert_eq!(next(16, 0.0101), Some(24), "half as many again at least");
        assert_eq!(next(16, 0.015), Some(40), "16 · 2.25 = 36, rounded up");
        assert_eq!(next(16, 5.0), Some(64), "four times at most");
        assert_eq!(next(900, 0.02), Some(1000));
        assert_eq!(next(1000, 0.02), None, "no more are allowed");
        assert_eq!(next(16, f32::INFINITY), Some(64));
    }
}
