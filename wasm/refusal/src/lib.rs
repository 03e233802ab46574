//! Failures of the WebAssembly modules: a JavaScript `Error` with the core's text as its `message`, the core's name of
//! the reason as its `code`, and the numbers and names that stand in the text as its `values`, in their order there.

/// Values as texts.
#[macro_export]
macro_rules! texts {
    ($($value:expr),* $(,)?) => { vec![$($value.to_string()),*] };
}

mod values;

use capsule_core::{EvaluateError, Model, OpenError};
use wasm_bindgen::prelude::*;

#[wasm_bindgen]
extern "C" {
    /// JavaScript's own class.
    #[wasm_bindgen(js_name = Error)]
    type Failure;

    #[wasm_bindgen(constructor, js_class = "Error")]
    fn new(message: &str) -> Failure;

    #[wasm_bindgen(method, setter, structural)]
    fn set_code(this: &Failure, code: &str);

    #[wasm_bindgen(method, setter, structural)]
    fn set_values(this: &Failure, values: Vec<String>);
}

/// Why JavaScript gets no answer.
#[derive(Debug)]
pub struct Refusal {
    code: &'static str,
    values: Vec<String>,
    text: String,
}

impl Refusal {
    /// A refusal of this kind, with the values of its text for people.
    pub fn new(code: &'static str, values: Vec<String>, text: String) -> Self {
        Self { code, values, text }
    }

    /// A name of something of this kind, where the known ones are others.
    pub fn unknown(kind: &str, name: &str, known: &[&str]) -> Self {
        let known = match known {
            [first @ .., last] if !first.is_empty() => format!("{} and {last}", first.join(", ")),
            _ => known.concat(),
        };
        let text = format!("{kind} {name:?} is unknown; there are {known}");
        Self::new("unknown-name", texts![kind, name, known], text)
    }

    /// The refusal of a query of a model, with the names of its parameters.
    pub fn of_query(error: EvaluateError, model: &Model<'_>) -> Self {
        let parameters = model.parameters();
        let name = |index: usize| parameters.get(index).map(|parameter| parameter.name);
        let text = model.describe(error).to_string();
        Self::new(error.name(), values::of_evaluation(&error, name), text)
    }
}

impl From<EvaluateError> for Refusal {
    fn from(error: EvaluateError) -> Self {
        Self::new(error.name(), values::of_evaluation(&error, |_| None), error.to_string())
    }
}

impl From<OpenError> for Refusal {
    fn from(error: OpenError) -> Self {
        Self::new(error.name(), values::of_opening(&error), error.to_string())
    }
}

impl From<Refusal> for JsValue {
    fn from(Refusal { code, values, text }: Refusal) -> Self {
        let failure = Failure::new(&text);
        failure.set_code(code);
        failure.set_values(values);
        failure.into()
    }
}
