//! Calls of the C interface in any order, with any sizes, and with pointers that are null, misaligned, or point into an
//! object of the call. Each call is refused or answers finite numbers. The address sanitizer checks that nothing else
//! is written; a call that fails leaves its outputs unchanged and reports the reason.

use crate::{FILE, Number, input, with_header};
use arbitrary::Arbitrary;
use capsule_capi::*;
use std::ptr::{null, null_mut};
use std::sync::LazyLock;

/// The target of a pointer. The callers of the interface promise that the memory exists and that no object outside the
/// call overlaps it, so these cases are left out.
#[derive(Arbitrary, Clone, Copy, Debug)]
enum Place {
    /// Memory of its own.
    Right,
    Null,
    /// Memory of its own, some bytes after its start.
    Odd(u8),
    /// Into the workspace of the call.
    Inside(u16),
}

/// Memory that a pointer of a call points to.
struct Memory {
    words: Vec<u64>,
    place: Place,
}

impl Memory {
    /// The size that the call needs, rounded up to a word, so that the sanitizer sees writes beyond it.
    fn new(place: Place, bytes: usize) -> Self {
        let before = match place {
            Place::Odd(before) => before.into(),
            _ => 0,
        };
        Self {
            words: vec![0; (before + bytes).div_ceil(8)],
            place,
        }
    }

    fn pointer<T>(&mut self, workspace: *mut Workspace) -> *mut T {
        let start = self.words.as_mut_ptr().cast::<T>();
        match self.place {
            Place::Right => start,
            Place::Null => null_mut(),
            Place::Odd(before) => start.wrapping_byte_add(before.into()),
            Place::Inside(bytes) => workspace
                .cast::<T>()
                .wrapping_byte_add(usize::from(bytes) % WORKSPACE_SIZE),
        }
    }

    /// The written bytes, if the pointer has memory of its own and points to its start.
    fn numbers<'a>(&'a self, count: usize) -> impl Iterator<Item = f32> + 'a {
        let halves = self.words.iter().flat_map(|word| [*word as u32, (*word >> 32) as u32]);
        let own = matches!(self.place, Place::Right);
        halves.map(f32::from_bits).take(if own { count } else { 0 })
    }
}

#[derive(Arbitrary, Clone, Copy, Debug)]
enum Function {
    Open {
        file: u8,
        length: Option<u16>,
        size: u16,
    },
    Describe,
    DescribeParameter(usize),
    Initialise {
        size: u16,
    },
    Prepare {
        parameters: [Number; 2],
        count: u8,
        method: u8,
        extrapolate: bool,
        step: Number,
        null: bool,
    },
    Advance {
        pieces: u16,
    },
    Observables,
    ExpectedError,
    Centroid,
    Volume,
    Outline {
        outline: u8,
        frame: u8,
    },
    Positions {
        frame: u8,
        nodes: [u16; 4],
        listed: u8,
    },
    Velocities {
        frame: u8,
        nodes: [u16; 4],
        listed: u8,
    },
    Membrane,
    StatusText(u32),
}

#[derive(Arbitrary, Debug)]
struct Call {
    function: Function,
    t: Number,
    no_model: bool,
    no_workspace: bool,
    out: Place,
    count: Place,
    error: Place,
    most: u16,
}

/// A model, a truncated one under a valid header, and an empty file.
static FILES: LazyLock<[Vec<u8>; 3]> =
    LazyLock::new(|| [FILE.clone(), with_header(&FILE[16..FILE.len() - 1]), vec![7; 40]]);

struct Objects {
    model: Box<Model>,
    workspace: Box<Workspace>,
}

impl Objects {
    /// Makes the call; returns how many finite numbers the answer must start with.
    fn make(&mut self, call: &Call, out: &mut Memory, count: &mut Memory, error: &mut Memory) -> (Status, usize) {
        let space = &raw mut *self.workspace;
        let model = if call.no_model {
            null_mut()
        } else {
            &raw mut *self.model
        };
        let workspace = if call.no_workspace { null_mut() } else { space };
        let (count_at, error) = (count.pointer::<usize>(space), error.pointer::<Error>(space));
        let numbers = out.pointer::<f32>(space);
        let (t, capacity) = (call.t.of([0.0, 4.0]), call.capacity());
        let list = |nodes: &[u16; 4], listed: u8| match listed {
            0..=4 => (nodes.as_ptr(), usize::from(listed)),
            _ => (null(), usize::from(listed)),
        };
        // SAFETY: every pointer is null, or there is memory of its size behind it; nobody else uses it.
        let status = unsafe {
            match call.function {
                Function::Open { file, length, size } => {
                    let file = &FILES[usize::from(file) % FILES.len()];
                    let length = length.map_or(file.len(), |length| file.len().min(length.into()));
                    let size = if size < 8 { usize::from(size) } else { MODEL_SIZE };
                    capsule_v1_open(model, size, file.as_ptr().cast(), length, error)
                }
                Function::Describe => capsule_v1_describe(model, numbers.cast(), error),
                Function::DescribeParameter(index) => {
                    capsule_v1_describe_parameter(model, index, numbers.cast(), error)
                }
                Function::Initialise { size } => {
                    let size = if size < 8 { usize::from(size) } else { WORKSPACE_SIZE };
                    capsule_v1_initialise(workspace, size, error)
                }
                Function::Prepare {
                    parameters,
                    count,
                    method,
                    extrapolate,
                    step,
                    null: none,
                } => {
                    let [ca, confinement] = parameters;
                    let values = [ca.of([0.005, 0.2]), confinement.of([0.75, 1.2]), 1.0];
                    let step = step.of([0.1, 4.0]);
                    let query = Query {
                        parameters: if none { null() } else { values.as_ptr() },
                        parameter_count: if count < 4 { count.into() } else { 2 },
                        method: (method % 4).into(),
                        extrapolate: extrapolate.into(),
                        // Few steps: executions stay short.
                        step: if 0.0 < step && step < 0.1 { 0.1 } else { step },
                    };
                    let query = if none && extrapolate { null() } else { &raw const query };
                    capsule_v1_prepare(model, workspace, query, numbers.cast(), error)
                }
                Function::Advance { pieces } => {
                    capsule_v1_advance(model, workspace, t, pieces.into(), numbers.cast(), error)
                }
                Function::Observables => capsule_v1_observables_at(model, workspace, t, numbers.cast(), error),
                Function::ExpectedError => capsule_v1_expected_error_at(model, workspace, t, numbers, error),
                Function::Centroid => capsule_v1_centroid_at(model, workspace, t, numbers, error),
                Function::Volume => capsule_v1_volume_at(model, workspace, t, numbers, error),
                Function::Outline { outline, frame } => capsule_v1_outline_at(
                    model,
                    workspace,
                    t,
                    (outline % 3).into(),
                    (frame % 3).into(),
                    numbers,
                    capacity,
                    count_at,
                    error,
                ),
                Function::Positions { frame, nodes, listed } => {
                    let (nodes, listed) = list(&nodes, listed);
                    let frame = (frame % 3).into();
                    capsule_v1_positions_at(
                        model, workspace, t, frame, nodes, listed, numbers, capacity, count_at, error,
                    )
                }
                Function::Velocities { frame, nodes, listed } => {
                    let (nodes, listed) = list(&nodes, listed);
                    let frame = (frame % 3).into();
                    capsule_v1_velocities_at(
                        model, workspace, t, frame, nodes, listed, numbers, capacity, count_at, error,
                    )
                }
                Function::Membrane => {
                    capsule_v1_membrane_at(model, workspace, t, numbers, capacity, count_at.cast(), error)
                }
                Function::StatusText(number) => {
                    assert!(!capsule_v1_status_text(number).is_null());
                    Status::Ok
                }
            }
        };
        let answers = match call.function {
            Function::Observables => 6,
            Function::Volume => 1,
            Function::Outline { .. } | Function::Positions { .. } | Function::Velocities { .. } => capacity,
            _ => 0,
        };
        (status, if status == Status::Ok { answers } else { 0 })
    }
}

impl Call {
    /// Whether the function takes a workspace, and gets one.
    fn knows_the_workspace(&self) -> bool {
        let takes_none = matches!(
            self.function,
            Function::Open { .. } | Function::Describe | Function::DescribeParameter(_) | Function::StatusText(_)
        );
        !(takes_none || self.no_workspace)
    }

    /// More than the small model needs, and little enough that clearing it takes no time.
    fn capacity(&self) -> usize {
        usize::from(self.most) % 512
    }

    /// Whether a call that fails leaves its outputs unchanged.
    fn leaves_its_outputs(&self) -> bool {
        // These write the domain and the scratch of the membrane.
        !matches!(self.function, Function::Prepare { .. } | Function::Membrane)
    }

    /// Whether the call may be made: pointers into the workspace need a workspace.
    fn is_fair(&self) -> bool {
        let inside = [self.out, self.count, self.error]
            .iter()
            .any(|place| matches!(place, Place::Inside(_)));
        !inside || self.knows_the_workspace()
    }
}

/// Makes the calls that the bytes encode, sixteen at most.
pub fn calls(bytes: &[u8]) {
    let Some(calls) = input::<Vec<Call>>(bytes) else {
        return;
    };
    let mut objects = Objects {
        model: Box::new(Model {
            opaque: [0; MODEL_WORDS],
        }),
        workspace: Box::new(Workspace {
            opaque: [0; WORKSPACE_WORDS],
        }),
    };
    for call in calls.iter().filter(|call| call.is_fair()).take(16) {
        let before = objects.workspace.opaque;
        // The largest value behind a pointer of the interface.
        let largest = size_of::<Description>();
        let mut out = Memory::new(call.out, largest.max(4 * call.capacity()));
        let mut count = Memory::new(call.count, largest);
        let mut error = Memory::new(call.error, size_of::<Error>());
        let (status, answers) = objects.make(call, &mut out, &mut count, &mut error);
        let untouched = |memory: &Memory| memory.words.iter().all(|word| *word == 0);
        let refused = matches!(status, Status::Null | Status::Misaligned | Status::Overlap);
        if refused {
            assert!(objects.workspace.opaque == before, "{call:?} was refused");
        }
        if refused || status != Status::Ok && call.leaves_its_outputs() {
            assert!(untouched(&out) && untouched(&count), "{call:?} failed");
        }
        if matches!(call.error, Place::Right) && !matches!(call.function, Function::StatusText(_)) {
            assert_eq!(error.words[0] as u32, status as u32, "{call:?}");
        } else if !matches!(call.error, Place::Odd(_)) {
            assert!(untouched(&error), "{call:?}");
        }
        assert!(out.numbers(answers).all(f32::is_finite), "{call:?}");
    }
}
