/** Shader materials of the shape and their uniforms: colors, a scalar field, and the edit as a sum of bands. */

import {
  DataTexture,
  DoubleSide,
  GLSL3,
  LinearFilter,
  NearestFilter,
  RawShaderMaterial,
  Vector2,
  Vector3,
  Vector4,
} from 'three';
import { type ClipEquation, WHOLE } from './clip';
import { colorTable, type MapName } from './colors';
import { fragmentShader, maskPacks, type Variant, vertexShader } from './shader';

/** Effect of a masked layer: opacity · (gain − 1) of each band, by slot. */
export type Masked = readonly { slot: number; slopes: readonly number[] }[];

export class Materials {
  packs = 0;
  hasScalar = false;
  /** True if the scalar numbers the classes of the palette. */
  hasClasses = false;
  hasRgb = false;
  tinted = false;
  private readonly made = new Map<string, RawShaderMaterial>();
  /** Uniforms of the sum of bands; their lengths are part of the shader. */
  private sums = noSums();
  private readonly tints = [new Vector4(), new Vector4()];
  private readonly texture: DataTexture;
  private readonly shared: Record<string, { value: unknown }>;

  constructor() {
    this.texture = new DataTexture(colorTable('viridis'), 256, 1);
    this.texture.magFilter = LinearFilter;
    this.texture.minFilter = LinearFilter;
    this.texture.needsUpdate = true;
    this.shared = {
      surface: { value: new Vector3() },
      accent: { value: new Vector3() },
      range: { value: new Vector2(0, 1) },
      colors: { value: this.texture },
      tint: { value: this.tints[0] },
      tint1: { value: this.tints[1] },
      pointSize: { value: 1 },
      pointScale: { value: 1 },
      clip: { value: new Vector4() },
    };
  }

  get(variant: Variant): RawShaderMaterial {
    const key = JSON.stringify(variant);
    let material = this.made.get(key);
    if (!material) {
      material = new RawShaderMaterial({
        glslVersion: GLSL3,
        vertexShader: vertexShader(variant),
        fragmentShader: fragmentShader(variant),
        side: DoubleSide,
        uniforms: { ...this.shared, ...this.sums },
      });
      this.made.set(key, material);
    }
    return material;
  }

  setColors(surface: [number, number, number], accent: [number, number, number]): void {
    (this.shared['surface']!.value as Vector3).set(...surface);
    (this.shared['accent']!.value as Vector3).set(...accent);
  }

  setClip(equation: ClipEquation | null): void {
    (this.shared['clip']!.value as Vector4).set(...(equation ?? WHOLE));
  }

  /** Sets the size of points in pixels at distance 1; `scale` is that of the picture beside that of the page. */
  setPointSize(size: number, scale = 1): void {
    this.shared['pointSize']!.value = size;
    this.shared['pointScale']!.value = scale;
  }

  setScalarRange(range: [number, number], map: MapName): void {
    (this.shared['range']!.value as Vector2).set(...range);
    this.hasClasses = map === 'classes';
    this.texture.magFilter = this.hasClasses ? NearestFilter : LinearFilter;
    this.texture.minFilter = this.texture.magFilter;
    this.texture.image.data!.set(colorTable(map));
    this.texture.needsUpdate = true;
  }

  /** Tints the mask of a slot; `null` turns the tint off. */
  setTint(slot: number | null): void {
    for (const tint of this.tints) tint.set(0, 0, 0, 0);
    if (slot !== null) this.tints[slot >> 2]?.setComponent(slot & 3, 1);
    this.tinted = slot !== null && slot < 8;
  }

  /** Discards the sums: other levels or more masks need other shaders. */
  forgetSums(): void {
    this.sums = noSums();
    for (const [key, material] of this.made) {
      if ((JSON.parse(key) as Variant).nLevels === 0) continue;
      material.dispose();
      this.made.delete(key);
    }
  }

  /** Sets the uniforms of the edit; `scales` belong to the bands. Returns false if the shader cannot sum the edit. */
  setSums(
    global: ArrayLike<number>,
    masked: Masked,
    scales: readonly (number | undefined)[],
    nLevels: number,
    posed: boolean,
  ): boolean {
    const nMasks = masked.reduce((n, m) => Math.max(n, m.slot + 1), 0);
    const packs = maskPacks(nLevels, nMasks, posed);
    if (packs === null) return false;
    const each = 4 * packs;
    if (this.sums.gains.value.length !== nLevels || packs !== this.packs) {
      this.forgetSums();
      this.packs = packs;
      this.sums.gains.value = new Array<number>(nLevels).fill(1);
      this.sums.scales.value = new Array<number>(nLevels).fill(0);
      this.sums.slopes.value = new Array<number>(Math.max(1, nLevels * each)).fill(0);
    }
    const sums = this.sums;
    sums.slopes.value.fill(0);
    for (let j = 0; j < nLevels; j++) {
      sums.gains.value[j] = global[j]!;
      sums.scales.value[j] = scales[j] ?? 0;
      for (const m of masked) sums.slopes.value[j * each + m.slot] = m.slopes[j]!;
    }
    return true;
  }
}

function noSums(): Record<'gains' | 'scales' | 'slopes', { value: number[] }> {
  return { gains: { value: [] }, scales: { value: [] }, slopes: { value: [] } };
}
