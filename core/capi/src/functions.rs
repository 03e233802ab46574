//! The functions of the interface.
//!
//! # What every caller keeps
//! Pointers are null, or point to memory of the size that their type or their length says, which nobody else writes
//! during the call. A file's bytes stay where they are, unchanged, as long as its model is used. Models and workspaces
//! are as these functions left them; they may be moved with all their bytes. Calls that share a model only may run at
//! the same time; calls that share a workspace may not.

use crate::error::{Error, figure};
use crate::memory::{Buffer, Bytes, apart};
use crate::opaque::{MOST_LOCAL_MODES, MOST_MODES, MOST_NEIGHBOURS};
use crate::{Description, Domain, Membrane, Method, Model, Observables, Parameter, Query, Status, Workspace};
use capsule_core as rom;
use capsule_core::{Evaluator, Nodes, Scene};
use core::ffi::{c_char, c_void};

/// cbindgen:ignore
type Instant<'e> = rom::Instant<'e, 'static, f32, MOST_MODES, MOST_LOCAL_MODES, MOST_NEIGHBOURS>;

/// What the status means, in a sentence that ends with a zero.
#[unsafe(no_mangle)]
pub extern "C" fn capsule_v1_status_text(status: u32) -> *const c_char {
    Status::from_number(status).text().as_ptr()
}

/// Opens the model file of `length` bytes: checks it, and fills `model`, of which `size` is `sizeof *model`. Nothing is
/// copied: the bytes are read where they lie, fastest if that is at a multiple of 16.
///
/// # Safety
/// See [`functions`](self).
#[unsafe(no_mangle)]
pub unsafe extern "C" fn capsule_v1_open(
    model: *mut Model,
    size: usize,
    file: *const c_void,
    length: usize,
    error: *mut Error,
) -> Status {
    let work = |error: Option<Bytes>| {
        let model = Buffer::new(model, 1)?;
        let file = Buffer::new(file.cast::<u8>(), length)?;
        apart_from(error, &[model.bytes(), file.bytes()])?;
        holds::<Model>(size)?;
        // SAFETY: the caller keeps what the module says.
        unsafe {
            model.clear();
            rom::Model::open_in(model.room(), file.values())?;
            model.set_up();
        }
        Ok(())
    };
    // SAFETY: the caller keeps what the module says.
    unsafe { report(error, work) }
}

/// Says what a model is.
///
/// # Safety
/// See [`functions`](self).
#[unsafe(no_mangle)]
pub unsafe extern "C" fn capsule_v1_describe(
    model: *const Model,
    description: *mut Description,
    error: *mut Error,
) -> Status {
    let work = |error: Option<Bytes>| {
        let (model, out) = (Buffer::new(model, 1)?, Buffer::new(description, 1)?);
        apart_from(error, &[model.bytes(), out.bytes()])?;
        // SAFETY: the caller keeps what the module says.
        let (model, out) = unsafe { (model.content()?, out.place()) };
        let points = |outline| model.node_set(outline).map_or(0, |nodes| nodes.len());
        out.write(Description {
            digest: model.digest(),
            parameter_count: model.contents().metadata.parameters.len(),
            nodes: model.mesh().nodes(),
            sector_nodes: model.mesh().sector_nodes().len(),
            midplane_points: points(rom::MIDPLANE),
            diagonal_points: points(rom::DIAGONAL),
            end_time: model.end_time(),
            method: match model.contents().default_method {
                rom::Method::Direct => Method::Direct,
                rom::Method::Paper => Method::Paper,
            },
        });
        Ok(())
    };
    // SAFETY: the caller keeps what the module says.
    unsafe { report(error, work) }
}

/// Name and range of parameter number `index`.
///
/// # Safety
/// See [`functions`](self).
#[unsafe(no_mangle)]
pub unsafe extern "C" fn capsule_v1_describe_parameter(
    model: *const Model,
    index: usize,
    parameter: *mut Parameter,
    error: *mut Error,
) -> Status {
    let work = |error: Option<Bytes>| {
        let (model, out) = (Buffer::new(model, 1)?, Buffer::new(parameter, 1)?);
        apart_from(error, &[model.bytes(), out.bytes()])?;
        // SAFETY: the caller keeps what the module says.
        let (model, out) = unsafe { (model.content()?, out.place()) };
        let parameters = &model.contents().metadata.parameters;
        let found = parameters
            .get(index)
            .ok_or(choice("parameter", index, parameters.len() - 1))?;
        out.write(Parameter {
            name: found.name.as_ptr().cast(),
            name_length: found.name.len(),
            least: found.min,
            greatest: found.max,
        });
        Ok(())
    };
    // SAFETY: the caller keeps what the module says.
    unsafe { report(error, work) }
}

/// Makes an empty workspace of memory, of which `size` is `sizeof *workspace`.
///
/// # Safety
/// See [`functions`](self).
#[unsafe(no_mangle)]
pub unsafe extern "C" fn capsule_v1_initialise(workspace: *mut Workspace, size: usize, error: *mut Error) -> Status {
    let work = |error: Option<Bytes>| {
        let workspace = Buffer::new(workspace, 1)?;
        apart_from(error, &[workspace.bytes()])?;
        holds::<Workspace>(size)?;
        // SAFETY: the caller keeps what the module says.
        unsafe { workspace.empty() };
        Ok(())
    };
    // SAFETY: the caller keeps what the module says.
    unsafe { report(error, work) }
}

/// Prepares a query; nothing is done if it is the one already prepared. `domain` may be null, else it says where the
/// parameters lie.
///
/// # Safety
/// See [`functions`](self).
#[unsafe(no_mangle)]
pub unsafe extern "C" fn capsule_v1_prepare(
    model: *const Model,
    workspace: *mut Workspace,
    query: *const Query,
    domain: *mut Domain,
    error: *mut Error,
) -> Status {
    let work = |error: Option<Bytes>| {
        let (model, workspace, query) = (
            Buffer::new(model, 1)?,
            Buffer::new(workspace, 1)?,
            Buffer::new(query, 1)?,
        );
        let query_bytes = query.bytes();
        // SAFETY: the caller keeps what the module says.
        let Some(query) = (unsafe { query.values() }).first() else {
            return Err(Status::Null.into());
        };
        let parameters = Buffer::new(query.parameters, query.parameter_count)?;
        let domain = optional(domain, 1)?;
        let of_domain = domain.as_ref().map_or(Bytes::NONE, Buffer::bytes);
        let buffers = [
            model.bytes(),
            workspace.bytes(),
            query_bytes,
            parameters.bytes(),
            of_domain,
        ];
        apart_from(error, &buffers)?;
        // SAFETY: the caller keeps what the module says.
        let (model, workspace, parameters) =
            unsafe { (model.content()?, workspace.content_mut()?, parameters.values()) };
        let expected = model.contents().metadata.parameters.len();
        let wrong_count = Error::from(Status::ParameterCount)
            .found(figure(parameters.len()))
            .least(figure(expected));
        let parameters = rom::Parameters::new(parameters).ok_or(wrong_count)?;
        let method = match query.method {
            0 => model.contents().default_method,
            1 => rom::Method::Direct,
            2 => rom::Method::Paper,
            other => return Err(choice("method", other as usize, 2)),
        };
        let mut asked = rom::Query::new(parameters, method);
        asked.extrapolate = query.extrapolate != 0;
        if query.step != 0.0 {
            asked.step = Some(query.step);
        }
        let found = Evaluator::new(model, workspace)?.prepare(&asked)?;
        if let Some(domain) = domain {
            // SAFETY: the caller keeps what the module says.
            unsafe { domain.place() }.write(match found {
                rom::Domain::Inside => Domain::Inside,
                rom::Domain::BeyondSteadyLimit => Domain::BeyondSteadyLimit,
                rom::Domain::FarFromSamples => Domain::FarFromSamples,
                rom::Domain::Outside => Domain::Outside,
            });
        }
        Ok(())
    };
    // SAFETY: the caller keeps what the module says.
    unsafe { report(error, work) }
}

/// Does at most `pieces` pieces of the work that everything at the instant `t` waits for, and sets `done` to 1 when
/// nothing is left, else to 0: for callers who must not be kept long. A piece is a snapshot or a row of a local basis, or
/// a step in time, of the paper's method; the direct method has no such work. What is asked at an instant does what is
/// left of it.
///
/// # Safety
/// See [`functions`](self).
#[unsafe(no_mangle)]
pub unsafe extern "C" fn capsule_v1_advance(
    model: *const Model,
    workspace: *mut Workspace,
    t: f32,
    pieces: usize,
    done: *mut u32,
    error: *mut Error,
) -> Status {
    // SAFETY: the caller keeps what the module says.
    unsafe {
        one(model, workspace, t, done, error, |instant| {
            Ok(u32::from(instant.advance(pieces)))
        })
    }
}

/// Lengths and velocity at the instant `t`, in l/V, of the prepared query.
///
/// # Safety
/// See [`functions`](self).
#[unsafe(no_mangle)]
pub unsafe extern "C" fn capsule_v1_observables_at(
    model: *const Model,
    workspace: *mut Workspace,
    t: f32,
    observables: *mut Observables,
    error: *mut Error,
) -> Status {
    let ask = |instant: &mut Instant<'_>| {
        let found = instant.observables()?;
        Ok(Observables {
            axial_length: found.axial_length,
            half_width: found.half_width,
            half_diagonal: found.half_diagonal,
            rear_depth: found.rear_depth,
            velocity: found.velocity,
            centroid: found.centroid,
        })
    };
    // SAFETY: the caller keeps what the module says.
    unsafe { one(model, workspace, t, observables, error, ask) }
}

/// Expected modified Hausdorff distance to the full-order model at the instant `t`, laboratory frame, as a fraction of
/// the radius a.
///
/// # Safety
/// See [`functions`](self).
#[unsafe(no_mangle)]
pub unsafe extern "C" fn capsule_v1_expected_error_at(
    model: *const Model,
    workspace: *mut Workspace,
    t: f32,
    expected_error: *mut f32,
    error: *mut Error,
) -> Status {
    // SAFETY: the caller keeps what the module says.
    unsafe {
        one(model, workspace, t, expected_error, error, |instant| {
            Ok(instant.expected_error())
        })
    }
}

/// The bound that 95 of 100 errors are below at the instant `t`, like the expected error.
///
/// # Safety
/// See [`functions`](self).
#[unsafe(no_mangle)]
pub unsafe extern "C" fn capsule_v1_error_bound_at(
    model: *const Model,
    workspace: *mut Workspace,
    t: f32,
    error_bound: *mut f32,
    error: *mut Error,
) -> Status {
    // SAFETY: the caller keeps what the module says.
    unsafe {
        one(model, workspace, t, error_bound, error, |instant| {
            Ok(instant.error_bound())
        })
    }
}

/// Position of the centroid at the instant `t`, laboratory frame, in l.
///
/// # Safety
/// See [`functions`](self).
#[unsafe(no_mangle)]
pub unsafe extern "C" fn capsule_v1_centroid_at(
    model: *const Model,
    workspace: *mut Workspace,
    t: f32,
    centroid: *mut f32,
    error: *mut Error,
) -> Status {
    // SAFETY: the caller keeps what the module says.
    unsafe { one(model, workspace, t, centroid, error, |instant| Ok(instant.centroid())) }
}

/// Enclosed volume at the instant `t`, in l^3.
///
/// # Safety
/// See [`functions`](self).
#[unsafe(no_mangle)]
pub unsafe extern "C" fn capsule_v1_volume_at(
    model: *const Model,
    workspace: *mut Workspace,
    t: f32,
    volume: *mut f32,
    error: *mut Error,
) -> Status {
    // SAFETY: the caller keeps what the module says.
    unsafe { one(model, workspace, t, volume, error, |instant| instant.volume()) }
}

/// An outline (a `capsule_outline`) at the instant `t` in a frame (a `capsule_frame`): points x, r, x, r, ... in l, from
/// the front pole to the rear pole. `points` has room for `capacity` numbers; `count` is set to how many were written.
///
/// # Safety
/// See [`functions`](self).
#[unsafe(no_mangle)]
pub unsafe extern "C" fn capsule_v1_outline_at(
    model: *const Model,
    workspace: *mut Workspace,
    t: f32,
    outline: u32,
    frame: u32,
    points: *mut f32,
    capacity: usize,
    count: *mut usize,
    error: *mut Error,
) -> Status {
    let ask = |instant: &mut Instant<'_>, out: &mut [f32]| {
        let name = match outline {
            0 => rom::MIDPLANE,
            1 => rom::DIAGONAL,
            other => return Err(choice("outline", other as usize, 1)),
        };
        let written = instant.outline(name, frame_of(frame)?, out.as_chunks_mut().0);
        Ok(2 * in_numbers(written, 2)?)
    };
    // SAFETY: the caller keeps what the module says.
    unsafe { many(model, workspace, t, None, points, capacity, count, error, ask) }
}

/// Positions of nodes at the instant `t` in a frame (a `capsule_frame`): x, y, z, x, y, z, ... in l. `nodes` lists
/// `node_count` of them; null asks for all. `positions` has room for `capacity` numbers; `count` is set to how many
/// were written.
///
/// # Safety
/// See [`functions`](self).
#[unsafe(no_mangle)]
pub unsafe extern "C" fn capsule_v1_positions_at(
    model: *const Model,
    workspace: *mut Workspace,
    t: f32,
    frame: u32,
    nodes: *const u16,
    node_count: usize,
    positions: *mut f32,
    capacity: usize,
    count: *mut usize,
    error: *mut Error,
) -> Status {
    // SAFETY: the caller keeps what the module says.
    unsafe {
        scene(
            model,
            workspace,
            t,
            frame,
            nodes,
            node_count,
            positions,
            capacity,
            count,
            error,
            |instant, scene, out| instant.positions(scene, out),
        )
    }
}

/// Velocities of nodes at the instant `t`, in V; otherwise as the positions.
///
/// # Safety
/// See [`functions`](self).
#[unsafe(no_mangle)]
pub unsafe extern "C" fn capsule_v1_velocities_at(
    model: *const Model,
    workspace: *mut Workspace,
    t: f32,
    frame: u32,
    nodes: *const u16,
    node_count: usize,
    velocities: *mut f32,
    capacity: usize,
    count: *mut usize,
    error: *mut Error,
) -> Status {
    // SAFETY: the caller keeps what the module says.
    unsafe {
        scene(
            model,
            workspace,
            t,
            frame,
            nodes,
            node_count,
            velocities,
            capacity,
            count,
            error,
            |instant, scene, out| instant.velocities(scene, out),
        )
    }
}

/// Totals of the membrane at the instant `t`. `scratch` has room for `capacity` numbers, three for each of the model's
/// sector nodes.
///
/// # Safety
/// See [`functions`](self).
#[unsafe(no_mangle)]
pub unsafe extern "C" fn capsule_v1_membrane_at(
    model: *const Model,
    workspace: *mut Workspace,
    t: f32,
    scratch: *mut f32,
    capacity: usize,
    membrane: *mut Membrane,
    error: *mut Error,
) -> Status {
    let work = |error: Option<Bytes>| {
        let (scratch, out) = (Buffer::new(scratch, capacity)?, Buffer::new(membrane, 1)?);
        let (model, workspace) = (Buffer::new(model, 1)?, Buffer::new(workspace, 1)?);
        apart_from(error, &[model.bytes(), workspace.bytes(), scratch.bytes(), out.bytes()])?;
        // SAFETY: the caller keeps what the module says.
        let (scratch, out) = unsafe { (scratch.zeros(), out.place()) };
        // SAFETY: the caller keeps what the module says.
        let found = unsafe {
            instant(&model, &workspace, t, |instant| {
                let room = instant.membrane(scratch.as_chunks_mut().0);
                let membrane = in_numbers(room, 3)?;
                Ok(Membrane {
                    area: membrane.area()?,
                    energy: membrane.energy()?,
                    pressure_drop: membrane.pressure_drop()?,
                })
            })?
        };
        out.write(found);
        Ok(())
    };
    // SAFETY: the caller keeps what the module says.
    unsafe { report(error, work) }
}

/// Runs the work of a call and writes its error where the caller wants it. Where a pointer is at fault nothing is
/// written: `error` may be what overlaps.
unsafe fn report(error: *mut Error, work: impl FnOnce(Option<Bytes>) -> Result<(), Error>) -> Status {
    let place = match optional(error, 1) {
        Ok(place) => place,
        Err(status) => return status,
    };
    let failure = work(place.as_ref().map(Buffer::bytes)).err().unwrap_or(Error::NONE);
    let pointer_at_fault = matches!(failure.status, Status::Null | Status::Misaligned | Status::Overlap);
    if let (Some(place), false) = (place, pointer_at_fault) {
        // SAFETY: the caller keeps what the module says, and no other buffer is there.
        unsafe { place.place() }.write(failure);
    }
    failure.status
}

/// A pointer that may be null.
fn optional<T>(pointer: *const T, count: usize) -> Result<Option<Buffer<T>>, Status> {
    if pointer.is_null() {
        Ok(None)
    } else {
        Buffer::new(pointer, count).map(Some)
    }
}

/// Refuses buffers that share memory with each other or with the error.
fn apart_from<const N: usize>(error: Option<Bytes>, buffers: &[Bytes; N]) -> Result<(), Status> {
    apart(buffers)?;
    error.map_or(Ok(()), |error| {
        buffers.iter().try_for_each(|buffer| apart(&[error, *buffer]))
    })
}

/// Refuses an object that the caller says is smaller than its content.
fn holds<O>(size: usize) -> Result<(), Error> {
    let needed = size_of::<O>();
    if size < needed {
        return Err(Error::from(Status::Short).found(figure(size)).least(figure(needed)));
    }
    Ok(())
}

fn choice(what: &'static str, found: usize, greatest: usize) -> Error {
    Error::from(Status::Choice)
        .what(what)
        .found(figure(found))
        .greatest(figure(greatest))
}

fn frame_of(frame: u32) -> Result<rom::Frame, Error> {
    match frame {
        0 => Ok(rom::Frame::Laboratory),
        1 => Ok(rom::Frame::Centroid),
        other => Err(choice("frame", other as usize, 1)),
    }
}

/// Says in numbers what a buffer of points lacks.
fn in_numbers<A>(result: Result<A, rom::EvaluateError>, numbers: usize) -> Result<A, Error> {
    result.map_err(|error| match error {
        rom::EvaluateError::BufferTooShort { required, found } => rom::EvaluateError::BufferTooShort {
            required: numbers * required,
            found: numbers * found,
        }
        .into(),
        other => other.into(),
    })
}

/// Asks something at an instant of the prepared query.
unsafe fn instant<A>(
    model: &Buffer<Model>,
    workspace: &Buffer<Workspace>,
    t: f32,
    ask: impl FnOnce(&mut Instant<'_>) -> Result<A, Error>,
) -> Result<A, Error> {
    // SAFETY: the caller keeps what the module says.
    let (model, workspace) = unsafe { (model.content()?, workspace.content_mut()?) };
    ask(&mut Evaluator::new(model, workspace)?.at(t)?)
}

/// A call that answers with one value.
unsafe fn one<A>(
    model: *const Model,
    workspace: *mut Workspace,
    t: f32,
    out: *mut A,
    error: *mut Error,
    ask: impl FnOnce(&mut Instant<'_>) -> Result<A, rom::EvaluateError>,
) -> Status {
    let work = |error: Option<Bytes>| {
        let (model, workspace, out) = (Buffer::new(model, 1)?, Buffer::new(workspace, 1)?, Buffer::new(out, 1)?);
        apart_from(error, &[model.bytes(), workspace.bytes(), out.bytes()])?;
        // SAFETY: the caller keeps what the module says.
        unsafe {
            let found = instant(&model, &workspace, t, |instant| Ok(ask(instant)?))?;
            out.place().write(found);
        }
        Ok(())
    };
    // SAFETY: the caller keeps what the module says.
    unsafe { report(error, work) }
}

/// A call that answers with many numbers; `ask` returns how many.
unsafe fn many(
    model: *const Model,
    workspace: *mut Workspace,
    t: f32,
    list: Option<Bytes>,
    out: *mut f32,
    capacity: usize,
    count: *mut usize,
    error: *mut Error,
    ask: impl FnOnce(&mut Instant<'_>, &mut [f32]) -> Result<usize, Error>,
) -> Status {
    let work = |error: Option<Bytes>| {
        let (model, workspace) = (Buffer::new(model, 1)?, Buffer::new(workspace, 1)?);
        let (out, count) = (Buffer::new(out, capacity)?, Buffer::new(count, 1)?);
        let list = list.unwrap_or(Bytes::NONE);
        apart_from(
            error,
            &[model.bytes(), workspace.bytes(), out.bytes(), count.bytes(), list],
        )?;
        // SAFETY: the caller keeps what the module says.
        unsafe {
            let (out, count) = (out.zeros(), count.place());
            count.write(0);
            count.write(instant(&model, &workspace, t, |instant| ask(instant, out))?);
        }
        Ok(())
    };
    // SAFETY: the caller keeps what the module says.
    unsafe { report(error, work) }
}

/// A call that answers with vectors at nodes.
unsafe fn scene(
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
    ask: impl FnOnce(&mut Instant<'_>, &Scene<'_>, &mut [[f32; 3]]) -> Result<usize, rom::EvaluateError>,
) -> Status {
    let nodes = match optional(nodes, node_count) {
        Ok(nodes) => nodes,
        Err(status) => return status,
    };
    let list = nodes.as_ref().map(Buffer::bytes);
    let ask = |instant: &mut Instant<'_>, out: &mut [f32]| {
        // SAFETY: the caller keeps what the module says.
        let nodes = nodes.map_or(Nodes::All, |nodes| Nodes::List(unsafe { nodes.values() }));
        let frame = frame_of(frame)?;
        Ok(3 * in_numbers(ask(instant, &Scene { nodes, frame }, out.as_chunks_mut().0), 3)?)
    };
    // SAFETY: the caller keeps what the module says.
    unsafe { many(model, workspace, t, list, out, capacity, count, error, ask) }
}
