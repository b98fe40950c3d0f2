//! The selected instance: which one a click means, what it is called, and the line around what is
//! seen of it.

use super::{
    frame_texture::FrameTexture,
    protocol::{Report, View},
    render_thread::State,
};
use crate::{
    math::Bounds,
    render::{RenderError, targets::Target},
    world::World,
};

/// Half the width of the line, pixels of a picture that is drawn at full size.
const RADIUS_PX: f32 = 2.0;
/// Its color, and how dark its rim is, which makes it seen on bright things too.
const ORANGE: [f32; 3] = [255.0, 150.0, 30.0];
const RIM: f32 = 0.5;

/// What finds an instance again in a scene that was read anew.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Mark {
    name: String,
    /// How many of the same name come before it.
    number: usize,
}

/// The selected instance in the frame that is shown.
#[derive(Clone, Debug)]
pub struct Picked {
    /// Its name; of several with the same one, also which.
    pub label: String,
    /// Index into the world's materials.
    pub material: usize,
    /// ReportContext it in world space; empty while it is hidden.
    pub bounds: Bounds,
    /// Of its mesh.
    pub triangles: usize,
    /// The line around what is seen of it, as large as the picture; `None` where nothing is.
    pub outline: Option<FrameTexture>,
}

impl Mark {
    /// Of the world's instance of this index.
    fn of(world: &World, index: usize) -> Option<Self> {
        let name = &world.instances.get(index)?.name;
        let before = world.instances[..index].iter();
        Some(Self {
            name: name.clone(),
            number: before.filter(|other| other.name == *name).count(),
        })
    }

    /// The instance, as an index into the world's, and how many have its name.
    fn find(&self, world: &World) -> Option<(usize, usize)> {
        let named = || {
            let all = world.instances.iter().enumerate();
            all.filter(|(_, other)| other.name == self.name)
        };
        let (index, _) = named().nth(self.number)?;
        Some((index, named().count()))
    }

    fn label(&self, count: usize) -> String {
        match count {
            1 => self.name.clone(),
            _ => format!("{} ({} of {count})", self.name, self.number + 1),
        }
    }
}

impl State {
    /// Selects what is at this part of a view's picture, which is drawn again if another is there.
    pub(super) fn pick(&mut self, view: &View, at: [f32; 2]) -> Result<(), RenderError> {
        let is_drawn = (self.drawn.as_ref())
            .is_some_and(|drawn| !drawn.looks_other(view) && drawn.frame == view.frame);
        if !is_drawn {
            self.render(view, view.a.method)?;
        }
        let [width, height] = self.live.renderer().targets().size;
        let ids: Vec<[u32; 2]> = self.live.renderer().read(&self.gpu, Target::Ids)?;
        let pixel = |part: f32, side: u32| ((part * side as f32) as u32).min(side - 1);
        let index = pixel(at[1], height) * width + pixel(at[0], width);
        self.mark = Mark::of(self.live.world(), ids[index as usize][0] as usize);
        let picked = self.picked_among(&ids)?;
        self.tell(Report::Picked(picked));
        Ok(())
    }

    /// Selects nothing.
    pub(super) fn unpick(&mut self) {
        self.mark = None;
        self.tell(Report::Unpicked);
    }

    /// The selected instance in the picture that was drawn last.
    pub(super) fn picked(&mut self) -> Result<Option<Picked>, RenderError> {
        if self.mark.is_none() {
            return Ok(None);
        }
        let ids: Vec<[u32; 2]> = self.live.renderer().read(&self.gpu, Target::Ids)?;
        self.picked_among(&ids)
    }

    fn picked_among(&mut self, ids: &[[u32; 2]]) -> Result<Option<Picked>, RenderError> {
        let world = self.live.world();
        let found = (self.mark.as_ref()).and_then(|mark| Some((mark, mark.find(world)?)));
        let Some((mark, (index, count))) = found else {
            self.mark = None;
            return Ok(None);
        };
        let instance = &world.instances[index];
        let label = mark.label(count);
        let (material, bounds) = (instance.material, world.bounds_of(instance));
        let triangles = world.meshes[instance.mesh].triangles.len();
        let size = self.live.renderer().targets().size;
        let whole = self.view.as_ref().map_or(size, |view| view.size);
        let radius = RADIUS_PX * (size[0] as f32 / whole[0].max(1) as f32).min(1.0);
        let inside: Vec<bool> = ids.iter().map(|ids| ids[0] as usize == index).collect();
        let outline = match outline(&inside, size, radius) {
            Some(rgba) => {
                let canvas = FrameTexture::of_size(&self.gpu, self.outline.take(), size)?;
                canvas.write(&self.gpu, &rgba);
                self.outline = Some(canvas.clone());
                Some(canvas)
            }
            None => None,
        };
        Ok(Some(Picked {
            label,
            material,
            bounds,
            triangles,
            outline,
        }))
    }
}

/// A line along the outside of what is `inside`, as RGBA with its alpha multiplied in; `None` where
/// nothing is inside.
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
    use glam::Affine3A;

    use super::*;
    use crate::world::Instance;

    fn world(names: &[&str]) -> World {
        let instance = |name: &&str| Instance {
            name: (*name).to_owned(),
            mesh: 0,
            material: 0,
            world_from_object: Affine3A::IDENTITY,
            dynamic: false,
        };
        World {
            instances: names.iter().map(instance).collect(),
            ..World::default()
        }
    }

    #[test]
    fn a_mark_finds_its_instance_in_another_scene() {
        let old = world(&["ball", "floor", "ball", "ball"]);
        let mark = Mark::of(&old, 2).expect("is there");
        assert_eq!(mark.find(&old), Some((2, 3)));
        assert_eq!(mark.label(3), "ball (2 of 3)");
        assert_eq!(mark.find(&world(&["ball", "lamp", "ball"])), Some((2, 2)));
        assert_eq!(mark.find(&world(&["floor", "ball"])), None);
        let floor = Mark::of(&old, 1).expect("is there");
        assert_eq!(floor.find(&world(&["a", "b", "floor"])), Some((2, 1)));
        assert_eq!(floor.label(1), "floor");
        assert_eq!(Mark::of(&old, u32::MAX as usize), None, "the sky");
    }

    /// ReportContext a square: the square stays free, the line follows it at its distance, and far away
    /// there is nothing.
    #[test]
    fn the_outline_runs_around_and_covers_nothing_of_it() {
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
        // The picture's edge is no edge of it.
        let whole = outline(&[true; 480], size, RADIUS_PX).expect("is seen");
        assert!(whole.iter().all(|byte| *byte == 0));
    }
}
