/** Sentences of the dialog of pictures for print. */

export const pictureText = {
  picturesOpen: 'Picture for print…',
  pictures: 'Picture for print',
  picturesNote:
    'The view at any size, drawn with four samples per pixel. All that is seen now is in the picture.',
  gridPicturesNote: 'The panes as they are shown, enlarged to a width in pixels.',
  pictureWidth: 'Width (pixels)',
  pictureHeight: 'Height (pixels)',
  transparent: 'Transparent ground',
  withLegend: 'Legend of the colors',
  pictureSave: 'Save picture (PNG)',
  turnFrames: 'Frames of a turn',
  turnSeconds: 'Seconds of the video',
  framesSave: 'Save frames (PNG in a ZIP)',
  videoSave: 'Save video (WebM)',
  noVideo: 'This browser makes no videos.',
  pictureRecipe: 'Recipe',
  pictureRecipeNote:
    'A small file with the view, the edit and these choices. Dropped on the page with the same shape, it makes the picture again.',
  pictureRecipeSave: 'Save recipe of the picture',
  pictureNumber: (label: string, min: string, max: string, value: string) =>
    `${label}: must be a whole number from ${min} to ${max}, got “${value}”.`,
  drawing: (share: number) => `Drawing the picture: ${Math.round(100 * share)} %`,
  drawingTurn: (k: number, n: number) => `Drawing the turn: ${k} of ${n}`,
  encoding: (seconds: number) => `Making the video, which takes ${seconds} s`,
  badPicture: (name: string) =>
    `${name} must be the recipe of a picture of a shape; save one with Picture for print.`,
  otherPicture: (name: string, n: number, got: number) =>
    `The picture shows ${name} with ${n} vertices, and the open shape has ${got}. Open that shape first.`,
};
