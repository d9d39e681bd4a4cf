//! From the conventions of models to a mesh of cells: UGRID, MPAS, ICON, and corners given by their coordinates.

use std::collections::HashMap;

use adwave::Progress;

use crate::ReadError;
use crate::formats::netcdf::cells::{CornerTable, MeshCells};
use crate::formats::netcdf::variables::{NetCdf, Variable};
use crate::model::units::show;

/// Mean radius of the earth in km, where a file states none.
const EARTH: f64 = 6371.0;

/// Corners within this distance on the unit sphere are one: 0.6 m on the earth, above the rounding of 32-bit degrees.
const SAME_CORNER: f64 = 1e-6;

/// Radius of the sphere of a mesh in km.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Radius {
    pub(super) km: f64,
    /// True if the file states it.
    pub(super) is_stated: bool,
}

/// A mesh of cells with the names of its axes.
#[derive(Debug)]
pub(super) struct CellMesh {
    /// Name of the convention.
    pub(super) convention: &'static str,
    pub(super) cells: MeshCells,
    /// `None` for a mesh in a plane, in meters.
    pub(super) radius: Option<Radius>,
    /// Names of the axes of cells and of corners.
    pub(super) cell_axis: String,
    pub(super) node_axis: String,
    /// Variables that are the mesh and no fields.
    pub(super) of_mesh: Vec<String>,
}

/// Mesh of a file, if its variables follow one of the conventions.
pub(super) fn find_mesh(file: &NetCdf<'_>, progress: Progress<'_>) -> Result<CellMesh, ReadError> {
    let topology = file.variables().iter().find(|v| v.text("cf_role") == Some("mesh_topology"));
    if let Some(topology) = topology {
        return ugrid(file, topology, progress);
    }
    if file.variable("verticesOnCell").is_some() {
        return mpas(file, progress);
    }
    if file.variable("vertex_of_cell").is_some() {
        return icon(file, progress);
    }
    if let Some(bounds) = bounds_of_cells(file) {
        return mesh_of_bounds(file, bounds, progress);
    }
    Err(ReadError::Whole(
        "the NetCDF has no mesh of cells (UGRID, MPAS, ICON, or centers with bounds of three corners or more); give the \
         grid file, and its fields by --signal FILE.nc:NAME"
            .into(),
    ))
}

/// Radius that the file or the grid mapping of a variable states, in km.
fn radius_of(file: &NetCdf<'_>) -> Radius {
    let of_file =
        ["sphere_radius", "semi_major_axis", "earth_radius"].iter().filter_map(|name| file.number(name));
    let of_mapping = file.variables().iter().filter(|v| v.text("grid_mapping_name").is_some());
    let of_mapping = of_mapping.filter_map(|v| v.number("earth_radius").or(v.number("semi_major_axis")));
    // A radius of 1 says that lengths are angles, whatever the planet.
    let stated = of_file.chain(of_mapping).find(|meters| *meters > 1000.0 && meters.is_finite());
    stated.map_or(Radius { km: EARTH, is_stated: false }, |meters| Radius {
        km: meters / 1000.0,
        is_stated: true,
    })
}

/// Radians of an angle in the unit of a variable.
fn angle_factor(variable: &Variable, usual: f64) -> f64 {
    match variable.text("units") {
        Some(unit) if unit.starts_with("deg") => std::f64::consts::PI / 180.0,
        Some(unit) if unit.starts_with("rad") => 1.0,
        _ => usual,
    }
}

const RADIANS: f64 = 1.0;
const DEGREES: f64 = std::f64::consts::PI / 180.0;

/// Points at longitudes and latitudes on a sphere.
fn points_on_sphere(
    file: &NetCdf<'_>,
    [longitude, latitude]: [&Variable; 2],
    usual: f64,
    radius: Radius,
) -> Result<Vec<[f64; 3]>, ReadError> {
    let [lon, lat] = [file.values(longitude)?, file.values(latitude)?];
    if lon.len() != lat.len() {
        return Err(ReadError::Whole(format!(
            "{} and {} must have the same number of values, got {} and {}; correct the file",
            show(&longitude.name),
            show(&latitude.name),
            lon.len(),
            lat.len()
        )));
    }
    let factors = [angle_factor(longitude, usual), angle_factor(latitude, usual)];
    let point = |k: usize| {
        let (lambda, phi) = (lon[k] * factors[0], lat[k] * factors[1]);
        // Half a turn and a hundredth of a degree for rounding; longitudes may count several turns.
        if !(lambda.abs() <= 20.0 && phi.abs() <= std::f64::consts::FRAC_PI_2 + 2e-4) {
            return Err(ReadError::Whole(format!(
                "place {k} is at the longitude {} and the latitude {}, which are no angles in the unit of the file; correct it",
                lon[k], lat[k]
            )));
        }
        Ok([phi.cos() * lambda.cos(), phi.cos() * lambda.sin(), phi.sin()].map(|c| radius.km * c))
    };
    (0..lon.len()).map(point).collect()
}

/// Means of the corners of cells, on the sphere if there is one.
fn means(nodes: &[[f64; 3]], corners: &adwave::shape::Polygons, radius: Option<Radius>) -> Vec<[f64; 3]> {
    let mean = |cell: &[u32]| {
        let sum = cell.iter().fold([0.0; 3], |sum, &v| {
            let p = nodes[v as usize];
            [sum[0] + p[0], sum[1] + p[1], sum[2] + p[2]]
        });
        let norm = sum[0].hypot(sum[1]).hypot(sum[2]);
        let factor = match radius {
            Some(radius) if norm > 0.0 => radius.km / norm,
            _ => 1.0 / cell.len() as f64,
        };
        sum.map(|c| c * factor)
    };
    corners.iter().map(mean).collect()
}

/// Size of the axis of a variable of one axis.
fn single_axis(variable: &Variable) -> Result<(String, usize), ReadError> {
    let [axis] = &variable.axes[..] else {
        return Err(ReadError::Whole(format!(
            "{} must have one axis, got {}; correct the file",
            show(&variable.name),
            variable.show_axes()
        )));
    };
    Ok((axis.name.clone(), axis.size as usize))
}

/// Table of corners of a variable of two axes, cells first unless the other axis is that of the cells.
fn corner_table(
    file: &NetCdf<'_>,
    variable: &Variable,
    is_cells: impl Fn(&str, u64) -> bool,
) -> Result<(String, CornerTable), ReadError> {
    let [a, b] = &variable.axes[..] else {
        return Err(ReadError::Whole(format!(
            "{} must have an axis of cells and one of corners, got {}; correct the file",
            show(&variable.name),
            variable.show_axes()
        )));
    };
    let numbers = file.raw_values(variable)?;
    let is_turned = !is_cells(&a.name, a.size) && is_cells(&b.name, b.size);
    let (cells, width) = if is_turned { (b, a.size as usize) } else { (a, b.size as usize) };
    let n_cells = cells.size as usize;
    let numbers = if is_turned {
        (0..n_cells)
            .flat_map(|cell| (0..width).map(move |k| (cell, k)))
            .map(|(cell, k)| numbers[k * n_cells + cell])
            .collect()
    } else {
        numbers
    };
    let table = CornerTable { numbers, width, first: 0.0, fill: variable.number("_FillValue"), counts: None };
    Ok((cells.name.clone(), table))
}

fn ugrid(file: &NetCdf<'_>, topology: &Variable, progress: Progress<'_>) -> Result<CellMesh, ReadError> {
    let words = |name: &str| topology.text(name).map(|text| text.split_whitespace().collect::<Vec<_>>());
    let Some([x, y]) = words("node_coordinates").and_then(|names| <[&str; 2]>::try_from(names).ok()) else {
        return Err(ReadError::Whole(
            "the mesh topology must name two node_coordinates; correct the file".into(),
        ));
    };
    let [x, y] = [file.require(x, "the mesh")?, file.require(y, "the mesh")?];
    let name = topology.text("face_node_connectivity").unwrap_or("face_node_connectivity");
    let faces = file.require(name, "the mesh")?;
    let (node_axis, n_nodes) = single_axis(x)?;
    let face_axis = topology.text("face_dimension");
    let (cell_axis, mut table) =
        corner_table(file, faces, |name, size| face_axis.map_or(size > 64, |axis| axis == name))?;
    table.first = faces.number("start_index").unwrap_or(0.0);
    let is_plane = x
        .text("units")
        .is_some_and(|unit| unit == "m" || unit.starts_with("meter") || unit.starts_with("metre"))
        || x.text("standard_name").is_some_and(|name| name.starts_with("projection"));
    let radius = (!is_plane).then(|| radius_of(file));
    let nodes = if let Some(radius) = radius {
        let is_latitude = |v: &Variable| {
            v.text("standard_name") == Some("latitude")
                || v.text("units").is_some_and(|unit| unit.contains("north"))
        };
        let pair = if is_latitude(x) && !is_latitude(y) { [y, x] } else { [x, y] };
        points_on_sphere(file, pair, DEGREES, radius)?
    } else {
        let (x, y) = (file.values(x)?, file.values(y)?);
        x.iter().zip(&y).map(|(x, y)| [*x, *y, 0.0]).collect()
    };
    if nodes.len() != n_nodes {
        return Err(ReadError::Whole(
            "both node_coordinates must have the axis of the nodes; correct the file".into(),
        ));
    }
    let corners = table.to_polygons(nodes.len(), progress)?;
    let centers = means(&nodes, &corners, radius);
    let mut of_mesh = vec![topology.name.clone(), x.name.clone(), y.name.clone(), faces.name.clone()];
    of_mesh.extend(words("face_coordinates").into_iter().flatten().map(str::to_owned));
    Ok(CellMesh {
        convention: "UGRID",
        cells: MeshCells { nodes, corners, centers },
        radius,
        cell_axis,
        node_axis,
        of_mesh,
    })
}

fn mpas(file: &NetCdf<'_>, progress: Progress<'_>) -> Result<CellMesh, ReadError> {
    let table_variable = file.require("verticesOnCell", "a mesh of MPAS")?;
    let n_corners = file.require("nEdgesOnCell", "a mesh of MPAS")?;
    let (cell_axis, n_cells) = single_axis(n_corners)?;
    let (_, mut table) =
        corner_table(file, table_variable, |name, size| name == cell_axis || size == n_cells as u64)?;
    table.first = 1.0;
    table.counts = Some(file.values(n_corners)?);
    check_cells(&table, n_cells)?;
    let is_sphere = file.text("on_a_sphere").is_none_or(|word| word.to_ascii_uppercase().starts_with('Y'));
    let radius = is_sphere.then(|| radius_of(file));
    let of_kind = |kind: &str| -> Result<Vec<[f64; 3]>, ReadError> {
        let named = |begin: &str| file.require(&format!("{begin}{kind}"), "a mesh of MPAS");
        if let Some(radius) = radius {
            points_on_sphere(file, [named("lon")?, named("lat")?], RADIANS, radius)
        } else {
            let [x, y, z] = [file.values(named("x")?)?, file.values(named("y")?)?, file.values(named("z")?)?];
            let n = x.len().min(y.len()).min(z.len());
            Ok((0..n).map(|k| [x[k], y[k], z[k]]).collect())
        }
    };
    let (nodes, centers) = (of_kind("Vertex")?, of_kind("Cell")?);
    check_centers(&centers, n_cells)?;
    let corners = table.to_polygons(nodes.len(), progress)?;
    let node_axis = file
        .variable("lonVertex")
        .or(file.variable("xVertex"))
        .map_or(Ok(String::new()), |v| single_axis(v).map(|a| a.0))?;
    let names = ["Cell", "Vertex", "Edge"].iter().flat_map(|kind| {
        ["lon", "lat", "x", "y", "z", "indexTo"].map(|begin| {
            if begin == "indexTo" { format!("indexTo{kind}ID") } else { format!("{begin}{kind}") }
        })
    });
    let of_mesh = names.chain(["nEdgesOnCell".to_owned(), "verticesOnCell".to_owned()]).collect();
    Ok(CellMesh {
        convention: "MPAS",
        cells: MeshCells { nodes, corners, centers },
        radius,
        cell_axis,
        node_axis,
        of_mesh,
    })
}

fn icon(file: &NetCdf<'_>, progress: Progress<'_>) -> Result<CellMesh, ReadError> {
    let first_of = |names: [&str; 2]| match file.variable(names[0]) {
        Some(variable) => Ok(variable),
        None => file.variable(names[1]).map_or_else(|| file.require(names[0], "a mesh of ICON"), Ok),
    };
    let center = [first_of(["clon", "lon_cell_centre"])?, first_of(["clat", "lat_cell_centre"])?];
    let vertex = [first_of(["vlon", "longitude_vertices"])?, first_of(["vlat", "latitude_vertices"])?];
    let (cell_axis, n_cells) = single_axis(center[0])?;
    let (node_axis, _) = single_axis(vertex[0])?;
    let table_variable = file.require("vertex_of_cell", "a mesh of ICON")?;
    let (_, mut table) =
        corner_table(file, table_variable, |name, size| name == cell_axis || size == n_cells as u64)?;
    table.first = 1.0;
    check_cells(&table, n_cells)?;
    let radius = radius_of(file);
    let nodes = points_on_sphere(file, vertex, RADIANS, radius)?;
    let centers = points_on_sphere(file, center, RADIANS, radius)?;
    let corners = table.to_polygons(nodes.len(), progress)?;
    let mut of_mesh: Vec<String> = center.iter().chain(&vertex).map(|v| v.name.clone()).collect();
    of_mesh.extend(
        [
            "vertex_of_cell",
            "clon_vertices",
            "clat_vertices",
            "lon_cell_centre",
            "lat_cell_centre",
            "longitude_vertices",
            "latitude_vertices",
            "cell_index",
            "vertex_index",
            "cartesian_x_vertices",
            "cartesian_y_vertices",
            "cartesian_z_vertices",
            "cell_circumcenter_cartesian_x",
            "cell_circumcenter_cartesian_y",
            "cell_circumcenter_cartesian_z",
        ]
        .map(str::to_owned),
    );
    let radius = Some(radius);
    Ok(CellMesh {
        convention: "ICON",
        cells: MeshCells { nodes, corners, centers },
        radius,
        cell_axis,
        node_axis,
        of_mesh,
    })
}

fn check_cells(table: &CornerTable, n_cells: usize) -> Result<(), ReadError> {
    let found = table.numbers.len() / table.width.max(1);
    if found == n_cells && table.counts.as_ref().is_none_or(|counts| counts.len() == n_cells) {
        return Ok(());
    }
    Err(ReadError::Whole(format!(
        "the corners are those of {found} cells, and there are {n_cells}; correct the file"
    )))
}

fn check_centers(centers: &[[f64; 3]], n_cells: usize) -> Result<(), ReadError> {
    if centers.len() == n_cells {
        return Ok(());
    }
    Err(ReadError::Whole(format!("there are {} centers of {n_cells} cells; correct the file", centers.len())))
}

/// Variables of the centers and of the corners of cells, longitude and latitude each.
#[derive(Clone, Copy)]
struct CellBounds<'a> {
    centers: [&'a Variable; 2],
    corners: [&'a Variable; 2],
}

/// Centers of cells of one axis whose attributes name bounds of three corners or more.
fn bounds_of_cells<'a>(file: &'a NetCdf<'_>) -> Option<CellBounds<'a>> {
    let with_bounds = |is: &dyn Fn(&Variable) -> bool| {
        file.variables().iter().filter(|v| v.axes.len() == 1 && is(v)).find_map(|center| {
            let bounds = file.variable(center.text("bounds")?)?;
            let is_table = bounds.axes.len() == 2 && bounds.axes[0].size == center.axes[0].size;
            (is_table && bounds.axes[1].size >= 3).then_some((center, bounds))
        })
    };
    let is = |v: &Variable, name: &str, begin: &str| {
        v.text("standard_name") == Some(name) || v.name.starts_with(begin)
    };
    let longitude = with_bounds(&|v| is(v, "longitude", "clon"))?;
    let latitude = with_bounds(&|v| is(v, "latitude", "clat"))?;
    Some(CellBounds { centers: [longitude.0, latitude.0], corners: [longitude.1, latitude.1] })
}

/// Mesh of cells whose corners are given by their coordinates: equal corners are one.
fn mesh_of_bounds(
    file: &NetCdf<'_>,
    bounds: CellBounds<'_>,
    progress: Progress<'_>,
) -> Result<CellMesh, ReadError> {
    let (cell_axis, n_cells) = single_axis(bounds.centers[0])?;
    let radius = radius_of(file);
    // Bounds have the unit of their centers.
    let usual = angle_factor(bounds.centers[0], DEGREES);
    let all = points_on_sphere(file, bounds.corners, usual, radius)?;
    let centers = points_on_sphere(file, bounds.centers, usual, radius)?;
    check_centers(&centers, n_cells)?;
    let step = SAME_CORNER * radius.km;
    let (mut nodes, mut node_of): (Vec<[f64; 3]>, HashMap<[i64; 3], u32>) = (Vec::new(), HashMap::new());
    let mut numbers = Vec::with_capacity(all.len());
    for point in all {
        let cell = point.map(|c| (c / step).floor() as i64);
        // A point near the border of its box may be equal to one in the next box.
        let near = (0..27).map(|k| [cell[0] + k % 3 - 1, cell[1] + k / 3 % 3 - 1, cell[2] + k / 9 - 1]);
        let is_same = |node: &u32| {
            let p = nodes[*node as usize];
            (0..3).all(|c| (p[c] - point[c]).abs() < step)
        };
        let found = near.filter_map(|cell| node_of.get(&cell).copied()).find(is_same);
        let node = found.unwrap_or_else(|| {
            nodes.push(point);
            node_of.insert(cell, nodes.len() as u32 - 1);
            nodes.len() as u32 - 1
        });
        numbers.push(f64::from(node));
    }
    let width = bounds.corners[0].axes[1].size as usize;
    let table = CornerTable { numbers, width, first: 0.0, fill: None, counts: None };
    check_cells(&table, n_cells)?;
    let corners = table.to_polygons(nodes.len(), progress)?;
    let of_mesh = bounds.centers.iter().chain(&bounds.corners).map(|v| v.name.clone()).collect();
    Ok(CellMesh {
        convention: "cells with bounds",
        cells: MeshCells { nodes, corners, centers },
        radius: Some(radius),
        cell_axis,
        node_axis: String::new(),
        of_mesh,
    })
}
