//! A VTU file: positions, velocities and triangles of its pieces.

use roxmltree::Node;

use super::encoding::Encoding;
use super::markup::Markup;
use crate::vtu::{QUADRATIC_TRIANGLE, TRIANGLE};

/// VTK's types of points and lines: meshers write them beside the triangles.
const BESIDE: [u8; 5] = [1, 2, 3, 4, 21];

/// The surface at one instant, its pieces one after the other.
#[derive(Debug, Default, PartialEq)]
pub(super) struct Snapshot {
    pub positions: Vec<[f64; 3]>,
    /// If all pieces have them.
    pub velocities: Option<Vec<[f64; 3]>>,
    /// As in [`Mesh`](crate::Mesh), nodes counted through all pieces.
    pub triangles: Vec<[u32; 6]>,
    /// The number of nodes of each piece.
    pub pieces: Vec<usize>,
    /// How many points and lines were among the cells.
    pub left_out: usize,
}

impl Snapshot {
    /// Reads a file.
    ///
    /// # Errors
    /// Missing, malformed and unsupported content, with the array and the cell.
    pub fn parse(bytes: &[u8]) -> Result<Self, String> {
        let markup = Markup::new(bytes)?;
        let document = markup.document("UnstructuredGrid")?;
        let encoding = Encoding::new(document.root_element(), markup.appended())?;
        let pieces: Vec<Node> = document
            .descendants()
            .filter(|node| node.has_tag_name("Piece"))
            .collect();
        if pieces.is_empty() {
            return Err("no Piece, expected an unstructured grid of at least one".to_owned());
        }
        let mut whole = Self::default();
        for (index, node) in pieces.iter().enumerate() {
            let piece = Piece {
                node: *node,
                encoding: &encoding,
            };
            let place = |reason: String| match pieces.len() {
                1 => reason,
                _ => format!("piece {index}: {reason}"),
            };
            let part = piece.read().map_err(place)?;
            whole.append(part).map_err(place)?;
        }
        Ok(whole)
    }

    /// Takes the pieces of another one too; empty ones are none.
    ///
    /// # Errors
    /// Flat and quadratic triangles in one surface, velocities in some pieces alone.
    pub fn append(&mut self, other: Self) -> Result<(), String> {
        if other.positions.is_empty() {
            return Ok(());
        }
        let flat = |snapshot: &Self| snapshot.triangles.first().map(crate::Mesh::is_flat);
        if let (Some(expected), Some(found)) = (flat(self), flat(&other))
            && expected != found
        {
            let kinds = ["quadratic triangles (22)", "triangles (5)"];
            let [found, expected] = [found, expected].map(|flat| kinds[usize::from(flat)]);
            return Err(format!(
                "{found}, but the pieces before have {expected}; expected one kind"
            ));
        }
        let nodes = self.positions.len();
        if nodes > 0 && self.velocities.is_some() != other.velocities.is_some() {
            return Err("array `velocity` is in some pieces alone, expected in all or none".to_owned());
        }
        self.velocities = match (self.velocities.take(), other.velocities) {
            (Some(first), Some(second)) => Some([first, second].concat()),
            (_, second) => second,
        };
        let shifted = other
            .triangles
            .iter()
            .map(|triangle| triangle.map(|node| node + nodes as u32));
        self.triangles.extend(shifted);
        self.positions.extend(other.positions);
        self.pieces.extend(other.pieces);
        self.left_out += other.left_out;
        Ok(())
    }
}

/// A `Piece` of a file.
struct Piece<'a> {
    node: Node<'a, 'a>,
    encoding: &'a Encoding<'a>,
}

impl<'a> Piece<'a> {
    fn read(&self) -> Result<Snapshot, String> {
        let [nodes, cells] = ["NumberOfPoints", "NumberOfCells"].map(|name| self.count(name));
        let (nodes, cells) = (nodes?, cells?);
        if nodes == 0 {
            return Ok(Snapshot::default());
        }
        let points = self.arrays("Points");
        let [points] = points[..] else {
            return Err(format!("{} arrays in Points, expected one", points.len()));
        };
        let positions = self.vectors(points, points.attribute("Name").unwrap_or("Points"), nodes)?;
        let velocity = self.array("PointData", "velocity")?;
        let velocities = velocity
            .map(|array| self.vectors(array, "velocity", nodes))
            .transpose()?;
        let (triangles, left_out) = self.triangles(nodes, cells)?;
        Ok(Snapshot {
            positions,
            velocities,
            triangles,
            pieces: vec![nodes],
            left_out,
        })
    }

    fn count(&self, name: &str) -> Result<usize, String> {
        let text = self
            .node
            .attribute(name)
            .ok_or_else(|| format!("Piece has no `{name}`"))?;
        // Node numbers have 32 bits.
        let count = text
            .trim()
            .parse::<u32>()
            .map_err(|_| format!("`{name}` is `{text}`, expected a whole number"))?;
        Ok(count as usize)
    }

    /// All arrays of a group.
    fn arrays(&self, group: &str) -> Vec<Node<'a, 'a>> {
        let groups = self.node.children().filter(|node| node.has_tag_name(group));
        let arrays = groups.flat_map(|group| group.children());
        arrays.filter(|node| node.has_tag_name("DataArray")).collect()
    }

    /// The array of that name, if there is one.
    fn array(&self, group: &str, name: &str) -> Result<Option<Node<'a, 'a>>, String> {
        let mut arrays = self.arrays(group);
        arrays.retain(|array| array.attribute("Name") == Some(name));
        match arrays.len() {
            0 | 1 => Ok(arrays.pop()),
            count => Err(format!("{count} arrays `{name}` in {group}, expected one")),
        }
    }

    fn vectors(&self, array: Node, name: &str, count: usize) -> Result<Vec<[f64; 3]>, String> {
        let named = |reason: String| format!("array `{name}`: {reason}");
        if let Some(found) = array
            .attribute("NumberOfComponents")
            .filter(|found| found.trim() != "3")
        {
            return Err(named(format!("{found} components, expected 3")));
        }
        let values = self.encoding.numbers(array, 3 * count).map_err(named)?;
        Ok(values.as_chunks().0.to_vec())
    }

    /// The numbers of an array in Cells.
    fn cells(&self, name: &str, count: usize) -> Result<Vec<f64>, String> {
        let array = self.array("Cells", name)?;
        let array = array.ok_or_else(|| format!("array `{name}` in Cells is missing"))?;
        let numbers = self.encoding.numbers(array, count);
        numbers.map_err(|reason| format!("array `{name}`: {reason}"))
    }

    /// The triangles, and how many points and lines there were beside.
    fn triangles(&self, nodes: usize, cells: usize) -> Result<(Vec<[u32; 6]>, usize), String> {
        self.refuse_ghosts(cells)?;
        let types = self.cells("types", cells)?;
        let kept = |kind: &f64| [TRIANGLE, QUADRATIC_TRIANGLE].map(f64::from).contains(kind);
        let kind = types.iter().copied().find(kept);
        if let Some((cell, found)) = types.iter().enumerate().find(|(_, found)| {
            let beside = BESIDE.map(f64::from).contains(found);
            !beside && Some(**found) != kind
        }) {
            return Err(other_cell(cell, *found, kind));
        }
        let corners = if kind == Some(f64::from(TRIANGLE)) { 3 } else { 6 };
        let ends = self.cells("offsets", cells)?;
        let mut start = 0.0;
        for (cell, (end, found)) in ends.iter().zip(&types).enumerate() {
            let length = end - start;
            if length < 0.0 || end.fract() != 0.0 || (kept(found) && length != f64::from(corners)) {
                let reason = format!("cell {cell} of type {found} spans {start} to {end}, expected {corners} nodes");
                return Err(format!("array `offsets`: {reason}"));
            }
            start = *end;
        }
        let connectivity = self.cells("connectivity", start as usize)?;
        let mut triangles = Vec::new();
        for (cell, (end, _)) in ends
            .iter()
            .zip(&types)
            .enumerate()
            .filter(|(_, (_, found))| kept(found))
        {
            let end = *end as usize;
            let members = &connectivity[end - corners as usize..end];
            let exists = |node: &f64| (0.0..nodes as f64).contains(node) && node.fract() == 0.0;
            if let Some(node) = members.iter().find(|node| !exists(node)) {
                let last = nodes - 1;
                return Err(format!(
                    "array `connectivity`: cell {cell} has the node {node}, expected 0 to {last}"
                ));
            }
            let place = |k: usize| if k < members.len() { k } else { k - 3 };
            triangles.push(std::array::from_fn(|k| members[place(k)] as u32));
        }
        let left_out = types.len() - triangles.len();
        Ok((triangles, left_out))
    }

    /// Ghosts are copies of other pieces' cells.
    fn refuse_ghosts(&self, cells: usize) -> Result<(), String> {
        let Some(array) = self.array("CellData", "vtkGhostType")? else {
            return Ok(());
        };
        let values = self
            .encoding
            .numbers(array, cells)
            .map_err(|reason| format!("array `vtkGhostType`: {reason}"))?;
        match values.iter().position(|value| *value != 0.0) {
            None => Ok(()),
            Some(cell) => Err(format!(
                "array `vtkGhostType`: cell {cell} is a ghost; save the surface without ghost cells"
            )),
        }
    }
}

/// Refuses a cell that is of another type than the triangles.
fn other_cell(cell: usize, found: f64, kind: Option<f64>) -> String {
    let name = match found as u8 {
        TRIANGLE => " (triangle)",
        6 => " (triangle strip)",
        7 => " (polygon)",
        8 => " (pixel)",
        9 => " (quadrilateral)",
        10 => " (tetrahedron)",
        12 => " (hexahedron)",
        QUADRATIC_TRIANGLE => " (quadratic triangle)",
        23 | 28 => " (quadratic quadrilateral)",
        24 => " (quadratic tetrahedron)",
        34 => " (triangle of seven nodes)",
        69 => " (Lagrange triangle)",
        76 => " (Bezier triangle)",
        _ => "",
    };
    let expected = match kind {
        Some(kind) => format!("type {kind} as the others"),
        None => "triangles (5) or quadratic ones (22)".to_owned(),
    };
    format!("array `types`: cell {cell} is of type {found}{name}; expected {expected}")
}
