//! The file that the result of an edit goes to.

use crate::error::CliError;
use crate::global::Global;
use crate::output::values_file::{ValuesFile, unsuitable_format_among, write_field};
use crate::output::{check_writable, note, output_format, write_shape};
use crate::resolve::applicable::article;
use crate::resolve::shape::{Input, move_points};
use crate::resolve::signal::Signal;
use adwave_io::{
    COORDS, CiftiColumns, Field, FieldValues, Format, GRID_VALUES, LabelTable, MovedNormals, ShapeFile,
    Subset, ValueType, keep_left_out_values, named_axis, with_axis, written_signal,
};
use std::path::Path;

/// The file that the result of an edit goes to.
#[derive(Clone, Copy)]
pub(crate) struct ResultFile<'a> {
    path: &'a Path,
}

/// Values of a signal after an edit, in the form in which a file stores them.
pub(crate) enum EditedSignal {
    /// New positions of the vertices.
    Points(Vec<[f64; 3]>),
    /// New values of a field, and the names of its columns if they come from a table.
    Field { field: Field, channel_names: Vec<String> },
    /// Values that are in the file already.
    Written,
}

impl<'a> ResultFile<'a> {
    /// Refuses a path that neither a shape nor values alone can be written to.
    pub(crate) fn new(path: &'a Path) -> Result<Self, CliError> {
        if matches!(ValuesFile::from_path(path), None | Some(ValuesFile::Grid)) {
            output_format(path)?;
        }
        check_writable(path)?;
        Ok(Self { path })
    }

    /// Refuses a path that cannot hold the places of the signal: those of an image or a volume, or faces.
    pub(crate) fn check_places(&self, input: &Input) -> Result<(), CliError> {
        check_places(self.path, input)?;
        let is_suitable = ValuesFile::from_path(self.path).is_some()
            || Format::from_path(self.path).is_some_and(Format::holds_face_fields);
        if input.mesh_of_cells.is_none() || is_suitable {
            return Ok(());
        }
        let others = [".npy", ".csv"];
        Err(unsuitable_format_among(self.path, "fields of faces are", Format::holds_face_fields, &others))
    }

    pub(crate) fn path(&self) -> &'a Path {
        self.path
    }

    /// The form of the values of a signal after an edit: one that is a coordinate of the shape moves its points, unless
    /// the values go into a file of their own.
    pub(crate) fn place_values(
        &self,
        file: &ShapeFile,
        name: &str,
        signal: &Signal,
        mut values: Vec<f64>,
    ) -> EditedSignal {
        signal.restore_unknown(&mut values);
        let is_alone = ValuesFile::choose_for_edited_signal(self.path, name, file).is_some();
        // Names of labels fit values that are labels still.
        let labels = signal.shared_labels().filter(|labels| are_labels(labels, &values));
        match named_axis(file, name).filter(|_| !is_alone) {
            Some(axis) => EditedSignal::Points(with_axis(file.points(), axis, &values)),
            None => EditedSignal::Field {
                field: written_signal(file, name, signal.n_channels, values).with_labels(labels),
                channel_names: signal.channel_names.clone(),
            },
        }
    }

    /// Writes the vertices `kept` of the shape with new positions of all of them. Values alone have one row per vertex,
    /// so that they cannot be written.
    pub(crate) fn write_part(
        &self,
        input: &mut Input,
        points: Vec<[f64; 3]>,
        kept: &[u32],
        normals: MovedNormals,
        global: &Global<'_>,
    ) -> Result<(), CliError> {
        if ValuesFile::choose_for_edited_signal(self.path, COORDS, &input.file).is_some() {
            return Err(CliError::Input(format!(
                "points can be dropped from a shape only, and {} is a file of values; choose a format of shapes",
                self.path.display()
            )));
        }
        move_points(&mut input.file, points, normals, global)?;
        let part = input.file.subset_with_left_out(&Subset { vertices: kept, ..Subset::default() })?;
        write_shape(global, &part, self.path).map(|_| ())
    }

    /// Writes the shape with the edited signal, or the values of the signal alone.
    pub(crate) fn write(
        &self,
        input: &mut Input,
        signal: &str,
        edited: EditedSignal,
        normals: MovedNormals,
        global: &Global<'_>,
    ) -> Result<(), CliError> {
        let alone = ValuesFile::choose_for_edited_signal(self.path, signal, &input.file);
        let field = match edited {
            EditedSignal::Written => return Ok(()),
            EditedSignal::Points(points) => {
                move_points(&mut input.file, points, normals, global)?;
                let Some(_) = alone else { return write_shape(global, &input.file, self.path).map(|_| ()) };
                let values = FieldValues::F64(input.file.points().as_flattened().to_vec());
                Field::new(COORDS, 3, values)
            }
            EditedSignal::Field { field, channel_names } => {
                if let (Some(mesh), None) = (&mut input.mesh_of_cells, alone) {
                    mesh.add_face_field(field)?;
                    return write_shape(global, mesh, self.path).map(|_| ());
                }
                if alone.is_none_or(|kind| kind == ValuesFile::Grid) {
                    note_rounding(input, signal, global);
                }
                keep_left_out_values(&mut input.file, signal, &field)?;
                if alone == Some(ValuesFile::Csv) && channel_names.len() == field.n_channels {
                    let columns = split_channels(&field, &channel_names);
                    return ValuesFile::Csv.write(global, self.path, &columns, &input.file);
                }
                field
            }
        };
        if let (Some(kind), None) = (alone, input.file.field(signal)) {
            return kind.write_edited(global, self.path, signal, field, &input.file);
        }
        write_field(global, self.path, alone, &mut input.file, field)
    }
}

/// True if all values are labels of the table, or no label.
fn are_labels(labels: &LabelTable, values: &[f64]) -> bool {
    let is_label =
        |v: &f64| v.is_nan() || *v == -1.0 || v.fract() == 0.0 && labels.entry(*v as i32).is_some();
    values.iter().all(is_label)
}

/// Refuses a file of shapes for values of an image or a volume, and the other way round.
pub(crate) fn check_places(path: &Path, input: &Input) -> Result<(), CliError> {
    let kind = ValuesFile::choose(path, &input.file);
    if input.file.brain().is_some() {
        let own = CiftiColumns::from_path(Path::new(&input.name)).filter(|own| *own != CiftiColumns::Labels);
        let fits = match kind {
            Some(ValuesFile::Cifti(CiftiColumns::Labels)) => false,
            Some(ValuesFile::Cifti(columns)) => own.is_none_or(|own| own == columns),
            Some(ValuesFile::Npy | ValuesFile::Csv) => true,
            _ => false,
        };
        if fits {
            return Ok(());
        }
        return Err(CliError::Input(format!(
            "{}: the values of {} go into a CIFTI of the same kind, .npy or .csv",
            path.display(),
            input.name
        )));
    }
    let is_grid = input.file.grid().is_some();
    let fits = if is_grid { kind.is_some() } else { kind != Some(ValuesFile::Grid) };
    if fits {
        return Ok(());
    }
    let (holds, use_instead) = if is_grid {
        ("shapes", "use its own format or .npy")
    } else {
        ("images and volumes", "use its own format, of which `adwave render` makes pictures, or .npy")
    };
    Err(CliError::Input(format!(
        "{}: the format holds {holds}, and {} is {} {}; {use_instead}",
        path.display(),
        input.name,
        article(input.kind_name()),
        input.kind_name()
    )))
}

/// Prints a note if an image or a volume holds whole numbers and no other type is asked for.
pub(crate) fn note_rounding(input: &Input, signal: &str, global: &Global<'_>) {
    if input.file.grid().is_none() || global.given.has("--value-type") {
        return;
    }
    let kind = input.file.field(signal).map(|field| field.values.value_type());
    if let Some(kind) = kind.filter(|kind| kind.is_integer()) {
        let kind = kind.name();
        note(
            global,
            &format!(
                "{signal} is rounded to whole numbers ({kind}), as in its file; --value-type f32 keeps fractions"
            ),
        );
    }
}

/// Sets the type of the numbers that an image or a volume is written with: that of its own file, if none is asked for.
pub(crate) fn set_value_type(
    input: &mut Input,
    path: &Path,
    value_type: Option<ValueType>,
    global: &Global<'_>,
) -> Result<(), CliError> {
    if input.file.grid().is_none() {
        let applies = format!("applies to images and volumes, and {} is a {}", input.name, input.kind_name());
        return global.given.refuse(&["--value-type"], &applies);
    }
    // A file of the same format has the type already.
    let is_other = input.file.format() != Format::grid_from_path(path);
    let own = input.file.field(GRID_VALUES).filter(|_| is_other).map(|field| field.values.value_type());
    input.file.set_value_type(value_type.or(own));
    Ok(())
}

/// The channels of a field as fields of these names.
fn split_channels(field: &Field, names: &[String]) -> Vec<Field> {
    let channel = |(c, name): (usize, &String)| {
        let values = (0..field.len()).map(|i| field.get(i, c)).collect();
        Field::new(name.clone(), 1, FieldValues::F64(values))
    };
    names.iter().enumerate().map(channel).collect()
}
