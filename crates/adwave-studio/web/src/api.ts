/** Requests to the server. Every failure is an `ApiError` whose message can be shown to the user. */

import type {
  CompareMethod,
  Comparison,
  Deviation,
  Edit,
  EditSummary,
  Feature,
  FieldInfo,
  LevelsAnswer,
  LevelsChoice,
  OpenedName,
  Region,
  Shape,
  ShapeList,
} from './protocol';
import { text } from './text';

export class ApiError extends Error {
  constructor(
    message: string,
    /** HTTP status; 0 if the server did not answer. */
    readonly status: number,
    readonly body: unknown = null,
  ) {
    super(message);
  }
}

const TOKEN = 'adwave-token';

/** Reads the access token from the fragment of the address once, and remembers it for this tab. */
export function readToken(): string {
  const fragment = location.hash.slice(1);
  if (fragment) {
    sessionStorage.setItem(TOKEN, fragment);
    history.replaceState(null, '', location.pathname + location.search);
    return fragment;
  }
  return sessionStorage.getItem(TOKEN) ?? '';
}

export class Api {
  constructor(
    readonly token: string,
    /** Base address of the page, ending in a slash. */
    readonly root: string = new URL('.', location.href).href,
  ) {}

  async fetch(path: string, init: RequestInit = {}): Promise<Response> {
    const headers: Record<string, string> = { Authorization: `Bearer ${this.token}` };
    if (typeof init.body === 'string') headers['Content-Type'] = 'application/json';
    let response: Response;
    try {
      response = await fetch(`${this.root}api/${path}`, { ...init, headers, cache: 'no-store' });
    } catch (error) {
      if (init.signal?.aborted) throw error;
      throw new ApiError(text.noServer, 0);
    }
    if (response.ok) return response;
    const body = await response.text();
    let sentence = body.length < 400 ? body : '';
    let parsed: unknown = null;
    try {
      parsed = JSON.parse(body);
      sentence = (parsed as { error?: string }).error ?? '';
    } catch {
      // The body is not JSON: it is shown as text.
    }
    if (response.status === 401) sentence ||= text.oldToken;
    throw new ApiError(sentence || text.badAnswer(response.status), response.status, parsed);
  }

  private async json<T>(path: string, init?: RequestInit): Promise<T> {
    return (await (await this.fetch(path, init)).json()) as T;
  }

  shapes(): Promise<ShapeList> {
    return this.json('shapes');
  }

  open(file: Blob, name: string, signal: AbortSignal): Promise<OpenedName> {
    return this.json(`shapes?name=${encodeURIComponent(name)}`, { method: 'POST', body: file, signal });
  }

  async close(id: number): Promise<void> {
    await this.fetch(`shapes/${id}`, { method: 'DELETE' });
  }

  shape(id: number): Promise<Shape> {
    return this.json(`shapes/${id}`);
  }

  async floats(path: string): Promise<Float32Array<ArrayBuffer>> {
    return new Float32Array(await (await this.fetch(path)).arrayBuffer());
  }

  async indices(path: string): Promise<Uint32Array<ArrayBuffer>> {
    return new Uint32Array(await (await this.fetch(path)).arrayBuffer());
  }

  levels(id: number, what: LevelsChoice, signal: AbortSignal): Promise<LevelsAnswer> {
    return this.json(`shapes/${id}/levels`, { method: 'PUT', body: JSON.stringify(what), signal });
  }

  edit(id: number): Promise<Edit> {
    return this.json(`shapes/${id}/edit`);
  }

  putEdit(id: number, edit: Edit, keepalive = false): Promise<EditSummary> {
    return this.json(`shapes/${id}/edit`, { method: 'PUT', body: JSON.stringify(edit), keepalive });
  }

  async weights(id: number, region: Region): Promise<Uint8Array> {
    const response = await this.fetch(`shapes/${id}/weights`, {
      method: 'POST',
      body: JSON.stringify(region),
    });
    return new Uint8Array(await response.arrayBuffer());
  }

  /** Fetches a field, for display or as regions use it. */
  async field(
    id: number,
    name: string,
    of: 'view' | 'region' = 'view',
  ): Promise<{ values: Float32Array; info: FieldInfo }> {
    const query = `name=${encodeURIComponent(name)}${of === 'region' ? '&of=region' : ''}`;
    const response = await this.fetch(`shapes/${id}/field?${query}`);
    const header = response.headers.get('X-Field');
    const info = header ? (JSON.parse(header) as FieldInfo) : { label: name, unit: '', diverging: false };
    return { values: new Float32Array(await response.arrayBuffer()), info };
  }

  /** Fetches a sample of the values of all frames of the series that a field belongs to. */
  seriesSample(id: number, name: string): Promise<Float32Array<ArrayBuffer>> {
    return this.floats(`shapes/${id}/field?name=${encodeURIComponent(name)}&of=series`);
  }

  /** Fetches the colors of the file, `u8 × 4 × n`. */
  async colors(id: number, name: string): Promise<Uint8Array> {
    const response = await this.fetch(`shapes/${id}/field?name=${encodeURIComponent(name)}`);
    return new Uint8Array(await response.arrayBuffer());
  }

  /** Adds the values of a file at the vertices; returns the names of the new fields. */
  addFields(id: number, file: Blob, name: string, signal: AbortSignal): Promise<{ fields: string[] }> {
    const path = `shapes/${id}/fields?name=${encodeURIComponent(name)}`;
    return this.json(path, { method: 'POST', body: file, signal });
  }

  /** Fetches the values of a field and then its bands from fine to coarse, `f32 × n` each. */
  async fieldBands(id: number, name: string, signal: AbortSignal): Promise<Float32Array<ArrayBuffer>> {
    const path = `shapes/${id}/field-bands?name=${encodeURIComponent(name)}`;
    return new Float32Array(await (await this.fetch(path, { signal })).arrayBuffer());
  }

  /** Fetches a field after the stored edit. */
  editedField(id: number, name: string): Promise<Float32Array<ArrayBuffer>> {
    return this.floats(`shapes/${id}/edited-field?name=${encodeURIComponent(name)}`);
  }

  /** Fetches a field after the stored edit as a file of values, in double precision. */
  async fieldFile(id: number, name: string, format: string): Promise<Blob> {
    const path = `shapes/${id}/edited-field?name=${encodeURIComponent(name)}&format=${format}`;
    return (await this.fetch(path)).blob();
  }

  /** Fetches the name that the file has for a node. */
  name(id: number, node: number): Promise<string> {
    return this.json(`shapes/${id}/name?vertex=${node}`);
  }

  features(id: number): Promise<Feature[]> {
    return this.json(`shapes/${id}/features`);
  }

  /** Fetches the edit of the positions (`null`) or of a field as a recipe. */
  async recipe(id: number, field: string | null): Promise<string> {
    const query = field === null ? '' : `?field=${encodeURIComponent(field)}`;
    return (await this.fetch(`shapes/${id}/recipe${query}`)).text();
  }

  putRecipe(id: number, recipe: string, signal: AbortSignal): Promise<LevelsAnswer> {
    return this.json(`shapes/${id}/recipe`, { method: 'PUT', body: recipe, signal });
  }

  /** Saves the edit; `valueType` is the type of the numbers of an image or a volume, that of its file if `null`. */
  save(
    id: number,
    name: string | null,
    replace: boolean,
    valueType: string | null = null,
  ): Promise<{ path: string; notes: string[] }> {
    const body = JSON.stringify({
      ...(name ? { name } : {}),
      replace,
      ...(valueType ? { value_type: valueType } : {}),
    });
    return this.json(`shapes/${id}/save`, { method: 'POST', body });
  }

  async download(id: number, format: string, valueType: string | null = null): Promise<Blob> {
    const type = valueType ? `&value_type=${valueType}` : '';
    const query = `format=${encodeURIComponent(format.toLowerCase())}${type}`;
    return (await this.fetch(`shapes/${id}/download?${query}`)).blob();
  }

  denoise(id: number, strength: number): Promise<{ id: number; name: string; noise: number }> {
    return this.json(`shapes/${id}/denoise`, { method: 'POST', body: JSON.stringify({ strength }) });
  }

  /** Fetches the positions of another method of the same roughness as the stored edit. */
  async compare(
    id: number,
    method: CompareMethod,
  ): Promise<{ positions: Float32Array<ArrayBuffer>; about: Comparison }> {
    const body = JSON.stringify({ method });
    const response = await this.fetch(`shapes/${id}/compare`, { method: 'POST', body });
    const about = JSON.parse(response.headers.get('X-Compare')!) as Comparison;
    return { positions: new Float32Array(await response.arrayBuffer()), about };
  }

  /** Fetches the distance of each vertex of a shape from another one, and a summary. */
  async deviation(
    id: number,
    from: number,
    signal: AbortSignal,
  ): Promise<{ values: Float32Array<ArrayBuffer>; about: Deviation }> {
    const body = JSON.stringify({ from });
    const response = await this.fetch(`shapes/${id}/deviation`, { method: 'POST', body, signal });
    const about = JSON.parse(response.headers.get('X-Deviation')!) as Deviation;
    return { values: new Float32Array(await response.arrayBuffer()), about };
  }

  /** Creates the report of the edited shape; returns its path. */
  report(id: number): Promise<{ path: string }> {
    return this.json(`shapes/${id}/report`, { method: 'POST' });
  }

  /** Fetches the shape with working sliders as one HTML file. */
  async page(id: number): Promise<Blob> {
    return (await this.fetch(`shapes/${id}/page`)).blob();
  }

  async endStudio(): Promise<void> {
    await this.fetch('done', { method: 'POST' });
  }
}
