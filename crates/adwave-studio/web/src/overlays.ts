/** Overlays of the shape: the circle of the brush, balls at features, edges. */

import {
  BufferAttribute,
  BufferGeometry,
  GLSL3,
  LineSegments,
  Points,
  RawShaderMaterial,
  type Scene,
  Vector3,
  Vector4,
} from 'three';
import { type ClipEquation, WHOLE } from './clip';
import type { Feature } from './protocol';
import { ballFragment, ballVertex, lineFragment, lineVertex } from './shader';

type Lines = LineSegments<BufferGeometry, RawShaderMaterial>;
type Ink = [number, number, number];
type Balls = Points<BufferGeometry, RawShaderMaterial>;

const EDGE_OPACITY = 0.4;
/** Number of edges of a graph above which they become fainter, down to this share of their opacity. */
const FEW_EDGES = 3000;
const FAINTEST = 0.12;

export class Overlays {
  private readonly ring: Lines[] = [];
  private readonly balls: Balls;
  /** Pins and handles of a pose, which are seen through the surface. */
  private readonly handles: Balls;
  /** Place of the last click. */
  private readonly mark: Balls;
  private readonly lines = new BufferGeometry();
  private wires: Lines | null = null;
  private edgeInk: Ink = [0, 0, 0];
  private edgeOpacity = EDGE_OPACITY;
  private readonly clip = new Vector4(...WHOLE);

  constructor(private readonly scene: Scene) {
    for (const opacity of [1, 0.45]) {
      const ring = new LineSegments(new BufferGeometry(), lineMaterial(opacity, 0.0015, this.clip));
      ring.frustumCulled = false;
      ring.visible = false;
      ring.renderOrder = 2;
      this.ring.push(ring);
      scene.add(ring);
    }
    this.balls = coloredBalls([0.87, 0.43, 0.2], [0.22, 0.48, 0.78], this.clip);
    this.handles = coloredBalls([0.95, 0.52, 0.1], [0.13, 0.42, 0.82], new Vector4(...WHOLE));
    this.handles.material.depthTest = false;
    this.handles.material.uniforms['smallest']!.value = 14;
    this.handles.renderOrder = 3;
    this.mark = coloredBalls([0.85, 0.1, 0.45], [0.85, 0.1, 0.45], this.clip);
    this.mark.material.uniforms['smallest']!.value = 11;
    this.mark.renderOrder = 3;
    scene.add(this.balls, this.handles, this.mark);
  }

  setInk(ring: Ink, edges: Ink): void {
    for (const [i, lines] of this.ring.entries()) ink(lines).set(...ring, i === 0 ? 1 : 0.5);
    this.edgeInk = edges;
  }

  /** Sets the plane that cuts edges, circles and features; pins and handles are always seen. */
  setClip(equation: ClipEquation | null): void {
    this.clip.set(...(equation ?? WHOLE));
  }

  /** Sets the pixels per model unit at distance 1, and the pixels of the picture per pixel of the page. */
  setPixels(pixels: number, ratio: number): void {
    this.balls.material.uniforms['pixels']!.value = pixels;
    for (const { material } of [this.balls, this.handles, this.mark])
      material.uniforms['ratio']!.value = ratio;
  }

  showRing(outer: Float32Array | null, inner: Float32Array | null): void {
    for (const [i, segments] of [outer, inner].entries()) {
      const ring = this.ring[i]!;
      ring.visible = segments !== null && segments.length > 0;
      if (!segments || !ring.visible) continue;
      ring.geometry.dispose();
      ring.geometry = new BufferGeometry();
      ring.geometry.setAttribute('position', new BufferAttribute(segments, 3));
    }
  }

  showFeatures(features: readonly Feature[], radii: number): void {
    this.balls.visible = features.length > 0;
    this.balls.geometry.dispose();
    this.balls.geometry = new BufferGeometry();
    if (features.length === 0) return;
    const set = (name: string, values: Iterable<number>, itemSize: number) =>
      this.balls.geometry.setAttribute(name, new BufferAttribute(Float32Array.from(values), itemSize));
    set(
      'position',
      features.flatMap((f) => f.position),
      3,
    );
    set(
      'size',
      features.map((f) => radii * f.sigma),
      1,
    );
    set(
      'sign',
      features.map((f) => f.sign),
      1,
    );
  }

  /** Shows balls of a fixed size: positions, and for each 1 for a handle and −1 for a pin. */
  showHandles(places: readonly number[], signs: readonly number[]): void {
    placeBalls(this.handles, places, signs);
  }

  /** Marks the place of a click; `null` removes the mark. */
  showMark(place: readonly number[] | null): void {
    placeBalls(this.mark, place ?? [], place ? [1] : []);
  }

  /** Sets the edges of a mesh, which are drawn above its faces, or of a graph, below its nodes. */
  setEdges(pairs: Uint32Array, place: 'above' | 'below'): void {
    this.lines.setIndex(new BufferAttribute(pairs, 1));
    this.wires = new LineSegments(
      this.lines,
      lineMaterial(0.35, place === 'above' ? 0.0002 : -0.0002, this.clip),
    );
    // Many edges of a graph cross each other.
    const crowd = place === 'below' ? Math.sqrt(FEW_EDGES / (pairs.length / 2)) : 1;
    this.edgeOpacity = EDGE_OPACITY * Math.min(1, Math.max(FAINTEST, crowd));
    this.wires.frustumCulled = false;
    this.wires.renderOrder = 1;
    this.scene.add(this.wires);
  }

  get hasEdges(): boolean {
    return this.wires !== null;
  }

  /** Shows or hides the edges of a geometry. */
  placeEdges(shown: boolean, of: BufferGeometry): void {
    if (!this.wires) return;
    this.wires.visible = shown;
    if (!shown) return;
    this.lines.setAttribute('position', of.getAttribute('position'));
    ink(this.wires).set(...this.edgeInk, this.edgeOpacity);
  }

  clear(): void {
    if (this.wires) this.scene.remove(this.wires);
    this.wires = null;
    this.lines.dispose();
    this.lines.deleteAttribute('position');
    this.lines.setIndex(null);
    this.showFeatures([], 1);
    this.showHandles([], []);
    this.showMark(null);
    this.showRing(null, null);
  }
}

function coloredBalls(high: Ink, low: Ink, clip: Vector4): Balls {
  const balls = new Points(
    new BufferGeometry(),
    new RawShaderMaterial({
      glslVersion: GLSL3,
      vertexShader: ballVertex,
      fragmentShader: ballFragment,
      uniforms: {
        pixels: { value: 1 },
        ratio: { value: 1 },
        smallest: { value: 8 },
        clip: { value: clip },
        high: { value: new Vector3(...high) },
        low: { value: new Vector3(...low) },
      },
    }),
  );
  balls.frustumCulled = false;
  balls.visible = false;
  return balls;
}

/** Shows balls of a fixed size at places, with a sign for each that chooses its color. */
function placeBalls(balls: Balls, places: readonly number[], signs: readonly number[]): void {
  balls.visible = signs.length > 0;
  balls.geometry.dispose();
  balls.geometry = new BufferGeometry();
  const set = (name: string, values: readonly number[], itemSize: number) =>
    balls.geometry.setAttribute(name, new BufferAttribute(Float32Array.from(values), itemSize));
  set('position', places, 3);
  // The shader enlarges points without a size to the smallest one.
  set(
    'size',
    signs.map(() => 0),
    1,
  );
  set('sign', signs, 1);
}

function ink(lines: Lines): Vector4 {
  return lines.material.uniforms['ink']!.value as Vector4;
}

function lineMaterial(opacity: number, bias: number, clip: Vector4): RawShaderMaterial {
  return new RawShaderMaterial({
    glslVersion: GLSL3,
    vertexShader: lineVertex,
    fragmentShader: lineFragment,
    uniforms: {
      ink: { value: new Vector4(0, 0, 0, opacity) },
      bias: { value: bias },
      clip: { value: clip },
    },
    transparent: true,
    depthWrite: false,
  });
}
