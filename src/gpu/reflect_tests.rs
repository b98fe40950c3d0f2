//! Tests of `reflect.rs`, without a GPU.

use super::*;
use crate::{
    bind::{merged_bindings, over_limits},
    shader::ShaderLibrary,
};

const PASS: &str = "
#import types
override steps: u32;
@id(7) override scale: f32 = 1.0;
@group(0) @binding(0) var<uniform> frame: Frame;
@group(2) @binding(1) var depth: texture_depth_2d;
@group(2) @binding(0) var color: texture_2d<f32>;
@group(2) @binding(2) var loaded: texture_2d<f32>;
@group(2) @binding(3) var linear: sampler;
@group(2) @binding(4) var<storage, read> rays: array<vec4f>;
@group(2) @binding(5) var mask: texture_storage_2d<r32uint, write>;
@group(2) @binding(6) var unused: texture_2d<f32>;
@compute @workgroup_size(8, 4)
fn main(@builtin(global_invocation_id) id: vec3u) {
    let d = textureLoad(depth, id.xy, 0) + textureLoad(loaded, id.xy, 0).x;
    let c = textureSampleLevel(color, linear, vec2f(d), 0.0) * frame.tint.w * rays[id.x].x;
    textureStore(mask, id.xy, vec4u(u32(c.x * scale) + steps));
}
";

fn reflected(text: &str) -> Result<ShaderModuleInfo, ShaderError> {
    let library = ShaderLibrary::from_texts(&[
        ("pass.wgsl", text),
        (
            "lib/types.wgsl",
            "// types\nstruct Frame {\n    size: vec2u,\n    tint: vec4f,\n    time_s: f32,\n}\n",
        ),
    ]);
    let source = library.source("pass")?;
    check(
        &source,
        &parse(&source)?,
        capabilities(wgpu::Features::empty()),
    )
}

#[test]
fn everything_a_pipeline_needs_is_listed() {
    let info = reflected(PASS).expect("valid");
    let main = info.entry_point("main").expect("listed");
    assert_eq!(main.workgroup_size, [8, 4, 1]);
    assert_eq!(main.stage, wgpu::ShaderStages::COMPUTE);
    let keys: Vec<_> = info
        .overrides
        .iter()
        .map(|o| (o.key.as_str(), o.optional))
        .collect();
    assert_eq!(keys, [("steps", false), ("7", true)]);

    let frame = info.layout_of("Frame").expect("listed");
    let fields: Vec<_> = frame
        .fields
        .iter()
        .map(|f| (f.name.as_str(), f.offset, f.size))
        .collect();
    assert_eq!(frame.size, 48);
    assert_eq!(
        fields,
        [("size", 0, 8), ("tint", 16, 16), ("time_s", 32, 4)]
    );

    let names: Vec<_> = info
        .bindings
        .iter()
        .map(|b| (b.group, b.binding, b.name.as_str()))
        .collect();
    assert_eq!(
        names,
        [
            (0, 0, "frame"),
            (2, 0, "color"),
            (2, 1, "depth"),
            (2, 2, "loaded"),
            (2, 3, "linear"),
            (2, 4, "rays"),
            (2, 5, "mask")
        ]
    );
    let float = |filterable| wgpu::BindingType::Texture {
        sample_type: wgpu::TextureSampleType::Float { filterable },
        view_dimension: wgpu::TextureViewDimension::D2,
        multisampled: false,
    };
    assert_eq!(info.bindings[1].ty, float(true));
    assert_eq!(info.bindings[3].ty, float(false));
    assert_eq!(
        info.bindings[5].ty,
        wgpu::BindingType::Buffer {
            ty: wgpu::BufferBindingType::Storage { read_only: true },
            has_dynamic_offset: false,
            min_binding_size: wgpu::BufferSize::new(16),
        }
    );
    assert_eq!(info.bindings[0].declared_at, "shaders/pass.wgsl:5");
}

#[test]
fn errors_point_at_the_edited_line_through_imports() {
    let unknown = PASS.replace("frame.tint.w", "frame.tnt.w");
    let error = reflected(&unknown).expect_err("no such member").to_string();
    assert!(error.starts_with("shaders/pass.wgsl:16:"), "{error}");
    assert!(
        error.contains("tnt") && error.contains("\n   | ") && error.contains("^^^"),
        "{error}"
    );

    let library = ShaderLibrary::from_texts(&[
        (
            "pass.wgsl",
            "#import bvh\n@compute @workgroup_size(1) fn main() { _ = f(); }",
        ),
        (
            "lib/bvh.wgsl",
            "// one\nfn f() -> u32 {\n\treturn 1.5;\n}\n",
        ),
    ]);
    let source = library.source("pass").expect("assembles");
    let error = parse(&source).expect_err("f32 is no u32");
    let at = error.location.as_ref().expect("placed");
    assert_eq!((&*at.file, at.line), ("shaders/lib/bvh.wgsl", 3), "{error}");
}

#[test]
fn validation_errors_carry_their_cause() {
    let text = "@compute @workgroup_size(1) fn main() {\n    let x = array(1, 2);\n    \
                    workgroupBarrier();\n    loop { }\n    return;\n}\n\
                    @fragment fn paint() -> @location(0) vec4f { return vec4f(dpdx(1.0)); }\n\
                    @compute @workgroup_size(1) fn wrong() { _ = dpdx(1.0); }\n";
    let error = reflected(text)
        .expect_err("derivatives need a fragment stage")
        .to_string();
    assert!(
        error.contains("wrong") && error.contains("shaders/pass.wgsl:"),
        "{error}"
    );
}

#[test]
fn groups_join_and_disagreements_are_named() {
    let a = reflected(PASS).expect("valid");
    let fragment = "
#import types
@group(0) @binding(0) var<uniform> frame: Frame;
@group(2) @binding(0) var color: texture_2d<u32>;
@fragment fn main() -> @location(0) vec4f {
    return frame.tint + vec4f(textureLoad(color, vec2u(0), 0));
}
";
    let b = reflected(fragment).expect("valid");
    let joined = merged_bindings(&[&a, &b], 0).expect("same frame");
    let both = wgpu::ShaderStages::COMPUTE | wgpu::ShaderStages::FRAGMENT;
    assert_eq!(joined[0].visibility, both);
    let error = merged_bindings(&[&a, &b], 2).expect_err("float against uint");
    assert!(
        error.contains("shaders/pass.wgsl:7") && error.contains("`color`"),
        "{error}"
    );
}

#[test]
fn limits_hold_over_the_whole_layout() {
    let declare = |n: u32| {
        let name = |i: u32| {
            format!(
                "@group({}) @binding({i}) var<storage, read> b{i}: array<u32>;\n",
                i % 2
            )
        };
        let sum: Vec<_> = (0..n).map(|i| format!("b{i}[0]")).collect();
        let all: String = (0..n).map(name).collect();
        reflected(&format!(
            "{all}@group(2) @binding(0) var<storage, read_write> o: u32;\n\
                 @compute @workgroup_size(1) fn main() {{ o = {}; }}",
            sum.join(" + ")
        ))
        .expect("valid")
    };
    let problems = |n: u32| {
        let info = declare(n);
        let groups: Vec<_> = (0..3)
            .map(|g| merged_bindings(&[&info], g).expect("one"))
            .collect();
        let groups: Vec<&[Binding]> = groups.iter().map(Vec::as_slice).collect();
        over_limits(&groups, &wgpu::Limits::default())
    };
    assert!(problems(7).is_empty());
    let over = problems(8);
    assert_eq!(over.len(), 1);
    assert!(
        over[0].starts_with("9 storage buffers in the compute stage, 8 allowed"),
        "{over:?}"
    );
}
