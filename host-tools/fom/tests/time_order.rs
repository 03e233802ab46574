//! Order of convergence in time of each integrator on a capsule: the coarse sphere in simple shear.

use capsule_fom::flow::{Background, FreeSpace};
use capsule_fom::integrator::{FixedStep, Rkc2, Scheme, State, Stepper};
use capsule_fom::system::{Capsule, Discretisation};
use capsule_fom::{EvaluationError, MembraneDiscretisation, MembraneLaw};

/// The flat state at t = 0.32.
fn end_state(mut stepper: impl Stepper<EvaluationError>) -> Vec<f64> {
    let discretisation =
        Discretisation::new(2, false, MembraneDiscretisation::default(), MembraneLaw::default()).unwrap();
    let flow = FreeSpace::new(Background::Shear { rate: 1.0 });
    let mut capsule = Capsule::new(&discretisation, &flow, 0.3, 1.0);
    let value = capsule.initial_value();
    let mut rate = |value: &[f64], rate: &mut [f64]| capsule.rate(value, rate);
    let mut state = State::new(0.0, value, &mut rate).unwrap();
    while state.time < 0.32 {
        stepper.step(&mut rate, &mut state, 0.32).unwrap();
    }
    state.value
}

fn difference(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
}

#[test]
fn every_scheme_converges_with_its_order_to_the_same_motion() {
    let reference = end_state(FixedStep::new(Scheme::Ralston, 1e-3));
    let orders = |errors: [f64; 3]| [(errors[0] / errors[1]).log2(), (errors[1] / errors[2]).log2()];
    let steps = [0.016, 0.008, 0.004];

    let euler = steps.map(|step| difference(&end_state(FixedStep::new(Scheme::ForwardEuler, step)), &reference));
    assert!(orders(euler).iter().all(|order| (order - 1.0).abs() < 0.1), "{euler:?}");

    let ralston = steps.map(|step| difference(&end_state(FixedStep::new(Scheme::Ralston, step)), &reference));
    assert!(
        orders(ralston).iter().all(|order| (order - 2.0).abs() < 0.3),
        "{ralston:?}"
    );

    // Without error control, at the greatest step; at these steps with the same number of stages.
    let rkc2 = [0.02, 0.01, 0.005].map(|step| difference(&end_state(Rkc2::new(f64::INFINITY, step)), &reference));
    assert!(orders(rkc2).iter().all(|order| (order - 2.0).abs() < 0.3), "{rkc2:?}");
}
