//! Computes successive frames of one motion: all nodes, 60 frames a unit of time.
//!
//!     cargo run --release -p capsule-rom-core --example playback

use capsule_core::{Evaluator, Frame, Method, Model, Playback, Query, Workspace, playback_len};
use std::error::Error;
use std::time::Instant;

const MODEL: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../models/capsule.crom");

fn main() -> Result<(), Box<dyn Error>> {
    let file = std::fs::read(MODEL)?;
    let model = Model::open(&file)?;
    let mut workspace = Workspace::<f32>::new();
    let mut evaluator = Evaluator::new(&model, &mut workspace)?;
    evaluator.prepare(&Query::new([0.10, 0.90], Method::Direct))?;

    // The cache of the surfaces between frames, and the positions of a frame.
    let mut playback = Playback::new(vec![0.0; playback_len(&model)]);
    let mut positions = vec![[0.0; 3]; model.mesh().nodes()];
    let frames = (60.0 * model.end_time()) as usize;
    let start = Instant::now();
    let mut front: f32 = 0.0;
    for frame in 0..=frames {
        let t = model.end_time() * frame as f32 / frames as f32;
        let count = evaluator.frame(t, Frame::Laboratory, &mut playback, &mut positions)?;
        front = positions[..count].iter().fold(f32::MIN, |front, [x, ..]| front.max(*x));
    }
    let time = start.elapsed() / (frames as u32 + 1);
    println!("{} frames of {} nodes, {time:?} a frame", frames + 1, positions.len());
    println!("the capsule's front ends at x = {front:.3} l");
    Ok(())
}
