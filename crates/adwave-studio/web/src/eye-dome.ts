/**
 * Eye-dome lighting of clouds (C. Boucheny, Visualisation scientifique de grands volumes de données, 2009): points are
 * darker where neighbors in the picture are nearer, which shows edges and depth without normals.
 */

import {
  BufferAttribute,
  BufferGeometry,
  Camera,
  DepthTexture,
  GLSL3,
  Mesh,
  NearestFilter,
  RawShaderMaterial,
  Scene,
  Vector2,
  type WebGLRenderer,
  WebGLRenderTarget,
} from 'three';

/** Distance of the neighbors in pixels of the page, and how strongly a difference of depth of one octave darkens. */
const RADIUS = 1.4;
const STRENGTH = 40;

const VERTEX = `precision highp float;
in vec3 position;
void main() {
  gl_Position = vec4(position, 1.0);
}`;

const FRAGMENT = `precision highp float;
uniform sampler2D colors;
uniform sampler2D depths;
uniform vec2 range; // near and far plane
uniform int radius; // pixels
out vec4 color;
float octave(ivec2 at) {
  ivec2 inside = clamp(at, ivec2(0), textureSize(depths, 0) - 1);
  return log2(range.x * range.y / (range.y - texelFetch(depths, inside, 0).r * (range.y - range.x)));
}
void main() {
  ivec2 at = ivec2(gl_FragCoord.xy);
  color = texelFetch(colors, at, 0);
  if (texelFetch(depths, at, 0).r == 1.0) return;
  float here = octave(at);
  float nearer = 0.0;
  for (int y = -1; y <= 1; y++)
    for (int x = -1; x <= 1; x++) nearer += max(0.0, here - octave(at + radius * ivec2(x, y)));
  color.rgb *= exp(-${STRENGTH.toFixed(1)} * nearer / 8.0);
}`;

export class EyeDome {
  private readonly target = new WebGLRenderTarget(1, 1, {
    depthTexture: new DepthTexture(1, 1),
    magFilter: NearestFilter,
    minFilter: NearestFilter,
  });
  private readonly size = new Vector2();
  private readonly scene = new Scene();
  private readonly camera = new Camera();
  private readonly uniforms = {
    colors: { value: this.target.texture },
    depths: { value: this.target.depthTexture },
    range: { value: new Vector2() },
    radius: { value: 1 },
  };

  constructor() {
    const geometry = new BufferGeometry();
    // One triangle that covers the picture.
    geometry.setAttribute(
      'position',
      new BufferAttribute(new Float32Array([-1, -1, 0, 3, -1, 0, -1, 3, 0]), 3),
    );
    const material = new RawShaderMaterial({
      glslVersion: GLSL3,
      vertexShader: VERTEX,
      fragmentShader: FRAGMENT,
      uniforms: this.uniforms,
      depthTest: false,
      depthWrite: false,
    });
    const quad = new Mesh(geometry, material);
    quad.frustumCulled = false;
    this.scene.add(quad);
  }

  /**
   * Draws with eye-dome lighting what `draw` draws without; `near` and `far` are those of its camera. `into` is the target
   * of a part of a picture, in which a pixel of the page has `pixels` pixels; without it the picture of the page is drawn.
   */
  light(
    renderer: WebGLRenderer,
    { near, far }: { near: number; far: number },
    draw: () => void,
    into: WebGLRenderTarget | null = null,
    pixels = renderer.getPixelRatio(),
  ): void {
    if (into) this.size.set(into.width, into.height);
    else renderer.getDrawingBufferSize(this.size);
    this.target.setSize(this.size.x, this.size.y);
    renderer.setRenderTarget(this.target);
    renderer.clear();
    draw();
    renderer.setRenderTarget(into);
    this.uniforms.range.value.set(near, far);
    this.uniforms.radius.value = Math.max(1, Math.round(RADIUS * pixels));
    renderer.render(this.scene, this.camera);
  }
}
