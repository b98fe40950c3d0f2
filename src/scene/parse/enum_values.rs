//! Values that are one of a fixed set of words.

use serde_json::{Value as Json, json};

use super::{
    report::Report,
    value::{Named, Value, wrong_type},
};
use crate::desc::{
    Accept, CurveKind, Ease, EnvironmentShadow, FillRule, Lookup, Marched, Method, PatternKind,
    Playback, Radiance, ReflectionMode, SelectBy, ShadowMode, SweepCurve, TextAlign, ToneMap,
    Trace, Visibility,
};
use crate::syntax::Node;
use crate::{range::Range, suggest};

/// Implements [`Value`] for an enum that is written as one of a fixed set of words.
macro_rules! words {
    ($type:ident { $($word:literal => $variant:expr),+ $(,)? }) => {
        impl Value for $type {
            const WORDS: Option<(&'static str, &'static [&'static str])> =
                Some((stringify!($type), &[$($word),+]));

            fn expected() -> String {
                const WORDS: &[&str] = &[$($word),+];
                one_of(WORDS)
            }
            fn schema(_: &Range) -> Json {
                json!({ "enum": [$($word),+] })
            }
            fn to_json(&self) -> Json {
                $(if *self == $variant { return json!($word); })+
                Json::Null
            }
            fn read(node: &Node, named: &Named, report: &mut Report) -> Option<Self> {
                match word(node, named.key, &[$($word),+], report)? {
                    $($word => Some($variant),)+
                    _ => None,
                }
            }
        }
    };
}

words!(ReflectionMode { "none" => Self::None, "auto" => Self::Auto, "mirror" => Self::Mirror });
words!(ShadowMode { "map" => Self::Map, "ray" => Self::Ray, "none" => Self::None, "auto" => Self::Auto });
words!(EnvironmentShadow { "ray" => Self::Ray, "none" => Self::None });
words!(Marched { "auto" => Self::Auto, "all" => Self::All, "cheaper" => Self::Cheaper });
words!(Trace { "software" => Self::Software, "query" => Self::Query, "auto" => Self::Auto });
words!(Accept { "verified" => Self::Verified, "threshold" => Self::Threshold });
words!(Method {
    "ssr" => Self::Ssr,
    "rt" => Self::Rt,
    "hybrid" => Self::Hybrid,
    "probe" => Self::Probe,
    "ssr+probe" => Self::SsrProbe,
    "ssr+box" => Self::SsrBox,
    "near-far" => Self::NearFar,
    "path" => Self::Path,
    "auto" => Self::Auto,
});
words!(Lookup { "infinity" => Self::Infinity, "box" => Self::Box, "distance" => Self::Distance });
words!(SelectBy { "pixel" => Self::Pixel, "instance" => Self::Instance });
words!(CurveKind {
    "step" => Self::Step,
    "linear" => Self::Linear,
    "catmull_rom" => Self::CatmullRom,
    "centripetal" => Self::Centripetal,
    "bezier" => Self::Bezier,
});
words!(FillRule { "nonzero" => Self::Nonzero, "evenodd" => Self::Evenodd });
words!(SweepCurve { "linear" => Self::Linear, "centripetal" => Self::Centripetal, "bezier" => Self::Bezier });
words!(TextAlign { "left" => Self::Left, "center" => Self::Center, "right" => Self::Right });
words!(Ease { "none" => Self::None, "in" => Self::In, "out" => Self::Out, "in_out" => Self::InOut });
words!(Playback { "once" => Self::Once, "loop" => Self::Loop, "ping_pong" => Self::PingPong });
words!(PatternKind {
    "checker" => Self::Checker,
    "brick" => Self::Brick,
    "noise" => Self::Noise,
    "marble" => Self::Marble,
    "stripes" => Self::Stripes,
    "gradient" => Self::Gradient,
    "dots" => Self::Dots,
});
words!(Visibility { "raster" => Self::Raster, "rays" => Self::Rays, "auto" => Self::Auto });
words!(Radiance { "half" => Self::Half, "full" => Self::Full, "auto" => Self::Auto });
words!(ToneMap { "none" => Self::None, "neutral" => Self::Neutral, "aces" => Self::Aces, "agx" => Self::Agx });

/// The words as a list in prose: `"a", "b" or "c"`.
pub fn one_of(words: &[&str]) -> String {
    let quoted: Vec<_> = words.iter().map(|w| suggest::text(w)).collect();
    match quoted.split_last() {
        Some((last, rest)) if !rest.is_empty() => format!("{} or {last}", rest.join(", ")),
        _ => quoted.concat(),
    }
}

/// The word that is written, if it is one of `words`; else a message that suggests the nearest one.
pub fn word(
    node: &Node,
    key: &str,
    words: &[&'static str],
    report: &mut Report,
) -> Option<&'static str> {
    let Some(written) = node.get_ref().as_str() else {
        let help = node.get_ref().as_bool().and_then(|is_on| {
            let meant = if is_on { "auto" } else { "none" };
            let word = words.iter().find(|word| **word == meant)?;
            Some(format!("write {}", suggest::text(word)))
        });
        wrong_type(node, key, &one_of(words), report).help = help;
        return None;
    };
    let known = words.iter().copied().find(|w| *w == written);
    if known.is_none() {
        let message = format!(
            "`{key}` must be {}, not {}",
            one_of(words),
            suggest::text(written)
        );
        let help = suggest::absent(written, words)
            .map(str::to_owned)
            .or_else(|| {
                let meant = suggest::nearest(written, words.iter().copied())?;
                Some(format!("did you mean {}?", suggest::text(meant)))
            });
        report.error("unknown-word", &node.span(), message).help = help;
    }
    known
}
