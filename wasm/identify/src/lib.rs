//! The identification of a capsule in the browser. The page loads this module when it is asked for, into a worker.
//! Answers are those of the command `capsule-rom identify`, by the same calls; every failure is a JavaScript `Error`
//! with the text of the crate that found it, a name of the reason as `code`, and what stands in the text as `values`.

mod identifier;
mod refused;
mod said;

use capsule_refusal::Refusal;
use identifier::Identifier as Inner;
use wasm_bindgen::prelude::*;

/// A model file, opened for identifications.
#[wasm_bindgen]
pub struct Identifier {
    inner: Inner,
}

#[wasm_bindgen]
impl Identifier {
    /// Opens the bytes of a model file (.crom).
    ///
    /// # Errors
    /// Bytes that are no model, or a model of anything but capsules in the channel.
    pub fn open(bytes: Vec<u8>) -> Result<Identifier, Refusal> {
        Ok(Self {
            inner: Inner::open(bytes)?,
        })
    }

    /// Identifies the capsule whose outline a file shows, a text or a picture. `said` and the result are JSON objects:
    /// the command's options by their names, with `_` for `-`; the command's `answer`, the `contour` and the fitted
    /// `outline` in l in the capsule's frame, the half with r >= 0 from the front to the rear, the `levels` of the rise
    /// of the sum of squares at the borders of the regions of 68 and 95 %, and the ranges `around` of Ca and a/l that
    /// hold them.
    ///
    /// # Errors
    /// What is wrong with the file or with what is said.
    pub fn identify(&mut self, name: &str, file: &[u8], said: &str) -> Result<String, Refusal> {
        Ok(self.inner.identify(name, file, said)?)
    }

    /// By how much the sum of squares is greater at each Ca, a/l, Ca, a/l, ... than at the last answer; not a number
    /// outside the domain.
    ///
    /// # Errors
    /// Before the first answer.
    pub fn misfit(&mut self, places: &[f64]) -> Result<Vec<f64>, Refusal> {
        Ok(self.inner.misfit(places)?)
    }
}
