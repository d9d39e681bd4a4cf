//! Laws of levels, parents and coarse meshes.

use crate::common::{TestMesh, fan, grid, octahedron, tetrahedron};
use adwave::Progress;
use adwave_subdivision::{Hierarchy, Obstacle, SubdivisionError};
use proptest::prelude::*;

/// Sorted triangles, each with its corners sorted.
fn as_sets(triangles: impl IntoIterator<Item = [u32; 3]>) -> Vec<[u32; 3]> {
    let mut sets: Vec<[u32; 3]> = triangles
        .into_iter()
        .map(|mut t| {
            t.sort_unstable();
            t
        })
        .collect();
    sets.sort_unstable();
    sets
}

/// Coarse meshes of several genera, with and without a border, of which none has a coarser level.
fn coarse_meshes() -> Vec<(&'static str, TestMesh)> {
    let mut two = tetrahedron();
    let first = two.points.len() as u32;
    two.triangles.extend(octahedron().triangles.iter().map(|t| t.map(|v| v + first)));
    two.points.extend(octahedron().points);
    vec![
        ("tetrahedron", tetrahedron()),
        ("octahedron", octahedron()),
        ("torus 3 × 3", grid(3, 3, true)),
        ("torus 5 × 3", grid(5, 3, true)),
        ("disk", fan(5)),
        ("disk of 7", fan(7)),
        ("two parts", two),
        (
            "one triangle",
            TestMesh { points: vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]], triangles: vec![[0, 1, 2]] },
        ),
    ]
}

#[test]
fn the_levels_of_a_subdivided_mesh_are_found_in_any_order() {
    for (name, coarse) in coarse_meshes() {
        for n_levels in 1..=4 {
            let (mesh, places) = coarse.cut(n_levels).shuffled(17 + n_levels as u64);
            let hierarchy = mesh.hierarchy();
            assert_eq!(hierarchy.n_levels(), n_levels, "{name}");
            assert_eq!(hierarchy.n_vertices(n_levels), coarse.points.len(), "{name}");
            let vertices = hierarchy.vertices(n_levels).unwrap();
            let found = hierarchy.triangles(n_levels).unwrap();
            let found = as_sets(found.iter().map(|t| t.map(|v| vertices[v as usize])));
            if !name.starts_with("torus") {
                // A torus is regular, so any parity of it is a coarse mesh.
                assert_eq!(
                    found,
                    as_sets(coarse.triangles.iter().map(|t| t.map(|v| places[v as usize]))),
                    "{name}"
                );
            }
        }
    }
}

#[test]
fn the_euler_characteristic_is_the_same_on_all_levels() {
    for (name, coarse) in coarse_meshes() {
        let mesh = coarse.cut(3);
        let hierarchy = mesh.hierarchy();
        for level in 0..=hierarchy.n_levels() {
            let vertices = hierarchy.vertices(level).unwrap();
            let points = vertices.iter().map(|&v| mesh.points[v as usize]).collect();
            let coarser = TestMesh { points, triangles: hierarchy.triangles(level).unwrap() };
            assert_eq!(coarser.euler(), mesh.euler(), "{name}, level {level}");
        }
    }
}

#[test]
fn an_icosphere_has_ten_times_four_to_the_k_and_two_vertices() {
    // An octahedron has 4·4^k + 2.
    let hierarchy = octahedron().cut(4).hierarchy();
    for level in 0..=4 {
        assert_eq!(hierarchy.n_vertices(level), 4 * 4_usize.pow(4 - level as u32) + 2);
        assert_eq!(hierarchy.n_faces(level), 8 * 4_usize.pow(4 - level as u32));
    }
}

#[test]
fn parents_are_the_ends_of_the_edge_that_was_cut() {
    let (mesh, _) = fan(5).cut(3).shuffled(5);
    let hierarchy = mesh.hierarchy();
    for level in 0..3 {
        let (fine, coarse) = (hierarchy.vertices(level).unwrap(), hierarchy.vertices(level + 1).unwrap());
        for (v, pair) in fine.iter().zip(hierarchy.parents(level).unwrap()) {
            let [p, q] = pair.map(|parent| mesh.points[coarse[parent as usize] as usize]);
            let own = mesh.points[*v as usize];
            assert_eq!(own, [0, 1, 2].map(|k| f64::midpoint(p[k], q[k])), "{v}: {pair:?}");
            assert!(pair[0] != pair[1] || coarse[pair[0] as usize] == *v);
        }
    }
}

#[test]
fn a_torus_has_the_same_levels_in_every_run() {
    let mesh = grid(24, 16, true);
    let first = mesh.hierarchy();
    assert_eq!(first.n_levels(), 2);
    assert_eq!((first.n_vertices(1), first.n_vertices(2)), (96, 24));
    for _ in 0..3 {
        let again = mesh.hierarchy();
        assert_eq!(again.vertices(2).unwrap(), first.vertices(2).unwrap());
        assert_eq!(again.triangles(2).unwrap(), first.triangles(2).unwrap());
    }
}

#[test]
fn parts_have_their_own_number_of_levels() {
    let (deep, flat, lone) = (tetrahedron().cut(3), octahedron().cut(1), octahedron());
    let mut mesh = deep.clone();
    for part in [&flat, &lone] {
        let first = mesh.points.len() as u32;
        mesh.points.extend(&part.points);
        mesh.triangles.extend(part.triangles.iter().map(|t| t.map(|v| v + first)));
    }
    mesh.points.push([9.0; 3]);
    let (mesh, _) = mesh.shuffled(3);
    let hierarchy = mesh.hierarchy();
    assert_eq!(hierarchy.n_levels(), 3);
    let mut found: Vec<(usize, usize, usize)> =
        hierarchy.parts().iter().map(|part| (part.n_levels, part.n_vertices, part.n_coarsest)).collect();
    found.sort_unstable();
    assert_eq!(found, [(0, 1, 1), (0, 6, 6), (1, 18, 6), (3, 130, 4)]);
    assert_eq!(hierarchy.n_vertices(3), 1 + 6 + 6 + 4);
    assert!(hierarchy.parts().iter().any(|part| matches!(part.obstacle, Obstacle::NoFaces { .. })));
}

#[test]
fn a_level_that_does_not_exist_is_refused() {
    let hierarchy = tetrahedron().cut(2).hierarchy();
    let expected = SubdivisionError::Level { level: 3, n_levels: 2 };
    assert_eq!(hierarchy.vertices(3).unwrap_err(), expected);
    assert_eq!(hierarchy.triangles(3).unwrap_err(), expected);
    assert_eq!(hierarchy.parents(2).unwrap_err(), SubdivisionError::Level { level: 2, n_levels: 1 });
    assert_eq!(expected.to_string(), "level must be in 0..=2, got 3");
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(40))]

    /// A mesh of random triangles of a grid with random holes: the search ends, and whatever it finds has the right counts.
    #[test]
    fn no_mesh_makes_the_search_fail_in_another_way(seed in 0_u64..1_000_000, holes in 0_usize..6) {
        let mut mesh = grid(8, 8, seed % 2 == 0);
        let mut random = crate::common::Random(seed);
        for _ in 0..holes {
            let k = random.below(mesh.triangles.len());
            mesh.triangles.swap_remove(k);
        }
        if let Ok(hierarchy) = Hierarchy::new(mesh.points.len(), &mesh.triangles, Progress::none()) {
            for level in 0..hierarchy.n_levels() {
                prop_assert_eq!(hierarchy.parents(level).unwrap().len(), hierarchy.n_vertices(level));
                prop_assert!(hierarchy.n_vertices(level + 1) < hierarchy.n_vertices(level));
            }
        }
    }
}
