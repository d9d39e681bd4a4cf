/** A shape of another tab, drawn beside the present one. */

import { BufferAttribute, BufferGeometry, Mesh, Points, type RawShaderMaterial } from 'three';
import { coarseTriangles } from './compute/coarse';
import { boundsOf, setAttributeArray } from './geometry';
import type { LitSide } from './shader';
import { VertexSubset } from './vertex-subset';

/** Arrays of a shape; positions are relative to the center of the shape that it is shown beside. */
export interface BesideArrays {
  positions: Float32Array;
  normals: Int8Array;
  /** Empty for a cloud. */
  triangles: Uint32Array;
  meanLength: number;
  lit: LitSide;
}

/** Number of triangles of the coarse version. */
const COARSE = 45_000;

export class BesideShape {
  readonly body: Mesh<BufferGeometry, RawShaderMaterial> | Points<BufferGeometry, RawShaderMaterial>;
  readonly isCloud: boolean;
  readonly lit: LitSide;
  /** Size of the points of a cloud, in model units. */
  readonly pointSize: number;
  /** Distance from a point that holds all vertices. */
  readonly bounds: { center: number[]; radius: number };
  hasScalar = false;
  private readonly whole = new BufferGeometry();
  private readonly few: VertexSubset | null;

  /** Takes arrays; a coarse version with fewer triangles is made if `isHeavy`. */
  constructor(
    { positions, normals, triangles, meanLength, lit }: BesideArrays,
    material: RawShaderMaterial,
    isHeavy: boolean,
  ) {
    this.lit = lit;
    this.isCloud = triangles.length === 0;
    this.pointSize = 1.4 * meanLength;
    this.bounds = boundsOf(positions);
    this.whole.setAttribute('position', new BufferAttribute(positions, 3));
    this.whole.setAttribute('normal', new BufferAttribute(normals, 4, true));
    if (!this.isCloud) this.whole.setIndex(new BufferAttribute(triangles, 1));
    this.few = isHeavy
      ? new VertexSubset(coarseTriangles(positions, triangles, COARSE), positions.length / 3)
      : null;
    this.few?.copyAttribute('position', positions, 3, false);
    this.few?.copyAttribute('normal', normals, 4, true);
    this.body = this.isCloud ? new Points(this.whole, material) : new Mesh(this.whole, material);
    this.body.frustumCulled = false;
  }

  /** Sets one number per vertex, shown as colors; `null` shows the color of the surface. */
  setScalar(values: Float32Array | null): void {
    this.hasScalar = values !== null;
    if (!values) return;
    setAttributeArray(this.whole, 'scalar', values, 1, false);
    this.few?.copyAttribute('scalar', values, 1, false);
  }

  /** Chooses the version that is drawn. */
  choose(coarse: boolean): void {
    this.body.geometry = coarse && this.few ? this.few.geometry : this.whole;
  }

  dispose(): void {
    this.whole.dispose();
    this.few?.geometry.dispose();
  }
}
