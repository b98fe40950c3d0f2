//! Picking: finds the clicked instance in the ids, and draws the outline of the selected
//! one.

use super::worker::Worker;
use crate::{
    viewer::{
        frame_texture::FrameTexture,
        protocol::{Picked, Report, View},
    },
    write_back::{SceneItem, picking::Clicks},
};
use reflet_render::{RenderError, pipeline::targets::Target};

/// Half the width of the outline, pixels at full resolution.
const RADIUS_PX: f32 = 2.0;
/// Outline color, and opacity of its dark rim, which keeps it visible on bright surfaces.
const ORANGE: [f32; 3] = [255.0, 150.0, 30.0];
const RIM: f32 = 0.5;

impl Worker {
    /// Selects the instance at this position of a view, which is rendered first if necessary.
    pub(super) fn pick(&mut self, view: &View, at: [f32; 2]) -> Result<(), RenderError> {
        let is_drawn = (self.rendered_view.as_ref())
            .is_some_and(|drawn| !drawn.differs_from(view) && drawn.frame == view.frame);
        if !is_drawn {
            // One sub-frame has the ids: a click does not wait for the others.
            let view = View {
                draft_ms: Some(f64::INFINITY),
                ..view.clone()
            };
            self.render(&view, view.a.method)?;
        }
        let camera = self.camera(&view.camera);
        let selected = self.item.as_ref().map(|(item, _)| *item);
        let hit = (self.clicks).hit(&self.live, &camera, at, selected)?;
        self.send(Report::Pixel(self.pixel(view, hit.pixel)?));
        self.selected = match hit.item {
            Some(SceneItem::Decal(_)) => None,
            _ => self.instance_name(hit.instance()),
        };
        self.show_item(hit.item);
        let picked = self.picked_among(&hit.ids)?;
        self.send(Report::Picked(picked));
        Ok(())
    }

    /// Clears the selection.
    pub(super) fn unpick(&mut self) {
        self.selected = None;
        (self.item, self.clicks) = (None, Clicks::default());
        self.send(Report::Unpicked);
    }

    /// The selected instance in the last rendered picture.
    pub(super) fn picked(&mut self) -> Result<Option<Picked>, RenderError> {
        if self.selected.is_none() && self.selected_decal().is_none() {
            return Ok(None);
        }
        let ids: Vec<[u32; 2]> = self.live.renderer().read(&self.gpu, Target::Ids)?;
        self.picked_among(&ids)
    }

    /// Name of the instance of this index; none of the sky.
    pub(super) fn instance_name(&self, index: usize) -> Option<String> {
        Some(self.live.world().instances.get(index)?.name.clone())
    }

    /// Index of the selected instance, if the scene still has its name.
    pub(super) fn selected_instance(&self) -> Option<usize> {
        let name = self.selected.as_ref()?;
        let mut instances = self.live.world().instances.iter();
        instances.position(|instance| instance.name == *name)
    }

    fn selected_decal(&self) -> Option<usize> {
        match self.item {
            Some((SceneItem::Decal(index), _)) => Some(index),
            _ => None,
        }
    }

    fn picked_among(&mut self, ids: &[[u32; 2]]) -> Result<Option<Picked>, RenderError> {
        if let Some(index) = self.selected_decal() {
            let Some((picked, inside)) = self.picked_decal(index, ids)? else {
                return Ok(None);
            };
            let outline = self.outlined(&inside)?;
            return Ok(Some(Picked { outline, ..picked }));
        }
        let world = self.live.world();
        let Some(index) = self.selected_instance() else {
            self.selected = None;
            return Ok(None);
        };
        let instance = &world.instances[index];
        let label = instance.name.clone();
        let (material, bounds) = (instance.material, world.bounds_of(instance));
        let mesh = &world.meshes[instance.mesh];
        let triangles = mesh.round.is_none().then_some(mesh.triangles.len());
        let inside: Vec<bool> = ids.iter().map(|ids| ids[0] as usize == index).collect();
        Ok(Some(Picked {
            label,
            material,
            bounds,
            triangles,
            outline: self.outlined(&inside)?,
        }))
    }

    /// Outline of pixels of the last picture, as a texture.
    fn outlined(&mut self, inside: &[bool]) -> Result<Option<FrameTexture>, RenderError> {
        let size = self.live.renderer().targets().size;
        let whole = self.view.as_ref().map_or(size, |view| view.size);
        let radius = RADIUS_PX * (size[0] as f32 / whole[0].max(1) as f32).min(1.0);
        Ok(match outline(inside, size, radius) {
            Some(rgba) => {
                let texture = FrameTexture::of_size(&self.gpu, self.outline.take(), size)?;
                texture.write(&self.gpu, &rgba);
                self.outline = Some(texture.clone());
                Some(texture)
            }
            None => None,
        })
    }
}

/// Outline of the `inside` mask as RGBA with premultiplied alpha; `None` where the mask is
/// empty.
fn outline(inside: &[bool], [width, height]: [u32; 2], radius: f32) -> Option<Vec<u8>> {
    let (width, height) = (width as i32, height as i32);
    let place = |x: i32, y: i32| {
        let is_there = (0..width).contains(&x) && (0..height).contains(&y);
        is_there.then(|| (y * width + x) as usize)
    };
    let rim = radius + 1.5;
    let reach = rim.ceil() as i32;
    let mut distances = vec![f32::INFINITY; inside.len()];
    let mut is_seen = false;
    for (y, x) in (0..height).flat_map(|y| (0..width).map(move |x| (y, x))) {
        if place(x, y).is_none_or(|at| !inside[at]) {
            continue;
        }
        is_seen = true;
        let near = [(1, 0), (-1, 0), (0, 1), (0, -1)];
        let mut near = near.iter().filter_map(|(dx, dy)| place(x + dx, y + dy));
        if !near.any(|at| !inside[at]) {
            continue;
        }
        for (dy, dx) in (-reach..=reach).flat_map(|y| (-reach..=reach).map(move |x| (y, x))) {
            if let Some(at) = place(x + dx, y + dy).filter(|at| !inside[*at]) {
                let distance = ((dx * dx + dy * dy) as f32).sqrt();
                distances[at] = distances[at].min(distance);
            }
        }
    }
    let texel = |distance: f32| {
        let line = (radius + 1.0 - distance).clamp(0.0, 1.0);
        let dark = RIM * (rim + 1.0 - distance).clamp(0.0, 1.0);
        let [r, g, b] = ORANGE.map(|channel| (channel * line).round() as u8);
        let alpha = line + (1.0 - line) * dark;
        [r, g, b, (255.0 * alpha).round() as u8]
    };
    is_seen.then(|| distances.into_iter().flat_map(texel).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Outline of a square: its inside stays free, the line follows it at a distance, and pixels far away
    /// stay empty.
    #[test]
    fn outline_surrounds_the_instance_without_covering_it() {
        let size = [24_u32, 20];
        let is_inside = |x: u32, y: u32| (8..14).contains(&x) && (7..12).contains(&y);
        let pixels = |y: u32| (0..size[0]).map(move |x| (x, y));
        let all: Vec<(u32, u32)> = (0..size[1]).flat_map(pixels).collect();
        let inside: Vec<bool> = all.iter().map(|(x, y)| is_inside(*x, *y)).collect();
        let rgba = outline(&inside, size, RADIUS_PX).expect("is seen");
        for ((x, y), texel) in all.into_iter().zip(rgba.chunks_exact(4)) {
            let dx = (8 - x as i32).max(x as i32 - 13).max(0);
            let dy = (7 - y as i32).max(y as i32 - 11).max(0);
            match dx * dx + dy * dy {
                0 => assert_eq!(texel, [0; 4], "{x} {y} is inside"),
                1..=4 => assert_eq!(texel, [255, 150, 30, 255], "{x} {y} is beside"),
                21.. => assert_eq!(texel, [0; 4], "{x} {y} is far"),
                _ => assert!(texel[3] > 0, "{x} {y} is near"),
            }
            assert!(texel[0] <= texel[3], "premultiplied");
        }
        assert_eq!(outline(&[false; 480], size, RADIUS_PX), None);
        // The border of the picture is no edge of the mask.
        let whole = outline(&[true; 480], size, RADIUS_PX).expect("is seen");
        assert!(whole.iter().all(|byte| *byte == 0));
    }
}
