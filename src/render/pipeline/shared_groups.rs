//! Bind groups 0 (frame) and 1 (scene), which all passes share.

use reflet_gpu::{Gpu, GpuError, GroupLayout, Shader, ShaderModuleInfo};

use super::resources::Resources;

/// Bind groups that all passes share.
#[derive(Debug)]
pub struct SharedGroups {
    /// Layouts of groups 0 and 1.
    pub layouts: [GroupLayout; 2],
    /// Bind groups 0 and 1.
    pub groups: [wgpu::BindGroup; 2],
    /// Empty group for passes that do not use group 0 or 1.
    pub empty: (GroupLayout, wgpu::BindGroup),
}

impl SharedGroups {
    /// Creates groups 0 and 1 with every binding that any of these shaders uses.
    ///
    /// # Errors
    /// Conflicting declarations of a binding, or a name without a resource.
    pub fn new(
        gpu: &Gpu,
        shaders: &[&ShaderModuleInfo],
        resources: Resources<'_>,
    ) -> Result<Self, GpuError> {
        let frame = GroupLayout::new(gpu, "frame", shaders, 0)?;
        let scene = GroupLayout::new(gpu, "scene", shaders, 1)?;
        let empty = GroupLayout::new(gpu, "empty", &[], 0)?;
        let (uniforms, maps) = (resources.uniforms, resources.maps);
        let frame_group = frame.bind_with(gpu, |name| {
            let panorama = resources.scene.panorama.as_ref();
            uniforms
                .resource(gpu, name)
                .or_else(|| maps.resource(name))
                .or_else(|| panorama?.resource(name))
        })?;
        let scene_group = scene.bind_with(gpu, |name| resources.scene.resource(name))?;
        let empty_group = empty.bind(gpu, &[])?;
        Ok(Self {
            layouts: [frame, scene],
            groups: [frame_group, scene_group],
            empty: (empty, empty_group),
        })
    }

    /// Layout of group 0 or 1 for a shader: the shared one if the shader uses the group, else the empty one.
    pub fn layout_for(&self, shader: &Shader, group: usize) -> &GroupLayout {
        if is_used(shader, group) {
            &self.layouts[group]
        } else {
            &self.empty.0
        }
    }

    /// Group that matches [`Self::layout_for`].
    pub fn group_for(&self, used: bool, group: usize) -> &wgpu::BindGroup {
        if used {
            &self.groups[group]
        } else {
            &self.empty.1
        }
    }
}

/// Whether any entry point of a shader uses this group.
pub fn is_used(shader: &Shader, group: usize) -> bool {
    let mut bindings = shader.info.bindings.iter();
    bindings.any(|b| b.group as usize == group)
}
