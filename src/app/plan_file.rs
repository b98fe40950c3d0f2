//! Plan files: unit costs of one adapter, written by `calibrate` and read by `--plan`.

use std::path::Path;

use serde::{Deserialize, Serialize};

use super::error::AppError;
use crate::{files::read_text, gpu::Gpu, render::settings::unit_costs::UnitCosts};

/// Maximum size of a plan file, bytes.
const MAX_BYTES: u64 = 1 << 16;

/// A plan file.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PlanFile {
    /// Name of the adapter that was measured.
    pub adapter: String,
    /// Unit costs of the adapter.
    pub unit_ns: UnitCosts,
}

impl PlanFile {
    /// TOML text of the plan file, with a comment.
    ///
    /// # Errors
    /// Error of the TOML encoder.
    pub fn text(&self) -> Result<String, AppError> {
        let body = toml::to_string(self).map_err(|e| AppError::Internal(e.to_string()))?;
        Ok(format!(
            "# Measured by reflet calibrate: nanoseconds that pieces of work take on this adapter.\n{body}"
        ))
    }

    /// Reads a plan file of any adapter.
    ///
    /// # Errors
    /// [`AppError::Usage`] with the path of an unreadable or invalid file.
    pub fn read(path: &Path) -> Result<Self, AppError> {
        let text = read_text(path, MAX_BYTES).map_err(|e| refused(path, &e.to_string()))?;
        Self::parse(&text).map_err(|why| refused(path, &why))
    }

    /// Parses the TOML text of a plan file.
    ///
    /// # Errors
    /// Message with the place of a key that is missing, unknown, not a number, or not above 0.
    fn parse(text: &str) -> Result<Self, String> {
        let plan: Self = toml::from_str(text).map_err(|e| e.to_string())?;
        let units = toml::Table::try_from(plan.unit_ns).map_err(|e| e.to_string())?;
        for (name, value) in units {
            let value = value.as_float().unwrap_or_default();
            if !(value > 0.0 && value <= MAX_NS) {
                return Err(format!(
                    "unit_ns.{name} is {value}, and must be above 0 and at most {MAX_NS}"
                ));
            }
        }
        Ok(plan)
    }
}

/// Maximum unit cost, nanoseconds: no piece of work takes a second.
const MAX_NS: f64 = 1e9;

/// Unit costs of a plan file that was measured on this adapter.
///
/// # Errors
/// [`AppError::Usage`] with the path of an unreadable or invalid file, or one of another adapter.
pub fn costs(path: &Path, gpu: &Gpu) -> Result<UnitCosts, AppError> {
    let plan = PlanFile::read(path)?;
    let adapter = &gpu.adapter_info.name;
    if plan.adapter != *adapter {
        return Err(refused(
            path,
            &format!(
                "it was measured on {:?}, and this adapter is {adapter:?}",
                plan.adapter
            ),
        ));
    }
    Ok(plan.unit_ns)
}

fn refused(path: &Path, why: &str) -> AppError {
    AppError::Usage(format!(
        "--plan {}: {why}\n  = help: `reflet calibrate -o FILE` measures an adapter and writes such a file",
        path.display()
    ))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn plan() -> PlanFile {
        PlanFile {
            adapter: "some \"GPU\"".to_owned(),
            unit_ns: UnitCosts::GPU,
        }
    }

    #[test]
    fn what_is_written_is_read() {
        let text = plan().text().expect("text");
        assert_eq!(PlanFile::parse(&text).as_ref(), Ok(&plan()));
    }

    #[test]
    fn broken_files_are_refused_by_what_is_wrong() {
        let text = plan().text().expect("text");
        let cut = &text[..text.find("mirror").unwrap_or(0)];
        for (text, part) in [
            (text.replace("hit = 0.1", "hit = 0.0"), "unit_ns.hit is 0"),
            (text.replace("hit = 0.1", "hit = -1.0"), "unit_ns.hit is -1"),
            (text.replace("hit = 0.1", "hit = nan"), "unit_ns.hit is NaN"),
            (text.replace("hit = 0.1", "hit = \"a\""), "hit"),
            (text.replace("hit = 0.1", ""), "missing field `hit`"),
            (
                text.replace("adapter =", "method = \"rt\"\nadapter ="),
                "unknown field `method`",
            ),
            (cut.to_owned(), "missing field"),
            (String::new(), "missing field `adapter`"),
        ] {
            let why = PlanFile::parse(&text).expect_err(&text);
            assert!(why.contains(part), "{part}: {why}");
        }
    }
}
