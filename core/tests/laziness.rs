//! What is not asked for is not computed: counted by the stored numbers that are read and the
//! products that are formed, with a number that counts.

mod common;

use capsule_core::mechanics::{Deformation, Stencil};
use capsule_core::{Evaluator, Frame, MIDPLANE, Method, Model, Nodes, Query, Real, Scene, Workspace};
use capsule_gauge::{Counted, count};
use common::{FUNCTIONS, Family, SHAPE_MODES};

/// Constants in the code count as reads too: so many a call has at most.
const CONSTANTS: usize = 3;

/// Stored numbers that a piece of work reads, and constants.
fn reads<R>(work: impl FnOnce() -> R) -> usize {
    count(work).1.reads
}

/// Reads of one node: its row of every mode, and its reference position.
const NODE: usize = 3 * SHAPE_MODES + 3;
/// Reads of one control of the splines.
const CONTROL: usize = (SHAPE_MODES + 1) * FUNCTIONS;

#[test]
fn a_scene_pays_for_itself_alone() {
    let family = Family::new(4);
    let file = family.file();
    let model = Model::open(&file).unwrap();
    let mut workspace = Workspace::<Counted>::new();
    let mut evaluator = Evaluator::new(&model, &mut workspace).unwrap();
    let query = Query::new([Counted(0.05), Counted(0.95)], Method::Direct);
    assert!(reads(|| evaluator.prepare(&query).unwrap()) > 0);
    assert_eq!(reads(|| evaluator.prepare(&query).unwrap()), 0, "the same query again");
    assert!(
        reads(|| evaluator.at(Counted(1.23)).unwrap()) <= 4,
        "an instant of which nothing is asked"
    );

    let mut buffer = vec![[Counted::ZERO; 3]; family.nodes()];
    let scene = |nodes| Scene {
        nodes,
        frame: Frame::Laboratory,
    };
    let mut instant = evaluator.at(Counted(1.23)).unwrap();
    let list = [5];
    let first = reads(|| instant.positions(&scene(Nodes::List(&list)), &mut buffer).unwrap());
    // Four controls, and the search for the interval.
    let interval = 4 * CONTROL;
    assert!((NODE + interval..NODE + interval + 40).contains(&first), "{first}");
    let again = reads(|| instant.positions(&scene(Nodes::List(&list)), &mut buffer).unwrap());
    let only = |found: usize, expected: usize| assert!((expected..=expected + CONSTANTS).contains(&found), "{found}");
    // The second look at an instant.
    only(again, NODE);

    let outline = family.sphere.midplane.len();
    only(
        reads(|| instant.positions(&scene(Nodes::Set(MIDPLANE)), &mut buffer).unwrap()),
        outline * NODE,
    );
    let sector = family.sphere.sector_nodes.len();
    only(
        reads(|| instant.positions(&scene(Nodes::All), &mut buffer).unwrap()),
        sector * NODE,
    );

    // Observables: the two outlines; nothing more of the velocity than was read for the displacement.
    // In its plane, a node has two components.
    let outlines = (family.sphere.midplane.len() + family.sphere.diagonal.len()) * NODE * 2 / 3;
    let observables = reads(|| instant.observables().unwrap());
    assert!((outlines..outlines + 80).contains(&observables), "{observables}");
    // A quarter of the elements, each node where it is needed.
    let volume = reads(|| instant.volume().unwrap());
    assert!(volume < family.sphere.elements.len() / 4 * (6 * NODE + 200), "{volume}");

    // The membrane: the sector's nodes, and from then on nothing but what a deformation needs, which is not stored.
    let stencil = Stencil::at(&model.mesh(), 5).unwrap();
    let mut positions = vec![[Counted::ZERO; 3]; sector];
    let mut membrane = None;
    only(
        reads(|| membrane = Some(instant.membrane(&mut positions).unwrap())),
        sector * NODE,
    );
    let membrane = membrane.unwrap();
    let mut deformation = Deformation::ZERO;
    assert!(reads(|| deformation = membrane.deformation(&stencil).unwrap()) <= 1);
    assert!(reads(|| deformation.stretches()) <= 1);
    assert!(reads(|| deformation.load(Counted(0.05))) <= 7);

    // The next frame of the same interval between stored instants.
    let mut instant = evaluator.at(Counted(1.24)).unwrap();
    let next = reads(|| instant.positions(&scene(Nodes::List(&list)), &mut buffer).unwrap());
    assert!(next < NODE + 40, "{next}");
}

#[test]
fn stepping_goes_on_from_where_it_is() {
    let family = Family::new(2);
    let file = family.file();
    let model = Model::open(&file).unwrap();
    let mut workspace = Workspace::<Counted>::new();
    let mut evaluator = Evaluator::new(&model, &mut workspace).unwrap();
    let query = Query::new([Counted(0.05), Counted(0.95)], Method::Paper);
    let step = Some(Counted(0.02));
    evaluator.prepare(&Query { step, ..query }).unwrap();
    let mut centroid = |t| reads(|| evaluator.at(Counted(t)).unwrap().centroid());
    let learning = 2 * family.times.len() * CONTROL;
    let first = centroid(3.0);
    assert!(first > learning, "{first}");
    // One more step reads the few snapshots of its window, not all.
    let next = centroid(3.02);
    assert!(next < learning / 3, "{next} of {learning}");
}
