"""FreeSurfer, GIFTI and CIFTI against nibabel: what it writes is read the same, and what is written it reads the same.

    python benches/formats/freesurfer.py target/release/adwave
"""

import sys
import tempfile
from pathlib import Path

import nibabel as nib
import numpy as np
from common import Adwave, Report, Shape, same_points, same_values, sphere, unordered
from nibabel.cifti2 import BrainModelAxis, Cifti2Image, ScalarAxis, SeriesAxis
from nibabel.freesurfer import io as fs


def triangles():
    """A sphere of triangles in single precision."""
    shape = sphere()
    faces = [[f[0], f[k - 1], f[k]] for f in shape.faces for k in range(2, len(f))]
    return Shape(shape.points.astype("f4").astype(float), faces)


def main():
    adwave, report = Adwave(sys.argv[1]), Report()
    shape = triangles()
    n = len(shape.points)
    numbers = np.random.default_rng(3).normal(size=n).astype("f4")
    volume = {
        "head": np.array([2, 0, 20]), "valid": "1  # volume info valid", "filename": "orig.mgz", "volume": np.array([256, 256, 256]),
        "voxelsize": np.ones(3), "xras": np.array([-1.0, 0, 0]), "yras": np.array([0, 0, -1.0]), "zras": np.array([0, 1.0, 0]), "cras": np.zeros(3),
    }
    with tempfile.TemporaryDirectory() as folder:
        folder = Path(folder)
        surface = folder / "lh.white"
        fs.write_geometry(surface, shape.points, np.array(shape.faces), create_stamp="made for a test", volume_info=volume)

        def read_surface():
            read = adwave.mask(surface, folder)
            return {"points": same_points(read, shape), "faces": unordered(read) == unordered(shape)}

        def write_surface():
            target = adwave.convert(surface, folder / "lh.pial")
            points, faces, info, stamp = fs.read_geometry(target, read_metadata=True, read_stamp=True)
            near = np.abs(points - shape.points).max() < 1e-6
            kept = all(np.array_equal(info[k], volume[k]) for k in volume)
            return {"points": near, "faces": faces.tolist() == shape.faces, "volume": kept, "creator": stamp == "made for a test"}

        report.check("FreeSurfer surface by nibabel", read_surface)
        report.check("adwave surface read by nibabel", write_surface)

        fs.write_morph_data(folder / "lh.thickness", numbers)
        labels = np.arange(n) % 4 - 1
        table = np.array([[25 * k, 50 + k, 100, 0, 0] for k in range(3)])
        table[:, 4] = table[:, 0] + table[:, 1] * 2**8 + table[:, 2] * 2**16
        fs.write_annot(folder / "lh.parts.annot", labels, table, ["a", "b", "c"], fill_ctab=False)
        nib.save(nib.MGHImage(numbers.reshape(-1, 1, 1), np.eye(4)), folder / "lh.map.mgh")
        nib.save(nib.MGHImage((1000 * numbers).astype("i2").astype("i4").reshape(-1, 1, 1), np.eye(4)), folder / "lh.map.mgz")
        for name, truth in (
            ("lh.thickness", numbers),
            ("lh.parts.annot", fs.read_annot(folder / "lh.parts.annot")[0]),
            ("lh.map.mgh", numbers),
            ("lh.map.mgz", (1000 * numbers).astype("i2")),
        ):
            report.check(f"nibabel {name}", lambda name=name, truth=truth: {"values": same_values(adwave.field(surface, folder / name, folder), truth)})

        def labels_written(name):
            """Labels after `filter --as-labels`, with the names and colors of the annotation."""
            target = folder / name
            adwave.run("filter", surface, "-o", target, "--signal", folder / "lh.parts.annot", "--as-labels", "--preset", "smooth", "-j", "3")
            names, colors = ["a", "b", "c"], table[:, :3] / 255
            if name.endswith(".annot"):
                keys, found, found_names = fs.read_annot(target)
                return {"names": [x.decode() for x in found_names] == names, "colors": np.array_equal(found[:, :3], table[:, :3]), "keys": set(keys) <= {-1, 0, 1, 2}}
            if name.endswith(".gii"):
                image = nib.load(target)
                keys, entries = image.darrays[0].data, {x.key: (x.label, x.rgba) for x in image.labeltable.labels}
            else:
                image = nib.load(target)
                entries = image.header.get_axis(0).label[0]
                keys = image.get_fdata()[0]
            found = [entries[k] for k in range(3)]
            near = np.abs(np.array([x[1][:3] for x in found]) - colors).max() < 1e-6
            return {"names": [x[0] for x in found] == names, "colors": bool(near), "keys": set(keys) <= set(entries)}

        for name in ("lh.smooth.annot", "lh.smooth.label.gii", "lh.smooth.dlabel.nii"):
            report.check(f"adwave {name} read by nibabel", lambda name=name: labels_written(name))

        left = np.zeros(n, bool)
        left[3:] = True
        models = BrainModelAxis.from_mask(left, "CortexLeft") + BrainModelAxis.from_mask(np.ones(50, bool), "CortexRight")
        rows = np.random.default_rng(4).normal(size=(2, len(models))).astype("f4")
        nib.save(Cifti2Image(rows, (ScalarAxis(["first", "second"]), models)), folder / "a.dscalar.nii")
        nib.save(Cifti2Image(rows, (SeriesAxis(0, 1, 2), models)), folder / "a.dtseries.nii")

        def cifti(name, truth):
            # Vertices without values are masked: the signal is not a number there.
            values = np.asarray(adwave.field(surface, name, folder)).reshape(n, -1)
            return {"values": same_values(values[3:], truth[:, : n - 3].T), "masked": bool(np.isnan(values[:3]).all())}

        report.check("nibabel dscalar, one map", lambda: cifti(f"{folder}/a.dscalar.nii:second", rows[1:]))
        report.check("nibabel dtseries", lambda: cifti(f"{folder}/a.dtseries.nii", rows))

        def gifti(encoding):
            path = folder / f"{encoding}.surf.gii"
            image = nib.gifti.GiftiImage()
            for data, intent in ((shape.points.astype("f4"), "NIFTI_INTENT_POINTSET"), (np.array(shape.faces, "i4"), "NIFTI_INTENT_TRIANGLE")):
                image.add_gifti_data_array(nib.gifti.GiftiDataArray(data, intent=intent, encoding=encoding))
            nib.save(image, path)
            read = adwave.mask(path, folder)
            near = np.abs(read.points - shape.points).max() < 1e-5
            return {"points": near if encoding == "GIFTI_ENCODING_ASCII" else same_points(read, shape), "faces": len(read.faces) == len(shape.faces)}

        for encoding in ("GIFTI_ENCODING_ASCII", "GIFTI_ENCODING_B64BIN", "GIFTI_ENCODING_B64GZ"):
            report.check(f"nibabel {encoding}", lambda encoding=encoding: gifti(encoding))
    report.end()


if __name__ == "__main__":
    main()
