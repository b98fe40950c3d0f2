//! Where the surface of a pixel is in the picture of another frame: instances, their deformation and the camera are
//! known for each frame, so no motion has to be estimated from pictures.

use std::{collections::BTreeMap, sync::Arc};

use glam::{DAffine3, DMat3, DVec2, DVec3, UVec2};

use reflet_base::math::in_f64;
use reflet_render::{Plane, PlaneData, picture::aov::Aov, settings::view::View};
use reflet_world::{Mesh, Shared, World, deform::Deformed};

/// Largest difference of two depths, relative to them, for which pixels of the same instance show the same place.
const SAME_DEPTH: f64 = 0.05;

/// The camera and the places of all surfaces in one frame.
pub struct FramePose {
    view: View,
    /// Object to world of each instance; `None` if hidden.
    places: Vec<Option<DAffine3>>,
    /// Mesh of each instance, an index.
    mesh_of: Vec<usize>,
    meshes: Shared<Mesh>,
    deformed: BTreeMap<usize, Arc<Deformed>>,
}

impl FramePose {
    /// The pose of a world, seen by a view of it.
    pub fn new(world: &World, view: View) -> Self {
        let instances = world.instances.iter();
        Self {
            view,
            places: instances
                .map(|i| (!i.is_hidden()).then(|| in_f64(&i.world_from_object)))
                .collect(),
            mesh_of: world.instances.iter().map(|i| i.mesh).collect(),
            meshes: world.meshes.clone(),
            deformed: world.deformed.clone(),
        }
    }

    /// Instances that are elsewhere in another frame, by index: moved, hidden in either frame, or of a deformed mesh.
    pub fn moved(&self, other: &Self) -> Vec<bool> {
        let places = self.places.iter().zip(&other.places);
        (places.zip(&self.mesh_of))
            .map(|((here, there), mesh)| here != there || self.deformed.contains_key(mesh))
            .collect()
    }

    /// Corners of a triangle of a deformed mesh, in object space; `None` for a mesh that is not deformed.
    fn corners(&self, mesh: usize, triangle: u32) -> Option<[DVec3; 3]> {
        let posed = self.deformed.get(&mesh)?.posed();
        let corners = self.meshes[mesh].triangles.get(triangle as usize)?;
        Some(posed.corners(*corners).map(|p| p.as_dvec3()))
    }

    /// World-space position of a place of the picture, in pixels from its upper left corner, at a depth in meters.
    fn position(&self, place: DVec2, depth_m: f64) -> DVec3 {
        let size = UVec2::from(self.view.size).as_dvec2();
        let ndc = place / size * 2.0 - 1.0;
        let (origin, direction) = self.view.ray(DVec2::new(ndc.x, -ndc.y));
        origin + direction * depth_m
    }

    /// Place of a world-space position in the picture, in pixels from its upper left corner, and its depth in meters;
    /// `None` behind the near plane.
    fn place(&self, position: DVec3) -> Option<(DVec2, f64)> {
        let (place, depth_m) = self.view.place(position);
        if depth_m < f64::from(self.view.near_m) {
            return None;
        }
        let size = UVec2::from(self.view.size).as_dvec2();
        let place = DVec2::new(place.x, -place.y);
        Some(((place + 1.0) * 0.5 * size, depth_m))
    }

    /// Place in the picture of another frame, and depth there, of the surface that a pixel shows.
    fn in_frame(&self, other: &Self, pixel: [u32; 2], seen: Seen) -> Option<(DVec2, f64)> {
        let center = DVec2::new(f64::from(pixel[0]) + 0.5, f64::from(pixel[1]) + 0.5);
        let position = self.position(center, f64::from(seen.depth_m));
        let instance = seen.ids[0] as usize;
        let (here, there) = (
            self.places.get(instance)?.as_ref()?,
            other.places.get(instance)?.as_ref()?,
        );
        let mesh = self.mesh_of[instance];
        let own = self.corners(mesh, seen.ids[1]);
        let moved = match own.zip(other.corners(mesh, seen.ids[1])) {
            Some((own, others)) if own != others || here != there => {
                let local = here.inverse().transform_point3(position);
                there.transform_point3(carried(local, own, others))
            }
            _ if here == there => position,
            _ => there.transform_point3(here.inverse().transform_point3(position)),
        };
        other.place(moved)
    }
}

/// The point that is to one triangle as `point` is to another: its weights of the corners, and its distance.
fn carried(point: DVec3, from: [DVec3; 3], to: [DVec3; 3]) -> DVec3 {
    let frame = |[a, b, c]: [DVec3; 3]| {
        let (u, v) = (b - a, c - a);
        DMat3::from_cols(u, v, u.cross(v).normalize_or_zero())
    };
    let local = frame(from).inverse() * (point - from[0]);
    match local.is_finite() {
        true => to[0] + frame(to) * local,
        false => point, // a triangle without area
    }
}

/// Surface that a pixel shows.
#[derive(Clone, Copy)]
struct Seen {
    /// Instance and triangle.
    ids: [u32; 2],
    depth_m: f32,
    /// Reflected instance in a sharp mirror; `None` for other surfaces.
    mirrored: Option<u32>,
}

/// Surfaces of all pixels of a picture.
pub struct Surfaces {
    size: [u32; 2],
    seen: Vec<Option<Seen>>,
}

impl Surfaces {
    /// AOVs that surfaces are made from, beside the guides of the denoiser.
    pub const AOVS: [Aov; 2] = [Aov::Depth, Aov::Ids];

    /// The surfaces of a picture, with the instance that each pixel mirrors.
    pub fn new(size: [u32; 2], planes: &[Plane], mirrored: &[Option<u32>]) -> Self {
        let of = |aov: Aov| planes.iter().find(|plane| plane.name == aov.name());
        let (depth, ids) = (of(Aov::Depth), of(Aov::Ids));
        let seen = match (depth.map(|p| &p.data), ids.map(|p| &p.data)) {
            (Some(PlaneData::F32(depths)), Some(PlaneData::U32(ids))) => depths
                .iter()
                .zip(ids.chunks_exact(2))
                .zip(mirrored)
                .map(|((depth_m, ids), mirrored)| {
                    depth_m.is_finite().then_some(Seen {
                        ids: [ids[0], ids[1]],
                        depth_m: *depth_m,
                        mirrored: *mirrored,
                    })
                })
                .collect(),
            _ => vec![None; size[0] as usize * size[1] as usize],
        };
        Self { size, seen }
    }

    fn seen_at(&self, [x, y]: [u32; 2]) -> Option<Seen> {
        self.seen[(y * self.size[0] + x) as usize]
    }

    /// Instances that the 3 × 3 pixels around one show, fewer at the border, with their indices; `None` for none.
    pub fn around(&self, [x, y]: [u32; 2]) -> impl Iterator<Item = (usize, Option<u32>)> {
        let [width, height] = self.size;
        let rows = y.saturating_sub(1)..height.min(y + 2);
        let pixels = rows
            .flat_map(move |y| (x.saturating_sub(1)..width.min(x + 2)).map(move |x| y * width + x));
        pixels.map(|index| {
            let index = index as usize;
            (index, self.seen[index].map(|seen| seen.ids[0]))
        })
    }

    /// Whether a pixel is beside an instance, other than its own, that has moved: it may show some of that, whose light
    /// would follow it as a trail.
    fn is_beside(&self, moved: &[bool], pixel: [u32; 2], own: u32) -> bool {
        let mut others = self.around(pixel).filter_map(|(_, instance)| instance);
        others.any(|other| other != own && moved.get(other as usize).is_none_or(|moved| *moved))
    }
}

/// Surfaces of a frame's pixels, with its camera and the places of its instances.
#[derive(Clone, Copy)]
pub struct PosedSurfaces<'a> {
    /// Surfaces of the pixels.
    pub surfaces: &'a Surfaces,
    /// Pose of the frame.
    pub pose: &'a FramePose,
}

/// Pixels of another frame that show the surface of a pixel, by index, with weights that add up to 1.
pub struct Taps(pub Vec<(usize, f32)>);

/// The pixels of another frame that show what `pixel` shows; `None` where that is hidden, outside of the picture,
/// beside one of the instances that have `moved` between the frames, or where a sharp mirror or its camera moved, since
/// its picture moves otherwise than the mirror.
pub fn taps(
    pixel: [u32; 2],
    here: PosedSurfaces<'_>,
    there: PosedSurfaces<'_>,
    moved: &[bool],
) -> Option<Taps> {
    let (surfaces, other_surfaces) = (here.surfaces, there.surfaces);
    let seen = surfaces.seen_at(pixel)?;
    let (place, depth_m) = here.pose.in_frame(there.pose, pixel, seen)?;
    let corner = place - 0.5;
    let motion = corner - DVec2::new(f64::from(pixel[0]), f64::from(pixel[1]));
    let is_still = motion.abs().max_element() < STILL_PX;
    if seen.mirrored.is_some() && !is_still {
        return None;
    }
    let corner = if is_still { corner.round() } else { corner };
    let base = corner.floor();
    let share = corner - base;
    let mut taps = Vec::with_capacity(4);
    let mut sum = 0.0;
    for [x, y] in [[0, 0], [1, 0], [0, 1], [1, 1]] {
        let [sx, sy] = [x, y].map(|v| v == 1);
        let weight =
            (if sx { share.x } else { 1.0 - share.x }) * (if sy { share.y } else { 1.0 - share.y });
        let at = base + DVec2::new(f64::from(x), f64::from(y));
        let is_inside = at.x >= 0.0
            && at.y >= 0.0
            && at.x < f64::from(surfaces.size[0])
            && at.y < f64::from(surfaces.size[1]);
        if weight < 1e-4 || !is_inside {
            continue;
        }
        let at = [at.x as u32, at.y as u32];
        let other = other_surfaces.seen_at(at);
        let is_same = other.is_some_and(|other| {
            other.ids[0] == seen.ids[0]
                && other.mirrored == seen.mirrored
                && (f64::from(other.depth_m) - depth_m).abs() <= SAME_DEPTH * depth_m
                && !other_surfaces.is_beside(moved, at, seen.ids[0])
        });
        if is_same {
            taps.push(((at[1] * surfaces.size[0] + at[0]) as usize, weight as f32));
            sum += weight as f32;
        }
    }
    if sum < 0.5 {
        return None;
    }
    taps.iter_mut().for_each(|(_, weight)| *weight /= sum);
    Some(Taps(taps))
}

/// Motion in pixels below which a pixel counts as the same one.
const STILL_PX: f64 = 0.01;

#[cfg(test)]
mod tests {
    use glam::{DQuat, Vec3};

    use super::*;
    use reflet_scene::desc::CameraDesc;

    const SIZE: [u32; 2] = [64, 48];

    fn posed<'a>(surfaces: &'a Surfaces, pose: &'a FramePose) -> PosedSurfaces<'a> {
        PosedSurfaces { surfaces, pose }
    }

    fn pose(eye: Vec3, place: DAffine3) -> FramePose {
        let camera = CameraDesc {
            eye,
            ..CameraDesc::default()
        };
        FramePose {
            view: View::new(&camera, SIZE, 1.0),
            places: vec![Some(place), None],
            mesh_of: vec![0, 0],
            meshes: Shared::default(),
            deformed: BTreeMap::new(),
        }
    }

    fn plane_of(instance: u32) -> Surfaces {
        let seen = Seen {
            ids: [instance, 0],
            depth_m: 5.0,
            mirrored: None,
        };
        Surfaces {
            size: SIZE,
            seen: vec![Some(seen); 64 * 48],
        }
    }

    #[test]
    fn a_surface_is_found_where_it_and_the_camera_have_moved() {
        let eye = Vec3::new(0.0, 0.0, 5.0);
        let still = pose(eye, DAffine3::IDENTITY);
        let surfaces = plane_of(0);
        let of = |other: &FramePose| {
            taps(
                [20, 30],
                posed(&surfaces, &still),
                posed(&surfaces, other),
                &still.moved(other),
            )
        };
        let same = of(&still).expect("it is there").0;
        assert_eq!(same, [(30 * 64 + 20, 1.0)]);
        // A picture of 48 pixels is 2 tan 30° 5 m high there.
        let pixel_m = 2.0 * 30_f64.to_radians().tan() * 5.0 / 48.0;
        let moved = pose(eye, DAffine3::from_translation(DVec3::X * 3.0 * pixel_m));
        let found = of(&moved).expect("it is there").0;
        let nearest = found.iter().max_by(|a, b| a.1.total_cmp(&b.1));
        assert_eq!(nearest.map(|(pixel, _)| *pixel), Some(30 * 64 + 23));
        let outside = pose(eye, DAffine3::from_translation(DVec3::X * 60.0 * pixel_m));
        assert!(of(&outside).is_none());
        let behind = pose(Vec3::new(0.0, 0.0, -0.5), DAffine3::IDENTITY);
        assert!(of(&behind).is_none(), "its depth differs");
    }

    #[test]
    fn hidden_and_other_instances_are_not_taken() {
        let eye = Vec3::new(0.0, 0.0, 5.0);
        let pose = pose(eye, DAffine3::IDENTITY);
        let (first, hidden) = (plane_of(0), plane_of(1));
        assert!(taps([20, 30], posed(&hidden, &pose), posed(&hidden, &pose), &[]).is_none());
        assert!(taps([20, 30], posed(&first, &pose), posed(&hidden, &pose), &[]).is_none());
    }

    #[test]
    fn pixels_beside_what_moved_are_not_taken() {
        let mut here = pose(Vec3::new(0.0, 0.0, 5.0), DAffine3::IDENTITY);
        here.places[1] = Some(DAffine3::IDENTITY);
        let mut there = pose(Vec3::new(0.0, 0.0, 5.0), DAffine3::IDENTITY);
        there.places[1] = Some(DAffine3::from_translation(DVec3::X));
        let (plain, mut passed) = (plane_of(0), plane_of(0));
        for y in 28..31 {
            passed.seen[y * 64 + 21] = plane_of(1).seen[0];
        }
        let found = |pixel, other: &FramePose| {
            let moved = here.moved(other);
            taps(pixel, posed(&plain, &here), posed(&passed, other), &moved).is_some()
        };
        assert!(!found([20, 30], &there), "it is beside the moved one");
        assert!(found([19, 30], &there), "it is a pixel away");
        assert!(found([20, 30], &here), "nothing has moved");
    }

    #[test]
    fn points_go_with_their_triangle() {
        let triangle = [DVec3::ZERO, DVec3::X, DVec3::Y];
        let rotation = DQuat::from_rotation_y(1.2);
        let moved = triangle.map(|corner| rotation * corner + DVec3::new(1.0, 2.0, 3.0));
        let found = carried(DVec3::new(0.3, 0.2, 0.01), triangle, moved);
        let expected = rotation * DVec3::new(0.3, 0.2, 0.01) + DVec3::new(1.0, 2.0, 3.0);
        assert!(found.distance(expected) < 1e-12, "{found}");
        let flat = [DVec3::ZERO, DVec3::X, DVec3::X];
        assert_eq!(carried(DVec3::Z, flat, moved), DVec3::Z);
    }
}
