//! One way through every call: its pointers are checked, its work is done, its error is written.

use crate::error::{Error, Failed};
use crate::memory::{Buffer, Bytes, Place, check, check_error};
use crate::opaque::{MAX_LOCAL_MODES, MAX_MODES, MAX_NEIGHBOURS, SCRATCH};
use crate::{Model, Status, Workspace};
use capsule_core as rom;
use capsule_core::{Evaluator, Nodes, Scene};
use core::mem::MaybeUninit;

/// cbindgen:ignore
pub(crate) type Instant<'e> = rom::Instant<'e, 'static, f32, MAX_MODES, MAX_LOCAL_MODES, MAX_NEIGHBOURS, SCRATCH>;

/// The work of a call; a failure writes its cause into the error.
///
/// cbindgen:ignore
type Work<'f> = dyn FnMut(&mut Error) -> Result<(), Failed> + 'f;

/// A question asked of an instant.
///
/// cbindgen:ignore
type Ask<'f> = dyn FnMut(&mut Instant<'_>, &mut Error) -> Result<(), Failed> + 'f;

/// Writes numbers of an instant and returns how many.
///
/// cbindgen:ignore
type Fill<'f> = dyn FnMut(&mut Instant<'_>, &mut [f32], &mut Error) -> Result<usize, Failed> + 'f;

/// Writes vectors at nodes and returns how many.
///
/// cbindgen:ignore
type Vectors = fn(&mut Instant<'_>, &Scene<'_>, &mut [[f32; 3]]) -> Result<usize, rom::EvaluateError>;

/// Checks the buffers of a call, does its work and fills `error`, which may be null. Where `error` itself is refused,
/// nothing is written. No buffer may overlap the file of `model`.
#[inline(never)]
pub(crate) unsafe fn call(
    model: Option<&Place<Model>>,
    buffers: &[Bytes],
    error: *mut Error,
    work: &mut Work<'_>,
) -> Status {
    let error = Place::output(error);
    let place = error.written().optional();
    if let Err(status) = check_error(place, buffers) {
        return status;
    }
    // SAFETY: the caller keeps the contract of `functions`.
    let file = model
        .filter(|model| model.is_valid())
        .map_or(Bytes::NONE, |model| unsafe { model.file() });
    if place.overlaps(&file) {
        return Status::Overlap;
    }
    let mut unused = MaybeUninit::uninit();
    let error = if error.is_null() {
        Place::output(unused.as_mut_ptr())
    } else {
        error
    };
    // SAFETY: the caller keeps the contract of `functions`, and no other buffer is there. Zeros say that nothing
    // failed.
    let failure = unsafe { error.zeros() };
    // The error holds the status of a failure.
    let (Ok(()) | Err(Failed)) = match failure.record(check(buffers, file)) {
        Ok(()) => work(failure),
        failed => failed,
    };
    failure.status
}

/// Puts a question to an instant of the prepared query.
pub(crate) unsafe fn with_instant(
    model: Place<Model>,
    workspace: Place<Workspace>,
    t: f32,
    ask: &mut Ask<'_>,
    failure: &mut Error,
) -> Result<(), Failed> {
    // SAFETY: the caller keeps the contract of `functions`.
    let (model, workspace) = unsafe {
        (
            failure.record(model.content())?,
            failure.record(workspace.content_mut())?,
        )
    };
    let mut evaluator = failure.record(Evaluator::new(model, workspace))?;
    ask(&mut failure.record(evaluator.at(t))?, failure)
}

/// A call that puts a question to an instant, with up to two buffers besides the model and the workspace.
pub(crate) unsafe fn call_at(
    model: *const Model,
    workspace: *mut Workspace,
    t: f32,
    [first, second]: [Bytes; 2],
    error: *mut Error,
    ask: &mut Ask<'_>,
) -> Status {
    let (model, workspace) = (Place::input(model), Place::output(workspace));
    let buffers = [model.read(), workspace.written(), first, second];
    // SAFETY: the caller keeps the contract of `functions`.
    unsafe {
        call(Some(&model), &buffers, error, &mut move |failure: &mut Error| {
            with_instant(model, workspace, t, ask, failure)
        })
    }
}

/// A call that answers with one value.
pub(crate) unsafe fn value_at<A>(
    model: *const Model,
    workspace: *mut Workspace,
    t: f32,
    out: *mut A,
    error: *mut Error,
    ask: impl Fn(&mut Instant<'_>) -> Result<A, rom::EvaluateError>,
) -> Status {
    let out = Place::output(out);
    let mut ask = move |instant: &mut Instant<'_>, failure: &mut Error| {
        let found = failure.record(ask(instant))?;
        // SAFETY: the caller keeps the contract of `functions`.
        unsafe { out.memory() }.write(found);
        Ok(())
    };
    // SAFETY: the caller keeps the contract of `functions`.
    unsafe { call_at(model, workspace, t, [out.written(), Bytes::NONE], error, &mut ask) }
}

/// A call that answers with one number.
#[inline(never)]
pub(crate) unsafe fn number_at(
    model: *const Model,
    workspace: *mut Workspace,
    t: f32,
    out: *mut f32,
    error: *mut Error,
    ask: fn(&mut Instant<'_>) -> Result<f32, rom::EvaluateError>,
) -> Status {
    // SAFETY: the caller keeps the contract of `functions`.
    unsafe { value_at(model, workspace, t, out, error, ask) }
}

/// A call that answers with many numbers.
pub(crate) unsafe fn array_at(
    model: *const Model,
    workspace: *mut Workspace,
    t: f32,
    list: Bytes,
    out: *mut f32,
    capacity: usize,
    count: *mut usize,
    error: *mut Error,
    fill: &mut Fill<'_>,
) -> Status {
    let (model, workspace) = (Place::input(model), Place::output(workspace));
    let (out, count) = (Buffer::output(out, capacity), Place::output(count));
    let mut work = move |failure: &mut Error| {
        // SAFETY: the caller keeps the contract of `functions`.
        let (out, count) = unsafe { (out.room(), count.memory()) };
        let mut ask = |instant: &mut Instant<'_>, failure: &mut Error| {
            count.write(fill(instant, out, failure)?);
            Ok(())
        };
        // SAFETY: the caller keeps the contract of `functions`.
        unsafe { with_instant(model, workspace, t, &mut ask, failure) }
    };
    let buffers = [model.read(), workspace.written(), out.written(), count.written(), list];
    // SAFETY: the caller keeps the contract of `functions`.
    unsafe { call(Some(&model), &buffers, error, &mut work) }
}

/// A call that answers with vectors at nodes.
#[inline(never)]
pub(crate) unsafe fn vectors_at(
    model: *const Model,
    workspace: *mut Workspace,
    t: f32,
    frame: u32,
    nodes: *const u16,
    node_count: usize,
    out: *mut f32,
    capacity: usize,
    count: *mut usize,
    error: *mut Error,
    ask: Vectors,
) -> Status {
    let list = Buffer::input(nodes, node_count);
    let mut ask = move |instant: &mut Instant<'_>, out: &mut [f32], failure: &mut Error| {
        let nodes = if list.is_null() {
            Nodes::All
        } else {
            // SAFETY: the caller keeps the contract of `functions`.
            Nodes::List(unsafe { list.values() })
        };
        let frame = frame_of(frame, failure)?;
        let written = ask(instant, &Scene { nodes, frame }, out.as_chunks_mut().0);
        Ok(3 * failure.record(count_in_numbers(written, 3))?)
    };
    let bytes = list.read().optional();
    // SAFETY: the caller keeps the contract of `functions`.
    unsafe { array_at(model, workspace, t, bytes, out, capacity, count, error, &mut ask) }
}

/// Refuses an object whose size, as the caller gives it, is less than that of its type.
pub(crate) fn check_size<O>(size: usize, failure: &mut Error) -> Result<(), Failed> {
    let needed = size_of::<O>();
    if size < needed {
        return Err(failure.counts(Status::Short, "", size, needed, 0));
    }
    Ok(())
}

/// The frame with this number (a `capsule_frame`).
pub(crate) fn frame_of(frame: u32, failure: &mut Error) -> Result<rom::Frame, Failed> {
    match frame {
        0 => Ok(rom::Frame::Laboratory),
        1 => Ok(rom::Frame::Centroid),
        other => Err(failure.choice("frame", other as usize, 1)),
    }
}

/// Counts a buffer that is too short in numbers, as C does, instead of points.
pub(crate) fn count_in_numbers<A>(
    result: Result<A, rom::EvaluateError>,
    numbers: usize,
) -> Result<A, rom::EvaluateError> {
    result.map_err(|error| match error {
        rom::EvaluateError::BufferTooShort { required, found } => rom::EvaluateError::BufferTooShort {
            required: numbers * required,
            found: numbers * found,
        },
        other => other,
    })
}
