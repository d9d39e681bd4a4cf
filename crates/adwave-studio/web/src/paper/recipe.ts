/** Recipe of a picture: a file from which the page makes the same picture again. */

import type { Edit, LevelsChoice, Shape } from '../protocol';
import { toEdit } from '../state';
import type { Studio } from '../studio';
import { text } from '../text';
import { parseView, type ViewMemory } from '../view-memory';
import type { PictureSize } from './render';

/** Sizes that can be asked for, in pixels. */
export const LEAST_SIDE = 16;
export const MOST_SIDE = 20_000;
export const MOST_FRAMES = 720;

/** Choices of the dialog of pictures. */
export interface PictureChoices {
  size: PictureSize;
  /** True if the ground is transparent, where the format has opacity. */
  transparent: boolean;
  /** True if the legend of the colors is drawn. */
  legend: boolean;
  /** Number of frames of a turn, and its seconds as a video. */
  frames: number;
  seconds: number;
}

export const USUAL_CHOICES: PictureChoices = {
  size: { width: 4000, height: 3000 },
  transparent: true,
  legend: true,
  frames: 72,
  seconds: 6,
};

export interface PictureRecipe extends PictureChoices {
  /** Version of this form. */
  picture: 1;
  shape: { name: string; n_vertices: number };
  view: ViewMemory;
  levels: LevelsChoice;
  edit: Edit;
}

export function recipeOf(studio: Studio, choices: PictureChoices): PictureRecipe {
  const { name, n_vertices } = studio.shape!;
  return {
    picture: 1,
    shape: { name, n_vertices },
    ...choices,
    view: studio.shownView!.get(),
    levels: studio.doc.levels.choice,
    edit: toEdit(studio.doc, 0),
  };
}

/** Reads a recipe; `null` if the text is none. */
export function parseRecipe(content: string): PictureRecipe | null {
  try {
    const recipe = JSON.parse(content) as PictureRecipe | null;
    const { width, height } = recipe!.size;
    const isSize = [width, height].every((x) => Number.isInteger(x) && x >= LEAST_SIDE && x <= MOST_SIDE);
    const isTurn = recipe!.frames >= 1 && recipe!.frames <= MOST_FRAMES && recipe!.seconds > 0;
    const isView = parseView(JSON.stringify(recipe!.view)) !== null;
    const isEdit = Array.isArray(recipe!.edit.layers) && typeof recipe!.levels === 'object';
    return recipe!.picture === 1 && isSize && isTurn && isView && isEdit ? recipe : null;
  } catch {
    return null;
  }
}

/** Applies the bands, the edit and the view of a recipe to the open shape; the edit is one step, or two with other bands. */
export async function applyRecipe(studio: Studio, recipe: PictureRecipe): Promise<void> {
  const shape: Shape = studio.shape!;
  if (recipe.shape.n_vertices !== shape.n_vertices)
    throw new Error(text.otherPicture(recipe.shape.name, recipe.shape.n_vertices, shape.n_vertices));
  if (JSON.stringify(recipe.levels) !== JSON.stringify(studio.doc.levels.choice))
    await studio.session.setLevels(recipe.levels);
  const { revision: _, ...present } = toEdit(studio.doc, 0);
  const { revision: __, ...wanted } = recipe.edit;
  if (JSON.stringify(present) !== JSON.stringify(wanted)) studio.session.applyEdit(recipe.edit);
  await studio.display.waitUntilSettled();
  studio.shownView?.set(recipe.view);
}
