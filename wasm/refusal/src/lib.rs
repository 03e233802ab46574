//! Failures of the WebAssembly modules: a JavaScript `Error` with the core's text as its `message` and the core's name
//! of the reason as its `code`.

use capsule_core::{EvaluateError, OpenError};
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
}

/// Why JavaScript gets no answer.
#[derive(Debug)]
pub struct Refusal {
    code: &'static str,
    text: String,
}

impl Refusal {
    /// A refusal of this kind, with a text for people.
    pub fn new(code: &'static str, text: impl Into<String>) -> Self {
        Self {
            code,
            text: text.into(),
        }
    }

    /// A word that stands for nothing.
    pub fn unknown(text: impl Into<String>) -> Self {
        Self::new("unknown-name", text)
    }
}

impl From<EvaluateError> for Refusal {
    fn from(error: EvaluateError) -> Self {
        Self::new(error.name(), error.to_string())
    }
}

impl From<OpenError> for Refusal {
    fn from(error: OpenError) -> Self {
        Self::new(error.name(), error.to_string())
    }
}

impl From<Refusal> for JsValue {
    fn from(Refusal { code, text }: Refusal) -> Self {
        let failure = Failure::new(&text);
        failure.set_code(code);
        failure.into()
    }
}
