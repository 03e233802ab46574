//! Answers at an instant of the prepared query.

use crate::dispatch::{Instant, array_at, call_at, count_in_numbers, frame_of, number_at, value_at, vectors_at};
use crate::error::Error;
use crate::memory::{Buffer, Bytes, Place};
use crate::{Membrane, Model, Observables, Status, Workspace};
use capsule_core as rom;

/// Does at most `pieces` pieces of the work that everything at the instant `t` waits for, and sets `done` to 1 when
/// nothing is left, else to 0: for callers who must not be kept long. A piece is a snapshot, a row or a mode of a local
/// basis, or a step in time, of the paper's method; the direct method has no such work. What is asked at an instant
/// does what is left of it.
///
/// # Safety
/// See [`functions`](crate::functions).
#[unsafe(no_mangle)]
pub unsafe extern "C" fn capsule_v1_advance(
    model: *const Model,
    workspace: *mut Workspace,
    t: f32,
    pieces: usize,
    done: *mut u32,
    error: *mut Error,
) -> Status {
    // SAFETY: the caller keeps the contract of `functions`.
    unsafe {
        value_at(model, workspace, t, done, error, |instant| {
            Ok(u32::from(instant.advance(pieces)))
        })
    }
}

/// Lengths and velocity at the instant `t`, in l/V, of the prepared query.
///
/// # Safety
/// See [`functions`](crate::functions).
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
    // SAFETY: the caller keeps the contract of `functions`.
    unsafe { value_at(model, workspace, t, observables, error, ask) }
}

/// Expected modified Hausdorff distance at the instant `t` to the full-order model (with the law and the bending
/// stiffness of the description), laboratory frame, as a fraction of the radius a; to other people's data the mean
/// distance of the nodes. Outside the sampled domain it is a guess.
///
/// # Safety
/// See [`functions`](crate::functions).
#[unsafe(no_mangle)]
pub unsafe extern "C" fn capsule_v1_expected_error_at(
    model: *const Model,
    workspace: *mut Workspace,
    t: f32,
    expected_error: *mut f32,
    error: *mut Error,
) -> Status {
    // SAFETY: the caller keeps the contract of `functions`.
    unsafe {
        number_at(model, workspace, t, expected_error, error, |instant| {
            instant.expected_error()
        })
    }
}

/// The bound that 95 of 100 errors are below at the instant `t`, like the expected error. Outside the sampled domain,
/// where `capsule_v1_prepare` says another domain than `CAPSULE_DOMAIN_INSIDE`, none is known:
/// `CAPSULE_STATUS_NO_BOUND`.
///
/// # Safety
/// See [`functions`](crate::functions).
#[unsafe(no_mangle)]
pub unsafe extern "C" fn capsule_v1_error_bound_at(
    model: *const Model,
    workspace: *mut Workspace,
    t: f32,
    error_bound: *mut f32,
    error: *mut Error,
) -> Status {
    // SAFETY: the caller keeps the contract of `functions`.
    unsafe { number_at(model, workspace, t, error_bound, error, |instant| instant.error_bound()) }
}

/// Position of the centroid at the instant `t`, laboratory frame, in l.
///
/// # Safety
/// See [`functions`](crate::functions).
#[unsafe(no_mangle)]
pub unsafe extern "C" fn capsule_v1_centroid_at(
    model: *const Model,
    workspace: *mut Workspace,
    t: f32,
    centroid: *mut f32,
    error: *mut Error,
) -> Status {
    // SAFETY: the caller keeps the contract of `functions`.
    unsafe { number_at(model, workspace, t, centroid, error, |instant| instant.centroid()) }
}

/// Enclosed volume at the instant `t`, in l^3.
///
/// # Safety
/// See [`functions`](crate::functions).
#[unsafe(no_mangle)]
pub unsafe extern "C" fn capsule_v1_volume_at(
    model: *const Model,
    workspace: *mut Workspace,
    t: f32,
    volume: *mut f32,
    error: *mut Error,
) -> Status {
    // SAFETY: the caller keeps the contract of `functions`.
    unsafe { number_at(model, workspace, t, volume, error, |instant| instant.volume()) }
}

/// An outline (a `capsule_outline`) at the instant `t` in a frame (a `capsule_frame`): points x, r, x, r, ... in l,
/// from the front pole to the rear pole. `points` has room for `capacity` numbers; `count` is set to how many were
/// written.
///
/// # Safety
/// See [`functions`](crate::functions).
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
    let mut ask = move |instant: &mut Instant<'_>, out: &mut [f32], failure: &mut Error| {
        let name = match outline {
            0 => rom::MIDPLANE,
            1 => rom::DIAGONAL,
            other => return Err(failure.choice("outline", other as usize, 1)),
        };
        let written = instant.outline(name, frame_of(frame, failure)?, out.as_chunks_mut().0);
        Ok(2 * failure.record(count_in_numbers(written, 2))?)
    };
    // SAFETY: the caller keeps the contract of `functions`.
    unsafe {
        array_at(
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
/// See [`functions`](crate::functions).
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
    // SAFETY: the caller keeps the contract of `functions`.
    unsafe {
        vectors_at(
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
/// See [`functions`](crate::functions).
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
    // SAFETY: the caller keeps the contract of `functions`.
    unsafe {
        vectors_at(
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
/// See [`functions`](crate::functions).
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
        // SAFETY: the caller keeps the contract of `functions`.
        let (scratch, out) = unsafe { (scratch.room(), out.memory()) };
        let membrane = instant.membrane(scratch.as_chunks_mut().0);
        let totals = membrane
            .as_ref()
            .map_err(|error| *error)
            .and_then(|membrane| membrane.totals());
        let totals = failure.record(count_in_numbers(totals, 3))?;
        out.write(Membrane {
            area: totals.area,
            energy: totals.energy,
            pressure_drop: totals.pressure_drop,
        });
        Ok(())
    };
    let others = [scratch.written(), out.written()];
    // SAFETY: the caller keeps the contract of `functions`.
    unsafe { call_at(model, workspace, t, others, error, &mut ask) }
}
