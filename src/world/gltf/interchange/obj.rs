//! OBJ: meshes with the materials of MTL files, by `tobj`.

use std::{
    cell::{Cell, RefCell},
    io::{self, BufRead, Read},
    path::Path,
};

use reflet_base::math::linear_from_srgb;
use tobj::{LoadError, LoadOptions};

use super::{Fault, Found, Glb, Part, Source, broken, mtl};

/// Materials that are missing, for the warning.
const MISSING: &str = "files of materials cannot be read, and their materials are matte";

/// Reads a model: faces with more corners become triangles, and missing normals are flat.
pub fn read(source: &Source<'_>, found: Found<'_>) -> Result<Glb, Fault> {
    let lines = Cell::new(0);
    let mut reader = Counted {
        rest: source.bytes,
        lines: &lines,
    };
    let options = LoadOptions {
        single_index: true,
        triangulate: true,
        ignore_points: true,
        ignore_lines: true,
    };
    // The library asks for the files of materials by a function that it may call at any time.
    let found = RefCell::new(found);
    let folder_of_maps = RefCell::new(String::new());
    let library = |name: &Path| {
        let name = name.to_string_lossy().replace('\\', "/");
        let found = &mut *found.borrow_mut();
        let bytes = source.sandbox.resolve(source.folder, &name);
        let bytes = bytes.and_then(|path| {
            found.files.push(path.clone());
            source.sandbox.read(&path)
        });
        match bytes {
            Ok(bytes) => {
                let end = name.rfind('/').map_or(0, |at| at + 1);
                name[..end].clone_into(&mut folder_of_maps.borrow_mut());
                let lines = Cell::new(0);
                let mut reader = Counted {
                    rest: &bytes,
                    lines: &lines,
                };
                tobj::load_mtl_buf(&mut reader).inspect_err(|error| {
                    let place = format!("{name}, line {}: {error}", lines.get());
                    found.notes.add("mtl-missing", 1, MISSING, &place);
                })
            }
            Err(missing) => {
                let place = missing.looked_for_in(source.folder).message;
                found.notes.add("mtl-missing", 1, MISSING, &place);
                Err(LoadError::OpenFileFailed)
            }
        }
    };
    let read = tobj::load_obj_buf(&mut reader, &options, library);
    let (models, materials) =
        read.map_err(|error| broken(format!("line {}: {error}", lines.get())))?;
    let mut glb = Glb::new();
    let (found, folder) = (found.into_inner(), folder_of_maps.into_inner());
    for material in &materials.unwrap_or_default() {
        mtl::add(&mut glb, material, &folder, found.notes);
    }
    let mut matte = None;
    for model in models {
        let mesh = model.mesh;
        let color = |c: &[f32; 3]| {
            let [r, g, b] = c.map(linear_from_srgb);
            [r, g, b, 1.0]
        };
        let material = match (mesh.material_id, matte) {
            (Some(own), _) => own,
            (None, Some(matte)) => matte,
            (None, None) => *matte.insert(glb.matte()),
        };
        glb.add(&Part {
            name: model.name,
            positions: mesh.positions.as_chunks().0.to_vec(),
            normals: mesh.normals.as_chunks().0.to_vec(),
            uvs: mesh.texcoords.as_chunks().0.to_vec(),
            colors: mesh.vertex_color.as_chunks().0.iter().map(color).collect(),
            triangles: Some(mesh.indices),
            material: Some(material),
        });
    }
    Ok(glb)
}

/// Text that counts the lines that were read of it, for messages.
struct Counted<'a> {
    rest: &'a [u8],
    lines: &'a Cell<usize>,
}

impl Read for Counted<'_> {
    fn read(&mut self, to: &mut [u8]) -> io::Result<usize> {
        self.rest.read(to)
    }
}

impl BufRead for Counted<'_> {
    fn fill_buf(&mut self) -> io::Result<&[u8]> {
        Ok(self.rest)
    }

    fn consume(&mut self, count: usize) {
        self.lines.set(self.lines.get() + 1);
        self.rest = &self.rest[count.min(self.rest.len())..];
    }
}
