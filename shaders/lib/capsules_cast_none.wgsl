// Variant without capsules that cast shadows into maps.
