// Variant without capsules.
