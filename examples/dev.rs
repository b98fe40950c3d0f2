use reflet::{
    gpu::*,
    render::{aov::Aov, *},
    scene::{desc::Method, parse},
    world::load,
};
fn main() {
    let args: Vec<String> = std::env::args().collect();
    let (desc, _) = parse::load(std::path::Path::new(&args[1]), &args[3..].to_vec())
        .unwrap_or_else(|e| {
            for d in e {
                eprintln!("{}", d.message);
            }
            std::process::exit(3)
        });
    let t = std::time::Instant::now();
    let options = load::LoadOptions {
        assets: vec!["/work/shared/assets".into()],
        ..Default::default()
    };
    let world = load::load(&desc, &options).unwrap_or_else(|e| {
        for d in e {
            eprintln!("{} {:?}", d.message, d.file);
        }
        std::process::exit(3)
    });
    for w in &world.warnings {
        eprintln!("warning: {}", w.message);
    }
    eprintln!("load {:?}", t.elapsed());
    let gpu = Gpu::new(&GpuOptions::default()).unwrap();
    let lib = ShaderLibrary::embedded();
    let mut ro = RenderOptions {
        reflection: desc.reflection,
        image: desc.image,
        general: false,
    };
    for (m, name) in [
        (Method::Ssr, "ssr"),
        (Method::Rt, "rt"),
        (Method::Hybrid, "hybrid"),
    ] {
        ro.reflection.method = m;
        let t = std::time::Instant::now();
        let mut r = Renderer::new(&gpu, &lib, &world, &ro).unwrap_or_else(|e| panic!("{e}"));
        eprintln!("new {:?} {:?}", t.elapsed(), r.plan().dropped);
        let cam = &world.cameras[0].value;
        let _ = r.picture(&gpu, &world, cam, &[]);
        let p = r
            .picture(&gpu, &world, cam, &[Aov::Cause])
            .unwrap_or_else(|e| panic!("{e}"));
        eprintln!(
            "{name}: frame {:.1} ms, tree {:.1} ms, rays {} {:?} Mray/s",
            p.stats.frame_ms,
            p.stats.tree_ms,
            p.stats.rays,
            p.stats.rays_per_s().map(|r| r / 1e6)
        );
        for (n, ms) in &p.stats.passes_ms {
            eprint!(" {n} {ms:.1}");
        }
        eprintln!();
        for c in p.stats.shares.sources.iter().chain(&p.stats.shares.causes) {
            eprint!(" {} {:.1}%", c.name, c.percent);
        }
        eprintln!();
        image::save_buffer(
            format!("{}-{name}.png", args[2]),
            &p.display,
            p.size[0],
            p.size[1],
            image::ColorType::Rgba8,
        )
        .unwrap();
        if let PlaneData::U32(c) = &p.planes[0].data {
            let px: Vec<u8> = c
                .iter()
                .flat_map(|c| {
                    reflet::render::cause::Cause::from_number(*c)
                        .unwrap()
                        .color()
                })
                .collect();
            image::save_buffer(
                format!("{}-{name}-cause.png", args[2]),
                &px,
                p.size[0],
                p.size[1],
                image::ColorType::Rgb8,
            )
            .unwrap();
        }
    }
}
