// Variant without decals: surfaces are as their materials say.

const HAS_DECALS: bool = false;

fn with_decals(s: Surface, instance: u32, plain: vec3f, behind: bool, footprint: f32) -> Surface {
    return s;
}
