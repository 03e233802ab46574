//! What C may hand in by mistake is refused, with a status that says what it was, and nothing is written.

#[path = "../../tests/common/mod.rs"]
mod common;

use capsule_capi::*;
use std::ffi::CStr;
use std::ptr::{null, null_mut};
use std::slice;

fn parameters(ca: f32) -> [f32; 2] {
    [ca, 0.9]
}

fn query(parameters: &[f32]) -> Query {
    Query {
        parameters: parameters.as_ptr(),
        parameter_count: parameters.len(),
        method: 0,
        extrapolate: 0,
        step: 0.0,
    }
}

fn no_error() -> Error {
    Error {
        status: Status::Ok,
        what: null(),
        what_length: 0,
        found: 0.0,
        least: 0.0,
        greatest: 0.0,
    }
}

struct Fixture {
    file: Vec<u8>,
    model: Box<Model>,
    workspace: Box<Workspace>,
}

impl Fixture {
    /// A model that is open and a workspace with a query.
    fn new() -> Self {
        let mut fixture = Self {
            file: common::Family::small().file(),
            model: Box::new(Model {
                opaque: [0; MODEL_WORDS],
            }),
            workspace: Box::new(Workspace {
                opaque: [0; WORKSPACE_WORDS],
            }),
        };
        assert_eq!(fixture.open(fixture.file.len(), null_mut()), Status::Ok);
        // SAFETY: the workspace is one.
        let made = unsafe { capsule_v1_initialise(&raw mut *fixture.workspace, WORKSPACE_SIZE, null_mut()) };
        assert_eq!(made, Status::Ok);
        assert_eq!(fixture.prepare(&query(&parameters(0.1)), null_mut()), Status::Ok);
        fixture
    }

    /// What the workspace holds; nothing in Miri, to which the padding between its fields is no number.
    fn words(&self) -> Option<[u64; WORKSPACE_WORDS]> {
        if cfg!(miri) { None } else { Some(self.workspace.opaque) }
    }

    fn open(&mut self, length: usize, error: *mut Error) -> Status {
        let file = self.file.as_ptr().cast();
        // SAFETY: the fixture owns the memory.
        unsafe { capsule_v1_open(&raw mut *self.model, MODEL_SIZE, file, length, error) }
    }

    fn prepare(&mut self, query: &Query, error: *mut Error) -> Status {
        // SAFETY: the fixture owns the memory.
        unsafe {
            capsule_v1_prepare(
                &raw const *self.model,
                &raw mut *self.workspace,
                query,
                null_mut(),
                error,
            )
        }
    }

    fn outline(
        &mut self,
        outline: u32,
        points: *mut f32,
        capacity: usize,
        count: *mut usize,
        error: *mut Error,
    ) -> Status {
        let (model, workspace) = (&raw const *self.model, &raw mut *self.workspace);
        // SAFETY: `points` and `count` are good, or refused.
        unsafe { capsule_v1_outline_at(model, workspace, 1.0, outline, 0, points, capacity, count, error) }
    }
}

#[test]
fn null_pointers() {
    let mut fixture = Fixture::new();
    let (model, workspace) = (&raw const *fixture.model, &raw mut *fixture.workspace);
    let asked = query(&[0.1, 0.9]);
    let no_parameters = Query {
        parameters: null(),
        ..asked
    };
    let mut count = 0;
    // SAFETY: every call has a null pointer.
    let found = unsafe {
        [
            capsule_v1_open(null_mut(), MODEL_SIZE, fixture.file.as_ptr().cast(), 0, null_mut()),
            capsule_v1_open(&raw mut *fixture.model, MODEL_SIZE, null(), 9, null_mut()),
            capsule_v1_describe(model, null_mut(), null_mut()),
            capsule_v1_describe(null(), null_mut(), null_mut()),
            capsule_v1_initialise(null_mut(), WORKSPACE_SIZE, null_mut()),
            capsule_v1_prepare(model, workspace, null(), null_mut(), null_mut()),
            capsule_v1_prepare(model, workspace, &no_parameters, null_mut(), null_mut()),
            capsule_v1_observables_at(model, workspace, 1.0, null_mut(), null_mut()),
            capsule_v1_outline_at(model, workspace, 1.0, 0, 0, null_mut(), 8, &mut count, null_mut()),
            capsule_v1_volume_at(model, null_mut(), 1.0, null_mut(), null_mut()),
        ]
    };
    assert_eq!(found, [Status::Null; 10]);
}

#[test]
fn misaligned_pointers() {
    let mut fixture = Fixture::new();
    let (model, workspace) = (&raw const *fixture.model, &raw mut *fixture.workspace);
    let mut numbers = [0.0_f32; 64];
    let odd = numbers.as_mut_ptr().wrapping_byte_add(1);
    let mut count = 0;
    assert_eq!(fixture.outline(0, odd, 8, &mut count, null_mut()), Status::Misaligned);
    // SAFETY: every call has a misaligned pointer.
    unsafe {
        assert_eq!(
            capsule_v1_volume_at(model, workspace, 1.0, odd, null_mut()),
            Status::Misaligned
        );
        let odd = workspace.wrapping_byte_add(4);
        assert_eq!(
            capsule_v1_initialise(odd, WORKSPACE_SIZE, null_mut()),
            Status::Misaligned
        );
        let volume = numbers.as_mut_ptr();
        let odd_error = numbers.as_mut_ptr().wrapping_byte_add(1).cast();
        assert_eq!(
            capsule_v1_volume_at(model, workspace, 1.0, volume, odd_error),
            Status::Misaligned
        );
    }
}

#[test]
fn short_buffers_say_what_is_needed() {
    let mut fixture = Fixture::new();
    let (mut numbers, mut count, mut error) = ([7.0_f32; 512], 0, no_error());
    let status = fixture.outline(0, numbers.as_mut_ptr(), 4, &mut count, &mut error);
    assert_eq!((status, error.status, error.found), (Status::Short, Status::Short, 4.0));
    assert!(error.least > 4.0 && numbers[4..].iter().all(|&number| number == 7.0));
    let status = fixture.outline(0, numbers.as_mut_ptr(), error.least as usize, &mut count, &mut error);
    assert_eq!((status, count), (Status::Ok, 2 * (count / 2)));
    let workspace = &raw mut *fixture.workspace;
    // SAFETY: the workspace is one.
    let status = unsafe { capsule_v1_initialise(workspace, WORKSPACE_SIZE - 1, &mut error) };
    assert_eq!((status, error.least), (Status::Short, WORKSPACE_SIZE as f64));
}

#[test]
fn overlapping_buffers() {
    let mut fixture = Fixture::new();
    // As words, so that what overlaps them is aligned.
    let (mut words, mut count) = ([0_u64; 256], 0);
    let inside = (&raw mut *fixture.workspace).cast::<f32>().wrapping_add(8);
    assert_eq!(fixture.outline(0, inside, 128, &mut count, null_mut()), Status::Overlap);
    let inside = (&raw mut *fixture.model).cast::<f32>();
    assert_eq!(fixture.outline(0, inside, 128, &mut count, null_mut()), Status::Overlap);
    let points = words.as_mut_ptr().cast::<f32>();
    assert_eq!(
        fixture.outline(0, points, 512, points.wrapping_add(2).cast(), null_mut()),
        Status::Overlap
    );
    assert_eq!(
        fixture.outline(0, points, usize::MAX / 4, &mut count, null_mut()),
        Status::Overlap
    );
    let inside = (&raw mut *fixture.workspace).cast();
    assert_eq!(fixture.outline(0, points, 512, &mut count, inside), Status::Overlap);
    assert_eq!(
        fixture.outline(0, points, 512, &mut count, null_mut()),
        Status::Ok,
        "the workspace is as it was"
    );
}

/// Whatever a call writes, it does not write over the file that the model reads.
#[test]
fn the_file_is_not_written_over() {
    let mut fixture = Fixture::new();
    let before = fixture.file.clone();
    let (model, workspace) = (&raw const *fixture.model, &raw mut *fixture.workspace);
    let start = fixture.file.as_mut_ptr();
    let inside = start.wrapping_add(start.align_offset(8) + 64);
    let (mut numbers, mut count, mut totals) = ([0.0_f32; 3 * 18], 0, [0.0_f32; 3]);
    let (points, capacity, totals) = (numbers.as_mut_ptr(), numbers.len(), totals.as_mut_ptr().cast());
    let (asked, none) = (parameters(0.1), null_mut());
    let (asked, error) = (query(&asked), inside.cast());
    // SAFETY: every call is refused.
    let found = unsafe {
        [
            capsule_v1_describe(model, inside.cast(), none),
            capsule_v1_describe_parameter(model, 0, inside.cast(), none),
            capsule_v1_prepare(model, workspace, &asked, inside.cast(), none),
            capsule_v1_prepare(model, inside.cast(), &asked, null_mut(), none),
            capsule_v1_prepare(model, workspace, &asked, null_mut(), error),
            capsule_v1_advance(model, workspace, 1.0, 1, inside.cast(), none),
            capsule_v1_observables_at(model, workspace, 1.0, inside.cast(), none),
            capsule_v1_expected_error_at(model, workspace, 1.0, inside.cast(), none),
            capsule_v1_error_bound_at(model, workspace, 1.0, inside.cast(), none),
            capsule_v1_centroid_at(model, workspace, 1.0, inside.cast(), none),
            capsule_v1_volume_at(model, workspace, 1.0, inside.cast(), none),
            capsule_v1_outline_at(model, workspace, 1.0, 0, 0, inside.cast(), 16, &mut count, none),
            capsule_v1_outline_at(model, workspace, 1.0, 0, 0, points, capacity, inside.cast(), none),
            capsule_v1_outline_at(model, workspace, 1.0, 0, 0, points, capacity, &mut count, error),
            capsule_v1_positions_at(
                model,
                workspace,
                1.0,
                0,
                null(),
                0,
                inside.cast(),
                capacity,
                &mut count,
                none,
            ),
            capsule_v1_velocities_at(
                model,
                workspace,
                1.0,
                0,
                null(),
                0,
                inside.cast(),
                capacity,
                &mut count,
                none,
            ),
            capsule_v1_membrane_at(model, workspace, 1.0, inside.cast(), capacity, totals, none),
            capsule_v1_membrane_at(model, workspace, 1.0, points, capacity, inside.cast(), none),
        ]
    };
    assert_eq!(found, [Status::Overlap; 18]);
    assert!(fixture.file == before);
    // What is only read may lie there: the nodes of an outline, for one.
    // SAFETY: the memory is there.
    let listed = unsafe {
        capsule_v1_positions_at(
            model,
            workspace,
            1.0,
            0,
            inside.cast(),
            1,
            points,
            capacity,
            &mut count,
            none,
        )
    };
    assert!(listed != Status::Overlap);
}

/// The error may be what is at fault: then it is not written, not even for a fault that is found first.
#[test]
fn an_error_inside_an_object_is_not_written() {
    let mut fixture = Fixture::new();
    let inside = (&raw mut *fixture.workspace).wrapping_byte_add(64).cast();
    let (model, workspace) = (&raw const *fixture.model, &raw mut *fixture.workspace);
    let before = fixture.words();
    // SAFETY: every call is refused.
    let found = unsafe {
        [
            capsule_v1_volume_at(model, workspace, 1.0, null_mut(), inside),
            capsule_v1_prepare(model, workspace, null(), null_mut(), inside),
            capsule_v1_initialise(workspace, 8, inside),
        ]
    };
    assert_eq!(found, [Status::Null, Status::Null, Status::Overlap]);
    assert!(fixture.words() == before);
}

#[test]
fn objects_that_were_not_set_up() {
    let mut fixture = Fixture::new();
    let mut volume = 0.0;
    let empty = Model {
        opaque: [0; MODEL_WORDS],
    };
    let mut bare = Box::new(Workspace {
        opaque: [0; WORKSPACE_WORDS],
    });
    // SAFETY: the memory is there.
    unsafe {
        let workspace = &raw mut *fixture.workspace;
        assert_eq!(
            capsule_v1_volume_at(&empty, workspace, 1.0, &mut volume, null_mut()),
            Status::NoModel
        );
        let model = &raw const *fixture.model;
        assert_eq!(
            capsule_v1_volume_at(model, &raw mut *bare, 1.0, &mut volume, null_mut()),
            Status::NoWorkspace
        );
        capsule_v1_initialise(&raw mut *bare, WORKSPACE_SIZE, null_mut());
        assert_eq!(
            capsule_v1_volume_at(model, &raw mut *bare, 1.0, &mut volume, null_mut()),
            Status::NotPrepared
        );
    }
    let mut error = no_error();
    assert_eq!(fixture.open(100, &mut error), Status::Truncated);
    assert_eq!((error.found, error.least), (100.0, fixture.file.len() as f64));
    assert_eq!(
        fixture.prepare(&query(&[0.1, 0.9]), null_mut()),
        Status::NoModel,
        "a failed open leaves no model"
    );
}

#[test]
fn questions_that_make_no_sense() {
    let mut fixture = Fixture::new();
    let mut error = no_error();
    assert_eq!(
        fixture.prepare(&query(&[0.1, 0.9, 1.0]), &mut error),
        Status::ParameterCount
    );
    assert_eq!((error.found, error.least), (3.0, 2.0));
    let method = Query {
        method: 3,
        ..query(&[0.1, 0.9])
    };
    assert_eq!(fixture.prepare(&method, &mut error), Status::Choice);
    assert_eq!(fixture.prepare(&query(&[0.9, 0.9]), &mut error), Status::OutsideDomain);
    assert!((error.greatest - 0.2).abs() < 1e-6);
    // SAFETY: the name lies in the model's file.
    let name = unsafe { slice::from_raw_parts(error.what.cast::<u8>(), error.what_length) };
    assert_eq!(name, b"capillary_number");
    let (mut numbers, mut count) = ([0.0; 512], 0);
    assert_eq!(
        fixture.outline(2, numbers.as_mut_ptr(), 512, &mut count, &mut error),
        Status::Choice
    );
    for status in 0..200 {
        let text = capsule_v1_status_text(status);
        // SAFETY: the interface promises a text that ends with a zero.
        assert!(!unsafe { CStr::from_ptr(text) }.to_str().unwrap().is_empty());
    }
}

#[test]
#[cfg_attr(miri, ignore = "steps the paper's method to the end")]
fn pieces_lead_to_the_same_answer() {
    let mut fixture = Fixture::new();
    let parameters = parameters(0.1);
    let paper = Query {
        method: 2,
        ..query(&parameters)
    };
    let ask = |fixture: &mut Fixture, pieces: Option<usize>| {
        let (model, workspace) = (&raw const *fixture.model, &raw mut *fixture.workspace);
        let (mut calls, mut done, mut volume) = (0, 0, 0.0);
        // SAFETY: the fixture owns the memory.
        unsafe {
            while let (Some(pieces), 0) = (pieces, done) {
                assert_eq!(
                    capsule_v1_advance(model, workspace, 2.0, pieces, &mut done, null_mut()),
                    Status::Ok
                );
                calls += 1;
            }
            assert_eq!(
                capsule_v1_volume_at(model, workspace, 2.0, &mut volume, null_mut()),
                Status::Ok
            );
        }
        (calls, volume)
    };
    assert_eq!(fixture.prepare(&paper, null_mut()), Status::Ok);
    let (calls, sliced) = ask(&mut fixture, Some(3));
    assert!(calls > 10);
    assert_eq!(fixture.prepare(&query(&parameters), null_mut()), Status::Ok);
    assert_eq!(fixture.prepare(&paper, null_mut()), Status::Ok);
    assert_eq!(ask(&mut fixture, None).1, sliced);
}
