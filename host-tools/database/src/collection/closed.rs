//! Whether triangles make one closed surface.

use std::collections::{BTreeMap, HashMap};

use crate::Mesh;

/// One of the two triangles at an edge.
struct Side {
    element: usize,
    /// Whether the triangle runs along the edge from the lower node to the higher one.
    rising: bool,
    middle: Option<u32>,
}

/// The triangles at each edge, by its nodes, the lower one first.
type Edges = BTreeMap<[u32; 2], Vec<Side>>;

/// Checks that each edge belongs to two triangles, which run along it in opposite directions and share its middle node,
/// that no triangle is degenerate or there twice, and that all nodes are on one connected surface.
///
/// # Errors
/// The first fault, with the numbers of its elements, edges and nodes.
pub(super) fn check(mesh: &Mesh) -> Result<(), String> {
    let mut corners = HashMap::new();
    for (e, element) in mesh.elements.iter().enumerate() {
        let nodes = if is_flat(element) { &element[..3] } else { &element[..] };
        if let Some(node) = (1..nodes.len()).find_map(|k| nodes[..k].iter().find(|node| **node == nodes[k])) {
            let count = nodes.len();
            return Err(format!(
                "`elements`: element {e} names node {node} twice, expected {count} different nodes"
            ));
        }
        let mut sorted = [element[0], element[1], element[2]];
        sorted.sort_unstable();
        if let Some(first) = corners.insert(sorted, e) {
            return Err(format!(
                "`elements`: elements {first} and {e} have the same corners, expected each triangle once"
            ));
        }
    }
    let edges = edges(mesh);
    // A flap has open edges too, and is their cause.
    let flaps = edges.iter().filter(|(_, sides)| sides.len() > 2);
    for (edge, sides) in flaps.chain(&edges) {
        check_edge(*edge, sides).map_err(|fault| match sides.len() {
            1 => {
                let open = edges.values().filter(|sides| sides.len() == 1).count();
                format!("{fault}; there are {open} such edges{}", coincident(mesh))
            }
            _ => fault,
        })?;
    }
    check_parts(mesh, &edges)
}

/// [`Mesh::is_flat`] looks at one mid-edge alone, and a degenerate quadratic triangle may look flat there.
fn is_flat(element: &[u32; 6]) -> bool {
    element[..3] == element[3..]
}

/// The edges of all triangles.
fn edges(mesh: &Mesh) -> Edges {
    let mut edges = Edges::new();
    for (e, element) in mesh.elements.iter().enumerate() {
        for (k, [from, to]) in [[0, 1], [1, 2], [2, 0]]
            .map(|side| side.map(|k| element[k]))
            .into_iter()
            .enumerate()
        {
            edges.entry([from.min(to), from.max(to)]).or_default().push(Side {
                element: e,
                rising: from < to,
                middle: (!is_flat(element)).then_some(element[3 + k]),
            });
        }
    }
    edges
}

fn check_edge([a, b]: [u32; 2], sides: &[Side]) -> Result<(), String> {
    let [one, two] = sides else {
        let elements: Vec<String> = sides.iter().map(|side| side.element.to_string()).collect();
        let elements = elements.join(", ");
        return Err(match sides.len() {
            1 => format!("`elements`: the surface is not closed: edge ({a}, {b}) belongs to element {elements} alone"),
            n => format!("`elements`: edge ({a}, {b}) belongs to {n} elements ({elements}), expected two"),
        });
    };
    let (e, f) = (one.element, two.element);
    if one.rising == two.rising {
        return Err(format!(
            "`elements`: elements {e} and {f} run along edge ({a}, {b}) in the same direction: one is turned over; \
             expected the nodes of all counter-clockwise seen from outside"
        ));
    }
    if one.middle != two.middle {
        let named = |middle: Option<u32>| middle.map_or("none".to_owned(), |node| format!("node {node}"));
        let [first, second] = [one, two].map(|side| named(side.middle));
        return Err(format!(
            "`elements`: the mid-edge node of edge ({a}, {b}) is {first} in element {e} and {second} in element {f}, \
             expected the same"
        ));
    }
    Ok(())
}

/// A hint at nodes that lie at the same place, as in STL files, where each triangle has its own.
fn coincident(mesh: &Mesh) -> String {
    let mut places = HashMap::new();
    let pair = mesh.nodes.iter().enumerate().find_map(|(node, position)| {
        let key = position.map(|x| (x + 0.0).to_bits());
        places.insert(key, node).map(|first| (first, node))
    });
    pair.map_or(String::new(), |(first, second)| {
        format!("; nodes {first} and {second} lie at the same place: merge such nodes by numpy.unique")
    })
}

/// Checks that all nodes are used, and that edges join all triangles.
fn check_parts(mesh: &Mesh, edges: &Edges) -> Result<(), String> {
    let mut used = vec![false; mesh.nodes.len()];
    for node in mesh.elements.as_flattened() {
        used[*node as usize] = true;
    }
    if let Some(node) = used.iter().position(|used| !used) {
        let unused = used.iter().filter(|used| !**used).count();
        return Err(format!(
            "`positions`: node {node} belongs to no element ({unused} such nodes), expected all nodes on the surface"
        ));
    }
    let mut neighbours = vec![Vec::new(); mesh.elements.len()];
    for sides in edges.values() {
        for side in sides {
            neighbours[side.element].extend(sides.iter().map(|side| side.element));
        }
    }
    let mut reached = vec![false; mesh.elements.len()];
    let mut waiting = vec![0];
    while let Some(e) = waiting.pop() {
        if !std::mem::replace(&mut reached[e], true) {
            waiting.extend(neighbours[e].iter().filter(|e| !reached[**e]));
        }
    }
    match reached.iter().position(|reached| !reached) {
        None => Ok(()),
        Some(e) => Err(format!(
            "`elements`: no edges lead from element 0 to element {e}: the surface is in several parts, expected one"
        )),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::tests::octahedral;

    /// The corners of the quadratic triangles alone, or with mid-edges all four triangles of each.
    fn flat() -> Mesh {
        let mesh = octahedral(2);
        let parts = [[0, 3, 5], [3, 1, 4], [5, 4, 2], [3, 4, 5]];
        let split = |element: &[u32; 6]| parts.map(|[a, b, c]| [a, b, c, a, b, c].map(|place| element[place]));
        Mesh {
            elements: mesh.elements.iter().flat_map(split).collect(),
            nodes: mesh.nodes,
        }
    }

    fn refused(change: impl Fn(&mut Mesh), words: &[&str]) {
        for mut mesh in [flat(), octahedral(2)] {
            change(&mut mesh);
            let error = check(&mesh).unwrap_err();
            assert!(words.iter().all(|word| error.contains(word)), "{error}");
        }
    }

    #[test]
    fn closed_surfaces_are_accepted() {
        check(&flat()).unwrap();
        check(&octahedral(2)).unwrap();
    }

    #[test]
    fn holes_flaps_and_overturned_triangles_are_named() {
        let element = octahedral(2).elements[5];
        let edge = [element[0].min(element[1]), element[0].max(element[1])];
        let hole = check(&Mesh {
            elements: octahedral(2)
                .elements
                .into_iter()
                .filter(|other| *other != element)
                .collect(),
            ..octahedral(2)
        });
        let hole = hole.unwrap_err();
        assert!(hole.contains("not closed") && hole.contains("3 such edges"), "{hole}");
        assert!(!hole.contains("same place"), "{hole}");
        let flap = |mesh: &mut Mesh| {
            let [a, b, ..] = mesh.elements[5];
            let far = mesh.elements[mesh.elements.len() - 1][0];
            mesh.elements.push([a, b, far, a, b, far]);
        };
        refused(flap, &["3 elements (", "expected two"]);
        let overturned = |mesh: &mut Mesh| {
            let [a, b, c, d, e, f] = mesh.elements[5];
            mesh.elements[5] = if a == d { [a, c, b, a, c, b] } else { [a, c, b, f, e, d] };
        };
        refused(overturned, &["5", "same direction", "turned over"]);
        let mut mesh = octahedral(2);
        mesh.elements[5][3] = mesh.elements[20][3];
        let error = check(&mesh).unwrap_err();
        let expected = format!("edge ({}, {}) is node", edge[0], edge[1]);
        assert!(error.contains(&expected) && error.contains("element 5"), "{error}");
    }

    #[test]
    fn degenerate_and_double_triangles_are_named() {
        refused(
            |mesh| mesh.elements[4][2] = mesh.elements[4][1],
            &["element 4", "twice"],
        );
        let double = |mesh: &mut Mesh| {
            let [a, b, c, ..] = mesh.elements[3];
            mesh.elements.push([b, c, a, b, c, a]);
        };
        refused(double, &["elements 3 and", "same corners"]);
    }

    #[test]
    fn unused_nodes_and_second_parts_are_named() {
        refused(
            |mesh| mesh.nodes.insert(66, [0.0; 3]),
            &["node 66", "no element", "1 such"],
        );
        let two = |mesh: &mut Mesh| {
            let count = mesh.elements.len();
            let shift = mesh.nodes.len() as u32;
            mesh.nodes.extend_from_within(..);
            mesh.elements.extend_from_within(..);
            mesh.elements[count..]
                .as_flattened_mut()
                .iter_mut()
                .for_each(|node| *node += shift);
        };
        refused(two, &["several parts", "element 0"]);
    }

    #[test]
    fn triangles_with_nodes_of_their_own_are_told_to_merge_them() {
        let mesh = flat();
        let nodes: Vec<[f64; 3]> = mesh
            .elements
            .iter()
            .flat_map(|e| [e[0], e[1], e[2]])
            .map(|n| mesh.nodes[n as usize])
            .collect();
        let own = |e: u32| [3 * e, 3 * e + 1, 3 * e + 2];
        let elements = (0..mesh.elements.len() as u32)
            .map(own)
            .map(|[a, b, c]| [a, b, c, a, b, c])
            .collect();
        let error = check(&Mesh { nodes, elements }).unwrap_err();
        assert!(
            error.contains("not closed") && error.contains("numpy.unique"),
            "{error}"
        );
    }
}
