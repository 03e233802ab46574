//! Parameters, methods, steps and instants of any bits: an error, or finite answers.

use crate::{FILE, Question, ask, input};
use capsule_core::{Model, Workspace};
use std::cell::RefCell;
use std::sync::LazyLock;

static MODEL: LazyLock<Model<'static>> = LazyLock::new(|| Model::open(&FILE).expect("the small model opens"));

thread_local! {
    /// Shared by all executions: no query may disturb the next one.
    static WORKSPACE: RefCell<Box<Workspace<f32>>> = RefCell::new(Box::default());
}

/// Asks the small model two questions.
pub fn query(bytes: &[u8]) {
    let Some(questions) = input::<[Question; 2]>(bytes) else {
        return;
    };
    WORKSPACE.with_borrow_mut(|workspace| {
        for question in &questions {
            ask(&MODEL, workspace, question);
        }
    });
}
