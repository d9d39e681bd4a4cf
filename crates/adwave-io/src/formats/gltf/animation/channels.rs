//! Choice of an animation, and its weights by the nodes that show the meshes.

use std::collections::BTreeMap;

use adwave::Progress;

use super::super::json::Json;
use super::super::read::VertexGroup;
use super::super::update::GltfSource;
use super::sampler::{MemoryCounter, WeightTrack};
use crate::ReadError;

/// Weights of an animation by the nodes that show the meshes.
pub(super) struct AnimatedNodes {
    pub(super) tracks: BTreeMap<usize, WeightTrack>,
    pub(super) notes: Vec<String>,
}

/// Channels of an animation that set weights.
fn weight_channels(animation: &Json) -> impl Iterator<Item = (usize, &Json, &Json)> {
    let channels = animation.list_of("channels").iter().enumerate();
    let channels = channels.filter_map(|(k, channel)| Some((k, channel, channel.get("target")?)));
    channels.filter(|(_, _, target)| target.text_of("path") == Some("weights"))
}

/// Name of an animation in messages.
fn shown_name(k: usize, animation: &Json) -> String {
    const LONGEST: usize = 60;
    match animation.text_of("name") {
        Some(name) => {
            format!("`{}`", name.chars().filter(|c| !c.is_control()).take(LONGEST).collect::<String>())
        }
        None => format!("number {k} without a name"),
    }
}

/// Finds the animation of that name, or the first one with weights.
pub(super) fn choose_animation<'a>(
    animations: &'a [Json],
    name: Option<&str>,
    notes: &mut Vec<String>,
) -> Result<&'a Json, ReadError> {
    /// Number of names in a message.
    const MOST_NAMES: usize = 20;
    if animations.is_empty() {
        return Err(ReadError::Whole(
            "the file must have an animation, got none; export it with its animation of morph targets".into(),
        ));
    }
    let numbered = || animations.iter().enumerate();
    let names = || {
        let names: Vec<String> =
            numbered().take(MOST_NAMES).map(|(k, animation)| shown_name(k, animation)).collect();
        let n_more = animations.len() - names.len();
        names.join(", ") + &if n_more > 0 { format!(" and {n_more} more") } else { String::new() }
    };
    let of_name = || numbered().filter(|(_, a)| name.is_none_or(|name| a.text_of("name") == Some(name)));
    let Some(_) = of_name().next() else {
        let name: String = name.unwrap_or_default().chars().filter(|c| !c.is_control()).collect();
        return Err(ReadError::Whole(format!(
            "the file has no animation `{name}`; choose one of {}",
            names()
        )));
    };
    let Some((k, animation)) = of_name().find(|(_, a)| weight_channels(a).next().is_some()) else {
        let which =
            name.map_or_else(|| format!("one of {}", names()), |name| format!("the animation `{name}`"));
        return Err(ReadError::Whole(format!(
            "{which} must have a channel of weights, got none; export the animation as morph targets (shape keys)"
        )));
    };
    if name.is_none() && animations.len() > 1 {
        notes.push(format!(
            "the file has {} animations, and the first one with weights was read: {}",
            animations.len(),
            shown_name(k, animation)
        ));
    }
    Ok(animation)
}

/// Reads the weights of all nodes that show morph targets in the scene.
pub(super) fn animated_nodes(
    source: &GltfSource,
    animation: &Json,
    memory: &mut MemoryCounter<'_>,
    progress: Progress<'_>,
) -> Result<AnimatedNodes, ReadError> {
    let (document, json) = (&source.document, &source.document.json);
    let (nodes, samplers) = (json.list_of("nodes"), animation.list_of("samplers"));
    let mut tracks = BTreeMap::new();
    let mut notes = Vec::new();
    let mut targets_of_node = vec![None; nodes.len()];
    for part in &source.parts {
        // All primitives of a mesh have its number of targets.
        if let Some(node) = part.instance.node.filter(|&node| targets_of_node[node].is_none()) {
            let mesh = part.instance.mesh;
            targets_of_node[node] = Some(n_targets(&json.list_of("meshes")[mesh], mesh)?);
        }
    }
    let mut n_without = 0;
    for (k, channel, target) in weight_channels(animation) {
        progress.check()?;
        let wrong = |what: String| {
            ReadError::Whole(format!("channel {k} of the animation {what}; export the animation again"))
        };
        let Some(node) = target.index_of("node") else {
            n_without += 1;
            continue;
        };
        let Some(&n_targets) = targets_of_node.get(node) else {
            return Err(wrong(format!("names node {node}, but there are {}", nodes.len())));
        };
        let sampler = channel.index_of("sampler").and_then(|index| samplers.get(index));
        let sampler =
            sampler.ok_or_else(|| wrong(format!("must name one of {} samplers", samplers.len())))?;
        let Some(n_targets) = n_targets.filter(|&n| n > 0) else {
            n_without += 1;
            continue;
        };
        if tracks.contains_key(&node) {
            return Err(wrong(format!("sets the weights of node {node} again")));
        }
        let place = format!("channel {k} of the animation");
        let track = WeightTrack::read(document, sampler, n_targets, &place, memory, progress)?;
        tracks.insert(node, track);
    }
    if tracks.is_empty() {
        return Err(ReadError::Whole(
            "the animation must set weights of a mesh with morph targets in the scene, got none; export the mesh \
             with its morph targets"
                .into(),
        ));
    }
    if n_without > 0 {
        notes.push(format!(
            "channels of weights without morph targets in the scene, which move nothing: {n_without}"
        ));
    }
    notes.extend(note_on_others(animation, source));
    Ok(AnimatedNodes { tracks, notes })
}

/// Remark on the channels and skins that are not applied.
fn note_on_others(animation: &Json, source: &GltfSource) -> Vec<String> {
    let channels = animation.list_of("channels").iter();
    let paths: Vec<&str> = channels.filter_map(|channel| channel.get("target")?.text_of("path")).collect();
    let mut named: Vec<&str> =
        ["translation", "rotation", "scale"].into_iter().filter(|path| paths.contains(path)).collect();
    if paths.iter().any(|path| *path != "weights" && !named.contains(path)) {
        named.push("other properties");
    }
    let nodes = source.document.json.list_of("nodes");
    let has_skin = |part: &VertexGroup| {
        part.instance.node.and_then(|node| nodes.get(node)).is_some_and(|node| node.get("skin").is_some())
    };
    let mut notes = Vec::new();
    if !named.is_empty() {
        let named = named.join(", ");
        notes.push(format!("the animation of {named} is not applied; nodes keep their transforms"));
    }
    if source.parts.iter().any(has_skin) {
        notes.push("skins are not applied; their meshes are moved by morph targets alone".into());
    }
    notes
}

/// Number of morph targets of a mesh: that of its primitives, some of which may have none.
fn n_targets(mesh: &Json, index: usize) -> Result<usize, ReadError> {
    let counts = || mesh.list_of("primitives").iter().map(|primitive| primitive.list_of("targets").len());
    let n = counts().max().unwrap_or(0);
    match counts().find(|&count| count != 0 && count != n) {
        Some(count) => Err(ReadError::Whole(format!(
            "the primitives of mesh {index} must have the same number of morph targets, got {count} and {n}; export \
             the mesh again"
        ))),
        None => Ok(n),
    }
}
