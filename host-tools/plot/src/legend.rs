//! The legend of a panel's colours: a line of entries, or more, between the title and the axes, where they hide
//! nothing.

use crate::mark::Mark;
use crate::{MARGIN, SMALL, TEXT, text};
use plotters::coord::Shift;
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};

/// Height of a line of entries, length of the stroke before a name, and the room around it.
const LINE: u32 = 20;
const STROKE: u32 = 16;
const GAP: u32 = 6;

/// A colour and its meaning.
pub(crate) struct Entry {
    pub(crate) name: String,
    pub(crate) colour: RGBColor,
    /// The curves that are drawn in this colour.
    pub(crate) marks: Vec<Mark>,
}

/// Entries with their places.
pub(crate) struct Legend {
    /// With the place of the left end and of the line, from the upper left corner.
    entries: Vec<(Entry, (u32, u32))>,
    lines: u32,
}

impl Legend {
    /// Lays entries out over a width.
    pub(crate) fn new(entries: Vec<Entry>, width: u32) -> Self {
        let (mut x, mut line) = (MARGIN, 0);
        let mut placed = Vec::new();
        for entry in entries {
            let needed = STROKE + GAP + width_of(&entry.name) + 2 * GAP;
            if x > MARGIN && x + needed > width - MARGIN {
                (x, line) = (MARGIN, line + 1);
            }
            placed.push((entry, (x, line)));
            x += needed;
        }
        let lines = if placed.is_empty() { 0 } else { line + 1 };
        Self { entries: placed, lines }
    }

    pub(crate) fn height(&self) -> u32 {
        // Some room above the axes.
        self.lines * LINE + GAP
    }

    pub(crate) fn draw<B: DrawingBackend>(
        &self,
        area: &DrawingArea<B, Shift>,
        unit: u32,
    ) -> Result<(), Box<dyn std::error::Error>>
    where
        B::ErrorType: 'static,
    {
        let style = text(SMALL, unit).pos(Pos::new(HPos::Left, VPos::Center));
        let at = |x: u32, y: u32| ((x * unit) as i32, (y * unit) as i32);
        for (entry, (x, line)) in &self.entries {
            let middle = line * LINE + LINE / 2;
            let centre = at(x + STROKE / 2, middle);
            for mark in &entry.marks {
                match mark {
                    Mark::Line => {
                        let ends = [at(*x, middle), at(x + STROKE, middle)];
                        area.draw(&PathElement::new(ends, entry.colour.stroke_width(2 * unit)))?;
                    }
                    Mark::Dots => area.draw(&Circle::new(centre, 3 * unit, entry.colour.filled()))?,
                    Mark::Rings => area.draw(&Circle::new(centre, 5 * unit, entry.colour.stroke_width(2 * unit)))?,
                }
            }
            area.draw_text(&entry.name, &style, at(x + STROKE + GAP, middle))?;
        }
        Ok(())
    }
}

/// Width of a text in the font that travels with the program; others are little wider.
fn width_of(words: &str) -> u32 {
    let size = FontDesc::from((TEXT, f64::from(SMALL))).box_size(words);
    // Without the font the drawing fails with its own error.
    size.map_or(0, |(width, _)| width + width / 10)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn entries_wrap_where_the_width_ends() {
        crate::register_font();
        let entries = |count: usize| {
            let entry = |i| Entry {
                name: format!("series {i}"),
                colour: BLACK,
                marks: vec![Mark::Line],
            };
            (0..count).map(entry).collect()
        };
        assert_eq!(Legend::new(entries(0), 400).lines, 0);
        assert_eq!(Legend::new(entries(2), 400).lines, 1);
        let legend = Legend::new(entries(9), 400);
        assert!((2..=4).contains(&legend.lines));
        for (entry, (x, _)) in &legend.entries {
            assert!(x + STROKE + GAP + width_of(&entry.name) <= 400 - MARGIN);
        }
    }
}
