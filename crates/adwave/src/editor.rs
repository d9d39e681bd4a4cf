//! Repeated edits of one signal: the bands are kept, and an edit costs as much as it changes.

use crate::bands::{BandsError, BandsInfo, Wavelets, check_buffer};
use crate::filter::{Edit, FilterError, FilterInput, LayerSlot, WeightedLayer, WeldedMembers};
use crate::mask::Mask;
use crate::pages::zeros;
use crate::region::RegionWeights;
use crate::{BandsRequest, Cancelled, Decomposer, Progress, parallel};
use std::ops::Range;

/// The welded vertices that an edit changed.
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum ChangedVertices {
    /// All vertices may have changed.
    All,
    /// The listed vertices alone, in ascending analysis order; [`Editor::members`] gives their vertices of the shape.
    Listed(Vec<u32>),
}

/// A signal with its bands, edited layer by layer: `f′ = f + Σ_j (Γ(j,x) − 1)·W_f(j,x)` (eq. 18), always up to
/// date.
///
/// The result depends only on the current layers, to the bit, not on the edits that led to them. An edit of all
/// vertices reads each band that it changes once; an edit of a region costs what the old and the new region cover.
/// Memory: (J + 3)·n·d values.
///
/// ```
/// use adwave::{Decomposer, bands::Schedule, filter::WeightedLayer, region::RegionWeights, shape::{Graph, Shape}};
/// let path = Shape::Graph(Graph::new(3, &[(0, 1, 1.0), (1, 2, 1.0)])?);
/// let mut editor = Decomposer::new(&path).request(&[0.0, 4.0, 0.0], 1, &Schedule::dyadic(1)?).editor()?;
/// editor.set_layers(vec![WeightedLayer::everywhere(vec![0.0])])?; // W_1 = (−2, 2, −2) taken away
/// assert_eq!(editor.edited(), [2.0, 2.0, 2.0]);
/// editor.set_weights(1, RegionWeights::Vertices(vec![1.0, 0.0, 0.5]))?;
/// assert_eq!(editor.edited(), [2.0, 4.0, 1.0]);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct Editor {
    decomposer: Decomposer,
    signal: Vec<f64>,
    wavelets: Wavelets,
    mean: Vec<f64>,
    layers: Vec<LayerSlot>,
    /// Members of each welded vertex, and the start of each list.
    first_member: Vec<usize>,
    members: Vec<u32>,
    edited: Vec<f64>,
    change: Vec<f64>,
}

/// Number of channels from which a signal is edited in groups of channels, without an [`Editor`], whose bands would
/// take several times the memory of the signal.
pub const MANY_CHANNELS: usize = 16;

/// Agreement of the result of a single edit with that of an [`Editor`] with the same layers.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub enum EditBits {
    /// Equal to the accuracy of the bands: gains that hold everywhere are one polynomial, for which no band is kept.
    #[default]
    Accuracy,
    /// Equal bit for bit, for signals of fewer than [`MANY_CHANNELS`] channels; recipes are applied in this way
    /// everywhere.
    Editor,
}

/// Number of rows whose channels a thread copies at a time.
const COPIED_AT_A_TIME: usize = 1 << 12;

/// The `channels` of a signal of n × `n_channels` values, n × channels; stops if the call is cancelled.
fn take_channels(
    signal: &[f64],
    n_channels: usize,
    channels: Range<usize>,
    progress: Progress<'_>,
) -> Result<Vec<f64>, Cancelled> {
    let width = channels.len();
    let mut taken: Vec<f64> = zeros(signal.len() / n_channels * width);
    parallel::try_visit_rows(&mut taken, width, COPIED_AT_A_TIME, progress, |first, rows| {
        let given = signal[first * n_channels..].chunks_exact(n_channels);
        rows.chunks_exact_mut(width)
            .zip(given)
            .for_each(|(to, from)| to.copy_from_slice(&from[channels.clone()]));
    })?;
    Ok(taken)
}

/// Puts values of some `channels`, n × channels, into a signal of n × `n_channels` values.
fn put_channels(values: &[f64], signal: &mut [f64], n_channels: usize, channels: Range<usize>) {
    let width = channels.len();
    parallel::visit_rows(signal, n_channels, COPIED_AT_A_TIME, |first, rows| {
        let given = values[first * width..].chunks_exact(width);
        rows.chunks_exact_mut(n_channels)
            .zip(given)
            .for_each(|(to, from)| to[channels.clone()].copy_from_slice(from));
    });
}

impl BandsRequest<'_> {
    /// Edits the signal once, and returns the new values with the cost and error bound of its bands. All front ends
    /// edit in this way: gains that hold everywhere are one polynomial, regions on few channels go through an
    /// [`Editor`], and signals of [`MANY_CHANNELS`] channels and more are edited
    /// [`channels_together`](crate::bands::BandsParams::channels_together) at a time. The number format is that of
    /// [`BandsParams::precision`](crate::bands::BandsParams::precision).
    ///
    /// ```
    /// use adwave::filter::WeightedLayer;
    /// use adwave::{Decomposer, EditBits, bands::Schedule, shape::{Graph, Shape}};
    /// let pair = Decomposer::new(&Shape::Graph(Graph::new(2, &[(0, 1, 1.0)])?));
    /// let schedule = Schedule::dyadic(1)?;
    /// let drop = vec![WeightedLayer::everywhere(vec![0.0])];
    /// let (smooth, _) = pair.request(&[1.0, 3.0], 1, &schedule).edit(drop, EditBits::Accuracy)?;
    /// assert_eq!(smooth, [2.0, 2.0]);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// As for [`filter_layers`](Self::filter_layers).
    pub fn edit(
        &self,
        layers: Vec<WeightedLayer>,
        bits: EditBits,
    ) -> Result<(Vec<f64>, BandsInfo), FilterError> {
        if self.n_channels() >= MANY_CHANNELS {
            return self.edit_in_groups(&layers);
        }
        let is_everywhere = matches!(&layers[..], [WeightedLayer { weights: RegionWeights::Everywhere, .. }]);
        if is_everywhere && bits == EditBits::Accuracy {
            return self.filter_layers_with_info(&layers);
        }
        let mut editor = self.editor()?;
        editor.set_layers(layers)?;
        let info = editor.wavelets.info.clone();
        Ok((editor.into_edited(), info))
    }

    /// Edits groups of channels of nearly equal size.
    fn edit_in_groups(&self, layers: &[WeightedLayer]) -> Result<(Vec<f64>, BandsInfo), FilterError> {
        let (values, n_channels) = (self.signal(), self.n_channels());
        let n_groups = n_channels.div_ceil(self.bands_params().channels_together());
        let most = n_channels.div_ceil(n_groups);
        let mut edited = zeros(values.len());
        let mut info: Option<BandsInfo> = None;
        for at in (0..n_channels).step_by(most) {
            self.reports().step(at as u64, n_channels as u64).map_err(BandsError::from)?;
            let width = most.min(n_channels - at);
            let channels = at..at + width;
            let group = take_channels(values, n_channels, channels.clone(), self.reports().quiet());
            let group = group.map_err(BandsError::from)?;
            let request = self.with_signal(&group, width).progress(self.reports().quiet());
            let (group, own) = request.filter_layers_with_info(layers)?;
            info = Some(info.map_or_else(|| own.clone(), |sum| sum.plus(&own)));
            put_channels(&group, &mut edited, n_channels, channels);
        }
        Ok((edited, info.expect("many channels are a group or more")))
    }

    /// Creates an editor that keeps the bands, for repeated edits of this signal.
    ///
    /// # Errors
    /// As for [`wavelets`](Self::wavelets).
    pub fn editor(&self) -> Result<Editor, BandsError> {
        let wavelets = self.unmasked_wavelets(&self.filled()?)?;
        self.editor_from_wavelets(wavelets)
    }

    /// Creates an editor from wavelets of this signal that were computed before. They are not compared with the
    /// signal.
    ///
    /// # Errors
    /// [`BandsError`] if the size of the wavelets does not match the signal or the levels.
    pub fn editor_from_wavelets(&self, wavelets: Wavelets) -> Result<Editor, BandsError> {
        let (filled, vertex_map) = (self.filled()?, self.vertex_map());
        let expected = vertex_map.n_welded() * self.n_channels();
        check_buffer(wavelets.n_levels() * expected, self.schedule().n_levels() * expected)?;
        for level in &wavelets.levels {
            check_buffer(level.len(), expected)?;
        }
        let is_welded = vertex_map.n_welded() < vertex_map.n_vertices();
        let mean = if is_welded { vertex_map.mean(&filled, self.n_channels()) } else { Vec::new() };
        Ok(Editor::new(self.decomposer().clone(), self.signal().to_vec(), wavelets, mean))
    }
}

impl Editor {
    fn new(decomposer: Decomposer, signal: Vec<f64>, wavelets: Wavelets, mean: Vec<f64>) -> Self {
        let (first_member, members) = decomposer.vertex_map().members().into_parts();
        let mut edited = zeros(signal.len());
        edited.copy_from_slice(&signal);
        let (change, layers) = (Vec::new(), Vec::new());
        Self { decomposer, signal, wavelets, mean, layers, first_member, members, edited, change }
    }

    /// The edited signal, n_vertices × n_channels, in the order of the shape.
    pub fn edited(&self) -> &[f64] {
        &self.edited
    }

    /// The values of [`edited`](Self::edited), without copying them.
    pub fn into_edited(self) -> Vec<f64> {
        self.edited
    }

    /// The original signal.
    pub fn signal(&self) -> &[f64] {
        &self.signal
    }

    /// Wavelet coefficients of the signal in the analysis order; 0 at masked vertices.
    pub fn wavelets(&self) -> &Wavelets {
        &self.wavelets
    }

    /// The prepared shape.
    pub fn decomposer(&self) -> &Decomposer {
        &self.decomposer
    }

    /// Number of layers.
    pub fn n_layers(&self) -> usize {
        self.layers.len()
    }

    /// Members of welded vertex `x`, as vertices of the shape.
    pub fn members(&self, x: usize) -> &[u32] {
        &self.members[self.first_member[x]..self.first_member[x + 1]]
    }

    /// Replaces all layers by those of an edit. To make it cancellable, call [`Edit::resolve`] and then
    /// [`set_layers`](Self::set_layers).
    ///
    /// # Errors
    /// [`FilterError`] if gains or regions do not match; then nothing changes.
    pub fn set_edit(&mut self, edit: &Edit<'_>) -> Result<(), FilterError> {
        let layers = edit.resolve(self.wavelets.n_levels(), self.decomposer.metric(), Progress::none())?;
        self.set_layers(layers)
    }

    /// Replaces all layers. O(n × levels × channels).
    ///
    /// # Errors
    /// As for [`set_edit`](Self::set_edit).
    pub fn set_layers(&mut self, layers: Vec<WeightedLayer>) -> Result<(), FilterError> {
        let vertex_map = self.decomposer.vertex_map();
        for (k, layer) in layers.iter().enumerate() {
            layer.check(k + 1, self.wavelets.n_levels(), vertex_map)?;
        }
        self.layers = layers.into_iter().map(|layer| LayerSlot::new(layer, vertex_map)).collect();
        self.update(ChangedVertices::All);
        Ok(())
    }

    /// Adds a layer after the others, and returns the changed vertices.
    ///
    /// # Errors
    /// As for [`set_edit`](Self::set_edit).
    pub fn push_layer(&mut self, layer: WeightedLayer) -> Result<ChangedVertices, FilterError> {
        let vertex_map = self.decomposer.vertex_map();
        layer.check(self.layers.len() + 1, self.wavelets.n_levels(), vertex_map)?;
        let slot = LayerSlot::new(layer, vertex_map);
        let touched = support(&slot);
        self.layers.push(slot);
        Ok(self.update(touched))
    }

    /// Removes layer `layer` (from 1), and returns the changed vertices.
    ///
    /// # Errors
    /// [`FilterError::NoSuchLayer`] if the layer does not exist.
    pub fn remove_layer(&mut self, layer: usize) -> Result<ChangedVertices, FilterError> {
        let touched = support(self.slot(layer)?);
        self.layers.remove(layer - 1);
        Ok(self.update(touched))
    }

    /// Replaces the gains of layer `layer` (from 1), and returns the changed vertices: those in the layer's region.
    ///
    /// # Errors
    /// [`FilterError`] if the layer does not exist or the gains do not match; then nothing changes.
    pub fn set_gains(&mut self, layer: usize, gains: &[f64]) -> Result<ChangedVertices, FilterError> {
        crate::filter::check_gains(gains, self.wavelets.n_levels())?;
        let slot = self.slot(layer)?;
        slot.set_gains(gains);
        let touched = support(slot);
        Ok(self.update(touched))
    }

    /// Replaces the weights of layer `layer` (from 1), and returns the changed vertices: those covered by the old
    /// or the new weights.
    ///
    /// # Errors
    /// [`FilterError`] if the layer does not exist or the weights do not match; then nothing changes.
    pub fn set_weights(
        &mut self,
        layer: usize,
        weights: RegionWeights,
    ) -> Result<ChangedVertices, FilterError> {
        let decomposer = self.decomposer.clone();
        let vertex_map = decomposer.vertex_map();
        weights.check(vertex_map).map_err(|source| FilterError::Region { layer, source })?;
        let touched = self.slot(layer)?.set_weights(weights, vertex_map);
        Ok(self.update(touched.map_or(ChangedVertices::All, ChangedVertices::Listed)))
    }

    fn slot(&mut self, layer: usize) -> Result<&mut LayerSlot, FilterError> {
        let n_layers = self.layers.len();
        let slot = layer.checked_sub(1).and_then(|k| self.layers.get_mut(k));
        slot.ok_or(FilterError::NoSuchLayer { layer, n_layers })
    }

    /// Recomputes the changed vertices.
    fn update(&mut self, touched: ChangedVertices) -> ChangedVertices {
        let source = FilterInput {
            signal: &self.signal,
            wavelets: &self.wavelets,
            mean: &self.mean,
            vertex_map: self.decomposer.vertex_map(),
            masked: self.decomposer.mask().map(Mask::vertices),
        };
        match &touched {
            ChangedVertices::All => source.apply(&self.layers, &mut self.change, &mut self.edited),
            ChangedVertices::Listed(touched) => {
                let welded = WeldedMembers { first_member: &self.first_member, members: &self.members };
                source.apply_at(&self.layers, touched, welded, &mut self.edited);
            }
        }
        touched
    }
}

fn support(slot: &LayerSlot) -> ChangedVertices {
    slot.support().map_or(ChangedVertices::All, |support| ChangedVertices::Listed(support.to_vec()))
}
