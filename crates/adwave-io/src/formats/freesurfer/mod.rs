//! FreeSurfer: surfaces (`lh.white`, `rh.pial`, …), values on them (`lh.thickness`, `lh.aparc.annot`, MGH and MGZ) and
//! lists of vertices (`lh.cortex.label`).
//!
//! Such files have no ending of their own; their first bytes identify them.
//!
//! Library: none. `neuroformats` (0.2) panics on files that are cut, on surfaces of quadrangles and on any other file,
//! and drops the tail of a surface (the volume that it belongs to), which is kept here.

pub(crate) mod annotation;
pub(crate) mod label;
pub(crate) mod overlay;
pub(crate) mod read;
pub(crate) mod write;

use adwave::vector::Axis;

use crate::Format;
use crate::model::format_descriptor::{ContentKind, CoordinateType, Evidence, FormatDescriptor};

impl Format {
    /// FreeSurfer surface.
    pub const FREESURFER: Self = Self::new("freesurfer");
}

pub(crate) static FREESURFER: FormatDescriptor = FormatDescriptor {
    format: Format::FREESURFER,
    title: "FreeSurfer surface",
    extensions: &["white", "pial", "inflated", "sphere", "orig", "smoothwm"],
    reads: "triangles and both forms of quadrangles; values alone (curv, annot, label, MGH, MGZ) as signals",
    writes: "triangles in 32-bit floats",
    keeps: "creator, volume information",
    loses: "fields, faces of more than three corners",
    coordinates: CoordinateType::Single,
    up_axis: Some(Axis::Z),
    recognize: |file| read::is_surface(file.bytes).then_some(Evidence::Signature),
    read: Some(|bytes, c| read::read_surface(&bytes, c.limits, c.progress)),
    write: Some(|shape, c| write::write_surface(shape, &mut c.report, c.out, c.progress)),
    ..FormatDescriptor::NEW
};

const VALUES: FormatDescriptor = FormatDescriptor { content: ContentKind::Values, ..FormatDescriptor::NEW };

pub(crate) static CURV: FormatDescriptor = FormatDescriptor {
    format: Format::new("curv"),
    title: "FreeSurfer values, curv",
    recognize: |file| overlay::is_curv(file.bytes).then_some(Evidence::Signature),
    name_foreign: |file| {
        overlay::is_curv(file.bytes)
            .then_some("FreeSurfer's values at vertices: use it as a field of a surface")
    },
    read_values: Some(|bytes, _, c| Ok(vec![overlay::read_curv(bytes, c.progress)?])),
    ..VALUES
};

pub(crate) static MGH: FormatDescriptor = FormatDescriptor {
    format: Format::new("mgh"),
    title: "FreeSurfer values, MGH",
    recognize: |file| overlay::is_mgh(file.bytes).then_some(Evidence::Signature),
    name_foreign: |file| {
        overlay::is_mgh(file.bytes).then_some("an MGH volume or overlay: use it as a field of a surface")
    },
    read_values: Some(|bytes, _, c| Ok(vec![overlay::read_mgh(bytes, c.progress)?])),
    ..VALUES
};

pub(crate) static ANNOTATION: FormatDescriptor = FormatDescriptor {
    format: Format::new("annot"),
    title: "FreeSurfer annotation",
    recognize: |file| overlay::is_annotation(file.bytes).then_some(Evidence::Layout),
    read_values: Some(|bytes, _, c| Ok(vec![overlay::read_annotation(bytes, c.progress)?])),
    read_mask: Some(|bytes, request, c| label::mask_of_annotation(bytes, request, c.progress)),
    ..VALUES
};

pub(crate) static LABEL: FormatDescriptor = FormatDescriptor {
    format: Format::new("label"),
    title: "FreeSurfer label",
    recognize: |file| label::is_label(file.bytes).then_some(Evidence::Layout),
    name_foreign: |file| {
        // A cloud may begin with a comment and a number of points too.
        (file.bytes.starts_with(b"#!ascii label") && label::is_label(file.bytes))
            .then_some("a FreeSurfer label: use it as a mask or a field of a surface")
    },
    read_values: Some(|bytes, size, c| Ok(vec![label::read_label(bytes, size.n_vertices, c.progress)?])),
    read_mask: Some(|bytes, request, c| label::mask_of_label(bytes, request, c.progress)),
    ..VALUES
};
