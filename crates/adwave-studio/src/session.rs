//! One shape that is open.

use crate::StudioError;
use crate::answer::Refused;
use crate::autosave::Autosave;
use crate::prepared::{Prepared, decomposer};
use adwave::operator::OperatorKind;
use adwave::shape::{Shape, bounding_box, triangulate};
use adwave::{Decomposer, Progress};
use adwave_io::{Format, ShapeFile, write_bytes};
use serde_json::{Value, json};
use std::collections::HashSet;
use std::path::{Path, PathBuf};
use std::sync::atomic::AtomicBool;
use std::sync::{Arc, Mutex, MutexGuard, OnceLock, PoisonError};

/// Vertices that a browser keeps with eight bands: some 100 bytes each.
const MAX_VERTICES: usize = 12_000_000;

/// A shape that the studio is opened on.
#[derive(Clone, Debug)]
pub struct Opened {
    /// What it is called.
    pub name: String,
    /// The file that it came from, beside which results are written.
    pub path: Option<PathBuf>,
    /// Its content.
    pub file: ShapeFile,
    /// The shape that it is.
    pub shape: Shape,
}

/// A shape with what is made of it.
pub(crate) struct Session {
    pub(crate) id: u64,
    pub(crate) opened: Opened,
    /// Where results are written.
    pub(crate) folder: PathBuf,
    pub(crate) center: [f64; 3],
    pub(crate) triangles: Vec<[u32; 3]>,
    walk: OnceLock<Result<Decomposer, Arc<StudioError>>>,
    prepared: OnceLock<Result<Mutex<Prepared>, Arc<StudioError>>>,
    turn: Mutex<()>,
    autosave: Option<Autosave>,
    resumed: OnceLock<bool>,
    /// Files that were written here, which may be written again.
    pub(crate) written: Mutex<HashSet<PathBuf>>,
    /// Whether the server ends, so that nothing more needs to be made.
    stop: Arc<AtomicBool>,
}

impl Session {
    pub(crate) fn new(
        id: u64,
        opened: Opened,
        folder: PathBuf,
        kept_in: Option<&Path>,
        stop: Arc<AtomicBool>,
    ) -> Result<Self, StudioError> {
        let Some(points) = opened.shape.points().filter(|_| !matches!(opened.shape, Shape::Graph(_))) else {
            return Err(StudioError::NoPositions(opened.name));
        };
        if points.len() > MAX_VERTICES {
            let (name, n) = (opened.name, points.len());
            return Err(StudioError::TooLarge { name, n, most: MAX_VERTICES });
        }
        let center = bounding_box(points)
            .map_or([0.0; 3], |(low, high)| std::array::from_fn(|c| 0.5 * low[c] + 0.5 * high[c]));
        let triangles = match &opened.shape {
            Shape::Mesh(mesh) => triangulate(points, mesh.faces()),
            _ => Vec::new(),
        };
        let autosave = Autosave::of(&opened, kept_in);
        Ok(Self {
            id,
            opened,
            folder,
            center,
            triangles,
            walk: OnceLock::new(),
            prepared: OnceLock::new(),
            turn: Mutex::default(),
            autosave,
            resumed: OnceLock::new(),
            written: Mutex::default(),
            stop,
        })
    }

    /// Stops what is made when the server ends.
    pub(crate) fn progress(&self) -> Progress<'_> {
        Progress::none().with_cancel(&self.stop)
    }

    /// Whoever needs the bands waits for its turn, and that outside the threads that compute: a thread that waits for others there takes up
    /// other work meanwhile, and would wait for a lock that it holds itself.
    pub(crate) fn turn(&self) -> MutexGuard<'_, ()> {
        self.turn.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// The shape with the diffusion that levels are counted in; the first who asks waits for it to be made.
    pub(crate) fn walk(&self) -> Result<&Decomposer, Refused> {
        let made = self.walk.get_or_init(|| {
            decomposer(&self.opened.shape, OperatorKind::Walk, self.progress()).map_err(Arc::new)
        });
        made.as_ref().map_err(|e| Refused::of(&**e))
    }

    /// The bands, and the edit of the last visit; the first who asks waits for them.
    pub(crate) fn prepared(&self) -> Result<MutexGuard<'_, Prepared>, Refused> {
        let walk = self.walk()?;
        let made = self.prepared.get_or_init(|| {
            let (shape, progress) = (&self.opened.shape, self.progress());
            let fresh = || Prepared::with_default_levels(shape, walk, progress);
            let kept = self.autosave.as_ref().and_then(Autosave::read);
            let resumed = kept.and_then(|(levels, document)| {
                let mut prepared = Prepared::new(shape, walk, levels, progress).ok()?;
                prepared.edit(document, &self.opened.file).ok()?;
                Some(prepared)
            });
            let _ = self.resumed.set(resumed.is_some());
            let prepared = resumed.map_or_else(fresh, Ok);
            prepared.map(Mutex::new).map_err(Arc::new)
        });
        let prepared = made.as_ref().map_err(|e| Refused::of(&**e))?;
        Ok(prepared.lock().unwrap_or_else(PoisonError::into_inner))
    }

    pub(crate) fn points(&self) -> &[[f64; 3]] {
        self.opened.shape.points().unwrap_or_default()
    }

    /// Keeps the edit for the next visit.
    pub(crate) fn keep(&self, prepared: &Prepared) -> Result<(), Refused> {
        match &self.autosave {
            Some(autosave) => autosave.write(&prepared.levels, &prepared.document),
            None => Ok(()),
        }
    }

    /// The file with the positions after the edit.
    pub(crate) fn edited_file(&self, prepared: &Prepared) -> Result<ShapeFile, Refused> {
        let mut file = self.opened.file.clone();
        file.set_points(prepared.points.to_vec()).map_err(|e| Refused::wrong(e.to_string()))?;
        Ok(file)
    }

    /// What the page is told of the shape.
    pub(crate) fn info(&self) -> Result<Value, Refused> {
        let prepared = self.prepared()?;
        let health = prepared.health();
        let (opened, n_levels) = (&self.opened, prepared.n_levels());
        let kind = if self.triangles.is_empty() { "cloud" } else { "mesh" };
        let presets: Vec<Value> = adwave::filter::Preset::ALL
            .iter()
            .map(|preset| json!({"name": preset.name(), "gains": preset.gains(n_levels)}))
            .collect();
        Ok(json!({
            "id": self.id,
            "name": opened.name,
            "format": opened.file.format().map(Format::name),
            "formats": self.formats(),
            "kind": kind,
            "n_vertices": opened.shape.n_vertices(),
            "n_triangles": self.triangles.len(),
            "center": self.center,
            "diagonal": prepared.decomposer.diagonal(),
            "mean_length": prepared.decomposer.mean_length(),
            "closed": health.is_closed(),
            "volume": health.volume,
            "components": health.n_components,
            "notes": notes(health),
            "levels": prepared.level_list(),
            "fields": crate::fields::list(self, n_levels),
            "presets": presets,
            "resumed": self.resumed.get().copied().unwrap_or(false),
        }))
    }

    /// Formats that hold this shape.
    fn formats(&self) -> Vec<&'static str> {
        let probe = if self.triangles.is_empty() {
            ShapeFile::from_cloud(vec![[0.0; 3]])
        } else {
            let faces = adwave::shape::Polygons::from_triangles(&[[0, 1, 2]]);
            ShapeFile::from_mesh(vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]], faces)
        };
        let holds = |format: &Format| write_bytes(&probe, *format, &mut std::io::sink()).is_ok();
        Format::all().filter(holds).map(Format::name).collect()
    }
}

/// What is unusual about a shape, in sentences.
fn notes(health: &adwave::shape::Health) -> Vec<String> {
    [
        (health.n_non_manifold_edges, "edges have three faces or more"),
        (health.n_misoriented_edges, "edges have faces that disagree about the outside"),
        (health.n_zero_area_faces, "faces have no area"),
        (health.n_unreferenced, "vertices are in no face; they stay where they are"),
    ]
    .into_iter()
    .filter(|(n, _)| *n > 0)
    .map(|(n, what)| format!("{n} {what}"))
    .collect()
}
