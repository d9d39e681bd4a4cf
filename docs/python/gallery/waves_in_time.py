# %% [markdown]
# # Waves in time
# In: ten seconds of an electroencephalogram, which Matplotlib ships. Out: its bands by duration, which sum to it.
#
#     bands = aw.grid(series, spacing=0.0125).decompose(sigma=[0.015, 0.05, 0.2])

# %%
# %pip install -q adwave matplotlib
import adwave as aw
import numpy as np
from matplotlib import cbook
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

series = np.fromfile(cbook.get_sample_data("eeg.dat", asfileobj=False)).reshape(800, 4)[:, 0]
bands = aw.grid(series, spacing=0.0125).decompose(sigma=[0.015, 0.05, 0.2])
assert np.allclose(bands.sum(axis=0), series)

# %%
figure = Figure((8.7, 3.6), layout="constrained")
axes = figure.subplots()
names = ("given", "shorter than 15 ms", "15 to 50 ms", "50 to 200 ms", "longer")
for k, values in enumerate((series, *bands)):
    axes.plot(np.arange(800) * 0.0125, values / series.std() - 8 * k, color=f"C{k}", linewidth=1)
    axes.text(-0.1, -8 * k, names[k], color=f"C{k}", ha="right", va="center")
axes.set(xlim=(0, 10), xlabel="seconds", yticks=[])
axes.spines[["left", "top", "right"]].set_visible(False)
canvas = FigureCanvasAgg(figure)
canvas.draw()
picture = aw.Picture.from_array(np.asarray(canvas.buffer_rgba()))
picture.save("waves_in_time.png")
