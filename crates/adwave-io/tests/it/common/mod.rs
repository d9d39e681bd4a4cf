//! Location of the test inputs.

use std::path::Path;

/// Folder of test inputs.
pub(crate) fn test_inputs() -> &'static Path {
    Path::new(adwave_test_data::folder!())
}
