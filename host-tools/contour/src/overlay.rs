//! Contours, walls and dents, drawn over the picture.

use crate::picture::{Found, Picture};
use image::{ImageFormat, Rgb, RgbImage};
use std::io::Cursor;

/// Small pictures are drawn larger, so that sub-pixel lines are seen: about this wide.
const WIDTH: u32 = 1200;
const CONTOUR: Rgb<u8> = Rgb([230, 40, 40]);
const WALL: Rgb<u8> = Rgb([30, 120, 255]);
const DENT: Rgb<u8> = Rgb([20, 190, 60]);

/// The picture as PNG with contours (red), walls (blue) and dents (green).
///
/// # Errors
/// Those of the PNG encoder.
pub fn overlay(picture: &Picture, found: &Found) -> Result<Vec<u8>, image::ImageError> {
    let [width, height] = picture.size();
    let scale = (WIDTH / width).max(1);
    let mut canvas = RgbImage::from_fn(width * scale, height * scale, |x, y| {
        let grey = picture.grey.get_pixel(x / scale, y / scale).0[0];
        Rgb([(255.0 * grey) as u8; 3])
    });
    let mut line = |[a, b]: [[f64; 2]; 2], colour: Rgb<u8>| {
        let [a, b] = [a, b].map(|point| point.map(|x| x * f64::from(scale)));
        let steps = (2.0 * (b[0] - a[0]).hypot(b[1] - a[1])).ceil().max(1.0);
        for i in 0..=steps as usize {
            let share = i as f64 / steps;
            let [x, y] = [0, 1].map(|d| (a[d] + share * (b[d] - a[d])).max(0.0) as u32);
            if let Some(pixel) = canvas.get_pixel_mut_checked(x, y) {
                *pixel = colour;
            }
        }
    };
    for capsule in &found.capsules {
        let count = capsule.points.len();
        for i in 0..count {
            line([capsule.points[i], capsule.points[(i + 1) % count]], CONTOUR);
        }
        if let Some([x, y]) = capsule.dent.map(|dent| dent.place) {
            line([[x - 3.0, y], [x + 3.0, y]], DENT);
            line([[x, y - 3.0], [x, y + 3.0]], DENT);
        }
    }
    for wall in found.walls.iter().flat_map(|walls| walls.lines) {
        line(wall, WALL);
    }
    let mut bytes = Cursor::new(Vec::new());
    canvas.write_to(&mut bytes, ImageFormat::Png)?;
    Ok(bytes.into_inner())
}
