//! Commands as tools: their arguments as a JSON Schema, and JSON arguments as a command line.

use std::{any::TypeId, collections::BTreeMap, path::PathBuf, slice};

use clap::{Arg, ArgAction, Command};
use rmcp::model::{JsonObject, object};
use serde::Deserialize;
use serde_json::{Value, json};

/// A command that clients call.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Tool {
    /// Name of the command.
    pub name: String,
    /// Its description.
    pub about: String,
    arguments: Vec<String>,
    /// JSON Schemas of the arguments.
    #[serde(default)]
    schemas: BTreeMap<String, Value>,
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
        shared: BTreeMap<String, Value>,
        tool: Vec<Tool>,
    }
    let table = toml::from_str(include_str!("tools.toml"));
    let Table { shared, mut tool } = table.expect("tests read it");
    for tool in &mut tool {
        for name in &tool.arguments {
            let own = tool.schemas.entry(name.clone());
            own.or_insert_with(|| shared[name].clone());
        }
        let command = program.find_subcommand(&tool.name);
        tool.command = command.expect("tests find it").clone();
    }
    tool
}

impl Tool {
    /// JSON Schema of the arguments.
    pub fn schema(&self) -> JsonObject {
        let required = self.arguments().filter(|arg| arg.is_required_set());
        let required: Vec<_> = required.map(|arg| arg.get_id().as_str()).collect();
        object(json!({
            "type": "object",
            "properties": self.schemas,
            "required": required,
            "additionalProperties": false,
        }))
    }

    /// Command-line words of a call with these JSON arguments; `path` checks each file name among them, and gives its word.
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
            let help = match name.as_str() {
                "output" => "; pictures are kept by a server that is started with `--write DIR`",
                _ => "",
            };
            return Err(format!(
                "`{own}` has no argument `{name}`; it has {names}{help}"
            ));
        }
        let (mut options, mut positions) = (self.always.clone(), vec!["--".to_owned()]);
        for arg in self.arguments() {
            let name = arg.get_id().as_str();
            let schema = &self.schemas[name];
            let about = &schema["description"];
            let is_switch = schema["type"] == "boolean";
            let is_right =
                |text: &String| schema["type"] != "integer" || text.parse::<u32>().is_ok();
            let value = given.get(name).unwrap_or(&schema["default"]);
            let values = match (arg.get_action(), value) {
                (_, Value::Null | Value::Bool(false)) => &[],
                // A list of numbers is one pixel.
                (ArgAction::Append, Value::Array(list)) if !list.iter().any(Value::is_number) => {
                    list.as_slice()
                }
                (_, value) => slice::from_ref(value),
            };
            let option = format!("--{}", arg.get_long().unwrap_or_default());
            for value in values {
                let text = match text_of(value).filter(is_right) {
                    Some(text) if !is_switch => text,
                    None if is_switch && *value == true => {
                        options.push(option.clone());
                        continue;
                    }
                    _ => return Err(format!("`{name}` cannot be {value}: {about}")),
                };
                let is_path = arg.get_value_parser().type_id() == TypeId::of::<PathBuf>();
                let names_file = is_path || name == "light" && text.contains('.');
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
