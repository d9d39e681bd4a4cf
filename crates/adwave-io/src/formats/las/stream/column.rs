//! Numbers of single LAS point records, by the name of their field.

use crate::formats::las::crs::coordinate_system;
use crate::formats::las::extra::ExtraBytes;
use crate::formats::las::fields::{bit_columns, record_bytes, whole_column};
use crate::formats::las::read::{VariableRecord, records};
use crate::formats::las::stream::LasReader;
use crate::model::field::ByteOrder;
use crate::{CoordinateSystem, ValueType};

/// Field with one number per point, as it is stored in a record.
#[derive(Clone, Debug, PartialEq)]
pub struct LasColumn {
    at: usize,
    storage: ColumnStorage,
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum ColumnStorage {
    /// Bits of a byte: the first of them, and the mask of the number.
    Bits {
        shift: u8,
        mask: u8,
    },
    Number(ValueType),
    /// A number with a scale and an offset.
    Scaled {
        value_type: ValueType,
        scale: f64,
        offset: f64,
    },
}

impl LasColumn {
    /// Number in a record; NaN if the record is too short.
    pub fn value(&self, record: &[u8]) -> f64 {
        let number = |t: ValueType| {
            let Some(bytes) = record.get(self.at..self.at + t.n_bytes()) else { return f64::NAN };
            let mut one = t.empty();
            one.push_bytes(bytes, ByteOrder::Little);
            one.get(0)
        };
        match self.storage {
            ColumnStorage::Bits { shift, mask } => {
                record.get(self.at).map_or(f64::NAN, |byte| f64::from((byte >> shift) & mask))
            }
            ColumnStorage::Number(t) => number(t),
            ColumnStorage::Scaled { value_type, scale, offset } => number(value_type) * scale + offset,
        }
    }

    /// Returns true if the numbers are 32-bit floats.
    pub fn is_single_precision(&self) -> bool {
        self.storage == ColumnStorage::Number(ValueType::F32)
    }
}

impl LasReader {
    /// Field with one number per point of that name; `None` if there is none.
    ///
    /// ```
    /// use adwave_io::{LasReader, ShapeFile, write_path};
    /// let folder = tempfile::tempdir().unwrap();
    /// let path = folder.path().join("a.las");
    /// write_path(&ShapeFile::from_cloud(vec![[0.0, 1.0, 2.0]]), &path, None).unwrap();
    /// let mut reader = LasReader::open(&path).unwrap();
    /// let class = reader.column("classification").unwrap();
    /// let mut records = Vec::new();
    /// reader.read(1, &mut records).unwrap();
    /// assert_eq!(class.value(&records), 0.0);
    /// assert!(reader.column("height").is_none());
    /// ```
    pub fn column(&self, name: &str) -> Option<LasColumn> {
        let format = self.layout().format;
        if let Some(&(_, at, shift, mask)) = bit_columns(format).iter().find(|column| column.0 == name) {
            return Some(LasColumn { at, storage: ColumnStorage::Bits { shift, mask } });
        }
        if let Some((at, value_type, 1)) = whole_column(format, name) {
            return Some(LasColumn { at, storage: ColumnStorage::Number(value_type) });
        }
        let own = self.extra_bytes().into_iter().find(|own| own.name == name && own.n_channels == 1)?;
        let storage = match own.scale {
            Some((scale, offset)) => ColumnStorage::Scaled { value_type: own.value_type, scale, offset },
            None => ColumnStorage::Number(own.value_type),
        };
        Some(LasColumn { at: own.at, storage })
    }

    /// Names of the fields with one number per point.
    pub fn column_names(&self) -> Vec<String> {
        const WHOLE: [&str; 7] = [
            "intensity",
            "classification",
            "scan_angle",
            "user_data",
            "point_source",
            "gps_time",
            "near_infrared",
        ];
        let format = self.layout().format;
        let bits = bit_columns(format).iter().map(|column| column.0);
        let whole = WHOLE.into_iter().filter(|name| whole_column(format, name).is_some());
        let extra = self.extra_bytes().into_iter().filter(|own| own.n_channels == 1).map(|own| own.name);
        bits.chain(whole).map(str::to_owned).chain(extra).collect()
    }

    /// Coordinate system that the header states; `None` if it states none.
    pub fn coordinate_system(&self) -> Option<CoordinateSystem> {
        let (head, header) = self.head();
        coordinate_system(head, header, &records(head, header))
    }

    fn extra_bytes(&self) -> Vec<ExtraBytes> {
        let (head, header) = self.head();
        let variable = records(head, header);
        let is_extra = |r: &&VariableRecord<'_>| r.user.starts_with(b"LASF_Spec") && r.id == 4;
        let standard = record_bytes(header.format).unwrap_or(header.record_bytes);
        let content = variable.iter().find(is_extra).map_or(&[][..], |r| r.content);
        let mut all = ExtraBytes::parse(content, standard);
        all.retain(|own| own.at + own.n_bytes() <= header.record_bytes);
        all
    }
}
