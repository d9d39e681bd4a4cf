"""Plug-in of napari: an equalizer for its layers, and a reader of meshes and point clouds."""
