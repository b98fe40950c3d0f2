// The environment as a gradient from straight up over the horizon to straight down.

#import frame

fn environment(direction: vec3f) -> vec3f {
    let y = clamp(direction.y, -1.0, 1.0);
    return frame.horizon
        + (frame.zenith - frame.horizon) * max(y, 0.0)
        + (frame.ground - frame.horizon) * max(-y, 0.0);
}

// Share of rays that follow bright parts of the environment: 0, a gradient has none.
fn environment_share(normal: vec3f) -> f32 {
    return 0.0;
}

fn environment_pdf(direction: vec3f, normal: vec3f) -> f32 {
    return 0.0;
}

fn environment_direction(u: vec2f, normal: vec3f) -> vec3f {
    return vec3f(0.0, 1.0, 0.0);
}
