//! The payload of a model file: ONE postcard message of the struct [`Contents`].
//!
//! Every array is a [`Blob`]: little-endian numbers behind a pad whose length lands them on a 16-byte boundary of the
//! file, so that they are read where they lie. [`encode`](super::encode) chooses the pads; a writer leaves them empty.
//!
//! # State
//! Coefficient 0 of the displacement is the translation, `sqrt(N_x) X_c` with `X_c` the axial position of the volume
//! centroid; it has no column in the mode matrix. Coefficient `k >= 1` belongs to column `k - 1`. The shape
//! displacement is measured in the centroid's frame from the scaled reference node: `x = s X + Phi alpha`, with s = a/l
//! or 1 as the mesh's [`Reference`] says, so the initial shape is in the data at t = 0. The velocity's coefficients are
//! the rates d alpha/dt: coefficient 0 is `sqrt(N_x) U` with `U = dX_c/dt`, the others are those of `v - U e_x`.

use heapless::Vec;
#[cfg(feature = "write")]
use serde::{Deserialize, Serialize};

/// The most clusters that a file may hold.
pub const MAX_CLUSTERS: usize = 4;
/// The most named node sets that a file may hold.
pub const MAX_NODE_SETS: usize = 8;
/// The most spans of time that the motion of a cluster may be cut into.
pub const MAX_SPANS: usize = 4;
/// The most parameters that a model may have.
pub const MAX_PARAMETERS: usize = 4;
/// The most samples that a cluster may hold.
pub const MAX_SAMPLES: usize = 1 << 16;

/// Name of the node set of the outline z = 0, y >= 0, front pole to rear pole. A model has it only if the symmetry of
/// its mesh holds these nodes in their plane.
pub const MIDPLANE: &str = "midplane";
/// Name of the node set of the outline y = z >= 0, front pole to rear pole, under the same condition.
pub const DIAGONAL: &str = "diagonal";

/// The message.
#[derive(Clone, Debug, Default, PartialEq)]
#[cfg_attr(feature = "write", derive(Serialize, Deserialize))]
pub struct Contents<'a> {
    /// Title, units, parameters, provenance.
    #[cfg_attr(feature = "write", serde(borrow))]
    pub metadata: Metadata<'a>,
    /// Surface mesh and its symmetry.
    pub mesh: Mesh<'a>,
    /// Stored instants `[N_t, 1]`, strictly rising from 0.
    pub times: Matrix<'a>,
    /// Instants `[N_e, 1]` of the stored leave-one-out errors, strictly rising.
    pub error_times: Matrix<'a>,
    /// Steady limit `[n, 2]`: rows (a/l, largest Ca that has a steady state), a/l strictly rising; linear between.
    /// Empty where the parameters are not (Ca, a/l) of a capsule in the channel.
    pub steady_limit: Matrix<'a>,
    /// Distances `[n, 3]` between the full-order solution and that without bending stiffness at some configurations:
    /// rows (Ca, a/l, modified Hausdorff distance in profile at the end as a fraction of a). May be empty.
    pub bending_effect: Matrix<'a>,
    /// Border `[n, 2]` that interpolation does not cross, because the solution jumps there: rows (a/l, Ca), a/l
    /// strictly rising; linear between, and no border beyond. May be empty.
    pub border: Matrix<'a>,
    /// Method for a caller that has no preference.
    pub default_method: Method,
    /// Settings of [`Method::Direct`].
    pub kernel: Kernel,
    /// Settings of [`Method::Paper`].
    pub paper: Paper,
    /// Index of the parameter along which the clusters follow each other.
    pub split: u8,
    /// Clusters, each for a range of that parameter, by its rising values; neighbours share their border.
    pub clusters: Vec<Cluster<'a>, MAX_CLUSTERS>,
}

/// Title, units, parameters, provenance.
#[derive(Clone, Debug, Default, PartialEq)]
#[cfg_attr(feature = "write", derive(Serialize, Deserialize))]
pub struct Metadata<'a> {
    /// Title for people.
    pub title: &'a str,
    /// Units of what goes in and comes out.
    #[cfg_attr(feature = "write", serde(borrow))]
    pub units: Units<'a>,
    /// Constitutive law of the membrane.
    pub membrane_law: &'a str,
    /// Bending stiffness B of the full-order model, in G_s a^2, if it is known.
    pub bending_stiffness: Option<f64>,
    /// One to four parameters, in the order of a query's; capillary number, confinement for a capsule in the channel.
    #[cfg_attr(feature = "write", serde(borrow))]
    pub parameters: Vec<Parameter<'a>, MAX_PARAMETERS>,
    /// Digest of the snapshot database (hexadecimal text).
    pub database_digest: &'a str,
    /// Settings of the offline stage, as JSON text.
    pub offline_settings: &'a str,
    /// Creation time, seconds since 1970-01-01 UTC: up to the year 2106.
    pub created_unix_s: u32,
}

/// Names of the units.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "write", derive(Serialize, Deserialize))]
pub struct Units<'a> {
    /// Of lengths; `l`, half the channel's side, for a capsule in the channel.
    pub length: &'a str,
    /// Of velocities; `V`, the mean velocity of the undisturbed flow, for a capsule in the channel.
    pub velocity: &'a str,
    /// Of times; `l/V` for a capsule in the channel.
    pub time: &'a str,
}

/// One parameter and the range in which the model was sampled.
///
/// A model works with scaled parameters, (value - origin) / scale, so that a large offset costs no precision. For a
/// capsule in the channel they are Ca and a/l themselves.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "write", derive(Serialize, Deserialize))]
pub struct Parameter<'a> {
    /// Name, such as `capillary_number`.
    pub name: &'a str,
    /// Least sampled value.
    pub min: f64,
    /// Greatest sampled value.
    pub max: f64,
    /// Value whose scaled parameter is 0; exact in single precision.
    pub origin: f64,
    /// Change of the value by which the scaled parameter grows by 1, > 0.
    pub scale: f64,
}

/// Surface mesh: triangles of degree 2 or 1, stored with what symmetry cannot derive.
#[derive(Clone, Debug, Default, PartialEq)]
#[cfg_attr(feature = "write", derive(Serialize, Deserialize))]
pub struct Mesh<'a> {
    /// Number of nodes N_x of the full mesh.
    pub nodes: u32,
    /// Nodes of an element: 6, or 3 where the triangles are flat.
    pub element_nodes: u8,
    /// `u16 [N_e, element_nodes]`: corners 0 1 2, mid-edges (0,1) (1,2) (2,0), counter-clockwise from outside.
    #[cfg_attr(feature = "write", serde(borrow))]
    pub elements: Blob<'a>,
    /// Shape of the reference nodes.
    pub reference: Reference,
    /// Reference nodes of the sector `[N_s, 3]`.
    pub sector_reference: Matrix<'a>,
    /// `u8 [G]`: the operations 0..8 to which the mesh is symmetric, the first of them 0. Bit 2: swap y and z (first);
    /// bit 0: y -> -y; bit 1: z -> -z.
    pub operations: Blob<'a>,
    /// `u16 [G, N_s]`: the full node to which each operation takes each sector node; 65535 where an operation before it
    /// does already. So every full node is named once, and the first row holds the sector's own full indices.
    pub images: Blob<'a>,
    /// `u16 [N_x]`: the place of each full node in `images`, row times N_s plus sector node.
    pub origins: Blob<'a>,
    /// Named lists of nodes, such as [`MIDPLANE`] and [`DIAGONAL`] where the mesh has
    /// nodes in these planes.
    pub node_sets: Vec<NodeSet<'a>, MAX_NODE_SETS>,
}

/// The reference state of a mesh: node X contributes `s X` to its position.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "write", derive(Serialize, Deserialize))]
pub enum Reference {
    /// The unit sphere, which times a/l is the stress-free state: s = a/l, and the parameters are (Ca, a/l). Only here
    /// the mechanics of the membrane is known.
    #[default]
    Sphere,
    /// Any shape, in the unit of length: s = 1.
    Shape {
        /// The length that stands for a in errors: the radius of the sphere of the same volume.
        radius: f64,
        /// Axial position that is added to the stored translation.
        origin: f64,
        /// Least and greatest volume of the snapshots, in the volume of the sphere of that radius.
        volumes: [f64; 2],
    },
}

/// A named list of nodes.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "write", derive(Serialize, Deserialize))]
pub struct NodeSet<'a> {
    /// Name.
    pub name: &'a str,
    /// `u16 [n]`: full node indices; an outline runs from the front pole to the rear pole.
    #[cfg_attr(feature = "write", serde(borrow))]
    pub nodes: Blob<'a>,
}

/// The double POD of one part of the parameter domain, and its samples.
#[derive(Clone, Debug, Default, PartialEq)]
#[cfg_attr(feature = "write", derive(Serialize, Deserialize))]
pub struct Cluster<'a> {
    /// Least value of the clusters' scaled parameter that the cluster answers for.
    pub min: f64,
    /// The greatest value.
    pub max: f64,
    /// Samples, by rising last parameter.
    #[cfg_attr(feature = "write", serde(borrow))]
    pub samples: Samples<'a>,
    /// Displacement and velocity.
    pub field: Field<'a>,
    /// Leave-one-out errors of [`Method::Direct`].
    pub direct_errors: Errors<'a>,
    /// Leave-one-out errors of [`Method::Paper`].
    pub paper_errors: Errors<'a>,
    /// `[N_c, N_t - 1]`: error of the interpolation in time in the middle of each interval of the stored instants,
    /// fraction of a; or empty where the instants are so dense that it is negligible.
    pub interval_errors: Matrix<'a>,
    /// `[N_t - 1, 1]`, or empty as they are: the 95 % bound of these errors as a multiple of them.
    pub interval_bound_factors: Matrix<'a>,
}

/// Where the samples of a cluster lie.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "write", derive(Serialize, Deserialize))]
pub struct Samples<'a> {
    /// `[N_c, P]`: rows of scaled parameters, rising: ordered by the last one, equal ones by the one before it.
    #[cfg_attr(feature = "write", serde(borrow))]
    pub parameters: Matrix<'a>,
    /// `[N_c, P]`: their [coordinates](crate::interpolate::Coordinates::transform), in which [`Method::Direct`] takes
    /// distances.
    pub places: Matrix<'a>,
}

/// The motion of a cluster: the double POD of displacement and velocity (eqs. 15 to 22) in common modes, with time in
/// cubic B-splines: the displacement of sample j at t is `Phi sum_b B_b(t) G_b Psi_j^T`, with the parameter modes Psi
/// of the span of time that control b belongs to.
///
/// The nodes move with their velocity, so both fields lie in one space Phi, and the velocity's coefficients are the
/// rates of the displacement's.
#[derive(Clone, Debug, Default, PartialEq)]
#[cfg_attr(feature = "write", derive(Serialize, Deserialize))]
pub struct Field<'a> {
    /// Shape modes `[3 S, K - 1]` at the sector nodes, orthonormal over the FULL mesh: rows of x, then of y, then of z,
    /// each S rows for S the next multiple of 8 of N_s; those beyond N_s are 0.
    #[cfg_attr(feature = "write", serde(borrow))]
    pub modes: Matrix<'a>,
    /// Knots `[N_b + 4, 1]`: the first four are 0 and the last four the end time; between, none is repeated more than
    /// four times.
    pub knots: Matrix<'a>,
    /// The controls, in spans that follow each other.
    pub spans: Vec<Span<'a>, MAX_SPANS>,
    /// The translation's controls `[N_b, K_a]`: that of sample j is `sum_b B_b(t) F_b Y_j^T`.
    pub axial_controls: Matrix<'a>,
    /// Y `[N_c, K_a]`.
    pub axial_modes: Matrix<'a>,
}

/// Successive controls of a motion. How it depends on the parameters changes in time, so each span has modes of its
/// own, fewer than all of time would need.
///
/// Of the core's slices G_b `[K - 1, K_c]` the last rows, which are negligible, are not stored.
#[derive(Clone, Debug, Default, PartialEq)]
#[cfg_attr(feature = "write", derive(Serialize, Deserialize))]
pub struct Span<'a> {
    /// Psi `[N_c, K_c]`.
    #[cfg_attr(feature = "write", serde(borrow))]
    pub parameter_modes: Matrix<'a>,
    /// `u16`, one for each control of the span: how many times eight rows of the core belong to its slice.
    pub slices: Blob<'a>,
    /// The rows of the slices `[n, K_c]`, one slice after the other.
    pub core: Matrix<'a>,
}

/// Leave-one-out errors at the samples of a cluster, by one method.
#[derive(Clone, Debug, Default, PartialEq)]
#[cfg_attr(feature = "write", derive(Serialize, Deserialize))]
pub struct Errors<'a> {
    /// Error `[N_c, N_e]` of the sample predicted without itself at the instants `error_times`, in the laboratory
    /// frame, as a fraction of a: modified Hausdorff distance for a capsule in the channel, mean distance of the nodes
    /// for
    /// [`Reference::Shape`].
    #[cfg_attr(feature = "write", serde(borrow))]
    pub left_out: Matrix<'a>,
    /// `[N_c, 1]`: [`Weights::deviation`](crate::interpolate::Weights::deviation) of that prediction, > 0.
    pub deviation: Matrix<'a>,
    /// `[N_e, 1]`: the 95 % bound of the error as a multiple of the expected error, at each of the instants.
    pub bound_factors: Matrix<'a>,
    /// `[N_e, 1]`: by how much the solution changes around a sample at each of the instants, per unit of distance in
    /// the coordinates of the interpolation, as a fraction of a: around nine in ten samples it changes more slowly.
    pub changes: Matrix<'a>,
    /// Error that remains at a sample itself (truncation, storage), fraction of a.
    pub floor: f64,
}

/// How a query is answered.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "write", derive(Serialize, Deserialize))]
pub enum Method {
    /// Interpolated coefficients evaluated at the instant: a quintic kernel in the parameters, cubic splines in time.
    #[default]
    Direct,
    /// Algorithm 2 of the paper: diffuse approximation, local POD, learned manifold, forward Euler.
    Paper,
}

/// Settings of the kernel interpolation.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "write", derive(Serialize, Deserialize))]
pub struct Kernel {
    /// Number of nearest samples that take part.
    pub neighbours: u32,
    /// Factor of each scaled parameter in the coordinates in which distances are taken; 1 beyond the last. With a
    /// steady limit the coordinates are (s_0 sqrt(Ca) / Ca_lim(a/l)^(1/8), s_1 a/l).
    pub scales: [f64; MAX_PARAMETERS],
}

/// Settings of Algorithm 2.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "write", derive(Serialize, Deserialize))]
pub struct Paper {
    /// M: samples that the ellipse of the diffuse approximation holds (section 3.4.1).
    pub neighbours: u32,
    /// Weight of each scaled parameter in the distance: (r, 1) for (Ca, a/l), eq. 27 with r on Ca, as Figure 5 shows
    /// it.
    pub scales: [f64; MAX_PARAMETERS],
    /// R as a multiple of the distance of the M-th sample; > 1, or that sample has no weight.
    pub radius: f64,
    /// m_u: rank of the local displacement basis, translation included.
    pub displacement_rank: u32,
    /// m_v: rank of the local velocity basis, translation included.
    pub velocity_rank: u32,
    /// R of eq. (45) as a multiple of the snapshot interval.
    pub window: f64,
}

/// A matrix.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "write", derive(Serialize, Deserialize))]
pub struct Matrix<'a> {
    /// Number of rows.
    pub rows: u32,
    /// Number of columns.
    pub columns: u32,
    /// How an entry is stored.
    pub encoding: Encoding,
    /// The entries.
    #[cfg_attr(feature = "write", serde(borrow))]
    pub blob: Blob<'a>,
}

/// How the entries of a matrix are stored.
///
/// A quantised entry is an integer times a scale. The integers of the first columns, which are wide, have two bytes,
/// the others one; [`panels`](super::panels) describes their layout.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "write", derive(Serialize, Deserialize))]
#[non_exhaustive]
pub enum Encoding {
    /// Little-endian binary32, row by row.
    #[default]
    F32,
    /// A little-endian binary32 scale for each column, then the panels of the transpose: for sums of rows.
    Columns(Widths),
    /// A little-endian binary32 scale for each column, then the panels: for products with vectors.
    ColumnPanels(Widths),
    /// A little-endian binary32 scale for each row, then the panels: for products with vectors.
    RowPanels(Widths),
}

/// Bytes of the integers of each column.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "write", derive(Serialize, Deserialize))]
pub struct Widths {
    /// Number of leading columns whose integers have two bytes; those of the others have one.
    pub wide_columns: u16,
}

/// Little-endian numbers, aligned to 16 bytes in the file by the pad before them.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "write", derive(Serialize, Deserialize))]
pub struct Blob<'a> {
    /// Zeros, fewer than 16.
    pub pad: &'a [u8],
    /// The numbers.
    pub data: &'a [u8],
}

impl Parameter<'_> {
    /// The value of a scaled parameter.
    pub fn value(&self, scaled: f64) -> f64 {
        self.origin + self.scale * scaled
    }
}

impl<'a> Blob<'a> {
    /// Data with an empty pad, as a writer gives it to [`encode`](super::encode).
    pub const fn new(data: &'a [u8]) -> Self {
        Self { pad: &[], data }
    }
}

impl<'a> Matrix<'a> {
    /// A matrix of little-endian f32, with an empty pad.
    pub const fn f32(rows: u32, columns: u32, data: &'a [u8]) -> Self {
        Self::new(rows, columns, Encoding::F32, data)
    }

    /// A matrix with an empty pad.
    pub const fn new(rows: u32, columns: u32, encoding: Encoding, data: &'a [u8]) -> Self {
        Self {
            rows,
            columns,
            encoding,
            blob: Blob::new(data),
        }
    }
}
