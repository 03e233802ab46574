//! Sub-pixel places of the edge, along the normals of a rough outline.

use crate::grid::{Grid, median, vertex};
use crate::rings::area;

/// Criterion for the edge of a capsule.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Edge {
    /// Where the brightness changes most.
    Gradient,
    /// Half way between the levels on both sides.
    HalfLevel,
}

impl Edge {
    /// Its name in JSON.
    pub fn name(self) -> &'static str {
        match self {
            Self::Gradient => "gradient",
            Self::HalfLevel => "half-level",
        }
    }
}

/// The search along a normal: so many steps to either side, and steps per pixel.
const REACH: usize = 28;
const PIXEL: usize = 4;
const FINE: f64 = PIXEL as f64;
/// Where levels are taken: steps from the ends of the search.
const LEVEL: usize = 6;
/// Profiles on either side of one that are averaged with it.
const BESIDE: usize = 4;
/// Points to either side whose normals tell the curvature.
const BENT: usize = 4;
/// The greatest standard deviation of a blur that is believed, in pixels.
const BROADEST: f64 = 3.0;
/// Share of the usual change of brightness below which an edge is not seen.
const FAINT: f64 = 0.2;

/// Brightness along a normal, from the inside outward.
type Profile = [f64; 2 * REACH + 1];

/// An edge on a normal.
struct Place {
    /// How far outward, in pixels.
    outward: f64,
    /// The change of the brightness there.
    change: f64,
    /// Variance of the blur, if the edge is one of a step, in square pixels.
    variance: f64,
}

/// Points at equal distances of about one pixel along a closed line.
pub(crate) fn evenly(ring: &[[f64; 2]]) -> Vec<[f64; 2]> {
    let closed = |i: usize| ring[i % ring.len()];
    let length = |i: usize| {
        let ([a, b], [c, d]) = (closed(i), closed(i + 1));
        (c - a).hypot(d - b)
    };
    let whole: f64 = (0..ring.len()).map(length).sum();
    let step = whole / whole.round().max(1.0);
    let mut points = Vec::with_capacity(whole as usize + 1);
    let mut way = 0.0;
    for i in 0..ring.len() {
        let ([a, b], [c, d]) = (closed(i), closed(i + 1));
        let own = length(i);
        while points.len() as f64 * step < way + own - 1e-9 {
            let share = (points.len() as f64 * step - way) / own;
            points.push([a + share * (c - a), b + share * (d - b)]);
        }
        way += own;
    }
    points
}

/// The edge beside the points of a rough outline of something bright. Points where no edge is seen are left out.
pub(crate) fn refine(grid: &Grid, rough: &[[f64; 2]], edge: Edge) -> Vec<[f64; 2]> {
    let mut rough = evenly(rough);
    if area(&rough) < 0.0 {
        rough.reverse();
    }
    let n = rough.len();
    let normals = normals(&rough);
    let profiles: Vec<Profile> = rough
        .iter()
        .zip(&normals)
        .map(|([x, y], [u, v])| {
            std::array::from_fn(|i| {
                let t = (i as f64 - REACH as f64) / FINE;
                grid.sample([x + t * u, y + t * v])
            })
        })
        .collect();
    let places: Vec<Option<Place>> = (0..n)
        .map(|i| {
            let profile: Profile = std::array::from_fn(|j| {
                let around = (0..=2 * BESIDE).map(|k| profiles[(i + n + k - BESIDE) % n][j]);
                around.sum::<f64>() / (2 * BESIDE + 1) as f64
            });
            match edge {
                Edge::Gradient => steepest(&profile),
                Edge::HalfLevel => half_level(&profile),
            }
        })
        .collect();
    let mut changes: Vec<f64> = places.iter().flatten().map(|place| place.change).collect();
    if changes.is_empty() {
        return Vec::new();
    }
    let least = FAINT * median(&mut changes);
    let mut variances: Vec<f64> = places.iter().flatten().map(|place| place.variance).collect();
    let variance = median(&mut variances).clamp(0.0, BROADEST * BROADEST);
    let moved = |(i, place): (usize, Option<Place>)| {
        let Place { outward, .. } = place.filter(|place| place.change > least)?;
        let ([x, y], [u, v]) = (rough[i], normals[i]);
        // Of a blur, which is a solution of the heat equation, the levels move inward with half the curvature.
        let outward = outward + 0.5 * variance * curvature(&normals, i);
        Some([x + outward * u, y + outward * v])
    };
    places.into_iter().enumerate().filter_map(moved).collect()
}

/// Outward normals of a closed line of points one pixel apart, which encloses a positive area.
fn normals(points: &[[f64; 2]]) -> Vec<[f64; 2]> {
    let n = points.len();
    (0..n)
        .map(|i| {
            let ([a, b], [c, d]) = (points[(i + n - 2) % n], points[(i + 2) % n]);
            let length = (c - a).hypot(d - b).max(f64::MIN_POSITIVE);
            [(d - b) / length, (a - c) / length]
        })
        .collect()
}

/// Curvature of a closed line of points one pixel apart, by the turn of its normals; positive where it is convex.
fn curvature(normals: &[[f64; 2]], i: usize) -> f64 {
    let n = normals.len();
    let ([a, b], [c, d]) = (normals[(i + n - BENT) % n], normals[(i + BENT) % n]);
    let turn = (a * d - b * c).clamp(-1.0, 1.0).asin();
    turn / (2 * BENT) as f64
}

/// Variance of the Gaussian whose derivative a fall is, from three of its values two pixels apart.
fn variance([before, at, after]: [f64; 3]) -> f64 {
    /// Variance that the differences over two pixels add.
    const DIFFERENCE: f64 = 1.0 / 3.0;
    let fall = at.ln() - 0.5 * (before.max(1e-3 * at).ln() + after.max(1e-3 * at).ln());
    0.5 * 4.0 / fall.max(1e-3) - DIFFERENCE
}

/// Where a profile falls most outward; none where that is the end of the search.
fn steepest(profile: &Profile) -> Option<Place> {
    let fall = |i: usize| 0.5 * (profile[i - PIXEL] - profile[i + PIXEL]);
    let at = (PIXEL..=2 * REACH - PIXEL).max_by(|a, b| fall(*a).total_cmp(&fall(*b)))?;
    if !(3 * PIXEL..=2 * REACH - 3 * PIXEL).contains(&at) {
        return None;
    }
    // Wide differences and a wide parabola, for the noise.
    let [before, after] = [at - 2 * PIXEL, at + 2 * PIXEL];
    let falls = [fall(before), fall(at), fall(after)];
    let offset = (after - at) as f64 * vertex(falls);
    Some(Place {
        outward: (at as f64 + offset - REACH as f64) / FINE,
        change: fall(at),
        variance: variance(falls),
    })
}

/// Where a profile is half way between its ends, nearest to its middle.
fn half_level(profile: &Profile) -> Option<Place> {
    let mean = |from: usize| profile[from..from + LEVEL].iter().sum::<f64>() / LEVEL as f64;
    let (inside, outside) = (mean(0), mean(2 * REACH + 1 - LEVEL));
    let level = 0.5 * (inside + outside);
    let crossings = profile.windows(2).enumerate().filter_map(|(i, pair)| {
        let crosses = pair[0] >= level && level > pair[1];
        crosses.then(|| i as f64 + (pair[0] - level) / (pair[0] - pair[1]) - REACH as f64)
    });
    let nearest = crossings.min_by(|a, b| a.abs().total_cmp(&b.abs()))?;
    Some(Place {
        outward: nearest / FINE,
        change: inside - outside,
        variance: steepest(profile).map_or(0.0, |place| place.variance),
    })
}
