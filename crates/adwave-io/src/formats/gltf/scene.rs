//! Meshes of the scene and their transforms.

use super::document::Document;
use super::json::Json;
use super::matrix::{IDENTITY, Matrix, of_node, product};
use crate::ReadError;

/// Largest number of nodes on a path of the tree.
const DEEPEST: usize = 1 << 16;

/// Mesh placed by a node.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Instance {
    /// Index of the node; `None` if there are no nodes.
    pub(crate) node: Option<usize>,
    pub(crate) mesh: usize,
    pub(crate) matrix: Matrix,
}

/// Meshes of the default scene in the order of its nodes; without a scene those of all nodes, without nodes all
/// meshes.
pub(crate) fn instances(document: &Document) -> Result<Vec<Instance>, ReadError> {
    let json = &document.json;
    let (nodes, scenes) = (json.list_of("nodes"), json.list_of("scenes"));
    if nodes.is_empty() {
        let n_meshes = json.list_of("meshes").len();
        return Ok((0..n_meshes).map(|mesh| Instance { node: None, mesh, matrix: IDENTITY }).collect());
    }
    let roots = match scenes.get(json.index_of("scene").unwrap_or(0)) {
        Some(scene) => scene.list_of("nodes").iter().filter_map(Json::index).collect(),
        None => roots(nodes),
    };
    let mut found = Vec::new();
    let mut seen = vec![false; nodes.len()];
    // Nodes to be visited, the next one last.
    let mut open: Vec<(usize, Matrix, usize)> =
        roots.into_iter().rev().map(|node| (node, IDENTITY, 0)).collect();
    while let Some((k, parent, depth)) = open.pop() {
        let Some(node) = nodes.get(k) else {
            return Err(ReadError::Whole(format!(
                "node {k} is referenced but does not exist; export the file again"
            )));
        };
        if std::mem::replace(&mut seen[k], true) || depth > DEEPEST {
            return Err(ReadError::Whole(format!(
                "node {k} has two parents or is its own ancestor; export the file again"
            )));
        }
        let own = of_node(node);
        let matrix = own.map_or(parent, |own| product(&parent, &own));
        if let Some(mesh) = node.index_of("mesh") {
            // A skinned mesh is moved by joints, not by nodes.
            let matrix = if node.get("skin").is_some() { IDENTITY } else { matrix };
            if !matrix.as_flattened().iter().all(|x| x.is_finite()) {
                return Err(ReadError::Whole(format!(
                    "the transform of node {k} must be finite; export the file again"
                )));
            }
            found.push(Instance { node: Some(k), mesh, matrix });
        }
        let children = node.list_of("children").iter().rev().filter_map(Json::index);
        open.extend(children.map(|child| (child, matrix, depth + 1)));
    }
    Ok(found)
}

/// Nodes without a parent.
fn roots(nodes: &[Json]) -> Vec<usize> {
    let mut is_child = vec![false; nodes.len()];
    for child in nodes.iter().flat_map(|node| node.list_of("children")).filter_map(Json::index) {
        if let Some(is_child) = is_child.get_mut(child) {
            *is_child = true;
        }
    }
    (0..nodes.len()).filter(|&k| !is_child[k]).collect()
}
