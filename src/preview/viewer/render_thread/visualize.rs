//! Conversion of each view channel to a picture, with the legend of its colors.

use super::{pixels::Pixels, worker::Worker};
use crate::viewer::{
    frame_texture::FrameTexture,
    picture_filter::PictureFilter,
    protocol::{Side, View, Visualization},
    view_channel::{
        BACKGROUND_GRAY, CUBE_CROSS, ShadowMapChoice, ViewChannel, aov_legend, distance_legend,
        ray_order,
    },
};
use reflet_gpu::GpuError;
use reflet_render::{
    Plane, PlaneData, RenderError,
    lighting::lights::{CUBE_FACES, has_cube_map},
    picture::aov_view,
    pipeline::targets::Target,
    renderer::stats::FrameStats,
};

/// Longest edge of a face in an unfolded cube map, pixels.
const FACE_PX: u32 = 512;
/// Color of empty texels of a shadow map.
const EMPTY_SHADOW: [u8; 4] = [24, 36, 84, 255];

impl Worker {
    /// Visualizes a side of the last rendered frame; `old` is reused where its size fits.
    pub(super) fn visualize(
        &self,
        side: Side,
        view: &View,
        stats: FrameStats,
        old: Option<FrameTexture>,
    ) -> Result<Visualization, RenderError> {
        let display = self.live.renderer().targets().texture(Target::Display);
        let display = display.filter(|_| !self.denoises(view));
        let (texture, legend) = match (side.channel, display) {
            (ViewChannel::Picture, Some(display)) => {
                let texture = FrameTexture::of_size(&self.gpu, old, stats.size)?;
                texture.copy(&self.gpu, display)?;
                (texture, self.samples_so_far(view, &stats))
            }
            (channel, _) => {
                let (pixels, legend) = self.pixels(channel, view, &stats)?;
                let texture = FrameTexture::of_size(&self.gpu, old, pixels.size)?;
                texture.write(&self.gpu, &pixels.rgba);
                (texture, legend)
            }
        };
        Ok(Visualization {
            channel: side.channel,
            texture,
            stats,
            legend,
        })
    }

    /// Whether the picture of a view is denoised: at rest alone.
    fn denoises(&self, view: &View) -> bool {
        let can_denoise = self.denoiser.is_some() && !self.live.is_coarse();
        can_denoise && view.denoises && view.draft_ms.is_none()
    }

    /// Number of sub-frames of a picture at rest, until it has all.
    fn samples_so_far(&self, view: &View, stats: &FrameStats) -> String {
        let (samples, all) = (stats.samples, self.live.samples());
        match view.draft_ms.is_none() && samples < all {
            true => format!("{samples} of {all} samples"),
            false => String::new(),
        }
    }

    /// Denoised display color of the last rendered frame, with its legend: its sub-frames so far, and why it could not
    /// be denoised.
    fn denoised(
        &self,
        view: &View,
        stats: &FrameStats,
        denoiser: &PictureFilter,
    ) -> Result<(Pixels, String), RenderError> {
        let camera = self.camera(&view.camera);
        let renderer = self.live.renderer();
        let mut picture = renderer.rendered_picture(&self.gpu, &camera, stats.clone())?;
        let denoised = denoiser.apply(&mut picture);
        self.gpu.check_interrupt()?;
        let mut legend = self.samples_so_far(view, stats);
        if let Err(error) = denoised {
            legend += &format!("\nnot denoised: {error}");
        }
        let legend = legend.trim_start().to_owned();
        let (size, rgba) = (picture.size, picture.display);
        Ok((Pixels { size, rgba }, legend))
    }

    /// A channel of the last rendered frame, whose statistics these are, and its legend.
    pub(super) fn pixels(
        &self,
        channel: ViewChannel,
        view: &View,
        stats: &FrameStats,
    ) -> Result<(Pixels, String), RenderError> {
        let renderer = self.live.renderer();
        let size = renderer.targets().size;
        match channel {
            ViewChannel::Picture => {
                if let Some(denoiser) = self.denoiser.as_ref().filter(|_| self.denoises(view)) {
                    return self.denoised(view, stats, denoiser);
                }
                let rgba = renderer.read(&self.gpu, Target::Display)?;
                Ok((Pixels { size, rgba }, String::new()))
            }
            ViewChannel::Aov(aov) => {
                let plane = aov.plane(&self.gpu, renderer, &self.camera(&view.camera))?;
                let rgba = aov_view::view(&plane);
                Ok((Pixels { size, rgba }, aov_legend(aov, &plane)))
            }
            ViewChannel::Rays => {
                let display = renderer.read(&self.gpu, Target::Display)?;
                let (rgba, legend) = ray_order(size, renderer.ray_list(&self.gpu)?, &display);
                Ok((Pixels { size, rgba }, legend))
            }
            ViewChannel::Shadow(shadow_map) => Ok(self.shadow(shadow_map)?),
        }
    }

    fn shadow(&self, shadow_map: ShadowMapChoice) -> Result<(Pixels, String), GpuError> {
        let (world, renderer) = (self.live.world(), self.live.renderer());
        let read = |face| renderer.shadow_map(&self.gpu, shadow_map.light, face);
        let light = world.lights.get(shadow_map.light);
        let is_cube = light.is_some_and(|l| has_cube_map(&l.desc.kind));
        let (size, distances, of) = if let (true, None) = (is_cube, shadow_map.face) {
            let mut faces = Vec::new();
            for face in 0..CUBE_FACES.len() {
                faces.extend(read(face)?.map(|(edge, map)| shrunk(edge, &map)));
            }
            let (size, cross) = cube_cross(&faces);
            (size, cross, "all six faces".to_owned())
        } else {
            let face = shadow_map.face.unwrap_or(0);
            let (edge, map) = read(face)?.unwrap_or((1, vec![f32::INFINITY]));
            let of = match is_cube {
                true => format!("the face to {}", CUBE_FACES[face]),
                false => "the light's whole map".to_owned(),
            };
            ([edge; 2], map.into_iter().map(Some).collect(), of)
        };
        let known: Vec<f32> = distances.iter().copied().flatten().collect();
        let legend = format!("{of}; {}", distance_legend(&known, "blue"));
        let grays = aov_view::view(&Plane {
            name: "shadow_map".into(),
            channels: &["Z"],
            data: PlaneData::F32(known),
        });
        let mut grays = grays.chunks_exact(4);
        let texel = |distance: &Option<f32>| match (distance, distance.and_then(|_| grays.next())) {
            (Some(distance), _) if distance.is_infinite() => EMPTY_SHADOW,
            (_, Some(gray)) => [gray[0], gray[1], gray[2], 255],
            _ => [BACKGROUND_GRAY, BACKGROUND_GRAY, BACKGROUND_GRAY, 255],
        };
        let rgba = distances.iter().flat_map(texel).collect();
        Ok((Pixels { size, rgba }, legend))
    }
}

/// Downsamples a square map to at most [`FACE_PX`]: the minimum of each block.
fn shrunk(edge: u32, map: &[f32]) -> (u32, Vec<f32>) {
    let step = edge.div_ceil(FACE_PX).max(1);
    let small = edge / step;
    let nearest = |x: u32, y: u32| {
        let rows = (y * step..(y + 1) * step).map(|y| (y * edge + x * step) as usize);
        let blocks = rows.flat_map(|start| &map[start..start + step as usize]);
        blocks.copied().fold(f32::INFINITY, f32::min)
    };
    let texels = (0..small).flat_map(|y| (0..small).map(move |x| (x, y)));
    (small, texels.map(|(x, y)| nearest(x, y)).collect())
}

/// The faces of a cube map unfolded to a cross, and its size; `None` outside of the faces.
fn cube_cross(faces: &[(u32, Vec<f32>)]) -> ([u32; 2], Vec<Option<f32>>) {
    let edge = faces.first().map_or(1, |(edge, _)| *edge);
    let size = [4 * edge, 3 * edge];
    let mut cross = vec![None; (size[0] * size[1]) as usize];
    for ((_, map), [left, top]) in faces.iter().zip(CUBE_CROSS) {
        for (row, y) in map.chunks_exact(edge as usize).zip(top * edge..) {
            let start = (y * size[0] + left * edge) as usize;
            for (to, distance) in cross[start..].iter_mut().zip(row) {
                *to = Some(*distance);
            }
        }
    }
    (size, cross)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_large_map_keeps_the_nearest_of_each_block() {
        let edge = 2 * FACE_PX;
        let mut map = vec![f32::INFINITY; (edge * edge) as usize];
        map[(3 * edge + 5) as usize] = 2.0;
        map[(2 * edge + 4) as usize] = 7.0;
        let (small, shrunk) = shrunk(edge, &map);
        assert_eq!(small, FACE_PX);
        let found: Vec<_> = (shrunk.iter().enumerate())
            .filter(|(_, distance)| distance.is_finite())
            .collect();
        assert_eq!(found, [((FACE_PX + 2) as usize, &2.0)]);
    }

    #[test]
    fn an_unfolded_cube_shows_each_face_once() {
        let faces: Vec<_> = (0..6).map(|face| (2, vec![face as f32; 4])).collect();
        let (size, cross) = cube_cross(&faces);
        assert_eq!(size, [8, 6]);
        for (face, [left, top]) in CUBE_CROSS.into_iter().enumerate() {
            let at = (2 * top * size[0] + 2 * left) as usize;
            assert_eq!(cross[at], Some(face as f32));
            assert_eq!(cross[at + 1 + size[0] as usize], Some(face as f32));
        }
        assert_eq!(cross.iter().flatten().count(), 24);
    }
}
