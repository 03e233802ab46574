//! The silhouette against surfaces whose projection is known, and against the meridians of a dented one.

use crate::common::Family;
use capsule_core::{EvaluateError, Model, silhouette, silhouette_derivatives};

const COUNT: usize = 65;

/// Silhouette of a surface that a map of the unit sphere gives, on the mesh of a frequency.
fn seen(frequency: i32, angle: f64, surface: impl Fn([f64; 3]) -> [f64; 3]) -> [[f64; 2]; COUNT] {
    let family = Family::new(frequency);
    let file = family.file();
    let model = Model::open(&file).unwrap();
    let mesh = model.mesh();
    let positions: Vec<_> = family.sphere.nodes.iter().map(|&node| surface(node)).collect();
    let mut normals = vec![[0.0; 3]; mesh.sector_nodes().len()];
    let mut out = [[0.0; 2]; COUNT];
    silhouette(&mesh, &positions, [angle.cos(), angle.sin()], &mut normals, &mut out).unwrap();
    out
}

/// The ray on which point number k lies, from the middle of the extent.
fn ray(k: usize) -> [f64; 2] {
    let half = (COUNT - 1) as f64 / 2.0;
    let u = k as f64 / half;
    let angle = if u <= 1.0 {
        2.0 * u.atan()
    } else {
        std::f64::consts::PI - 2.0 * (2.0 - u).atan()
    };
    [angle.cos(), angle.sin()]
}

/// How far out the rays meet a surface, by its meridians: each is cut where it crosses a ray.
fn met(angle: f64, middle: f64, surface: impl Fn([f64; 3]) -> [f64; 3]) -> Vec<f64> {
    const LATITUDES: usize = 600;
    let mut greatest = vec![0.0_f64; COUNT];
    let rays: Vec<f64> = (0..COUNT).map(|k| ray(k)[1].atan2(ray(k)[0])).collect();
    for j in 0..4 * LATITUDES {
        let phi = std::f64::consts::PI * j as f64 / (2 * LATITUDES) as f64;
        let mut before: Option<[f64; 2]> = None;
        for i in 0..=LATITUDES {
            let theta = std::f64::consts::PI * i as f64 / LATITUDES as f64;
            let [x, y, z] = surface([theta.cos(), theta.sin() * phi.cos(), theta.sin() * phi.sin()]);
            let (x, w) = (x - middle, angle.cos() * y + angle.sin() * z);
            // Rounding must not choose the side of the axis.
            let w = if w.abs() < 1e-12 { 0.0 } else { w };
            let place = [w.atan2(x), x.hypot(w)];
            if let Some(mut last) = before.replace(place) {
                let mut place = place;
                if (place[0] - last[0]).abs() > std::f64::consts::PI {
                    // Through the axis behind: angles beyond pi.
                    for angle in [&mut place[0], &mut last[0]] {
                        *angle = angle.rem_euclid(std::f64::consts::TAU);
                    }
                }
                let (low, high) = (last[0].min(place[0]) - 1e-9, last[0].max(place[0]) + 1e-9);
                for k in rays.partition_point(|ray| *ray < low)..rays.partition_point(|ray| *ray <= high) {
                    let share = ((rays[k] - last[0]) / (place[0] - last[0])).clamp(0.0, 1.0);
                    let radius = last[1] + share * (place[1] - last[1]);
                    greatest[k] = greatest[k].max(if radius.is_finite() { radius } else { last[1] });
                }
            }
        }
    }
    greatest
}

#[test]
fn an_ellipsoid_is_seen_as_an_ellipse() {
    let (a, b) = (1.3, 0.8);
    for frequency in [4, 13] {
        for angle in [0.0, std::f64::consts::FRAC_PI_4, 0.3] {
            let out = seen(frequency, angle, |[x, y, z]| [0.7 + a * x, b * y, b * z]);
            let mut worst = 0.0_f64;
            for (k, [x, w]) in out.into_iter().enumerate() {
                let [c, s] = ray(k);
                let radius = 1.0 / (c / a).hypot(s / b);
                worst = worst.max((x - 0.7 - radius * c).abs().max((w - radius * s).abs()));
            }
            // Along the mirror planes the rim runs through nodes, elsewhere between them.
            let fine = if angle == 0.3 { 5e-4 } else { 1e-4 };
            assert!(
                worst < if frequency == 4 { 5e-3 } else { fine },
                "{frequency} {angle}: {worst}"
            );
        }
    }
}

#[test]
fn a_dented_square_surface_is_seen_as_far_as_its_meridians_reach() {
    // Flattened towards the walls, with a dent behind whose rim reaches farther back in the corners.
    let surface = |[x, y, z]: [f64; 3]| {
        let across = y * y + z * z;
        let square = 4.0 * y * y * z * z;
        let dent = 0.6 * (1.0 - across).powi(2) * x.min(0.0).powi(4);
        let radius = 0.8 * (1.0 + 0.15 * square - 0.1 * across * x * x);
        [1.1 * x + dent - 0.1 * square * x, radius * y, radius * z]
    };
    // Angles at which a meridian lies in the plane of the line of sight and the axis.
    for angle in [0.0, std::f64::consts::FRAC_PI_4, std::f64::consts::FRAC_PI_6] {
        let mut errors = [0.0_f64; 2];
        for (error, frequency) in errors.iter_mut().zip([8, 16]) {
            let out = seen(frequency, angle, surface);
            let extent = Family::new(frequency)
                .sphere
                .nodes
                .iter()
                .fold([f64::INFINITY, -1.0], |[low, high], node| {
                    let [x, ..] = surface(*node);
                    [low.min(x), high.max(x)]
                });
            let middle = 0.5 * (extent[0] + extent[1]);
            for ([x, w], met) in out.into_iter().zip(met(angle, middle, surface)) {
                *error = error.max(((x - middle).hypot(w) - met).abs());
            }
        }
        let [coarse, fine] = errors;
        assert!(
            coarse < 4e-3 && fine < 5e-4 && fine < coarse / 4.0,
            "{angle}: {coarse} {fine}"
        );
    }
}

/// Greatest error of the movement of an ellipsoid's silhouette by its two axes, and by a flow of the membrane along its
/// surface, which moves nothing.
fn errors_of_movement(frequency: i32, angle: f64) -> [f64; 3] {
    let (a, b) = (1.3, 0.8);
    let family = Family::new(frequency);
    let file = family.file();
    let model = Model::open(&file).unwrap();
    let mesh = model.mesh();
    let nodes = &family.sphere.nodes;
    let positions: Vec<_> = nodes.iter().map(|[x, y, z]| [a * x, b * y, b * z]).collect();
    let by_a: Vec<_> = nodes.iter().map(|[x, ..]| [*x, 0.0, 0.0]).collect();
    let by_b: Vec<_> = nodes.iter().map(|[_, y, z]| [0.0, *y, *z]).collect();
    let along: Vec<_> = nodes.iter().map(|[x, y, _]| [-a * y, b * x, 0.0]).collect();
    let mut normals = vec![[0.0; 3]; mesh.sector_nodes().len()];
    let (mut out, mut plain, mut movement) = ([[0.0; 2]; COUNT], [[0.0; 2]; COUNT], [[[0.0; 2]; 3]; COUNT]);
    let (fields, across) = ([&*by_a, &*by_b, &*along], [angle.cos(), angle.sin()]);
    silhouette_derivatives(&mesh, &positions, fields, across, &mut normals, &mut out, &mut movement).unwrap();
    silhouette(&mesh, &positions, across, &mut normals, &mut plain).unwrap();
    assert_eq!(out, plain);
    let short = &mut movement[..4].to_vec();
    let error = silhouette_derivatives(&mesh, &positions, fields, across, &mut normals, &mut out, short);
    assert!(matches!(error, Err(EvaluateError::BufferTooShort { found: 4, .. })));
    let mut errors = [0.0_f64; 3];
    for ([x, w], found) in plain.into_iter().zip(movement) {
        // x^2 / a^2 + w^2 / b^2 = 1 moves by its change over the length of its gradient.
        let gradient = (x / (a * a)).hypot(w / (b * b));
        let normal = [x / (a * a) / gradient, w / (b * b) / gradient];
        let found = found.map(|[dx, dw]: [f64; 2]| dx * normal[0] + dw * normal[1]);
        let exact = [x * x / (a * a * a) / gradient, w * w / (b * b * b) / gradient, 0.0];
        (0..3).for_each(|d| errors[d] = errors[d].max((found[d] - exact[d]).abs()));
    }
    errors
}

#[test]
fn the_silhouette_moves_as_the_surface_does() {
    // Along the mirror planes the rim runs through nodes.
    for angle in [0.0, std::f64::consts::FRAC_PI_4] {
        let [coarse, fine] = [6, 12].map(|frequency| errors_of_movement(frequency, angle));
        for (coarse, fine) in coarse.into_iter().zip(fine) {
            // The error of the normals, which is of second order.
            assert!(fine < 0.4 * coarse || fine < 1e-6, "{angle}: {coarse:e} {fine:e}");
            assert!(fine < 1e-2, "{angle}: {fine:e}");
        }
    }
}

#[test]
fn what_does_not_fit_is_refused() {
    let family = Family::new(4);
    let file = family.file();
    let model = Model::open(&file).unwrap();
    let mesh = model.mesh();
    let positions = &family.sphere.nodes;
    let sector = mesh.sector_nodes().len();
    let ask = |positions: &[[f64; 3]], normals: usize, out: usize| {
        silhouette(
            &mesh,
            positions,
            [1.0, 0.0],
            &mut vec![[0.0; 3]; normals],
            &mut vec![[0.0; 2]; out],
        )
    };
    let short = |required, found| Err(EvaluateError::BufferTooShort { required, found });
    assert_eq!(
        ask(&positions[1..], sector, 9),
        short(positions.len(), positions.len() - 1)
    );
    assert_eq!(ask(positions, sector - 1, 9), short(sector, sector - 1));
    assert_eq!(ask(positions, sector, 2), short(3, 2));
    assert_eq!(ask(positions, sector, 3), Ok(()));
    let broken = vec![[f64::NAN; 3]; positions.len()];
    assert_eq!(ask(&broken, sector, 9), Err(EvaluateError::NotFinite));
}
