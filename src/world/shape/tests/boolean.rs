//! Volumes of combined shapes add up.

use glam::Quat;
use reflet_scene::desc::{PartDesc, PlacementDesc, Written};

use super::*;

pub fn part(shape: ShapeDesc, translation: Vec3, rotation: Quat, scale: Vec3) -> PartDesc {
    let placement = PlacementDesc::Trs {
        translation,
        rotation,
        scale,
    };
    let at = Written(Default::default());
    PartDesc {
        shape,
        placement,
        at,
    }
}

fn moved(shape: ShapeDesc, translation: Vec3) -> PartDesc {
    part(shape, translation, Quat::IDENTITY, Vec3::ONE)
}

fn volume(shape: &ShapeDesc) -> f64 {
    let mesh = mesh(shape);
    check_joined(&mesh, &format!("{shape:?}"));
    area_and_volume(&mesh).1
}

/// Inclusion and exclusion: |A ∪ B| + |A ∩ B| = |A| + |B|, and |A ∖ B| = |A| − |A ∩ B|.
#[test]
fn volumes_of_combined_shapes_add_up() {
    let shapes = [
        r#"{ kind = "box", size = [1, 0.7, 0.9] }"#,
        r#"{ kind = "sphere", radius = 0.6, segments = 24 }"#,
        r#"{ kind = "cylinder", radius = 0.4, height = 1.2, segments = 24 }"#,
        r#"{ kind = "torus", radius = 0.5, tube_radius = 0.2, segments = 24 }"#,
        r#"{ kind = "cone", radius = 0.5, height = 1, segments = 24 }"#,
    ]
    .map(read);
    let mut turn = 0.3_f32;
    for a in &shapes {
        for b in &shapes {
            turn += 1.7;
            let rotation = Quat::from_euler(glam::EulerRot::XYZ, turn, 2.0 * turn, 0.5 * turn);
            let offset = Vec3::new(0.1 * turn.sin(), 0.2, 0.1 * turn.cos());
            let parts = || {
                let second = part(b.clone(), offset, rotation, Vec3::new(1.0, 1.2, 0.9));
                vec![moved(a.clone(), Vec3::ZERO), second]
            };
            let own = [
                area_and_volume(&mesh(a)).1,
                area_and_volume(&mesh(b)).1 * 1.08,
            ];
            let union = volume(&ShapeDesc::Union { parts: parts() });
            let both = volume(&ShapeDesc::Intersection { parts: parts() });
            let left = volume(&ShapeDesc::Difference { parts: parts() });
            assert!((union + both - own[0] - own[1]).abs() < 1e-4, "{a:?} {b:?}");
            assert!((left + both - own[0]).abs() < 1e-4, "{a:?} {b:?}");
        }
    }
}
