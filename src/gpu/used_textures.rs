//! Textures that a shader uses, by name.

use std::collections::BTreeSet;

use naga::{
    Expression, Function, GlobalVariable, Handle, ImageClass, Module, Statement, TypeInner,
};

use super::specialize::visit;

/// Names of the textures of `@group(2)` that some entry point of a shader uses, by binding number.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct UsedTextures {
    /// Textures that are read, whatever the values of overrides.
    pub read: Vec<String>,
    /// Textures that are written with these values of overrides; some may be read too.
    pub written: Vec<String>,
}

impl UsedTextures {
    /// Textures of a parsed shader, and of the part of it that some values of overrides leave.
    pub fn new(whole: &Module, part: &Module) -> Self {
        let used = |module: &Module, is_written: bool| {
            let globals = used_globals(module).into_iter();
            let used = globals.filter_map(|handle| {
                let global = &module.global_variables[handle];
                let slot = global.binding.filter(|slot| slot.group == 2)?;
                let is_storage = match module.types[global.ty].inner {
                    TypeInner::Image { class, .. } => matches!(class, ImageClass::Storage { .. }),
                    _ => return None,
                };
                let name = global.name.clone()?;
                (is_storage == is_written).then_some((slot.binding, name))
            });
            let mut used: Vec<_> = used.collect();
            used.sort_unstable();
            used.into_iter().map(|(_, name)| name).collect()
        };
        Self {
            read: used(whole, false),
            written: used(part, true),
        }
    }
}

/// Global variables that entry points and the functions that they call use.
fn used_globals(module: &Module) -> BTreeSet<Handle<GlobalVariable>> {
    let mut used = BTreeSet::new();
    let mut called = BTreeSet::new();
    let mut pending: Vec<&Function> = module.entry_points.iter().map(|e| &e.function).collect();
    while let Some(function) = pending.pop() {
        let globals = function.expressions.iter().filter_map(|(_, e)| match e {
            Expression::GlobalVariable(handle) => Some(*handle),
            _ => None,
        });
        used.extend(globals);
        visit(&function.body, &mut |statement| {
            if let Statement::Call { function, .. } = statement
                && called.insert(*function)
            {
                pending.push(&module.functions[*function]);
            }
        });
    }
    used
}
