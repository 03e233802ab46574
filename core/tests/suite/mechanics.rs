//! The mechanics of the membrane against exact deformations of the sphere.

use crate::common::{Arena, Family, Sphere, write};
use capsule_core::mechanics::{Deformation, Membrane, Stencil, undisturbed_velocity};
use capsule_core::{EvaluateError, Evaluator, Method, Model, Query, Real, Workspace};
use std::cell::{Cell, RefCell};

type Point = [f64; 3];

fn dot(a: Point, b: Point) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// The deformations of a sphere under a map, at every node of the sector.
fn deformations<T: Real>(sphere: &Sphere, map: fn(Point) -> Point) -> Vec<(Point, Deformation<T>)> {
    let single = |point: Point| point.map(T::from_f64);
    let positions: Vec<_> = sphere.nodes.iter().map(|&node| single(map(node))).collect();
    let nodes = sphere.nodes.iter().map(|&node| single(node));
    sphere
        .sector_nodes
        .iter()
        .map(|&node| {
            let node = usize::from(node);
            let stencil = Stencil::new(nodes.clone(), node).unwrap();
            (
                sphere.nodes[node],
                stencil.deformation(T::ONE, |i| Ok(positions[i])).unwrap(),
            )
        })
        .collect()
}

/// The load's greatest error over its greatest value, on meshes of rising frequency.
fn load_errors<T: Real>(frequencies: &[i32], map: fn(Point) -> Point, exact: fn(Point) -> Point) -> Vec<f64> {
    let error = |&frequency: &i32| {
        let found = deformations::<T>(&Sphere::new(frequency), map);
        let (mut error, mut scale) = (0.0_f64, 0.0_f64);
        for (point, deformation) in found {
            let load = deformation.load(T::ONE).unwrap().map(T::to_f64);
            let exact = exact(point);
            let difference: Point = std::array::from_fn(|d| load[d] - exact[d]);
            error = error.max(dot(difference, difference).sqrt());
            scale = scale.max(dot(exact, exact).sqrt());
        }
        error / scale
    };
    frequencies.iter().map(error).collect()
}

const STRETCH: f64 = 1.2;

fn inflated(point: Point) -> Point {
    point.map(|x| STRETCH * x)
}

/// Pressure 2 (lambda^-1 - lambda^-7).
fn inflation_load(point: Point) -> Point {
    point.map(|x| 2.0 * (STRETCH.powi(-1) - STRETCH.powi(-7)) * x)
}

/// A hollow, asymmetric shape.
fn hollow([x, y, z]: Point) -> Point {
    [
        x - 0.5 * (y * y + z * z) + 0.1 * x * y,
        0.85 * y * (1.0 - 0.1 * z * z),
        0.8 * z * (1.0 + 0.2 * x),
    ]
}

/// The load of [`hollow`] by the principle of virtual work in its strong form: differences of the first Piola-Kirchhoff
/// tension along two great circles, extended off the sphere so that the map depends on directions only.
fn hollow_load(point: Point) -> Point {
    let unit = |p: Point| p.map(|x| x / dot(p, p).sqrt());
    let map = |p: Point| hollow(unit(p));
    let step = 1e-4;
    // Gradient of the map at a point: columns by the Cartesian directions, zero along the radius.
    let gradient = |p: Point| -> [Point; 3] {
        std::array::from_fn(|d| {
            let at = |s: f64| map(std::array::from_fn(|i| p[i] + if i == d { s } else { 0.0 }));
            let (a, b, c, e) = (at(-2.0 * step), at(-step), at(step), at(2.0 * step));
            std::array::from_fn(|i| (a[i] - 8.0 * b[i] + 8.0 * c[i] - e[i]) / (12.0 * step))
        })
    };
    // Cartesian first Piola-Kirchhoff tension P = F - J^-2 F C^+ of a unit sphere, C^+ the inverse on the tangent
    // plane: with C's tangential invariants, C^+ = (tr C I_t - C) / det C.
    let tension = |p: Point| -> [Point; 3] {
        let n = unit(p);
        let f = gradient(n);
        let c: [Point; 3] = std::array::from_fn(|i| std::array::from_fn(|j| dot(f[i], f[j])));
        let trace = c[0][0] + c[1][1] + c[2][2];
        let square: f64 = c.iter().flatten().map(|x| x * x).sum();
        let determinant = 0.5 * (trace * trace - square);
        let s: [Point; 3] = std::array::from_fn(|i| {
            std::array::from_fn(|j| {
                let tangent = f64::from(i == j) - n[i] * n[j];
                tangent - (trace * tangent - c[i][j]) / (determinant * determinant)
            })
        });
        // Columns by the stress-free direction.
        std::array::from_fn(|j| std::array::from_fn(|d| (0..3).map(|i| f[i][d] * s[i][j]).sum()))
    };
    // The surface divergence of a tangential field that is constant along the radius is the Cartesian one.
    let mut load = [0.0; 3];
    let step = 1e-3;
    for j in 0..3 {
        let at = |s: f64| tension(std::array::from_fn(|i| point[i] + if i == j { s } else { 0.0 }))[j];
        let (a, b, c, e) = (at(-2.0 * step), at(-step), at(step), at(2.0 * step));
        for d in 0..3 {
            load[d] -= (a[d] - 8.0 * b[d] + 8.0 * c[d] - e[d]) / (12.0 * step);
        }
    }
    let f = gradient(point);
    let trace: f64 = f.iter().map(|&column| dot(column, column)).sum();
    let square: f64 = f.iter().flat_map(|&a| f.iter().map(move |&b| dot(a, b).powi(2))).sum();
    let dilation = (0.5 * (trace * trace - square)).sqrt();
    load.map(|x| x / dilation)
}

#[test]
fn load_of_the_inflated_sphere() {
    let errors = load_errors::<f64>(&[4, 8, 16], inflated, inflation_load);
    assert!(errors[1] < 3e-4 && errors[2] < 3e-5, "{errors:?}");
    assert!(errors[0] > 100.0 * errors[2], "more than third order: {errors:?}");
    let errors = load_errors::<f32>(&[8, 16], inflated, inflation_load);
    assert!(errors[0] < 5e-4 && errors[1] < 3e-4, "{errors:?}");
}

#[test]
fn load_of_a_hollow_shape() {
    let errors = load_errors::<f64>(&[4, 8, 16], hollow, hollow_load);
    assert!(errors[1] < 5e-4 && errors[2] < 3e-5, "{errors:?}");
    assert!(errors[0] > 100.0 * errors[2], "more than third order: {errors:?}");
    let errors = load_errors::<f32>(&[8, 16], hollow, hollow_load);
    assert!(errors[0] < 5e-4 && errors[1] < 3e-4, "{errors:?}");
}

/// Stretches, directions and tensions where they are known: on the ellipsoid's meridian in the plane y = 0, the
/// direction across it is that of y.
#[test]
fn stretches_and_directions_of_an_ellipsoid() {
    let map = |[x, y, z]: Point| [1.5 * x, 0.8 * y, 0.8 * z];
    let mut found = 0;
    for (node, deformation) in deformations::<f64>(&Sphere::new(13), map) {
        // The sector's edge z = 0 is a meridian, across it z.
        if node[2] != 0.0 {
            continue;
        }
        found += 1;
        let along = (1.5 * node[1]).hypot(0.8 * node[0]);
        let across = 0.8;
        let [greatest, least] = deformation.stretches();
        assert!((greatest - along.max(across)).abs() < 1e-4 && (least - along.min(across)).abs() < 1e-4);
        assert!((deformation.area_dilation() - along * across).abs() < 1e-4);
        let [first, second] = deformation.directions();
        assert!(dot(first, second).abs() < 1e-12);
        if (along - across).abs() > 0.05 {
            let lateral = if along > across { second } else { first };
            assert!(lateral[2].abs() > 1.0 - 1e-6, "{lateral:?}");
        }
    }
    assert_eq!(found, 2 * 26 + 1);
}

/// A model's capsule in the family's motion, in one precision.
fn membrane<T: Real>(family: &Family, check: impl Fn(&Model<'_>, Membrane<'_, '_, T>)) {
    let file = family.file();
    let model = Model::open(&file).unwrap();
    let mut workspace = Workspace::<T>::new();
    let mut evaluator = Evaluator::new(&model, &mut workspace).unwrap();
    let [capillary_number, confinement] = PARAMETERS.map(T::from_f64);
    evaluator
        .prepare(&Query::new([capillary_number, confinement], Method::Direct))
        .unwrap();
    let mut sector = vec![[T::ZERO; 3]; model.mesh().sector_nodes().len()];
    let mut instant = evaluator.at(T::from_f64(1.0)).unwrap();
    check(&model, instant.membrane(&mut sector).unwrap());
    let required = sector.len();
    assert_eq!(
        instant.membrane(&mut sector[1..]).unwrap_err(),
        EvaluateError::BufferTooShort {
            required,
            found: required - 1
        }
    );
}

const PARAMETERS: [f64; 2] = [0.05, 0.97];

#[test]
fn a_membrane_of_another_law_has_no_mechanics() {
    let family = Family::new(2);
    let mut arena = Arena::default();
    let mut contents = family.contents(&mut arena);
    contents.metadata.membrane_law = "Skalak, C = 1";
    let file = write(&contents);
    let model = Model::open(&file).unwrap();
    let mut workspace = Workspace::<f64>::new();
    let mut evaluator = Evaluator::new(&model, &mut workspace).unwrap();
    evaluator.prepare(&Query::new(PARAMETERS, Method::Direct)).unwrap();
    let mut sector = vec![[0.0; 3]; model.mesh().sector_nodes().len()];
    let mut instant = evaluator.at(1.0).unwrap();
    assert_eq!(
        instant.membrane(&mut sector).unwrap_err(),
        EvaluateError::UnsupportedReference
    );
}

#[test]
fn totals_are_the_integrals_of_the_nodal_values() {
    let errors = [4, 8].map(|frequency| {
        let family = Family::new(frequency);
        let errors = Cell::new([0.0; 4]);
        membrane::<f64>(&family, |model, membrane| {
            let [area, energy, pressure_drop, force] = integrals(&family, model, &membrane);
            let totals = membrane.totals().unwrap();
            let error = |found: f64, exact: f64| (found / exact - 1.0).abs();
            errors.set([
                error(totals.area, area),
                error(totals.energy, energy),
                error(totals.pressure_drop, pressure_drop),
                // No force without inertia.
                force / pressure_drop.abs(),
            ]);
        });
        errors.get()
    });
    // The nodal rule is of second order.
    for (coarse, fine) in errors[0].iter().zip(errors[1]) {
        assert!(fine < 3e-2 && fine <= 0.4 * coarse, "{errors:?}");
    }
}

/// Area, energy, pressure drop and total force by the nodal values.
fn integrals(family: &Family, model: &Model<'_>, membrane: &Membrane<'_, '_, f64>) -> [f64; 4] {
    let [capillary_number, confinement] = PARAMETERS;
    let mesh = model.mesh();
    let weights = areas(&family.sphere);
    assert!((weights.iter().sum::<f64>() / (4.0 * std::f64::consts::PI) - 1.0).abs() < 1e-12);
    let [exact, _] = family.exact(PARAMETERS, 1.0);
    let (mut area, mut energy, mut power, mut force) = (0.0, 0.0, 0.0, [0.0; 3]);
    for node in 0..mesh.nodes() {
        let stencil = Stencil::at(&mesh, node).unwrap();
        assert_eq!(stencil.node(), node);
        let deformation = membrane.deformation(&stencil).unwrap();
        let weight = weights[node] * confinement * confinement;
        let current = weight * deformation.area_dilation();
        area += current;
        energy += weight * deformation.energy_density();
        let load = deformation.load(capillary_number).unwrap();
        (0..3).for_each(|d| force[d] += current * load[d]);
        power += current * load[0] * undisturbed(exact[node]);
        // The node's representative tells the same.
        let (index, operation) = mesh.origin(node).unwrap();
        let stencil = Stencil::at(&mesh, mesh.sector_nodes().get(index).unwrap()).unwrap();
        let carried = membrane.deformation(&stencil).unwrap().transformed(operation);
        let carried = carried.load(capillary_number).unwrap();
        let difference: Point = std::array::from_fn(|d| carried[d] - load[d]);
        assert!(
            dot(difference, difference) < 1e-10 * dot(load, load),
            "{node} {carried:?} {load:?}"
        );
    }
    [area, energy, power / 4.0, dot(force, force).sqrt()]
}

/// Area of the unit sphere that each node stands for: a third of the spherical triangles between neighbours.
fn areas(sphere: &Sphere) -> Vec<f64> {
    let mut areas = vec![0.0; sphere.nodes.len()];
    for element in &sphere.elements {
        for corners in [[0, 3, 5], [3, 1, 4], [5, 4, 2], [3, 4, 5]] {
            let [a, b, c] = corners.map(|corner| sphere.nodes[usize::from(element[corner])]);
            // Solid angle of a spherical triangle (van Oosterom and Strackee, 1983).
            let triple = a[0] * (b[1] * c[2] - b[2] * c[1])
                + a[1] * (b[2] * c[0] - b[0] * c[2])
                + a[2] * (b[0] * c[1] - b[1] * c[0]);
            let solid = 2.0 * triple.atan2(1.0 + dot(a, b) + dot(b, c) + dot(c, a));
            for corner in corners {
                areas[usize::from(element[corner])] += solid / 3.0;
            }
        }
    }
    areas
}

#[test]
fn the_undisturbed_flow_is_that_of_the_series_with_mean_velocity_1() {
    // By the midpoint rule over a quarter of the section.
    let count = 40;
    let at = |i: usize| (i as f64 + 0.5) / count as f64;
    let mut mean = 0.0;
    for (i, j) in (0..count).flat_map(|i| (0..count).map(move |j| (i, j))) {
        let found: f64 = undisturbed_velocity(at(i), at(j));
        assert!((found - undisturbed([0.0, at(i), at(j)])).abs() < 2e-3, "{i} {j}");
        mean += found / (count * count) as f64;
    }
    assert!((mean - 1.0).abs() < 1e-3, "{mean}");
}

/// Undisturbed flow by the double sine series.
fn undisturbed([_, y, z]: Point) -> f64 {
    let k = |n: usize| (n as f64 + 0.5) * std::f64::consts::PI;
    let mut sum = 0.0;
    for m in 0..30 {
        for n in 0..30 {
            let (a, b) = (k(m), k(n));
            let sign = if (m + n) % 2 == 0 { 4.0 } else { -4.0 };
            sum += sign / (a * b * (a * a + b * b)) * (a * y).cos() * (b * z).cos();
        }
    }
    7.113_538_44 * sum
}

/// All local quantities at a node and the totals.
fn readings<T: Real>(family: &Family) -> Vec<f64> {
    let readings = RefCell::new(Vec::new());
    membrane::<T>(family, |model, membrane| {
        let capillary_number = T::from_f64(PARAMETERS[0]);
        for node in [0, 57, 100, 333] {
            let deformation = membrane
                .deformation(&Stencil::at(&model.mesh(), node).unwrap())
                .unwrap();
            let scalars = [deformation.area_dilation(), deformation.energy_density()];
            let pairs = [deformation.stretches(), deformation.tensions()];
            let all = scalars.iter().chain(pairs.as_flattened());
            let load = deformation
                .load(capillary_number)
                .unwrap()
                .map(|x| x / T::from_f32(30.0));
            readings.borrow_mut().extend(all.copied().chain(load).map(T::to_f64));
        }
        let totals = membrane.totals().unwrap();
        readings
            .borrow_mut()
            .extend([totals.area, totals.energy, totals.pressure_drop].map(T::to_f64));
        let few = Stencil::<T>::new([[T::ONE, T::ZERO, T::ZERO]; 14].into_iter(), 3);
        assert_eq!(few.unwrap_err(), EvaluateError::StencilTooSmall { node: 3 });
        let unknown = EvaluateError::UnknownNode {
            node: 1026,
            nodes: 1026,
        };
        assert_eq!(Stencil::<T>::at(&model.mesh(), 1026).unwrap_err(), unknown);
    });
    readings.into_inner()
}

#[test]
fn single_precision_agrees() {
    let family = Family::new(8);
    let (single, double) = (readings::<f32>(&family), readings::<f64>(&family));
    for (index, (a, b)) in single.iter().zip(&double).enumerate() {
        assert!((a - b).abs() < 5e-5, "reading {index}: {a} {b}");
    }
}
