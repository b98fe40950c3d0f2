// Variant without capsules for the camera to see.
