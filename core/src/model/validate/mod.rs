//! The checks of [`Model::open`](super::Model::open): dimensions, indices, ranges, finiteness.

mod checks;
mod cluster;
mod mesh;

use super::error::OpenError;
use super::wire::{Contents, Reference};
use checks::{MAX, POSITIVE, Range, TIME, Validator};

/// Greatest length of a model in its own units, as a multiple of its radius.
const MAX_IN_RADII: f32 = 1e9;
/// The largest value of a parameter in its own units.
const MAX_PARAMETER: f64 = 1e36;

/// Checks the contents of a model.
pub(super) fn contents(contents: &Contents<'_>) -> Result<(), OpenError> {
    let length = match contents.mesh.reference {
        Reference::Sphere => MAX,
        // The radius itself is checked with the mesh.
        Reference::Shape { radius, .. } => MAX_IN_RADII * radius as f32,
    };
    let mut validator = Validator {
        found: Ok(()),
        length: [-length, length],
    };
    validator.contents(contents);
    validator.found
}

impl Validator {
    fn contents(&mut self, contents: &Contents<'_>) {
        // Ca and a/l of a capsule in the channel are positive.
        let sphere = matches!(contents.mesh.reference, Reference::Sphere);
        let least = if sphere { 1e-6 } else { -1e6 };
        let parameters = contents.metadata.parameters.len();
        self.count("parameters", if sphere { 2 } else { parameters.max(1) }, parameters);
        let greatest = if sphere { 1e6 } else { MAX_PARAMETER };
        for range in &contents.metadata.parameters {
            self.setting(
                "parameter minimum",
                range.min,
                if sphere { least } else { -greatest },
                greatest,
            );
            self.setting("parameter maximum", range.max, range.min, greatest);
            let [origin, scale] = if sphere {
                [[0.0, 0.0], [1.0, 1.0]]
            } else {
                [[-greatest, greatest], [1.0 / greatest, greatest]]
            };
            self.setting("origin of a parameter", range.origin, origin[0], origin[1]);
            self.setting("scale of a parameter", range.scale, scale[0], scale[1]);
        }
        if let Some(stiffness) = contents.metadata.bending_stiffness {
            self.setting("bending stiffness", stiffness, 0.0, 1e6);
        }
        self.mesh(&contents.mesh);

        let times = self.rising("times", &contents.times, [1, 2], TIME);
        let (start, end_time) = (times.get(0, 0), times.get(times.rows().saturating_sub(1), 0));
        if start != 0.0 {
            self.number("times", 0, start, "0");
        }
        let error_times = self.rising("error times", &contents.error_times, [1, 1], TIME);
        let limit = self.rising("steady limit", &contents.steady_limit, [2, 0], POSITIVE);
        let effect = &contents.bending_effect;
        self.matrix("effect of bending", effect, [effect.rows as usize, 3], POSITIVE);
        self.singles("effect of bending", effect);
        if !sphere {
            self.count(
                "points of the steady limit and of the effect of bending outside the channel",
                0,
                limit.rows() + effect.rows as usize,
            );
        }
        for row in 0..limit.rows() {
            let value = limit.get(row, 1).into();
            self.fixed(
                value,
                &Range {
                    what: "capillary number of the steady limit",
                    min: 1e-6,
                    max: 1e6,
                },
            );
        }
        self.rising("border", &contents.border, [2, 0], POSITIVE);
        self.singles("steady limit", &contents.steady_limit);
        self.singles("border", &contents.border);

        let kernel = &contents.kernel;
        self.at_least_one("neighbours of the kernel", kernel.neighbours);
        for scale in &kernel.scales {
            self.fixed(
                *scale,
                &Range {
                    what: "scale of the kernel",
                    min: 1e-9,
                    max: 1e9,
                },
            );
        }
        let paper = &contents.paper;
        self.at_least_one("neighbours of the diffuse approximation", paper.neighbours);
        for scale in &paper.scales {
            self.fixed(
                *scale,
                &Range {
                    what: "scale of the diffuse approximation",
                    min: 1e-9,
                    max: 1e9,
                },
            );
        }
        self.fixed(
            paper.radius,
            &Range {
                what: "radius of the diffuse approximation",
                min: 1.0 + 1e-3,
                max: 10.0,
            },
        );
        self.at_least_one("local displacement rank", paper.displacement_rank);
        self.at_least_one("local velocity rank", paper.velocity_rank);
        self.fixed(
            paper.window,
            &Range {
                what: "window of the manifold",
                min: 1.0,
                max: 4.0,
            },
        );

        self.index("parameter of the clusters", 0, contents.split.into(), parameters);
        self.count("clusters", contents.clusters.len().max(1), contents.clusters.len());
        let mut reached = 1e6;
        for cluster in &contents.clusters {
            self.setting("least value of a cluster", cluster.min, least, reached);
            self.setting("greatest value of a cluster", cluster.max, cluster.min, 1e6);
            reached = cluster.max;
            self.samples(&cluster.samples, parameters, least as f32);
            self.field(cluster, contents.mesh.sector_reference.rows as usize, end_time);
            let (samples, instants) = (cluster.samples.parameters.rows as usize, error_times.rows());
            self.errors(&cluster.direct_errors, samples, instants);
            self.errors(&cluster.paper_errors, samples, instants);
            let known = cluster.interval_errors.rows > 0;
            let shape = if known {
                [samples, times.rows().saturating_sub(1)]
            } else {
                [0, 0]
            };
            self.matrix("errors between instants", &cluster.interval_errors, shape, POSITIVE);
            let factors = [shape[1], usize::from(known)];
            self.matrix(
                "bound's factors between instants",
                &cluster.interval_bound_factors,
                factors,
                POSITIVE,
            );
        }
    }
}
