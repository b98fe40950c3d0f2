//! Terminator on a smooth ball of few triangles: light ends at the smooth surface's horizon, not at edges of
//! triangles.

use crate::kit::*;

const BALL: &str = include_str!("terminator/ball.toml");

#[test]
fn light_ends_where_the_smooth_surface_turns_away() {
    let Some(gpu) = gpu() else { return };
    let to_light = Vec3::new(1.0, 0.3, 0.2).normalize();
    // Shadow maps blur over texels; 16-bit light and normals leave an error of 1 %.
    for (shadow, tolerance, most) in [("none", 0.01, 0), ("ray", 0.01, 0), ("map", 0.05, 20)] {
        let set = format!("light.lamp.shadow={shadow}");
        let picture = render(gpu, BALL, &[&set], &[Aov::Normal]);
        let normals = floats(&picture, Aov::Normal).chunks_exact(3);
        let mut seen = 0;
        let mut wrong = Vec::new();
        for (i, normal) in (0..).zip(normals.map(Vec3::from_slice)) {
            if normal == Vec3::ZERO {
                continue;
            }
            seen += 1;
            let [x, y] = [i % 64, i / 64];
            let expected = normal.dot(to_light).max(0.0);
            let found = color(&picture, x, y)[0];
            if (found - expected).abs() > tolerance {
                wrong.push((x, y, found, expected));
            }
        }
        assert!(seen > 1500, "{seen} pixels of the ball");
        assert!(
            wrong.len() <= most,
            "{shadow}: {} wrong: {:?}",
            wrong.len(),
            wrong.first()
        );
    }
}
