// Variant without indexed drawing: the device has no primitive index, or the geometry is in several buffers; all
// vertices are pulled.
