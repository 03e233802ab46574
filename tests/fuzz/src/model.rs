//! Model files: bytes as they come, bytes with a right header, and a small model with bytes changed under a right
//! header. What opens gives errors or finite answers.

use crate::{FILE, Question, ask, input, with_header};
use arbitrary::Arbitrary;
use capsule_core::{Model, Workspace};
use std::cell::RefCell;

#[derive(Arbitrary, Debug)]
enum File<'a> {
    Raw(&'a [u8]),
    Payload(&'a [u8]),
    /// Where a byte is changed, and what is flipped of it.
    Changed([(u32, u8); 4]),
}

const HEADER: usize = 16;

thread_local! {
    static WORKSPACE: RefCell<Box<Workspace<f32>>> = RefCell::new(Box::default());
}

/// Opens what the bytes stand for and asks it.
pub fn model(bytes: &[u8]) {
    let Some((question, file)) = input::<(Question, File<'_>)>(bytes) else {
        return;
    };
    let file = match file {
        File::Raw(bytes) => bytes.to_vec(),
        File::Payload(bytes) => with_header(bytes),
        File::Changed(changes) => {
            let mut payload = FILE[HEADER..].to_vec();
            let length = payload.len();
            for (place, bits) in changes {
                payload[place as usize % length] ^= bits;
            }
            with_header(&payload)
        }
    };
    let Ok(model) = Model::open(&file) else { return };
    WORKSPACE.with_borrow_mut(|workspace| ask(&model, workspace, &question));
}
