//! Closed curves from the unordered segments of the core's cross-section.

use capsule_core::{EvaluateError, Model, Segment, section};
use std::collections::BTreeMap;

/// Closed curves [y, z] of the surface in the plane at `x`, each given once around. A plane through the rear
/// cavity gives two; one that misses the surface gives none.
///
/// # Errors
/// Fewer positions than the mesh has nodes.
pub fn curves(model: &Model<'_>, positions: &[[f32; 3]], x: f32) -> Result<Vec<Vec<[f32; 2]>>, EvaluateError> {
    let mesh = model.mesh();
    let mut segments: Vec<Segment<f32>> = vec![[[0.0; 2]; 2]; 4 * mesh.elements().len()];
    let count = section(&mesh, positions, x, &mut segments)?;
    segments.truncate(count);
    Ok(chain(&segments))
}

/// Joins segments end to start; shared points have the same bits.
fn chain(segments: &[Segment<f32>]) -> Vec<Vec<[f32; 2]>> {
    let bits = |point: [f32; 2]| point.map(f32::to_bits);
    let mut next: BTreeMap<[u32; 2], [f32; 2]> = segments.iter().map(|[from, to]| (bits(*from), *to)).collect();
    let mut curves = Vec::new();
    while let Some((_, mut point)) = next.pop_first() {
        let mut curve = vec![point];
        while let Some(following) = next.remove(&bits(point)) {
            point = following;
            curve.push(point);
        }
        curves.push(curve);
    }
    curves
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The segments of a regular polygon, every `stride`-th one after another.
    fn polygon(corners: usize, radius: f32, stride: usize) -> Vec<Segment<f32>> {
        let corner = |i: usize| {
            let (sin, cos) = (std::f32::consts::TAU * (i % corners) as f32 / corners as f32).sin_cos();
            [radius * cos, radius * sin]
        };
        (0..corners)
            .map(|i| i * stride % corners)
            .map(|i| [corner(i), corner(i + 1)])
            .collect()
    }

    #[test]
    fn scattered_segments_of_two_rings_become_two_closed_curves() {
        let (outer, inner) = (polygon(64, 0.8, 27), polygon(40, 0.3, 7));
        let mixed: Vec<_> = inner.iter().chain(&outer).copied().collect();
        let mut curves = chain(&mixed);
        curves.sort_by_key(Vec::len);
        assert_eq!(curves.iter().map(Vec::len).collect::<Vec<_>>(), [40, 64]);
        for (curve, radius) in curves.iter().zip([0.3, 0.8]) {
            let side = 2.0 * radius * (std::f32::consts::PI / curve.len() as f32).sin();
            for (i, [y, z]) in curve.iter().enumerate() {
                let [next_y, next_z] = curve[(i + 1) % curve.len()];
                assert!((y.hypot(*z) - radius).abs() < 1e-6);
                assert!(
                    ((next_y - y).hypot(next_z - z) - side).abs() < 1e-6,
                    "consecutive points are neighbours"
                );
            }
        }
    }

    #[test]
    fn no_segments_no_curves_and_an_open_chain_ends() {
        assert!(chain(&[]).is_empty());
        assert_eq!(
            chain(&[[[0.0, 0.0], [1.0, 0.0]], [[1.0, 0.0], [1.0, 1.0]]]),
            [[[1.0, 0.0], [1.0, 1.0]]]
        );
    }
}
