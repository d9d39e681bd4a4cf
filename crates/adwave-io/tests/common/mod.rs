//! Where the test inputs are.

use std::path::Path;

/// The folder of test inputs.
pub(crate) fn test_inputs() -> &'static Path {
    Path::new(adwave_test_data::folder!())
}
