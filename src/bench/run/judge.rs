//! Scores of a variant's picture against the reference.

use std::path::Path;

use crate::{
    parameter::{MAX_STEPS, Variant},
    score::{CAMERA_MOVE_U, Changes, Errors, Hits, PLANES, Reference, View},
    seams::{self, Looked},
};
use reflet_metric::hits::CauseTally;
use reflet_render::Renderer;
use reflet_scene::{
    desc::{CameraDesc, Method, ReflectionDesc},
    diagnostic::Diagnostic,
};

use super::{Bench, BenchError, Subject, Sweep, flicker::FrameChange};

/// Scores of a variant's picture.
pub(super) struct Judged {
    pub(super) errors: Errors,
    pub(super) since: Option<FrameChange>,
    pub(super) verdicts: Option<Vec<CauseTally>>,
    pub(super) changes: Option<Changes>,
    pub(super) probe_seam_step: Option<f64>,
}

impl Bench<'_> {
    /// Renders the reference picture: of the subject's truth, otherwise with the renderer of method `rt`.
    pub(super) fn reference(
        &self,
        subject: &Subject,
        rt: &mut Renderer,
        size: [u32; 2],
    ) -> Result<Reference, BenchError> {
        let reflection = self.protocol.reference(&subject.reflection);
        let mut of_truth = match &subject.truth {
            Some(truth) => {
                // A truth with method `path` keeps its own settings, any other uses the reference's.
                let own = match truth.reflection.method {
                    Method::Path => truth.reflection,
                    _ => reflection,
                };
                Some(truth.renderer(self.gpu, self.library, &own, size)?)
            }
            None => None,
        };
        let shown = subject.truth.as_deref().unwrap_or(subject);
        let rt = of_truth.as_deref_mut().unwrap_or(rt);
        rt.set_reflection_parameters(&reflection);
        let picture = rt.picture(self.gpu, &shown.camera, &PLANES)?;
        let mut reference = Reference::new(&picture).map_err(|why| {
            let scene = Path::new(&subject.name);
            let message = format!("the reference cannot judge anything: {why}");
            BenchError::File(Box::new(Diagnostic::in_file("bad-pixels", scene, message)))
        })?;
        if self.moves(subject) {
            reference.moved = self.moved(subject, rt)?;
        }
        Ok(reference)
    }

    /// Whether pictures of a moved camera are needed: only for failure modes that are still scenes.
    fn moves(&self, subject: &Subject) -> bool {
        self.protocol.sweep == Sweep::Rules && !subject.motion && subject.truth.is_none()
    }

    /// Ends of the mirror rays with the camera moved by [`CAMERA_MOVE_U`].
    fn moved(
        &self,
        subject: &Subject,
        renderer: &mut Renderer,
    ) -> Result<Option<Hits>, BenchError> {
        let camera = &subject.camera;
        let right = (camera.target - camera.eye).cross(camera.up);
        let by = right.normalize_or_zero() * CAMERA_MOVE_U * renderer.unit_m();
        let moved = CameraDesc {
            eye: camera.eye + by,
            target: camera.target + by,
            ..camera.clone()
        };
        let picture = renderer.picture(self.gpu, &moved, &PLANES)?;
        Ok(Hits::from_planes(&picture.planes))
    }

    /// Errors, false accepts and false rejects of one variant's picture, or the reason why there are none.
    pub(super) fn judge(
        &self,
        subject: &Subject,
        variant: &Variant,
        renderer: &mut Renderer,
        reference: &Reference,
        size: [u32; 2],
    ) -> Result<Result<Judged, String>, BenchError> {
        let planes = match (variant.scale == 1.0, variant.method.looks_up()) {
            (true, true) => [&PLANES[..], &seams::PLANES].concat(),
            (true, false) => PLANES.to_vec(),
            (false, _) => Vec::new(),
        };
        renderer.set_reflection_parameters(&variant.reflection);
        let picture = renderer.picture(self.gpu, &subject.camera, &planes)?;
        let looked = variant.method.looks_up().then_some(Looked {
            world: &subject.world,
            camera: &subject.camera,
            settings: &variant.reflection,
            picture: &picture,
        });
        let hits = Hits::from_planes(&picture.planes);
        let scored = View::new(&picture, size).and_then(|view| {
            let since = (self.cache.flicker).push(subject, variant, &view, reference)?;
            let answers = variant.method.answers_all();
            let seam = looked.and_then(|looked| looked.seam_step(&view, reference));
            Ok((
                reference.errors(&view, hits.as_ref(), answers)?,
                since,
                seam,
            ))
        });
        let mut changes = None;
        if let (Some(hits), true) = (&hits, self.moves(subject)) {
            let moved = self.moved(subject, renderer)?;
            changes = moved.and_then(|moved| reference.changes(hits, &moved));
        }
        let mut verdicts = None;
        // The rays of a truth differ from this picture's.
        let is_asked = variant.method.marches() && subject.truth.is_none();
        if let (Some(hits), true) = (&hits, is_asked) {
            renderer.set_reflection_parameters(&ReflectionDesc {
                steps: MAX_STEPS,
                ..variant.reflection
            });
            let planes = renderer.crossings(self.gpu, &subject.camera, &PLANES)?;
            let unit_m = renderer.unit_m();
            let length_m = variant.reflection.ray_length_u * unit_m;
            verdicts = Hits::from_planes(&planes)
                .map(|crossings| reference.verdicts(hits, &crossings, length_m, unit_m));
            renderer.set_reflection_parameters(&variant.reflection);
        }
        let scored = scored.map_err(|error| error.to_string());
        Ok(scored.and_then(|(errors, since, probe_seam_step)| {
            Ok(Judged {
                errors,
                since,
                verdicts: verdicts.transpose()?,
                changes,
                probe_seam_step,
            })
        }))
    }
}
