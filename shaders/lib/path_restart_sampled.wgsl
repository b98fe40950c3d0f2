// Second path of an invocation, after another one.

#import extent

fn forget_path() {
    path_scatterings = 0u;
    path_is_chance = false;
    passed_m = 0.0;
}
