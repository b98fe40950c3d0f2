//! Every shader assembles and validates without a GPU, and stays inside the limits that every
//! adapter has.

use std::{collections::BTreeSet, sync::LazyLock};

use reflet::gpu::{
    ShaderError, ShaderLibrary, ShaderModuleInfo, UsedTextures,
    bind::{merged_bindings, over_limits},
    check, check_part, parse,
    reflect::capabilities,
};
use reflet::render::{
    RenderOptions,
    layout::gpu_struct,
    passes,
    pipeline::{
        pass::Pass,
        pass_targets::PassTargets,
        shader_variant::{self, ShaderVariant},
        shared_data::SharedData,
        targets::Target,
    },
    plan::Features,
};

mod parts;
mod tint;

use crate::common::sampled;
use tint::{Source, sources};

/// Variant with these features and the features that follow from them.
fn variant(features: Features) -> ShaderVariant {
    ShaderVariant {
        features: features.with_followers(),
        ..ShaderVariant::default()
    }
}

/// Every shader of every variant.
static SOURCES: LazyLock<Vec<Source>> = LazyLock::new(sources);

/// The optional features that `Gpu` asks for; a shader that needs one has a twin that does not.
const OPTIONAL: wgpu::Features =
    wgpu::Features::PRIMITIVE_INDEX.union(wgpu::Features::EXPERIMENTAL_RAY_QUERY);

/// A shader of some variants.
struct Shader {
    /// Declarations of the whole text.
    info: ShaderModuleInfo,
    /// Textures of the whole text.
    used: UsedTextures,
    /// Declarations of the part that each set of features leaves, as a pipeline gets it.
    parts: Vec<ShaderModuleInfo>,
}

impl Shader {
    /// Parses a text, and validates it as a whole and the part of it that each set of features leaves.
    fn checked((_, source, variants): &Source) -> Result<Self, ShaderError> {
        let source = source.as_ref().map_err(Clone::clone)?;
        let module = parse(source)?;
        let info = check(source, &module, capabilities(OPTIONAL))?;
        let is_declared = |key: &str| info.overrides.iter().any(|o| o.name == key);
        let of = |features: &Features, mirrors: bool| -> Vec<(&str, bool)> {
            let flags = features.constants().map(|(key, value)| (key, value != 0.0));
            let all = flags.chain([("MIRRORS", mirrors)]);
            all.filter(|(key, _)| is_declared(key)).collect()
        };
        let sets = variants
            .iter()
            .flat_map(|f| [true, false].map(|on| of(f, on)));
        let sets: BTreeSet<_> = sets.collect();
        let part = |flags: Vec<(&str, bool)>| {
            let given = flags.into_iter();
            let given: Vec<_> = given
                .map(|(key, on)| (key, f64::from(u8::from(on))))
                .collect();
            check_part(source, &module, capabilities(OPTIONAL), &given)
        };
        Ok(Self {
            used: UsedTextures::new(&module, &module),
            // Each of them is a part of a text that is validated as a whole.
            parts: sampled(Vec::from_iter(sets), 9)
                .into_iter()
                .map(part)
                .collect::<Result<_, _>>()?,
            info,
        })
    }
}

/// Every text of every variant.
static SHIPPED: LazyLock<Vec<Shader>> = LazyLock::new(|| {
    let (good, bad): (Vec<_>, Vec<_>) =
        SOURCES.iter().map(Shader::checked).partition(Result::is_ok);
    let errors: BTreeSet<String> = (bad.into_iter().filter_map(Result::err))
        .map(|error| error.to_string())
        .collect();
    assert!(
        errors.is_empty(),
        "\n{}",
        Vec::from_iter(errors).join("\n\n")
    );
    good.into_iter().flatten().collect()
});

/// Declarations of every text of every variant.
fn shipped() -> impl Iterator<Item = &'static ShaderModuleInfo> {
    SHIPPED.iter().map(|shader| &shader.info)
}

#[test]
fn every_shader_validates_and_has_an_entry_point() {
    for info in shipped() {
        assert!(
            !info.entry_points.is_empty(),
            "{} starts nowhere",
            info.file
        );
    }
}

#[test]
fn every_library_is_imported_somewhere() {
    let sources = SOURCES
        .iter()
        .filter_map(|(_, source, _)| source.as_ref().ok());
    let all: String = sources.map(|source| &*source.text).collect();
    let library =
        or_panic!(ShaderVariant::all()[0].library(&ShaderLibrary::embedded(), &passes::ALL));
    for name in library.lib_names() {
        let lib = or_panic!(library.lib_source(name));
        // The last line of a library is part of every shader that imports it.
        let own = lib.text.lines().rev().find(|line| line.len() > 3);
        assert!(
            own.is_some_and(|line| all.contains(line)),
            "shaders/lib/{name}.wgsl is never imported"
        );
    }
}

#[test]
fn every_shader_stays_inside_the_default_limits() {
    let mut wrong = BTreeSet::new();
    for info in SHIPPED.iter().flat_map(|shader| &shader.parts) {
        let mut limits = wgpu::Limits::default();
        // Only devices with higher limits get BVHs, meshes, instances and materials as textures: software adapters, and
        // these and light trees as storage textures where enough can be bound.
        let arrays =
            "nodes triangles vertices mesh_data instances materials emitters panorama_squares";
        let is_array = |name: &str| arrays.split(' ').any(|array| array == name);
        for binding in (info.bindings.iter()).filter(|b| is_array(&b.name)) {
            match binding.ty {
                wgpu::BindingType::StorageTexture { .. } => {
                    limits.max_storage_textures_per_shader_stage += 1;
                }
                // Every device binds light trees and squares of the panorama as textures.
                wgpu::BindingType::Texture { .. }
                    if !["emitters", "panorama_squares"].contains(&&*binding.name) =>
                {
                    limits.max_sampled_textures_per_shader_stage += 1;
                }
                _ => {}
            }
        }
        // Only devices with ray queries get shaders that use them.
        limits.max_acceleration_structures_per_shader_stage = 1;
        let groups: Vec<_> = (0..limits.max_bind_groups)
            .map(|group| or_panic!(merged_bindings(&[info], group)))
            .collect();
        assert!(
            info.bindings
                .iter()
                .all(|b| b.group < limits.max_bind_groups),
            "{}: more than {} bind groups",
            info.file,
            limits.max_bind_groups
        );
        let groups: Vec<_> = groups.iter().map(Vec::as_slice).collect();
        for problem in over_limits(&groups, &limits) {
            wrong.insert(format!("{}: {problem}", info.file));
        }
        for entry in &info.entry_points {
            let [x, y, z] = entry.workgroup_size;
            if x * y * z > limits.max_compute_invocations_per_workgroup {
                wrong.insert(format!(
                    "{}: {}: {x}x{y}x{z} threads",
                    info.file, entry.name
                ));
            }
        }
    }
    assert!(wrong.is_empty(), "{}", Vec::from_iter(wrong).join("\n"));
}

#[test]
fn embedded_shaders_equal_the_folder() {
    let folder = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("shaders");
    let embedded = ShaderLibrary::embedded();
    let Ok(on_disk) = ShaderLibrary::from_dir(&folder) else {
        assert_eq!(embedded.names().count(), 0);
        return;
    };
    assert!(embedded.names().eq(on_disk.names()));
    assert!(embedded.lib_names().eq(on_disk.lib_names()));
    for name in embedded.names() {
        let text = |library| {
            Ok(ShaderVariant::default()
                .library(library, &passes::ALL)?
                .source(name)?
                .text)
        };
        let texts: [Result<_, ShaderError>; 2] = [&embedded, &on_disk].map(text);
        assert_eq!(texts[0].as_ref().ok(), texts[1].as_ref().ok(), "{name}");
    }
}

/// Shaders read the structs that Rust writes, at the places where it writes them.
#[test]
fn shared_structs_have_the_same_layout_in_the_shaders() {
    let compare = |spec: &gpu_struct::StructSpec, shader: &ShaderModuleInfo| {
        let Some(layout) = shader.layout_of(spec.name) else {
            return false;
        };
        let wgsl = (layout.fields.iter()).map(|f| (f.name.as_str(), f.offset as usize));
        let rust = spec.fields.iter().map(|f| (f.name, f.offset));
        let (name, file) = (spec.name, &shader.file);
        assert!(wgsl.eq(rust), "{name} in {file}: {:?}", layout.fields);
        assert_eq!(layout.size as usize, spec.size, "{name} in {file}");
        true
    };
    for spec in shader_variant::SHARED {
        let found = shipped().filter(|shader| compare(spec, shader));
        assert!(found.count() > 0, "no shader uses {}", spec.name);
    }
    for pass in passes::ALL.iter() {
        let shader = shipped().find(|s| s.name == pass.shader());
        let shader = shader.unwrap_or_else(|| panic!("pass {} has no shader", pass.name));
        let has = |spec| compare(spec, shader);
        let is_same = pass.params.iter().chain(pass.structs).all(has);
        assert!(is_same, "{} does not use its structs", shader.file);
    }
}

/// Targets that the shader of a pass uses in some frame.
fn targets(pass: &Pass) -> PassTargets {
    let texts = SHIPPED
        .iter()
        .filter(|shader| shader.info.name == pass.shader());
    let used = texts.map(|shader| PassTargets::new(pass, &shader.used));
    used.fold(PassTargets::default(), |mut all, used| {
        all.reads.extend(used.reads);
        all.writes.extend(used.writes);
        all
    })
}

#[test]
fn every_pass_reads_only_what_was_written_before() {
    let mut written: (Vec<Target>, Vec<SharedData>) = Default::default();
    for pass in passes::ORDER.iter() {
        let name = pass.name;
        let PassTargets { reads, writes } = targets(pass);
        for target in reads {
            // A pass that swaps targets reads what it wrote.
            let known = written.0.contains(&target) || writes.contains(&target);
            assert!(known, "{name} reads {} too early", target.name());
        }
        for data in pass.reads_shared {
            assert!(written.1.contains(data), "{name} reads {data:?} too early");
        }
        written.0.extend(writes);
        written.1.extend(pass.writes_shared);
    }
    let read_by_none: Vec<_> = (Target::ALL.iter())
        .filter(|target| !written.0.contains(target))
        .collect();
    assert!(read_by_none.is_empty(), "no pass writes {read_by_none:?}");
}

/// Binding that holds shared data; `None` for data that the dispatch itself reads.
fn binding_of(data: SharedData, pass: &Pass) -> Option<&'static str> {
    match data {
        SharedData::ShadowMaps => Some("shadow_maps"),
        SharedData::CulledDepth | SharedData::PixelLists | SharedData::DepthPyramid => {
            Some("lists")
        }
        SharedData::Counters => Some("counters"),
        // Their textures have a name for each use.
        SharedData::MethodMaps => None,
        SharedData::DispatchSizes => pass.writes_shared.contains(&data).then_some("arguments"),
    }
}

/// `reflet info --frame` prints the shared data that passes declare; their shaders bind the same.
#[test]
fn compute_passes_declare_the_shared_data_that_their_shaders_bind() {
    let draws = ["shadow", "visibility", "peel"]; // into attachments
    let known = BTreeSet::from(["shadow_maps", "lists", "counters", "arguments"]);
    let computes = passes::ALL
        .iter()
        .filter(|pass| !draws.contains(&pass.name));
    for pass in computes {
        let shaders = shipped().filter(|shader| shader.name == pass.shader());
        let bound = shaders.flat_map(|shader| shader.bindings.iter().map(|b| b.name.as_str()));
        let bound: BTreeSet<_> = bound.filter(|name| known.contains(name)).collect();
        let users = passes::ALL.iter().filter(|p| p.shader() == pass.shader());
        let shared = users.flat_map(|p| p.reads_shared.iter().chain(p.writes_shared));
        let declared: BTreeSet<_> = shared.filter_map(|data| binding_of(*data, pass)).collect();
        assert_eq!(declared, bound, "{}", pass.name);
    }
}

/// Overrides that neither the table of features nor a pass gives: numbers of the plan and of the adapter, and choices
/// between pipelines of one shader.
const OTHER_OVERRIDES: [&str; 12] = [
    "COUNT",
    "CUTOUT",
    "EMISSION_SCALE",
    "LAYER_POOLS",
    "MAX_VISITS",
    "REFLECTED_ROOT",
    "REFUSE",
    "ROW_SHUFFLES",
    "SHADE",
    "SLOT_POOLS",
    "SPHERES",
    "WRAPS",
];

/// A pipeline constant that no shader declares is ignored, and one that nothing sets keeps its default value, so that a
/// misspelled name would change no picture that a test looks at.
#[test]
fn overrides_are_those_of_features_and_passes() {
    let options = RenderOptions::default();
    let features = Features::ROWS.iter().filter_map(|row| row.constant);
    let own = passes::ALL
        .iter()
        .flat_map(|pass| (pass.overrides)(&options));
    let given: BTreeSet<String> = features
        .chain(own.map(|(name, _)| name))
        .chain(OTHER_OVERRIDES)
        .map(str::to_owned)
        .collect();
    let declared: BTreeSet<String> = shipped()
        .flat_map(|shader| shader.overrides.iter().map(|o| o.name.clone()))
        .collect();
    assert_eq!(given, declared);
}

/// Pairs of features are validated apart and together.
#[test]
fn variants_let_two_features_meet() {
    let sets = Features::variants();
    type Get = fn(&Features) -> bool;
    let pairs: [[Get; 2]; 6] = [
        [|f| f.panorama, |f| f.indirect],
        [|f| f.sheen, |f| f.iridescence],
        [|f| f.layers, |f| f.indirect],
        [|f| f.emitters, |f| f.sampled_environment],
        [|f| f.details, |f| f.layers],
        [|f| f.multiple_scattering, |f| f.full_radiance],
    ];
    for (index, [a, b]) in pairs.into_iter().enumerate() {
        let found = |on: [bool; 2]| sets.iter().any(|set| [a(set), b(set)] == on);
        let all = [[false, false], [false, true], [true, false], [true, true]];
        assert!(all.into_iter().all(found), "pair {index}");
    }
    let follow = sets.iter().all(|set| *set == set.with_followers());
    assert!(follow, "{sets:?}");
}
