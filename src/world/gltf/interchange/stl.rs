//! STL: triangles without shared vertices, in text or binary, by `stl_io`.

use std::io::Cursor;

use super::{Fault, Found, Glb, Part, Source, broken};

pub fn read(source: &Source<'_>, _: Found<'_>) -> Result<Glb, Fault> {
    let mut bytes = Cursor::new(source.bytes);
    let triangles = stl_io::create_stl_reader(&mut bytes);
    let triangles = triangles.map_err(|e| broken(format!("the header cannot be read: {e}")))?;
    let mut glb = Glb::new();
    let mut part = Part {
        name: "solid".to_owned(),
        material: Some(glb.matte()),
        ..Part::default()
    };
    for (number, triangle) in triangles.enumerate() {
        let triangle = triangle.map_err(|e| broken(format!("triangle {number}: {e}")))?;
        part.positions.extend(triangle.vertices.map(|v| v.0));
    }
    part.triangles = Some((0..part.positions.len() as u32).collect());
    glb.add(&part);
    Ok(glb)
}
