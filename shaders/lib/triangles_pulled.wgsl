// The device does not number triangles, or the geometry is in several buffers: all vertices are pulled.
