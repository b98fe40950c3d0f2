// Variant without random paths: a path leaves nothing behind for the next one.

fn forget_path() {}
