//! Tests of parameters and variants.

use super::*;

#[test]
fn a_parameter_changes_its_setting_and_nothing_else() {
    let settings = ReflectionDesc {
        method: Method::Hybrid,
        ..ReflectionDesc::default()
    };
    type Change = fn(&mut ReflectionDesc);
    let changes: [(Parameter, Change); 5] = [
        (Parameter::ThresholdU, |r| {
            (r.accept, r.threshold_u) = (Accept::Threshold, 8.0);
        }),
        (Parameter::EdgePx, |r| r.edge_px = 8.0),
        (Parameter::Steps, |r| r.steps = 8),
        (Parameter::RayLengthU, |r| r.ray_length_u = 8.0),
        (Parameter::Bounces, |r| r.bounces = Bounces::AtMost(8)),
    ];
    for (parameter, change) in changes {
        let varied = Variant::sweep(Method::Hybrid, &settings, parameter, &[8.0]);
        let mut changed = settings;
        change(&mut changed);
        assert_eq!(varied[0].reflection, changed);
    }
    let scaled = Variant::sweep(Method::Rt, &settings, Parameter::Scale, &[0.5])[0];
    assert_eq!(scaled.rendered_size([641, 1]), [321, 1]);
    assert_eq!(scaled.label(), "rt, scale = 0.5");
}

#[test]
fn a_parameter_without_effect_makes_one_variant() {
    let settings = ReflectionDesc::default();
    for parameter in [Parameter::ThresholdU, Parameter::Steps] {
        let variants = Variant::sweep(Method::Rt, &settings, parameter, &[8.0, 16.0]);
        assert_eq!(variants.len(), 1);
        assert_eq!(variants[0].value, None);
    }
    assert_eq!(
        Variant::sweep(Method::Ssr, &settings, Parameter::Bounces, &[1.0, 2.0]).len(),
        1
    );
}

#[test]
fn defaults_are_in_range_and_other_values_are_refused() {
    for parameter in Parameter::ALL {
        assert_eq!(Parameter::from_name(parameter.name()), Some(parameter));
        parameter
            .default_values()
            .iter()
            .for_each(|&v| parameter.check(v).expect("in range"));
        assert!(parameter.check(f64::NAN).is_err() && parameter.check(-1.0).is_err());
    }
    let says = Parameter::Steps.check(16.5).expect_err("no whole number");
    assert_eq!(says, "steps = 16.5: must be a whole number from 8 to 4096");
    for (parameter, value, says) in [
        (
            Parameter::RayLengthU,
            f64::INFINITY,
            "above 0 and at most 1e12",
        ),
        (Parameter::RayLengthU, 1e-300, "above 0"), // 0 in single precision
        (Parameter::ThresholdU, 1e300, "0 to 1e12"),
    ] {
        let error = parameter.check(value).expect_err("out of range");
        assert_eq!(
            error,
            format!("{} = {value:?}: must be {says}", parameter.name())
        );
    }
}

#[test]
fn a_rate_between_two_and_four_is_told_which_are_allowed() {
    for value in [3.0, 2.5, 8.0] {
        let says = Parameter::Rate.check(value).expect_err("no such rate");
        assert!(says.contains("must be 1, 2 or 4"), "{value}: {says}");
    }
    for value in [1.0, 2.0, 4.0] {
        assert_eq!(Parameter::Rate.check(value), Ok(()));
    }
}
