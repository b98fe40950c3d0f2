//! Texture references of materials, and the images that they use.

use std::{collections::HashMap, fmt, path::Path};

use glam::{Vec2, Vec3};

use super::{
    Fault, ImageSource, ImageUse, Notes,
    accessor::Data,
    finite, label,
    lenient::{self, LeftOut},
    schema::{self, Root, TextureInfo},
    uri::{self, Sandbox},
};
use crate::{TextureRef, Wrap};

/// Collects the used images and their color spaces.
pub struct Textures<'a> {
    /// The file.
    pub root: &'a Root,
    data: &'a Data<'a>,
    folder: &'a Path,
    sandbox: &'a Sandbox,
    /// Index of each used image, by its index in the file, its color space and its fallback.
    uses: HashMap<(usize, bool, Option<usize>), usize>,
    /// Images by color space.
    pub images: Vec<ImageUse>,
}

impl<'a> Textures<'a> {
    /// A collection without images.
    pub fn new(root: &'a Root, data: &'a Data<'a>, folder: &'a Path, sandbox: &'a Sandbox) -> Self {
        Self {
            root,
            data,
            folder,
            sandbox,
            uses: HashMap::new(),
            images: Vec::new(),
        }
    }
}

/// A use of a texture, for messages.
pub struct Slot<'a> {
    /// Name of the material, such as `material 3 "silk"`.
    pub material: &'a str,
    /// The material's index in the file.
    pub index: usize,
    /// Keys inside the material, joined with `/`.
    pub path: &'a str,
}

impl fmt::Display for Slot<'_> {
    /// Key of the texture, and its path in the JSON.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let key = self.path.rsplit('/').next().unwrap_or_default();
        write!(f, "{key} (/materials/{}/{})", self.index, self.path)
    }
}

impl Textures<'_> {
    /// Resolves a use of a texture; `None` if the texture has only images of unsupported formats.
    pub fn reference(
        &mut self,
        info: &TextureInfo,
        srgb: bool,
        slot: &Slot<'_>,
        notes: &mut Notes,
    ) -> Result<Option<TextureRef>, Fault> {
        let found = self.find(info, srgb, slot, notes);
        let found = found.map_err(|fault| fault.placed(&slot.to_string()));
        let left_out = LeftOut {
            name: "texture-left-out",
            what: "textures are wrong and left out",
            place: slot.material,
        };
        lenient::forgiven(self.root, found, None, &left_out, notes)
    }

    fn find(
        &mut self,
        info: &TextureInfo,
        srgb: bool,
        slot: &Slot<'_>,
        notes: &mut Notes,
    ) -> Result<Option<TextureRef>, Fault> {
        let Some(texture) = self.root.textures.get(info.index) else {
            let missing = Fault::missing("texture", info.index);
            let left_out = LeftOut {
                name: lenient::DROPPED,
                what: lenient::DROPPED_WHAT,
                place: &format!("{}: {slot}", slot.material),
            };
            return lenient::forgiven(self.root, Err(missing), None, &left_out, notes);
        };
        let sampler = match texture.sampler.map(|i| (i, self.root.samplers.get(i))) {
            Some((_, Some(sampler))) => sampler,
            Some((i, None)) => return Err(Fault::missing("sampler", i)),
            None => &schema::Sampler::default(),
        };
        let images: Vec<_> = (texture.extensions.sources())
            .chain(texture.source)
            .collect();
        if images.is_empty() {
            let what = "textures have no PNG, JPEG, WebP or KTX2 image and are left out";
            let place = format!("{}: {slot}", slot.material);
            notes.add("texture-unsupported", 1, what, &place);
            return Ok(None);
        }
        let transform = info.extensions.transform.as_ref();
        let uv_set = transform.and_then(|t| t.tex_coord);
        let transform = rows(transform)?;
        let mut wrap = |code: Option<u32>| {
            let left_out = LeftOut {
                name: "property-left-out",
                what: "wrap modes are unknown, and their textures repeat",
                place: &format!("{}: {slot}", slot.material),
            };
            lenient::forgiven(self.root, wrap(code), Wrap::Repeat, &left_out, notes)
        };
        let wrap = [wrap(sampler.wrap_s)?, wrap(sampler.wrap_t)?];
        let mut texture = None;
        // The preferred image comes last, and has the images after it in the list as fallbacks.
        for image in images.into_iter().rev() {
            texture = Some(self.image_use(image, srgb, slot, texture)?);
        }
        Ok(texture.map(|texture| TextureRef {
            texture,
            uv_set: uv_set.unwrap_or(info.tex_coord),
            transform,
            wrap,
            nearest: sampler.mag_filter == Some(9728),
        }))
    }

    /// Index into [`Textures::images`] of an image in a color space and with a fallback; a new one is added.
    fn image_use(
        &mut self,
        index: usize,
        srgb: bool,
        user: &Slot<'_>,
        fallback: Option<usize>,
    ) -> Result<usize, Fault> {
        let next = self.images.len();
        let slot = *(self.uses.entry((index, srgb, fallback))).or_insert(next);
        if slot == next {
            let used_by = format!("{user} of {}", user.material);
            let image = self.image(index, srgb, &used_by)?;
            self.images.push(ImageUse { fallback, ..image });
        }
        Ok(slot)
    }

    /// An image of the file; `used_by` is for messages.
    pub fn image(&self, index: usize, srgb: bool, used_by: &str) -> Result<ImageUse, Fault> {
        let Some(image) = self.root.images.get(index) else {
            return Err(Fault::missing("image", index));
        };
        let uri = image.uri.as_deref().filter(|uri| !uri.starts_with("data:"));
        let name = label("image", index, image.name.as_deref().or(uri));
        let place = format!("{name}, {used_by}");
        Ok(ImageUse {
            source: self.source(image).map_err(|f| f.placed(&place)),
            fallback: None,
            name,
            used_by: used_by.to_owned(),
            index,
            srgb,
        })
    }

    /// Adds an image that `convert` makes of others; `name` and `used_by` are for messages.
    pub fn converted<const N: usize>(
        &mut self,
        from: [Option<TextureRef>; N],
        (name, used_by): (String, String),
        srgb: bool,
        convert: impl FnOnce([Option<ImageSource>; N]) -> ImageSource,
    ) -> usize {
        let source = |used: &TextureRef| self.images[used.texture].source.clone();
        let sources = from.each_ref().map(|used| used.as_ref().map(source));
        let fault = sources.iter().flatten().find_map(|s| s.clone().err());
        let source = match fault {
            Some(fault) => Err(fault),
            None => Ok(convert(sources.map(|source| source.and_then(Result::ok)))),
        };
        self.images.push(ImageUse {
            name,
            used_by,
            // Unique, and above the indices of the file's images.
            index: self.root.images.len() + self.images.len(),
            srgb,
            source,
            fallback: None,
        });
        self.images.len() - 1
    }

    fn source(&self, image: &schema::Image) -> Result<ImageSource, Fault> {
        match (&image.uri, image.buffer_view) {
            (Some(_), Some(_)) => Err(Fault::new("gltf-image", "has both a uri and a bufferView")),
            (None, None) => Err(Fault::new(
                "gltf-image",
                "has neither a uri nor a bufferView",
            )),
            (None, Some(view)) => self.data.view_bytes(view).map(ImageSource::Bytes),
            (Some(text), None) => match uri::parse(text)? {
                uri::Target::Data(bytes) => Ok(ImageSource::Bytes(super::Bytes::new(bytes))),
                uri::Target::Relative(name) => self
                    .sandbox
                    .resolve(self.folder, &name)
                    .map_err(|fault| fault.looked_for_in(self.folder))
                    .map(ImageSource::File),
            },
        }
    }
}

fn wrap(code: Option<u32>) -> Result<Wrap, Fault> {
    Ok(match code {
        None | Some(10497) => Wrap::Repeat,
        Some(33071) => Wrap::Clamp,
        Some(33648) => Wrap::Mirror,
        Some(other) => {
            return Err(Fault::new(
                "gltf-sampler",
                format!("wrap mode {other} is unknown"),
            ));
        }
    })
}

/// Matrix rows of KHR_texture_transform, as in [`TextureRef::transform`].
fn rows(transform: Option<&schema::TextureTransform>) -> Result<[Vec3; 2], Fault> {
    let Some(t) = transform else {
        return Ok([Vec3::X, Vec3::Y]);
    };
    let ([ox, oy], [sx, sy]) = (t.offset.unwrap_or_default(), t.scale.unwrap_or([1.0; 2]));
    let rotation = t.rotation.unwrap_or(0.0);
    if !finite(&[ox, oy, sx, sy, rotation]) {
        return Err(Fault::new(
            "gltf-material",
            "KHR_texture_transform must be finite",
        ));
    }
    Ok(TextureRef::rows(
        Vec2::new(ox, oy),
        rotation,
        Vec2::new(sx, sy),
    ))
}
