//! Collections of arrays in memory.

use ndarray::ArrayD;
use py_literal::Value;

use super::arrays::Arrays;
use super::dtype::{NUMBERS, TEXTS, refused};
use crate::DatabaseError;

/// An array in memory.
#[derive(Debug, Clone, PartialEq)]
pub struct NamedArray {
    /// Its name, see [`super`].
    pub name: String,
    /// Its element type, as NumPy describes it: `<f8`.
    pub descriptor: String,
    /// Its elements.
    pub elements: Elements,
}

/// The elements of an array.
#[derive(Debug, Clone, PartialEq)]
pub enum Elements {
    /// Integers or real numbers.
    Numbers(ArrayD<f64>),
    /// Texts.
    Texts(Vec<String>),
    /// Others, which no collection has.
    Others,
}

/// Arrays in memory, each of which is asked for once.
pub(crate) struct Memory {
    arrays: Vec<NamedArray>,
    names: Vec<String>,
}

impl Memory {
    pub(crate) fn new(arrays: Vec<NamedArray>) -> Self {
        let mut names: Vec<String> = arrays.iter().map(|array| array.name.clone()).collect();
        names.sort_unstable();
        Self { arrays, names }
    }

    /// Takes out the elements that `of` takes; `expected` says which.
    fn take<T>(
        &mut self,
        name: &str,
        (expected, remedy): (&str, Option<&'static str>),
        of: impl Fn(Elements) -> Option<T>,
    ) -> Result<T, DatabaseError> {
        let index = self.arrays.iter().position(|array| array.name == name);
        let index = index.ok_or_else(|| DatabaseError::collection(format!("array `{name}` is missing")))?;
        let array = self.arrays.swap_remove(index);
        let kind = Value::String(array.descriptor);
        of(array.elements).ok_or_else(|| refused(name, &kind, expected, remedy))
    }
}

impl Arrays for Memory {
    fn names(&self) -> &[String] {
        &self.names
    }

    fn numbers(&mut self, name: &str) -> Result<ArrayD<f64>, DatabaseError> {
        self.take(name, NUMBERS, |elements| match elements {
            Elements::Numbers(numbers) => Some(numbers),
            Elements::Texts(_) | Elements::Others => None,
        })
    }

    fn texts(&mut self, name: &str) -> Result<Vec<String>, DatabaseError> {
        self.take(name, TEXTS, |elements| match elements {
            Elements::Texts(texts) => Some(texts),
            Elements::Numbers(_) | Elements::Others => None,
        })
    }
}
