/** Dialog of pictures for papers: its size and ground, a turn as frames or as a video, and the recipe of all of it. */

import { Quaternion, Vector3 } from 'three';
import type { Camera } from '../camera';
import { dialog } from '../dialog';
import { check, download, h } from '../dom';
import type { Files } from '../files';
import { legendLayer } from '../picture';
import type { Studio } from '../studio';
import { text } from '../text';
import {
  applyRecipe,
  LEAST_SIDE,
  MOST_FRAMES,
  MOST_SIDE,
  type PictureChoices,
  parseRecipe,
  recipeOf,
  USUAL_CHOICES,
} from './recipe';
import { drawPicture, type PictureParams } from './render';
import { makeVideo, videoKind } from './video';
import { ZipWriter } from './zip';

/** Largest side of a frame of a video. */
const MOST_VIDEO_SIDE = 3840;

export class PaperPictures {
  private choices: PictureChoices = USUAL_CHOICES;

  constructor(
    private readonly studio: Studio,
    private readonly files: Files,
  ) {}

  /** Applies a recipe of a picture, and opens the dialog with its choices. */
  async openRecipe(content: string, name: string): Promise<void> {
    const recipe = parseRecipe(content);
    if (!recipe || !this.studio.shape || this.studio.isGrid) throw new Error(text.badPicture(name));
    await applyRecipe(this.studio, recipe);
    const { size, transparent, legend, frames, seconds } = recipe;
    this.choices = { size, transparent, legend, frames, seconds };
    this.open();
  }

  open(): void {
    const { studio } = this;
    const isGrid = studio.isGrid;
    const width = number(text.pictureWidth, this.choices.size.width, LEAST_SIDE, MOST_SIDE);
    const height = number(text.pictureHeight, this.choices.size.height, LEAST_SIDE, MOST_SIDE);
    const frames = number(text.turnFrames, this.choices.frames, 1, MOST_FRAMES);
    const seconds = number(text.turnSeconds, this.choices.seconds, 1, 120);
    let { transparent, legend } = this.choices;
    const problem = h('p', { class: 'problem', role: 'alert', hidden: true });
    const run = (work: (choices: PictureChoices) => Promise<void>) => () => {
      const wrong = [width, height, ...(isGrid ? [] : [frames, seconds])].find(
        ({ input }) => !input.checkValidity() || !Number.isInteger(input.valueAsNumber),
      );
      problem.hidden = !wrong;
      if (wrong) {
        const { min, max, value } = wrong.input;
        problem.textContent = text.pictureNumber(wrong.label, min, max, value);
        wrong.input.focus();
        return;
      }
      const size = { width: width.input.valueAsNumber, height: height.input.valueAsNumber };
      this.choices = isGrid
        ? { ...this.choices, size, transparent }
        : {
            size,
            transparent,
            legend,
            frames: frames.input.valueAsNumber,
            seconds: seconds.input.valueAsNumber,
          };
      box.close();
      void this.files.reportErrors(() => work(this.choices));
    };
    const ground = check(text.transparent, transparent, (on) => {
      transparent = on;
    });
    const withLegend = check(text.withLegend, legend, (on) => {
      legend = on;
    });
    const picture = run((choices) => this.savePicture(choices));
    const box = dialog(
      text.pictures,
      h('p', {}, isGrid ? text.gridPicturesNote : text.picturesNote),
      h('div', { class: 'row numbers' }, width.element, isGrid ? null : height.element),
      ground,
      isGrid ? null : withLegend,
      problem,
      h('div', { class: 'row' }, button(text.pictureSave, picture, 'primary')),
      ...(isGrid
        ? []
        : [
            h('h3', {}, text.turntable),
            h('div', { class: 'row numbers' }, frames.element, seconds.element),
            h(
              'div',
              { class: 'row' },
              button(
                text.framesSave,
                run((choices) => this.saveFrames(choices)),
              ),
              videoKind()
                ? button(
                    text.videoSave,
                    run((choices) => this.saveVideo(choices)),
                  )
                : h('span', { class: 'hint' }, text.noVideo),
            ),
            h('h3', {}, text.pictureRecipe),
            h('p', {}, text.pictureRecipeNote),
            h(
              'div',
              { class: 'row' },
              button(
                text.pictureRecipeSave,
                run((choices) => this.saveRecipe(choices)),
              ),
            ),
          ]),
    );
  }

  /** Settles the edit and hides what belongs to the pointer. */
  private async prepare(): Promise<void> {
    const { studio } = this;
    studio.view.showRing(null, null);
    studio.view.showMark(null);
    await studio.display.waitUntilSettled();
  }

  /** Everything but camera, signal and progress of a picture. */
  private paramsOf(choices: PictureChoices): Pick<PictureParams, 'size' | 'ground' | 'layers'> {
    const { view } = this.studio;
    const { size } = choices;
    const legend = choices.legend ? document.querySelector<HTMLElement>('.legend') : null;
    const layer = legend && !legend.hidden ? legendLayer(view.canvas, legend, size) : null;
    return { size, ground: choices.transparent ? null : view.paper, layers: layer ? [layer] : [] };
  }

  private async savePicture(choices: PictureChoices): Promise<void> {
    const { studio } = this;
    const name = `${this.files.stem}-${choices.size.width}.png`;
    const picture = await studio.wait(text.drawing(0), async (signal, tell) => {
      if (studio.isGrid) return studio.gridView.picture(choices.size.width, choices.transparent);
      await this.prepare();
      return drawPicture(studio.view, {
        ...this.paramsOf(choices),
        camera: studio.view.camera.copy(choices.size),
        signal,
        progress: (share) => tell(text.drawing(share)),
      });
    });
    if (picture) download(picture, name);
  }

  /** Draws the pictures of a turn about the upright axis, and gives each to `take`. */
  private async drawTurn(
    choices: PictureChoices,
    { signal, tell }: { signal: AbortSignal; tell: (what: string) => void },
    take: (frame: Blob, k: number) => Promise<void>,
  ): Promise<void> {
    await this.prepare();
    const { view } = this.studio;
    const params = this.paramsOf(choices);
    for (let k = 0; k < choices.frames; k++) {
      const camera = turned(view.camera.copy(choices.size), k / choices.frames);
      const frame = await drawPicture(view, { ...params, camera, signal, progress: () => {} });
      await take(frame, k);
      tell(text.drawingTurn(k + 1, choices.frames));
    }
  }

  private async saveFrames(choices: PictureChoices): Promise<void> {
    const { studio } = this;
    const digits = String(choices.frames - 1).length;
    const archive = await studio.wait(text.drawingTurn(0, choices.frames), async (signal, tell) => {
      const zip = new ZipWriter();
      await this.drawTurn(choices, { signal, tell }, (frame, k) =>
        zip.add(`${this.files.stem}-${String(k).padStart(digits, '0')}.png`, frame),
      );
      return zip.finish();
    });
    if (archive) download(archive, `${this.files.stem}-turn.zip`);
  }

  private async saveVideo(choices: PictureChoices): Promise<void> {
    const { studio } = this;
    // Encoders take even numbers of pixels, and video has a ground.
    const scale = Math.min(1, MOST_VIDEO_SIDE / Math.max(choices.size.width, choices.size.height));
    const even = (x: number) => Math.max(2, 2 * Math.round((x * scale) / 2));
    const size = { width: even(choices.size.width), height: even(choices.size.height) };
    const video = await studio.wait(text.drawingTurn(0, choices.frames), async (signal, tell) => {
      const frames: Blob[] = [];
      await this.drawTurn({ ...choices, size, transparent: false }, { signal, tell }, async (frame) => {
        frames.push(frame);
      });
      tell(text.encoding(choices.seconds));
      return makeVideo(frames, choices.seconds, videoKind()!, signal);
    });
    if (video) download(video, `${this.files.stem}-turn.webm`);
  }

  private async saveRecipe(choices: PictureChoices): Promise<void> {
    const recipe = JSON.stringify(recipeOf(this.studio, choices), null, 1);
    download(new Blob([recipe], { type: 'application/json' }), `${this.files.stem}.picture.json`);
  }
}

/** The camera turned about the upright axis through its pivot, by a share of a whole turn. */
function turned(camera: Camera, share: number): Camera {
  const axis = camera.up === 'y' ? new Vector3(0, 1, 0) : new Vector3(0, 0, 1);
  camera.three.quaternion.premultiply(new Quaternion().setFromAxisAngle(axis, -2 * Math.PI * share));
  camera.update();
  return camera;
}

function number(label: string, value: number, min: number, max: number) {
  const input = h('input', {
    type: 'number',
    min: String(min),
    max: String(max),
    step: '1',
    required: true,
    value: String(value),
    'aria-label': label,
  });
  return { label, input, element: h('label', { class: 'field' }, h('span', {}, label), input) };
}

function button(label: string, onclick: () => void, kind = ''): HTMLButtonElement {
  return h('button', { type: 'button', class: kind, onclick }, label);
}
