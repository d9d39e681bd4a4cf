/** Videos of pictures, made by the browser in real time. */

/** Kinds of WebM, the best first. */
const KINDS = ['video/webm;codecs=vp9', 'video/webm;codecs=vp8', 'video/webm'];

/** Kind of video that this browser makes; `null` if it makes none. */
export function videoKind(): string | null {
  if (typeof MediaRecorder === 'undefined') return null;
  return KINDS.find((kind) => MediaRecorder.isTypeSupported(kind)) ?? null;
}

/** Makes a video of pictures of one size, each shown for the same time. */
export async function makeVideo(
  frames: readonly Blob[],
  seconds: number,
  kind: string,
  signal: AbortSignal,
): Promise<Blob> {
  const first = await createImageBitmap(frames[0]!);
  const canvas = document.createElement('canvas');
  canvas.width = first.width;
  canvas.height = first.height;
  const context = canvas.getContext('2d', { alpha: false })!;
  context.drawImage(first, 0, 0);
  const stream = canvas.captureStream(0);
  const track = stream.getVideoTracks()[0] as CanvasCaptureMediaStreamTrack;
  // A tenth of a byte for each pixel of a frame keeps thin lines.
  const bits = (0.8 * canvas.width * canvas.height * frames.length) / seconds;
  const recorder = new MediaRecorder(stream, {
    mimeType: kind,
    videoBitsPerSecond: Math.max(2e6, Math.min(60e6, bits)),
  });
  const parts: Blob[] = [];
  recorder.addEventListener('dataavailable', ({ data }) => parts.push(data));
  const stopped = new Promise<void>((done, failed) => {
    recorder.addEventListener('stop', () => done());
    recorder.addEventListener('error', () => failed(new Error('The browser could not make the video.')));
  });
  recorder.start();
  const began = performance.now();
  try {
    for (const [k, frame] of frames.entries()) {
      signal.throwIfAborted();
      const bitmap = await createImageBitmap(frame);
      const wait = began + (1000 * k * seconds) / frames.length - performance.now();
      if (wait > 0) await new Promise((done) => setTimeout(done, wait));
      context.drawImage(bitmap, 0, 0);
      bitmap.close();
      track.requestFrame();
    }
    // The last frame is shown as long as the others.
    await new Promise((done) => setTimeout(done, (1000 * seconds) / frames.length));
  } finally {
    if (recorder.state !== 'inactive') recorder.stop();
    for (const each of stream.getTracks()) each.stop();
  }
  await stopped;
  return new Blob(parts, { type: kind });
}
