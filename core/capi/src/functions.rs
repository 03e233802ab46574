//! The functions of the interface.
//!
//! # What every caller keeps
//! Pointers are null, or point to memory of the size that their type or their length says, which nobody else writes
//! during the call. A file's bytes stay where they are, unchanged, as long as its model is used. Models and workspaces
//! are as these functions left them; they may be moved with all their bytes. Calls that share a model only may run at
//! the same time; calls that share a workspace may not.

use crate::error::{Error, Failed};
use crate::memory::{Buffer, Bytes, Place, check, check_error};
use crate::opaque::{MAX_LOCAL_MODES, MAX_MODES, MAX_NEIGHBOURS, SCRATCH};
use crate::{Description, Domain, Membrane, Method, Model, Observables, Parameter, Query, Status, Workspace};
use capsule_core as rom;
use capsule_core::{Evaluator, Nodes, Scene};
use core::ffi::{c_char, c_void};
use core::mem::MaybeUninit;

/// cbindgen:ignore
type Instant<'e> = rom::Instant<'e, 'static, f32, MAX_MODES, MAX_LOCAL_MODES, MAX_NEIGHBOURS, SCRATCH>;

/// What a call does; why it fails it writes into the error. The vtable of a closure would hold its body twice, for
/// [`FnMut`] and for [`FnOnce`].
trait Work<A, B> {
    fn run(&mut self, with: A, failure: &mut Error) -> Result<B, Failed>;
}

impl<A, B, F: FnMut(A, &mut Error) -> Result<B, Failed>> Work<A, B> for F {
    fn run(&mut self, with: A, failure: &mut Error) -> Result<B, Failed> {
        self(with, failure)
    }
}

/// What a call asks of an instant.
///
/// cbindgen:ignore
type Ask<'f> = dyn for<'a, 'e> Work<&'a mut Instant<'e>, ()> + 'f;
/// Writes numbers of an instant and returns how many.
///
/// cbindgen:ignore
type Fill<'f> = dyn for<'a, 'e, 'o> Work<(&'a mut Instant<'e>, &'o mut [f32]), usize> + 'f;

/// Writes vectors at nodes and returns how many.
///
/// cbindgen:ignore
type Vectors = fn(&mut Instant<'_>, &Scene<'_>, &mut [[f32; 3]]) -> Result<usize, rom::EvaluateError>;

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
    let (model, file) = (Place::output(model), Buffer::input(file.cast::<u8>(), length));
    let mut work = move |(), failure: &mut Error| {
        holds::<Model>(size, failure)?;
        // SAFETY: the caller keeps what the module says.
        unsafe {
            model.clear();
            failure.of(rom::Model::open_in(model.room(), file.values()))?;
            model.set_up();
        }
        Ok(())
    };
    // SAFETY: the caller keeps what the module says.
    unsafe { call(None, &[model.written(), file.read()], error, &mut work) }
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
    let (model, out) = (Place::input(model), Place::output(description));
    let mut work = move |(), failure: &mut Error| {
        // SAFETY: the caller keeps what the module says.
        let (model, out) = unsafe { (failure.of(model.content())?, out.memory()) };
        let mesh = model.mesh();
        let points = |outline| model.node_set(outline).map_or(0, |nodes| nodes.len());
        out.write(Description {
            digest: model.digest(),
            parameter_count: model.parameters().len(),
            nodes: mesh.nodes(),
            sector_nodes: mesh.sector_nodes().len(),
            midplane_points: points(rom::MIDPLANE),
            diagonal_points: points(rom::DIAGONAL),
            end_time: model.end_time(),
            method: match model.default_method() {
                rom::Method::Direct => Method::Direct,
                rom::Method::Paper => Method::Paper,
            },
            law: model.membrane_law().as_ptr().cast(),
            law_length: model.membrane_law().len(),
            bending_stiffness: model.bending_stiffness().map_or(-1.0, |b| b as f32),
        });
        Ok(())
    };
    // SAFETY: the caller keeps what the module says.
    unsafe { call(Some(&model), &[model.read(), out.written()], error, &mut work) }
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
    let (model, out) = (Place::input(model), Place::output(parameter));
    let mut work = move |(), failure: &mut Error| {
        // SAFETY: the caller keeps what the module says.
        let (model, out) = unsafe { (failure.of(model.content())?, out.memory()) };
        let parameters = model.parameters();
        let found = parameters
            .get(index)
            .ok_or_else(|| failure.choice("parameter", index, parameters.len() - 1))?;
        out.write(Parameter {
            name: found.name.as_ptr().cast(),
            name_length: found.name.len(),
            least: found.min,
            greatest: found.max,
        });
        Ok(())
    };
    // SAFETY: the caller keeps what the module says.
    unsafe { call(Some(&model), &[model.read(), out.written()], error, &mut work) }
}

/// Makes an empty workspace of memory, of which `size` is `sizeof *workspace`.
///
/// # Safety
/// See [`functions`](self).
#[unsafe(no_mangle)]
pub unsafe extern "C" fn capsule_v1_initialise(workspace: *mut Workspace, size: usize, error: *mut Error) -> Status {
    let workspace = Place::output(workspace);
    let mut work = move |(), failure: &mut Error| {
        holds::<Workspace>(size, failure)?;
        // SAFETY: the caller keeps what the module says.
        unsafe { workspace.empty() };
        Ok(())
    };
    // SAFETY: the caller keeps what the module says.
    unsafe { call(None, &[workspace.written()], error, &mut work) }
}

/// Prepares a query; nothing is done if it is the one already prepared. `domain` may be null, else it says where the
/// parameters lie, also where they are refused, and `CAPSULE_DOMAIN_UNKNOWN` where the call fails before it looks.
/// Where a pointer is refused, it is left as it was.
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
    let (model, workspace, query, domain) = (
        Place::input(model),
        Place::output(workspace),
        Place::input(query),
        Place::output(domain),
    );
    // SAFETY: the caller keeps what the module says.
    let parameters = unsafe { parameters_of(&query, &model) };
    let say = move |place| {
        if !domain.is_null() {
            // SAFETY: the caller keeps what the module says.
            unsafe { domain.memory() }.write(place);
        }
    };
    let mut work = move |(), failure: &mut Error| {
        say(Domain::Unknown);
        // SAFETY: the caller keeps what the module says.
        let (model, workspace, query) = unsafe {
            (
                failure.of(model.content())?,
                failure.of(workspace.content_mut())?,
                query.start().read(),
            )
        };
        // A refusal here leaves nothing prepared either.
        let refused = |workspace: &mut crate::opaque::CoreWorkspace, failed| {
            workspace.invalidate();
            Err(failed)
        };
        let (expected, found) = (model.parameters().len(), query.parameter_count);
        // SAFETY: the caller keeps what the module says.
        let parameters = Some(found)
            .filter(|found| *found == expected)
            .and_then(|_| rom::Parameters::new(unsafe { parameters.values() }));
        let Some(parameters) = parameters else {
            return refused(
                workspace,
                failure.counts(Status::ParameterCount, "", found, expected, 0),
            );
        };
        let method = match query.method {
            0 => model.default_method(),
            1 => rom::Method::Direct,
            2 => rom::Method::Paper,
            other => return refused(workspace, failure.choice("method", other as usize, 2)),
        };
        let mut asked = rom::Query::new(parameters, method);
        asked.extrapolate = query.extrapolate != 0;
        if query.step != 0.0 {
            asked.step = Some(query.step);
        }
        let prepared = failure.of(Evaluator::new(model, workspace))?.prepare(&asked);
        // They are as many as the model's.
        let found = model.domain(parameters).unwrap_or(rom::Domain::Outside);
        say(place_of(&prepared, found).into());
        prepared.map_or_else(|error| Err(failure.query(error, model)), |_| Ok(()))
    };
    let buffers = [
        model.read(),
        workspace.written(),
        query.read(),
        parameters.read(),
        domain.written().optional(),
    ];
    // SAFETY: the caller keeps what the module says.
    unsafe { call(Some(&model), &buffers, error, &mut work) }
}

/// Does at most `pieces` pieces of the work that everything at the instant `t` waits for, and sets `done` to 1 when
/// nothing is left, else to 0: for callers who must not be kept long. A piece is a snapshot, a row or a mode of a local
/// basis, or a step in time, of the paper's method; the direct method has no such work. What is asked at an instant
/// does what is left of it.
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

/// Expected modified Hausdorff distance at the instant `t` to the full-order model (with the law and the bending
/// stiffness of the description), laboratory frame, as a fraction of the radius a; to other people's data the mean
/// distance of the nodes. Outside the sampled domain it is a guess.
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
        number(model, workspace, t, expected_error, error, |instant| {
            instant.expected_error()
        })
    }
}

/// The bound that 95 of 100 errors are below at the instant `t`, like the expected error. Outside the sampled domain,
/// where `capsule_v1_prepare` says another domain than `CAPSULE_DOMAIN_INSIDE`, none is known:
/// `CAPSULE_STATUS_NO_BOUND`.
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
    unsafe { number(model, workspace, t, error_bound, error, |instant| instant.error_bound()) }
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
    unsafe { number(model, workspace, t, centroid, error, |instant| instant.centroid()) }
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
    unsafe { number(model, workspace, t, volume, error, |instant| instant.volume()) }
}

/// An outline (a `capsule_outline`) at the instant `t` in a frame (a `capsule_frame`): points x, r, x, r, ... in l,
/// from the front pole to the rear pole. `points` has room for `capacity` numbers; `count` is set to how many were
/// written.
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
    let mut ask = move |(instant, out): (&mut Instant<'_>, &mut [f32]), failure: &mut Error| {
        let name = match outline {
            0 => rom::MIDPLANE,
            1 => rom::DIAGONAL,
            other => return Err(failure.choice("outline", other as usize, 1)),
        };
        let written = instant.outline(name, frame_of(frame, failure)?, out.as_chunks_mut().0);
        Ok(2 * failure.of(in_numbers(written, 2))?)
    };
    // SAFETY: the caller keeps what the module says.
    unsafe {
        many(
            model,
            workspace,
            t,
            Bytes::NONE,
            points,
            capacity,
            count,
            error,
            &mut ask,
        )
    }
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
    let (scratch, out) = (Buffer::output(scratch, capacity), Place::output(membrane));
    let mut ask = move |instant: &mut Instant<'_>, failure: &mut Error| {
        // SAFETY: the caller keeps what the module says.
        let (scratch, out) = unsafe { (scratch.room(), out.memory()) };
        let membrane = instant.membrane(scratch.as_chunks_mut().0);
        let totals = membrane
            .as_ref()
            .map_err(|error| *error)
            .and_then(|membrane| membrane.totals());
        let totals = failure.of(in_numbers(totals, 3))?;
        out.write(Membrane {
            area: totals.area,
            energy: totals.energy,
            pressure_drop: totals.pressure_drop,
        });
        Ok(())
    };
    let others = [scratch.written(), out.written()];
    // SAFETY: the caller keeps what the module says.
    unsafe { call_at(model, workspace, t, others, error, &mut ask) }
}

/// Runs the work of a call on its buffers, unless one of them is refused, and writes its error where the caller wants
/// it; nothing where `error` itself is refused. `model` is the one that is asked.
#[inline(never)]
unsafe fn call(
    model: Option<&Place<Model>>,
    buffers: &[Bytes],
    error: *mut Error,
    work: &mut dyn Work<(), ()>,
) -> Status {
    let error = Place::output(error);
    let place = error.written().optional();
    if let Err(status) = check_error(place, buffers) {
        return status;
    }
    // SAFETY: the caller keeps what the module says.
    let file = model
        .filter(|model| model.is_sound())
        .map_or(Bytes::NONE, |model| unsafe { model.file() });
    if place.overlaps(&file) {
        return Status::Overlap;
    }
    let mut unasked = MaybeUninit::uninit();
    let error = if error.is_null() {
        Place::output(unasked.as_mut_ptr())
    } else {
        error
    };
    // SAFETY: the caller keeps what the module says, and no other buffer is there. Zeros say that nothing failed.
    let failure = unsafe { error.zeros() };
    // What failed is in the status.
    let (Ok(()) | Err(Failed)) = match failure.of(check(buffers, file)) {
        Ok(()) => work.run((), failure),
        failed => failed,
    };
    failure.status
}

/// A query's parameters, of which no more are looked at than the model has. None of a query that cannot be read; that
/// is refused.
///
/// # Safety
/// The caller keeps what the module says.
unsafe fn parameters_of(query: &Place<Query>, model: &Place<Model>) -> Buffer<f32> {
    if !(query.is_sound() && model.is_sound()) {
        return Buffer::input(core::ptr::null(), 0);
    }
    // SAFETY: the caller keeps what the module says.
    let (query, model) = unsafe { (query.start().read(), model.content()) };
    let most = model.map_or(0, |model| model.parameters().len());
    Buffer::input(query.parameters, query.parameter_count.min(most))
}

/// Refuses an object that the caller says is smaller than its content.
fn holds<O>(size: usize, failure: &mut Error) -> Result<(), Failed> {
    let needed = size_of::<O>();
    if size < needed {
        return Err(failure.counts(Status::Short, "", size, needed, 0));
    }
    Ok(())
}

/// Where a query lies, prepared or refused, of which the ranges and the steady limit say `found`.
fn place_of(prepared: &Result<rom::Domain, rom::EvaluateError>, found: rom::Domain) -> rom::Domain {
    use rom::EvaluateError::{BeyondExtrapolation, FarFromSamples};
    match (prepared, found) {
        (Ok(place), _) => *place,
        (Err(FarFromSamples { .. } | BeyondExtrapolation { .. }), rom::Domain::Inside) => rom::Domain::FarFromSamples,
        (Err(_), place) => place,
    }
}

fn frame_of(frame: u32, failure: &mut Error) -> Result<rom::Frame, Failed> {
    match frame {
        0 => Ok(rom::Frame::Laboratory),
        1 => Ok(rom::Frame::Centroid),
        other => Err(failure.choice("frame", other as usize, 1)),
    }
}

/// Says in numbers what a buffer of points lacks.
fn in_numbers<A>(result: Result<A, rom::EvaluateError>, numbers: usize) -> Result<A, rom::EvaluateError> {
    result.map_err(|error| match error {
        rom::EvaluateError::BufferTooShort { required, found } => rom::EvaluateError::BufferTooShort {
            required: numbers * required,
            found: numbers * found,
        },
        other => other,
    })
}

/// Asks something at an instant of the prepared query.
unsafe fn at(
    model: Place<Model>,
    workspace: Place<Workspace>,
    t: f32,
    ask: &mut Ask<'_>,
    failure: &mut Error,
) -> Result<(), Failed> {
    // SAFETY: the caller keeps what the module says.
    let (model, workspace) = unsafe { (failure.of(model.content())?, failure.of(workspace.content_mut())?) };
    let mut evaluator = failure.of(Evaluator::new(model, workspace))?;
    ask.run(&mut failure.of(evaluator.at(t))?, failure)
}

/// A call that asks something at an instant, with one or two buffers besides the model and the workspace.
unsafe fn call_at(
    model: *const Model,
    workspace: *mut Workspace,
    t: f32,
    [first, second]: [Bytes; 2],
    error: *mut Error,
    ask: &mut Ask<'_>,
) -> Status {
    let (model, workspace) = (Place::input(model), Place::output(workspace));
    let buffers = [model.read(), workspace.written(), first, second];
    // SAFETY: the caller keeps what the module says.
    unsafe {
        call(Some(&model), &buffers, error, &mut move |(), failure: &mut Error| {
            at(model, workspace, t, ask, failure)
        })
    }
}

/// A call that answers with one value.
unsafe fn one<A>(
    model: *const Model,
    workspace: *mut Workspace,
    t: f32,
    out: *mut A,
    error: *mut Error,
    ask: impl Fn(&mut Instant<'_>) -> Result<A, rom::EvaluateError>,
) -> Status {
    let out = Place::output(out);
    let mut ask = move |instant: &mut Instant<'_>, failure: &mut Error| {
        let found = failure.of(ask(instant))?;
        // SAFETY: the caller keeps what the module says.
        unsafe { out.memory() }.write(found);
        Ok(())
    };
    // SAFETY: the caller keeps what the module says.
    unsafe { call_at(model, workspace, t, [out.written(), Bytes::NONE], error, &mut ask) }
}

/// A call that answers with one number.
#[inline(never)]
unsafe fn number(
    model: *const Model,
    workspace: *mut Workspace,
    t: f32,
    out: *mut f32,
    error: *mut Error,
    ask: fn(&mut Instant<'_>) -> Result<f32, rom::EvaluateError>,
) -> Status {
    // SAFETY: the caller keeps what the module says.
    unsafe { one(model, workspace, t, out, error, ask) }
}

/// A call that answers with many numbers.
unsafe fn many(
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
    let mut work = move |(), failure: &mut Error| {
        // SAFETY: the caller keeps what the module says.
        let (out, count) = unsafe { (out.room(), count.memory()) };
        let mut ask = |instant: &mut Instant<'_>, failure: &mut Error| {
            count.write(fill.run((instant, out), failure)?);
            Ok(())
        };
        // SAFETY: the caller keeps what the module says.
        unsafe { at(model, workspace, t, &mut ask, failure) }
    };
    let buffers = [model.read(), workspace.written(), out.written(), count.written(), list];
    // SAFETY: the caller keeps what the module says.
    unsafe { call(Some(&model), &buffers, error, &mut work) }
}

/// A call that answers with vectors at nodes.
#[inline(never)]
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
    ask: Vectors,
) -> Status {
    let list = Buffer::input(nodes, node_count);
    let mut ask = move |(instant, out): (&mut Instant<'_>, &mut [f32]), failure: &mut Error| {
        let nodes = if list.is_null() {
            Nodes::All
        } else {
            // SAFETY: the caller keeps what the module says.
            Nodes::List(unsafe { list.values() })
        };
        let frame = frame_of(frame, failure)?;
        let written = ask(instant, &Scene { nodes, frame }, out.as_chunks_mut().0);
        Ok(3 * failure.of(in_numbers(written, 3))?)
    };
    let bytes = list.read().optional();
    // SAFETY: the caller keeps what the module says.
    unsafe { many(model, workspace, t, bytes, out, capacity, count, error, &mut ask) }
}
