/** Shaders of the shape: bands are vertex attributes, so that a slider only changes a uniform. */

/** Number of vertex attributes that WebGL 2 guarantees. */
const MOST_ATTRIBUTES = 16;

/** Number of packs of four masks that fit beside `nLevels` bands; `null` if the bands alone do not fit. */
export function maskPacks(nLevels: number, nMasks: number, posed = false): number | null {
  const packs = Math.ceil(nMasks / 4);
  // Position, normal and scalar are always attributes; in a pose also the rotation.
  const others = posed ? 4 : 3;
  return packs <= 2 && others + nLevels + packs <= MOST_ATTRIBUTES ? packs : null;
}

/** Side of the faces that is lit in full; the other one is darker. */
export type LitSide = 'front' | 'back' | 'both';

/** Variant of the shader. Variants are used instead of branches, which cost time in software rendering even if not taken. */
export interface Variant {
  /** Number of summed bands; 0 if the positions are final. */
  nLevels: number;
  /** Number of packs of four masks in the sum. */
  packs: number;
  /** The sum is turned with the frame of the vertex in a pose. */
  posed: boolean;
  cloud: boolean;
  clay: boolean;
  lit: LitSide;
  /** Computes normals from derivatives instead of vertex normals. */
  flat: boolean;
  scalar: boolean;
  /** The scalar is the number of a class, the same over a triangle. */
  classes: boolean;
  /** The scalar is the one without an edit. */
  original: boolean;
  /** Colors of the file instead of a scalar. */
  rgb: boolean;
  tint: boolean;
  /** Leaves out what lies beyond a plane. */
  clip: boolean;
}

export function vertexShader({
  nLevels,
  packs,
  posed,
  cloud,
  flat,
  scalar,
  classes,
  original,
  rgb,
  tint,
  clip,
}: Variant): string {
  const number = original ? 'unedited' : 'scalar';
  const levels = Array.from({ length: nLevels }, (_, j) => j);
  const components = ['x', 'y', 'z', 'w'];
  const nMasks = 4 * packs;
  const masks = Array.from({ length: nMasks }, (_, m) => `masks${m >> 2}.${components[m & 3]}`);
  const sum = levels.map((j) => {
    const product = masks.map((r, m) => `(1.0 + ${r} * slopes[${j * nMasks + m}])`).join(' * ');
    const gain = product ? `gains[${j}] * ${product}` : `gains[${j}]`;
    return `  d += ((${gain} - 1.0) * scales[${j}]) * band${j}.xyz;`;
  });
  return `precision highp float;
uniform mat4 modelViewMatrix;
uniform mat4 projectionMatrix;
uniform mat3 normalMatrix;
${tint ? 'uniform vec4 tint;\nuniform vec4 tint1;\nout float vTint;' : ''}
${cloud ? 'uniform float pointSize;\nuniform float pointScale;' : ''}
${nLevels ? `uniform float gains[${nLevels}];\nuniform float scales[${nLevels}];` : ''}
${nLevels && nMasks ? `uniform float slopes[${nLevels * nMasks}];` : ''}
in vec3 position;
in vec4 normal;
${posed ? TURNED : ''}
${scalar ? `in float ${number};\n${classes ? 'flat ' : ''}out float vScalar;` : ''}
${rgb ? 'in vec4 paint;\nout vec3 vPaint;' : ''}
${tint || packs > 0 ? 'in vec4 masks0;' : ''}
${tint || packs > 1 ? 'in vec4 masks1;' : ''}
${levels.map((j) => `in vec4 band${j};`).join('\n')}
${flat && !cloud ? '' : 'out vec3 vNormal;'}
out vec3 vPlace;
${clip ? 'out vec3 vModel;' : ''}
void main() {
  vec3 p = position;
${nLevels ? '  vec3 d = vec3(0.0);' : ''}
${sum.join('\n')}
${nLevels ? `  p += ${posed ? 'turned(d)' : 'd'};` : ''}
  vec4 place = modelViewMatrix * vec4(p, 1.0);
  vPlace = place.xyz;
${clip ? '  vModel = p;' : ''}
${flat && !cloud ? '' : `  vNormal = normalMatrix * ${posed ? 'turned(normal.xyz)' : 'normal.xyz'};`}
${scalar ? `  vScalar = ${number};` : ''}
${rgb ? '  vPaint = paint.rgb;' : ''}
${tint ? '  vTint = dot(masks0, tint) + dot(masks1, tint1);' : ''}
  gl_Position = projectionMatrix * place;
${cloud ? '  gl_PointSize = clamp(pointSize / gl_Position.w, 1.5 * pointScale, 64.0 * pointScale);' : ''}
}`;
}

/** Rotation by the quaternion of the vertex. */
const TURNED = `in vec4 turn;
vec3 turned(vec3 d) { return d + 2.0 * cross(turn.xyz, cross(turn.xyz, d) + turn.w * d); }`;

const CLAY = `  // Clay: a broad highlight from above, dark silhouettes.
  float rim = 1.0 - n.z;
  float top = smoothstep(-0.6, 1.0, dot(n, vec3(-0.35, 0.76, 0.55)));
  float shine = max(0.0, dot(n, vec3(-0.3, 0.55, 0.78)));
  shine *= shine; shine *= shine; shine *= shine; shine *= shine;
  vec3 light = base * (0.32 + 0.85 * top) * (1.0 - 0.55 * rim * rim) + vec3(0.2 * shine);`;

const SHADED = `  float key = max(0.0, dot(n, vec3(-0.42, 0.56, 0.71)));
  float fill = max(0.0, dot(n, vec3(0.88, -0.12, 0.46)));
  vec3 light = base * (0.24 + 0.72 * key + 0.18 * fill + 0.06 * n.y);`;

/** Bluish and darker: the color of the back of a surface, relative to that of its front. */
const BACK = 'vec3(0.5, 0.61, 0.8)';

/** On a color map the tint is hatched, so that both are seen. */
const HATCHED = '(0.1 + 0.75 * step(0.6, fract((gl_FragCoord.x + gl_FragCoord.y) / 9.0)))';

const CLIP_INPUTS = 'uniform vec4 clip;\nin vec3 vModel;';
const CLIP = '  if (dot(vec4(vModel, 1.0), clip) > 0.0) discard;';

export function fragmentShader({
  cloud,
  clay,
  lit,
  flat,
  scalar,
  classes,
  rgb,
  tint,
  clip,
}: Variant): string {
  const round = `  vec2 q = 2.0 * gl_PointCoord - 1.0;
  if (dot(q, q) > 1.0) discard;
  vec3 n = dot(vNormal, vNormal) > 1e-6 ? normalize(vNormal) : vec3(0.0, 0.0, 1.0);
  if (n.z < 0.0) n = -n;`;
  // Both sides are lit as if they faced the viewer.
  const facing = flat
    ? '  vec3 n = normalize(cross(dFdx(vPlace), dFdy(vPlace)));'
    : '  vec3 n = normalize(gl_FrontFacing ? vNormal : -vNormal);';
  // The back has a color of its own; colors that mean something are only darker there.
  const back = scalar || rgb ? 'vec3(0.62)' : BACK;
  const side = {
    front: `gl_FrontFacing ? vec3(1.0) : ${back}`,
    back: `gl_FrontFacing ? ${back} : vec3(1.0)`,
    both: 'vec3(1.0)',
  }[lit];
  return `precision highp float;
uniform vec3 surface;
${tint ? 'uniform vec3 accent;\nin float vTint;' : ''}
${scalar ? `uniform vec2 range;\nuniform sampler2D colors;\n${classes ? 'flat ' : ''}in float vScalar;` : ''}
${rgb ? 'in vec3 vPaint;' : ''}
${flat && !cloud ? '' : 'in vec3 vNormal;'}
in vec3 vPlace;
${clip ? CLIP_INPUTS : ''}
out vec4 color;
void main() {
${clip ? CLIP : ''}
${cloud ? round : facing}
  vec3 base = surface;
${rgb ? '  base = vPaint;' : ''}
${scalar ? '  base = vScalar == vScalar ? texture(colors, vec2((vScalar - range.x) / (range.y - range.x), 0.5)).rgb : vec3(0.5);' : ''}
${tint ? `  base = mix(base, accent, ${scalar || rgb ? HATCHED : '0.72'} * min(vTint, 1.0));` : ''}
${cloud ? '' : `  base *= ${side};`}
${clay ? CLAY : SHADED}
  color = vec4(light, 1.0);
}`;
}

export const lineVertex = `precision highp float;
uniform mat4 modelViewMatrix;
uniform mat4 projectionMatrix;
uniform float bias;
in vec3 position;
out vec3 vModel;
void main() {
  vModel = position;
  gl_Position = projectionMatrix * modelViewMatrix * vec4(position, 1.0);
  gl_Position.z -= bias * gl_Position.w;
}`;

export const lineFragment = `precision highp float;
uniform vec4 ink;
${CLIP_INPUTS}
out vec4 color;
void main() {
${CLIP}
  color = ink;
}`;

/** Points with a diameter in model units, shaded as balls. */
export const ballVertex = `precision highp float;
uniform mat4 modelViewMatrix;
uniform mat4 projectionMatrix;
uniform float pixels; // pixels per model unit at distance 1
uniform float smallest; // pixels of the page
uniform float ratio;
in vec3 position;
in float size;
in float sign;
out float vSign;
out vec3 vModel;
void main() {
  vSign = sign;
  vModel = position;
  gl_Position = projectionMatrix * modelViewMatrix * vec4(position, 1.0);
  gl_PointSize = clamp(size * pixels / gl_Position.w, smallest * ratio, 48.0 * ratio);
  gl_Position.z -= 0.002 * gl_Position.w;
}`;

export const ballFragment = `precision highp float;
uniform vec3 high;
uniform vec3 low;
in float vSign;
${CLIP_INPUTS}
out vec4 color;
void main() {
${CLIP}
  vec2 q = 2.0 * gl_PointCoord - 1.0;
  float r = dot(q, q);
  if (r > 1.0) discard;
  vec3 n = vec3(q.x, -q.y, sqrt(1.0 - r));
  float key = max(0.0, dot(n, normalize(vec3(-0.45, 0.6, 0.75))));
  color = vec4((vSign > 0.0 ? high : low) * (0.45 + 0.6 * key), 1.0);
}`;
