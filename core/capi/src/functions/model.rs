//! Opening and describing models, setting up workspaces.

use crate::dispatch::{call, check_size};
use crate::error::Error;
use crate::memory::{Buffer, Place};
use crate::{Description, Method, Model, Parameter, Status, Workspace};
use capsule_core as rom;
use core::ffi::{c_char, c_void};

/// Version of this library, such as "0.1.0": a program compares it with the `CAPSULE_VERSION` that it was compiled
/// with.
#[unsafe(no_mangle)]
pub extern "C" fn capsule_v1_version() -> *const c_char {
    const VERSION: &str = concat!(env!("CARGO_PKG_VERSION"), "\0");
    VERSION.as_ptr().cast()
}

/// The meaning of a status, as a sentence that ends with a zero.
#[unsafe(no_mangle)]
pub extern "C" fn capsule_v1_status_text(status: u32) -> *const c_char {
    Status::from_number(status).text().as_ptr()
}

/// Opens the model file of `length` bytes: checks it, and fills `model`, of which `size` is `sizeof *model`. Nothing is
/// copied: the bytes are read where they lie, fastest if that is at a multiple of 16.
///
/// # Safety
/// See [`functions`](crate::functions).
#[unsafe(no_mangle)]
pub unsafe extern "C" fn capsule_v1_open(
    model: *mut Model,
    size: usize,
    file: *const c_void,
    length: usize,
    error: *mut Error,
) -> Status {
    let (model, file) = (Place::output(model), Buffer::input(file.cast::<u8>(), length));
    let mut work = move |failure: &mut Error| {
        check_size::<Model>(size, failure)?;
        // SAFETY: the caller keeps the contract of `functions`.
        unsafe {
            model.clear();
            failure.record(rom::Model::open_in(model.room(), file.values()))?;
            model.set_up();
        }
        Ok(())
    };
    // SAFETY: the caller keeps the contract of `functions`.
    unsafe { call(None, &[model.written(), file.read()], error, &mut work) }
}

/// Describes a model.
///
/// # Safety
/// See [`functions`](crate::functions).
#[unsafe(no_mangle)]
pub unsafe extern "C" fn capsule_v1_describe(
    model: *const Model,
    description: *mut Description,
    error: *mut Error,
) -> Status {
    let (model, out) = (Place::input(model), Place::output(description));
    let mut work = move |failure: &mut Error| {
        // SAFETY: the caller keeps the contract of `functions`.
        let (model, out) = unsafe { (failure.record(model.content())?, out.memory()) };
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
    // SAFETY: the caller keeps the contract of `functions`.
    unsafe { call(Some(&model), &[model.read(), out.written()], error, &mut work) }
}

/// Name and range of parameter number `index`.
///
/// # Safety
/// See [`functions`](crate::functions).
#[unsafe(no_mangle)]
pub unsafe extern "C" fn capsule_v1_describe_parameter(
    model: *const Model,
    index: usize,
    parameter: *mut Parameter,
    error: *mut Error,
) -> Status {
    let (model, out) = (Place::input(model), Place::output(parameter));
    let mut work = move |failure: &mut Error| {
        // SAFETY: the caller keeps the contract of `functions`.
        let (model, out) = unsafe { (failure.record(model.content())?, out.memory()) };
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
    // SAFETY: the caller keeps the contract of `functions`.
    unsafe { call(Some(&model), &[model.read(), out.written()], error, &mut work) }
}

/// Makes an empty workspace of memory, of which `size` is `sizeof *workspace`.
///
/// # Safety
/// See [`functions`](crate::functions).
#[unsafe(no_mangle)]
pub unsafe extern "C" fn capsule_v1_initialise(workspace: *mut Workspace, size: usize, error: *mut Error) -> Status {
    let workspace = Place::output(workspace);
    let mut work = move |failure: &mut Error| {
        check_size::<Workspace>(size, failure)?;
        // SAFETY: the caller keeps the contract of `functions`.
        unsafe { workspace.empty() };
        Ok(())
    };
    // SAFETY: the caller keeps the contract of `functions`.
    unsafe { call(None, &[workspace.written()], error, &mut work) }
}
