"""The widget: a slider for each band of a layer."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from napari.qt.threading import create_worker
from napari.utils.notifications import show_error
from qtpy.QtCore import Qt
from qtpy.QtWidgets import (
    QComboBox,
    QFormLayout,
    QHBoxLayout,
    QLabel,
    QPushButton,
    QSlider,
    QSpinBox,
    QVBoxLayout,
    QWidget,
)

from napari_adwave.layers import Signal, signal_of

if TYPE_CHECKING:
    import napari

#: Steps of a slider for a gain of 1.
ONE = 100
#: Largest gain of a slider.
MOST_GAIN = 4
MOST_LEVELS = 12


class Equalizer(QWidget):
    """Splits a layer into bands and adds a layer that follows the sliders."""

    def __init__(self, viewer: napari.Viewer) -> None:
        super().__init__()
        self.viewer = viewer
        self.signal: Signal | None = None
        self.bands: Any = None
        self.result: Any = None
        self.sliders: list[QSlider] = []
        self.choice = QComboBox()
        self.levels = QSpinBox()
        self.levels.setRange(1, MOST_LEVELS)
        self.levels.setValue(6)
        self.buttons = {name: QPushButton(name) for name in ("Split", "Denoise", "Stands out", "Reset")}
        self.message = QLabel("Choose a layer and press Split.")
        self.message.setWordWrap(True)
        self.rows = QFormLayout()
        self._lay_out()
        for name, call in (("Split", self.split), ("Denoise", self.denoise), ("Stands out", self.stands_out)):
            self.buttons[name].clicked.connect(lambda _=False, call=call: self._guarded(call))
        self.buttons["Reset"].clicked.connect(lambda _=False: self.set_gains([1.0] * len(self.sliders)))
        viewer.layers.events.inserted.connect(self._list_layers)
        viewer.layers.events.removed.connect(self._list_layers)
        self._list_layers()

    def _lay_out(self) -> None:
        head = QFormLayout()
        head.addRow("Layer", self.choice)
        head.addRow("Levels", self.levels)
        row = QHBoxLayout()
        for button in self.buttons.values():
            row.addWidget(button)
        whole = QVBoxLayout(self)
        whole.addLayout(head)
        whole.addLayout(row)
        whole.addWidget(self.message)
        whole.addLayout(self.rows)
        whole.addStretch()

    def _list_layers(self, _event: Any = None) -> None:
        chosen = self.choice.currentText()
        self.choice.clear()
        self.choice.addItems([layer.name for layer in self.viewer.layers])
        if chosen in self.viewer.layers:
            self.choice.setCurrentText(chosen)

    def _guarded(self, call: Any) -> None:
        """Call a method and show the line of its error."""
        try:
            call()
        except (ValueError, TypeError, MemoryError) as error:
            self._fail(str(error))

    def _fail(self, error: str) -> None:
        self._set_busy(None)
        self.message.setText(error)
        show_error(error)

    def _set_busy(self, text: str | None) -> None:
        for button in self.buttons.values():
            button.setEnabled(text is None)
        if text is not None:
            self.message.setText(text)

    def _start(self, text: str, compute: Any, done: Any) -> Any:
        """Compute in a thread, so that the window stays alive, and take the result."""

        def attempt() -> tuple[Any, str | None]:
            # A worker raises an error again in the window, so it comes back as a text and is shown once.
            try:
                return compute(), None
            except (ValueError, TypeError, MemoryError) as error:
                return None, str(error)

        self._set_busy(text)
        worker = create_worker(attempt, _start_thread=False)
        worker.returned.connect(lambda outcome: self._finish(*outcome, done))
        worker.start()
        return worker

    def _finish(self, result: Any, error: str | None, done: Any) -> None:
        if error is None:
            done(result)
        else:
            self._fail(error)

    def chosen(self) -> Signal:
        """Signal of the chosen layer.

        Raises
        ------
        ValueError
            If it has no bands.
        """
        name = self.choice.currentText()
        return signal_of(self.viewer.layers[name] if name else None)

    def split(self) -> Any:
        """Compute the bands of the chosen layer and make a slider for each."""
        signal, n_levels = self.chosen(), self.levels.value()
        return self._start("Splitting …", lambda: (signal, signal.decompose(n_levels)), self._take_bands)

    def _take_bands(self, computed: tuple[Signal, Any]) -> None:
        self.signal, self.bands = computed
        self.result = None
        while self.rows.rowCount():
            self.rows.removeRow(0)
        self.sliders = []
        widths = [*np.ravel(self.bands.fwhm), np.nan][: len(self.bands)]
        for k in range(len(self.bands) - 1):
            slider = QSlider(Qt.Orientation.Horizontal)
            slider.setRange(0, MOST_GAIN * ONE)
            slider.setValue(ONE)
            slider.valueChanged.connect(lambda _value: self._guarded(self.apply))
            self.sliders.append(slider)
            self.rows.addRow(f"up to {widths[k]:.3g}", slider)
        self._set_busy(None)
        self.message.setText(f"{len(self.sliders)} bands, fine to coarse; 1 keeps a band, 0 removes it.")

    def gains(self) -> list[float]:
        """Gain of each band."""
        return [slider.value() / ONE for slider in self.sliders]

    def set_gains(self, gains: list[float]) -> None:
        """Set all sliders, and compute once."""
        for slider, gain in zip(self.sliders, gains, strict=True):
            slider.blockSignals(True)
            slider.setValue(round(gain * ONE))
            slider.blockSignals(False)
        if self.sliders:
            self._guarded(self.apply)

    def apply(self) -> None:
        """Show the bands with their gains, in the layer of the result."""
        assert self.signal is not None
        values = np.asarray(self.bands.apply(self.gains()))
        name = f"{self.signal.layer.name} equalized"
        layer = self.signal.new_layer(values, name)
        if self.result is not None and self.result in self.viewer.layers:
            self.result.data = layer.data
        else:
            self.result = self.viewer.add_layer(layer)

    def denoise(self) -> Any:
        """Add a layer without the noise of the chosen one."""
        signal = self.chosen()
        name = f"{signal.layer.name} denoised"
        return self._start("Denoising …", signal.denoise, lambda values: self._add(signal.new_layer(values, name)))

    def stands_out(self) -> Any:
        """Add a map of what stands out of the chosen layer."""
        signal = self.chosen()
        name = f"{signal.layer.name} saliency"
        return self._start("Mapping …", signal.saliency, lambda values: self._add(signal.map_layer(values, name)))

    def _add(self, layer: Any) -> None:
        self.viewer.add_layer(layer)
        self._set_busy(None)
        self.message.setText(f"Added {layer.name}.")
