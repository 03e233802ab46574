//! Pictures of capsules in a channel whose outlines are known.

use image::{DynamicImage, GrayImage, ImageBuffer, ImageFormat, Luma};
use std::io::Cursor;
use tiff::encoder::TiffEncoder;
use tiff::encoder::colortype::Gray32Float;

/// A closed curve.
#[derive(Clone)]
pub struct Outline {
    points: Vec<[f64; 2]>,
}

const POINTS: usize = 4000;

impl Outline {
    /// The curve around a centre that an angle runs along.
    pub fn new([x, y]: [f64; 2], curve: impl Fn(f64) -> [f64; 2]) -> Self {
        let point = |i: usize| {
            let [u, v] = curve(std::f64::consts::TAU * i as f64 / POINTS as f64);
            [x + u, y + v]
        };
        Self {
            points: (0..POINTS).map(point).collect(),
        }
    }

    /// Places where the curve crosses a row, from left to right.
    fn crossings(&self, y: f64) -> Vec<f64> {
        let mut crossings: Vec<f64> = (0..POINTS)
            .filter_map(|i| {
                let ([a, b], [c, d]) = (self.points[i], self.points[(i + 1) % POINTS]);
                ((b <= y) != (d <= y)).then(|| a + (y - b) / (d - b) * (c - a))
            })
            .collect();
        crossings.sort_by(f64::total_cmp);
        crossings
    }

    /// Root of the mean square of the distances of points from the curve; infinite where they leave some of it out.
    pub fn error(&self, points: &[[f64; 2]]) -> f64 {
        let distance = |[x, y]: [f64; 2], [u, v]: [f64; 2]| (x - u).hypot(y - v);
        let mean = points
            .iter()
            .map(|point| {
                let nearest = self.points.iter().map(|own| distance(*own, *point));
                nearest.fold(f64::INFINITY, f64::min).powi(2)
            })
            .sum::<f64>()
            / points.len() as f64;
        let seen = |own: &[f64; 2]| points.iter().any(|point| distance(*own, *point) < 2.0);
        if self.points.iter().step_by(40).all(seen) {
            mean.sqrt()
        } else {
            f64::INFINITY
        }
    }
}

#[derive(Clone)]
pub struct Scene {
    pub outlines: Vec<Outline>,
    pub width: u32,
    pub height: u32,
    /// Brightness of the liquid, and how much brighter capsules are.
    pub level: f64,
    pub contrast: f64,
    /// Rows of the walls at half the width.
    pub walls: Option<[f64; 2]>,
    /// Rise of the walls.
    pub slope: f64,
    /// Share of the light that is missing in the corners, one after the other.
    pub uneven: [f64; 2],
    /// Standard deviation of the camera's blur, in pixels.
    pub blur: f64,
    /// Standard deviation of the brightness.
    pub noise: f64,
    pub seed: u64,
    /// Whether a pixel is in or out, and nothing between.
    pub binary: bool,
    /// Place of a line across the capsules that is twice as dark as they are.
    pub line: Option<f64>,
}

/// Sub-rows of a pixel; along rows areas are exact.
const FINE: usize = 16;

impl Scene {
    /// Dark capsules in a channel under uneven light.
    pub fn of(outlines: impl Into<Vec<Outline>>) -> Self {
        Self {
            walls: Some([22.4, 163.1]),
            uneven: [0.1, 0.15],
            blur: 1.2,
            noise: 0.008,
            contrast: -0.4,
            level: 0.8,
            ..Self::plain(outlines)
        }
    }

    /// Capsules on a black ground, without blur and noise.
    pub fn plain(outlines: impl Into<Vec<Outline>>) -> Self {
        Self {
            outlines: outlines.into(),
            width: 280,
            height: 180,
            level: 0.0,
            contrast: 0.4,
            walls: None,
            slope: 0.0,
            uneven: [0.0; 2],
            blur: 0.0,
            noise: 0.0,
            seed: 1,
            binary: false,
            line: None,
        }
    }

    /// Distance of the walls along a column.
    pub fn apart(&self) -> f64 {
        self.walls.map_or(f64::NAN, |[upper, lower]| lower - upper)
    }

    pub fn png(&self) -> Vec<u8> {
        self.encoded(ImageFormat::Png)
    }

    pub fn encoded(&self, format: ImageFormat) -> Vec<u8> {
        encoded(&self.drawn(), format)
    }

    /// The picture after some quarter turns to the right.
    pub fn turned(&self, turns: usize) -> Vec<u8> {
        let picture = (0..turns).fold(self.drawn(), |picture, _| picture.rotate90());
        encoded(&picture, ImageFormat::Png)
    }

    /// The place in the scene of a place in the turned picture.
    pub fn back(&self, place: [f64; 2], turns: usize) -> [f64; 2] {
        let (width, height) = (f64::from(self.width), f64::from(self.height));
        let [x, y] = place;
        match turns {
            0 => [x, y],
            1 => [y, height - x],
            2 => [width - x, height - y],
            _ => [width - y, x],
        }
    }

    fn drawn(&self) -> DynamicImage {
        let (width, height) = (self.width as usize, self.height as usize);
        let mut values = vec![0.0; width * height];
        let covered = |from: f64, to: f64, x: usize| (to.min(x as f64 + 1.0) - from.max(x as f64)).max(0.0);
        for y in 0..height {
            for fine in 0..FINE {
                let row = y as f64 + (fine as f64 + 0.5) / FINE as f64;
                for x in 0..width {
                    values[y * width + x] += self.channel(x as f64 + 0.5, row) / FINE as f64;
                }
                for outline in &self.outlines {
                    for pair in outline.crossings(row).chunks_exact(2) {
                        for x in 0..width {
                            let share = covered(pair[0], pair[1], x) / FINE as f64;
                            let line = self.line.map_or(0.0, |line| covered(line - 1.5, line + 1.5, x));
                            values[y * width + x] += self.contrast * share * (1.0 + line);
                        }
                    }
                }
            }
        }
        for (i, value) in values.iter_mut().enumerate() {
            let x = (i % width) as f64 / width as f64;
            let y = (i / width) as f64 / height as f64;
            *value *= 1.0 - self.uneven[0] * x - self.uneven[1] * (2.0 * y - 1.0).powi(2);
        }
        let mut values = blurred(&values, width, height, self.blur);
        let mut random = Random(self.seed);
        values
            .iter_mut()
            .for_each(|value| *value += self.noise * random.normal());
        if self.binary {
            values.iter_mut().for_each(|value| *value = value.round());
        }
        let pixels = values
            .iter()
            .map(|value| (255.0 * value).round().clamp(0.0, 255.0) as u8)
            .collect();
        let picture: GrayImage = ImageBuffer::<Luma<u8>, _>::from_raw(self.width, self.height, pixels).unwrap();
        picture.into()
    }

    /// A bright liquid, walls as dark lines of five pixels, and what is behind them a little darker.
    fn channel(&self, x: f64, y: f64) -> f64 {
        let Some([upper, lower]) = self.walls else {
            return self.level;
        };
        let y = y - self.slope * (x - 0.5 * f64::from(self.width));
        let outward = (upper - y).max(y - lower);
        match outward {
            ..0.0 => self.level,
            0.0..5.0 => 0.25 * self.level,
            _ => 0.85 * self.level,
        }
    }
}

fn encoded(picture: &DynamicImage, format: ImageFormat) -> Vec<u8> {
    let mut bytes = Cursor::new(Vec::new());
    let format = match format {
        ImageFormat::Jpeg => image::ImageOutputFormat::Jpeg(95),
        other => other.into(),
    };
    picture.write_to(&mut bytes, format).unwrap();
    bytes.into_inner()
}

/// A Gaussian blur, by sums.
fn blurred(values: &[f64], width: usize, height: usize, deviation: f64) -> Vec<f64> {
    let reach = (4.0 * deviation).ceil() as isize;
    let kernel: Vec<f64> = (-reach..=reach)
        .map(|i| {
            if reach == 0 {
                1.0
            } else {
                (-0.5 * (i as f64 / deviation).powi(2)).exp()
            }
        })
        .collect();
    let whole: f64 = kernel.iter().sum();
    let along = |values: &[f64], step: [isize; 2]| -> Vec<f64> {
        (0..values.len())
            .map(|i| {
                let (x, y) = ((i % width) as isize, (i / width) as isize);
                let value = |(k, weight): (usize, &f64)| {
                    let shift = k as isize - reach;
                    let x = (x + shift * step[0]).clamp(0, width as isize - 1) as usize;
                    let y = (y + shift * step[1]).clamp(0, height as isize - 1) as usize;
                    weight * values[y * width + x]
                };
                kernel.iter().enumerate().map(value).sum::<f64>() / whole
            })
            .collect()
    };
    along(&along(values, [1, 0]), [0, 1])
}

/// Random numbers by Lehmer's generator.
struct Random(u64);

impl Random {
    fn uniform(&mut self) -> f64 {
        self.0 = self.0 * 48271 % 2_147_483_647;
        self.0 as f64 / 2_147_483_647.0
    }

    /// Of standard deviation 1: twelve uniform numbers.
    fn normal(&mut self) -> f64 {
        (0..12).map(|_| self.uniform()).sum::<f64>() - 6.0
    }
}

/// A picture as a TIFF of floating-point numbers, each level by a function.
pub fn floats(scene: &Scene, level: impl Fn(f32) -> f32) -> Vec<u8> {
    let picture = scene.drawn().into_luma16();
    let levels: Vec<f32> = picture
        .as_raw()
        .iter()
        .map(|grey| level(f32::from(*grey) / 65535.0))
        .collect();
    let mut bytes = Cursor::new(Vec::new());
    let mut encoder = TiffEncoder::new(&mut bytes).unwrap();
    encoder
        .write_image::<Gray32Float>(picture.width(), picture.height(), &levels)
        .unwrap();
    bytes.into_inner()
}
