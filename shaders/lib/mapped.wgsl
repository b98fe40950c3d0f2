// Common parts of the marches of reflection rays through maps.

#import cause

// Number of halvings of a step in which the ray goes behind a surface.
const HALVINGS: u32 = 12u;
// Maximum distance on the face of a point on a triangle from where the ray goes behind what the map sees, pixels.
const SAME_PLACE_PX: f32 = 1.5;
// Cosine between the line of sight and the normal of a surface below which the map sees it edge-on.
const EDGE_ON: f32 = 0.2;

// Number of steps through maps since the invocation started.
var<private> map_steps: u32 = 0u;
// How the last ray ended.
var<private> map_cause: u32 = CAUSE_UNMARCHED;
