//! Probabilities of light trees on the device, beside the CPU's.

use reflet::{
    gpu::{ShaderLibrary, readback::read_buffer},
    render::{
        buffers::chunks::Chunks, passes, pipeline::shader_variant::ShaderVariant, plan::Features,
        upload::emitters::GpuEmitters,
    },
    scene::desc::{LightDesc, LightKind, ShadowMode},
    world::{
        Light,
        light_tree::{Chosen, LIGHT_LEAF, LightTrees, Tree},
    },
};
use wgpu::util::DeviceExt as _;

use super::kit::*;
use super::{
    light_tree::{FLOOR, LAMPS},
    many_lamps::lamps,
};

/// Chooses an emitter for each query, and gives the probabilities of another one. It stands below the text of a pass,
/// of which only what it calls is compiled.
const KERNEL: &str = include_str!("light_tree_kernel/kernel.wgsl");

#[repr(C)]
#[derive(Clone, Copy, bytemuck::Pod, bytemuck::Zeroable)]
struct Query {
    position: [f32; 3],
    by_power: u32,
    normal: [f32; 3],
    /// Emitter whose probabilities are asked for, as in [`Answer`].
    instance: u32,
    u: [f32; 2],
    item: u32,
    pad: u32,
}

#[repr(C)]
#[derive(Clone, Copy, Debug, bytemuck::Pod, bytemuck::Zeroable)]
struct Answer {
    /// Chosen instance; `u32::MAX` for a lamp.
    instance: u32,
    /// Chosen triangle, or number of a lamp's record.
    item: u32,
    chosen: [f32; 2],
    known: [f32; 2],
}

/// Runs the kernel over the trees of a world.
fn answers(gpu: &Gpu, emitters: &GpuEmitters, queries: &[Query]) -> Vec<Answer> {
    let features = Features {
        emissive_lights: true,
        tree_lamps: true,
        sized_lamps: true,
        ..Features::default()
    };
    let variant = ShaderVariant {
        features: features.with_followers(),
        chunks: Chunks {
            storage_texels: gpu.reads_storage_texels,
            ..Chunks::default()
        },
        ..ShaderVariant::default()
    };
    let library = variant
        .library(&ShaderLibrary::embedded(), &passes::ALL)
        .expect("it has all files");
    let pass = library.source("light").expect("it assembles");
    let text = format!("{}\n{KERNEL}", pass.text);
    let device = &gpu.device;
    let module = device.create_shader_module(wgpu::ShaderModuleDescriptor {
        label: Some("light tree"),
        source: wgpu::ShaderSource::Wgsl(text.into()),
    });
    let pipeline = device.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
        label: Some("light tree"),
        layout: None,
        module: &module,
        entry_point: Some("choose"),
        compilation_options: Default::default(),
        cache: None,
    });
    let buffer = |contents: &[u8], usage| {
        device.create_buffer_init(&wgpu::util::BufferInitDescriptor {
            label: None,
            contents,
            usage,
        })
    };
    let mut sampling = [0_u32; 12];
    sampling[8..].copy_from_slice(&bytemuck::cast::<_, [u32; 4]>(emitters.light_tree));
    let sampling = buffer(bytemuck::bytes_of(&sampling), wgpu::BufferUsages::UNIFORM);
    let asked = buffer(bytemuck::cast_slice(queries), wgpu::BufferUsages::STORAGE);
    let empty = vec![0; size_of::<Answer>() * queries.len()];
    let usage = wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_SRC;
    let given = buffer(&empty, usage);
    let entry = |binding, resource| wgpu::BindGroupEntry { binding, resource };
    let groups = [
        vec![entry(5, sampling.as_entire_binding())],
        vec![entry(16, emitters.resource())],
        vec![
            entry(20, asked.as_entire_binding()),
            entry(21, given.as_entire_binding()),
        ],
    ];
    let mut encoder = device.create_command_encoder(&Default::default());
    let mut pass = encoder.begin_compute_pass(&Default::default());
    pass.set_pipeline(&pipeline);
    for (index, entries) in (0..).zip(&groups) {
        let group = device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: None,
            layout: &pipeline.get_bind_group_layout(index),
            entries,
        });
        pass.set_bind_group(index, &group, &[]);
    }
    pass.dispatch_workgroups((queries.len() as u32).div_ceil(64), 1, 1);
    drop(pass);
    gpu.queue.submit([encoder.finish()]);
    read_buffer(gpu, &given).expect("it is read")
}

/// Numbers in [0, 1), the same in each run (Weyl's sequences).
fn numbers(index: u32) -> [f32; 7] {
    [
        0.754_877_7,
        0.569_840_3,
        0.430_159_7,
        0.819_172_5,
        0.671_043_6,
        0.549_700_5,
        0.450_299_5_f64,
    ]
    .map(|step| (f64::from(index + 1) * step).fract() as f32)
}

#[test]
fn the_device_chooses_with_the_probabilities_of_the_cpu() {
    let Some(gpu) = gpu() else { return };
    let (_, world) = scene(&[FLOOR, LAMPS, &lamps(0..66)].concat(), &[]);
    let trees = LightTrees::new(&world, None);
    let emitters = GpuEmitters::new(gpu, &world, Default::default())
        .expect("it fits")
        .expect("it has emitters");
    let records = trees.lights.len() as u32;
    let words = |what: Chosen| match what {
        Chosen::Triangle { instance, triangle } => [instance, triangle],
        Chosen::Lamp(lamp) => [u32::MAX, records + lamp],
    };
    let mut known: Vec<Chosen> = (world.emitters().into_iter())
        .map(|e| Chosen::Triangle {
            instance: e.instance,
            triangle: e.triangle,
        })
        .collect();
    known.extend((0..world.lamps.len() as u32).map(Chosen::Lamp));
    let count = 20_000;
    let of = |index: u32| {
        let [x, y, z, a, b, u, v] = numbers(index);
        let point = Vec3::new(8.0 * x - 4.0, 4.0 * y - 0.5, 8.0 * z - 4.0);
        let (height, turn) = (2.0 * a - 1.0, std::f32::consts::TAU * b);
        let flat = (1.0 - height * height).sqrt();
        let normal = Vec3::new(flat * turn.cos(), height, flat * turn.sin());
        let other = known[index as usize % known.len()];
        (
            point,
            normal.normalize(),
            [u, v],
            index.is_multiple_of(3),
            other,
        )
    };
    let queries: Vec<Query> = (0..count)
        .map(|index| {
            let (point, normal, u, by_power, other) = of(index);
            let [instance, item] = words(other);
            Query {
                position: point.to_array(),
                by_power: u32::from(by_power),
                normal: normal.to_array(),
                instance,
                u,
                item,
                pad: 0,
            }
        })
        .collect();
    let (mut same, mut lamps_chosen, mut positive) = (0, 0, 0);
    let close = |found: [f32; 2], expected: [f32; 2], index: u32| {
        for (found, expected) in found.into_iter().zip(expected) {
            let off = (found - expected).abs();
            assert!(
                off <= 2e-3 * expected + 1e-6,
                "{found}, not {expected}: {index}"
            );
        }
    };
    for (answer, index) in answers(gpu, &emitters, &queries).into_iter().zip(0..) {
        let (point, normal, u, by_power, other) = of(index);
        let chances = trees.chances(other, point, normal);
        close(answer.known, chances, index);
        positive += u32::from(chances[0] > 0.0);
        let chosen = trees.choose(u, by_power, point, normal);
        let Some(chosen) = chosen.filter(|c| by_power || c.chances[0] > 0.0) else {
            same += u32::from(answer.chosen == [0.0; 2]);
            continue;
        };
        // Rounding moves the borders between the shares of two emitters.
        if words(chosen.what) == [answer.instance, answer.item] {
            same += 1;
            close(answer.chosen, chosen.chances, index);
            lamps_chosen += u32::from(matches!(chosen.what, Chosen::Lamp(_)));
        }
    }
    assert!(same * 1000 >= count * 998, "{same} of {count}");
    assert!(lamps_chosen > count / 10, "{lamps_chosen}");
    assert!(positive > count / 4, "{positive}");
}

/// Share of the power of the weak lamps: with the digits of one number alone, 1,024 values choose among them.
const WEAK_SHARE: f64 = 1.0 / 16384.0;
const WEAK_LAMPS: u32 = 3000;

/// 197,000 lamps on a square, and 3,000 weak ones far away from them, which come last.
fn deep_world() -> World {
    let lamp = |place: Vec3, intensity_cd: f32| Light {
        name: String::new(),
        desc: LightDesc {
            shadow: ShadowMode::Ray,
            ..LightDesc::new(LightKind::Point {
                position: place,
                intensity_cd,
                radius_m: 0.0,
            })
        },
        range_m: None,
        moves: false,
    };
    let bright = 197_000;
    let weak_cd = f64::from(bright) * WEAK_SHARE / f64::from(WEAK_LAMPS);
    let on_square = |i: u32, side: u32| Vec3::new((i % side) as f32, 0.0, (i / side) as f32);
    let strong = (0..bright).map(|i| lamp(on_square(i, 444), 1.0));
    let weak = (0..WEAK_LAMPS).map(|i| lamp(Vec3::X * 5000.0 + on_square(i, 55), weak_cd as f32));
    World {
        lamps: strong.chain(weak).collect(),
        ..World::default()
    }
}

/// Sum of the shares of the lamps before the first weak one, in the order in which random numbers choose them.
fn share_before_weak(tree: &Tree, first_weak: u32) -> f64 {
    let (mut open, mut sum) = (vec![(tree.link, 1.0)], 0.0);
    while let Some((link, power)) = open.pop() {
        if link & LIGHT_LEAF == 0 {
            let node = |index: u32| &tree.nodes[index as usize];
            open.extend([link + 1, link].map(|i| (node(i).link, f64::from(node(i).cluster.power))));
        } else if link & !LIGHT_LEAF < first_weak {
            sum += power;
        } else {
            return sum;
        }
    }
    sum
}

/// Each of the rarest lamps of a deep tree is chosen as often as its probability says, which takes more digits than one
/// random number has.
#[test]
fn rare_lamps_of_a_deep_tree_are_chosen_by_their_chance() {
    let Some(gpu) = gpu() else { return };
    let world = deep_world();
    let emitters = GpuEmitters::new(gpu, &world, Default::default())
        .expect("it fits")
        .expect("it has emitters");
    let trees = LightTrees::new(&world, None);
    let first_weak = world.lamps.len() as u32 - WEAK_LAMPS;
    let top = trees.top.as_ref().expect("it has a tree");
    let start = share_before_weak(top, first_weak);
    let steps = f64::from(1 << 24);
    let first = (start * steps) as u32;
    let (values, digits) = ((WEAK_SHARE * steps) as u32, 256);
    let queries: Vec<Query> = (0..values * digits)
        .map(|k| Query {
            position: [0.0, 3.0, 0.0],
            by_power: 1,
            normal: [0.0, 1.0, 0.0],
            instance: u32::MAX,
            u: [
                (first + k / digits) as f32 / steps as f32,
                (k % digits) as f32 / digits as f32,
            ],
            item: first_weak,
            pad: 0,
        })
        .collect();
    let mut found = vec![0_u32; WEAK_LAMPS as usize];
    for answer in answers(gpu, &emitters, &queries) {
        if let Some(weak) = answer.item.checked_sub(first_weak) {
            found[weak as usize] += 1;
            let chance = f64::from(answer.chosen[1]) / (WEAK_SHARE / f64::from(WEAK_LAMPS));
            assert!((chance - 1.0).abs() < 0.01, "{chance}");
        }
    }
    // 87 each on average, with a standard deviation of at most 9.3.
    let expected = f64::from(values * digits) / f64::from(WEAK_LAMPS);
    let off = |n: &&u32| (f64::from(**n) - expected).abs() > 6.0 * expected.sqrt();
    let wrong: Vec<_> = found.iter().filter(off).collect();
    // Rounding of the way there moves the first and the last ones.
    assert!(wrong.len() <= 12, "{}: {wrong:?}", wrong.len());
}
