//! Model files: any bytes, any bytes under a valid header, and a small model with changed bytes under a valid header. A
//! file that opens gives errors or finite answers.

use crate::{FILE, Question, ask, input, with_header};
use arbitrary::Arbitrary;
use capsule_core::{Model, Workspace};
use std::cell::RefCell;

#[derive(Arbitrary, Debug)]
enum File<'a> {
    Raw(&'a [u8]),
    Payload(&'a [u8]),
    /// Places of changed bytes, and the bits that are flipped there.
    Changed([(u32, u8); 4]),
}

const HEADER: usize = 16;

thread_local! {
    static WORKSPACE: RefCell<Box<Workspace<f32>>> = RefCell::new(Box::default());
}

/// Opens the file that the bytes encode and asks it every question.
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
