//! Meshes of climate models in NetCDF, in files that are put together here.

use adwave_io::{Format, LengthUnit, ReadLimits, ShapeFile, parse_surface_values, read_bytes};
use adwave_test_data::data_test;

fn read(bytes: &[u8]) -> Result<ShapeFile, String> {
    read_bytes(bytes.to_vec(), Some("a.nc"), &ReadLimits::default()).map_err(|e| e.to_string())
}

/// Value of an attribute.
#[derive(Clone)]
enum Value {
    Text(&'static str),
    Number(f64),
}

/// Numbers of a variable.
#[derive(Clone)]
enum Numbers {
    Ints(Vec<i32>),
    Doubles(Vec<f64>),
}

/// A variable: its name, dimensions, attributes and numbers.
#[derive(Clone)]
struct Variable(&'static str, Vec<usize>, Vec<(&'static str, Value)>, Numbers);

/// A file of CDF-2, of dimensions of fixed sizes.
#[derive(Clone, Default)]
struct Classic {
    dimensions: Vec<(&'static str, u32)>,
    attributes: Vec<(&'static str, Value)>,
    variables: Vec<Variable>,
}

impl Classic {
    fn bytes(&self) -> Vec<u8> {
        // The header is as long whatever the offsets.
        let start = self.header(&vec![0; self.variables.len()]).len();
        let mut offsets = Vec::new();
        let mut data = Vec::new();
        for Variable(.., numbers) in &self.variables {
            offsets.push((start + data.len()) as u64);
            match numbers {
                Numbers::Ints(v) => v.iter().for_each(|x| data.extend(x.to_be_bytes())),
                Numbers::Doubles(v) => v.iter().for_each(|x| data.extend(x.to_be_bytes())),
            }
        }
        let mut bytes = self.header(&offsets);
        bytes.extend(data);
        bytes
    }

    fn header(&self, offsets: &[u64]) -> Vec<u8> {
        let mut out = b"CDF\x02\0\0\0\0".to_vec();
        let number = |out: &mut Vec<u8>, n: usize| out.extend((n as u32).to_be_bytes());
        let text = |out: &mut Vec<u8>, text: &str| {
            number(out, text.len());
            out.extend(text.as_bytes());
            out.resize(out.len().next_multiple_of(4), 0);
        };
        let list = |out: &mut Vec<u8>, tag: usize, n: usize| {
            number(out, if n == 0 { 0 } else { tag });
            number(out, n);
        };
        let attributes = |out: &mut Vec<u8>, attributes: &[(&str, Value)]| {
            list(out, 12, attributes.len());
            for (name, value) in attributes {
                text(out, name);
                match value {
                    Value::Text(value) => {
                        number(out, 2);
                        text(out, value);
                    }
                    Value::Number(value) => {
                        number(out, 6);
                        number(out, 1);
                        out.extend(value.to_be_bytes());
                    }
                }
            }
        };
        list(&mut out, 10, self.dimensions.len());
        for (name, size) in &self.dimensions {
            text(&mut out, name);
            number(&mut out, *size as usize);
        }
        attributes(&mut out, &self.attributes);
        list(&mut out, 11, self.variables.len());
        for (Variable(name, axes, own, numbers), offset) in self.variables.iter().zip(offsets) {
            text(&mut out, name);
            number(&mut out, axes.len());
            for axis in axes {
                number(&mut out, *axis);
            }
            attributes(&mut out, own);
            number(&mut out, if matches!(numbers, Numbers::Ints(_)) { 4 } else { 6 });
            number(&mut out, 0);
            out.extend(offset.to_be_bytes());
        }
        out
    }

    fn variable(&mut self, name: &str) -> &mut Variable {
        self.variables.iter_mut().find(|v| v.0 == name).unwrap()
    }
}

/// Corners of an octahedron at longitudes and latitudes in radians, and its triangles from 1 on.
const LON: [f64; 6] = [0.0, 90.0, 180.0, 270.0, 0.0, 0.0];
const LAT: [f64; 6] = [0.0, 0.0, 0.0, 0.0, 90.0, -90.0];
const TRIANGLES: [[i32; 3]; 8] =
    [[1, 2, 5], [2, 3, 5], [3, 4, 5], [4, 1, 5], [2, 1, 6], [3, 2, 6], [4, 3, 6], [1, 4, 6]];

/// Latitude of the centers of the triangles: those of the corners of a cube.
fn center_latitude() -> f64 {
    (1.0_f64 / 3.0).sqrt().asin()
}

fn centers() -> (Vec<f64>, Vec<f64>) {
    let lon = (0..8).map(|k| (45.0 + 90.0 * f64::from(k % 4)).to_radians()).collect();
    let lat = (0..8).map(|k| if k < 4 { center_latitude() } else { -center_latitude() }).collect();
    (lon, lat)
}

fn radians(degrees: &[f64]) -> Numbers {
    Numbers::Doubles(degrees.iter().map(|d| d.to_radians()).collect())
}

/// An octahedron as ICON writes it: triangles are cells, the table of corners has the cells along its second axis.
fn icon() -> Classic {
    let (clon, clat) = centers();
    let table = (0..3).flat_map(|k| TRIANGLES.map(|cell| cell[k])).collect();
    let unit = || vec![("units", Value::Text("radian"))];
    let heat = (0..48).map(f64::from).collect();
    Classic {
        dimensions: vec![("cell", 8), ("vertex", 6), ("nv", 3), ("time", 2), ("height", 3)],
        attributes: vec![("sphere_radius", Value::Number(6_371_229.0))],
        variables: vec![
            Variable("clon", vec![0], unit(), Numbers::Doubles(clon)),
            Variable("clat", vec![0], unit(), Numbers::Doubles(clat)),
            Variable("vlon", vec![1], unit(), radians(&LON)),
            Variable("vlat", vec![1], unit(), radians(&LAT)),
            Variable("vertex_of_cell", vec![2, 0], vec![], Numbers::Ints(table)),
            Variable("cell_area", vec![0], vec![], Numbers::Doubles(vec![1.5; 8])),
            Variable(
                "time",
                vec![3],
                vec![("units", Value::Text("minutes since 2000-01-01"))],
                Numbers::Doubles(vec![0.0, 30.0]),
            ),
            Variable("ta", vec![3, 4, 0], vec![("_FillValue", Value::Number(13.0))], Numbers::Doubles(heat)),
        ],
    }
}

/// The same points as MPAS writes them: the corners of the octahedron are cells, and its triangles are corners.
fn mpas() -> Classic {
    let (lon, lat) = centers();
    // Corners follow each other around a cell: west and east above, then below; the last of five places is empty.
    let around = |cell: i32| match cell {
        1..=4 => {
            let west = (cell + 2) % 4 + 1;
            [west, cell, cell + 4, west + 4, 0]
        }
        5 => [1, 2, 3, 4, 0],
        _ => [5, 6, 7, 8, 0],
    };
    let table = (1..=6).flat_map(around).collect();
    Classic {
        dimensions: vec![("nCells", 6), ("nVertices", 8), ("maxEdges", 5), ("Time", 1), ("nVertLevels", 2)],
        attributes: vec![("on_a_sphere", Value::Text("YES")), ("sphere_radius", Value::Number(1.0))],
        variables: vec![
            Variable("lonCell", vec![0], vec![], radians(&LON)),
            Variable("latCell", vec![0], vec![], radians(&LAT)),
            Variable("lonVertex", vec![1], vec![], Numbers::Doubles(lon)),
            Variable("latVertex", vec![1], vec![], Numbers::Doubles(lat)),
            Variable("nEdgesOnCell", vec![0], vec![], Numbers::Ints(vec![4; 6])),
            Variable("verticesOnCell", vec![0, 2], vec![], Numbers::Ints(table)),
            Variable("theta", vec![3, 0, 4], vec![], Numbers::Doubles((0..12).map(f64::from).collect())),
            Variable("vorticity", vec![3, 1], vec![], Numbers::Doubles(vec![0.5; 8])),
        ],
    }
}

/// Sum of the volumes of the pyramids from the origin to the faces, split at their first corners.
fn volume(shape: &ShapeFile) -> f64 {
    let p = shape.points();
    let of = |a: [f64; 3], b: [f64; 3], c: [f64; 3]| {
        a[0] * (b[1] * c[2] - b[2] * c[1])
            + a[1] * (b[2] * c[0] - b[0] * c[2])
            + a[2] * (b[0] * c[1] - b[1] * c[0])
    };
    let faces = shape.faces().iter();
    faces
        .map(|f| {
            (1..f.len() - 1)
                .map(|k| of(p[f[0] as usize], p[f[k] as usize], p[f[k + 1] as usize]))
                .sum::<f64>()
        })
        .sum::<f64>()
        / 6.0
}

#[test]
fn cells_of_icon_are_vertices_with_levels_and_times() {
    let shape = read(&icon().bytes()).unwrap();
    assert_eq!((shape.n_vertices(), shape.faces().len()), (8, 6));
    assert_eq!(shape.length_unit(), Some(&LengthUnit::KILOMETER));
    // A cube whose corners are 6371.229 km from its center, with its faces outwards.
    let side = 2.0 * 6371.229 / 3.0_f64.sqrt();
    assert!((volume(&shape) / side.powi(3) - 1.0).abs() < 1e-12, "{}", volume(&shape));
    assert_eq!(shape.field_names(), ["ta_level1", "ta_level2", "ta_level3", "cell_area"]);
    let second = shape.field("ta_level2").unwrap();
    assert_eq!((second.n_channels, second.frame_step), (2, Some(1800.0)));
    for cell in 0..8 {
        let value = second.get(cell, 0);
        assert!(if cell == 5 { value.is_nan() } else { value == 8.0 + cell as f64 });
        assert_eq!(second.get(cell, 1), 32.0 + cell as f64);
    }
    let note = "ICON mesh: vertices are the centers of cells, on the sphere of radius 6371.229 km that the file states";
    assert!(shape.notes()[0].contains(note));
}

#[test]
fn cells_of_mpas_are_vertices() {
    let shape = read(&mpas().bytes()).unwrap();
    assert_eq!((shape.n_vertices(), shape.faces().len()), (6, 8));
    assert!((volume(&shape) / (4.0 / 3.0 * 6371.0_f64.powi(3)) - 1.0).abs() < 1e-12);
    assert_eq!(shape.field_names(), ["theta_level1", "theta_level2"]);
    assert_eq!(shape.field("theta_level2").unwrap().to_f64(), [1.0, 3.0, 5.0, 7.0, 9.0, 11.0]);
    assert!(shape.notes()[0].contains("radius 6371 km, that of the earth, since the file states none"));
}

#[test]
fn nodes_of_ugrid_are_vertices_and_faces_are_faces() {
    let (_, bytes) = Format::NETCDF.samples().next().unwrap();
    let shape = read(bytes).unwrap();
    assert_eq!((shape.n_vertices(), shape.faces().len()), (6, 8));
    let heat = shape.field("heat").unwrap();
    assert_eq!((heat.n_channels, heat.frame_step), (2, Some(21_600.0)));
    assert_eq!((heat.get(2, 0), heat.get(2, 1)), (2.0, 8.0));
    assert!(heat.get(3, 1).is_nan());
    // Its fields alone, for a shape of as many vertices.
    let fields = parse_surface_values(bytes, None, 6, &ReadLimits::default()).unwrap();
    assert!(fields.iter().any(|field| field.name == "heat" && field.n_channels == 2));
    assert!(
        parse_surface_values(bytes, None, 7, &ReadLimits::default())
            .unwrap_err()
            .to_string()
            .contains("7 places")
    );
}

#[test]
fn equal_corners_of_bounds_are_one() {
    let mut file = icon();
    let (degrees_lon, degrees_lat): (Vec<f64>, Vec<f64>) =
        TRIANGLES.iter().flatten().map(|&v| (LON[v as usize - 1], LAT[v as usize - 1])).unzip();
    file.variables.retain(|v| !["vertex_of_cell", "vlon", "vlat"].contains(&v.0));
    for (name, bounds, values) in [("clon", "clon_bnds", degrees_lon), ("clat", "clat_bnds", degrees_lat)] {
        file.variable(name).2.push(("bounds", Value::Text(bounds)));
        file.variables.push(Variable(bounds, vec![0, 2], vec![], radians(&values)));
    }
    let (found, expected) = (read(&file.bytes()).unwrap(), read(&icon().bytes()).unwrap());
    assert_eq!((found.points(), found.faces().len()), (expected.points(), 6));
    assert!((volume(&found) / volume(&expected) - 1.0).abs() < 1e-12);
    assert_eq!(found.field_names(), expected.field_names());
}

#[test]
fn wrong_meshes_are_errors_of_one_line() {
    let ints = |file: &mut Classic, name: &str, at: usize, value: i32| {
        let Numbers::Ints(values) = &mut file.variable(name).3 else { unreachable!() };
        values[at] = value;
    };
    let doubles = |file: &mut Classic, name: &str, at: usize, value: f64| {
        let Numbers::Doubles(values) = &mut file.variable(name).3 else { unreachable!() };
        values[at] = value;
    };
    let mut cases: Vec<(Classic, &str)> = Vec::new();
    let mut add = |mut file: Classic, change: &dyn Fn(&mut Classic), message: &'static str| {
        change(&mut file);
        cases.push((file, message));
    };
    add(
        icon(),
        &|f| ints(f, "vertex_of_cell", 3, 7),
        "cell 3 of the mesh names corner 7, but they are 1 to 6",
    );
    add(icon(), &|f| ints(f, "vertex_of_cell", 0, 0), "cell 0 of the mesh names corner 0");
    add(icon(), &|f| ints(f, "vertex_of_cell", 0, 2), "cell 0 of the mesh has 2 corners");
    add(icon(), &|f| doubles(f, "vlat", 2, 9.0), "are no angles");
    add(icon(), &|f| doubles(f, "clon", 2, f64::NAN), "are no angles");
    add(icon(), &|f| f.variables.retain(|v| v.0 != "vlon"), "needs the variable vlon");
    add(
        mpas(),
        &|f| ints(f, "nEdgesOnCell", 1, 6),
        "cell 1 of the mesh has 6 corners, and the table has room for 5",
    );
    add(mpas(), &|f| ints(f, "nEdgesOnCell", 1, 5), "cell 1 of the mesh names corner 0");
    add(mpas(), &|f| ints(f, "verticesOnCell", 1, 4), "has 3 corners");
    add(mpas(), &|f| f.variable("nEdgesOnCell").1 = vec![1], "those of 6 cells, and there are 8");
    add(mpas(), &|f| f.variable("verticesOnCell").1 = vec![0], "an axis of cells and one of corners");
    add(mpas(), &|f| f.variable("theta").1 = vec![3, 0, 77], "has the dimension 77, but there are 5");
    add(mpas(), &|f| f.dimensions[0].1 = u32::MAX, " ");
    add(mpas(), &|f| f.variables.truncate(2), "has no mesh of cells");
    for (file, message) in cases {
        match read(&file.bytes()) {
            Err(error) => assert!(error.contains(message) && !error.contains('\n'), "{message}: {error}"),
            // Three of four corners are a triangle.
            Ok(shape) => assert!(message == "has 3 corners" && shape.n_vertices() == 6, "{message}"),
        }
    }
}

#[test]
fn a_cut_file_is_a_shape_or_an_error_of_one_line() {
    for file in [icon(), mpas()] {
        let bytes = file.bytes();
        for end in 0..bytes.len() {
            let error = read(&bytes[..end]).err();
            assert!(error.is_none_or(|error| !error.contains('\n')), "{end}");
        }
    }
}

#[data_test]
fn a_netcdf_4_of_a_model_is_read_with_its_levels() {
    let folder = std::path::Path::new(adwave_test_data::folder!()).join("domains/vectors/geoflow-small");
    let shape = adwave_io::read_path(&folder.join("grid.nc"), &ReadLimits::default()).unwrap();
    assert_eq!((shape.n_vertices(), shape.faces().len()), (6000, 3840));
    assert_eq!(shape.field_names().len(), 20);
    assert_eq!(shape.field_names()[19], "mesh_depth_level20");
    let bytes = std::fs::read(folder.join("v1.nc")).unwrap();
    let fields = parse_surface_values(&bytes, None, 6000, &ReadLimits::default()).unwrap();
    assert_eq!(fields.iter().filter(|field| field.name.starts_with("v1_level")).count(), 20);
    let cut = &bytes[..bytes.len() - 1000];
    assert!(parse_surface_values(cut, None, 6000, &ReadLimits::default()).is_err());
}
