//! Half of a closed outline as a smooth curve, and the distance of points from it.

/// The most points of half an outline.
pub const MAX_HALF: usize = 96;

/// Half of an outline that is symmetric about the x axis: cubics through points from the front to the rear, y >= 0.
#[derive(Clone, Copy, Debug)]
pub struct Curve {
    count: usize,
    points: [[f64; 2]; MAX_HALF],
    /// Derivatives by the number of the point.
    tangents: [[f64; 2]; MAX_HALF],
}

/// The point of a curve that is nearest to another.
#[derive(Clone, Copy, Debug)]
pub struct Foot {
    /// Its place along the curve: the number of a point, with fractions.
    pub place: f64,
    /// The outward normal, of length 1.
    pub normal: [f64; 2],
    /// Distance along the normal: positive outside.
    pub distance: f64,
}

impl Curve {
    pub(crate) const EMPTY: Self = Self {
        count: 0,
        points: [[0.0; 2]; MAX_HALF],
        tangents: [[0.0; 2]; MAX_HALF],
    };

    /// The curve through points in order, at most [`MAX_HALF`]; none for more or for fewer than five.
    pub(crate) fn through(points: impl ExactSizeIterator<Item = [f64; 2]>) -> Option<Self> {
        let mut curve = Self {
            count: points.len(),
            ..Self::EMPTY
        };
        if curve.count < 5 || curve.count > MAX_HALF {
            return None;
        }
        for (place, point) in curve.points.iter_mut().zip(points) {
            *place = point;
        }
        // Beyond the poles the outline goes on as its mirror image. Differences of fourth order.
        let last = curve.count - 1;
        let at = |i: isize| {
            let place = i.unsigned_abs();
            let beyond = place > last;
            let place = if beyond { 2 * last - place } else { place };
            let [x, y] = curve.point(place);
            [x, if i < 0 || beyond { -y } else { y }]
        };
        let mut tangents = [[0.0; 2]; MAX_HALF];
        for (i, tangent) in tangents.iter_mut().enumerate().take(curve.count) {
            let i = i as isize;
            let [before, after, far_before, far_after] = [at(i - 1), at(i + 1), at(i - 2), at(i + 2)];
            *tangent = [0, 1].map(|d| (8.0 * (after[d] - before[d]) - (far_after[d] - far_before[d])) / 12.0);
        }
        curve.tangents = tangents;
        Some(curve)
    }

    /// Number of points.
    pub fn count(&self) -> usize {
        self.count
    }

    /// The points, front to rear.
    pub fn points(&self) -> &[[f64; 2]] {
        self.points.get(..self.count).unwrap_or_default()
    }

    fn point(&self, i: usize) -> [f64; 2] {
        self.points.get(i).copied().unwrap_or_default()
    }

    /// The outward normal at a point.
    pub(crate) fn normal(&self, i: usize) -> [f64; 2] {
        unit_normal(self.tangents.get(i).copied().unwrap_or_default())
    }

    /// Point, first and second derivative at a place.
    fn at(&self, place: f64) -> [[f64; 2]; 3] {
        let i = (place as usize).min(self.count.saturating_sub(2));
        let s = place - i as f64;
        let r = 1.0 - s;
        let tangent = |i: usize| self.tangents.get(i).copied().unwrap_or_default();
        let (p, q, m, n) = (self.point(i), self.point(i + 1), tangent(i), tangent(i + 1));
        let combine = |a: f64, b: f64, c: f64, d: f64| [0, 1].map(|k| a * p[k] + b * q[k] + c * m[k] + d * n[k]);
        [
            combine(r * r * (1.0 + 2.0 * s), s * s * (1.0 + 2.0 * r), r * r * s, -s * s * r),
            combine(-6.0 * r * s, 6.0 * r * s, r * (1.0 - 3.0 * s), s * (3.0 * s - 2.0)),
            combine(12.0 * s - 6.0, 6.0 - 12.0 * s, 6.0 * s - 4.0, 6.0 * s - 2.0),
        ]
    }

    /// The place at a share 0 to 1 of the way from the front to the rear, as a point.
    pub fn position(&self, share: f64) -> [f64; 2] {
        self.at_place(share * self.count.saturating_sub(1) as f64)
    }

    /// The point at a place.
    pub(crate) fn at_place(&self, place: f64) -> [f64; 2] {
        let [point, ..] = self.at(place);
        point
    }

    /// The nearest point of the curve to one with y >= 0.
    pub fn nearest(&self, [x, y]: [f64; 2]) -> Foot {
        let (mut nearest, mut least) = (0, f64::INFINITY);
        for (i, [u, v]) in self.points().iter().enumerate() {
            let square = (x - u) * (x - u) + (y - v) * (y - v);
            if square < least {
                (nearest, least) = (i, square);
            }
        }
        self.nearest_from(nearest, [x, y])
    }

    /// The nearest point to one that is near a point of the curve by number.
    pub(crate) fn nearest_from(&self, start: usize, [x, y]: [f64; 2]) -> Foot {
        const STEPS: usize = 5;
        const CLOSE: f64 = 1e-5;
        let last = self.count.saturating_sub(1);
        let (low, high) = (start.saturating_sub(1) as f64, (start + 1).min(last) as f64);
        let mut place = start.min(last) as f64;
        let mut values = self.at(place);
        for _ in 0..STEPS {
            let [point, first, second] = values;
            let way = [x - point[0], y - point[1]];
            let slope = dot(first, first);
            let full = slope - dot(way, second);
            let step = dot(way, first) / if full > 0.25 * slope { full } else { slope };
            let next = (place + step).clamp(low, high);
            let done = (next - place).abs() < CLOSE;
            place = next;
            values = self.at(place);
            if done {
                break;
            }
        }
        let [point, tangent, _] = values;
        let normal = unit_normal(tangent);
        Foot {
            place,
            normal,
            distance: dot([x - point[0], y - point[1]], normal),
        }
    }

    /// Values known at the points, linear between them, at a place.
    pub(crate) fn value<const W: usize>(&self, values: &[[f64; W]; MAX_HALF], place: f64) -> [f64; W] {
        between(values, (place as usize).min(self.count.saturating_sub(2)), place)
    }

    /// Place of the greatest product with a direction along the curve.
    fn extreme(&self, direction: [f64; 2]) -> f64 {
        const STEPS: usize = 4;
        let value = |i: usize| dot(self.point(i), direction);
        let greatest = (0..self.count).fold(0, |best, i| if value(i) > value(best) { i } else { best });
        let last = self.count.saturating_sub(1);
        let (low, high) = (greatest.saturating_sub(1) as f64, (greatest + 1).min(last) as f64);
        let mut place = greatest as f64;
        for _ in 0..STEPS {
            let [_, first, second] = self.at(place).map(|vector| dot(vector, direction));
            if second < 0.0 {
                place = (place - first / second).clamp(low, high);
            }
        }
        place
    }

    /// Places of the foremost, the rearmost and the outermost point.
    pub(crate) fn extremes(&self) -> [f64; 3] {
        [[1.0, 0.0], [-1.0, 0.0], [0.0, 1.0]].map(|direction| self.extreme(direction))
    }

    /// Foremost and rearmost x.
    pub fn extent(&self) -> [f64; 2] {
        let [front, rear, _] = self.extremes();
        [front, rear].map(|place| self.at_place(place)[0])
    }

    /// Greatest y.
    pub fn half_width(&self) -> f64 {
        let [.., widest] = self.extremes();
        self.at_place(widest)[1]
    }

    /// Area within the closed outline and the x of its centroid.
    pub(crate) fn area(&self) -> [f64; 2] {
        let (mut area, mut moment) = (0.0, 0.0);
        for pair in self.points().windows(2) {
            if let [[x0, y0], [x1, y1]] = *pair {
                // Strips between the chord and its mirror image, from the right to the left.
                let strip = (x0 - x1) * (y0 + y1);
                area += strip;
                moment += strip * 0.5 * (x0 + x1) + (x0 - x1) * (x0 - x1) * (y0 - y1) / 6.0;
            }
        }
        [area, if area > 0.0 { moment / area } else { 0.0 }]
    }
}

/// Values at a place, linear between those known at a whole place before it and at the next.
pub(crate) fn between<const W: usize>(values: &[[f64; W]; MAX_HALF], i: usize, place: f64) -> [f64; W] {
    let share = place - i as f64;
    let [low, high] = [i, i + 1].map(|i| values.get(i).copied().unwrap_or([0.0; W]));
    core::array::from_fn(|k| low[k] + share * (high[k] - low[k]))
}

pub(crate) fn dot(a: [f64; 2], b: [f64; 2]) -> f64 {
    a[0] * b[0] + a[1] * b[1]
}

/// The normal to the right of a tangent: outward on a way from the front over y > 0 to the rear.
fn unit_normal([x, y]: [f64; 2]) -> [f64; 2] {
    let length = libm::sqrt(x * x + y * y);
    if length > 0.0 {
        [y / length, -x / length]
    } else {
        [0.0; 2]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Half an ellipse; angles that are not equidistant.
    fn ellipse(a: f64, b: f64) -> Curve {
        let angle = |i: usize| {
            let s = i as f64 / 52.0;
            core::f64::consts::PI * (s + 0.05 * libm::sin(2.0 * core::f64::consts::PI * s))
        };
        Curve::through((0..53).map(|i| [a * libm::cos(angle(i)), b * libm::sin(angle(i))])).unwrap()
    }

    #[test]
    fn the_distance_from_a_circle_is_that_from_its_centre() {
        let circle = ellipse(0.9, 0.9);
        for k in 0..200 {
            let angle = core::f64::consts::PI * f64::from(k) / 199.0;
            for radius in [0.85, 0.9, 0.97] {
                let (c, s) = (libm::cos(angle), libm::sin(angle).abs());
                let foot = circle.nearest([radius * c, radius * s]);
                assert!(
                    (foot.distance - (radius - 0.9)).abs() < 3e-6,
                    "{angle} {}",
                    foot.distance
                );
                assert!((foot.normal[0] - c).abs() < 2e-4 && (foot.normal[1] - s).abs() < 2e-4);
            }
        }
    }

    #[test]
    fn extents_and_area_are_those_of_the_ellipse() {
        let curve = ellipse(1.2, 0.7);
        let [front, rear] = curve.extent();
        assert!((front - 1.2).abs() < 1e-9 && (rear + 1.2).abs() < 1e-9);
        assert!((curve.half_width() - 0.7).abs() < 1e-6);
        let [area, centroid] = curve.area();
        assert!((area - core::f64::consts::PI * 1.2 * 0.7).abs() < 3e-3 && centroid.abs() < 1e-12);
    }

    #[test]
    fn too_few_or_too_many_points_make_no_curve() {
        assert!(Curve::through((0..4).map(|i| [f64::from(i), 0.0])).is_none());
        assert!(Curve::through((0..97).map(|i| [f64::from(i), 0.0])).is_none());
    }
}
