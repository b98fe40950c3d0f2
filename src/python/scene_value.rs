//! Values of Python as values of scene text.

use pyo3::{
    exceptions::{PyTypeError, PyValueError},
    prelude::*,
    types::{PyBool, PyDict, PyFloat, PyInt, PyList, PyMapping, PyString, PyTuple},
};
use toml::{Table, Value};

use crate::errors::argument_error;

/// Largest depth of lists and tables in each other.
const MOST_DEEP: usize = 64;

/// Scene text of a mapping.
///
/// # Errors
/// A key that is no text, and a value that scene text cannot hold, with its path.
pub fn scene_text(scene: &Bound<'_, PyMapping>) -> PyResult<String> {
    let table = table(scene, "", 0)?;
    toml::to_string(&table).map_err(|error| PyValueError::new_err(error.to_string()))
}

/// Value as it stands behind `=` in scene text; `path` names it in messages.
///
/// # Errors
/// A value that scene text cannot hold.
pub fn value_text(value: &Bound<'_, PyAny>, path: &str) -> PyResult<String> {
    Ok(toml_value(value, path, 0)?.to_string())
}

/// Changed values as for `--set`.
pub fn settings_of(values: &Bound<'_, PyMapping>) -> PyResult<Vec<String>> {
    let setting = |item: Bound<'_, PyAny>| {
        let (path, value): (String, Bound<'_, PyAny>) = item.extract()?;
        Ok(format!("{path}={}", value_text(&value, &path)?))
    };
    values.items()?.iter().map(setting).collect()
}

/// One text, or several.
pub fn names(value: &Bound<'_, PyAny>, what: &str) -> PyResult<Vec<String>> {
    match value.extract::<String>() {
        Ok(one) => Ok(vec![one]),
        Err(_) => value.extract().map_err(|_| {
            let text = format!("{what} is a text or a list of texts, not {}", kind(value));
            argument_error(value.py(), &text)
        }),
    }
}

fn table(mapping: &Bound<'_, PyMapping>, path: &str, depth: usize) -> PyResult<Table> {
    let mut table = Table::new();
    for item in mapping.items()?.iter() {
        let (key, value): (Bound<'_, PyAny>, Bound<'_, PyAny>) = item.extract()?;
        let Ok(key) = key.cast::<PyString>() else {
            let message = format!("{}: keys must be text, not {}", place(path), kind(&key));
            return Err(PyTypeError::new_err(message));
        };
        let key = key.to_str()?;
        let inner = match path {
            "" => key.to_owned(),
            path => format!("{path}.{key}"),
        };
        table.insert(key.to_owned(), toml_value(&value, &inner, depth + 1)?);
    }
    Ok(table)
}

fn toml_value(value: &Bound<'_, PyAny>, path: &str, depth: usize) -> PyResult<Value> {
    if depth > MOST_DEEP {
        let message = format!(
            "{}: more than {MOST_DEEP} lists and tables in each other",
            place(path)
        );
        return Err(PyValueError::new_err(message));
    }
    if value.is_none() {
        let message = format!("{}: None is no value; leave the key out", place(path));
        return Err(PyTypeError::new_err(message));
    }
    if let Ok(switch) = value.cast::<PyBool>() {
        return Ok(Value::Boolean(switch.is_true()));
    }
    if value.is_instance_of::<PyInt>() {
        let number = value.extract().map_err(|_| {
            let message = format!("{}: {value} does not fit into 64 bits", place(path));
            argument_error(value.py(), &message)
        })?;
        return Ok(Value::Integer(number));
    }
    if value.is_instance_of::<PyFloat>() {
        return Ok(Value::Float(value.extract()?));
    }
    if let Ok(text) = value.cast::<PyString>() {
        return Ok(Value::String(text.to_str()?.to_owned()));
    }
    if value.is_instance_of::<PyList>() || value.is_instance_of::<PyTuple>() {
        let items = value.try_iter()?.enumerate();
        let items = items.map(|(i, item)| toml_value(&item?, &format!("{path}[{i}]"), depth + 1));
        return Ok(Value::Array(items.collect::<PyResult<_>>()?));
    }
    if let Ok(mapping) = value.cast::<PyDict>() {
        return Ok(Value::Table(table(mapping.as_mapping(), path, depth)?));
    }
    if let Ok(mapping) = value.cast::<PyMapping>() {
        return Ok(Value::Table(table(mapping, path, depth)?));
    }
    // Arrays and numbers of NumPy, and paths.
    for method in ["tolist", "__fspath__"] {
        if let Ok(method) = value.getattr(method) {
            return toml_value(&method.call0()?, path, depth + 1);
        }
    }
    let message = format!(
        "{}: {} is no value of scene text, which has numbers, texts, True, False, lists and dicts",
        place(path),
        kind(value)
    );
    Err(PyTypeError::new_err(message))
}

fn place(path: &str) -> &str {
    match path {
        "" => "the scene",
        path => path,
    }
}

/// Name of a value's type.
pub fn kind(value: &Bound<'_, PyAny>) -> String {
    let name = value.get_type().qualname();
    name.map_or_else(|_| "this".to_owned(), |name| name.to_string())
}
