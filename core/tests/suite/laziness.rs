//! A quantity that is not requested is not computed: counted by the stored numbers that are read and the operations,
//! with a number that counts.

use crate::common::{FUNCTIONS, Family, SHAPE_MODES};
use capsule_core::mechanics::{Deformation, Stencil};
use capsule_core::{Evaluator, Frame, MIDPLANE, Method, Model, Nodes, Query, Real, Scene, Workspace, section};
use capsule_opcount::{Counted, count};

/// Constants in the code count as reads too: so many a call has at most.
const CONSTANTS: usize = 3;

/// Stored numbers that a piece of work reads, and constants.
fn reads<R>(work: impl FnOnce() -> R) -> usize {
    count(work).1.reads
}

/// Floating-point operations of a piece of work.
fn operations<R>(work: impl FnOnce() -> R) -> usize {
    count(work).1.operations()
}

/// Reads of one node: its row of every mode, and its reference position.
const NODE: usize = 3 * SHAPE_MODES + 3;
/// Reads of a component of eight nodes that share a panel, without their reference positions.
const PANEL: usize = 8 * SHAPE_MODES;
/// Reads of one control of the splines: a panel, and the translation's row.
const CONTROL: usize = (8 + 1) * FUNCTIONS;

/// Reads of a span's parameter modes: a row of each sample that takes part.
const SPAN: usize = 24 * FUNCTIONS;

/// Panels that nodes fill.
fn panels(nodes: &[u16]) -> usize {
    nodes.len().div_ceil(8)
}

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
    // Four controls, of two spans of time, and the search for the interval.
    let interval = 4 * CONTROL + 2 * SPAN;
    assert!((NODE + interval..NODE + interval + 40).contains(&first), "{first}");
    let again = reads(|| instant.positions(&scene(Nodes::List(&list)), &mut buffer).unwrap());
    let only = |found: usize, expected: usize| assert!((expected..=expected + CONSTANTS).contains(&found), "{found}");
    // The second look at an instant.
    only(again, NODE);

    let outline = family.sphere.midplane.len();
    let only = |found: usize, panels: usize| {
        let with_reference = panels * (PANEL + 8) + CONSTANTS;
        assert!((panels * PANEL..=with_reference).contains(&found), "{found} {panels}");
    };
    only(
        reads(|| instant.positions(&scene(Nodes::Set(MIDPLANE)), &mut buffer).unwrap()),
        3 * outline.div_ceil(8),
    );
    let sector = family.sphere.sector_nodes.len();
    only(
        reads(|| instant.positions(&scene(Nodes::All), &mut buffer).unwrap()),
        3 * sector.div_ceil(8),
    );

    // Observables: the two outlines; nothing more of the velocity than was read for the displacement.
    // In its plane, a node has two components.
    // The poles belong to both outlines, and lie in the first one's panels.
    let outlines = 2 * (panels(&family.sphere.midplane) + panels(&family.sphere.diagonal));
    let observables = reads(|| instant.observables().unwrap());
    let most = (outlines + 6) * (PANEL + 8) + 80;
    assert!((outlines * PANEL..most).contains(&observables), "{observables}");
    // Every node of the sector once, and the quadrature's constants for every element.
    let volume = reads(|| instant.volume().unwrap());
    let most = 3 * sector.div_ceil(8) * (PANEL + 8) + family.sphere.elements.len() / 4 * 200;
    assert!(volume < most, "{volume} {most}");

    // The membrane: the sector's nodes, and from then on nothing but what a deformation needs, which is not stored.
    let stencil = Stencil::at(&model.mesh(), 5).unwrap();
    let mut positions = vec![[Counted::ZERO; 3]; sector];
    let mut membrane = None;
    only(
        reads(|| membrane = Some(instant.membrane(&mut positions).unwrap())),
        3 * sector.div_ceil(8),
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

#[test]
fn a_scene_computes_for_itself_alone() {
    let family = Family::new(4);
    let file = family.file();
    let model = Model::open(&file).unwrap();
    let mut workspace = Workspace::<Counted>::new();
    let mut evaluator = Evaluator::new(&model, &mut workspace).unwrap();
    let query = Query::new([Counted(0.05), Counted(0.95)], Method::Direct);
    evaluator.prepare(&query).unwrap();
    assert_eq!(
        operations(|| evaluator.prepare(&query).unwrap()),
        0,
        "the same query again"
    );
    let mut nodes = vec![[Counted::ZERO; 3]; family.nodes()];
    let mut points = vec![[Counted::ZERO; 2]; family.nodes()];
    fn scene(nodes: Nodes<'_>) -> Scene<'_> {
        let frame = Frame::Laboratory;
        Scene { nodes, frame }
    }

    // The place alone: four controls of one coefficient, and no node.
    let mut instant = evaluator.at(Counted(1.23)).unwrap();
    // Products and sums of the functions, in a panel.
    let control = 8 * 2 * FUNCTIONS;
    let splines = 150;
    let place = operations(|| instant.centroid());
    assert!(place < 4 * 2 * FUNCTIONS + splines, "{place}");
    // The velocity of the place as well; of all nodes: all coefficients.
    let rate = operations(|| instant.centroid_velocity());
    assert!(rate < splines, "{rate}");
    let mut velocity = |list: &[u16]| operations(|| instant.velocities(&scene(Nodes::List(list)), &mut nodes).unwrap());
    let (first, one) = (velocity(&[5]), velocity(&[5]));
    assert!(
        first < one + 4 * control + 2 * 2 * SPAN + 8 * (SHAPE_MODES + 1) + splines,
        "{first} {one}"
    );

    // Each node for itself.
    let mut position = |list: &[u16]| operations(|| instant.positions(&scene(Nodes::List(list)), &mut nodes).unwrap());
    position(&[5]);
    let (one, three) = (position(&[5]), position(&[5, 9, 2]));
    assert!(one < 3 * (2 * SHAPE_MODES + 20), "{one}");
    // But for the scale of the translation, which all nodes share.
    assert!(three <= 3 * one && 3 * one <= three + 2 * 4, "{one} {three}");
    let outline = operations(|| instant.outline(MIDPLANE, Frame::Laboratory, &mut points).unwrap());
    let panel = 8 * (2 * SHAPE_MODES + 20);
    assert!(outline <= 2 * panels(&family.sphere.midplane) * panel, "{outline}");
    let surface = operations(|| instant.positions(&scene(Nodes::All), &mut nodes).unwrap());
    assert!(
        surface <= 3 * panels(&family.sphere.sector_nodes) * panel + family.nodes() * 3,
        "{surface}"
    );

    // A section: where the plane cuts, and no other element.
    let mut segments = vec![[[Counted::ZERO; 2]; 2]; 4 * family.sphere.elements.len()];
    let x = nodes[0][0] - Counted(0.3);
    let mut count = 0;
    let cut = operations(|| count = section(&model.mesh(), &nodes, x, &mut segments).unwrap());
    assert!(0 < count && cut <= count * 2 * 10, "{cut} for {count}");

    // Mechanics: node by node, and only what is asked for.
    let mut sector = vec![[Counted::ZERO; 3]; family.sphere.sector_nodes.len()];
    let membrane = instant.membrane(&mut sector).unwrap();
    let stencils = [5, 9].map(|node| Stencil::at(&model.mesh(), node).unwrap());
    let mut deformations = [Deformation::ZERO; 2];
    for (stencil, deformation) in stencils.iter().zip(&mut deformations) {
        let found = operations(|| *deformation = membrane.deformation(stencil).unwrap());
        assert!(found < 1_000, "{found}");
    }
    let [deformation, _] = deformations;
    let (stretches, tensions) = (
        operations(|| deformation.stretches()),
        operations(|| deformation.tensions()),
    );
    assert!(stretches < 200 && tensions < stretches + 20, "{stretches} {tensions}");

    // The next frame: the same controls, and the nodes.
    let mut instant = evaluator.at(Counted(1.24)).unwrap();
    let next = operations(|| instant.positions(&scene(Nodes::All), &mut nodes).unwrap());
    assert!(next < surface + 8 * (SHAPE_MODES + 1) + splines, "{next}");
    // The expected error needs no coefficient.
    let mut instant = evaluator.at(Counted(2.9)).unwrap();
    let error = operations(|| instant.expected_error());
    assert!(error < 40 * 32, "{error}");
    assert!(
        operations(|| instant.centroid()) > 0,
        "nothing of it was computed for the error"
    );
}
