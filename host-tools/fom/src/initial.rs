//! The initial shape of a capsule.

use crate::Mesh;

/// The greatest semi-minor axis of the start (in l): larger capsules are pre-deformed to fit in the channel.
pub const MAX_SEMI_MINOR_AXIS: f64 = 0.9;

/// The semi-axes along and across the channel of the start for a confinement `a/l`: a prolate ellipsoid of the
/// sphere's volume with semi-minor axes `min(a/l, 0.9)`.
///
/// The paper starts from a sphere below a/l = 0.95 and from an ellipsoid at its samples from there on (caption of
/// Fig. 3); this rule is the same at those samples and continuous between.
pub fn semi_axes(confinement: f64) -> [f64; 2] {
    let minor = confinement.min(MAX_SEMI_MINOR_AXIS);
    [confinement * (confinement / minor) * (confinement / minor), minor]
}

/// The confinement whose start has this semi-axis along the channel: the greatest one that fits in it.
pub fn greatest_confinement(semi_axis: f64) -> f64 {
    let square = MAX_SEMI_MINOR_AXIS * MAX_SEMI_MINOR_AXIS;
    semi_axis.min((semi_axis * square).cbrt())
}

/// The node positions of the start, centred on the origin.
pub fn positions(mesh: &Mesh, confinement: f64) -> Vec<[f64; 3]> {
    let [major, minor] = semi_axes(confinement);
    mesh.nodes
        .iter()
        .map(|&[x, y, z]| [major * x, minor * y, minor * z])
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::surface::Moments;

    #[test]
    fn the_volume_is_that_of_the_sphere() {
        let mesh = Mesh::octahedral(4).unwrap();
        let unit = Moments::of(&mesh.elements, &mesh.nodes).volume;
        for confinement in [0.2, 0.9, 0.925, 1.2_f64] {
            let volume = Moments::of(&mesh.elements, &positions(&mesh, confinement)).volume;
            assert!((volume / (unit * confinement.powi(3)) - 1.0).abs() < 1e-13);
            assert!(semi_axes(confinement)[1] <= 0.9);
        }
        assert_eq!(semi_axes(0.8), [0.8, 0.8]);
    }

    #[test]
    fn the_greatest_confinement_is_the_inverse_of_the_length() {
        for confinement in [0.5, 0.9, 1.0, 1.25] {
            let [length, _] = semi_axes(confinement);
            assert!((greatest_confinement(length) - confinement).abs() < 1e-14);
        }
    }
}
