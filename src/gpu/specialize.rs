//! Specializes a shader: branches that the values of its overrides rule out are removed, with the functions and
//! bindings that only they used, before bindings are reflected and before the driver sees them. Drivers remove them
//! too, but only after they have read and inlined all code.

use naga::{
    BinaryOperator, Block, Expression, Function, Handle, Literal, LocalVariable, Module, Override,
    ShaderStage, Span, Statement, UnaryOperator,
    back::pipeline_constants::{PipelineConstantError, process_overrides},
    compact::{KeepUnused, compact},
    valid::ModuleInfo,
};

/// A module without overrides and without source locations, for one compute entry point or for all entry points: texts
/// that differ only in removed parts become one module.
///
/// # Errors
/// A value that does not match its override.
pub fn specialized(
    module: &Module,
    info: &ModuleInfo,
    compute: Option<&str>,
    constants: &[(&str, f64)],
) -> Result<Module, Box<PipelineConstantError>> {
    let entry = compute.map(|name| (ShaderStage::Compute, name));
    let values = constants
        .iter()
        .map(|(key, value)| ((*key).to_owned(), *value))
        .collect();
    let (module, _) = process_overrides(module, info, entry, &values).map_err(Box::new)?;
    let mut module = module.into_owned();
    prune_module(&mut module, &[]);
    Ok(module)
}

/// A module without the branches that these values of boolean overrides rule out, and without declarations that only
/// these used. All its overrides still have no value.
pub fn pruned(module: &Module, constants: &[(&str, f64)]) -> Module {
    let given = module.overrides.iter().filter_map(|(handle, known)| {
        let name = known.name.as_deref()?;
        let (_, value) = constants.iter().find(|(key, _)| *key == name)?;
        Some((handle, *value != 0.0))
    });
    let given: Vec<_> = given.collect();
    let mut module = module.clone();
    prune_module(&mut module, &given);
    module
}

/// An override and its value.
type Given = (Handle<Override>, bool);

/// Removes the branches that constants and these values of overrides never take, and declarations that are then unused.
fn prune_module(module: &mut Module, given: &[Given]) {
    let mut functions = std::mem::take(&mut module.functions);
    let mut returned = Vec::new();
    // A function stands behind its callees.
    for (handle, function) in functions.iter_mut() {
        let value = prune(Facts::new(module, given, &returned), function);
        returned.extend(value.map(|value| (handle, value)));
    }
    module.functions = functions;
    let mut entries = std::mem::take(&mut module.entry_points);
    for entry in &mut entries {
        prune(Facts::new(module, given, &returned), &mut entry.function);
    }
    module.entry_points = entries;
    // `compact` keeps what has a name.
    for (_, constant) in module.constants.iter_mut() {
        constant.name = None;
    }
    compact(module, KeepUnused::No);
}

/// Values that are known in all functions of a module.
#[derive(Clone, Copy)]
struct Facts<'a> {
    module: &'a Module,
    given: &'a [Given],
    returned: &'a [Returned],
}

impl<'a> Facts<'a> {
    fn new(module: &'a Module, given: &'a [Given], returned: &'a [Returned]) -> Self {
        Self {
            module,
            given,
            returned,
        }
    }
}

/// Removes the branches that constants never take, and gives the only value that the function returns, if it is known.
fn prune(facts: Facts<'_>, function: &mut Function) -> Option<bool> {
    let mut known = Vec::new();
    loop {
        let body = std::mem::take(&mut function.body);
        let kept = taken(&Values::new(facts, function, &known), body);
        function.body = kept;
        let next = constant_temporaries(facts, function, &known);
        if next.len() == known.len() {
            break;
        }
        known = next;
    }
    // `compact` keeps what has a name.
    function.named_expressions.clear();
    let values = Values::new(facts, function, &known);
    let mut all = Vec::new();
    visit(&function.body, &mut |statement| {
        if let Statement::Return { value } = statement {
            all.push(value.and_then(|value| values.value_of(value)));
        }
    });
    let first = (*all.first()?)?;
    all.iter()
        .all(|value| *value == Some(first))
        .then_some(first)
}

/// A function and the only value that it ever returns.
type Returned = (Handle<Function>, bool);

/// A temporary variable and the only value that it ever holds.
type Known = (Handle<LocalVariable>, bool);

/// Temporary variables, which naga makes for `&&` and `||`, that are only ever assigned one value.
fn constant_temporaries(facts: Facts<'_>, function: &Function, known: &[Known]) -> Vec<Known> {
    let values = Values::new(facts, function, known);
    let mut stores = Vec::new();
    visit(&function.body, &mut |statement| {
        if let Statement::Store { pointer, value } = statement
            && let Expression::LocalVariable(variable) = function.expressions[*pointer]
        {
            stores.push((variable, *value));
        }
    });
    let only = |variable| {
        let mut of = (stores.iter()).filter(|(stored_to, _)| *stored_to == variable);
        let first = values.value_of(of.next()?.1)?;
        of.all(|(_, value)| values.value_of(*value) == Some(first))
            .then_some((variable, first))
    };
    // The front end stores to temporaries before it loads; a variable in the source text may be read before.
    let temporaries = (function.local_variables.iter()).filter(|(_, v)| v.name.is_none());
    temporaries.filter_map(|(handle, _)| only(handle)).collect()
}

/// Calls `look` with every statement of a block and of the blocks inside it.
pub(super) fn visit(block: &Block, look: &mut impl FnMut(&Statement)) {
    for statement in block {
        look(statement);
        match statement {
            Statement::Block(inner) => visit(inner, look),
            Statement::If { accept, reject, .. } => {
                visit(accept, look);
                visit(reject, look);
            }
            Statement::Switch { cases, .. } => {
                for case in cases {
                    visit(&case.body, look);
                }
            }
            Statement::Loop {
                body, continuing, ..
            } => {
                visit(body, look);
                visit(continuing, look);
            }
            _ => {}
        }
    }
}

/// Evaluates boolean expressions whose value is known.
struct Values<'a> {
    facts: Facts<'a>,
    function: &'a Function,
    known: &'a [Known],
}

impl<'a> Values<'a> {
    fn new(facts: Facts<'a>, function: &'a Function, known: &'a [Known]) -> Self {
        Self {
            facts,
            function,
            known,
        }
    }

    fn value_of(&self, expression: Handle<Expression>) -> Option<bool> {
        match self.function.expressions[expression] {
            Expression::Literal(Literal::Bool(value)) => Some(value),
            Expression::Constant(constant) => {
                let init = self.facts.module.constants[constant].init;
                match self.facts.module.global_expressions[init] {
                    Expression::Literal(Literal::Bool(value)) => Some(value),
                    _ => None,
                }
            }
            Expression::Override(wanted) => {
                let found = self.facts.given.iter().find(|(other, _)| *other == wanted);
                found.map(|(_, value)| *value)
            }
            Expression::Unary {
                op: UnaryOperator::LogicalNot,
                expr,
            } => self.value_of(expr).map(|value| !value),
            Expression::Binary { op, left, right } => {
                let decides = match op {
                    BinaryOperator::And | BinaryOperator::LogicalAnd => false,
                    BinaryOperator::InclusiveOr | BinaryOperator::LogicalOr => true,
                    _ => return None,
                };
                match (self.value_of(left), self.value_of(right)) {
                    (Some(left), Some(right)) if left == right => Some(left),
                    (Some(one), _) | (_, Some(one)) if one == decides => Some(decides),
                    (Some(_), Some(_)) => Some(decides),
                    _ => None,
                }
            }
            Expression::Load { pointer } => match self.function.expressions[pointer] {
                Expression::LocalVariable(variable) => {
                    let found = self.known.iter().find(|(other, _)| *other == variable);
                    found.map(|(_, value)| *value)
                }
                _ => None,
            },
            Expression::CallResult(called) => {
                let found = self
                    .facts
                    .returned
                    .iter()
                    .find(|(other, _)| *other == called);
                found.map(|(_, value)| *value)
            }
            _ => None,
        }
    }
}

/// A block without branches that are never taken, and without unreachable statements after its end.
fn taken(values: &Values<'_>, block: Block) -> Block {
    let mut kept = Block::with_capacity(block.len());
    for (statement, _) in block.span_into_iter() {
        match inner_taken(values, statement) {
            Statement::If {
                condition,
                accept,
                reject,
            } => match values.value_of(condition) {
                Some(true) => kept.extend_block(accept),
                Some(false) => kept.extend_block(reject),
                None => kept.push(
                    Statement::If {
                        condition,
                        accept,
                        reject,
                    },
                    Span::UNDEFINED,
                ),
            },
            Statement::Block(inner) => kept.extend_block(inner),
            other => kept.push(other, Span::UNDEFINED),
        }
        let ends = |s: &Statement| {
            matches!(
                s,
                Statement::Break | Statement::Continue | Statement::Return { .. } | Statement::Kill
            )
        };
        if kept.last().is_some_and(ends) {
            break;
        }
    }
    kept
}

/// A statement without the branches inside it that are never taken.
fn inner_taken(values: &Values<'_>, statement: Statement) -> Statement {
    match statement {
        Statement::If {
            condition,
            accept,
            reject,
        } => {
            let of = |branch, when| match values.value_of(condition) {
                Some(value) if value != when => Block::new(),
                _ => taken(values, branch),
            };
            Statement::If {
                condition,
                accept: of(accept, true),
                reject: of(reject, false),
            }
        }
        Statement::Block(inner) => Statement::Block(taken(values, inner)),
        Statement::Switch {
            selector,
            mut cases,
        } => {
            for case in &mut cases {
                case.body = taken(values, std::mem::take(&mut case.body));
            }
            Statement::Switch { selector, cases }
        }
        Statement::Loop {
            body,
            continuing,
            break_if,
        } => {
            // `continuing` may use expressions of the body itself, even past a point where the body ends early.
            let body = if continuing.is_empty() && break_if.is_none() {
                taken(values, body)
            } else {
                let mut kept = Block::with_capacity(body.len());
                for (statement, _) in body.span_into_iter() {
                    kept.push(inner_taken(values, statement), Span::UNDEFINED);
                }
                kept
            };
            Statement::Loop {
                body,
                continuing: taken(values, continuing),
                break_if,
            }
        }
        other => other,
    }
}

#[cfg(test)]
#[path = "specialize_tests.rs"]
mod tests;
