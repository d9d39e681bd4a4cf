"""Calls that are right, for a type checker in its strict mode."""

import adwave as aw
import numpy as np
from numpy.typing import NDArray

shape = aw.sample("creature", vertices=2000)
V, F = shape.vertices, shape.faces
f: NDArray[np.float64] = V[:, 2]

bands = aw.decompose(shape, f, levels=4)
pair = aw.decompose((V, F), f, fwhm=[1, 2, 4])
part = aw.decompose(V, faces=F, mask=f > 0, steps=[1, 2.5])
smooth = aw.smooth(shape, f, fwhm=8)
exact = aw.smooth(shape, f, fwhm="2%", exact=True)
steps = aw.smooth(shape, f, steps=3, only="part=1")
edited = aw.filter(shape, "smooth", operator=aw.Operator("walk", neighbors=12))
values = aw.filter(shape, [0, 1, 1], signal=f, where="ball:vertex=1,radius=2%")
clean, estimates = aw.denoise(shape, creases="keep")
salient: float = aw.saliency(shape, f).max()
places = aw.features(shape, best=5, options=aw.FeatureOptions(descriptors=True))
picture = aw.render(shape, f, scale=aw.ColorScale(color_map="magma"), camera=aw.Camera(view="front"))
less = aw.simplify(shape, ratio=0.5).vertices
facts = aw.info(shape, operator="surface", exact=True)
region = aw.region(shape, f > 0, blur="2%")

doubled = 2 * bands - 1
sizes = abs(bands)
mean = bands.mean(axis=0)
as_array = np.asarray(bands)
single = bands.astype(np.float32)
first: NDArray[np.float64] = bands[0]

prepared = aw.Decomposer(shape)
again = prepared.decompose(f, levels=aw.Widths(fwhm=[1, 2]))
matrix = prepared.matrix(lazy=False)
rows = aw.sklearn.WaveletFeatures(levels=4).fit_transform([shape])
split = aw.sklearn.SignalBands(shape, levels=4).fit_transform([f])
harmonics = aw.baselines.harmonics(shape, 5)
