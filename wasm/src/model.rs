//! An opened model file and its metadata.

use crate::evaluation::Evaluation;
use crate::shared::{CoreModel, File, Shared};
use crate::surface::{Surface, normals};
use capsule_core::model::Reference;
use capsule_core::{DIAGONAL, MIDPLANE, Method};
use capsule_refusal::Refusal;
use std::cell::OnceCell;
use std::rc::Rc;
use wasm_bindgen::prelude::*;

/// Pieces into which each side of a P2 element is divided for drawing.
const DIVISIONS: usize = 4;

/// A model file (.crom), opened and validated.
#[wasm_bindgen]
pub struct Model {
    shared: Rc<Shared>,
}

#[wasm_bindgen]
impl Model {
    /// Opens the bytes of a file.
    ///
    /// # Errors
    /// The core's error text.
    pub fn open(bytes: Vec<u8>) -> Result<Model, Refusal> {
        let file = File::try_new(bytes, |bytes| CoreModel::open(bytes))?;
        let mesh = file.borrow_dependent().mesh();
        let nodes = mesh.nodes();
        let elements: Vec<[u16; 6]> = mesh.elements().collect();
        // Flat triangles are drawn as they are.
        let divisions = if mesh.element_nodes() == 3 { 1 } else { DIVISIONS };
        let surface = Surface::new(&elements, divisions);
        Ok(Self {
            shared: Rc::new(Shared {
                file,
                surface,
                nodes,
                stencils: OnceCell::new(),
            }),
        })
    }

    /// A new evaluation, with a workspace of its own.
    pub fn evaluation(&self) -> Evaluation {
        Evaluation::new(self.shared.clone())
    }

    /// The bytes of the file.
    pub fn file(&self) -> Vec<u8> {
        self.shared.file.borrow_owner().clone()
    }

    /// Title.
    #[wasm_bindgen(getter)]
    pub fn title(&self) -> String {
        self.shared.core().title().to_owned()
    }

    /// Constitutive law of the membrane.
    #[wasm_bindgen(getter, js_name = membraneLaw)]
    pub fn membrane_law(&self) -> String {
        self.shared.core().membrane_law().to_owned()
    }

    /// Bending stiffness B of the full-order model, in G_s a^2; undefined where it is not known.
    #[wasm_bindgen(getter, js_name = bendingStiffness)]
    pub fn bending_stiffness(&self) -> Option<f64> {
        self.shared.core().bending_stiffness()
    }

    /// The solution that errors are taken against, in words.
    #[wasm_bindgen(getter, js_name = errorsAgainst)]
    pub fn errors_against(&self) -> String {
        self.shared.core().errors_against().to_string()
    }

    /// CRC-32 of the payload in hexadecimal: identifies the model.
    #[wasm_bindgen(getter)]
    pub fn digest(&self) -> String {
        format!("{:08x}", self.shared.core().digest())
    }

    /// Digest of the snapshots behind the model.
    #[wasm_bindgen(getter, js_name = databaseDigest)]
    pub fn database_digest(&self) -> String {
        self.shared.core().database_digest().to_owned()
    }

    /// Creation time, seconds since 1970-01-01 UTC.
    #[wasm_bindgen(getter, js_name = createdUnixS)]
    pub fn created_unix_s(&self) -> f64 {
        self.shared.core().created_unix_s().into()
    }

    /// Nodes of the full mesh.
    #[wasm_bindgen(getter, js_name = nodeCount)]
    pub fn node_count(&self) -> usize {
        self.shared.nodes
    }

    /// Nodes of each element: six, or three of flat triangles.
    #[wasm_bindgen(getter, js_name = elementNodes)]
    pub fn element_nodes(&self) -> usize {
        self.shared.core().mesh().element_nodes()
    }

    /// The nodes of one element after another: its corners, then the middles of the edges 12, 23 and 31.
    pub fn elements(&self) -> Vec<u16> {
        let mesh = self.shared.core().mesh();
        let count = mesh.element_nodes();
        mesh.elements()
            .flat_map(|element| element.into_iter().take(count))
            .collect()
    }

    /// The last instant, in l/V.
    #[wasm_bindgen(getter, js_name = endTime)]
    pub fn end_time(&self) -> f64 {
        self.shared.core().end_time().into()
    }

    /// The default method: "direct" or "paper".
    #[wasm_bindgen(getter, js_name = defaultMethod)]
    pub fn default_method(&self) -> String {
        match self.shared.core().default_method() {
            Method::Direct => "direct",
            Method::Paper => "paper",
        }
        .to_owned()
    }

    /// Whether this is a capsule in the channel, over Ca and a/l.
    #[wasm_bindgen(getter, js_name = isChannel)]
    pub fn is_channel(&self) -> bool {
        matches!(self.shared.core().reference(), Reference::Sphere)
    }

    /// The length that the page draws as one: l in the channel, else the capsule's radius, in the unit of length.
    #[wasm_bindgen(getter, js_name = drawnLength)]
    pub fn drawn_length(&self) -> f64 {
        match self.shared.core().reference() {
            Reference::Sphere => 1.0,
            Reference::Shape { radius, .. } => radius,
        }
    }

    /// Whether the mechanics of the membrane is known: stretches, tensions, energy and load.
    #[wasm_bindgen(getter, js_name = hasMechanics)]
    pub fn has_mechanics(&self) -> bool {
        self.shared.core().has_mechanics()
    }

    /// Whether the model has the two section outlines.
    #[wasm_bindgen(getter, js_name = hasOutlines)]
    pub fn has_outlines(&self) -> bool {
        let core = self.shared.core();
        [MIDPLANE, DIAGONAL].iter().all(|name| core.node_set(name).is_some())
    }

    /// The units of length, velocity and time.
    pub fn units(&self) -> Vec<String> {
        let units = &self.shared.core().units();
        [units.length, units.velocity, units.time].map(str::to_owned).to_vec()
    }

    /// The parameters' names, in the order of a query's.
    #[wasm_bindgen(js_name = parameterNames)]
    pub fn parameter_names(&self) -> Vec<String> {
        let parameters = self.shared.core().parameters();
        parameters.iter().map(|parameter| parameter.name.to_owned()).collect()
    }

    /// Ranges in which the model was sampled: least and greatest value of the first parameter, then of the second ...
    pub fn ranges(&self) -> Vec<f64> {
        let parameters = self.shared.core().parameters();
        parameters.iter().flat_map(|range| [range.min, range.max]).collect()
    }

    /// Sampled parameters, one set after another. A sample that clusters share is given once.
    pub fn samples(&self) -> Vec<f64> {
        let mut samples: Vec<Vec<f64>> = Vec::new();
        let core = self.shared.core();
        let ranges = core.parameters();
        for cluster in core.clusters() {
            let rows = cluster.parameters();
            for row in 0..rows.rows() {
                let columns = (0..rows.columns()).zip(ranges);
                let sample = columns
                    .map(|(column, range)| range.value(rows.get(row, column).into()))
                    .collect();
                if !samples.contains(&sample) {
                    samples.push(sample);
                }
            }
        }
        samples.concat()
    }

    /// Border of the region that has a steady state: a/l, largest Ca, a/l, largest Ca, ..., by increasing a/l.
    #[wasm_bindgen(js_name = steadyLimit)]
    pub fn steady_limit(&self) -> Vec<f64> {
        let points = self.shared.core().steady_limit_curve().points();
        points.flat_map(|point: [f64; 2]| point).collect()
    }

    /// Border where the solution jumps: a/l, Ca, a/l, Ca, ..., by rising a/l; empty where there is none.
    #[wasm_bindgen(js_name = jumpBorder)]
    pub fn jump_border(&self) -> Vec<f64> {
        let points = self.shared.core().jump_curve().points();
        points.flat_map(|point: [f64; 2]| point).collect()
    }

    /// The parameters to suggest instead of those outside the domain: each moved into its range, and Ca below the
    /// steady limit where there is one, to a thousandth.
    pub fn nearest(&self, parameters: &[f64]) -> Vec<f64> {
        let core = self.shared.core();
        let ranges = core.parameters();
        let into_range = |(value, range): (&f64, _)| -> f64 {
            let range: &capsule_core::model::Parameter<'_> = range;
            value.max(range.min).min(range.max)
        };
        let mut nearest: Vec<f64> = parameters.iter().zip(ranges).map(into_range).collect();
        if let ([capillary_number, confinement], Some(range)) = (&mut nearest[..], ranges.first())
            && let Some(limit) = core.steady_limit(*confinement)
        {
            // A limit stored in single precision may lie slightly below the original.
            let limit = (limit.min(range.max) * 1e3 + 1e-3).floor() / 1e3;
            *capillary_number = capillary_number.min(limit).max(range.min);
        }
        nearest
    }

    /// Unit normals of a surface whose vertices are x, y, z, ..., in the order of [`Evaluation::surface`].
    pub fn normals(&self, positions: &[f32]) -> Vec<f32> {
        let (positions, _) = positions.as_chunks();
        normals(self.shared.surface.triangles(), positions).into_flattened()
    }

    /// Numbers at the vertices to draw, from those at the nodes.
    #[wasm_bindgen(js_name = atVertices)]
    pub fn at_vertices(&self, nodes: &[f32]) -> Vec<f32> {
        self.shared.surface.numbers(nodes)
    }

    /// Vertices of the triangles to draw, three by three.
    pub fn triangles(&self) -> Vec<u32> {
        self.shared.surface.triangles().as_flattened().to_vec()
    }
}
