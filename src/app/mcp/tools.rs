//! Commands as tools: their arguments as a JSON Schema, and JSON arguments as a command line.

use std::{any::TypeId, collections::BTreeMap, path::PathBuf, slice};

use clap::{Arg, ArgAction, Command};
use rmcp::model::JsonObject;
use serde::Deserialize;
use serde_json::{Value, json};

/// A command that clients call.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Tool {
    /// Name of the command.
    pub name: String,
    about: String,
    arguments: Vec<String>,
    #[serde(default)]
    defaults: BTreeMap<String, String>,
    /// Words of every call.
    #[serde(default)]
    pub always: Vec<String>,
    /// Option that names the picture to make.
    pub picture: Option<String>,
    /// Exit code of a run that has an answer nevertheless.
    #[serde(default)]
    pub fails: i32,
    #[serde(skip)]
    command: Command,
}

/// The commands of the program that are tools.
pub fn tools(program: &Command) -> Vec<Tool> {
    #[derive(Deserialize)]
    struct Table {
        tool: Vec<Tool>,
    }
    let table = toml::from_str::<Table>(include_str!("tools.toml"));
    let mut tools = table.expect("tests read it").tool;
    for tool in &mut tools {
        let command = program.find_subcommand(&tool.name);
        tool.command = command.expect("tests find it").clone();
    }
    tools
}

impl Tool {
    /// Description and JSON Schema of the arguments, made of the command's help.
    pub fn described(&self) -> (String, JsonObject) {
        let (mut properties, mut required) = (JsonObject::new(), Vec::new());
        for arg in self.arguments() {
            let name = arg.get_id().to_string();
            required.extend(arg.is_required_set().then(|| name.clone()));
            properties.insert(name, schema(arg));
        }
        let schema = [
            ("type", json!("object")),
            ("properties", json!(properties)),
            ("required", json!(required)),
            ("additionalProperties", json!(false)),
        ];
        let schema = schema.map(|(key, value)| (key.to_owned(), value));
        let about = self.command.get_about().map(ToString::to_string);
        let about = format!("{}. {}", about.unwrap_or_default(), self.about);
        (about, schema.into_iter().collect())
    }

    /// Words of a command line for JSON arguments; `path` gives the word for a file that one names.
    ///
    /// # Errors
    /// Message about an argument that the tool does not have, or of the wrong type, and errors of `path`.
    pub fn words(
        &self,
        given: &JsonObject,
        path: &dyn Fn(&str) -> Result<String, String>,
    ) -> Result<Vec<String>, String> {
        if let Some(name) = given.keys().find(|name| !self.arguments.contains(name)) {
            let (own, names) = (&self.name, self.arguments.join(", "));
            return Err(format!("`{own}` has no argument `{name}`; it has {names}"));
        }
        let (mut options, mut positions) = (self.always.clone(), vec!["--".to_owned()]);
        for arg in self.arguments() {
            let name = arg.get_id().as_str();
            let default = json!(self.defaults.get(name));
            let values = match (arg.get_action(), given.get(name).unwrap_or(&default)) {
                (_, Value::Null | Value::Bool(false)) => &[],
                (ArgAction::Append, Value::Array(list)) => list.as_slice(),
                (_, value) => slice::from_ref(value),
            };
            let option = format!("--{}", arg.get_long().unwrap_or_default());
            for value in values {
                let text = match text_of(value) {
                    Some(text) if !is_switch(arg) => text,
                    None if is_switch(arg) && *value == true => {
                        options.push(option.clone());
                        continue;
                    }
                    _ => return Err(format!("`{name}` cannot be {value}")),
                };
                let names_file = is_of::<PathBuf>(arg) || name == "light" && text.contains('.');
                let text = if names_file { path(&text)? } else { text };
                match arg.is_positional() {
                    true => positions.push(text),
                    false => options.push(format!("{option}={text}")),
                }
            }
        }
        options.append(&mut positions);
        Ok(options)
    }

    fn arguments(&self) -> impl Iterator<Item = &Arg> {
        self.arguments.iter().map(|name| {
            let mut all = self.command.get_arguments();
            let found = all.find(|arg| arg.get_id() == name);
            found.expect("tests find it")
        })
    }
}

/// JSON Schema of an argument.
fn schema(arg: &Arg) -> Value {
    let words = arg.get_possible_values();
    let words: Vec<_> = words.iter().map(|word| word.get_name()).collect();
    let mut schema = match () {
        () if is_switch(arg) => json!({ "type": "boolean" }),
        () if is_of::<u32>(arg) => json!({ "type": "integer" }),
        () if is_of::<f32>(arg) => json!({ "type": "number" }),
        () if !words.is_empty() => json!({ "type": "string", "enum": words }),
        () => json!({ "type": "string" }),
    };
    if matches!(arg.get_action(), ArgAction::Append) {
        schema = json!({ "type": "array", "items": schema });
    }
    let help = arg.get_help().map(ToString::to_string);
    schema["description"] = json!(help);
    schema
}

fn is_switch(arg: &Arg) -> bool {
    matches!(arg.get_action(), ArgAction::SetTrue)
}

/// Whether the values of an argument are of a type.
fn is_of<T: 'static>(arg: &Arg) -> bool {
    arg.get_value_parser().type_id() == TypeId::of::<T>()
}

/// A value as a word: lists of numbers such as a pixel are joined by commas.
fn text_of(value: &Value) -> Option<String> {
    match value {
        Value::String(text) => Some(text.clone()),
        Value::Number(number) => Some(number.to_string()),
        Value::Array(list) => {
            let texts: Option<Vec<_>> = list.iter().map(text_of).collect();
            Some(texts?.join(","))
        }
        _ => None,
    }
}
