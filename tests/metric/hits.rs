//! False accepts and false rejects.

use reflet::metric::hits::{
    CauseCode, CauseTally, HitError, HitPlane, HitPlanes, Tolerance, Verdict, tally,
};

const fn code(code: u32, name: &'static str, verdict: Verdict) -> CauseCode {
    CauseCode {
        code,
        name,
        verdict,
    }
}

const NOTHING: f32 = f32::INFINITY;
const CODES: [CauseCode; 4] = [
    code(0, "rough", Verdict::NotAsked),
    code(1, "hit", Verdict::Accepted),
    code(2, "none", Verdict::Empty),
    code(7, "hidden", Verdict::Rejected),
];
const TOLERANCE: Tolerance = Tolerance {
    absolute_m: 0.01,
    relative: 0.02,
};

/// Test pixel: cause, screen distance and surface, ray distance and surface.
type Pixel = (u32, f32, u32, f32, u32);

fn check(pixels: &[Pixel]) -> Result<Vec<CauseTally>, HitError> {
    let cause: Vec<u32> = pixels.iter().map(|p| p.0).collect();
    let screen_m: Vec<f32> = pixels.iter().map(|p| p.1).collect();
    let screen: Vec<u32> = pixels.iter().map(|p| p.2).collect();
    let ray_m: Vec<f32> = pixels.iter().map(|p| p.3).collect();
    let ray: Vec<u32> = pixels.iter().map(|p| p.4).collect();
    let planes = HitPlanes {
        cause: &cause,
        screen: HitPlane {
            distance_m: &screen_m,
            surface: &screen,
        },
        ray: HitPlane {
            distance_m: &ray_m,
            surface: &ray,
        },
    };
    tally(&planes, &CODES, TOLERANCE)
}

/// Counts of a tally: pixels, false accepts, false rejects, ray missed, other surface, other distance, overlooked.
fn counts(t: &CauseTally) -> [usize; 7] {
    let accepts = [
        t.ray_missed,
        t.other_surface,
        t.other_distance,
        t.overlooked,
    ];
    let [missed, surface, distance, overlooked] = accepts;
    [
        t.pixels,
        t.false_accepts,
        t.false_rejects,
        missed,
        surface,
        distance,
        overlooked,
    ]
}

#[test]
fn each_kind_of_error_is_counted_once() {
    let found = check(&[
        (1, 2.0, 5, 2.0, 5),         // right
        (1, 2.0, 5, 2.03, 5),        // right: within 2 % of 2.03
        (1, 0.1, 5, 0.109, 5),       // right: within 1 cm
        (1, 2.0, 5, 2.05, 5),        // too far off
        (1, 2.0, 5, 2.0, 6),         // another surface
        (1, 2.0, 5, 4.0, 6),         // both: counted as another surface
        (1, 2.0, 5, NOTHING, 0),     // the ray met nothing
        (1, NOTHING, 0, 2.0, 5),     // accepted nothing
        (1, NOTHING, 0, NOTHING, 0), // both nothing
        (2, NOTHING, 0, NOTHING, 0), // right
        (2, NOTHING, 0, 3.0, 5),     // overlooked
        (7, 2.0, 5, 2.0, 5),         // refused for nothing
        (7, 2.0, 5, 3.0, 5),         // rightly refused
        (7, 2.0, 5, 2.0, 6),         // rightly refused
        (7, 2.0, 5, NOTHING, 0),     // rightly refused
        (7, NOTHING, 0, 2.0, 5),     // no candidate
        (0, 2.0, 5, NOTHING, 0),     // not asked
        (0, f32::NAN, 5, -1.0, 0),   // not asked, so not read
    ])
    .expect("good planes");
    let found: Vec<_> = found.iter().map(|t| (t.name, counts(t))).collect();
    assert_eq!(
        found,
        [
            ("rough", [2, 0, 0, 0, 0, 0, 0]),
            ("hit", [9, 5, 0, 1, 2, 1, 1]),
            ("none", [2, 1, 0, 0, 0, 0, 1]),
            ("hidden", [5, 0, 1, 0, 0, 0, 0]),
        ]
    );
}

#[test]
fn bad_planes_are_refused() {
    assert_eq!(
        check(&[(1, 1.0, 0, 1.0, 0), (3, 1.0, 0, 1.0, 0)]),
        Err(HitError::Code { code: 3, pixel: 1 })
    );
    for bad in [f32::NAN, -1.0, f32::NEG_INFINITY] {
        assert_eq!(
            check(&[(1, bad, 0, 1.0, 0)]),
            Err(HitError::Distance { pixel: 0 })
        );
        assert_eq!(
            check(&[(1, 1.0, 0, bad, 0)]),
            Err(HitError::Distance { pixel: 0 })
        );
    }
    let plane = HitPlane {
        distance_m: &[1.0],
        surface: &[1],
    };
    let short = HitPlane {
        distance_m: &[1.0],
        surface: &[],
    };
    let planes = HitPlanes {
        cause: &[1],
        screen: plane,
        ray: short,
    };
    assert_eq!(
        tally(&planes, &CODES, TOLERANCE),
        Err(HitError::Length([1, 1, 1, 1, 0]))
    );
}

#[test]
fn no_pixels_are_no_errors() {
    assert!(
        check(&[])
            .expect("good planes")
            .iter()
            .all(|t| counts(t) == [0; 7])
    );
}

#[test]
fn a_distance_at_the_tolerance_agrees() {
    let planes = |screen: &'static [f32], ray: &'static [f32]| HitPlanes {
        cause: &[1, 1],
        screen: HitPlane {
            distance_m: screen,
            surface: &[4, 4],
        },
        ray: HitPlane {
            distance_m: ray,
            surface: &[4, 4],
        },
    };
    let wrong = |planes: HitPlanes, absolute_m, relative| {
        let tolerance = Tolerance {
            absolute_m,
            relative,
        };
        tally(&planes, &CODES, tolerance).expect("good planes")[1].false_accepts
    };
    assert_eq!(wrong(planes(&[0.0, 2.5], &[0.0, 2.0]), 0.5, 0.0), 0);
    assert_eq!(wrong(planes(&[0.0, 2.5], &[0.0, 2.0]), 0.0, 0.25), 0);
    assert_eq!(wrong(planes(&[0.0, 2.5], &[0.0, 2.0]), 0.4, 0.2), 1);
}
