//! Tests of `specialize.rs`, without a GPU.

use naga::{
    front::wgsl,
    valid::{Capabilities, ValidationFlags, Validator},
};

use super::*;

const TEXT: &str = "
    override A: bool = true;
    override B: bool = false;
    @group(0) @binding(0) var<storage, read_write> out: array<u32>;
    @group(0) @binding(1) var<storage, read> of_a: array<u32>;
    @group(0) @binding(2) var<storage, read> of_b: array<u32>;
    fn with_a(i: u32) -> u32 { return of_a[i]; }
    fn with_b(i: u32) -> u32 { return of_b[i]; }
    fn has_b(i: u32) -> bool { return B && of_b[i] > 0u; }
    fn unset() -> bool {
        var known: bool;
        if (out[2] == 0u) { known = true; }
        return known;
    }
    fn chosen(i: u32) -> u32 {
        var sum = 0u;
        for (var k = 0u; k < 4u; k++) {
            if (B) { continue; }
            if (A) { sum += k; } else { break; }
            sum += 1u;
        }
        loop {
            if (A) { break; }
            let step = sum + 1u;
            continuing { sum += step; break if step > 9u; }
        }
        if (unset()) { sum += 1u; }
        if (has_b(i)) { sum += with_b(i); }
        if (A && i > 3u) { sum += with_a(i); }
        if (!(B || !A) || i > 5u) { sum += 1u; }
        loop {
            if (!B) { break; }
            sum += with_b(i);
        }
        switch i {
            case 1u: { if (B && A) { return with_b(i); } }
            default: {}
        }
        if (B) { return sum + with_b(i); } else { return sum; }
    }
    @compute @workgroup_size(1) fn main() { out[0] = chosen(out[1]); }
    @compute @workgroup_size(1) fn other() { out[1] = with_b(0u); }
";

fn names(constants: &[(&str, f64)], entry: Option<&str>) -> Vec<String> {
    let module = wgsl::parse_str(TEXT).expect("parses");
    let validate = |module: &Module| {
        Validator::new(ValidationFlags::all(), Capabilities::empty())
            .validate(module)
            .expect("is valid")
    };
    let info = validate(&module);
    let special = specialized(&module, &info, entry, constants).expect("specializes");
    validate(&special);
    assert!(special.overrides.is_empty());
    let functions = special.functions.iter().filter_map(|(_, f)| f.name.clone());
    let globals = special.global_variables.iter();
    functions
        .chain(globals.filter_map(|(_, g)| g.name.clone()))
        .collect()
}

/// `has_b` stays as a call without a use, but its reads and its branch are gone.
#[test]
fn what_constants_leave_out_is_gone() {
    let main = Some("main");
    let found = names(&[], main);
    assert_eq!(found, ["with_a", "has_b", "unset", "chosen", "out", "of_a"]);
    let found = names(&[("A", 0.0)], main);
    assert_eq!(found, ["has_b", "unset", "chosen", "out"]);
    let found = names(&[("B", 1.0)], main);
    let all = [
        "with_a", "with_b", "has_b", "unset", "chosen", "out", "of_a", "of_b",
    ];
    assert_eq!(found, all);
}

/// Variables declared in the source text have an initial value: one stored value does not make them constant.
#[test]
fn variables_of_the_author_are_not_constants() {
    let module = wgsl::parse_str(TEXT).expect("parses");
    let is_unset = |f: &&Function| f.name.as_deref() == Some("unset");
    let mut functions = module.functions.iter().map(|(_, f)| f);
    let unset = functions.find(is_unset).expect("it is there");
    assert!(constant_temporaries(Facts::new(&module, &[], &[]), unset, &[]).is_empty());
}

#[test]
fn other_entry_points_stay_where_none_is_chosen() {
    let found = names(&[("A", 0.0)], None);
    assert_eq!(found, ["with_b", "has_b", "unset", "chosen", "out", "of_b"]);
}

#[test]
fn names_of_no_override_are_refused() {
    let module = wgsl::parse_str(TEXT).expect("parses");
    let info = Validator::new(ValidationFlags::all(), Capabilities::empty())
        .validate(&module)
        .expect("is valid");
    assert!(specialized(&module, &info, None, &[("C", 1.0)]).is_err());
}
