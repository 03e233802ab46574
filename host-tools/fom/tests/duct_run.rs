//! Whole runs in a coarse duct.

use std::ops::ControlFlow;

use capsule_fom::flow::{DuctSettings, MembraneQuadrature, Precision};
use capsule_fom::{Configuration, FomError, Integrator, Outcome, Run, RunState, Settings, Solver, Status};

fn settings() -> Settings {
    Settings {
        mesh_frequency: 3,
        end_time: 0.4,
        duct: DuctSettings::coarse(),
        ..Settings::default()
    }
}

fn run(settings: Settings, configuration: Configuration) -> Result<Outcome, FomError> {
    Solver::new(settings)?.run(&configuration, &mut |_| ControlFlow::Continue(()))
}

const CONFIGURATION: Configuration = Configuration {
    capillary_number: 0.1,
    confinement: 0.85,
};

fn difference(a: &[[f64; 3]], b: &[[f64; 3]]) -> f64 {
    a.iter()
        .flatten()
        .zip(b.iter().flatten())
        .map(|(a, b)| (a - b).abs())
        .fold(0.0, f64::max)
}

#[test]
fn an_eighth_of_the_capsule_moves_like_the_whole() {
    let fixed = Settings {
        integrator: Integrator::Ralston { step: 5e-3 },
        // Without what depends on how the nodes are grouped.
        duct: DuctSettings {
            precision: Precision::Double,
            membrane: MembraneQuadrature {
                far: 50.0,
                ..MembraneQuadrature::default()
            },
            ..DuctSettings::coarse()
        },
        ..settings()
    };
    let reduced = run(fixed.clone(), CONFIGURATION).unwrap();
    let whole = run(
        Settings {
            symmetric: false,
            ..fixed
        },
        CONFIGURATION,
    )
    .unwrap();
    assert_eq!(reduced.times, whole.times);
    for (a, b) in reduced.positions.iter().zip(&whole.positions) {
        assert!(difference(a, b) < 1e-8, "{}", difference(a, b));
    }
    for (a, b) in reduced.velocities.iter().zip(&whole.velocities) {
        assert!(difference(a, b) < 1e-7, "{}", difference(a, b));
    }
}

#[test]
fn integrators_agree_and_snapshots_are_consistent() {
    let ralston = run(
        Settings {
            integrator: Integrator::Ralston { step: 2e-3 },
            ..settings()
        },
        CONFIGURATION,
    )
    .unwrap();
    let rkc2 = run(settings(), CONFIGURATION).unwrap();
    assert_eq!(rkc2.times, settings().snapshot_times());
    let last = rkc2.times.len() - 1;
    assert_eq!(rkc2.status, Status::Unsteady);
    assert!(difference(&ralston.positions[last], &rkc2.positions[last]) < 1e-3);
    assert!(rkc2.velocity_evaluations < ralston.velocity_evaluations);
    assert!(rkc2.volume_drift < 1e-5 && ralston.volume_drift < 1e-5);
    // The film is what the widest instant leaves.
    let reach = |positions: &[[f64; 3]]| {
        positions
            .iter()
            .flat_map(|x| [x[1].abs(), x[2].abs()])
            .fold(0.0, f64::max)
    };
    let widest = (0..=last).max_by(|i, j| reach(&rkc2.positions[*i]).total_cmp(&reach(&rkc2.positions[*j])));
    let widest = widest.unwrap();
    assert_eq!(rkc2.thinnest_film.time, rkc2.times[widest]);
    assert!((rkc2.thinnest_film.thickness - (1.0 - reach(&rkc2.positions[widest]))).abs() < 1e-14);
    // The centroid moves downstream, slower than the undisturbed flow on the axis, and costs pressure.
    assert!(rkc2.centroid[0] == 0.0 && rkc2.centroid[last] > 0.4 && rkc2.centroid[last] < 0.84);
    assert!(rkc2.pressure_drop[last] > 0.0 && rkc2.history.pressure_drop == rkc2.pressure_drop);
    // Profiles are in the frame of the centroid and fit the history.
    let [front, rear] = [rkc2.profile_midplane.first(), rkc2.profile_midplane.last()].map(|p| p.unwrap()[0]);
    assert!((front - rear - (rkc2.history.axial_length[last] - rkc2.history.rear_depth[last])).abs() < 0.02);
    assert!(front > 0.0 && rear < 0.0);
}

#[test]
fn a_long_fixed_step_is_refused_with_the_limit() {
    let long = Settings {
        integrator: Integrator::ForwardEuler { step: 0.1 },
        ..settings()
    };
    let error = run(long, CONFIGURATION).unwrap_err();
    let FomError::UnstableStep { step, limit, .. } = error else {
        panic!("{error}")
    };
    assert_eq!(step, 0.1);
    // The spectral radius is about 10 n / Ca.
    assert!((1e-3..0.05).contains(&limit), "{limit}");
}

#[test]
fn bad_parameters_are_refused() {
    let at = |capillary_number, confinement| Configuration {
        capillary_number,
        confinement,
    };
    assert!(matches!(
        run(settings(), at(f64::NAN, 0.9)),
        Err(FomError::NotPositive { .. })
    ));
    assert!(matches!(
        run(settings(), at(0.1, -0.9)),
        Err(FomError::NotPositive { .. })
    ));
    // An ellipsoid longer than the duct.
    assert!(matches!(run(settings(), at(0.1, 1.6)), Err(FomError::TooLong { .. })));
    let coarse = Settings {
        mesh_frequency: 1,
        ..settings()
    };
    assert!(matches!(
        run(coarse, CONFIGURATION),
        Err(FomError::MeshFrequency { frequency: 1 })
    ));
    let mut short = settings();
    short.duct.half_length = -1.0;
    assert!(matches!(run(short, CONFIGURATION), Err(FomError::Duct(_))));
}

#[test]
fn a_run_that_cannot_go_on_keeps_its_snapshots() {
    // The soft capsule grows until it comes too close to the ends of a short duct.
    let mut short = settings();
    short.end_time = 3.0;
    short.duct.half_length = 2.2;
    let soft = Configuration {
        capillary_number: 0.3,
        confinement: 0.95,
    };
    let outcome = run(short, soft).unwrap();
    let Status::Stopped { time, reason } = &outcome.status else {
        panic!("{:?}", outcome.status)
    };
    assert!(reason.contains("end of the duct"), "{reason}");
    assert!(outcome.times.len() > 1 && *time >= outcome.times[outcome.times.len() - 1]);
    assert_eq!(outcome.positions.len(), outcome.times.len());
}

#[test]
fn the_observer_may_interrupt() {
    let solver = Solver::new(settings()).unwrap();
    let mut steps = 0;
    let outcome = solver
        .run(&CONFIGURATION, &mut |progress| {
            steps += 1;
            assert_eq!(progress.steps, steps);
            if progress.t > 0.25 {
                ControlFlow::Break(())
            } else {
                ControlFlow::Continue(())
            }
        })
        .unwrap();
    assert!(matches!(outcome.status, Status::Stopped { time, .. } if time > 0.25));
    let before: Vec<f64> = settings().snapshot_times().into_iter().filter(|&t| t < 0.25).collect();
    assert_eq!(outcome.times, before);
}

#[test]
fn a_small_stiff_capsule_becomes_steady_with_the_velocity_of_a_sphere() {
    let small = Configuration {
        capillary_number: 0.02,
        confinement: 0.2,
    };
    let outcome = run(
        Settings {
            end_time: 4.0,
            duct: DuctSettings::default(),
            ..settings()
        },
        small,
    )
    .unwrap();
    assert!(matches!(outcome.status, Status::Steady { .. }), "{:?}", outcome.status);
    // u_max less the Faxen correction: 2.0488 V.
    let velocity = outcome.history.centroid_velocity.last().unwrap();
    assert!((velocity - 2.0488).abs() < 5e-3, "{velocity}");
}

#[test]
fn an_interrupted_and_saved_run_ends_like_an_undisturbed_one() {
    for integrator in [Integrator::Rkc2 { tolerance: 1e-4 }, Integrator::Ralston { step: 5e-3 }] {
        let solver = Solver::new(Settings {
            mesh_frequency: 2,
            end_time: 0.3,
            integrator,
            ..settings()
        })
        .unwrap();
        let whole = solver.run(&CONFIGURATION, &mut |_| ControlFlow::Continue(())).unwrap();
        let mut run = solver.start(&CONFIGURATION).unwrap();
        let outcome = loop {
            let mut steps = 0;
            let state = solver.resume(run, &mut |_| {
                steps += 1;
                if steps == 3 {
                    ControlFlow::Break(())
                } else {
                    ControlFlow::Continue(())
                }
            });
            match state.unwrap() {
                RunState::Finished(outcome) => break *outcome,
                RunState::Interrupted(saved) => {
                    run = postcard::from_bytes(&postcard::to_stdvec(&saved).unwrap()).unwrap()
                }
            }
        };
        let timeless = |outcome| Outcome {
            wall_time_s: 0.0,
            ..outcome
        };
        assert!(timeless(outcome) == timeless(whole), "{integrator:?}");
    }
}

#[test]
fn a_saved_run_of_another_mesh_is_refused() {
    let of = |mesh_frequency| {
        Solver::new(Settings {
            mesh_frequency,
            ..settings()
        })
        .unwrap()
    };
    let run: Run = of(2).start(&CONFIGURATION).unwrap();
    let error = of(3).resume(run, &mut |_| ControlFlow::Continue(())).unwrap_err();
    assert!(matches!(error, FomError::AnotherRun { .. }), "{error}");
}

#[test]
fn a_capsule_too_long_for_the_duct_is_refused_with_the_limit() {
    let solver = Solver::new(settings()).unwrap();
    let start = |confinement| {
        solver.start(&Configuration {
            confinement,
            ..CONFIGURATION
        })
    };
    let Err(FomError::TooLong { limit, .. }) = start(2.0) else {
        panic!("it fits")
    };
    assert!(limit > 1.2 && limit < 2.0 && start(1.001 * limit).is_err(), "{limit}");
    assert!(!matches!(start(0.999 * limit), Err(FomError::TooLong { .. })));
}
