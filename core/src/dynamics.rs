//! Reduced time stepping.
#[derive(Clone, Debug)]
pub(crate) struct Dynamics<T, const K: usize, const M: usize> {
    q: [[T; M]; M],
    w: [[T; M]; K],
}
impl<T: crate::Real, const K: usize, const M: usize> Dynamics<T, K, M> {
    pub(crate) const EMPTY: Self = Self {
        q: [[T::ZERO; M]; M],
        w: [[T::ZERO; M]; K],
    };
    pub(crate) fn forget(&mut self) {}
}
