//! The coordinates in which distances are taken, and where they are cut.
//!
//! For a capsule in the channel they are (s_0 sqrt(Ca) / Ca_lim(a/l)^(1/8), s_1 a/l): the solution varies fast at small Ca,
//! where the square root stretches the plane, and along the steady limit Ca_lim(a/l), towards which the plane is bent a
//! little, so that a query near the limit finds samples as near to it on the rows beside its own. How much is a
//! compromise: away from the limit the solution follows Ca alone. Where the solution jumps, because the rear of the
//! membrane buckles, the plane is cut: no interpolation crosses a jump well.

use super::{minus, square, times};
use crate::model::Curve;
use crate::model::wire::{Contents, MAX_PARAMETERS};
use crate::{Parameters, Real};

/// Coordinates of the parameters: each times its scale, but for a capsule in the channel (see the module).
#[derive(Clone, Copy, Debug)]
pub struct Coordinates<'a> {
    /// Factor of each parameter.
    pub scales: [f64; MAX_PARAMETERS],
    /// Ca_lim(a/l) of a capsule in the channel.
    pub limit: Option<Curve<'a>>,
    /// Parameters (Ca, a/l) on different sides know nothing of each other; without points it parts nothing.
    pub border: Curve<'a>,
}

impl<'a> Coordinates<'a> {
    /// The coordinates of a model: those of the channel if it has a steady limit.
    pub fn new(contents: &Contents<'a>) -> Self {
        Self {
            scales: contents.kernel.scales,
            limit: (contents.steady_limit.rows > 0).then(|| Curve::new(&contents.steady_limit)),
            border: Curve::new(&contents.border),
        }
    }

    /// Whether the border lies between two pairs of parameters.
    pub fn apart<T: Real>(&self, a: [T; 2], b: [T; 2]) -> bool {
        let [a, b] = [a, b].map(|parameters| self.border.below(parameters));
        a.zip(b).is_some_and(|(a, b)| a != b)
    }

    /// Places around a query.
    pub(super) fn around<T: Real>(&self, query: &Parameters<T>) -> Around<'_, 'a, T> {
        let scales = self.scales.map(T::from_f64);
        let last = query.as_slice().len().saturating_sub(1);
        let scale = scales.get(last).copied().unwrap_or(T::ONE);
        let last = query.get(last);
        let query = query.array();
        let row = Row::new(self, scales[0], query[1]);
        Around {
            coordinates: self,
            scales,
            query,
            scale,
            last,
            root: row.root(query[0]),
            side: self.border.below([query[0], query[1]]),
            row,
        }
    }
}

/// Where samples lie as seen from a query.
#[derive(Debug)]
pub(super) struct Around<'c, 'a, T> {
    coordinates: &'c Coordinates<'a>,
    scales: [T; MAX_PARAMETERS],
    query: [T; MAX_PARAMETERS],
    /// The query's last parameter, and its scale.
    last: T,
    scale: T,
    /// The query's first coordinate in the channel, and its side of the border.
    root: T,
    side: Option<bool>,
    /// Of the sample before: samples come in rows of equal a/l.
    row: Row<T>,
}

impl<T: Real> Around<'_, '_, T> {
    /// The query's last parameter, which is a coordinate but for its scale in the channel too.
    pub(super) fn last(&self) -> T {
        self.last
    }

    /// The scale of the last parameter.
    pub(super) fn scale(&self) -> T {
        self.scale
    }

    /// The place of a sample less the query's, and the square of its length; none if that is no less than `limit`, or if
    /// the border lies between.
    #[inline(always)]
    pub(super) fn offset(&mut self, sample: [T; MAX_PARAMETERS], limit: T) -> Option<(T, [T; MAX_PARAMETERS])> {
        let [first, second, ..] = sample;
        let mut offset = times(self.scales, minus(sample, self.query));
        if second != self.row.second {
            self.row = Row::new(self.coordinates, self.scales[0], second);
        }
        if self.coordinates.limit.is_some() {
            // (a - b)^2 >= c where a^2 + b^2 - c >= 2 a b: most samples need no root.
            let (own, of_query) = (self.row.stretch * first, self.root * self.root);
            let rest = own + of_query + offset[1] * offset[1] - limit;
            if rest > T::ZERO && rest * rest >= T::from_f32(4.0) * own * of_query {
                return None;
            }
            offset[0] = self.row.root(first) - self.root;
        }
        let square = square(offset);
        (square < limit && !self.apart(first)).then_some((square, offset))
    }

    /// Whether the border lies between the query and a sample of the row.
    fn apart(&mut self, capillary_number: T) -> bool {
        let Some(side) = self.side else { return false };
        let curve = &self.coordinates.border;
        let border = *self.row.border.get_or_insert_with(|| curve.within(self.row.second));
        border.is_some_and(|border| (capillary_number < border) != side)
    }
}

/// What parameters of one a/l share.
#[derive(Debug)]
struct Row<T> {
    second: T,
    /// s_0^2 / Ca_lim(a/l)^(1/4)
    stretch: T,
    /// Of the row, if the border reaches there: looked up when a sample is near enough to ask.
    border: Option<Option<T>>,
}

impl<T: Real> Row<T> {
    fn new(coordinates: &Coordinates<'_>, scale: T, second: T) -> Self {
        let limit = coordinates.limit.and_then(|limit| limit.at(second)).unwrap_or(T::ONE);
        Self {
            second,
            stretch: scale * scale / limit.quick_sqrt().quick_sqrt(),
            border: None,
        }
    }

    /// The first coordinate in the channel.
    fn root(&self, capillary_number: T) -> T {
        (self.stretch * capillary_number.max(T::ZERO)).quick_sqrt()
    }
}
