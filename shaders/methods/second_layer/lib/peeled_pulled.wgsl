// Variant without indexed drawing; see triangles_pulled.wgsl.
