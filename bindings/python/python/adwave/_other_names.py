"""Names that other libraries give to what this package has: options, functions, attributes and words."""

from __future__ import annotations

#: Options of other libraries, by the option here that they stand for.
_OPTIONS = {
    # Only features have it, and of them a number is that of the best.
    "best": "n_features n_best top top_k max_features n_keypoints num_features count n_max n k number num",
    "levels": (
        "n_levels level n_scales nscales j n_bands nlevels depth max_level num_levels num_scales nb_levels "
        "max_levels nb_scales octaves n_octaves nf n_filters num_filters n_components num_bands"
    ),
    "steps": (
        "t n_steps time times tau iterations n_iter n_iterations iters power n niter number_of_iterations "
        "num_iterations num_steps max_iter filter_iterations repeat order diffusion_time n_times hops scales K "
        "n_hops num_hops num_layers"
    ),
    "neighbors": "k knn n_neighbors n_neighbours neighbours nn num_neighbors max_nn nb_neighbors kneighbors n_neigh",
    "threads": "n_jobs num_threads n_threads workers nthreads num_workers",
    "color_map": "cmap colormap colors_map",
    "range": "clim vmin vmax color_range",
    "signal": (
        "f x data values scalars y field feature texture img value scalar name function s sig features "
        "signals layer vertex_values point_data array arr map key surf_map surf_data stat_map node_attr color"
    ),
    "where": "region roi subset",
    "mask": "mask_img vertex_mask indices",
    "weights": "weight edge_weight w edge_weights edge_attr weighting",
    "operator": "method kernel laplacian kind walk lazy exact normalization normalized",
    "gains": "preset gain filter coefficients coeffs g mode_gains response type",
    "sigma": "std std_dev std_deviation sd smoothing bandwidth sigmas s stddev scale sigma_range",
    "widths": "lengths length sizes radius radii rms_width width size distance",
    "fwhm": "smoothing_fwhm kernel_fwhm fwhm_mm",
    "seed": "random_state rng random_seed",
    "progress": "verbose progress_bar show_progress disable tqdm",
    "accuracy": "tol tolerance eps rtol atol convergence",
    "noise": "noise_level noise_sigma sigma_noise noise_std std_noise variance",
    "strength": "alpha h factor amount denoise_strength",
    "vertices": (
        "target n_vertices n_points target_count faces_count n num_vertices n_verts resolution target_number_of_points"
    ),
    "faces_wanted": "face_count target_number_of_triangles n_faces target_faces num_faces",
    "ratio": "fraction percent keep target_perc proportion",
    "reduction": "target_reduction percent_reduction",
    "theta": "threshold thresh thr threshold_abs min_response contrast_threshold",
    "open_browser": "open browser show launch",
    "axis": "dim",
    "axes": "dims axis dim spatial_dims channel_axis",
    "faces": "triangles tri tris cells f elements face simplices topology",
    "points": "vertices verts v coords coordinates pos xyz nodes pts",
    "spacing": "voxel_size pixdim zooms cellsize pixel_size sampling voxel_sizes cell_size dx res",
    "affine": "",
    "genes": "gene var_names gene_names gene_list",
    "edge_index": "",
    "nodes": "num_nodes n_nodes number_of_nodes",
    "periodic": "mode boundary wrap padding pad_mode",
    "nothing": (
        "lamb lambda_ lam mu nu relaxation_factor inplace copy metric normalize return_info pass_band "
        "feature_angle boundary_smoothing feature_smoothing edge_angle implicit_time_integration truncate "
        "cval output dtype device symmetric volume_constraint laplacian_operator in_place filter_scope solver "
        "random progress_callback cutoff beta gamma wavelet symmetrize p use_rep basis std_ratio radius_factor kernel_size"
    ),
}
#: Options here that an option of another library may stand for, in the order in which they are tried.
OPTIONS_OF: dict[str, list[str]] = {}
for _ours, _names in _OPTIONS.items():
    for _name in (*_names.split(), _ours):
        OPTIONS_OF.setdefault(_name, []).append(_ours)
#: Words of other libraries for what comes first, the surest first.
SHAPE_WORDS = (
    *("edge_index", "surf_mesh", "mesh", "surface", "shape", "graph", "G", "vertices", "verts", "V", "points", "xyz"),
    *("pos", "coords", "coordinates", "adjacency", "adj", "W", "A", "adata", "pcd", "point_cloud", "cloud", "poly"),
    *("polydata", "volume", "img", "image", "grid", "data", "X"),
)
#: Names of a number of neighbors.
NEIGHBOR_NAMES = ("neighbors", *_OPTIONS["neighbors"].split())


def _reversed(names_of: dict[str, str]) -> dict[str, str]:
    return {name: ours for ours, names in names_of.items() for name in names.split()}


#: Functions of other libraries, by the function here that does the same.
_FUNCTIONS = {
    "Shape": (
        "mesh trimesh trianglemesh polydata graph pointcloud cloud surface from_mesh from_trimesh "
        "from_networkx from_vertices_faces from_arrays pygraph as_mesh create_mesh"
    ),
    "read": (
        "load read_mesh load_mesh open loadmesh read_point_cloud read_triangle_mesh read_shape from_file load_shape"
    ),
    "decompose": (
        "wavelets wavelet transform dwt wavedec swt bands split analyze analysis wavelet_transform multiscale "
        "decomposition forward diffusion_wavelets wavelet_decompose decompose_signal pyramid starlet wavedec2"
    ),
    "smooth": (
        "diffuse heat_kernel heat heat_diffusion blur lowpass gaussian gaussian_smooth smoothing diffusion "
        "smooth_data smooth_mesh filter_smooth_simple laplacian_smooth heat_smooth smooth_img "
        "smooth_surface smooth_signal gaussian_filter gaussian_blur smooth_image smooth_array "
        "filter_laplacian filter_humphrey heat_method"
    ),
    "denoise": "denoising remove_noise clean denoise_mesh denoise_image denoise_wavelet denoise_signal threshold "
    "remove_statistical_outlier remove_radius_outlier remove_outliers",
    "filter": (
        "sharpen enhance equalize apply_filter bandpass highpass band_pass filter_signal filter_mesh unsharp_mask"
    ),
    "saliency": "saliency_map salience mesh_saliency",
    "features": (
        "keypoints detect interest_points detect_features find_features blobs blob_log peaks sift detect_keypoints"
    ),
    "match": (
        "icp registration_icp register registration align registration_ransac find_motion match_shapes fit_motion"
    ),
    "distances": "distance hausdorff chamfer compare diff difference hausdorff_distance chamfer_distance compute_point_cloud_distance",
    "simplify": (
        "decimate decimation simplify_quadric_decimation decimate_pro reduce voxel_down_sample downsample "
        "qslim simplify_quadric simplify_mesh quadric_decimation"
    ),
    "subdivide": "loop_subdivision refine upsample",
    "point_walk": "knn knn_graph kneighbors_graph nearest_neighbors neighbor_graph from_points neighbors_walk knn_walk",
    "walk": "random_walk markov transition_matrix diffusion_operator from_adjacency markov_chain walk_from_graph",
    "impute": "magic imputation impute_counts magic_impute",
    "scattering": "scatter scattering_transform geometric_scattering",
    "grid": "image volume raster voxels array from_array from_image image_data imagedata as_grid",
    "render": "plot show view draw picture screenshot snapshot plot_mesh",
    "sample": "example dataset samples load_example example_mesh get_sample",
    "info": "describe summary stats health check",
    "region": "roi select ball mask brush patch geodesic_ball neighborhood",
    "Widths": "widths scales",
    "Steps": "steps",
    "Decomposer": "prepare prepared waveletoperator operator_of solver",
    "studio": "gui app editor",
    "threads": "set_num_threads set_threads num_threads n_threads",
    "show_versions": "versions version_info",
    "signal": "curvature mean_curvature normals estimate_normals compute_normals vertex_normals gaussian_curvature",
    "baselines": "taubin filter_taubin smooth_taubin filter_smooth_taubin harmonics heat_kernel_signature eigenvectors "
    "diffmap diffusion_map diffusion_maps laplacian_eigenmaps spectral_embedding eigenmodes",
}
FUNCTION_OF = _reversed(_FUNCTIONS)
#: Signals by names of functions that compute them elsewhere.
SIGNALS = {
    "curvature": "mean-curvature",
    "mean_curvature": "mean-curvature",
    "gaussian_curvature": "gaussian-curvature",
}
#: Baselines by names of functions elsewhere.
BASELINES = {
    "filter_taubin": "taubin",
    "smooth_taubin": "taubin",
    "filter_smooth_taubin": "taubin",
    **dict.fromkeys(("eigenvectors", "eigenmodes", "diffmap", "diffusion_map", "diffusion_maps"), "harmonics"),
    **dict.fromkeys(("laplacian_eigenmaps", "spectral_embedding"), "harmonics"),
}
#: Options of baselines by the words that other libraries have for them.
BASELINE_OPTIONS = {
    "iterations": ("n_iter", "number_of_iterations", "filter_iterations"),
    "lam": ("lamb", "lambda_", "lambda_filter"),
}
#: Presets by the words that other programs have for them.
PRESETS = {
    "enhance": ("sharpen", "sharp", "highpass", "high-pass", "high_pass", "boost", "unsharp", "detail"),
    "smooth": ("lowpass", "low-pass", "low_pass", "blur", "gaussian", "heat", "denoise", "laplacian", "taubin"),
}
#: Former names of functions.
FORMER = {"point_walk": "points"}
#: Attributes of objects of other libraries, by the attribute here, with its arguments; ``[-1]`` is the last of the bands.
_MEMBERS = {
    "write": "save export to_file write_mesh save_mesh dump",
    "n_vertices": "n_points n_verts num_vertices n_cells vertex_count n_samples nvertices num_nodes number_of_nodes N n",
    "n_faces": "n_triangles num_faces face_count n_cells_",
    "points": "V v verts xyz coords coordinates pos",
    "faces": "F triangles tris simplices",
    "fields": "point_data vertex_attributes attributes data columns",
    "matrix()": "P W A T L adjacency",
    "matrix": (
        "to_scipy to_sparse toarray todense as_matrix transition_matrix laplacian to_matrix get_matrix dense to_csr"
    ),
    'signal("normals")': "normals vertex_normals point_normals compute_normals",
    'signal("mean-curvature")': "curvature mean_curvature",
    "decompose": "transform wavelets wavelet_transform dwt analyze split wavedec",
    "smooth": "diffuse blur gaussian heat apply gaussian_filter lowpass",
    "features": "keypoints detect blobs",
    "[-1]": "residual residue rest base approximation approx coarse trend",
    "reconstruct": "inverse synthesize inverse_transform sum_bands",
    "select": "extract subset crop mask_vertices",
    "mean_length": "mean_edge_length avg_edge_length",
    "to_pyvista": "pyvista wrap",
    "to_trimesh": "trimesh",
}
MEMBER_OF = _reversed(_MEMBERS)
#: Methods of objects of other libraries, by the function here.
_AS_FUNCTIONS = {
    "render": "plot show draw view render picture",
    "info": "info describe summary is_watertight stats",
    "simplify": "simplify decimate",
    "scattering": "scattering scatter",
    "impute": "impute magic",
    "studio": "studio gui",
    "report": "report",
    "distances": "distances distance hausdorff",
    "match": "match register icp align",
}
AS_FUNCTION = _reversed(_AS_FUNCTIONS)
