//! `bench --choose`: the cheapest settings of each scene that keep a bound, as text for the scene.

use crate::{
    app::{error::AppError, print_out},
    bench::{
        choose::{Bound, block, choose},
        report::Section,
    },
};

/// Prints the chosen settings of each section.
///
/// # Errors
/// [`AppError::Threshold`] where no settings of a scene keep the bound, after the others are printed.
pub fn print_choice(sections: &[Section], bound: &Bound) -> Result<(), AppError> {
    let mut blocks = Vec::new();
    let mut refused = false;
    for section in sections {
        match choose(&section.group, bound) {
            Ok(point) => blocks.push(block(point, section.group.masked)),
            Err(why) => {
                let sample = section.group.points.first().map(|p| &p.sample);
                let scene = sample.map_or("", |s| s.scene.as_str());
                reflet_base::error_line!("{scene}: {why}");
                refused = true;
            }
        }
    }
    if !blocks.is_empty() {
        print_out(&blocks.join("\n"))?;
    }
    if refused {
        Err(AppError::Threshold)
    } else {
        Ok(())
    }
}
