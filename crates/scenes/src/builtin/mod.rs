//! The built-in scenes.
//!
//! Every scene is deterministic: the same parameters give the same scene on every machine. Cameras have 128 x 128 pixels
//! until somebody asks for more.

pub mod ajar_door;
pub mod bumpy;
pub mod cornell;
pub mod furnace;
pub mod glass_ball;
pub mod glass_caustic;
pub mod glossy_caustic;
pub mod hidden_lights;
pub mod many_lights;
mod parts;
pub mod pool;
pub mod ring;
pub mod sky;
pub mod studio;
pub mod veach_mis;

use crate::{LoadError, LoadedScene, error::nearest};

/// A built-in scene.
#[derive(Debug)]
pub struct Builtin {
    /// Name on the command line.
    pub name: &'static str,
    /// What it is and what it tests, one line.
    pub summary: &'static str,
    /// Its parameters.
    pub parameters: &'static [Parameter],
    build: fn(&Values) -> LoadedScene,
}

/// A parameter of a built-in scene.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Parameter {
    /// Name on the command line.
    pub name: &'static str,
    /// What it does, one line.
    pub summary: &'static str,
    /// What values it takes.
    pub kind: ParameterKind,
}

/// The values that a parameter takes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ParameterKind {
    /// A whole number.
    Integer {
        /// Value when it is not given.
        default: u32,
        /// Smallest and largest value.
        range: (u32, u32),
    },
    /// A real number.
    Number {
        /// Value when it is not given.
        default: f64,
        /// Smallest and largest value.
        range: (f64, f64),
    },
    /// One of several words, the first when it is not given.
    Choice {
        /// The words.
        options: &'static [&'static str],
    },
}

/// The built-in scenes, in the order in which they are listed.
pub fn builtins() -> &'static [Builtin] {
    &[
        cornell::BUILTIN,
        furnace::BUILTIN,
        veach_mis::BUILTIN,
        glass_caustic::BUILTIN,
        ring::BUILTIN,
        ajar_door::BUILTIN,
        many_lights::BUILTIN,
        sky::BUILTIN,
        glass_ball::BUILTIN,
        glossy_caustic::BUILTIN,
        pool::BUILTIN,
        studio::BUILTIN,
        hidden_lights::BUILTIN,
        bumpy::BUILTIN,
    ]
}

impl Builtin {
    /// Builds the scene with parameters given as `name=value,name=value`; none is an empty string.
    ///
    /// # Errors
    ///
    /// A parameter that the scene has not, one given twice, a value out of range.
    pub fn load(&self, parameters: &str) -> Result<LoadedScene, LoadError> {
        let mut values = Values {
            parameters: self.parameters,
            values: self.parameters.iter().map(|p| p.kind.default_value()).collect(),
        };
        let mut given = vec![false; self.parameters.len()];
        for assignment in parameters.split(',').map(str::trim).filter(|a| !a.is_empty()) {
            let (name, value) = assignment.split_once('=').map_or((assignment, ""), |(n, v)| (n.trim(), v.trim()));
            let wrong = |expected: String| LoadError::ParameterValue {
                scene: self.name,
                name: name.to_owned(),
                value: value.to_owned(),
                expected,
            };
            let index = self.parameters.iter().position(|p| p.name == name).ok_or_else(|| self.unknown(name))?;
            if std::mem::replace(&mut given[index], true) {
                return Err(wrong("allowed: it is given a second time".to_owned()));
            }
            let kind = self.parameters[index].kind;
            values.values[index] = kind.parse(value).ok_or_else(|| wrong(kind.expected()))?;
        }
        Ok((self.build)(&values))
    }

    fn unknown(&self, name: &str) -> LoadError {
        let names: Vec<_> = self.parameters.iter().map(|p| p.name).collect();
        let known = match names.as_slice() {
            [] => "it has none".to_owned(),
            names => format!("it has {}", names.join(", ")),
        };
        LoadError::UnknownParameter {
            scene: self.name,
            name: name.to_owned(),
            nearest: nearest(name, names.iter().copied()),
            known,
        }
    }
}

impl ParameterKind {
    fn default_value(self) -> Value {
        match self {
            ParameterKind::Integer { default, .. } => Value::Integer(default),
            ParameterKind::Number { default, .. } => Value::Number(default),
            ParameterKind::Choice { options } => Value::Choice(options[0]),
        }
    }

    fn parse(self, text: &str) -> Option<Value> {
        match self {
            ParameterKind::Integer { range, .. } => {
                text.parse().ok().filter(|v| (range.0..=range.1).contains(v)).map(Value::Integer)
            }
            ParameterKind::Number { range, .. } => {
                text.parse().ok().filter(|v| (range.0..=range.1).contains(v)).map(Value::Number)
            }
            ParameterKind::Choice { options } => options.iter().find(|o| **o == text).map(|o| Value::Choice(o)),
        }
    }

    fn expected(self) -> String {
        match self {
            ParameterKind::Integer { range, .. } => format!("a whole number from {} to {}", range.0, range.1),
            ParameterKind::Number { range, .. } => format!("a number from {} to {}", range.0, range.1),
            ParameterKind::Choice { options } => format!("one of {}", options.join(", ")),
        }
    }
}

/// A value for each of a scene's parameters.
struct Values {
    parameters: &'static [Parameter],
    values: Vec<Value>,
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Value {
    Integer(u32),
    Number(f64),
    Choice(&'static str),
}

impl Values {
    // A scene asks for its own parameters by the names in its own table, which the tests go through.
    fn get(&self, name: &str) -> Value {
        let index = self.parameters.iter().position(|p| p.name == name);
        self.values[index.unwrap_or_else(|| panic!("the scene's table has no parameter {name}"))]
    }

    fn integer(&self, name: &str) -> u32 {
        match self.get(name) {
            Value::Integer(v) => v,
            other => panic!("parameter {name} is not whole: {other:?}"),
        }
    }

    fn number(&self, name: &str) -> f64 {
        match self.get(name) {
            Value::Number(v) => v,
            other => panic!("parameter {name} is not a number: {other:?}"),
        }
    }

    fn choice(&self, name: &str) -> &'static str {
        match self.get(name) {
            Value::Choice(v) => v,
            other => panic!("parameter {name} is not a choice: {other:?}"),
        }
    }
}
