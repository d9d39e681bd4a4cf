/** Renderer of the exported file: shaded positions and normals with plain WebGL 2. */

const VERTEX = `#version 300 es
uniform mat4 matrix;
uniform mat3 turn;
uniform float size;
in vec3 position;
in vec3 normal;
out vec3 vNormal;
void main() {
  vNormal = turn * normal;
  gl_Position = matrix * vec4(position, 1.0);
  gl_PointSize = size;
}`;

const FRAGMENT = `#version 300 es
precision highp float;
uniform vec3 surface;
uniform bool cloud;
in vec3 vNormal;
out vec4 color;
void main() {
  vec3 n = dot(vNormal, vNormal) > 1e-6 ? normalize(vNormal) : vec3(0.0, 0.0, 1.0);
  vec3 side = vec3(1.0);
  if (cloud ? n.z < 0.0 : !gl_FrontFacing) { n = -n; if (!cloud) side = vec3(0.5, 0.61, 0.8); }
  float key = max(0.0, dot(n, vec3(-0.42, 0.56, 0.71)));
  float fill = max(0.0, dot(n, vec3(0.88, -0.12, 0.46)));
  color = vec4(surface * side * (0.24 + 0.72 * key + 0.18 * fill + 0.06 * n.y), 1.0);
}`;

const SURFACE = [0.84, 0.83, 0.81];
/** Half the field of view in radians. */
const HALF_VIEW = Math.PI / 12;

export class Picture {
  yaw = 0.5;
  pitch = 0.2;
  /** Distance from the center, relative to the one at which the shape fits. */
  distance = 1;
  private readonly gl: WebGL2RenderingContext;
  private readonly program: WebGLProgram;
  private readonly positions: WebGLBuffer;
  private readonly normals: WebGLBuffer;
  private middle = [0, 0, 0];
  private radius = 1;

  constructor(
    readonly canvas: HTMLCanvasElement,
    private readonly n: number,
    private readonly triangles: Uint32Array,
  ) {
    const gl = canvas.getContext('webgl2', { antialias: true, preserveDrawingBuffer: true });
    if (!gl) throw new Error('no WebGL 2');
    this.gl = gl;
    this.program = gl.createProgram();
    for (const [kind, source] of [
      [gl.VERTEX_SHADER, VERTEX],
      [gl.FRAGMENT_SHADER, FRAGMENT],
    ] as const) {
      const shader = gl.createShader(kind)!;
      gl.shaderSource(shader, source);
      gl.compileShader(shader);
      gl.attachShader(this.program, shader);
    }
    gl.bindAttribLocation(this.program, 0, 'position');
    gl.bindAttribLocation(this.program, 1, 'normal');
    gl.linkProgram(this.program);
    this.positions = gl.createBuffer();
    this.normals = gl.createBuffer();
    const indices = gl.createBuffer();
    gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, indices);
    gl.bufferData(gl.ELEMENT_ARRAY_BUFFER, triangles, gl.STATIC_DRAW);
    gl.enable(gl.DEPTH_TEST);
  }

  /** Centers the picture on the shape. */
  frame(p: Float32Array): void {
    const low = [Infinity, Infinity, Infinity];
    const high = [-Infinity, -Infinity, -Infinity];
    for (let i = 0; i < p.length; i++) {
      const c = i % 3;
      low[c] = Math.min(low[c]!, p[i]!);
      high[c] = Math.max(high[c]!, p[i]!);
    }
    this.middle = low.map((x, c) => (x + high[c]!) / 2);
    this.radius = Math.hypot(...low.map((x, c) => (high[c]! - x) / 2)) || 1;
  }

  show(positions: Float32Array, normals: Int8Array): void {
    const { gl } = this;
    gl.bindBuffer(gl.ARRAY_BUFFER, this.positions);
    gl.bufferData(gl.ARRAY_BUFFER, positions, gl.DYNAMIC_DRAW);
    gl.enableVertexAttribArray(0);
    gl.vertexAttribPointer(0, 3, gl.FLOAT, false, 0, 0);
    gl.bindBuffer(gl.ARRAY_BUFFER, this.normals);
    gl.bufferData(gl.ARRAY_BUFFER, normals, gl.DYNAMIC_DRAW);
    gl.enableVertexAttribArray(1);
    gl.vertexAttribPointer(1, 3, gl.BYTE, true, 4, 0);
  }

  draw(paper: readonly [number, number, number]): void {
    const { gl, canvas } = this;
    const ratio = Math.min(2, devicePixelRatio);
    const [width, height] = [canvas.clientWidth * ratio, canvas.clientHeight * ratio].map((x) =>
      Math.max(1, Math.round(x)),
    );
    if (canvas.width !== width || canvas.height !== height) {
      canvas.width = width!;
      canvas.height = height!;
    }
    gl.viewport(0, 0, canvas.width, canvas.height);
    gl.clearColor(...paper, 1);
    gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
    const { turn, matrix } = this.matrices(canvas.width / canvas.height);
    gl.useProgram(this.program);
    const place = (name: string) => gl.getUniformLocation(this.program, name);
    gl.uniformMatrix4fv(place('matrix'), false, matrix);
    gl.uniformMatrix3fv(place('turn'), false, turn);
    gl.uniform3fv(place('surface'), SURFACE);
    gl.uniform1i(place('cloud'), this.triangles.length ? 0 : 1);
    gl.uniform1f(place('size'), Math.max(1.5, (2 * canvas.height) / Math.sqrt(this.n)));
    if (this.triangles.length) gl.drawElements(gl.TRIANGLES, this.triangles.length, gl.UNSIGNED_INT, 0);
    else gl.drawArrays(gl.POINTS, 0, this.n);
  }

  /** Rotation of the shape and the full projection, as columns. */
  private matrices(aspect: number): { turn: number[]; matrix: number[] } {
    const [cy, sy, cp, sp] = [
      Math.cos(this.yaw),
      Math.sin(this.yaw),
      Math.cos(this.pitch),
      Math.sin(this.pitch),
    ];
    // First about the upright axis, then toward the viewer.
    const rows = [
      [cy, 0, sy],
      [sp * sy, cp, -sp * cy],
      [-cp * sy, sp, cp * cy],
    ] as const;
    const turn = [0, 1, 2].flatMap((c) => rows.map((row) => row[c]!));
    const fits = this.radius / Math.sin(Math.atan(Math.tan(HALF_VIEW) * Math.min(1, aspect)));
    const away = fits * this.distance;
    const near = Math.max(away - this.radius, away * 1e-3);
    const far = away + this.radius;
    const f = 1 / Math.tan(HALF_VIEW);
    const shift = rows.map((row) => -row.reduce((sum, r, c) => sum + r * this.middle[c]!, 0));
    shift[2]! -= away;
    const depth = [(near + far) / (near - far), (2 * near * far) / (near - far)] as const;
    const column = (x: number, y: number, z: number, w: number) => [
      (f / aspect) * x,
      f * y,
      depth[0] * z + depth[1] * w,
      -z,
    ];
    const columns = [0, 1, 2].map((c) => column(rows[0][c]!, rows[1][c]!, rows[2][c]!, 0));
    return { turn, matrix: [...columns, column(shift[0]!, shift[1]!, shift[2]!, 1)].flat() };
  }
}
