// Variant without indexed drawing; see triangles_pulled.wgsl.

#import layer_test
