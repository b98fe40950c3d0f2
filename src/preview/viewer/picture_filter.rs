//! Filter of pictures at rest.

use std::{fmt, sync::Arc};

use reflet_render::Picture;

/// Filter of finished pictures, such as a denoiser.
#[derive(Clone)]
pub struct PictureFilter(Arc<Filter>);

type Filter = dyn Fn(&mut Picture) -> Result<(), String> + Send + Sync;

impl PictureFilter {
    /// Filter by a function that changes the display color of a picture with linear radiance and guides, or returns an
    /// error message.
    pub fn new(
        filter: impl Fn(&mut Picture) -> Result<(), String> + Send + Sync + 'static,
    ) -> Self {
        Self(Arc::new(filter))
    }

    /// Filters a picture.
    ///
    /// # Errors
    /// Message of the filter.
    pub fn apply(&self, picture: &mut Picture) -> Result<(), String> {
        (self.0)(picture)
    }
}

impl fmt::Debug for PictureFilter {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("PictureFilter")
    }
}
