//! Normals of a coarse shape.

use crate::DeformError;
use crate::rotation::{NO_TURN, add_outer, normalized, symmetric_eigen};
use adwave::shape::face_vertex_normals;
use adwave::signal::{OutwardError, outward_normals};
use adwave::vector::{Vector, cross, dot, subtract};
use adwave::{Decomposer, Progress};

/// Unit normals of the welded vertices on a coarse shape: of the faces of a mesh; of planes through the neighbors in a
/// cloud, on the side of the outside. Zero where there is none.
pub(crate) fn base_normals(
    decomposer: &Decomposer,
    base: &[Vector],
    progress: Progress<'_>,
) -> Result<Vec<Vector>, DeformError> {
    let geometry = decomposer.geometry_for("a deformation")?;
    if geometry.shape().is_mesh() {
        return Ok(face_vertex_normals(base, geometry.faces()));
    }
    let outward = match outward_normals(geometry, None, progress) {
        Ok(outward) => outward.normals,
        Err(OutwardError::Cancelled(cancelled)) => return Err(cancelled.into()),
        Err(_) => return Err(DeformError::NoPositions),
    };
    let normal = |x: usize| {
        let mut moments = [[0.0; 3]; 3];
        for &y in decomposer.neighbors().row(x) {
            let e = subtract(&base[y as usize], &base[x]);
            let squared = dot(&e, &e);
            if squared > 0.0 {
                add_outer(&mut moments, 1.0 / squared, &e, &e);
            }
        }
        let (values, vectors) = symmetric_eigen(moments);
        let least = (1..3).fold(0, |least, k| if values[k] < values[least] { k } else { least });
        let n = [0, 1, 2].map(|i| vectors[i][least]);
        if dot(&n, &outward[x]) < 0.0 { n.map(|c| -c) } else { n }
    };
    Ok((0..base.len()).map(normal).collect())
}

/// Smallest rotation that takes one unit vector to another.
pub(crate) fn smallest_turn(from: &Vector, to: &Vector) -> [f64; 4] {
    let axis = cross(from, to);
    let w = 1.0 + dot(from, to);
    if w < 1e-9 {
        return NO_TURN;
    }
    normalized(&[w, axis[0], axis[1], axis[2]])
}
