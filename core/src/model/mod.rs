//! The model file: wire format, validation, views that read in place.
//!
//! A file is a 16-byte header (magic `CROM`, format version, payload length, CRC-32 of the payload, all little-endian
//! u32) and one postcard message, see [`wire`]. [`Model::open`] checks everything once; after it no accessor and no
//! evaluation depends on the file being well made any more.

mod checksum;
mod curve;
mod encode;
mod matrix;
mod mesh;
mod parameters;
mod read;
mod validate;
pub mod wire;

pub use curve::Curve;
pub use encode::encode;
pub(crate) use matrix::{Factors, Vectors};
pub use matrix::{Indices, MatrixView};
pub use mesh::Mesh;
pub(crate) use mesh::{apply, components};
pub use parameters::Parameters;

use crate::Real;
use crate::error::OpenError;
use core::fmt;
use core::mem::MaybeUninit;
use read::{Cursor, Part};
use wire::{Cluster, Contents, Reference};

/// Name of the node set of the outline z = 0, y >= 0, front pole to rear pole. A model has it only if the symmetry of
/// its mesh holds these nodes in their plane.
pub const MIDPLANE: &str = "midplane";
/// Name of the node set of the outline y = z >= 0, front pole to rear pole, under the same condition.
pub const DIAGONAL: &str = "diagonal";

const MAGIC: [u8; 4] = *b"CROM";
const VERSION: u32 = 10;
const HEADER_LENGTH: usize = 16;

/// The most samples that a cluster may hold.
pub(crate) const MAX_SAMPLES: usize = 1 << 16;

/// Rounding that a parameter may carry and still count as within a range: singles of the file against doubles of the
/// caller.
pub(crate) const PARAMETER_TOLERANCE: f64 = 1e-6;

/// A validated model, reading the file's bytes where they lie.
#[derive(Clone, Debug)]
pub struct Model<'a> {
    contents: Contents<'a>,
    digest: u32,
    file: &'a [u8],
}

impl<'a> Model<'a> {
    /// Opens a model file: checks header, CRC-32, every dimension, index and number.
    ///
    /// # Errors
    /// What is wrong with the file, see [`OpenError`].
    pub fn open(file: &'a [u8]) -> Result<Self, OpenError> {
        let mut model = Self::empty();
        model.read(file)?;
        Ok(model)
    }

    /// As [`open`](Self::open), in memory of the caller's: nothing large passes over the stack.
    ///
    /// # Errors
    /// As [`open`](Self::open); nothing may be concluded from what the memory holds then.
    pub fn open_in<'p>(place: &'p mut MaybeUninit<Self>, file: &'a [u8]) -> Result<&'p Self, OpenError> {
        let model = place.write(Self::empty());
        model.read(file)?;
        Ok(model)
    }

    fn empty() -> Self {
        Self {
            contents: Contents::default(),
            digest: 0,
            file: &[],
        }
    }

    /// Fills an empty model.
    #[inline(never)]
    fn read(&mut self, file: &'a [u8]) -> Result<(), OpenError> {
        let (payload, digest) = payload(file)?;
        (self.digest, self.file) = (digest, file);
        let mut message = Cursor::new(payload);
        self.contents.read(&mut message);
        match message.end().ok_or(OpenError::Undecodable)? {
            0 => validate::contents(&self.contents),
            found => Err(OpenError::TrailingBytes { found }),
        }
    }

    /// The bytes of the file.
    pub fn file(&self) -> &'a [u8] {
        self.file
    }

    /// CRC-32 of the payload: identifies the model.
    pub fn digest(&self) -> u32 {
        self.digest
    }

    /// The solution that the errors of the model are measured against, in words: of the full-order model with its law
    /// and bending stiffness, or other people's data.
    pub fn errors_against(&self) -> impl fmt::Display {
        let contents = &self.contents;
        let (law, stiffness) = (contents.metadata.membrane_law, contents.metadata.bending_stiffness);
        let reference = contents.mesh.reference;
        fmt::from_fn(move |f| match (reference, stiffness) {
            (Reference::Shape { .. }, _) => f.write_str("the data that the model was built from"),
            (Reference::Sphere, None) => write!(f, "the full-order model ({law})"),
            (Reference::Sphere, Some(stiffness)) => {
                write!(f, "the full-order model ({law}, B = {stiffness:e} G_s a^2)")
            }
        })
    }

    /// The decoded message.
    pub fn contents(&self) -> &Contents<'a> {
        &self.contents
    }

    /// The surface mesh.
    pub fn mesh(&self) -> Mesh<'a> {
        Mesh::new(&self.contents.mesh)
    }

    /// The named node set, if the model has it.
    pub fn node_set(&self, name: &str) -> Option<Indices<'a>> {
        self.contents
            .mesh
            .node_sets
            .iter()
            .find(|set| set.name == name)
            .map(|set| Indices::new(&set.nodes))
    }

    /// Stored instants `[N_t, 1]`.
    pub fn times(&self) -> MatrixView<'a> {
        MatrixView::new(&self.contents.times)
    }

    /// The last instant that can be asked for.
    pub fn end_time(&self) -> f32 {
        let times = self.times();
        times.get(times.rows().saturating_sub(1), 0)
    }

    /// The largest Ca that has a steady state at a confinement, linear between the stored points and constant beyond;
    /// none where the model has no steady limit.
    pub fn steady_limit<T: Real>(&self, confinement: T) -> Option<T> {
        Curve::new(&self.contents.steady_limit).at(confinement)
    }

    /// The factor of the reference nodes: a/l where they lie on the unit sphere, else 1.
    pub(crate) fn scale<T: Real>(&self, parameters: &Parameters<T>) -> T {
        match self.contents.mesh.reference {
            Reference::Sphere => parameters.get(1),
            Reference::Shape { .. } => T::ONE,
        }
    }

    /// The length that stands for a, the radius of the capsule, in errors, in the unit of length.
    pub fn radius<T: Real>(&self, parameters: impl Into<Parameters<T>>) -> T {
        match self.contents.mesh.reference {
            Reference::Sphere => parameters.into().get(1),
            Reference::Shape { radius, .. } => T::from_f64(radius),
        }
    }

    /// The axial position that is added to the stored translation.
    pub(crate) fn origin<T: Real>(&self) -> T {
        match self.contents.mesh.reference {
            Reference::Sphere => T::ZERO,
            Reference::Shape { origin, .. } => T::from_f64(origin),
        }
    }

    /// The scaled parameters, with which interpolation works: see [`wire::Parameter`].
    pub fn scaled<T: Real>(&self, parameters: &Parameters<T>) -> Parameters<T> {
        parameters.scaled(&self.contents.metadata.parameters)
    }

    /// The cluster that answers for parameters: the first that reaches up to them, else the last. Validation refuses
    /// a model that has none.
    pub fn cluster<T: Real>(&self, parameters: &Parameters<T>) -> Option<&Cluster<'a>> {
        let value = self.scaled(parameters).get(self.contents.split.into());
        let reaches = |cluster: &&Cluster<'a>| {
            let max = T::from_f64(cluster.max);
            value <= max + T::from_f64(PARAMETER_TOLERANCE) * max.abs()
        };
        let clusters = &self.contents.clusters;
        clusters.iter().find(reaches).or(clusters.last())
    }
}

/// The payload of a file and its CRC-32, if the header is right.
#[inline(never)]
fn payload(file: &[u8]) -> Result<(&[u8], u32), OpenError> {
    let truncated = |expected| OpenError::Truncated {
        expected,
        found: file.len(),
    };
    let (header, body) = file
        .split_first_chunk::<HEADER_LENGTH>()
        .ok_or(truncated(HEADER_LENGTH))?;
    let &[magic, version, length, checksum] = header.as_chunks::<4>().0 else {
        return Err(truncated(HEADER_LENGTH));
    };
    if magic != MAGIC {
        return Err(OpenError::Magic { found: magic });
    }
    let (version, length) = (u32::from_le_bytes(version), u32::from_le_bytes(length));
    let checksum = u32::from_le_bytes(checksum);
    if version != VERSION {
        return Err(OpenError::Version {
            found: version,
            supported: VERSION,
        });
    }
    let length = length as usize;
    if body.len() < length {
        return Err(truncated(HEADER_LENGTH.saturating_add(length)));
    }
    if body.len() > length {
        return Err(OpenError::TrailingBytes {
            found: body.len() - length,
        });
    }
    let found = checksum::checksum(body);
    if found == checksum {
        Ok((body, found))
    } else {
        Err(OpenError::Checksum {
            expected: checksum,
            found,
        })
    }
}
