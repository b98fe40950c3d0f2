// Variant without thin films.

#import scene

fn with_film(s: Surface, instance: u32, index: array<u32, 3>, bary: vec2f, area2: f32, footprint: f32, cosine: f32) -> Surface {
    return s;
}
