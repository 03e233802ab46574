//! Whether the snapshots of a closed surface are a plausible motion of one capsule.

use super::Collection;
use super::parameters::number;
use crate::{DatabaseError, Mesh};

/// The least volume, as a share of the cube of the surface's extent: that of an ellipsoid 700 times as long as wide.
const FLAT: f64 = 1e-6;

/// The most that the mean radius may change within a configuration, as a factor: swelling and bursting are within it.
const SWOLLEN: f64 = 2.0;

/// The most that the mean radius may differ from the median of all configurations, as a factor: beyond are other units.
const OTHER_UNIT: f64 = 100.0;

/// The farthest that a capsule may lie from the channel's axis, in mean radii.
const OFF_AXIS: f64 = 100.0;

const UNWRAP: &str =
    "expected one capsule of the same nodes throughout, with unwrapped positions where the domain is periodic";

/// A snapshot as a whole.
struct Body {
    /// The radius of the sphere of the same volume; negative when the surface is inside out.
    radius: f64,
    /// The volume as a share of the extent's cube.
    fullness: f64,
    /// The mean of the nodes.
    centre: [f64; 3],
}

/// Checks that in all snapshots the surface encloses a plausible volume and hangs together, and that it moves without
/// jumps.
///
/// # Errors
/// [`DatabaseError::BadCollection`] with the configuration, the instant and the nodes.
pub(super) fn check(collection: &Collection, mesh: &Mesh) -> Result<(), DatabaseError> {
    let edges = edges(mesh);
    let mut radii = Vec::new();
    for (j, snapshots) in collection.positions.iter().enumerate() {
        let bodies = snapshots.iter().map(|positions| Body::new(mesh, positions));
        let bodies: Vec<Body> = bodies.collect::<Result<_, _>>()?;
        let check = Configuration {
            collection,
            j,
            bodies: &bodies,
        };
        check.bodies()?;
        check.edges(&edges)?;
        check.volumes()?;
        check.path()?;
        radii.push(bodies[0].radius);
    }
    let middle = median(&mut radii.clone());
    match radii
        .iter()
        .position(|r| !(middle / OTHER_UNIT..=middle * OTHER_UNIT).contains(r))
    {
        None => Ok(()),
        Some(j) => Err(DatabaseError::collection(format!(
            "`positions`: {} has the mean radius {}, the median of all is {}; expected all in the same unit of length",
            collection.place(j),
            rounded(radii[j]),
            rounded(middle)
        ))),
    }
}

impl Body {
    /// In coordinates relative to a node, divided by the extent: neither a distant origin nor the unit matters.
    fn new(mesh: &Mesh, positions: &[[f64; 3]]) -> Result<Self, DatabaseError> {
        let origin = positions[0];
        let relative = |x: &[f64; 3]| [x[0] - origin[0], x[1] - origin[1], x[2] - origin[2]];
        let mut scaled: Vec<[f64; 3]> = positions.iter().map(relative).collect();
        let extent = scaled
            .as_flattened()
            .iter()
            .fold(0.0, |extent: f64, x| extent.max(x.abs()));
        if extent > 0.0 {
            scaled.as_flattened_mut().iter_mut().for_each(|x| *x /= extent);
        }
        let mean = |d: usize| scaled.iter().map(|x| x[d]).sum::<f64>() / scaled.len() as f64;
        let centre = [0, 1, 2].map(|d| origin[d] + extent * mean(d));
        let fullness = volume(mesh, &scaled)?;
        Ok(Self {
            radius: extent * (0.75 / std::f64::consts::PI * fullness).cbrt(),
            fullness,
            centre,
        })
    }

    fn volume(&self) -> String {
        rounded(4.0 / 3.0 * std::f64::consts::PI * self.radius.powi(3))
    }
}

struct Configuration<'a> {
    collection: &'a Collection,
    j: usize,
    bodies: &'a [Body],
}

impl Configuration<'_> {
    fn fault(&self, i: usize, what: &str) -> DatabaseError {
        let (time, place) = (number(self.collection.times[i]), self.collection.place(self.j));
        DatabaseError::collection(format!("`positions` of {place} at t = {time} (snapshot {i}): {what}"))
    }

    /// No snapshot is flat.
    fn bodies(&self) -> Result<(), DatabaseError> {
        match self.bodies.iter().position(|body| body.fullness.abs() <= FLAT) {
            None => Ok(()),
            Some(i) => Err(self.fault(i, "the surface encloses no volume, expected a body")),
        }
    }

    /// No edge is longer than the mean diameter, unless the mesh is as coarse as that. The volume of a surface that is
    /// torn apart is any number, so the diameter is of the least one.
    fn edges(&self, edges: &[[u32; 2]]) -> Result<(), DatabaseError> {
        let radii = self.bodies.iter().map(|body| body.radius.abs());
        let diameter = 2.0 * radii.fold(f64::INFINITY, f64::min);
        for (i, positions) in self.collection.positions[self.j].iter().enumerate() {
            let length = |[a, b]: &[u32; 2]| {
                let [a, b] = [a, b].map(|node| positions[*node as usize]);
                (a[0] - b[0]).hypot(a[1] - b[1]).hypot(a[2] - b[2])
            };
            let mut lengths: Vec<f64> = edges.iter().map(length).collect();
            let longest = (0..lengths.len()).max_by(|e, f| lengths[*e].total_cmp(&lengths[*f]));
            let Some((longest, [a, b])) = longest.map(|e| (lengths[e], edges[e])) else {
                continue;
            };
            let half = median(&mut lengths);
            if longest > diameter && longest > 2.0 * half {
                let (longest, half) = (rounded(longest), rounded(half));
                return Err(self.fault(
                    i,
                    &format!("edge ({a}, {b}) has the length {longest}, half of all are shorter than {half}; {UNWRAP}"),
                ));
            }
        }
        Ok(())
    }

    /// All volumes are positive, and alike.
    fn volumes(&self) -> Result<(), DatabaseError> {
        let first = &self.bodies[0];
        if first.radius < 0.0 {
            let turned = if Mesh::is_flat(&self.collection.elements[0]) {
                "elements[:, ::-1]"
            } else {
                "elements[:, [0, 2, 1, 5, 4, 3]]"
            };
            return Err(DatabaseError::collection(format!(
                "`elements`: the surface is inside out: it encloses the volume {} in {}; expected the nodes of each \
                 triangle counter-clockwise seen from outside: `{turned}` turns them over",
                first.volume(),
                self.collection.place(self.j)
            )));
        }
        for (i, body) in self.bodies.iter().enumerate() {
            if body.radius < 0.0 {
                let found = body.volume();
                return Err(self.fault(i, &format!("the surface encloses the volume {found}; {UNWRAP}")));
            }
            if !(first.radius / SWOLLEN..=first.radius * SWOLLEN).contains(&body.radius) {
                let (found, start) = (body.volume(), first.volume());
                let factor = SWOLLEN.powi(3);
                return Err(self.fault(
                    i,
                    &format!(
                        "the volume is {found}, at the start {start}; expected the same within a factor of {factor}"
                    ),
                ));
            }
        }
        Ok(())
    }

    /// The centre stays near the channel's axis, and does not move back by more than a diameter in one step of a
    /// forward motion.
    fn path(&self) -> Result<(), DatabaseError> {
        let radius = self.bodies[0].radius;
        for (i, Body { centre, .. }) in self.bodies.iter().enumerate() {
            if centre[1].abs().max(centre[2].abs()) > OFF_AXIS * radius {
                let [y, z] = [centre[1], centre[2]].map(rounded);
                let radius = rounded(radius);
                let what = format!(
                    "the centre lies at y = {y}, z = {z}, more than {OFF_AXIS} mean radii ({radius}) from the \
                     channel's axis y = z = 0; expected coordinates from the axis"
                );
                return Err(self.fault(i, &what));
            }
        }
        let steps: Vec<f64> = self
            .bodies
            .windows(2)
            .map(|pair| pair[1].centre[0] - pair[0].centre[0])
            .collect();
        for (i, step) in steps.iter().enumerate() {
            // The steps before and after; at an end the two next to it.
            let first = i.saturating_sub(1).min(steps.len().saturating_sub(3));
            let neighbours = steps
                .iter()
                .enumerate()
                .skip(first)
                .take(3)
                .filter(|(other, _)| *other != i);
            let against = neighbours.filter(|(_, other)| step * **other < 0.0 && step.abs() > other.abs());
            if step.abs() > 2.0 * radius && against.count() == 2 {
                let step = rounded(*step);
                let what = format!("the capsule has jumped by {step} along x against its motion; {UNWRAP}");
                return Err(self.fault(i + 1, &what));
            }
        }
        Ok(())
    }
}

/// The edges of a closed surface, of quadratic triangles their halves. Each edge is a rising one of just one triangle.
fn edges(mesh: &Mesh) -> Vec<[u32; 2]> {
    let mut edges = Vec::new();
    for element in &mesh.elements {
        for [from, to, middle] in [[0, 1, 3], [1, 2, 4], [2, 0, 5]].map(|side| side.map(|k| element[k])) {
            if from < to && Mesh::is_flat(element) {
                edges.push([from, to]);
            } else if from < to {
                edges.extend([[from, middle], [middle, to]]);
            }
        }
    }
    edges
}

/// The volume that a closed surface encloses. Its triangles are all flat, or all quadratic.
fn volume(mesh: &Mesh, positions: &[[f64; 3]]) -> Result<f64, DatabaseError> {
    if !Mesh::is_flat(&mesh.elements[0]) {
        return Ok(mesh.volume_and_centroid(positions)?.0);
    }
    // The tetrahedra from the origin: the same as the quadrature's value, at a fraction of its time.
    let tetrahedron = |element: &[u32; 6]| {
        let [a, b, c] = [0, 1, 2].map(|k| positions[element[k] as usize]);
        let normal = [
            b[1] * c[2] - b[2] * c[1],
            b[2] * c[0] - b[0] * c[2],
            b[0] * c[1] - b[1] * c[0],
        ];
        (a[0] * normal[0] + a[1] * normal[1] + a[2] * normal[2]) / 6.0
    };
    Ok(mesh.elements.iter().map(tetrahedron).sum())
}

pub(super) fn median(values: &mut [f64]) -> f64 {
    let middle = values.len() / 2;
    *values.select_nth_unstable_by(middle, f64::total_cmp).1
}

/// A measured number to four digits.
pub(super) fn rounded(value: f64) -> String {
    number(format!("{value:.3e}").parse().unwrap_or(value))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::tests::octahedral;

    type Node = [f64; 3];

    /// An ellipsoid of the volume of the unit sphere that travels along x at the speed 1.5, three configurations;
    /// `change` is done to each node of the last one, by its number and instant.
    fn moving(change: impl Fn(Node, usize, f64) -> Node) -> Result<Collection, String> {
        let mesh = octahedral(4);
        let times: Vec<f64> = (0..9).map(|i| 0.5 * f64::from(i)).collect();
        let at = |j: usize, n: usize, t: f64| {
            let ([x, y, z], s) = (mesh.nodes[n], 1.0 + 0.1 * t.min(1.0) * j as f64);
            let node = [1.5 * t + x * s, y / s, z];
            if j == 2 { change(node, n, t) } else { node }
        };
        let snapshot = |j, t| (0..mesh.nodes.len()).map(|n| at(j, n, t)).collect();
        let collection = Collection::new(Collection {
            parameter_names: vec!["flow".to_owned()],
            length_unit: None,
            time_unit: None,
            parameters: vec![vec![0.0], vec![0.5], vec![1.0]],
            positions: (0..3)
                .map(|j| times.iter().map(|t| snapshot(j, *t)).collect())
                .collect(),
            velocities: Vec::new(),
            elements: mesh.elements.clone(),
            times,
        });
        collection.map_err(|error| error.to_string())
    }

    fn refused(change: impl Fn(Node, usize, f64) -> Node, words: &[&str]) {
        let error = moving(change).expect_err("refused");
        assert!(words.iter().all(|word| error.contains(word)), "{error}");
    }

    const LAST: &str = "configuration 2 (flow = 1)";

    #[test]
    fn the_reference_is_the_mean_initial_shape_about_its_centroid() {
        // The last of three unit spheres is wider, and starts elsewhere.
        let collection = moving(|[x, y, z], _, _| [x + 3.0, 1.3 * y, 1.3 * z]).unwrap();
        let (mesh, radius) = collection.reference().unwrap();
        let sphere = octahedral(4);
        for (found, [x, y, z]) in mesh.nodes.iter().zip(&sphere.nodes) {
            let expected = [*x, 1.1 * y, 1.1 * z];
            assert!(
                (0..3).all(|d| (found[d] - expected[d]).abs() < 1e-12),
                "{found:?} {expected:?}"
            );
        }
        let (volume, _) = sphere.volume_and_centroid(&sphere.nodes).unwrap();
        let expected = (0.75 * 1.1 * 1.1 * volume / std::f64::consts::PI).cbrt();
        assert!((radius - expected).abs() < 1e-12, "{radius} {expected}");
    }

    #[test]
    fn any_unit_and_any_origin_along_the_channel_will_do() {
        for unit in [1e-140, 1e-6, 1.0, 1e90] {
            let mut collection = moving(|node, _, _| node).unwrap();
            let nodes = collection.positions.iter_mut().flatten().flatten();
            nodes.for_each(|node| *node = [unit * (node[0] + 1e4), unit * node[1], unit * node[2]]);
            collection.velocities.clear();
            Collection::new(collection).unwrap();
        }
    }

    #[test]
    fn the_volume_of_a_flat_mesh_is_that_of_the_quadrature() {
        let quadratic = octahedral(4);
        let flat = |&[a, b, c, ..]: &[u32; 6]| [a, b, c, a, b, c];
        let mesh = Mesh {
            elements: quadratic.elements.iter().map(flat).collect(),
            nodes: quadratic.nodes,
        };
        let positions: Vec<Node> = mesh
            .nodes
            .iter()
            .map(|[x, y, z]| [2.0 * x + 0.3, y + 0.1 * x * x, *z])
            .collect();
        let (expected, _) = mesh.volume_and_centroid(&positions).unwrap();
        let found = volume(&mesh, &positions).unwrap();
        assert!((found - expected).abs() < 1e-12, "{found} {expected}");
    }

    #[test]
    fn a_periodic_domain_must_be_unwrapped() {
        // Whole nodes that leave [-1.5, 1.5] come in again at the other end.
        let wrap = |x: f64| x - 3.0 * ((x + 1.5) / 3.0).floor();
        refused(
            |[x, y, z], _, _| [wrap(x), y, z],
            &["`positions`", LAST, "t = 0.5 (snapshot 1)", "edge (", "periodic"],
        );
        // A single node, and the capsule as a whole once its centre is out.
        refused(
            |[x, y, z], n, t| [x - if n == 7 && t == 1.0 { 9.0 } else { 0.0 }, y, z],
            &[LAST, "snapshot 2", "7"],
        );
        let whole = |[x, y, z]: Node, _, t: f64| [x - if t > 1.2 { 6.0 } else { 0.0 }, y, z];
        refused(whole, &[LAST, "t = 1.5 (snapshot 3)", "jumped by -5.25"]);
        let early = |[x, y, z]: Node, _, t: f64| [x - if t > 0.2 { 6.0 } else { 0.0 }, y, z];
        refused(early, &["t = 0.5 (snapshot 1)", "jumped by -5.25"]);
    }

    #[test]
    fn a_motion_back_and_forth_is_no_jump() {
        moving(|[x, y, z], _, t| [x - 1.5 * t + 6.0 * (1.3 * t).sin(), y, z]).unwrap();
    }

    #[test]
    fn volumes_must_be_positive_and_alike() {
        let grown = |t: f64| 1.0 + 0.3 * t;
        moving(|node, _, t| node.map(|x| x * grown(t.min(2.0)))).unwrap();
        refused(
            |node, _, t| node.map(|x| x * grown(t)),
            &[LAST, "t = 3.5 (snapshot 7)", "factor of 8"],
        );
        let inward = |[x, y, z]: Node, _, t: f64| if t == 2.0 { [x, y, -z] } else { [x, y, z] };
        refused(inward, &[LAST, "t = 2 (snapshot 4)", "volume -4.18"]);
        refused(|[x, y, _], _, t| [x, y, 0.1 * t], &[LAST, "snapshot 0", "no volume"]);
        refused(
            |node, _, _| node.map(|x| 1e-3 * x),
            &[LAST, "same unit of length", "9.997e-4"],
        );
        refused(|[x, y, z], _, _| [x, y, z + 150.0], &[LAST, "z = 150", "axis"]);
    }
}
