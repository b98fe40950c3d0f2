// Variant of fog without emitters.

fn scattered_of_emitters(way: Way, index: u32) -> Scattered {
    return Scattered();
}
