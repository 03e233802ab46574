//! Contours found in pictures that are drawn from known outlines: with blur, noise, uneven light and walls.

mod scene;

use capsule_contour::{Axis, Edge, Flow, Found, Picture, PictureError, Settings};
use image::ImageFormat;
use scene::{Outline, Scene, floats};

fn find(scene: &Scene, background: Option<&Scene>) -> Result<Found, PictureError> {
    let picture = Picture::read(&scene.png()).unwrap();
    let background = background.map(|scene| Picture::read(&scene.png()).unwrap());
    picture.capsules(background.as_ref(), &Settings::default())
}

fn one(scene: &Scene) -> Found {
    let found = find(scene, None).unwrap();
    assert_eq!(found.capsules.len(), 1);
    found
}

/// An ellipse off the pixels' grid.
fn ellipse() -> Outline {
    Outline::new([141.3, 92.7], |angle| [61.0 * angle.cos(), 48.0 * angle.sin()])
}

/// A capsule that flows to the right, with a dent behind.
fn dented() -> Outline {
    Outline::new([141.3, 92.7], |angle| {
        let (x, y) = (58.0 * angle.cos(), 52.0 * angle.sin());
        let behind = (y / 22.0_f64).powi(2);
        let dent = if x < 0.0 { 24.0 * (-behind).exp() } else { 0.0 };
        [x + dent, y * (1.0 - 0.2 * x / 58.0)]
    })
}

#[test]
fn a_smooth_outline_is_found_to_a_tenth_of_a_pixel() {
    let dark = Scene::of([ellipse()]);
    let bright = Scene {
        contrast: 0.25,
        ..dark.clone()
    };
    for scene in [&dark, &bright] {
        let found = one(scene);
        let error = ellipse().error(&found.capsules[0].points);

        assert!(error < 0.1, "{error}");
        assert_eq!(
            (found.axis, found.edge, found.cut),
            (Axis::Horizontal, Edge::Gradient, 0)
        );
        let walls = found.walls.unwrap();
        assert!((walls.distance / scene.apart() - 1.0).abs() < 0.005, "{walls:?}");
        // An ellipse has no front.
        assert_eq!(found.capsules[0].flow, None);
    }
}

#[test]
fn noise_of_a_fifteenth_of_the_contrast_costs_a_fifth_of_a_pixel() {
    let faint = Scene {
        contrast: -0.12,
        blur: 2.0,
        ..Scene::of([ellipse()])
    };
    let found = one(&faint);
    let error = ellipse().error(&found.capsules[0].points);

    assert!(error < 0.2, "{error}");
    let walls = found.walls.unwrap();
    assert!((walls.distance / faint.apart() - 1.0).abs() < 0.005, "{walls:?}");
}

#[test]
fn both_edges_agree_on_a_symmetric_blur() {
    let picture = Picture::read(&Scene::of([ellipse()]).png()).unwrap();
    for edge in [Edge::Gradient, Edge::HalfLevel] {
        let settings = Settings {
            edge: Some(edge),
            ..Settings::default()
        };
        let found = picture.capsules(None, &settings).unwrap();
        let error = ellipse().error(&found.capsules[0].points);

        assert!(error < 0.1 && found.edge == edge, "{edge:?}: {error}");
    }
}

#[test]
fn every_format_gives_the_same() {
    let scene = Scene::of([ellipse()]);
    for format in [ImageFormat::Png, ImageFormat::Tiff, ImageFormat::Jpeg] {
        let bytes = scene.encoded(format);
        assert!(Picture::is_one(&bytes));
        let found = Picture::read(&bytes)
            .unwrap()
            .capsules(None, &Settings::default())
            .unwrap();
        let error = ellipse().error(&found.capsules[0].points);

        assert!(error < 0.1, "{format:?}: {error}");
    }
}

#[test]
fn floating_point_levels_are_those_of_whole_numbers() {
    let scene = Scene::of([ellipse()]);
    let empty = Scene {
        outlines: Vec::new(),
        ..scene.clone()
    };
    let level = |grey: f32| 3000.0 * grey - 500.0;
    let picture = Picture::read(&floats(&scene, level)).unwrap();
    let background = Picture::read(&floats(&empty, level)).unwrap();
    for background in [None, Some(&background)] {
        let found = picture.capsules(background, &Settings::default()).unwrap();
        let whole = Picture::read(&scene.png()).unwrap();
        let empty = Picture::read(&empty.png()).unwrap();
        let same = whole
            .capsules(background.map(|_| &empty), &Settings::default())
            .unwrap();
        let (found, same) = (&found.capsules[0].points, &same.capsules[0].points);
        assert_eq!(found.len(), same.len());
        for (point, other) in found.iter().zip(same) {
            // Single precision.
            assert!(
                (point[0] - other[0]).hypot(point[1] - other[1]) < 1e-3,
                "{point:?} {other:?}"
            );
        }
    }

    let whole = Picture::read(&empty.png()).unwrap();
    let error = picture.capsules(Some(&whole), &Settings::default()).unwrap_err();
    assert_eq!(error, PictureError::Levels);
    let error = Picture::read(&floats(&scene, |_| f32::NAN)).unwrap_err();
    assert!(error.to_string().contains("column 1 and row 1"), "{error}");
}

#[test]
fn a_mask_is_found_by_its_half_level() {
    let mask = Scene {
        contrast: 1.0,
        binary: true,
        ..Scene::plain([dented()])
    };
    for scene in [
        mask.clone(),
        Scene {
            level: 1.0,
            contrast: -1.0,
            ..mask
        },
    ] {
        let found = one(&scene);
        let error = dented().error(&found.capsules[0].points);
        // A pixel is in or out: its edge is off by up to half a pixel, by 0.29 rms if it were not averaged.

        assert!(error < 0.2 && found.edge == Edge::HalfLevel, "{error}");
        assert_eq!(found.walls, None);
    }
}

#[test]
fn a_dent_and_the_direction_of_the_flow_are_found() {
    let scene = Scene::of([dented()]);
    for (turns, flow) in [(0, Flow::Right), (1, Flow::Down), (2, Flow::Left), (3, Flow::Up)] {
        let picture = Picture::read(&scene.turned(turns)).unwrap();
        let found = picture.capsules(None, &Settings::default()).unwrap();
        let points: Vec<_> = found.capsules[0]
            .points
            .iter()
            .map(|point| scene.back(*point, turns))
            .collect();
        let error = dented().error(&points);

        assert!(error < 0.1, "{error}");
        assert_eq!(found.capsules[0].flow, Some(flow));
        let walls = found.walls.unwrap();
        assert!((walls.distance / scene.apart() - 1.0).abs() < 0.005, "{walls:?}");
    }
}

#[test]
fn the_line_of_a_dent_is_seen_through_the_capsule() {
    let nose = Outline::new([141.3, 92.7], |angle| {
        let (x, y) = (58.0 * angle.cos(), 52.0 * angle.sin());
        [if x < 0.0 { 0.5 * x } else { x }, y]
    });
    let plain = Scene::of([nose]);
    let rear = 141.3 - 29.0;
    let lined = Scene {
        line: Some(rear + 17.4),
        ..plain.clone()
    };
    let dent = one(&lined).capsules[0].dent.unwrap();
    assert!((dent.depth - 17.4).abs() < 0.5, "{dent:?}");
    let found = one(&plain);
    assert_eq!(
        (found.capsules[0].dent, found.capsules[0].flow),
        (None, Some(Flow::Right))
    );
}

#[test]
fn a_channel_may_slope() {
    let slope = 0.02_f64;
    let scene = Scene {
        slope,
        ..Scene::of([ellipse()])
    };
    let found = one(&scene);
    let error = ellipse().error(&found.capsules[0].points);

    assert!(error < 0.1, "{error}");
    let walls = found.walls.unwrap();
    let apart = scene.apart() * slope.atan().cos();
    assert!((walls.distance / apart - 1.0).abs() < 0.005, "{walls:?}, {apart}");
}

#[test]
fn several_capsules_are_told_apart() {
    let behind = Outline::new([330.4, 88.2], |angle| [50.0 * angle.cos(), 41.0 * angle.sin()]);
    let scene = Scene {
        width: 460,
        ..Scene::of([behind.clone(), ellipse()])
    };
    let found = find(&scene, None).unwrap();
    assert_eq!(found.capsules.len(), 2);
    for (capsule, truth) in found.capsules.iter().zip([ellipse(), behind]) {
        let error = truth.error(&capsule.points);

        assert!(error < 0.1, "{error}");
    }
}

#[test]
fn a_background_takes_away_what_stands_still() {
    let dirt = Outline::new([226.0, 60.0], |angle| [14.0 * angle.cos(), 14.0 * angle.sin()]);
    let empty = Scene {
        seed: 5,
        ..Scene::of([dirt.clone()])
    };
    let picture = Scene::of([ellipse(), dirt]);
    let found = find(&picture, Some(&empty)).unwrap();
    assert_eq!(found.capsules.len(), 1);
    let error = ellipse().error(&found.capsules[0].points);

    assert!(error < 0.1, "{error}");
    let walls = found.walls.unwrap();
    assert!((walls.distance / picture.apart() - 1.0).abs() < 0.005, "{walls:?}");
}

#[test]
fn a_capsule_that_is_cut_is_no_capsule() {
    let cut = Outline::new([20.0, 92.7], |angle| [61.0 * angle.cos(), 48.0 * angle.sin()]);
    let empty = Scene::of([]);
    let picture = Scene::of([cut.clone()]);
    assert_eq!(find(&picture, None), Err(PictureError::EndsDiffer));
    let mask = Scene {
        contrast: 1.0,
        ..Scene::plain([cut.clone()])
    };
    assert!(find(&mask, None).is_err());
    let above = Outline::new([141.3, 20.0], |angle| [61.0 * angle.cos(), 48.0 * angle.sin()]);
    assert_eq!(find(&Scene::plain([above]), None), Err(PictureError::TouchesBorder));
    // Beside a whole one it is left out.
    let wide = Scene { width: 460, ..empty };
    let both = Scene {
        outlines: vec![
            ellipse(),
            Outline::new([455.0, 92.7], |angle| [61.0 * angle.cos(), 48.0 * angle.sin()]),
        ],
        ..wide
    };
    assert_eq!(find(&both, None), Err(PictureError::EndsDiffer));
}

#[test]
fn what_is_no_picture_of_a_capsule_is_named() {
    for empty in [Scene::of([]), Scene::plain([])] {
        assert!(matches!(find(&empty, None), Err(PictureError::NoCapsule { .. })));
    }
    let flat = Scene {
        noise: 0.0,
        ..Scene::plain([])
    };
    assert!(matches!(find(&flat, None), Err(PictureError::NoCapsule { .. })));
    let small = Scene {
        width: 460,
        ..Scene::of([])
    };
    let error = find(&Scene::of([ellipse()]), Some(&small)).unwrap_err();
    assert!(error.to_string().contains("460 x 180"), "{error}");
    let png = Scene::of([ellipse()]).png();
    for bytes in [&b"x,y\n1,2\n"[..], &[], &png[..png.len() / 2]] {
        assert!(matches!(Picture::read(bytes), Err(PictureError::Unreadable { .. })));
    }
    let tiny = Scene {
        width: 20,
        ..Scene::plain([])
    };
    let error = Picture::read(&tiny.png()).unwrap_err();
    assert!(error.to_string().contains("20 x 180"), "{error}");
}
