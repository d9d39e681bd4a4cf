//! Recipes as files: the edit of the positions or of one field is sent and opened.

use crate::document::{Document, layers_of_recipe};
use crate::field_bands::{FIELD_FIT, editable_field};
use crate::fields::list_fields;
use crate::response::{ApiError, ApiResult, bytes_response, json_response};
use crate::session::{Session, name_of_values};
use adwave::bands::DEFAULT_EXTENT;
use adwave::mask::missing;
use adwave::operator::OperatorKind;
use adwave::signal::SurfaceSignal;
use adwave::{Decomposer, LevelSpec};
use adwave_io::{Recipe, parse_recipe, recipe_to_text};
use serde_json::json;
use std::sync::Arc;

/// Names of signals of a recipe that the command computes from a shape, in addition to [`SurfaceSignal`].
const COMPUTED: [&str; 8] =
    ["x", "y", "z", "luminance", "lightness", "texture", "texture-luminance", "texture-lightness"];

/// Responds with the edit of the positions (`None`) or of a field as a recipe.
pub(crate) fn recipe_response(session: &Session, field: Option<&str>) -> ApiResult {
    let prepared = session.lock_prepared()?;
    let (levels, operator) = (&prepared.bands.levels, prepared.bands.decomposer.operator_kind());
    let recipe = match field {
        Some(name) => prepared.bands.document.to_field_recipe(name, levels, operator),
        None => prepared.bands.document.to_recipe(levels, operator),
    };
    Ok(bytes_response(recipe_to_text(&recipe)))
}

/// Replaces the levels, and the edit of the positions or of the field that the recipe names; the other edits remain.
pub(crate) fn apply_recipe(session: &Session, text: &str) -> ApiResult {
    let recipe = parse_recipe(text).map_err(|e| ApiError::from_classified(&e))?;
    if recipe.density_invariant || recipe.keep_creases {
        let message = "the studio does not support density_invariant and keep_creases; \
                       apply the recipe with `adwave filter --recipe`";
        return Err(ApiError::bad_request(message));
    }
    let field = match recipe.field.as_str() {
        "coords" => None,
        _ => Some(field_of_recipe(session, &recipe)?),
    };
    let levels = levels_of_recipe(session, &recipe, field.as_deref())?;
    let walk = session.walk_decomposer()?;
    let mut next = session.prepare(walk, levels, session.progress())?;
    if recipe.operator.is_some_and(|kind| kind != next.bands.decomposer.operator_kind()) {
        let message = "the studio uses the surface operator for levels given by width, and the walk operator otherwise; \
                       apply this recipe with `adwave filter --recipe`";
        return Err(ApiError::bad_request(message));
    }
    let mut prepared = session.lock_prepared()?;
    let mut present = prepared.bands.document.clone();
    present.map_levels(&prepared.bands.sigmas(), &next.bands.sigmas());
    present.revision += 1;
    let document = if let Some(name) = &field {
        present.with_field_layers(name, layers_of_recipe(&recipe, next.bands.n_levels())?)
    } else {
        let positions = Document::from_recipe(&recipe, next.bands.n_levels(), present.revision)?;
        Document { fields: present.fields, ..positions }
    };
    next.poser = Arc::clone(&prepared.poser);
    next.apply_edit(document, &session.file())?;
    *prepared = next;
    session.store_edit(&prepared)?;
    json_response(&json!({
        "levels": prepared.bands.level_infos(),
        "choice": prepared.bands.levels_request(),
        "edit": prepared.bands.document,
        "field": field,
    }))
}

/// Converts the levels of a recipe to a form for which the studio computes the same bands as the command. The studio
/// uses the walk operator for steps, and the surface operator for widths.
fn levels_of_recipe(session: &Session, recipe: &Recipe, field: Option<&str>) -> Result<LevelSpec, ApiError> {
    let is_walk_by_width = recipe.operator == Some(OperatorKind::Walk) && recipe.levels.is_by_width();
    let is_counted = matches!(recipe.levels, LevelSpec::Default | LevelSpec::Voices { .. });
    let depends_on_gaps = is_counted && field.is_some();
    if !(is_walk_by_width || depends_on_gaps) {
        return Ok(recipe.levels.clone());
    }
    let walk = session.walk_decomposer()?;
    let resolve = |decomposer: &Decomposer| {
        recipe.levels.resolve(decomposer, DEFAULT_EXTENT).map_err(|e| ApiError::from_classified(&e))
    };
    let file = session.file();
    // A vertex without a value is no part of the walk, whose steps have another length then.
    let values = field.map(|name| editable_field(&file, name)).transpose()?.map(adwave_io::Field::to_f64);
    let resolved = match values.and_then(|values| missing(&values, 1)) {
        Some(flags) => {
            let masked = walk.masked(&flags);
            resolve(&masked.map_err(|e| ApiError::bad_request(format!("'{}': {e}", recipe.field)))?)?
        }
        None => resolve(walk)?,
    };
    Ok(match recipe.levels {
        LevelSpec::Default => LevelSpec::Dyadic(resolved.schedule.n_levels()),
        _ => LevelSpec::Steps(resolved.schedule.steps().to_vec()),
    })
}

/// Returns the name of the field of this shape that a recipe edits: the named field, or that of the file of values that
/// the recipe names.
fn field_of_recipe(session: &Session, recipe: &Recipe) -> Result<String, ApiError> {
    let asked = recipe.field.as_str();
    if !recipe.clones.is_empty() || recipe.pose.is_some() {
        return Err(ApiError::bad_request(format!(
            "[[clone]] and [pose] of the recipe change positions, and it edits the field '{asked}'; remove them from the recipe"
        )));
    }
    if recipe.local_fit.is_some_and(|fit| fit != FIELD_FIT) {
        return Err(ApiError::bad_request(format!(
            "the studio smooths fields about a linear fit, and the recipe of '{asked}' has another local_fit; \
             apply it with `adwave filter --recipe`"
        )));
    }
    let is_computed = COMPUTED.contains(&asked)
        || SurfaceSignal::from_name(asked).is_some()
        || list_fields(session, 0).iter().any(|field| field.name() == asked && field.is_computed());
    if is_computed {
        return Err(ApiError::bad_request(format!(
            "the recipe edits '{asked}', which is computed from the shape, and the studio edits positions and fields \
             of files; apply it with `adwave filter --recipe`"
        )));
    }
    let file = session.file();
    // As the command names it: a field of the shape, or a path, and perhaps a column after a colon.
    let last = asked.rsplit(['/', '\\']).next().unwrap_or(asked);
    let (file_name, column) =
        last.split_once(':').map_or((last, None), |(name, column)| (name, Some(column)));
    let stem = name_of_values(file_name);
    let name = column.map_or_else(|| stem.to_owned(), |column| format!("{stem} {column}"));
    let has_values = |name: &str| file.vertex_fields().iter().any(|f| f.name == name && f.n_channels == 1);
    if let Some(name) = [asked, &name].into_iter().find(|name| has_values(name)) {
        return Ok(editable_field(&file, name)?.name.clone());
    }
    let channel = file.vertex_fields().iter().find(|field| field.name.starts_with(&format!("{stem} ")));
    Err(ApiError::bad_request(if let Some(field) = file.field(asked) {
        format!(
            "the recipe edits '{asked}', which has {} values per vertex, and the studio edits fields of one; \
             apply it with `adwave filter --recipe`",
            field.n_channels
        )
    } else if let Some(field) = channel {
        format!(
            "the recipe edits all values of '{asked}' together, and the studio one at a time; \
             write field = \"{}\" into the recipe, or that of another column",
            field.name
        )
    } else {
        let source =
            if file_name == stem { format!("its file, such as {stem}.npy,") } else { file_name.to_owned() };
        format!(
            "the recipe edits the field '{asked}', which this shape does not have; \
             drop {source} on the page, and open the recipe again"
        )
    }))
}
