//! Pictures of capsules: an outline filled, blurred and with noise, as a camera would give it.

use super::truth::normal;
use crate::StudyError;
use crate::random::Random;
use capsule_contour::{Picture, Settings};
use image::{ColorType, ImageEncoder, codecs::png::PngEncoder};

/// Samples along each side of a pixel.
const FINE: usize = 4;
/// Empty channel around the capsule, in l.
const AROUND: f64 = 0.8;
/// Shades of the liquid and of the capsule, of 1.
const LIQUID: f64 = 0.7;
const CAPSULE: f64 = 0.3;
/// Standard deviation of the camera's blur, in pixels.
const BLUR: f64 = 1.0;

/// The contour that is found in a picture of a closed outline, in pixels; `noise` is that of a pixel, of the contrast.
///
/// # Errors
/// A picture in which no capsule is found.
pub(super) fn seen(
    outline: &[[f64; 2]],
    pixels: f64,
    noise: f64,
    random: &mut Random,
) -> Result<Vec<[f64; 2]>, StudyError> {
    let range = |d: usize| {
        let values = || outline.iter().map(|point| point[d]);
        [
            values().fold(f64::INFINITY, f64::min) - AROUND,
            values().fold(f64::NEG_INFINITY, f64::max) + AROUND,
        ]
    };
    let ranges = [range(0), range(1)];
    let [width, height] = ranges.map(|[low, high]| ((high - low) * pixels).ceil() as usize);
    // Where the capsule lies among the pixels is random.
    let first = [0, 1].map(|d| ranges[d][0] - random.next() / pixels);
    let fine = pixels * FINE as f64;
    let placed: Vec<[f64; 2]> = outline
        .iter()
        .map(|point| [0, 1].map(|d| (point[d] - first[d]) * fine))
        .collect();
    let [columns, rows] = [width * FINE, height * FINE];
    let blurred = blurred(&filled(&placed, columns, rows), columns, BLUR * FINE as f64);
    let mut grey = Vec::with_capacity(2 * width * height);
    for row in 0..height {
        for column in 0..width {
            let samples = (0..FINE * FINE).map(|k| (row * FINE + k / FINE) * columns + column * FINE + k % FINE);
            let covered = samples.map(|at| blurred[at]).sum::<f64>() / (FINE * FINE) as f64;
            let shade = LIQUID + (CAPSULE - LIQUID) * (covered + noise * normal(random));
            let shade = (shade.clamp(0.0, 1.0) * f64::from(u16::MAX)) as u16;
            grey.extend(shade.to_ne_bytes());
        }
    }
    let mut png = Vec::new();
    let encoder = PngEncoder::new(&mut png);
    encoder.write_image(&grey, width as u32, height as u32, ColorType::L16)?;
    let found = Picture::read(&png)?.capsules(None, &Settings::default())?;
    let capsule = found.capsules.into_iter().next();
    Ok(capsule.ok_or(StudyError::NothingToCompare)?.points)
}

/// 1 at the samples inside a closed polygon, by rows: a sample is inside where the number of edges to its left is odd.
fn filled(polygon: &[[f64; 2]], columns: usize, rows: usize) -> Vec<f64> {
    let mut inside = vec![0.0; columns * rows];
    for (row, samples) in inside.chunks_exact_mut(columns).enumerate() {
        let y = row as f64 + 0.5;
        let ends = polygon.iter().zip(polygon.iter().cycle().skip(1));
        let mut crossings: Vec<f64> = ends
            .filter(|(p, q)| (p[1] <= y) != (q[1] <= y))
            .map(|(p, q)| p[0] + (y - p[1]) * (q[0] - p[0]) / (q[1] - p[1]))
            .collect();
        crossings.sort_by(f64::total_cmp);
        for pair in crossings.chunks_exact(2) {
            let [from, to] = [pair[0], pair[1]].map(|x| ((x + 0.5) as usize).min(columns));
            samples[from..to].fill(1.0);
        }
    }
    inside
}

/// Blurred by a Gaussian along rows and columns; beyond the border everything is 0.
fn blurred(values: &[f64], columns: usize, deviation: f64) -> Vec<f64> {
    let reach = (4.0 * deviation).ceil() as usize;
    let weight = |i: usize| (-0.5 * (i as f64 / deviation).powi(2)).exp();
    let whole = weight(0) + 2.0 * (1..=reach).map(weight).sum::<f64>();
    let weights: Vec<f64> = (0..=reach).map(|i| weight(i) / whole).collect();
    let along = |values: &[f64], step: usize, length: usize| -> Vec<f64> {
        (0..values.len())
            .map(|at| {
                let place = at / step % length;
                let mut sum = weights[0] * values[at];
                for (i, weight) in weights.iter().enumerate().skip(1) {
                    if place >= i {
                        sum += weight * values[at - i * step];
                    }
                    if place + i < length {
                        sum += weight * values[at + i * step];
                    }
                }
                sum
            })
            .collect()
    };
    let rows = values.len() / columns;
    along(&along(values, 1, columns), columns, rows)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_circle_is_found_where_it_was_drawn() {
        let circle: Vec<[f64; 2]> = (0..2000)
            .map(|i| {
                let angle = std::f64::consts::TAU * f64::from(i) / 2000.0;
                [0.8 * angle.cos(), 0.8 * angle.sin()]
            })
            .collect();
        let found = seen(&circle, 50.0, 0.0, &mut Random(3)).unwrap();
        let middle = [0, 1].map(|d| found.iter().map(|point| point[d]).sum::<f64>() / found.len() as f64);
        for [x, y] in found {
            let radius = (x - middle[0]).hypot(y - middle[1]);
            assert!((radius - 40.0).abs() < 0.1, "{radius}");
        }
    }
}
