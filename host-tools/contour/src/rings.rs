//! Closed level lines around the regions that stand out from the background.

use crate::error::PictureError;
use crate::grid::Grid;
use contour::ContourBuilder;

/// The least extent of a capsule, in pixels.
pub(crate) const LEAST: u32 = 12;
/// Fraction of the greatest area below which something is dirt beside a capsule.
const DIRT: f64 = 0.2;
/// How many standard deviations of the background a capsule must stand out.
const CLEAR: f64 = 5.0;
/// Bins of the brightness.
const BINS: usize = 256;

/// Two classes of brightness.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Classes {
    pub(crate) threshold: f64,
    /// Difference of the means.
    pub(crate) contrast: f64,
    /// Standard deviation of the darker class.
    noise: f64,
}

impl Classes {
    /// The classes with the greatest variance between them (Otsu, IEEE Trans. SMC 9, 1979).
    pub(crate) fn of(values: &[f64]) -> Option<Self> {
        let range = values
            .iter()
            .fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], value| {
                [low.min(*value), high.max(*value)]
            });
        let width = (range[1] - range[0]) / BINS as f64;
        if !(width.is_finite() && width > 0.0) {
            return None;
        }
        let mut counts = [0.0; BINS];
        for value in values {
            counts[(((value - range[0]) / width) as usize).min(BINS - 1)] += 1.0;
        }
        let centre = |bin: usize| range[0] + width * (bin as f64 + 0.5);
        let count = values.len() as f64;
        let sum: f64 = (0..BINS).map(|bin| counts[bin] * centre(bin)).sum();
        let (mut below, mut sum_below) = (0.0, 0.0);
        let mut best = (0.0, 0, 0.0);
        for bin in 0..BINS - 1 {
            below += counts[bin];
            sum_below += counts[bin] * centre(bin);
            let above = count - below;
            if below > 0.0 && above > 0.0 {
                let contrast = (sum - sum_below) / above - sum_below / below;
                let variance = below * above * contrast * contrast;
                if variance > best.0 {
                    best = (variance, bin, contrast);
                }
            }
        }
        let (_, bin, contrast) = best;
        let threshold = range[0] + width * (bin + 1) as f64;
        let dark: Vec<f64> = values.iter().copied().filter(|value| *value < threshold).collect();
        let mean = dark.iter().sum::<f64>() / dark.len().max(1) as f64;
        let variance = dark.iter().map(|value| (value - mean).powi(2)).sum::<f64>() / dark.len().max(1) as f64;
        // Half way between the means, and not at the edge of a bin: for pictures with two levels they are far apart.
        Some(Self {
            threshold: mean + 0.5 * contrast,
            contrast,
            noise: variance.sqrt(),
        })
    }
}

/// Closed lines around what is brighter than half the contrast, and how many of them the border cuts.
pub(crate) struct Rings {
    /// In pixels, the last point is not the first.
    pub(crate) whole: Vec<Vec<[f64; 2]>>,
    pub(crate) cut: usize,
    pub(crate) contrast: f64,
}

impl Rings {
    pub(crate) fn of(grid: &Grid) -> Result<Self, PictureError> {
        let none = PictureError::NoCapsule { least: LEAST };
        let classes = Classes::of(&grid.values).ok_or(none.clone())?;
        if classes.contrast < CLEAR * classes.noise {
            return Err(none);
        }
        let builder = ContourBuilder::new(grid.width, grid.height, true);
        let contours = builder.contours(&grid.values, &[classes.threshold]);
        let polygons = contours
            .ok()
            .and_then(|contours| contours.into_iter().next())
            .map(|contour| contour.into_inner().0.0);
        let mut rings: Vec<Vec<[f64; 2]>> = polygons
            .unwrap_or_default()
            .into_iter()
            .map(|polygon| {
                let (exterior, _) = polygon.into_inner();
                let mut ring: Vec<[f64; 2]> = exterior.0.into_iter().map(|at| [at.x, at.y]).collect();
                ring.pop();
                ring
            })
            .filter(|ring| extent(ring).iter().all(|[low, high]| high - low >= f64::from(LEAST)))
            .collect();
        let largest = rings.iter().map(|ring| area(ring).abs()).fold(0.0, f64::max);
        rings.retain(|ring| area(ring).abs() >= DIRT * largest);
        let found = rings.len();
        let size = [grid.width as f64, grid.height as f64];
        rings.retain(|ring| {
            let inside = |d: usize| {
                let [low, high] = extent(ring)[d];
                low > 1.0 && high < size[d] - 1.0
            };
            inside(0) && inside(1)
        });
        match (found, rings.len()) {
            (0, _) => Err(none),
            (_, 0) => Err(PictureError::TouchesBorder),
            (found, whole) => Ok(Self {
                whole: rings,
                cut: found - whole,
                contrast: classes.contrast,
            }),
        }
    }
}

/// Least and greatest coordinates of points.
pub(crate) fn extent(points: &[[f64; 2]]) -> [[f64; 2]; 2] {
    [0, 1].map(|d| {
        points
            .iter()
            .fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], point| {
                [low.min(point[d]), high.max(point[d])]
            })
    })
}

/// The area within a closed line, positive where it turns from x to y.
pub(crate) fn area(ring: &[[f64; 2]]) -> f64 {
    let triangle = |i: usize| {
        let ([a, b], [c, d]) = (ring[i], ring[(i + 1) % ring.len()]);
        a * d - b * c
    };
    0.5 * (0..ring.len()).map(triangle).sum::<f64>()
}
