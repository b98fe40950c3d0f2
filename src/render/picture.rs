//! A finished picture on the CPU: linear color, display color and AOV planes.

use crate::{
    gpu::{Gpu, GpuError, readback},
    scene::desc::CameraDesc,
    world::World,
};

use super::{RenderError, Renderer, aov::Aov, stats::FrameStats, targets::Target};

/// Pixels of one quantity, row by row from the top.
#[derive(Clone, Debug, PartialEq)]
pub struct Plane {
    /// Of the AOV.
    pub name: &'static str,
    /// Channel names, such as `R`, `G`, `B`.
    pub channels: &'static [&'static str],
    /// `width * height * channels` values.
    pub data: PlaneData,
}

/// A plane's values.
#[derive(Clone, Debug, PartialEq)]
pub enum PlaneData {
    /// Measured quantities.
    F32(Vec<f32>),
    /// Numbers of things.
    U32(Vec<u32>),
}

/// What a render gives.
#[derive(Clone, Debug, PartialEq)]
pub struct Picture {
    /// Pixels.
    pub size: [u32; 2],
    /// Linear radiance, RGBA, exposure not applied, mean of the sub-frames.
    pub color: Vec<f32>,
    /// Display color, RGBA, sRGB.
    pub display: Vec<u8>,
    /// The AOVs that were asked for.
    pub planes: Vec<Plane>,
    /// What it cost.
    pub stats: FrameStats,
}

impl Renderer {
    /// Renders and reads back one picture.
    ///
    /// # Errors
    /// As [`Renderer::render`].
    pub fn picture(
        &mut self,
        gpu: &Gpu,
        world: &World,
        camera: &CameraDesc,
        aovs: &[Aov],
    ) -> Result<Picture, RenderError> {
        let stats = self.render(gpu, world, camera)?;
        let mut color: Vec<f32> = self.read(gpu, self.color())?;
        let scale = 1.0 / stats.samples as f32;
        for pixel in color.chunks_exact_mut(4) {
            for channel in &mut pixel[..3] {
                *channel *= scale;
            }
            pixel[3] = 1.0;
        }
        let planes = aovs
            .iter()
            .map(|aov| aov.plane(gpu, self, camera))
            .collect::<Result<_, _>>()?;
        Ok(Picture {
            size: stats.size,
            color,
            display: self.read(gpu, Target::Display)?,
            planes,
            stats,
        })
    }

    /// The values of a target; zeros where this frame does not write it.
    ///
    /// # Errors
    /// What reading back says.
    pub fn read<T: bytemuck::Pod>(&self, gpu: &Gpu, target: Target) -> Result<Vec<T>, GpuError> {
        let size = self.targets().size;
        let Some(texture) = self.targets().texture(target) else {
            let bytes = target.pixel_bytes() * u64::from(size[0]) * u64::from(size[1]);
            return Ok(vec![T::zeroed(); bytes as usize / size_of::<T>()]);
        };
        Ok(bytemuck::pod_collect_to_vec(&readback::read_texture(
            gpu, texture,
        )?))
    }
}
