//! An opened model file and what it says of itself.

use crate::evaluation::Evaluation;
use crate::surface::Surface;
use capsule_core::model::wire::{Encoding, Matrix};
use self_cell::self_cell;
use std::rc::Rc;
use wasm_bindgen::prelude::*;

type CoreModel<'a> = capsule_core::Model<'a>;

self_cell!(
    /// The file's bytes with the model that reads them in place.
    struct File {
        owner: Vec<u8>,
        #[covariant]
        dependent: CoreModel,
    }
);

/// What all evaluations of a model share.
pub(crate) struct Shared {
    file: File,
    /// The membrane as triangles to draw.
    pub surface: Surface,
    /// Nodes of the full mesh.
    pub nodes: usize,
}

impl Shared {
    pub fn core(&self) -> &CoreModel<'_> {
        self.file.borrow_dependent()
    }
}

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
    /// What is wrong with the file, in the core's words.
    pub fn open(bytes: Vec<u8>) -> Result<Model, JsError> {
        let file = File::try_new(bytes, |bytes| CoreModel::open(bytes))?;
        let mesh = &file.borrow_dependent().contents().mesh;
        let nodes = mesh.nodes as usize;
        let indices: Vec<u16> = mesh
            .elements
            .data
            .chunks_exact(2)
            .map(|pair| u16::from_le_bytes([pair[0], pair[1]]))
            .collect();
        let elements: Vec<[u16; 6]> = indices.as_chunks::<6>().0.to_vec();
        let surface = Surface::new(&elements, DIVISIONS);
        Ok(Self {
            shared: Rc::new(Shared { file, surface, nodes }),
        })
    }

    /// A new evaluation, with a workspace of its own.
    pub fn evaluation(&self) -> Evaluation {
        Evaluation::new(self.shared.clone())
    }

    /// Title for people.
    #[wasm_bindgen(getter)]
    pub fn title(&self) -> String {
        self.shared.core().contents().metadata.title.to_owned()
    }

    /// Constitutive law of the membrane.
    #[wasm_bindgen(getter, js_name = membraneLaw)]
    pub fn membrane_law(&self) -> String {
        self.shared.core().contents().metadata.membrane_law.to_owned()
    }

    /// CRC-32 of the payload in hexadecimal: identifies the model.
    #[wasm_bindgen(getter)]
    pub fn digest(&self) -> String {
        format!("{:08x}", self.shared.core().digest())
    }

    /// Digest of the snapshots that the model was made from.
    #[wasm_bindgen(getter, js_name = databaseDigest)]
    pub fn database_digest(&self) -> String {
        self.shared.core().contents().metadata.database_digest.to_owned()
    }

    /// Creation time, seconds since 1970-01-01 UTC.
    #[wasm_bindgen(getter, js_name = createdUnixS)]
    pub fn created_unix_s(&self) -> f64 {
        self.shared.core().contents().metadata.created_unix_s as f64
    }

    /// Nodes of the full mesh.
    #[wasm_bindgen(getter, js_name = nodeCount)]
    pub fn node_count(&self) -> usize {
        self.shared.nodes
    }

    /// The last instant that can be asked for, in l/V.
    #[wasm_bindgen(getter, js_name = endTime)]
    pub fn end_time(&self) -> f64 {
        numbers(&self.shared.core().contents().times)
            .last()
            .copied()
            .unwrap_or_default()
    }

    /// Ranges in which the model was sampled: least and greatest Ca, then least and greatest a/l.
    pub fn ranges(&self) -> Vec<f64> {
        let parameters = &self.shared.core().contents().metadata.parameters;
        parameters.iter().flat_map(|range| [range.min, range.max]).collect()
    }

    /// Sampled parameters: Ca, a/l, Ca, a/l, ... A sample that clusters share is given once.
    pub fn samples(&self) -> Vec<f64> {
        let clusters = &self.shared.core().contents().clusters;
        let mut samples: Vec<[f64; 2]> = Vec::new();
        for cluster in clusters {
            for sample in numbers(&cluster.samples).as_chunks::<2>().0 {
                if !samples.contains(sample) {
                    samples.push(*sample);
                }
            }
        }
        samples.into_flattened()
    }

    /// Border of the region that has a steady state: a/l, largest Ca, a/l, largest Ca, ..., by rising a/l.
    #[wasm_bindgen(js_name = steadyLimit)]
    pub fn steady_limit(&self) -> Vec<f64> {
        numbers(&self.shared.core().contents().steady_limit)
    }

    /// Vertices of the triangles to draw, three by three.
    pub fn triangles(&self) -> Vec<u32> {
        self.shared.surface.triangles().as_flattened().to_vec()
    }
}

/// The entries of a stored matrix, row by row.
fn numbers(matrix: &Matrix<'_>) -> Vec<f64> {
    match matrix.encoding {
        Encoding::F32 => {
            let (entries, _) = matrix.blob.data.as_chunks::<4>();
            entries
                .iter()
                .map(|&entry| f64::from(f32::from_le_bytes(entry)))
                .collect()
        }
        _ => Vec::new(),
    }
}
