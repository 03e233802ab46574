//! The model file: wire format, validation, views that read in place.
//!
//! A file is a 16-byte header (magic `CROM`, format version, payload length, CRC-32 of the payload, all little-endian
//! u32) and one postcard message, described in `wire.rs`. [`Model::open`] checks everything once; after it no accessor
//! and no evaluation depends on the file being well made any more.

mod checksum;
mod curve;
#[cfg(feature = "write")]
mod encode;
mod error;
mod header;
mod indices;
mod matrix;
mod mesh;
#[cfg(not(feature = "write"))]
mod panels;
#[cfg(feature = "write")]
pub mod panels;
mod parameters;
mod products;
mod quantized;
mod read;
mod samples;
mod validate;
#[cfg(not(feature = "write"))]
pub(crate) mod wire;
#[cfg(feature = "write")]
pub mod wire;

pub use curve::Curve;
#[cfg(feature = "write")]
pub use encode::encode;
#[cfg(feature = "write")]
pub use error::EncodeError;
pub use error::OpenError;
pub use indices::Indices;
pub use matrix::MatrixView;
pub use mesh::Mesh;
pub(crate) use mesh::{apply, components};
pub use parameters::Parameters;
pub(crate) use quantized::{QuantizedRef, QuantizedVectors};
pub use samples::ClusterSamples;
pub use wire::{DIAGONAL, MIDPLANE, Parameter, Reference, Units};

use crate::Real;
use crate::error::EvaluateError;
use crate::mechanics;
use core::fmt;
use core::mem::MaybeUninit;
use header::payload;
use read::{Decode, Reader};
use wire::{Cluster, Contents, Method};

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
    /// [`OpenError`] names the fault of the file.
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
        let mut message = Reader::new(payload);
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

    /// Title for people.
    pub fn title(&self) -> &'a str {
        self.contents.metadata.title
    }

    /// Units of lengths, velocities and times.
    pub fn units(&self) -> Units<'a> {
        self.contents.metadata.units
    }

    /// The parameters with their names and sampled ranges, in the order of a query.
    pub fn parameters(&self) -> &[Parameter<'a>] {
        &self.contents.metadata.parameters
    }

    /// Constitutive law of the membrane.
    pub fn membrane_law(&self) -> &'a str {
        self.contents.metadata.membrane_law
    }

    /// Bending stiffness B of the full-order model, in G_s a^2, if it is known.
    pub fn bending_stiffness(&self) -> Option<f64> {
        self.contents.metadata.bending_stiffness
    }

    /// Digest of the snapshot database (hexadecimal text).
    pub fn database_digest(&self) -> &'a str {
        self.contents.metadata.database_digest
    }

    /// Settings of the offline stage, as JSON text.
    pub fn offline_settings(&self) -> &'a str {
        self.contents.metadata.offline_settings
    }

    /// Creation time, seconds since 1970-01-01 UTC.
    pub fn created_unix_s(&self) -> u32 {
        self.contents.metadata.created_unix_s
    }

    /// Method for a caller that has no preference.
    pub fn default_method(&self) -> Method {
        self.contents.default_method
    }

    /// The reference state of the mesh: [`Reference::Sphere`] for a capsule in the channel.
    pub fn reference(&self) -> Reference {
        self.contents.mesh.reference
    }

    /// Whether the [mechanics] of the membrane is known: that of a neo-Hookean membrane which is stress-free as a
    /// sphere of radius a/l.
    pub fn has_mechanics(&self) -> bool {
        matches!(self.reference(), Reference::Sphere) && self.membrane_law() == mechanics::LAW
    }

    /// The clusters, by rising values of the parameter that divides them.
    pub fn clusters(&self) -> impl ExactSizeIterator<Item = ClusterSamples<'a>> {
        self.contents.clusters.iter().map(ClusterSamples::new)
    }

    /// The curve of the largest Ca with a steady state; without points where the model has no steady limit.
    pub fn steady_limit_curve(&self) -> Curve<'a> {
        Curve::new(&self.contents.steady_limit)
    }

    /// The curve Ca(a/l) at which the solution jumps, and which interpolation does not cross.
    pub fn jump_curve(&self) -> Curve<'a> {
        Curve::new(&self.contents.border)
    }

    /// Effect of the bending stiffness at some configurations `[n, 3]`: rows (Ca, a/l, distance as a fraction of a).
    pub fn bending_effect(&self) -> MatrixView<'a> {
        MatrixView::new(&self.contents.bending_effect)
    }

    /// Instants `[N_e, 1]` of the leave-one-out errors.
    pub fn error_times(&self) -> MatrixView<'a> {
        MatrixView::new(&self.contents.error_times)
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
    #[cfg(feature = "write")]
    pub fn contents(&self) -> &Contents<'a> {
        &self.contents
    }

    /// The decoded message.
    #[cfg(not(feature = "write"))]
    pub(crate) fn contents(&self) -> &Contents<'a> {
        &self.contents
    }

    /// An error in words, with the names of the model's parameters.
    pub fn describe(&self, error: EvaluateError) -> impl fmt::Display + use<'a> {
        let parameters = self.contents.metadata.parameters.iter();
        let names: heapless::Vec<&'a str, { wire::MAX_PARAMETERS }> =
            parameters.map(|parameter| parameter.name).collect();
        fmt::from_fn(move |f| error.write(f, &names))
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
