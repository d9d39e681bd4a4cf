//! The graph of cells that is chosen from their counts alone, with a time for each gene.

use super::ImputeArgs;
use crate::error::CliError;
use crate::global::Global;
use crate::output::progress::with_progress;
use crate::output::{count, number, table};
use crate::resolve::walk::{ResolvedWalk, in_file};
use adwave_graph::{
    ComparedGraph, CountMatrix, GraphChoice, GraphChoiceParams, GraphWalkError, Transformation, WalkPowers,
    cell_walk, choose_graph,
};
use serde_json::{Value, json};

/// The chosen graph and its walk on all cells.
pub(super) struct ChosenGraph {
    pub(super) walk: ResolvedWalk,
    pub(super) choice: GraphChoice,
}

/// Chooses components, neighbors and times, and makes the walk on all cells.
pub(super) fn choose(
    args: &ImputeArgs,
    matrix: &CountMatrix<'_>,
    transformation: Transformation,
    global: &Global<'_>,
) -> Result<ChosenGraph, CliError> {
    let options = ["--neighbors", "--kernel", "--symmetrize", "--self-loops", "--normalize", "--stay"];
    global.given.refuse(&options, "applies to --graph or --points; without them the graph is chosen")?;
    let failed = |e: GraphWalkError| in_file(&args.counts, &e);
    let params = GraphChoiceParams::default().with_transformation(transformation).with_seed(args.seed);
    let found =
        with_progress(global, "choosing the graph", |progress| choose_graph(matrix, params, progress));
    let choice = found.map_err(failed)?.ok_or_else(|| {
        CliError::Input(format!(
            "{}: a graph is chosen of at least 50 cells and 20 genes that vary; give --graph, --walk or --points",
            args.counts.display()
        ))
    })?;
    let best = choice.best;
    let powers: WalkPowers =
        with_progress(global, "finding neighbors", |progress| cell_walk(matrix, &best, progress))
            .map_err(failed)?;
    let source = format!(
        "to the {} nearest neighbors in {} principal components ({}), loops of weight 1, row normalization",
        best.n_neighbors, best.n_components, best.scaling
    );
    let (n, n_entries) = (powers.n_nodes(), powers.walk().rows().nnz());
    let text =
        format!("{}, {}; walk {source}", count(n, "node", "nodes"), count(n_entries, "entry", "entries"));
    let json = json!({
        "nodes": n,
        "entries": n_entries,
        "isolated": powers.walk().n_isolated(),
        "reversible": powers.walk().is_reversible(),
        "normalization": powers.walk().normalization().name(),
        "walk": source,
    });
    Ok(ChosenGraph { walk: ResolvedWalk { powers, text, json }, choice })
}

/// Table of the graphs that were compared, and the steps of the genes.
pub(super) fn text(choice: &GraphChoice) -> String {
    let genes = |held: usize| count(held, "gene", "genes");
    let mut text = format!(
        "chosen by {} held back from the graphs of {}\n\n",
        genes(choice.n_held_back),
        count(choice.n_cells, "cell", "cells")
    );
    text += &table(
        ["components", "of", "neighbors", "steps", "unexplained share", ""],
        choice.compared.iter().map(|graph| {
            let is_best = key(graph) == key(&choice.best);
            [
                graph.n_components.to_string(),
                graph.scaling.to_string(),
                graph.n_neighbors.to_string(),
                graph.steps.to_string(),
                number(graph.loss),
                if is_best { "least" } else { "" }.to_owned(),
            ]
        }),
    );
    text += &format!("\nsteps of the genes: {}\n", steps_text(&choice.steps));
    text
}

fn key(graph: &ComparedGraph) -> (adwave_graph::ComponentScaling, usize, usize) {
    (graph.scaling, graph.n_components, graph.n_neighbors)
}

/// Numbers of genes by their steps.
fn steps_text(steps: &[u32]) -> String {
    let mut sorted = steps.to_vec();
    sorted.sort_unstable();
    let groups = sorted.chunk_by(|a, b| a == b);
    let texts: Vec<String> =
        groups.map(|group| format!("{} of {}", group[0], count(group.len(), "gene", "genes"))).collect();
    texts.join(", ")
}

/// JSON of the graphs that were compared, and of the steps of each gene.
pub(super) fn json(choice: &GraphChoice) -> Value {
    let graph = |graph: &ComparedGraph| {
        json!({
            "scaling": graph.scaling.name(),
            "components": graph.n_components,
            "neighbors": graph.n_neighbors,
            "steps": graph.steps,
            "unexplained_share": graph.loss,
        })
    };
    json!({
        "best": graph(&choice.best),
        "compared": choice.compared.iter().map(graph).collect::<Vec<_>>(),
        "cells": choice.n_cells,
        "genes_held_back": choice.n_held_back,
        "steps_by_gene": choice.steps,
    })
}
