//! Renders a scene of this folder to pixels and reads two of its AOVs:
//! `cargo run -p reflet-render --example render_to_pixels [SCENE [OUT.png]]`.

use std::{env, error::Error};

use reflet_render::{
    PlaneData,
    pipeline::cause::Source,
    runtime::{Session, SessionOptions},
};

fn main() -> Result<(), Box<dyn Error>> {
    let mut arguments = env::args().skip(1);
    let scene = arguments.next();
    let scene = scene.unwrap_or_else(|| "scenes/mirrors.toml".to_owned());

    let mut session = Session::open(scene, &SessionOptions::default())?;
    session.set(["image.size=[320, 180]", "image.samples=4"])?;
    let picture = session.render(&["depth", "source"])?;

    let [width, height] = picture.size;
    if let Some(path) = arguments.next() {
        let color = image::ColorType::Rgba8;
        image::save_buffer(path, &picture.display, width, height, color)?;
    }
    println!("{width} x {height} pixels");
    if let PlaneData::F32(depths) = &picture.planes[0].data {
        let nearest_m = depths.iter().copied().fold(f32::INFINITY, f32::min);
        println!("the nearest is {nearest_m} m away");
    }
    if let PlaneData::U32(sources) = &picture.planes[1].data {
        let is_traced = |source: &&u32| **source == Source::Traced as u32;
        let num_traced = sources.iter().filter(is_traced).count();
        println!("{num_traced} of them show a traced reflection");
    }
    Ok(())
}
