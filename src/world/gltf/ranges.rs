//! Numbers of materials: wrong numbers are left out, numbers outside their range clamped, each with a warning.

use super::{Fault, Notes, finite};

/// Reader of the numbers of a material.
pub struct Numbers<'a> {
    /// Name of the material, for messages.
    pub place: &'a str,
    /// Whether wrong numbers are left out.
    pub is_lenient: bool,
    /// Warnings.
    pub notes: Notes,
}

impl Numbers<'_> {
    /// A number of 0 to 1; `other` where the file has none.
    pub fn unit(&mut self, key: &str, value: Option<f32>, other: f32) -> Result<f32, Fault> {
        self.one(key, value, other, 1.0)
    }

    /// A number of 0 to `most`; `other` where the file has none.
    pub fn one(
        &mut self,
        key: &str,
        value: Option<f32>,
        other: f32,
        most: f32,
    ) -> Result<f32, Fault> {
        let [number] = self.clamped(key, value.map(|v| [v]), [other], most)?;
        Ok(number)
    }

    /// Numbers of 0 to `most`; `other` where the file has none, or some that are not finite and left out.
    ///
    /// # Errors
    /// Numbers that are not finite, where the load forgives nothing.
    pub fn clamped<const N: usize>(
        &mut self,
        key: &str,
        value: Option<[f32; N]>,
        other: [f32; N],
        most: f32,
    ) -> Result<[f32; N], Fault> {
        let value = self.finite(key, value, other)?;
        let clamped = value.map(|v| v.clamp(0.0, most));
        if clamped != value {
            let written = match value[..] {
                [one] => one.to_string(),
                _ => format!("{value:?}"),
            };
            let range = match most.is_finite() {
                true => format!("0 to {most}"),
                false => "0 or more".into(),
            };
            let what = "factors of materials are outside their range and clamped";
            let text = format!("{}: {key} is {written}, expected {range}", self.place);
            self.notes.add("factor-clamped", 1, what, &text);
        }
        Ok(clamped)
    }

    /// Numbers of any size; `other` where the file has none, or some that are not finite and left out.
    ///
    /// # Errors
    /// Same errors as [`Self::clamped`].
    pub fn finite<const N: usize>(
        &mut self,
        key: &str,
        value: Option<[f32; N]>,
        other: [f32; N],
    ) -> Result<[f32; N], Fault> {
        self.checked(value, other, finite, || format!("{key} must be finite"))
    }

    /// A value that `is_right`; `other` where the file has none, or a wrong one, which `message` names, is left out.
    ///
    /// # Errors
    /// A wrong value, where the load forgives nothing.
    pub fn checked<const N: usize>(
        &mut self,
        value: Option<[f32; N]>,
        other: [f32; N],
        is_right: impl Fn(&[f32]) -> bool,
        message: impl Fn() -> String,
    ) -> Result<[f32; N], Fault> {
        match value {
            Some(value) if !is_right(&value) => {
                self.wrong(message())?;
                Ok(other)
            }
            value => Ok(value.unwrap_or(other)),
        }
    }

    /// Leaves a property out.
    ///
    /// # Errors
    /// The property, where the load forgives nothing.
    pub fn wrong(&mut self, message: String) -> Result<(), Fault> {
        if !self.is_lenient {
            return Err(Fault::new("gltf-material", message));
        }
        let what = "properties of materials are wrong and left out";
        let text = format!("{}: {message}", self.place);
        self.notes.add("property-left-out", 1, what, &text);
        Ok(())
    }
}
