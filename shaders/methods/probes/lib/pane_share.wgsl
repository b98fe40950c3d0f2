// Panes on the maps of probes: which of them count, and the share of light that they let pass.

// Maximum number of clear panes behind each other that maps tell from the surfaces behind them.
const MAX_CLEAR_PANES: u32 = 16u;
// Cosine of the largest angle between rays before and behind panes that count as one.
const SAME_DIRECTION: f32 = 0.9999;

fn is_same_direction(a: vec3f, b: vec3f) -> bool {
    return dot(a, b) > SAME_DIRECTION;
}

// Ten bits for each channel; a look-up unpacks them.
fn packed_share(share: vec3f) -> u32 {
    let rounded = vec3u(round(saturate(share) * 1023.0));
    return rounded.x | (rounded.y << 10u) | (rounded.z << 20u);
}
