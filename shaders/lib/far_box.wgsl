// Box around the camera in which method near-far traces rays.

struct FarBox {
    eye: vec3f, // middle of the box, from which the maps are captured
    half_size_m: f32, // its faces are axis-aligned
    layers: u32, // number of maps, from near to far
    steps: u32, // maximum number of steps of a march through the maps
    separation_m: f32, // minimum distance between what successive maps see along a ray
    pad0: u32,
}

@group(2) @binding(22) var<uniform> far_box: FarBox;
