// Box around the camera in which method near-far traces rays.

#import far_structs

@group(2) @binding(22) var<uniform> far_box: FarBox;
