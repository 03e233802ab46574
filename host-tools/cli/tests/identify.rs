//! `capsule-rom identify` on the outline of a capsule whose parameters are known: at the nodes of its section, with a
//! decimal comma as spreadsheets write it, and drawn into a picture.

use capsule_core::{Evaluator, Frame, MIDPLANE, Method, Model, Nodes, Query, Scene, Workspace, silhouette};
use serde_json::Value;
use std::path::Path;
use std::process::{Command, Output};

const CA: f64 = 0.06;
const CONFINEMENT: f64 = 0.95;
const HALF_WIDTH_UM: f64 = 25.0;
const FLOW: &str = "--half-width-um 25 --velocity-mm-s 5 --viscosity-pa-s 0.8";

fn run(contour: &Path, options: &str) -> Output {
    Command::new(env!("CARGO_BIN_EXE_capsule-rom"))
        .arg("identify")
        .arg(contour)
        .args(options.split_whitespace())
        .output()
        .expect("the command starts")
}

/// The section z = 0 of the steady capsule in l, and the capsule's velocity in V.
fn section() -> (Vec<[f64; 2]>, f64) {
    section_at(f64::INFINITY)
}

/// The same at an instant, or at the model's last one.
fn section_at(t: f64) -> (Vec<[f64; 2]>, f64) {
    let model = Model::open(include_bytes!("../../../models/capsule.crom")).unwrap();
    let mut workspace = Workspace::<f64>::new();
    let mut evaluator = Evaluator::new(&model, &mut workspace).unwrap();
    evaluator
        .prepare(&Query::new([CA, CONFINEMENT], Method::Direct))
        .unwrap();
    let mut instant = evaluator.at(t.min(model.end_time().into())).unwrap();
    let mut half = vec![[0.0; 2]; model.node_set(MIDPLANE).unwrap().len()];
    instant.outline(MIDPLANE, Frame::Centroid, &mut half).unwrap();
    let mirrored: Vec<[f64; 2]> = half[1..half.len() - 1].iter().rev().map(|[x, r]| [*x, -r]).collect();
    half.extend(mirrored);
    (half, instant.centroid_velocity().unwrap())
}

/// Writes the section in um and returns the capsule's velocity in V.
fn write_contour(path: &Path) -> f64 {
    let (points, velocity) = section();
    write_points(path, &points);
    velocity
}

/// Writes points in l as a contour in um.
fn write_points(path: &Path, points: &[[f64; 2]]) {
    let mut text = "x_um;y_um\n".to_owned();
    for [x, y] in points {
        let [x, y] = [x, y].map(|value| format!("{:.4}", HALF_WIDTH_UM * value).replace('.', ","));
        text.push_str(&format!("{x};{y}\n"));
    }
    std::fs::write(path, text).unwrap();
}

/// Size of the picture, pixels per l, and the middle of the first capsule.
const SIZE: [u32; 2] = [420, 220];
const PIXELS: f64 = 80.0;
const MIDDLE: [f64; 2] = [128.3, 110.2];

/// Eight points for one of a closed curve, by Catmull and Rom's cubics: chords between the nodes cut the rims by a
/// tenth of a pixel.
fn smooth(nodes: &[[f64; 2]]) -> Vec<[f64; 2]> {
    let n = nodes.len();
    let point = |i: usize| {
        let (k, t) = (i / 8, (i % 8) as f64 / 8.0);
        [0, 1].map(|d| {
            let [a, b, c, e] = [n - 1, 0, 1, 2].map(|step| nodes[(k + step) % n][d]);
            b + 0.5 * t * (c - a + t * (2.0 * a - 5.0 * b + 4.0 * c - e + t * (3.0 * (b - c) + e - a)))
        })
    };
    (0..8 * n).map(point).collect()
}

/// Draws capsules at distances behind the first, dark between two walls, and writes the picture.
fn write_picture(path: &Path, capsules: &[f64]) {
    let (nodes, _) = section();
    let outline = smooth(&nodes);
    // Places where a row of the capsule crosses its outline.
    let crossings = |y: f64| -> Vec<f64> {
        let crossing = |i: usize| {
            let ([a, b], [c, d]) = (outline[i], outline[(i + 1) % outline.len()]);
            ((b <= y) != (d <= y)).then(|| a + (y - b) / (d - b) * (c - a))
        };
        (0..outline.len()).filter_map(crossing).collect()
    };
    let rows: Vec<(f64, Vec<f64>)> = (0..8 * SIZE[1])
        .map(|i| ((f64::from(i) + 0.5) / 8.0 - MIDDLE[1]) / PIXELS)
        .map(|y| (y, crossings(y)))
        .collect();
    let brightness = |x: f64, (y, crossings): &(f64, Vec<f64>)| {
        if y.abs() > 1.0 {
            return if y.abs() < 1.06 { 60.0 } else { 170.0 };
        }
        let inside = |x: f64| crossings.iter().filter(|crossing| **crossing > x).count() % 2 == 1;
        let covered = capsules.iter().any(|behind| inside(x - behind));
        if covered { 110.0 } else { 200.0 }
    };
    let picture = image::GrayImage::from_fn(SIZE[0], SIZE[1], |column, row| {
        let fine = (0..64).map(|i| {
            let x = (f64::from(column) + (f64::from(i % 8) + 0.5) / 8.0 - MIDDLE[0]) / PIXELS;
            brightness(x, &rows[(8 * row + i / 8) as usize])
        });
        image::Luma([(fine.sum::<f64>() / 64.0).round() as u8])
    });
    image::imageops::blur(&picture, 1.0).save(path).unwrap();
}

#[test]
fn a_known_capsule_lies_in_its_intervals() {
    let directory = tempfile::tempdir().unwrap();
    let contour = directory.path().join("contour.csv");
    let velocity = write_contour(&contour);
    let output = run(&contour, &format!("{FLOW} -o midplane --exposure-ms 0.01 --json"));
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let answer: Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(answer["verdict"], "identified", "{answer}");
    // G_s = mu V / Ca.
    for (name, truth) in [
        ("ca", CA),
        ("confinement", CONFINEMENT),
        ("radius_um", CONFINEMENT * HALF_WIDTH_UM),
        ("gs_n_per_m", 0.8 * 5e-3 / CA),
    ] {
        let ends = [0, 1].map(|end| answer[format!("{name}_95")][end].as_f64().unwrap());
        assert!(ends[0] < truth && truth < ends[1], "{name}: {truth} in {ends:?}");
        let value = answer[name].as_f64().unwrap();
        assert!((value / truth - 1.0).abs() < 0.01, "{name}: {value}, {truth}");
    }
    // The way in the exposure: 0.01 ms at the capsule's velocity, of which 5 mm/s are V.
    let blur = answer["blur_um"].as_f64().unwrap();
    assert!(
        (blur / (0.01 * 5.0 * velocity) - 1.0).abs() < 2e-3,
        "{blur}, {velocity}"
    );
}

#[test]
fn several_frames_tell_the_capsule_and_their_instants() {
    let directory = tempfile::tempdir().unwrap();
    let identify = |instants: [f64; 3], options: &str| {
        let files = instants.map(|t| {
            let file = directory.path().join(format!("{t}.csv"));
            write_points(&file, &section_at(t).0);
            file
        });
        let [first, second, third] = &files;
        let more = format!("--frames {} {}", second.display(), third.display());
        let output = run(
            first,
            &format!("{FLOW} -o midplane --flow right --json {options} {more}"),
        );
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        let answer: Value = serde_json::from_slice(&output.stdout).unwrap();
        assert_eq!(answer["verdict"], "identified");
        for (name, truth) in [("ca", CA), ("confinement", CONFINEMENT)] {
            let [low, high] = [0, 1].map(|end| answer[name]["interval_95"][end].as_f64().unwrap());
            assert!(low < truth && truth < high, "{name}: {truth} in {low} to {high}");
            let value = answer[name]["value"].as_f64().unwrap();
            assert!((value / truth - 1.0).abs() < 0.02, "{name}: {value}, {truth}");
        }
        answer
    };
    let steady = identify([18.0, 19.0, 20.0], "");
    assert_eq!((&steady["drifts"], &steady["instants"]), (&false.into(), &Value::Null));
    let truths = [0.4, 0.9, 2.0];
    let transient = identify(truths, "--transient");
    for (instant, truth) in transient["instants"].as_array().unwrap().iter().zip(truths) {
        let [t, deviation] = ["t", "deviation"].map(|key| instant[key].as_f64().unwrap());
        assert!(
            (t - truth).abs() < 4.0 * deviation.max(0.01),
            "{t} +- {deviation}, {truth}"
        );
    }
}

/// The silhouette along z of the steady capsule, in l.
fn seen() -> Vec<[f64; 2]> {
    let model = Model::open(include_bytes!("../../../models/capsule.crom")).unwrap();
    let mut workspace = Workspace::<f64>::new();
    let mut evaluator = Evaluator::new(&model, &mut workspace).unwrap();
    evaluator
        .prepare(&Query::new([CA, CONFINEMENT], Method::Direct))
        .unwrap();
    let mesh = model.mesh();
    let mut positions = vec![[0.0; 3]; mesh.nodes()];
    let scene = Scene {
        nodes: Nodes::All,
        frame: Frame::Centroid,
    };
    let mut instant = evaluator.at(model.end_time().into()).unwrap();
    instant.positions(&scene, &mut positions).unwrap();
    let mut normals = vec![[0.0; 3]; mesh.sector_nodes().len()];
    let mut half = vec![[0.0; 2]; 201];
    silhouette(&mesh, &positions, [1.0, 0.0], &mut normals, &mut half).unwrap();
    let mirrored: Vec<[f64; 2]> = half[1..200].iter().rev().map(|[x, y]| [*x, -y]).collect();
    half.extend(mirrored);
    half
}

#[test]
fn a_dent_line_narrows_the_intervals_of_a_silhouette() {
    let directory = tempfile::tempdir().unwrap();
    let [contour, line] = ["contour.csv", "line.csv"].map(|name| directory.path().join(name));
    // Errors of some 0.1 um, as of a pixel of that size.
    let jittered = |points: Vec<[f64; 2]>| -> Vec<[f64; 2]> {
        let jitter = |i: usize, d: usize| 0.006 * ((i * i * 7 + 3 * d) as f64).sin();
        let points = points.into_iter().enumerate();
        points.map(|(i, [x, y])| [x + jitter(i, 0), y + jitter(i, 1)]).collect()
    };
    write_points(&contour, &jittered(seen()));
    let (section, _) = section();
    let rear = section.iter().map(|[x, _]| *x).fold(f64::INFINITY, f64::min);
    let behind = section.iter().filter(|[x, y]| *x < rear + 0.5 && y.abs() < 0.5);
    write_points(&line, &jittered(behind.copied().collect()));
    let width = |options: &str| {
        let output = run(&contour, &format!("{FLOW} -o silhouette --flow right --json {options}"));
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        let answer: Value = serde_json::from_slice(&output.stdout).unwrap();
        assert_eq!(answer["verdict"], "identified");
        let [low, high] = [0, 1].map(|end| answer["ca_95"][end].as_f64().unwrap());
        assert!(low < CA && CA < high, "{low} {high}");
        (high - low, answer["dent_line_residual_um"].as_f64())
    };
    let (without, none) = width("");
    let (with, residual) = width(&format!("--dent-line {}", line.display()));
    assert!(with < 0.8 * without && none.is_none(), "{with} {without}");
    assert!((0.05..0.2).contains(&residual.unwrap()), "{residual:?}");
    let section = run(&contour, &format!("{FLOW} -o midplane --dent-line {}", line.display()));
    let message = String::from_utf8_lossy(&section.stderr);
    assert!(!section.status.success() && message.contains("silhouette"), "{message}");
}

#[test]
fn inconsistent_measurements_are_refused() {
    let directory = tempfile::tempdir().unwrap();
    let contour = directory.path().join("contour.csv");
    write_contour(&contour);
    let narrow = FLOW.replace("--half-width-um 25", "--half-width-um 12");
    let headless = directory.path().join("headless.csv");
    let text = std::fs::read_to_string(&contour).unwrap();
    std::fs::write(&headless, text.replace("x_um;y_um\n", "")).unwrap();
    let short = directory.path().join("short.csv");
    std::fs::write(&short, text.lines().take(8).collect::<Vec<_>>().join("\n")).unwrap();
    for (file, options, reason) in [
        (&contour, &*narrow, "the channel"),
        (&headless, FLOW, "unit"),
        (&short, FLOW, "12"),
    ] {
        let output = run(file, &format!("{options} -o midplane"));
        let message = String::from_utf8_lossy(&output.stderr);
        assert!(
            output.status.code() == Some(1) && message.contains(reason) && output.stdout.is_empty(),
            "{reason}: {message}"
        );
    }
}

#[test]
fn a_known_capsule_is_identified_in_a_picture() {
    let directory = tempfile::tempdir().unwrap();
    let in_it = |name: &str| directory.path().join(name);
    let picture = in_it("capsule.png");
    write_picture(&picture, &[0.0]);
    let (contour, overlay) = (in_it("contour.csv"), in_it("overlay.png"));
    let written = format!("--contour-out {} --overlay {}", contour.display(), overlay.display());
    let output = run(
        &picture,
        &format!("{FLOW} -o midplane --json --channel square {written}"),
    );
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    assert!(output.stderr.is_empty());
    let answer: Value = serde_json::from_slice(&output.stdout).unwrap();
    let scale = answer["picture"]["pixel_um"].as_f64().unwrap() / (HALF_WIDTH_UM / PIXELS);
    assert!((scale - 1.0).abs() < 0.005, "{scale}");
    assert_eq!(answer["flow"], "right");
    for (name, truth) in [("ca", CA), ("confinement", CONFINEMENT)] {
        let ends = [0, 1].map(|end| answer[format!("{name}_95")][end].as_f64().unwrap());
        assert!(
            ends[0] < truth && truth < ends[1],
            "{name}: {truth} in {ends:?}, {answer}"
        );
    }
    assert_eq!(image::open(&overlay).unwrap().width() % SIZE[0], 0);
    // The contour that was written is the one that was fitted.
    let pixel_um = answer["picture"]["pixel_um"].as_f64().unwrap();
    let again = run(&contour, &format!("{FLOW} -o midplane --json --pixel-um {pixel_um}"));
    let again: Value = serde_json::from_slice(&again.stdout).unwrap();
    let ratio = again["ca"].as_f64().unwrap() / answer["ca"].as_f64().unwrap();
    assert!((ratio - 1.0).abs() < 1e-3, "{again}");
    // A picture does not tell a square channel from a tube.
    let unsaid = run(&picture, &format!("{FLOW} -o midplane"));
    assert!(String::from_utf8_lossy(&unsaid.stderr).contains("--channel"));
    let round = run(&picture, &format!("{FLOW} -o midplane --channel round"));
    assert!(!round.status.success() && String::from_utf8_lossy(&round.stderr).contains("round"));
}

#[test]
fn one_of_several_capsules_in_a_picture_is_chosen() {
    let directory = tempfile::tempdir().unwrap();
    let picture = directory.path().join("capsules.png");
    write_picture(&picture, &[0.0, 2.3]);
    let output = run(&picture, &format!("{FLOW} -o midplane"));
    let message = String::from_utf8_lossy(&output.stderr);
    assert!(
        !output.status.success() && message.contains("2 whole capsule(s)"),
        "{message}"
    );
    for number in [1, 2] {
        let output = run(&picture, &format!("{FLOW} -o midplane --json --capsule {number}"));
        let answer: Value = serde_json::from_slice(&output.stdout).unwrap();
        let ca = answer["ca"].as_f64().unwrap();
        assert!((ca / CA - 1.0).abs() < 0.1, "{ca}");
    }
    let text = directory.path().join("contour.csv");
    write_contour(&text);
    let output = run(&text, &format!("{FLOW} -o midplane --capsule 1"));
    assert!(String::from_utf8_lossy(&output.stderr).contains("--capsule is for pictures"));
}

#[test]
fn a_batch_answers_skips_and_goes_on() {
    let directory = tempfile::tempdir().unwrap();
    let in_it = |name: &str| directory.path().join(name);
    write_contour(&in_it("contour.csv"));
    let rows = "file,half_width_um,width_um,width_um_deviation\n\
                contour.csv,,,\n\
                missing.csv,,,\n\
                contour.csv,25,,\n\
                contour.csv,12,,\n";
    std::fs::write(in_it("table.csv"), rows).unwrap();
    let batch = |out: &str, options: &str| {
        Command::new(env!("CARGO_BIN_EXE_capsule-rom"))
            .args(["identify", "batch"])
            .arg(in_it("table.csv"))
            .arg("--out")
            .arg(in_it(out))
            .args(format!("{FLOW} -o midplane {options}").split_whitespace())
            .output()
            .unwrap()
    };
    let output = batch("results.csv", "");
    let message = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(1), "{message}");
    assert!(
        message.contains("row 2: ") && message.contains("missing.csv"),
        "{message}"
    );
    assert!(
        message.contains("row 4: ") && message.contains("the channel"),
        "{message}"
    );
    let results = std::fs::read_to_string(in_it("results.csv")).unwrap();
    assert_eq!(results.lines().count(), 3, "{results}");
    assert!(String::from_utf8_lossy(&output.stdout).contains("2 identified"));
    // Interrupted within its last line, it goes on to the same results: what is there is kept.
    let cut = results.len() - 20;
    std::fs::write(in_it("results.csv"), &results[..cut]).unwrap();
    std::fs::write(in_it("table.csv"), rows.replace("missing.csv", "contour.csv")).unwrap();
    let message = String::from_utf8_lossy(&batch("results.csv", "").stderr).into_owned();
    assert!(message.contains("row 4: ") && !message.contains("row 2: "), "{message}");
    let again = std::fs::read_to_string(in_it("results.csv")).unwrap();
    let mut lines: Vec<&str> = again.lines().collect();
    assert_eq!(lines.len(), 4, "{again}");
    lines.remove(2);
    assert_eq!(lines, results.lines().collect::<Vec<_>>());
    // Other options are another batch.
    let other = batch("results.csv", "--scale-error 0.01");
    assert!(String::from_utf8_lossy(&other.stderr).contains("other options"));
    assert_eq!(std::fs::read_to_string(in_it("results.csv")).unwrap(), again);
    // The same answers as JSON lines, and the population.
    let plot = format!("--json --plot {}", in_it("histograms.svg").display());
    let output = batch("results.jsonl", &plot);
    let population: Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(
        (&population["identified"], &population["failed"]),
        (&3.into(), &1.into())
    );
    let lines = std::fs::read_to_string(in_it("results.jsonl")).unwrap();
    let first: Value = serde_json::from_str(lines.lines().next().unwrap()).unwrap();
    let mean = population["ca"]["mean"].as_f64().unwrap();
    assert!((first["ca"].as_f64().unwrap() / mean - 1.0).abs() < 1e-9);
    assert!(population["ca"]["standard_error"].as_f64().unwrap() < 1e-9);
    assert!(
        std::fs::read_to_string(in_it("histograms.svg"))
            .unwrap()
            .contains("G_s")
    );
}
