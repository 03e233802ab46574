//! Parameters, methods, steps and instants of any bits: an error, or finite answers.
#![no_main]

use capsule_core::{Model, Workspace};
use capsule_fuzz::{FILE, Question, ask};
use libfuzzer_sys::fuzz_target;
use std::cell::RefCell;
use std::sync::LazyLock;

static MODEL: LazyLock<Model<'static>> = LazyLock::new(|| Model::open(&FILE).expect("the small model opens"));

thread_local! {
    /// Kept from one execution to the next: what one query leaves must not disturb another.
    static WORKSPACE: RefCell<Box<Workspace<f32>>> = RefCell::new(Box::default());
}

fuzz_target!(|questions: [Question; 2]| {
    WORKSPACE.with_borrow_mut(|workspace| {
        for question in &questions {
            ask(&MODEL, workspace, question);
        }
    });
});
