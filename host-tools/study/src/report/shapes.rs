//! The capsule in space (Fig. 12): flat-shaded triangles, the far ones first.

use std::fmt::Write;

use capsule_core::{Evaluator, Method, Model, Query, Workspace};

use super::accuracy::ALL;
use super::sheet::{Drawing, Section, Sheet};
use crate::StudyError;

const INSTANTS: [f64; 5] = [0.0, 0.4, 3.0, 6.0, 9.0];
/// Directions of the picture's right, up, and towards the eye; the flow goes to the right.
const RIGHT: [f64; 3] = [0.866, -0.5, 0.0];
const UP: [f64; 3] = [-0.171, -0.296, 0.940];
const TO_EYE: [f64; 3] = [-0.470, -0.814, -0.342];
const LIGHT: [f64; 3] = [-0.30, -0.55, 0.78];
/// Pixels of a length l.
const SCALE: f64 = 110.0;
/// Width and height of the picture.
const SIZE: [f64; 2] = [360.0, 300.0];

pub(super) fn section(sheet: &mut Sheet, model: &Model) -> Result<Section, StudyError> {
    let [ca, confinement] = [0.10, 0.90];
    let mut section = Section::new(
        "The capsule in space (Fig. 12)",
        &format!(
            "Predicted shapes at Ca = {ca}, a/l = {confinement}, in the frame of the centroid; behind them the shape \
             at t = 0. The flow goes \
             to the right."
        ),
    );
    let mut workspace = Box::new(Workspace::<f64>::new());
    let mut evaluator = Evaluator::new(model, &mut workspace)?;
    evaluator.prepare(&Query::new([ca, confinement], Method::Direct))?;
    let mut nodes = vec![[0.0; 3]; model.mesh().nodes()];
    let mut rows = Vec::new();
    let mut first = String::new();
    for t in INSTANTS {
        let mut instant = evaluator.at(t)?;
        let centroid = instant.centroid()?;
        instant.positions(&ALL, &mut nodes)?;
        nodes.iter_mut().for_each(|node| node[0] -= centroid);
        rows.extend(nodes.iter().enumerate().map(|(i, [x, y, z])| {
            let numbers = [*x, *y, *z].map(|value| format!("{value:.6}"));
            [vec![t.to_string(), i.to_string()], numbers.to_vec()].concat()
        }));
        let shape = faces(model, &nodes);
        if first.is_empty() {
            first.clone_from(&shape);
        }
        section.figures.push(Drawing {
            caption: format!("Fig. 12: t = {t}, centroid at x = {centroid:.2} l"),
            svg: format!(
                "<svg width=\"{0}\" height=\"{1}\" viewBox=\"0 0 {0} {1}\" xmlns=\"http://www.w3.org/2000/svg\" \
                 stroke-width=\"0.4\"><g opacity=\"0.25\">{first}</g>{shape}</svg>",
                SIZE[0], SIZE[1]
            ),
            data: "fig12_nodes.csv".to_owned(),
        });
    }
    sheet.csv("fig12_nodes.csv", &["t", "node", "x", "y", "z"], rows.into_iter())?;
    Ok(section)
}

fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    (0..3).map(|d| a[d] * b[d]).sum()
}

/// The faces that look to the eye, as paths of an SVG.
fn faces(model: &Model, nodes: &[[f64; 3]]) -> String {
    let mut faces = Vec::new();
    for element in model.mesh().elements() {
        let [a, b, c] = [0, 1, 2].map(|corner| nodes[usize::from(element[corner])]);
        let [u, v]: [[f64; 3]; 2] = [b, c].map(|p| std::array::from_fn(|d| p[d] - a[d]));
        let normal = [
            u[1] * v[2] - u[2] * v[1],
            u[2] * v[0] - u[0] * v[2],
            u[0] * v[1] - u[1] * v[0],
        ];
        if dot(normal, TO_EYE) > 0.0 {
            let light = (dot(normal, LIGHT) / dot(normal, normal).sqrt()).max(0.0);
            let depth = [a, b, c].iter().map(|p| dot(*p, TO_EYE)).sum::<f64>();
            faces.push((depth, light, [a, b, c]));
        }
    }
    faces.sort_by(|a, b| a.0.total_cmp(&b.0));
    let mut paths = String::new();
    for (_, light, corners) in faces {
        let shade = 70.0 + 165.0 * light;
        let [red, green, blue] = [0.55, 0.78, 1.0].map(|share| (share * shade) as u8);
        let colour = format!("#{red:02x}{green:02x}{blue:02x}");
        let points = corners.map(|p| {
            let [x, y] = [
                0.5 * SIZE[0] + SCALE * dot(p, RIGHT),
                0.5 * SIZE[1] - SCALE * dot(p, UP),
            ];
            format!("{x:.1},{y:.1}")
        });
        let _ = write!(
            paths,
            "<path d=\"M{}Z\" fill=\"{colour}\" stroke=\"{colour}\"/>",
            points.join("L")
        );
    }
    paths
}
