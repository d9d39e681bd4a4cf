//! Meshes of climate models in NetCDF: UGRID, MPAS, ICON, and cells that are given by their bounds.
//!
//! If fields lie on the nodes, nodes are the vertices and cells the faces. Else the centers of the cells are the
//! vertices, and the faces join the cells that meet at a node, so that everything that works on vertices works on
//! fields of cells. Longitudes and latitudes become points in km on the sphere that the file states. Times are
//! channels, levels are fields of their own, fill values are NaN.
//!
//! Library: `hdf5-pure` for NetCDF-4, as for AnnData. The crate `netcdf` needs the C library; `netcdf3` reads a file by
//! its path and neither CDF-5 nor bytes, and its header takes few lines.

mod cells;
mod classic;
mod fields;
mod hdf5;
mod mesh;
mod variables;

use adwave::vector::Axis;

use crate::formats::netcdf::fields::{PlaceAxis, read_fields};
use crate::formats::netcdf::mesh::{CellMesh, find_mesh};
use crate::formats::netcdf::variables::{NetCdf, Variable, is_classic};
use crate::model::context::ReadContext;
use crate::model::file_head::FileHead;
use crate::model::format_descriptor::{Evidence, FormatDescriptor, SampleFile, SurfaceSize};
use crate::{CoordinatePrecision, Field, Format, LengthUnit, ReadError, ShapeFile};

impl Format {
    /// NetCDF of a mesh of cells.
    pub const NETCDF: Self = Self::new("netcdf");
}

/// Any HDF5 may be a NetCDF-4: as a shape if its name says so, else as values for a mesh.
fn recognize(file: &FileHead<'_>) -> Option<Evidence> {
    let is_hdf5 = file.bytes.starts_with(b"\x89HDF\r\n\x1a\n");
    if is_classic(file.bytes) || (is_hdf5 && file.is_named(&NETCDF)) {
        return Some(Evidence::Signature);
    }
    is_hdf5.then_some(Evidence::Statement)
}

pub(crate) static NETCDF: FormatDescriptor = FormatDescriptor {
    format: Format::NETCDF,
    title: "NetCDF of a mesh",
    extensions: &["nc", "nc4", "cdf", "ugrid"],
    reads: "meshes of UGRID, MPAS and ICON, and cells with bounds, classic (CDF-1, 2, 5) and NetCDF-4, with their \
            fields on nodes or cells; times as channels, levels as fields; points in km on the sphere of the file; \
            fields alone as signals",
    loses: "fields on edges, tables of numbers, texts; rasters of longitude and latitude",
    up_axis: Some(Axis::Z),
    recognize,
    read: Some(read_netcdf),
    read_values: Some(read_values),
    samples: &[SampleFile { name: "a.nc", bytes: include_bytes!("samples/a.nc") }],
    ..FormatDescriptor::NEW
};

/// Fields of a file whose places are as many as the vertices of a shape.
fn read_values(
    bytes: &[u8],
    size: &SurfaceSize<'_>,
    context: &ReadContext<'_>,
) -> Result<Vec<Field>, ReadError> {
    let file = NetCdf::open(bytes.to_vec(), context.limits)?;
    let fields = read_fields(&file, &PlaceAxis::OfSize(size.n_vertices), |_| false, context.limits)?;
    if fields.is_empty() {
        return Err(ReadError::Whole(format!(
            "the NetCDF has no variable with an axis of {} places; choose the file of this mesh",
            size.n_vertices
        )));
    }
    Ok(fields)
}

fn read_netcdf(bytes: Vec<u8>, context: &ReadContext<'_>) -> Result<ShapeFile, ReadError> {
    let file = NetCdf::open(bytes, context.limits)?;
    let mesh = find_mesh(&file, context.progress)?;
    let (n_nodes, n_cells) = (mesh.cells.nodes.len(), mesh.cells.corners.len());
    context.limits.check_points(n_nodes.max(n_cells) as u64)?;
    let is_of_mesh = |v: &Variable| {
        let is_bounds = |other: &Variable| other.text("bounds") == Some(v.name.as_str());
        mesh.of_mesh.contains(&v.name)
            || v.text("cf_role").is_some()
            || file.variables().iter().any(is_bounds)
    };
    let on = |axis: &str, n: usize| -> Result<Vec<Field>, ReadError> {
        if axis.is_empty() {
            return Ok(Vec::new());
        }
        read_fields(&file, &PlaceAxis::Named(axis, n), is_of_mesh, context.limits)
    };
    let mut of_cells = on(&mesh.cell_axis, n_cells)?;
    let mut of_nodes = on(&mesh.node_axis, n_nodes)?;
    // The areas of the dual cells of MPAS and ICON are at their nodes, and what a model computes is in the cells.
    let is_by_nodes = !of_nodes.is_empty() && (of_cells.is_empty() || mesh.convention == "UGRID");
    let mut left_out: Vec<String> = Vec::new();
    let mut shape = if is_by_nodes {
        let mut shape = ShapeFile::from_mesh(mesh.cells.nodes.clone(), mesh.cells.corners.clone());
        shape.vertex_fields = std::mem::take(&mut of_nodes);
        shape.face_fields = std::mem::take(&mut of_cells);
        shape
    } else {
        let faces = mesh.cells.dual_faces(mesh.radius.is_some(), context.progress)?;
        left_out.extend(of_nodes.iter().map(|field| field.name.clone()));
        let mut shape = ShapeFile::from_mesh(mesh.cells.centers.clone(), faces);
        shape.vertex_fields = of_cells;
        shape
    };
    shape.notes.push(describe(&mesh, is_by_nodes));
    if !left_out.is_empty() {
        let (n, shown) = (left_out.len(), left_out.iter().take(3).cloned().collect::<Vec<_>>().join(", "));
        shape
            .notes
            .push(format!("{n} fields on nodes are left out, since the vertices are the cells: {shown}"));
    }
    shape.unit = Some(if mesh.radius.is_some() { LengthUnit::KILOMETER } else { LengthUnit::METER });
    shape.format = Some(Format::NETCDF);
    shape.precision = CoordinatePrecision::F64;
    shape.is_map = true;
    Ok(shape)
}

/// Sentence on what the vertices are, and where they are.
fn describe(mesh: &CellMesh, is_by_nodes: bool) -> String {
    let places = if is_by_nodes { "nodes" } else { "centers of cells" };
    let sphere = match mesh.radius {
        Some(radius) if radius.is_stated => {
            format!(
                "on the sphere of radius {} km that the file states, so that lengths are in km",
                radius.km
            )
        }
        Some(radius) => {
            format!(
                "on a sphere of radius {} km, that of the earth, since the file states none; lengths are in km",
                radius.km
            )
        }
        None => "in a plane, with lengths in m".to_owned(),
    };
    format!("{} mesh: vertices are the {places}, {sphere}", mesh.convention)
}
