//! Preparing a query.

use crate::dispatch::call;
use crate::error::Error;
use crate::memory::{Buffer, Place};
use crate::opaque::CoreWorkspace;
use crate::{Domain, Model, Query, Status, Workspace};
use capsule_core as rom;
use capsule_core::Evaluator;

/// Prepares a query; nothing is done if it is the one already prepared. `domain` may be null, else it says where the
/// parameters lie, also where they are refused, and `CAPSULE_DOMAIN_UNKNOWN` where the call fails before it looks.
/// Where a pointer is refused, it is left as it was.
///
/// # Safety
/// See [`functions`](crate::functions).
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
    // SAFETY: the caller keeps the contract of `functions`.
    let parameters = unsafe { parameters_of(&query, &model) };
    let report = move |place| {
        if !domain.is_null() {
            // SAFETY: the caller keeps the contract of `functions`.
            unsafe { domain.memory() }.write(place);
        }
    };
    let mut work = move |failure: &mut Error| {
        report(Domain::Unknown);
        // SAFETY: the caller keeps the contract of `functions`.
        let (model, workspace, query) = unsafe {
            (
                failure.record(model.content())?,
                failure.record(workspace.content_mut())?,
                query.start().read(),
            )
        };
        // A refusal here leaves nothing prepared either.
        let refused = |workspace: &mut CoreWorkspace, failed| {
            workspace.invalidate();
            Err(failed)
        };
        let (expected, found) = (model.parameters().len(), query.parameter_count);
        // SAFETY: the caller keeps the contract of `functions`.
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
        let prepared = failure.record(Evaluator::new(model, workspace))?.prepare(&asked);
        // They are as many as the model's.
        let found = model.domain(parameters).unwrap_or(rom::Domain::Outside);
        report(domain_of(&prepared, found).into());
        prepared.map_or_else(|error| Err(failure.query(error, model)), |_| Ok(()))
    };
    let buffers = [
        model.read(),
        workspace.written(),
        query.read(),
        parameters.read(),
        domain.written().optional(),
    ];
    // SAFETY: the caller keeps the contract of `functions`.
    unsafe { call(Some(&model), &buffers, error, &mut work) }
}

/// A query's parameters, at most as many as the model has; none of a query that cannot be read, which is refused.
///
/// # Safety
/// The caller keeps the contract of `functions`.
unsafe fn parameters_of(query: &Place<Query>, model: &Place<Model>) -> Buffer<f32> {
    if !(query.is_valid() && model.is_valid()) {
        return Buffer::input(core::ptr::null(), 0);
    }
    // SAFETY: the caller keeps the contract of `functions`.
    let (query, model) = unsafe { (query.start().read(), model.content()) };
    let most = model.map_or(0, |model| model.parameters().len());
    Buffer::input(query.parameters, query.parameter_count.min(most))
}

/// Where a query lies, prepared or refused: `found` is its place by the ranges and the steady limit.
fn domain_of(prepared: &Result<rom::Domain, rom::EvaluateError>, found: rom::Domain) -> rom::Domain {
    use rom::EvaluateError::{BeyondExtrapolation, FarFromSamples};
    match (prepared, found) {
        (Ok(place), _) => *place,
        (Err(FarFromSamples { .. } | BeyondExtrapolation { .. }), rom::Domain::Inside) => rom::Domain::FarFromSamples,
        (Err(_), place) => place,
    }
}
