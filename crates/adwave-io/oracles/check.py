"""Reads what `cargo run -p adwave-bench-helpers --bin oracle_files -- FOLDER` has written with NumPy, SciPy, PyVista and NiBabel.

Needs: pip install numpy scipy pyvista nibabel. Run: python check.py FOLDER
"""

import sys
from pathlib import Path

import nibabel
import numpy as np
import pyvista as pv
import scipy.io
import scipy.sparse

folder = Path(sys.argv[1])
points = np.array([[0, 0, 0.1], [1, 0, 0.2], [1, 1, 0.3], [0, 1, 0.4], [0.5, 2, 0.5]])

mesh = pv.read(folder / "mesh.vtp")
assert mesh.points.dtype == np.float64 and np.array_equal(mesh.points, points)
assert mesh.faces.tolist() == [4, 0, 1, 2, 3, 3, 3, 2, 4]
assert mesh.point_data["quality"].dtype == np.float32
assert np.array_equal(mesh.point_data["quality"], np.array([0, 0.1, 0.2, 0.3, 0.4], np.float32))
assert np.array_equal(mesh.point_data["flow"], np.arange(15.0).reshape(5, 3))
assert mesh.point_data["color"].dtype == np.uint8 and mesh.point_data["color"].shape == (5, 3)
assert mesh.point_data["label"].tolist() == [-1, 0, 1, 2, 3]
assert mesh.cell_data["part"].tolist() == [7, 9]

cloud = pv.read(folder / "cloud.vtp")
assert np.array_equal(cloud.points, points) and cloud.n_verts == 5

wire = pv.read(folder / "wire.vtp")
assert wire.lines.tolist() == [2, 0, 1, 2, 1, 4]

large = pv.read(folder / "large.vtp")
assert np.array_equal(large.points[:, 0], np.arange(300_000.0))
assert np.array_equal(large.point_data["i"], np.arange(300_000))

for name in ["mesh.ply", "ascii.ply", "mesh.obj", "mesh.stl"]:
    other = pv.read(folder / name)
    assert other.n_points == 5, name
    assert np.allclose(other.bounds, mesh.bounds, rtol=1e-6), name
assert pv.read(folder / "mesh.ply").faces.tolist() == mesh.faces.tolist()

for name in ["mesh.gii", "mesh.gii.gz"]:
    surface = nibabel.load(folder / name)
    (pointset,) = surface.get_arrays_from_intent("NIFTI_INTENT_POINTSET")
    (triangles,) = surface.get_arrays_from_intent("NIFTI_INTENT_TRIANGLE")
    assert pointset.data.dtype == np.float32 and np.array_equal(pointset.data, points.astype(np.float32))
    assert pointset.coordsys.xform.tolist() == np.eye(4).tolist()
    # The polygon of four corners is two triangles.
    assert triangles.data.dtype == np.int32 and triangles.data.shape == (3, 3)
    arrays = {array.metadata["Name"]: array for array in surface.darrays[2:]}
    assert list(arrays) == ["quality", "flow", "color", "label", 'a<b> & "c"']
    assert np.array_equal(arrays["flow"].data, np.arange(15.0, dtype=np.float32).reshape(5, 3))
    assert arrays["color"].data.dtype == np.uint8 and arrays["color"].intent == nibabel.nifti1.intent_codes["NIFTI_INTENT_RGB_VECTOR"]
    assert arrays["label"].data.dtype == np.int32 and arrays["label"].data.tolist() == [-1, 0, 1, 2, 3]
    assert np.isnan(arrays['a<b> & "c"'].data[1]) and arrays['a<b> & "c"'].data[2] == -2

fields = nibabel.load(folder / "fields.func.gii")
assert fields.meta["AnatomicalStructurePrimary"] == "CortexLeft"
names = ["quality", "flow_x", "flow_y", "flow_z", "red", "green", "blue", "label", 'a<b> & "c"']
assert [array.metadata["Name"] for array in fields.darrays] == names
assert all(array.data.shape == (5,) for array in fields.darrays)
assert np.array_equal(np.stack(fields.agg_data()[1:4], axis=1), np.arange(15.0).reshape(5, 3))

assert np.array_equal(np.load(folder / "a.npy"), np.arange(6.0).reshape(2, 3))
for name in ["stored.npz", "deflated.npz"]:
    archive = np.load(folder / name)
    assert archive["x"].dtype == np.float32 and archive["x"].tolist() == [0.5, 1.5, 2.5]
    assert archive["index"].dtype == np.uint32 and archive["index"].shape == (2, 1, 2)
    assert archive["empty"].shape == (0, 3)
    assert archive["n"].shape == () and archive["n"] == -5

expected = np.array([[0, 1.5, 0], [2, 0, -3]])
sparse = scipy.sparse.load_npz(folder / "sparse.npz")
assert sparse.format == "csr" and np.array_equal(sparse.toarray(), expected)
assert np.array_equal(scipy.io.mmread(folder / "sparse.mtx").toarray(), expected)
print("all as written")
