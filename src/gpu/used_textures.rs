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
        let names = |module: &Module, globals: BTreeSet<Handle<GlobalVariable>>| {
            let used = globals.into_iter().filter_map(|handle| {
                let global = &module.global_variables[handle];
                let slot = global.binding.filter(|slot| slot.group == 2)?;
                Some((slot.binding, global.name.clone()?))
            });
            let mut used: Vec<_> = used.collect();
            used.sort_unstable();
            used.into_iter().map(|(_, name)| name).collect()
        };
        let ([read, _], [_, written]) = (touched(whole), touched(part));
        Self {
            read: names(whole, read),
            written: names(part, written),
        }
    }
}

/// Textures that entry points and the functions that they call read, sampled ones and loaded storage textures, and textures
/// that they store to.
fn touched(module: &Module) -> [BTreeSet<Handle<GlobalVariable>>; 2] {
    let [mut read, mut stored] = [BTreeSet::new(), BTreeSet::new()];
    let is_sampled = |handle: Handle<GlobalVariable>| {
        let ty = &module.types[module.global_variables[handle].ty].inner;
        matches!(ty, TypeInner::Image { class, .. } if !matches!(class, ImageClass::Storage { .. }))
    };
    for function in used_functions(module) {
        let global = |expression: &Expression| match expression {
            Expression::GlobalVariable(handle) => Some(*handle),
            _ => None,
        };
        for (_, expression) in function.expressions.iter() {
            read.extend(match expression {
                Expression::ImageLoad { image, .. } => global(&function.expressions[*image]),
                other => global(other).filter(|handle| is_sampled(*handle)),
            });
        }
        visit(&function.body, &mut |statement| {
            if let Statement::ImageStore { image, .. } = statement {
                stored.extend(global(&function.expressions[*image]));
            }
        });
    }
    [read, stored]
}

/// Entry points and the functions that they call.
fn used_functions(module: &Module) -> Vec<&Function> {
    let mut called = BTreeSet::new();
    let mut pending: Vec<&Function> = module.entry_points.iter().map(|e| &e.function).collect();
    let mut used = Vec::new();
    while let Some(function) = pending.pop() {
        used.push(function);
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
