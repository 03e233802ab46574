//! Wrong arguments from C are refused, with a status and an error that say what it was, and nothing else is
//! written.

#[path = "../../tests/suite/common/mod.rs"]
mod common;

use capsule_capi::*;
use std::ffi::CStr;
use std::mem::MaybeUninit;
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
        Self::of(common::Family::small())
    }

    fn of(family: common::Family) -> Self {
        let mut fixture = Self {
            file: family.file(),
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

    /// Bytes of the workspace; none in Miri, where the padding between its fields is uninitialised.
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
    // Inputs may lie there: the nodes of an outline, for one.
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

/// The error may be what is at fault: then it is not written, whatever else is at fault.
#[test]
fn an_error_inside_an_object_is_not_written() {
    let mut fixture = Fixture::new();
    let inside = (&raw mut *fixture.workspace).wrapping_byte_add(64).cast();
    let (model, workspace) = (&raw const *fixture.model, &raw mut *fixture.workspace);
    let before = fixture.words();
    // As words, so that an error fits into them.
    let mut parameters = [u64::MAX; 8];
    let asked = Query {
        parameters: parameters.as_ptr().cast(),
        parameter_count: 3,
        ..query(&[])
    };
    // SAFETY: every call is refused.
    let found = unsafe {
        [
            capsule_v1_volume_at(model, workspace, 1.0, null_mut(), inside),
            capsule_v1_prepare(model, workspace, null(), null_mut(), inside),
            capsule_v1_initialise(workspace, 8, inside),
            capsule_v1_prepare(model, workspace, &asked, null_mut(), parameters.as_mut_ptr().cast()),
        ]
    };
    assert_eq!(found, [Status::Overlap; 4]);
    assert!(fixture.words() == before && parameters == [u64::MAX; 8]);
}

/// An error of which no field is as a call leaves it.
fn old_error() -> Error {
    Error {
        status: Status::Other,
        what: c"old".as_ptr(),
        what_length: 3,
        found: 1.0,
        least: 2.0,
        greatest: 3.0,
    }
}

#[test]
fn the_error_says_which_kind_of_pointer_was_refused() {
    let mut fixture = Fixture::new();
    let (model, workspace) = (&raw const *fixture.model, &raw mut *fixture.workspace);
    let mut numbers = [7.0_f32; 64];
    let (points, mut count, mut domain) = (numbers.as_mut_ptr(), 99, Domain::FarFromSamples);
    let (count, domain) = (&raw mut count, &raw mut domain);
    let (odd, most) = (points.wrapping_byte_add(1), usize::MAX / 4);
    let asked = parameters(0.1);
    let good = query(&asked);
    let bad = |parameters| Query { parameters, ..good };
    let (no_array, odd_array, shared) = (bad(null()), bad(odd), bad(domain.cast()));
    let odd_query = (&raw const good).wrapping_byte_add(1);
    let start = fixture.file.as_mut_ptr();
    let in_file = start.wrapping_add(start.align_offset(8) + 64).cast::<f32>();
    let (size, length) = (MODEL_SIZE, fixture.file.len());
    let inside = (&raw mut *fixture.model).cast();
    type Call<'c> = Box<dyn Fn(*mut Error) -> Status + 'c>;
    let outline = |points, capacity, count| -> Call {
        // SAFETY: every call is refused.
        Box::new(move |error| unsafe {
            capsule_v1_outline_at(model, workspace, 1.0, 0, 0, points, capacity, count, error)
        })
    };
    let prepare = |query| -> Call {
        // SAFETY: every call is refused.
        Box::new(move |error| unsafe { capsule_v1_prepare(model, workspace, query, domain, error) })
    };
    let volume = |model, workspace, volume| -> Call {
        // SAFETY: every call is refused.
        Box::new(move |error| unsafe { capsule_v1_volume_at(model, workspace, 1.0, volume, error) })
    };
    let open = |file| -> Call {
        // SAFETY: every call is refused.
        Box::new(move |error| unsafe { capsule_v1_open(inside, size, file, length, error) })
    };
    let calls = [
        (Status::Null, outline(null_mut(), 8, count)),
        (Status::Null, outline(points, 64, null_mut())),
        (Status::Null, prepare(null())),
        (Status::Null, prepare(&no_array)),
        (Status::Null, volume(null(), workspace, points)),
        (Status::Null, volume(model, null_mut(), points)),
        (Status::Null, volume(model, workspace, null_mut())),
        (Status::Null, open(null())),
        (Status::Misaligned, outline(odd, 8, count)),
        (Status::Misaligned, prepare(odd_query)),
        (Status::Misaligned, prepare(&odd_array)),
        (
            Status::Misaligned,
            volume(model.wrapping_byte_add(1), workspace, points),
        ),
        (Status::Overlap, outline(points, most, count)),
        (Status::Overlap, outline(inside.cast(), 8, count)),
        (Status::Overlap, prepare(&shared)),
        (Status::Overlap, volume(model, workspace, in_file)),
        (Status::Overlap, open(inside.cast_const().cast())),
    ];
    for (i, (status, call)) in calls.iter().enumerate() {
        let mut error = old_error();
        assert_eq!((call(&mut error), error.status), (*status, *status), "call {i}");
        assert!(error.what.is_null() && error.what_length == 0, "call {i}");
        assert_eq!((error.found, error.least, error.greatest), (0.0, 0.0, 0.0), "call {i}");
    }
    // SAFETY: they are there.
    assert_eq!(unsafe { (count.read(), domain.read()) }, (99, Domain::FarFromSamples));
    assert_eq!(numbers, [7.0; 64]);
}

#[test]
fn nothing_but_the_error_is_written_where_a_call_fails() {
    let mut fixture = Fixture::new();
    let (model, workspace) = (&raw const *fixture.model, &raw mut *fixture.workspace);
    let (mut numbers, mut count, mut totals) = ([7.0_f32; 4096], 99, [7.0_f32; 3]);
    let (points, capacity, totals) = (numbers.as_mut_ptr(), numbers.len(), totals.as_mut_ptr());
    let (late, none) = (1e9, null_mut());
    let list = [0, 1, u16::MAX];
    // SAFETY: the memory is there.
    let found = unsafe {
        [
            capsule_v1_outline_at(model, workspace, late, 0, 0, points, capacity, &mut count, none),
            capsule_v1_outline_at(model, workspace, 1.0, 2, 0, points, capacity, &mut count, none),
            capsule_v1_outline_at(model, workspace, 1.0, 0, 2, points, capacity, &mut count, none),
            capsule_v1_outline_at(model, workspace, 1.0, 0, 0, points, 3, &mut count, none),
            capsule_v1_positions_at(model, workspace, 1.0, 0, null(), 0, points, 5, &mut count, none),
            capsule_v1_positions_at(
                model,
                workspace,
                1.0,
                0,
                list.as_ptr(),
                list.len(),
                points,
                capacity,
                &mut count,
                none,
            ),
            capsule_v1_velocities_at(
                model,
                workspace,
                1.0,
                0,
                list.as_ptr(),
                list.len(),
                points,
                capacity,
                &mut count,
                none,
            ),
            capsule_v1_membrane_at(model, workspace, 1.0, points, 2, totals.cast(), none),
            capsule_v1_observables_at(model, workspace, late, points.cast(), none),
            capsule_v1_volume_at(model, workspace, late, points, none),
        ]
    };
    let expected = [
        Status::Value,
        Status::Choice,
        Status::Choice,
        Status::Short,
        Status::Short,
        Status::UnknownNode,
        Status::UnknownNode,
        Status::Short,
        Status::Value,
        Status::Value,
    ];
    assert_eq!(found, expected);
    // SAFETY: they are there.
    assert_eq!(unsafe { totals.cast::<[f32; 3]>().read() }, [7.0; 3]);
    assert!(numbers == [7.0; 4096] && count == 99);
}

/// Memory that nobody has written yet is good enough to be filled.
#[test]
fn no_more_than_the_answer_is_written() {
    let mut fixture = Fixture::new();
    let mut numbers = [const { MaybeUninit::<f32>::uninit() }; 4096];
    for last in &mut numbers[2048..] {
        last.write(7.0);
    }
    let (points, mut count) = (numbers.as_mut_ptr().cast::<f32>(), 0);
    assert_eq!(fixture.outline(0, points, 4096, &mut count, null_mut()), Status::Ok);
    assert!(count > 0 && count < 2048);
    // SAFETY: the call has written the first ones, and this test the last ones.
    let (answer, rest) = unsafe {
        (
            slice::from_raw_parts(points, count),
            slice::from_raw_parts(points.add(2048), 2048),
        )
    };
    assert!(answer.iter().all(|number| number.is_finite()) && rest == [7.0; 2048]);
}

/// Of the array no more is read than the model has parameters, and none of it where the count is another.
#[test]
fn another_count_of_parameters_is_refused_before_they_are_read() {
    let mut fixture = Fixture::new();
    // One parameter only, in memory that ends there: Miri finds who reads another.
    let one = Box::new(0.1_f32);
    let unwritten = [const { MaybeUninit::<f32>::uninit() }; 2];
    for count in [0, 1, 3, 4, 5, usize::MAX / 4, usize::MAX] {
        for parameters in [&raw const *one, unwritten.as_ptr().cast()] {
            let (mut error, mut domain) = (old_error(), Domain::Inside);
            let asked = Query {
                parameters,
                parameter_count: count,
                ..query(&[])
            };
            let (model, workspace) = (&raw const *fixture.model, &raw mut *fixture.workspace);
            // SAFETY: the call is refused.
            let status = unsafe { capsule_v1_prepare(model, workspace, &asked, &mut domain, &mut error) };
            assert_eq!((status, domain), (Status::ParameterCount, Domain::Unknown), "{count}");
            let found = (count as f64).min(f64::from(u32::MAX));
            assert_eq!((error.found, error.least), (found, 2.0));
        }
    }
}

#[test]
fn the_domain_is_said_of_what_is_refused_too() {
    let mut fixture = Fixture::new();
    let (model, workspace) = (&raw const *fixture.model, &raw mut *fixture.workspace);
    let ask = |query: &Query| {
        let mut domain = Domain::FarFromSamples;
        // SAFETY: the fixture owns the memory.
        let status = unsafe { capsule_v1_prepare(model, workspace, query, &mut domain, null_mut()) };
        (status, domain)
    };
    let (inside, outside) = (parameters(0.1), parameters(0.9));
    let extrapolated = Query {
        extrapolate: 1,
        ..query(&outside)
    };
    let no_step = Query {
        step: -1.0,
        ..query(&inside)
    };
    let no_method = Query {
        method: 3,
        ..query(&inside)
    };
    assert_eq!(ask(&query(&inside)), (Status::Ok, Domain::Inside));
    assert_eq!(ask(&query(&outside)), (Status::OutsideDomain, Domain::Outside));
    assert_eq!(ask(&extrapolated), (Status::Ok, Domain::Outside));
    assert_eq!(ask(&no_step), (Status::Value, Domain::Inside));
    assert_eq!(ask(&no_method), (Status::Choice, Domain::Unknown));
}

#[test]
fn every_refused_query_leaves_nothing_prepared() {
    let mut fixture = Fixture::new();
    let good = parameters(0.1);
    let method = Query {
        method: 3,
        ..query(&good)
    };
    let (nan, outside, few) = (parameters(f32::NAN), parameters(0.9), [0.1]);
    for refused in [method, query(&nan), query(&outside), query(&few)] {
        assert_eq!(fixture.prepare(&query(&good), null_mut()), Status::Ok);
        assert_ne!(fixture.prepare(&refused, null_mut()), Status::Ok);
        let (mut numbers, mut count) = ([0.0; 512], 0);
        let status = fixture.outline(0, numbers.as_mut_ptr(), 512, &mut count, null_mut());
        assert_eq!(status, Status::NotPrepared);
    }
}

#[test]
fn an_extrapolated_answer_has_no_bound_and_an_impossible_shape_is_refused() {
    // Nodes enough for a sphere's volume.
    let mut fixture = Fixture::of(common::Family::new(2));
    let (model, workspace) = (&raw const *fixture.model, &raw mut *fixture.workspace);
    let mut error = no_error();
    let prepare = |values: [f32; 2]| {
        let asked = Query {
            extrapolate: 1,
            ..query(&values)
        };
        let mut domain = Domain::Unknown;
        // SAFETY: the fixture owns the memory.
        let status = unsafe { capsule_v1_prepare(model, workspace, &asked, &mut domain, null_mut()) };
        assert_eq!((status, domain), (Status::Ok, Domain::BeyondSteadyLimit));
    };
    let mut number = 7.0;
    prepare([0.141, 0.76]);
    // SAFETY: as before.
    let status = unsafe { capsule_v1_expected_error_at(model, workspace, 0.0, &mut number, &mut error) };
    assert!(status == Status::Ok && number > 0.0 && number < 1.0, "{number}");
    number = 7.0;
    // SAFETY: as before.
    let status = unsafe { capsule_v1_error_bound_at(model, workspace, 0.0, &mut number, &mut error) };
    assert_eq!((status, number, error.status), (Status::NoBound, 7.0, Status::NoBound));
    // The family's volume is not kept.
    prepare([0.2, 0.9]);
    // SAFETY: as before.
    let status = unsafe { capsule_v1_volume_at(model, workspace, 3.0, &mut number, &mut error) };
    let impossible = Status::ImpossibleShape;
    assert_eq!((status, number, error.status), (impossible, 7.0, impossible));
    assert!(
        error.found < error.least || error.found > error.greatest,
        "{}",
        error.found
    );
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
    let name = |error: &Error| unsafe { slice::from_raw_parts(error.what.cast::<u8>(), error.what_length) };
    assert_eq!(name(&error), b"capillary_number");
    assert_eq!(fixture.prepare(&query(&[f32::NAN, 0.9]), &mut error), Status::Value);
    assert_eq!(name(&error), b"capillary_number");
    assert_eq!(
        fixture.prepare(&query(&[0.15, 1.15]), &mut error),
        Status::BeyondSteadyLimit
    );
    assert_eq!(name(&error), b"capillary_number");
    assert_eq!(fixture.prepare(&query(&[0.1, 0.9]), &mut error), Status::Ok);
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
