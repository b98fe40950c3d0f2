//! `--choose`: the setting on the Pareto front that meets a bound, as a ready `[reflection]` block.

use reflet_scene::desc::Bounces;

use super::{
    pareto::{Spot, best_within, cheapest_within},
    summary::{Group, Metric, Point, digits},
};

/// Quantity that a bound limits.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Quantity {
    /// SSIM, a lower bound.
    Ssim,
    /// Mean FLIP, an upper bound.
    Flip,
    /// PSNR in dB, a lower bound.
    Psnr,
    /// relMSE, an upper bound.
    RelMse,
    /// Milliseconds per frame, an upper bound.
    Ms,
}

/// A bound on error or time, such as `ssim>=0.98`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bound {
    /// Limited quantity.
    pub quantity: Quantity,
    /// Limit, in the quantity's unit.
    pub limit: f64,
}

/// Name of each quantity, the quantity, its comparison sign, and the largest limit that makes sense.
const QUANTITIES: [(&str, Quantity, &str, f64); 5] = [
    ("ssim", Quantity::Ssim, ">=", 1.0),
    ("psnr", Quantity::Psnr, ">=", f64::MAX),
    ("flip", Quantity::Flip, "<=", 1.0),
    ("relmse", Quantity::RelMse, "<=", f64::MAX),
    ("ms", Quantity::Ms, "<=", f64::MAX),
];

impl Bound {
    /// Parses a bound.
    ///
    /// # Errors
    /// Message with the valid forms.
    pub fn parse(text: &str) -> Result<Self, String> {
        let forms = "ssim>=X, psnr>=X, flip<=X, relmse<=X or ms<=X";
        let written = [">=", "<="].into_iter().find_map(|sign| {
            text.split_once(sign)
                .map(|(name, limit)| (name, sign, limit))
        });
        let Some((name, sign, limit)) = written else {
            return Err(format!("expected {forms}"));
        };
        let name = name.trim().to_ascii_lowercase();
        let Some((_, quantity, right, most)) = QUANTITIES.iter().find(|(known, ..)| *known == name)
        else {
            return Err(format!("\"{name}\" cannot be bounded; expected {forms}"));
        };
        if sign != *right {
            return Err(format!(
                "{name}{sign} bounds the wrong side; write {name}{right}"
            ));
        }
        let limit = limit.trim().parse::<f64>().ok();
        let limit = limit.filter(|l| (0.0..=*most).contains(l)).ok_or_else(|| {
            let range = if *most == 1.0 {
                "from 0 to 1"
            } else {
                "that is 0 or more"
            };
            format!("after {sign} expected a number {range}")
        })?;
        Ok(Self {
            quantity: *quantity,
            limit,
        })
    }

    /// Bounded value of a point and the limit, both with a sign such that less is better.
    fn value(&self, point: &Point, masked: bool) -> Option<[f64; 2]> {
        let s = &point.sample;
        let value = match (self.quantity, masked) {
            (Quantity::Ssim, true) => -s.mask_ssim?,
            (Quantity::Ssim, false) => -s.ssim?,
            (Quantity::Psnr, true) => -s.mask_psnr_db?,
            (Quantity::Psnr, false) => -s.psnr_db?,
            (Quantity::Flip, _) => point.error(Metric::Flip, masked)?,
            (Quantity::RelMse, _) => point.error(Metric::RelMse, masked)?,
            (Quantity::Ms, _) => point.ms.median,
        };
        let limit = match self.quantity {
            Quantity::Ssim | Quantity::Psnr => -self.limit,
            _ => self.limit,
        };
        Some([value, limit])
    }
}

/// Best point of a group under a bound: the fastest under a bound on error, the point of least FLIP under a bound on
/// time. Values are measured inside the mask where every setting has scores there, otherwise in the frame. The point is
/// on the Pareto front of the bounded quantity.
///
/// # Errors
/// Message with the closest point when none meets the bound, or the reason why nothing can be bounded.
pub fn choose<'a>(group: &'a Group, bound: &Bound) -> Result<&'a Point, String> {
    if bound.quantity == Quantity::Psnr && group.points.iter().any(|p| p.is_mean) {
        return Err(
            "of an animation PSNR has no mean, since it is infinite in frames that are equal; bound \
             ssim, flip or relmse instead"
                .to_owned(),
        );
    }
    let values = group.points.iter();
    let known: Vec<(&Point, [f64; 2])> = values
        .filter_map(|p| bound.value(p, group.masked).map(|v| (p, v)))
        .collect();
    let spot = |(point, [value, _]): &(&Point, [f64; 2])| Spot {
        ms: point.ms.median,
        error: match bound.quantity {
            Quantity::Ms => (point.error(Metric::Flip, group.masked)).unwrap_or(f64::INFINITY),
            _ => *value,
        },
    };
    let spots: Vec<Spot> = known.iter().map(spot).collect();
    let Some((_, [_, limit])) = known.first() else {
        return Err("no setting of this scene could be judged".to_owned());
    };
    let found = match bound.quantity {
        Quantity::Ms => best_within(&spots, *limit),
        _ => cheapest_within(&spots, *limit),
    };
    found.map(|index| known[index].0).ok_or_else(|| {
        let closest = known.iter().min_by(|(_, a), (_, b)| a[0].total_cmp(&b[0]));
        let (point, [value, _]) = closest.expect("not empty");
        format!(
            "no setting meets the bound{}; the closest is {} with {}",
            match bound.quantity {
                Quantity::Ms => String::new(),
                _ => format!(" {}", region(group.masked)),
            },
            point.label(),
            digits(value.abs())
        )
    })
}

/// Name of the region in which errors are taken.
const fn region(masked: bool) -> &'static str {
    if masked {
        "in reflections"
    } else {
        "of the frame"
    }
}

/// Settings of a point as scene text, with the measured values as comments.
pub fn block(point: &Point, masked: bool) -> String {
    let s = &point.sample;
    let error = |metric| point.error(metric, masked).map_or("?".to_owned(), digits);
    let (ssim, psnr_db) = if masked {
        (s.mask_ssim, s.mask_psnr_db)
    } else {
        (s.ssim, s.psnr_db)
    };
    let bounces = match s.bounces {
        Bounces::LIMIT => "\"auto\"".to_owned(),
        count => count.to_string(),
    };
    let mut text = format!(
        "# {} at {} x {} on {}: {} ms a frame,\n\
         # {} against rt with {} bounces: SSIM {}, FLIP {}, relMSE {}{}\n\
         [reflection]\n\
         method = \"{}\"\n\
         threshold_u = {:?}\n\
         steps = {}\n\
         ray_length_u = {:?}\n\
         bounces = {bounces}\n\
         roughness_cutoff = {:?}\n\
         unit_m = {:?}\n\
         fade = {}\n\
         blur_px = {:?}\n",
        s.scene,
        s.width,
        s.height,
        s.adapter,
        digits(point.ms.median),
        region(masked),
        s.reference_bounces,
        ssim.map_or("?".to_owned(), |v| format!("{v:.4}")),
        error(Metric::Flip),
        error(Metric::RelMse),
        psnr_db.map_or(String::new(), |v| format!(", PSNR {} dB", digits(v))),
        s.method,
        s.threshold_u,
        s.steps,
        s.ray_length_u,
        s.roughness_cutoff,
        s.unit_m,
        s.fade,
        s.blur_px
    );
    if s.scale != 1.0 {
        let [width, height] =
            [s.width, s.height].map(|side| (f64::from(side) * s.scale).round() as u32);
        text +=
            &format!("\n# enlarged bilinearly when shown\n[image]\nsize = [{width}, {height}]\n");
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bounds_are_read_and_mistakes_are_explained() {
        let bound = Bound::parse(" SSIM >= 0.98").expect("a bound");
        assert_eq!((bound.quantity, bound.limit), (Quantity::Ssim, 0.98));
        assert_eq!(
            Bound::parse("ms<=4").expect("a bound").quantity,
            Quantity::Ms
        );
        for (text, says) in [
            ("ssim", "expected ssim>=X"),
            ("speed>=3", "\"speed\" cannot be bounded"),
            ("ssim<=0.9", "write ssim>="),
            ("ms>=4", "write ms<="),
            ("ms<=fast", "expected a number"),
            ("flip<=NaN", "expected a number"),
            ("flip<=1.01", "expected a number from 0 to 1"),
            ("ssim>=1.5", "expected a number from 0 to 1"),
            ("psnr>=-1", "expected a number that is 0 or more"),
        ] {
            let error = Bound::parse(text).expect_err(text);
            assert!(error.contains(says), "{text}: {error}");
        }
    }
}
