//! The studio, served by a thread of its own.

use crate::error;
use crate::shape::ShapeData;
use adwave::Progress;
use adwave_studio::{StudioInput, StudioParams, serve};
use pyo3::prelude::*;
use std::path::Path;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc;
use std::time::Duration;

pub(crate) fn add(module: &Bound<'_, PyModule>) -> PyResult<()> {
    module.add_function(wrap_pyfunction!(studio, module)?)
}

/// Edited shape, the recipe of its positions, and those of its fields by name.
type EditedShape = (ShapeData, String, Vec<(String, String)>);

/// Time between two checks of signals.
const LOOK: Duration = Duration::from_millis(20);

/// Serves the studio until the page is done or a signal raises; `ready` is called with the address and with the one for
/// the browser.
#[pyfunction]
fn studio(
    py: Python<'_>,
    shape: &Bound<'_, ShapeData>,
    port: u16,
    ready: &Bound<'_, PyAny>,
) -> PyResult<EditedShape> {
    let content = shape.get();
    let path = Path::new(&content.name);
    let path = path.is_file().then(|| path.to_path_buf());
    let name = path.as_deref().and_then(Path::file_name).map(|name| name.to_string_lossy().into_owned());
    let input = StudioInput {
        name: name.unwrap_or_else(|| content.name.clone()),
        path,
        file: content.file.clone(),
        shape: content.shape(py)?.clone(),
    };
    let params = StudioParams::default().with_port(port).with_n_threads(Some(crate::call::threads()));
    let stop = AtomicBool::new(false);
    let (send, receive) = mpsc::channel();
    let mut raised = None;
    let outcome = std::thread::scope(|scope| {
        let stop = &stop;
        let server = scope.spawn(move || {
            let progress = Progress::none().with_cancel(stop);
            // The calling thread waits for the address.
            serve(input, &params, progress, |address| drop(send.send(address.clone())))
        });
        while !server.is_finished() {
            py.detach(|| std::thread::sleep(LOOK));
            let checked = py.check_signals().and_then(|()| match receive.try_recv() {
                Ok(address) => ready.call1((address.url, address.url_for_browser)).map(|_| ()),
                Err(_) => Ok(()),
            });
            if let Err(error) = checked {
                stop.store(true, Ordering::Relaxed);
                if !error.is_instance_of::<pyo3::exceptions::PyKeyboardInterrupt>(py) {
                    raised = Some(error);
                }
                break;
            }
        }
        py.detach(|| server.join())
    });
    if let Some(raised) = raised {
        return Err(raised);
    }
    let finished = outcome
        .map_err(|_| error::InternalError::new_err("internal error of the studio; please report it"))?
        .map_err(|e| error::to_exception(&e))?;
    let edited = py.detach(|| finished.edited_file()).map_err(|e| error::to_exception(&e))?;
    let edited = edited.unwrap_or_else(|| content.file.clone());
    Ok((content.with_file(edited), finished.recipe, finished.field_recipes))
}
