//! Algorithm 2 where values are exactly equal: which of them is the feature.

use crate::reference::fast::{Fast, FeatureParams, Response};
use crate::reference::shapes::{Case, Parts};
use adwave::operator::OperatorParams;

const SIGMA: [f64; 5] = [0.0, 1.0, 2.0, 3.0, 4.0];

/// A path of nodes.
fn path(n: u32) -> Case {
    let edges = (1..n).map(|v| (v - 1, v, 1.0)).collect();
    let parts = Parts::Graph { n_nodes: n as usize, edges };
    Case { name: "path", parts, params: OperatorParams::default() }
}

/// Features found if R is 0 except at `(level, vertex, value)`: levels and vertices.
fn found(fast: &Fast<'_>, n: usize, theta: f64, values: &[(usize, usize, f64)]) -> Vec<(usize, usize)> {
    let mut levels = vec![vec![0.0; n]; 4];
    for &(j, x, value) in values {
        levels[j - 1][x] = value;
    }
    let params = FeatureParams::default().with_response(Response::Literal).with_theta(theta);
    fast.features_of(&levels, &SIGMA, &params).iter().map(|f| (f.level, f.vertex)).collect()
}

#[test]
fn of_equal_neighbors_the_first_of_the_analysis_wins() {
    let case = path(12);
    let fast = Fast::new(&case);
    for (x, y) in [(4, 5), (5, 6), (4, 6), (5, 7)] {
        let first = if fast.comes_first(x, y) { x } else { y };
        for sign in [1.0, -1.0] {
            assert_eq!(found(&fast, 12, 0.1, &[(2, x, sign), (2, y, sign)]), [(2, first)], "{x}, {y}");
        }
    }
    // Three steps away is nobody's neighbor.
    let mut both = found(&fast, 12, 0.1, &[(3, 4, 1.0), (3, 7, 1.0)]);
    both.sort_unstable();
    assert_eq!(both, [(3, 4), (3, 7)]);
}

#[test]
fn of_equal_levels_the_finer_wins() {
    let case = path(12);
    let fast = Fast::new(&case);
    for sign in [1.0, -1.0] {
        for (x, y) in [(5, 5), (5, 6), (6, 5), (5, 7), (7, 5)] {
            let found = |j: usize| found(&fast, 12, 0.1, &[(j, x, sign), (j + 1, y, sign)]);
            // The first and the last level hold no feature, and what equals one there is none where it is the coarser.
            assert_eq!(found(1), [], "{x}, {y}");
            assert_eq!(found(2), [(2, x)], "{x}, {y}");
            assert_eq!(found(3), [(3, x)], "{x}, {y}");
        }
    }
}

#[test]
fn a_response_that_equals_the_threshold_is_none() {
    let case = path(8);
    let fast = Fast::new(&case);
    // The mean |R| is 2/8.
    assert_eq!(found(&fast, 8, 8.0, &[(2, 3, 2.0)]), []);
    assert_eq!(found(&fast, 8, 7.999, &[(2, 3, 2.0)]), [(2, 3)]);
}

#[test]
fn features_of_equal_strength_are_in_the_order_of_the_analysis() {
    let case = path(30);
    let fast = Fast::new(&case);
    let mut expected = [2, 9, 16, 23, 28];
    expected.sort_by(|&x, &y| fast.comes_first(y, x).cmp(&fast.comes_first(x, y)));
    let values = expected.map(|x| (2, x, if x == 16 { -1.0 } else { 1.0 }));
    assert_eq!(found(&fast, 30, 0.1, &values), expected.map(|x| (2, x)));
}
