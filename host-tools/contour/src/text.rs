//! Contours from text files, as ImageJ, MATLAB, dclab and spreadsheets write them.

/// Unit of a contour's coordinates.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Unit {
    /// Micrometres
    Um,
    /// Pixels
    Px,
}

/// A contour as the file has it.
#[derive(Clone, Debug, PartialEq)]
pub struct ContourText {
    /// The points.
    pub points: Vec<[f64; 2]>,
    /// The unit, if the headings name one.
    pub unit: Option<Unit>,
    /// Notes on the file, in words.
    pub format: String,
}

/// The fault of a contour's text.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum TextError {
    /// Nothing that looks like points.
    #[error("it holds no line with two numbers: expected the points' coordinates, one point a line")]
    NoPoints,
    /// A cell that should be a number.
    #[error("line {line}: \"{cell}\" is no number")]
    NoNumber {
        /// Number of the line, from 1.
        line: usize,
        /// The cell.
        cell: String,
    },
    /// More columns than two, and no headings that tell which count.
    #[error(
        "it has {width} columns{}{names}: two are needed, or headings that begin with x and y",
        if names.is_empty() { "" } else { ": " }
    )]
    Columns {
        /// How many.
        width: usize,
        /// Their headings, if there are any.
        names: String,
    },
    /// The headings name another unit than the caller.
    #[error("its headings say {named} and the unit is given as {given}: one of them is wrong")]
    Units {
        /// The headings' unit.
        named: Unit,
        /// The caller's.
        given: Unit,
    },
    /// No unit is known.
    #[error("the unit of its numbers is not known: say that it is um, or give the size of a pixel")]
    NoUnit,
    /// Pixels of unknown size.
    #[error("it is in pixels: give the size of a pixel")]
    NoScale,
}

impl std::fmt::Display for Unit {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(match self {
            Self::Um => "um",
            Self::Px => "pixels",
        })
    }
}

/// Reads two columns of a text.
///
/// # Errors
/// A text without two columns of numbers.
pub fn read(bytes: &[u8]) -> Result<ContourText, TextError> {
    parse(&decode(bytes))
}

/// Text in UTF-8 or UTF-16 with its mark, else in the Western code page of old spreadsheets.
fn decode(bytes: &[u8]) -> String {
    let wide = |bytes: &[u8], read: fn([u8; 2]) -> u16| {
        let units: Vec<u16> = bytes.as_chunks().0.iter().map(|pair| read(*pair)).collect();
        String::from_utf16_lossy(&units)
    };
    match bytes {
        [0xef, 0xbb, 0xbf, rest @ ..] => String::from_utf8_lossy(rest).into_owned(),
        [0xff, 0xfe, rest @ ..] => wide(rest, u16::from_le_bytes),
        [0xfe, 0xff, rest @ ..] => wide(rest, u16::from_be_bytes),
        _ => match std::str::from_utf8(bytes) {
            Ok(text) => text.to_owned(),
            Err(_) => bytes.iter().map(|&byte| char::from(byte)).collect(),
        },
    }
}

/// How the cells of a line are parted.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Separator {
    Tab,
    Semicolon,
    Comma,
    Spaces,
}

impl Separator {
    /// That of a line of numbers.
    fn of(line: &str) -> Self {
        if line.contains('\t') {
            Self::Tab
        } else if line.contains(';') {
            Self::Semicolon
        } else if line.contains(", ") || (line.contains(',') && !line.trim().contains(' ')) {
            Self::Comma
        } else {
            Self::Spaces
        }
    }

    fn name(self) -> &'static str {
        match self {
            Self::Tab => "tabs",
            Self::Semicolon => "semicolons",
            Self::Comma => "commas",
            Self::Spaces => "spaces",
        }
    }

    fn cells(self, line: &str) -> Vec<&str> {
        let cells: Vec<&str> = match self {
            Self::Tab => line.split('\t').collect(),
            Self::Semicolon => line.split(';').collect(),
            Self::Comma => line.split(',').collect(),
            Self::Spaces => line.split_whitespace().collect(),
        };
        cells
            .into_iter()
            .map(|cell| cell.trim().trim_matches('"').trim())
            .collect()
    }

    fn number(self, cell: &str) -> Option<f64> {
        let value = match self {
            Self::Comma => cell.parse(),
            _ => cell.replace(',', ".").parse(),
        };
        value.ok().filter(|value: &f64| value.is_finite())
    }
}

fn parse(text: &str) -> Result<ContourText, TextError> {
    let lines: Vec<(usize, &str)> = text
        .lines()
        .enumerate()
        .map(|(number, line)| (number + 1, line.trim_end()))
        .filter(|(_, line)| !line.trim().is_empty() && !line.trim_start().starts_with(['#', '%']))
        .collect();
    let numbers = |line: &str| {
        let separator = Separator::of(line);
        let cells = separator.cells(line);
        cells.iter().filter(|cell| separator.number(cell).is_some()).count()
    };
    let first = lines.iter().position(|(_, line)| numbers(line) >= 2);
    let first = first.ok_or(TextError::NoPoints)?;
    let separator = Separator::of(lines[first].1);
    let headings = first.checked_sub(1).map(|above| separator.cells(lines[above].1));
    let rows: Vec<(usize, Vec<&str>)> = lines[first..]
        .iter()
        .map(|(number, line)| (*number, separator.cells(line)))
        .collect();
    let width = rows[0].1.len();
    let headings = headings.filter(|headings| headings.len() == width);
    let [x, y] = columns(headings.as_deref(), &rows, separator)?;
    let mut points = Vec::with_capacity(rows.len());
    for (number, cells) in &rows {
        let value = |column: usize| {
            let cell = cells.get(column).copied().unwrap_or_default();
            let value = separator.number(cell);
            value.ok_or_else(|| TextError::NoNumber {
                line: *number,
                cell: cell.to_owned(),
            })
        };
        points.push([value(x)?, value(y)?]);
    }
    // Some programs close the polygon by its first point.
    if points.len() > 1 && points.first() == points.last() {
        points.pop();
    }
    let unit = headings.as_ref().and_then(|headings| unit(headings[x]));
    let format = format!(
        "{} points, columns {} and {} of {width}, parted by {}{}",
        points.len(),
        x + 1,
        y + 1,
        separator.name(),
        match unit {
            Some(Unit::Um) => ", in um",
            Some(Unit::Px) => ", in pixels",
            None => "",
        }
    );
    Ok(ContourText { points, unit, format })
}

/// The columns of x and y: by their headings, else the only two, or the two behind an index.
fn columns(
    headings: Option<&[&str]>,
    rows: &[(usize, Vec<&str>)],
    separator: Separator,
) -> Result<[usize; 2], TextError> {
    let width = rows[0].1.len();
    if let Some(headings) = headings {
        let named = |name: char| {
            let is = |heading: &&str| {
                let heading = heading.trim_start_matches("pos_").to_ascii_lowercase();
                let mut letters = heading.chars();
                letters.next() == Some(name) && !letters.next().is_some_and(char::is_alphanumeric)
            };
            headings.iter().position(is)
        };
        if let (Some(x), Some(y)) = (named('x'), named('y')) {
            return Ok([x, y]);
        }
    }
    let index = || {
        let steps = rows.windows(2).map(|pair| {
            let value = |row: &(usize, Vec<&str>)| row.1.first().and_then(|cell| separator.number(cell));
            value(&pair[1]).zip(value(&pair[0])).map(|(b, a)| b - a)
        });
        rows.len() > 1 && steps.into_iter().all(|step| step == Some(1.0))
    };
    match width {
        2 => Ok([0, 1]),
        3 if index() => Ok([1, 2]),
        _ => Err(TextError::Columns {
            width,
            names: headings.map(|headings| headings.join(", ")).unwrap_or_default(),
        }),
    }
}

/// The unit that a heading names.
fn unit(heading: &str) -> Option<Unit> {
    let heading = heading.to_lowercase();
    let has = |names: &[&str]| names.iter().any(|name| heading.contains(name));
    if has(&["um", "\u{b5}m", "\u{3bc}m", "micron", "micromet"]) {
        Some(Unit::Um)
    } else if has(&["px", "pix"]) {
        Some(Unit::Px)
    } else {
        None
    }
}

impl ContourText {
    /// The points in um; `given` is the unit that the caller states.
    ///
    /// # Errors
    /// A unit that is not known or contradicts the headings; pixels of unknown size.
    pub fn in_um(&self, given: Option<Unit>, pixel_um: Option<f64>) -> Result<Vec<[f64; 2]>, TextError> {
        if let (Some(named), Some(given)) = (self.unit, given)
            && named != given
        {
            return Err(TextError::Units { named, given });
        }
        let unit = given.or(self.unit).or(pixel_um.map(|_| Unit::Px));
        match (unit, pixel_um) {
            (None, _) => Err(TextError::NoUnit),
            (Some(Unit::Px), None) => Err(TextError::NoScale),
            (Some(Unit::Um), _) => Ok(self.points.clone()),
            (Some(Unit::Px), Some(pixel)) => Ok(self.points.iter().map(|point| point.map(|x| x * pixel)).collect()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn points(text: &str) -> Vec<[f64; 2]> {
        parse(text).unwrap().points
    }

    #[test]
    fn the_ways_in_which_programs_write_points() {
        let expected = vec![[1.5, 2.25], [3.0, 4.5], [5.5, 6.0]];
        for text in [
            // ImageJ, XY coordinates; Results table with index and headings; MATLAB; spreadsheets of other languages.
            "1.5\t2.25\n3\t4.5\n5.5\t6\n",
            " ,X,Y\n1,1.5,2.25\n2,3,4.5\n3,5.5,6\n",
            "1\t1.5\t2.25\n2\t3\t4.5\n3\t5.5\t6\n",
            "1.5000000e+00,2.2500000e+00\r\n3,4.5\r\n5.5,6\r\n",
            "\"X\";\"Y\"\n1,5;2,25\n3;4,5\n5,5;6\n",
            "x (\u{b5}m); y (\u{b5}m)\n1,5;2,25\n3,0;4,5\n5,5;6,0\n",
            "   1.5   2.25\n   3.0   4.5\n   5.5   6.0\n",
            "1,5 2,25\n3 4,5\n5,5 6\n",
            "# exported\n\nframe,area,x_um,y_um\n7,1,1.5,2.25\n7,1,3,4.5\n7,1,5.5,6\n",
            // Closed by its first point.
            "1.5, 2.25\n3, 4.5\n5.5, 6\n1.5, 2.25\n",
        ] {
            assert_eq!(points(text), expected, "{text}");
        }
    }

    #[test]
    fn marks_and_code_pages() {
        let text = "X [\u{b5}m]\tY [\u{b5}m]\n1\t2\n3\t4\n";
        let wide: Vec<u8> = [0xfeff]
            .into_iter()
            .chain(text.encode_utf16())
            .flat_map(u16::to_le_bytes)
            .collect();
        let latin: Vec<u8> = text.chars().map(|c| c as u8).collect();
        let marked = [&[0xef, 0xbb, 0xbf], text.as_bytes()].concat();
        for bytes in [wide, latin, marked, text.as_bytes().to_vec()] {
            let contour = parse(&decode(&bytes)).unwrap();
            assert_eq!(
                (contour.points, contour.unit),
                (vec![[1.0, 2.0], [3.0, 4.0]], Some(Unit::Um))
            );
        }
    }

    #[test]
    fn what_is_wrong_is_named() {
        let error = |text: &str| parse(text).unwrap_err().to_string();
        assert!(error("").contains("no line with two numbers"));
        assert!(error("a,b\nc,d\n").contains("no line with two numbers"));
        assert!(error("1,2,3\n4,5,6\n").contains("3 columns"));
        assert_eq!(error("1,2\n3,nan\n"), "line 2: \"nan\" is no number");
        assert!(error("area,mean,length\n1,2,3\n1,2,3\n").contains("area, mean, length"));
        let contour = parse("1,2\n3,4\n").unwrap();
        let error = |given, pixel| contour.in_um(given, pixel).unwrap_err().to_string();
        assert!(error(None, None).contains("say that it is um"));
        assert!(error(Some(Unit::Px), None).contains("size of a pixel"));
        assert_eq!(contour.in_um(None, Some(0.5)).unwrap(), [[0.5, 1.0], [1.5, 2.0]]);
    }
}
