// The G-buffer holds all that there is of surfaces.

#import scene

fn detailed(s: Surface, pixel: vec2u) -> Surface {
    return s;
}
