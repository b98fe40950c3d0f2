//! `--denoise`: Intel Open Image Denoise, a library that is loaded at run time where it is installed.

pub mod reproject;
pub mod window;

use std::{
    env,
    ffi::{CStr, c_char, c_int, c_void},
    path::PathBuf,
    ptr,
};

use libloading::Library;

use crate::error::OutputError;
use reflet_render::{
    Picture, Plane, PlaneData,
    picture::aov::Aov,
    settings::cutoff::{MIRROR_REFLECTANCE, SHARP_ROUGHNESS},
};
use reproject::Surfaces;

/// File name of the library with its major version; the interface of version 2 dates from 2023.
#[cfg(target_os = "linux")]
const FILE: &str = "libOpenImageDenoise.so.2";
#[cfg(target_os = "macos")]
const FILE: &str = "libOpenImageDenoise.2.dylib";
#[cfg(not(any(target_os = "linux", target_os = "macos")))]
const FILE: &str = "OpenImageDenoise.dll";

/// Environment variable with the folder of the library, for systems that do not find it.
const FOLDER: &str = "REFLET_OIDN";

/// AOVs that tell what pixels mirror.
const MIRRORS: [Aov; 3] = [Aov::Material, Aov::Reflectance, Aov::HitIds];

/// Largest change of a channel's mean that is made up for, as a factor: more is light of specks that the filter
/// removed, which would brighten all pixels, in each frame of a film otherwise.
const MEAN_RANGE: [f64; 2] = [0.98, 1.02];

// Constants of `oidn.h`.
const DEVICE_CPU: c_int = 1;
const FORMAT_FLOAT3: c_int = 3;

type Handle = *mut c_void;

/// The loaded library.
pub struct Denoiser {
    library: Library,
    /// Number of AOVs that are written; further ones follow them.
    written: usize,
    stop: Stop,
}

/// Whether a picture is given up.
type Stop = Box<dyn Fn() -> bool + Send + Sync>;

/// An input or output image of a filter: its name in the library, and three floats per pixel.
struct Image<'a>(&'a CStr, &'a mut [f32]);

impl Denoiser {
    /// Loads the library, for pictures that are written with `aovs`.
    ///
    /// # Errors
    /// [`OutputError::Usage`] if it is not installed, with instructions.
    pub fn new(aovs: &[Aov]) -> Result<Self, OutputError> {
        let folder = env::var_os(FOLDER).filter(|folder| !folder.is_empty());
        let path = folder.map_or_else(|| FILE.into(), |folder| PathBuf::from(folder).join(FILE));
        #[expect(
            unsafe_code,
            reason = "the library is no build dependency: most machines lack it"
        )]
        // SAFETY: loading the library of this name runs no code of its own but C++ constructors, as when a
        // program is linked to it.
        let library = unsafe { Library::new(&path) };
        let library = library.map_err(|error| {
            OutputError::Usage(format!(
                "--denoise needs Intel Open Image Denoise 2, and {} could not be loaded: {error}\n\
                 install it from https://www.openimagedenoise.org or by `pip install pyoidn`, and set \
                 {FOLDER} to the folder that has {FILE}",
                path.display()
            ))
        })?;
        Ok(Self {
            library,
            written: aovs.len(),
            stop: Box::new(|| false),
        })
    }

    /// Whether the user names a folder of the library.
    pub fn has_named_folder() -> bool {
        env::var_os(FOLDER).is_some_and(|folder| !folder.is_empty())
    }

    /// The denoiser, whose pictures are given up with an error once `stop` holds.
    pub fn stopped_by(self, stop: impl Fn() -> bool + Send + Sync + 'static) -> Self {
        let stop = Box::new(stop);
        Self { stop, ..self }
    }

    /// AOVs to render for denoising: the requested ones, with `has_window` also AOVs that find surfaces in other
    /// frames.
    pub fn aovs(requested: &[Aov], has_window: bool) -> Vec<Aov> {
        let surfaces = MIRRORS.into_iter().chain(Surfaces::AOVS);
        let further = surfaces.filter(|aov| has_window && !requested.contains(aov));
        requested.iter().copied().chain(further).collect()
    }

    /// The instance that each pixel mirrors, none of its instances for the surroundings, where its surface is a sharp
    /// mirror.
    pub fn mirrored(planes: &[Plane]) -> Vec<Option<u32>> {
        let hits = planes.iter().find(|plane| plane.name == Aov::HitIds.name());
        let Some(PlaneData::U32(hits)) = hits.map(|plane| &plane.data) else {
            return Vec::new();
        };
        let material = values(planes, Aov::Material);
        let surfaces = (material.chunks_exact(3)).zip(values(planes, Aov::Reflectance));
        (surfaces.zip(hits.chunks_exact(2)))
            .map(|((material, reflectance), hit)| {
                (material[0] < SHARP_ROUGHNESS && reflectance > MIRROR_REFLECTANCE)
                    .then_some(hit[0])
            })
            .collect()
    }

    /// Denoises the linear radiance of a picture with guides, makes its display color from that, and drops the planes
    /// that were added by [`Denoiser::aovs`].
    ///
    /// # Errors
    /// [`OutputError::Internal`] with the library's message.
    pub fn apply(&self, picture: &mut Picture) -> Result<(), OutputError> {
        let first = |pixel: &[f32]| [pixel[0], pixel[1], pixel[2]];
        let linear: Vec<f32> = picture.color.chunks_exact(4).flat_map(first).collect();
        let mut clean = self.filtered(picture.size, linear.clone(), &picture.guides)?;
        keep_mean(&mut clean, &linear);
        let pixels = picture.color.chunks_exact_mut(4);
        for (pixel, clean) in pixels.zip(clean.chunks_exact(3)) {
            // Empty pixels stay black, even where the filter has spread light.
            let is_there = !picture.alpha || pixel[3] > 0.0;
            pixel[..3].copy_from_slice(if is_there { clean } else { &[0.0; 3] });
        }
        picture.set_display_from_color();
        picture.planes.truncate(self.written);
        Ok(())
    }

    /// Denoised copy of linear radiance with three floats per pixel, by planes of guides.
    fn filtered(
        &self,
        size: [u32; 2],
        mut color: Vec<f32>,
        guides: &[f32],
    ) -> Result<Vec<f32>, OutputError> {
        let mut output = vec![0.0; color.len()];
        let (mut albedo, mut normal) = match guides.len() / 2 {
            0 => (vec![0.0; color.len()], vec![0.0; color.len()]),
            half => (interleaved(&guides[..half]), interleaved(&guides[half..])),
        };
        let images = [
            Image(c"color", &mut color),
            Image(c"albedo", &mut albedo),
            Image(c"normal", &mut normal),
            Image(c"output", &mut output),
        ];
        self.execute(size, images, c"hdr")
            .map_err(|why| OutputError::Internal(format!("Open Image Denoise: {why}")))?;
        Ok(output)
    }

    #[expect(unsafe_code, reason = "the library is C, and loaded at run time")]
    fn execute(&self, size: [u32; 2], images: [Image<'_>; 4], kind: &CStr) -> Result<(), String> {
        let pixels = size[0] as usize * size[1] as usize;
        if images.iter().any(|image| image.1.len() != 3 * pixels) {
            return Err(format!("an image has other than {pixels} pixels"));
        }
        macro_rules! function {
            ($name:ident($($argument:ty),* $(,)?) $(-> $result:ty)?) => {
                // SAFETY: the function type is declared so in `oidn.h`, version 2.
                unsafe {
                    let name = concat!(stringify!($name), "\0");
                    self.library
                        .get::<unsafe extern "C" fn($($argument),*) $(-> $result)?>(name.as_bytes())
                        .map_err(|error| error.to_string())?
                }
            };
        }
        let new_device = function!(oidnNewDevice(c_int) -> Handle);
        let commit_device = function!(oidnCommitDevice(Handle));
        let release_device = function!(oidnReleaseDevice(Handle));
        let device_error = function!(oidnGetDeviceError(Handle, *mut *const c_char) -> c_int);
        let new_filter = function!(oidnNewFilter(Handle, *const c_char) -> Handle);
        let set_image = function!(
            oidnSetSharedFilterImage(
                Handle,
                *const c_char,
                *mut c_void,
                c_int,
                usize,
                usize,
                usize,
                usize,
                usize,
            )
        );
        let set_flag = function!(oidnSetFilterBool(Handle, *const c_char, bool));
        let set_monitor =
            function!(oidnSetFilterProgressMonitorFunction(Handle, Monitor, *const Stop));
        let commit_filter = function!(oidnCommitFilter(Handle));
        let run = function!(oidnExecuteFilter(Handle));
        let release_filter = function!(oidnReleaseFilter(Handle));
        // SAFETY: handles are used only between creation and release; images have three floats for each pixel
        // (checked above) and live until the filter is released, as `self.stop` does; a CPU device reads and writes
        // them in place.
        unsafe {
            let device = new_device(DEVICE_CPU);
            commit_device(device);
            let filter = new_filter(device, c"RT".as_ptr());
            for Image(name, values) in images {
                let data = values.as_mut_ptr().cast();
                let [width, height] = size.map(|v| v as usize);
                set_image(
                    filter,
                    name.as_ptr(),
                    data,
                    FORMAT_FLOAT3,
                    width,
                    height,
                    0,
                    0,
                    0,
                );
            }
            set_flag(filter, kind.as_ptr(), true);
            set_monitor(filter, goes_on, &raw const self.stop);
            commit_filter(filter);
            run(filter);
            let mut message = ptr::null();
            let failed = device_error(device, &raw mut message) != 0;
            let text = match failed && !message.is_null() {
                true => CStr::from_ptr(message).to_string_lossy().into_owned(),
                false => "no reason given".to_owned(),
            };
            release_filter(filter);
            release_device(device);
            if failed { Err(text) } else { Ok(()) }
        }
    }
}

/// Called by the library while it works, in any of its threads, with the share that is done; it ends at `false`.
type Monitor = extern "C" fn(&Stop, f64) -> bool;

extern "C" fn goes_on(stop: &Stop, _: f64) -> bool {
    !stop()
}

/// Three planes, pixel by pixel.
fn interleaved(planes: &[f32]) -> Vec<f32> {
    let pixels = planes.len() / 3;
    (0..planes.len())
        .map(|i| planes[i % 3 * pixels + i / 3])
        .collect()
}

/// Scales each channel of a denoised picture to its mean before: the filter works on a compressed range and leaves some
/// light out.
fn keep_mean(clean: &mut [f32], noisy: &[f32]) {
    for channel in 0..3 {
        let sum = |values: &[f32]| -> f64 {
            let of_channel = values.iter().skip(channel).step_by(3);
            of_channel.map(|value| f64::from(value.max(0.0))).sum()
        };
        let factor = sum(noisy) / sum(clean);
        if factor.is_finite() {
            let factor = factor.clamp(MEAN_RANGE[0], MEAN_RANGE[1]) as f32;
            let of_channel = clean.iter_mut().skip(channel).step_by(3);
            of_channel.for_each(|value| *value *= factor);
        }
    }
}

/// Values of a float AOV of the picture; empty if it is missing.
fn values(planes: &[Plane], aov: Aov) -> Vec<f32> {
    let plane = planes.iter().find(|plane| plane.name == aov.name());
    match plane.map(|plane| &plane.data) {
        Some(PlaneData::F32(values)) => values.clone(),
        _ => Vec::new(),
    }
}
