//! The model file: what is written is read, in place; what is wrong is refused by name.

use crate::common::{Arena, Family, write};
use crate::header::with_header;
use capsule_core::model::wire::{Blob, Contents, Encoding, Matrix, Reference, Widths};
use capsule_core::model::{MatrixView, encode};
use capsule_core::{EncodeError, Evaluator, Method, Model, OpenError, Query, Workspace};
use proptest::prelude::*;

const HEADER: usize = 16;

#[test]
fn what_was_written_is_read_in_place() {
    let family = Family::new(2);
    let mut arena = Arena::default();
    let mut contents = family.contents(&mut arena);
    contents.steady_limit = changed(&contents.steady_limit, 3, 0.13);
    contents.steady_limit = changed(&contents.steady_limit, 5, 0.05);
    let file = write(&contents);
    let model = Model::open(&file).unwrap();
    assert_eq!(model.digest(), u32::from_le_bytes(file[12..16].try_into().unwrap()));
    assert_eq!(model.end_time(), 4.0);
    for (confinement, limit) in [(0.5_f64, 0.14), (0.825, 0.135), (1.05, 0.09), (2.0, 0.05)] {
        assert!((model.steady_limit(confinement).unwrap() - limit).abs() < 1e-7);
    }

    let read = model.contents();
    assert_eq!(read.metadata, contents.metadata);
    assert_eq!((read.kernel, read.paper), (contents.kernel, contents.paper));
    let mut blobs = 0;
    let mut same = |a: &Blob<'_>, b: &Blob<'_>| {
        assert_eq!(a.data, b.data);
        assert_eq!(
            (a.data.as_ptr() as usize - file.as_ptr() as usize) % 16,
            0,
            "aligned in the file"
        );
        blobs += 1;
    };
    same(&read.mesh.elements, &contents.mesh.elements);
    same(&read.mesh.operations, &contents.mesh.operations);
    same(&read.times.blob, &contents.times.blob);
    for (a, b) in read.clusters.iter().zip(&contents.clusters) {
        same(&a.samples.parameters.blob, &b.samples.parameters.blob);
        same(&a.samples.places.blob, &b.samples.places.blob);
        same(&a.field.spans[1].core.blob, &b.field.spans[1].core.blob);
        same(&a.paper_errors.deviation.blob, &b.paper_errors.deviation.blob);
    }
    assert_eq!(blobs, 11);
    let mesh = model.mesh();
    for (node, exact) in family.sphere.nodes.iter().enumerate() {
        let found = mesh.reference(node).unwrap();
        assert!((0..3).all(|axis| (f64::from(found[axis]) - exact[axis]).abs() < 1e-7));
    }
    assert!(mesh.elements().eq(family.sphere.elements.iter().copied()));
}

#[test]
fn a_model_describes_itself_as_it_was_written() {
    let family = Family::new(2);
    let mut arena = Arena::default();
    let mut contents = family.contents(&mut arena);
    contents.metadata.title = "a title";
    contents.metadata.membrane_law = "a law";
    contents.metadata.bending_stiffness = Some(3e-4);
    contents.metadata.database_digest = "12ab";
    contents.metadata.offline_settings = "{\"a\": 1}";
    contents.metadata.created_unix_s = 4_000_000_000;
    contents.default_method = Method::Paper;
    contents.bending_effect = changed(&contents.bending_effect, 2, 0.25);
    let file = write(&contents);
    let model = Model::open(&file).unwrap();
    assert_eq!(model.file(), file);
    let texts = [
        model.title(),
        model.membrane_law(),
        model.database_digest(),
        model.offline_settings(),
    ];
    assert_eq!(texts, ["a title", "a law", "12ab", "{\"a\": 1}"]);
    assert_eq!(
        (model.bending_stiffness(), model.created_unix_s()),
        (Some(3e-4), 4_000_000_000)
    );
    assert_eq!(model.default_method(), Method::Paper);
    let units = model.units();
    assert_eq!([units.length, units.velocity, units.time], ["l", "V", "l/V"]);
    let names = model.parameters().iter().map(|parameter| parameter.name);
    assert!(names.eq(["capillary_number", "confinement"]));
    assert_eq!(model.reference(), Reference::Sphere);
    assert_eq!(
        (model.bending_effect().rows(), model.bending_effect().get(0, 2)),
        (1, 0.25)
    );
    assert_eq!(
        (model.times().rows(), model.error_times().rows()),
        (family.times.len(), 2)
    );
    assert_eq!(
        (
            model.steady_limit_curve().points::<f64>().count(),
            model.jump_curve().points::<f64>().count()
        ),
        (3, 0)
    );
    let outline = model.node_set("midplane").unwrap();
    assert!(
        outline
            .iter()
            .eq(family.sphere.midplane.iter().map(|&node| usize::from(node)))
    );
    assert!(model.node_set("nothing").is_none());
    let samples: usize = model.clusters().map(|cluster| cluster.parameters().rows()).sum();
    let written = contents
        .clusters
        .iter()
        .map(|cluster| cluster.samples.parameters.rows as usize);
    assert_eq!(samples, written.sum());
    assert_eq!(
        model.errors_against().to_string(),
        "the full-order model (a law, B = 3e-4 G_s a^2)"
    );

    contents.metadata.bending_stiffness = None;
    let file = write(&contents);
    let model = Model::open(&file).unwrap();
    assert_eq!(model.bending_stiffness(), None);
    assert_eq!(model.errors_against().to_string(), "the full-order model (a law)");
}

#[test]
fn alignment_does_not_change_a_bit() {
    let file = Family::new(2).file();
    let answer = |bytes: &[u8]| {
        let model = Model::open(bytes).unwrap();
        let mut workspace = Workspace::<f32>::new();
        let mut evaluator = Evaluator::new(&model, &mut workspace).unwrap();
        evaluator.prepare(&Query::new([0.033, 0.87], Method::Paper)).unwrap();
        evaluator.at(0.77).unwrap().observables().unwrap()
    };
    let expected = answer(&file);
    for shift in 1..4 {
        let mut shifted = vec![0; shift];
        shifted.extend_from_slice(&file);
        assert_eq!(answer(&shifted[shift..]), expected);
    }
}

#[test]
fn a_short_buffer_is_refused() {
    let family = Family::new(2);
    let mut arena = Arena::default();
    let contents = family.contents(&mut arena);
    let length = write(&contents).len();
    for found in [0, 15, 16, 1000, length - 1] {
        let mut buffer = vec![0; found];
        assert_eq!(
            encode(&contents, &mut buffer),
            Err(EncodeError::BufferTooShort { found })
        );
    }
    assert_eq!(encode(&contents, &mut vec![0; length]), Ok(length));
}

#[test]
fn a_damaged_header_is_refused() {
    let file = Family::new(2).file();
    let open = |change: &dyn Fn(&mut Vec<u8>)| {
        let mut bytes = file.clone();
        change(&mut bytes);
        Model::open(&bytes).unwrap_err()
    };
    let length = file.len();
    assert_eq!(
        open(&|file| file.truncate(7)),
        OpenError::Truncated {
            expected: HEADER,
            found: 7
        }
    );
    assert_eq!(
        open(&|file| file.truncate(900)),
        OpenError::Truncated {
            expected: length,
            found: 900
        }
    );
    assert_eq!(open(&|file| file[1] = b'X'), OpenError::Magic { found: *b"CXOM" });
    let newer = open(&|file| file[4] = 11);
    assert_eq!(
        newer,
        OpenError::Version {
            found: 11,
            supported: 10
        }
    );
    assert!(newer.to_string().contains("update the reader"), "{newer}");
    assert_eq!(
        open(&|file| file[4] = 0),
        OpenError::Version {
            found: 0,
            supported: 10
        }
    );
    assert_eq!(open(&|file| file.extend([0; 3])), OpenError::TrailingBytes { found: 3 });
    assert!(matches!(open(&|file| file[500] ^= 4), OpenError::Checksum { .. }));
    assert!(matches!(open(&|file| file[13] ^= 1), OpenError::Checksum { .. }));
}

#[test]
fn a_message_that_is_not_one_is_refused() {
    assert_eq!(
        Model::open(&with_header(&[1, 2, 3])).unwrap_err(),
        OpenError::Undecodable
    );
    let file = Family::new(2).file();
    let mut payload = file[HEADER..].to_vec();
    payload.push(0);
    assert_eq!(
        Model::open(&with_header(&payload)).unwrap_err(),
        OpenError::TrailingBytes { found: 1 }
    );
}

/// The reference of other people's models.
const SHAPE: Reference = Reference::Shape {
    radius: 0.9,
    origin: 0.0,
    volumes: [1.0, 1.0],
};

/// The error that a change of the contents leads to.
fn refused(change: impl FnOnce(&mut Contents<'_>)) -> OpenError {
    let family = Family::new(2);
    let mut arena = Arena::default();
    let mut contents = family.contents(&mut arena);
    change(&mut contents);
    let error = Model::open(&write(&contents)).unwrap_err();
    assert!(!error.to_string().is_empty());
    error
}

/// A copy of a matrix with one entry changed.
fn changed<'a>(matrix: &Matrix<'a>, index: usize, value: f32) -> Matrix<'a> {
    let mut bytes = matrix.blob.data.to_vec();
    bytes[4 * index..][..4].copy_from_slice(&value.to_le_bytes());
    Matrix {
        blob: Blob::new(bytes.leak()),
        ..*matrix
    }
}

#[test]
fn wrong_dimensions_are_refused() {
    let dimension = |what| {
        move |error| {
            assert!(
                matches!(error, OpenError::Dimension { what: w, .. } if w == what),
                "{error}"
            )
        }
    };
    let rows = |what| move |error| assert!(matches!(error, OpenError::Rows { what: w, .. } if w == what), "{error}");
    let columns = |what| {
        move |error| {
            assert!(
                matches!(error, OpenError::Columns { what: w, .. } if w == what),
                "{error}"
            )
        }
    };
    dimension("clusters")(refused(|c| c.clusters.clear()));
    rows("modes")(refused(|c| c.clusters[0].field.modes.rows += 1));
    rows("parameter modes")(refused(|c| c.clusters[1].field.spans[1].parameter_modes.rows += 1));
    columns("core")(refused(|c| c.clusters[1].field.spans[0].core.columns += 1));
    columns("knots")(refused(|c| c.clusters[0].field.knots.columns = 2));
    dimension("knots")(refused(|c| c.clusters[0].field.knots = Matrix::f32(7, 1, &[0; 28])));
    rows("axial controls")(refused(|c| c.clusters[0].field.axial_controls.rows -= 1));
    rows("axial modes")(refused(|c| c.clusters[0].field.axial_modes.rows = 2));
    columns("axial modes")(refused(|c| c.clusters[0].field.axial_modes.columns = 2));
    rows("leave-one-out errors")(refused(|c| c.clusters[0].direct_errors.left_out.rows = 2));
    columns("leave-one-out errors")(refused(|c| c.clusters[0].direct_errors.left_out.columns = 1));
    columns("errors between instants")(refused(|c| c.clusters[0].interval_errors.columns -= 1));
    rows("errors between instants")(refused(|c| c.clusters[1].interval_errors.rows -= 1));
    columns("effect of bending")(refused(|c| c.bending_effect.columns = 2));
    rows("deviations")(refused(|c| c.clusters[0].paper_errors.deviation.rows = 2));
    columns("steady limit")(refused(|c| c.steady_limit.columns = 3));
    dimension("nodes")(refused(|c| c.mesh.nodes = 1 << 17));
    dimension("images that are nodes")(refused(|c| c.mesh.nodes += 1));
    dimension("operations")(refused(|c| c.mesh.operations.data = &[]));
    let length = |error| assert!(matches!(error, OpenError::Length { .. }), "{error}");
    length(refused(|c| c.mesh.origins.data = &c.mesh.origins.data[2..]));
    length(refused(|c| c.mesh.operations.data = &c.mesh.operations.data[..7]));
    length(refused(|c| c.mesh.elements.data = &c.mesh.elements.data[2..]));
    length(refused(|c| c.mesh.images.data = &c.mesh.images.data[2..]));
    length(refused(|c| c.times.rows = u32::MAX));
    length(refused(|c| c.clusters[0].field.modes.blob.data = &[0; 4]));
    dimension("rows of the core")(refused(|c| c.clusters[0].field.spans[0].slices.data = &[0; 4]));
    dimension("slices")(refused(|c| c.clusters[0].field.spans.truncate(1)));
    let slices = |value| {
        move |c: &mut Contents<'_>| {
            let mut data = c.clusters[1].field.spans[1].slices.data.to_vec();
            data[0] = value;
            c.clusters[1].field.spans[1].slices.data = data.leak();
        }
    };
    let more_than_modes = refused(slices(9));
    assert!(
        matches!(more_than_modes, OpenError::Index { what: "slices", .. }),
        "{more_than_modes}"
    );
    dimension("rows of the core")(refused(slices(0)));
}

#[test]
fn wrong_numbers_are_refused() {
    let number = |what| {
        move |error| {
            assert!(
                matches!(error, OpenError::Number { what: w, .. } if w == what),
                "{error}"
            )
        }
    };
    number("times")(refused(|c| c.times = changed(&c.times, 3, 0.1)));
    number("times")(refused(|c| c.times = changed(&c.times, 0, 0.01)));
    number("error times")(refused(|c| c.error_times = changed(&c.error_times, 1, f32::NAN)));
    number("border")(refused(|c| c.border = Matrix::f32(1, 2, &[255; 8])));
    number("steady limit")(refused(|c| c.steady_limit = changed(&c.steady_limit, 2, 0.7)));
    let error = refused(|c| c.steady_limit = changed(&c.steady_limit, 3, 0.0));
    assert!(matches!(error, OpenError::Setting { value: 0.0, .. }), "{error}");
    number("sector's reference nodes")(refused(|c| {
        c.mesh.sector_reference = changed(&c.mesh.sector_reference, 4, 0.0);
    }));
    for value in [f32::NAN, f32::INFINITY, -1e7] {
        number("modes")(refused(|c| {
            c.clusters[1].field.modes = changed(&c.clusters[1].field.modes, 5, value)
        }));
        number("core")(refused(|c| {
            c.clusters[0].field.spans[0].core = changed(&c.clusters[0].field.spans[0].core, 5, value);
        }));
        number("parameter modes")(refused(|c| {
            c.clusters[0].field.spans[1].parameter_modes =
                changed(&c.clusters[0].field.spans[1].parameter_modes, 5, value);
        }));
        number("axial controls")(refused(|c| {
            c.clusters[0].field.axial_controls = changed(&c.clusters[0].field.axial_controls, 0, value)
        }));
        number("samples")(refused(|c| {
            c.clusters[0].samples.parameters = changed(&c.clusters[0].samples.parameters, 0, value)
        }));
        number("leave-one-out errors")(refused(|c| {
            c.clusters[0].paper_errors.left_out = changed(&c.clusters[0].paper_errors.left_out, 0, value);
        }));
    }
    // Not 0 at the start, not the end time at the end, falling, five times the same.
    for (index, value) in [(3, 0.05), (85, 3.9), (7, 0.05), (8, 0.1)] {
        number("knots")(refused(|c| {
            let mut knots = changed(&c.clusters[1].field.knots, index, value);
            if index == 8 {
                (4..8).for_each(|earlier| knots = changed(&knots, earlier, value));
            }
            c.clusters[1].field.knots = knots;
        }));
    }
    number("deviations")(refused(|c| {
        c.clusters[0].paper_errors.deviation = changed(&c.clusters[0].paper_errors.deviation, 0, 0.0);
    }));
    number("samples")(refused(|c| {
        c.clusters[0].samples.parameters = changed(&c.clusters[0].samples.parameters, 1, 5.0);
    }));
    let duplicate = refused(|c| {
        let samples = MatrixView::new(&c.clusters[0].samples.parameters);
        let first = changed(&c.clusters[0].samples.parameters, 2, samples.get(0, 0));
        c.clusters[0].samples.parameters = changed(&first, 3, samples.get(0, 1));
    });
    assert_eq!(duplicate, OpenError::DuplicateSample { first: 0, second: 1 });
}

#[test]
fn wrong_indices_sets_and_settings_are_refused() {
    let index = |what| {
        move |error| {
            assert!(
                matches!(error, OpenError::Index { what: w, .. } if w == what),
                "{error}"
            )
        }
    };
    let set = |blob: &Blob<'_>, byte: usize, value: u8| {
        let mut bytes = blob.data.to_vec();
        bytes[byte] = value;
        Blob::new(bytes.leak())
    };
    index("elements")(refused(|c| c.mesh.elements = set(&c.mesh.elements, 1, 1)));
    index("origins")(refused(|c| c.mesh.origins = set(&c.mesh.origins, 1, 255)));
    index("images")(refused(|c| c.mesh.images = set(&c.mesh.images, 1, 255)));
    index("operations")(refused(|c| c.mesh.operations = set(&c.mesh.operations, 7, 8)));
    index("operations")(refused(|c| c.mesh.operations = set(&c.mesh.operations, 0, 1)));
    index("node sets")(refused(|c| {
        c.mesh.node_sets[1].nodes = set(&c.mesh.node_sets[1].nodes, 1, 1)
    }));
    let wrong = refused(|c| c.mesh.images = set(&c.mesh.images, 2, c.mesh.images.data[0]));
    assert!(matches!(wrong, OpenError::NoImage { .. }), "{wrong}");
    assert_eq!(
        refused(|c| c.mesh.node_sets[0].nodes.data = &[0; 4]),
        OpenError::ShortOutline { name: "midplane" }
    );
    let dimension = |what| move |error| assert!(matches!(error, OpenError::Dimension { what: w, .. } if w == what));
    dimension("nodes of an element")(refused(|c| c.mesh.element_nodes = 4));
    dimension("parameters")(refused(|c| c.metadata.parameters.truncate(1)));
    let other = |what| {
        dimension(what)(refused(|c| {
            c.mesh.reference = SHAPE;
        }))
    };
    other("points of the steady limit and of the effect of bending outside the channel");
    index("parameter of the clusters")(refused(|c| c.split = 2));
    let setting = |error| assert!(matches!(error, OpenError::Setting { .. }), "{error}");
    setting(refused(|c| c.metadata.parameters[0].min = f64::NAN));
    setting(refused(|c| c.metadata.parameters[1].max = 0.5));
    setting(refused(|c| c.kernel.neighbours = 0));
    setting(refused(|c| c.kernel.scales[0] = f64::INFINITY));
    setting(refused(|c| c.paper.neighbours = 0));
    setting(refused(|c| c.paper.scales[1] = 0.0));
    setting(refused(|c| c.paper.radius = 1.0));
    setting(refused(|c| c.paper.displacement_rank = 0));
    setting(refused(|c| c.paper.velocity_rank = 0));
    setting(refused(|c| c.paper.window = 0.5));
    setting(refused(|c| c.clusters[1].min = 0.95));
    setting(refused(|c| c.clusters[1].max = 0.8));
    setting(refused(|c| c.clusters[0].direct_errors.floor = -1.0));
    setting(refused(|c| c.metadata.bending_stiffness = Some(f64::NAN)));
    // Ca and a/l are not scaled.
    setting(refused(|c| c.metadata.parameters[0].origin = 0.1));
    setting(refused(|c| c.metadata.parameters[1].scale = 2.0));
}

/// Opens bytes and, if they are a model, asks it for everything at one instant.
fn exercise(bytes: &[u8]) {
    let Ok(model) = Model::open(bytes) else { return };
    let mut workspace = Workspace::<f32>::new();
    let Ok(mut evaluator) = Evaluator::new(&model, &mut workspace) else {
        return;
    };
    for method in [Method::Direct, Method::Paper] {
        let query = Query {
            extrapolate: true,
            step: Some(0.5),
            ..Query::new([0.05, 0.9], method)
        };
        if evaluator.prepare(&query).is_err() {
            continue;
        }
        let Ok(mut instant) = evaluator.at(1.23) else { continue };
        if let Ok(found) = instant.observables() {
            let all = [
                found.axial_length,
                found.half_width,
                found.half_diagonal,
                found.rear_depth,
                found.velocity,
            ];
            assert!(all.iter().all(|value| value.is_finite()), "{found:?}");
        }
        if let Ok(volume) = instant.volume() {
            assert!(volume.is_finite());
        }
        for number in [instant.expected_error(), instant.error_bound(), instant.centroid()] {
            assert!(number.map_or(true, f32::is_finite));
        }
    }
}

/// Any reader of postcard finds the same message in a payload, or none where this one finds none.
fn read_as_postcard_reads(payload: &[u8]) {
    let read = with_header(payload);
    let (read, expected) = (Model::open(&read), postcard::take_from_bytes::<Contents<'_>>(payload));
    match (read, expected) {
        (Ok(model), Ok((contents, []))) => assert_eq!(*model.contents(), contents),
        (Err(OpenError::TrailingBytes { found }), Ok((_, rest))) => assert_eq!(found, rest.len()),
        (Err(OpenError::Undecodable), Err(_)) => {}
        (Err(error), Ok((_, []))) if error != OpenError::Undecodable => {}
        (read, expected) => panic!("{:?} but {expected:?}", read.err()),
    }
}

#[test]
fn the_message_is_postcard() {
    let family = Family::new(2);
    let mut arena = Arena::default();
    let mut contents = family.contents(&mut arena);
    contents.metadata.created_unix_s = u32::MAX;
    contents.metadata.title = "a µ-capsule";
    contents.default_method = Method::Paper;
    contents.clusters[0].field.modes.encoding = Encoding::Columns(Widths { wide_columns: 300 });
    contents.clusters[1].field.spans[0].core.encoding = Encoding::RowPanels(Widths { wide_columns: 0 });
    read_as_postcard_reads(&write(&contents)[HEADER..]);
    contents.clusters[0].field.modes.encoding = Encoding::F32;
    contents.clusters[1].field.spans[0].core.encoding = Encoding::F32;
    read_as_postcard_reads(&write(&contents)[HEADER..]);
    contents.steady_limit = Matrix::f32(0, 2, &[]);
    contents.bending_effect = Matrix::f32(0, 3, &[]);
    contents.metadata.bending_stiffness = None;
    contents.mesh.reference = SHAPE;
    read_as_postcard_reads(&write(&contents)[HEADER..]);

    let payload = &Family::small().file()[HEADER..];
    let mut damaged = payload.to_vec();
    for length in (0..payload.len()).step_by(3) {
        read_as_postcard_reads(&payload[..length]);
        for byte in [0, 0x7f, 0x80, 0xff] {
            damaged[length] = byte;
            read_as_postcard_reads(&damaged);
        }
        damaged[length] = payload[length];
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 300, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn random_bytes_never_panic(bytes in proptest::collection::vec(any::<u8>(), 0..300)) {
        exercise(&bytes);
        exercise(&with_header(&bytes));
        read_as_postcard_reads(&bytes);
    }

    #[test]
    fn flipped_bits_are_refused_or_harmless(position in any::<prop::sample::Index>(), bit in 0..8_u8) {
        thread_local!(static FILE: Vec<u8> = Family::new(2).file());
        FILE.with(|file| {
            let mut bytes = file.clone();
            bytes[position.index(file.len())] ^= 1 << bit;
            assert!(Model::open(&bytes).is_err());
            // The same with a checksum that agrees.
            let payload = bytes[HEADER..].to_vec();
            exercise(&with_header(&payload));
            read_as_postcard_reads(&payload);
        });
    }
}

/// As many samples as a cluster may hold, all but a few in one row: each is compared with the one before it alone, or
/// this takes minutes.
#[test]
fn many_samples_of_one_row_are_opened_and_the_last_duplicate_is_found() {
    let row = |count: u32| {
        let ca = move |i: u32| 0.005 + 0.19 * f64::from(i) / f64::from(count);
        let mut family = Family::small();
        family.samples = (0..count)
            .map(|i| [ca(i), 0.8])
            .chain((0..8).map(|i| [ca(i), 1.0]))
            .collect();
        family
    };
    let family = row(60_000);
    let mut arena = Arena::default();
    let mut contents = family.contents(&mut arena);
    assert!(Model::open(&write(&contents)).is_ok());
    let samples = MatrixView::new(&contents.clusters[0].samples.parameters);
    let (first, second) = (59_998, 59_999);
    let value = samples.get(first, 0);
    contents.clusters[0].samples.parameters = changed(&contents.clusters[0].samples.parameters, 2 * second, value);
    assert_eq!(
        Model::open(&write(&contents)).unwrap_err(),
        OpenError::DuplicateSample { first, second }
    );
}
