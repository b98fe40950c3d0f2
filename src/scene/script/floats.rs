//! Arrays of many numbers, which scripts fill for meshes: 4 bytes a number, where an array of Rhai takes 16.

use std::{fmt::Write as _, sync::Arc};

use rhai::{Dynamic, EvalAltResult};

use super::{format_value::named, limits::FLOATS, value::fail};
use crate::toml_text::FLOATS_PREFIX;

type Result<T> = std::result::Result<T, Box<EvalAltResult>>;

/// Numbers in single precision; copies share them until a copy changes.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Floats(Arc<Vec<f32>>);

impl Floats {
    /// Array of `count` zeros.
    pub(super) fn zeros(count: i64) -> Result<Self> {
        let fits = usize::try_from(count).ok().filter(|count| *count <= FLOATS);
        fits.map_or_else(
            || fail(format!("`floats` has 0 to {FLOATS} numbers, not {count}")),
            |count| Ok(Self(Arc::new(vec![0.0; count]))),
        )
    }

    /// Appends numbers.
    pub(super) fn add(&mut self, numbers: &[f64]) -> Result<()> {
        if self.0.len() + numbers.len() > FLOATS {
            return fail(format!("`floats` has at most {FLOATS} numbers"));
        }
        for x in numbers {
            let single = finite(*x)?;
            Arc::make_mut(&mut self.0).push(single);
        }
        Ok(())
    }

    /// Number of numbers.
    pub(super) fn len(&self) -> i64 {
        self.0.len() as i64
    }

    fn index(&self, index: i64) -> Result<usize> {
        let count = self.0.len();
        let found = usize::try_from(index).ok().filter(|index| *index < count);
        found.map_or_else(
            || {
                fail(format!(
                    "`floats` has {count} numbers, so there is none at {index}"
                ))
            },
            Ok,
        )
    }

    /// The number at an index, from 0.
    pub(super) fn get(&self, index: i64) -> Result<f64> {
        Ok(f64::from(self.0[self.index(index)?]))
    }

    /// Replaces the number at an index.
    pub(super) fn set(&mut self, index: i64, x: f64) -> Result<()> {
        let index = self.index(index)?;
        let single = finite(x)?;
        Arc::make_mut(&mut self.0)[index] = single;
        Ok(())
    }

    /// Refuses what is no number as one of the numbers.
    pub(super) fn refuse(other: &Dynamic) -> Result<()> {
        fail(format!(
            "each element of `floats` is one number, not {}; `f.add(v)` appends a vector",
            named(other)
        ))
    }

    /// The numbers, shared with all copies.
    pub(super) fn shared(self) -> Arc<Vec<f32>> {
        self.0
    }

    /// Appends the text that stands for the numbers in TOML, with its quotes.
    pub(super) fn write(&self, out: &mut String) {
        out.reserve(8 * self.0.len() + FLOATS_PREFIX.len() + 2);
        out.push('"');
        out.push_str(FLOATS_PREFIX);
        for x in self.0.iter() {
            let _ = write!(out, "{:08x}", x.to_bits());
        }
        out.push('"');
    }
}

fn finite(x: f64) -> Result<f32> {
    let single = x as f32;
    match single.is_finite() {
        true => Ok(single),
        false => fail(format!(
            "`floats` takes finite numbers of single precision, not {x}"
        )),
    }
}
