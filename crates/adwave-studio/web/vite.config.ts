import { existsSync, readdirSync } from 'node:fs';
import { readFile } from 'node:fs/promises';
import { build, defineConfig, type Plugin } from 'vite';

// File names without hashes: the bundle is committed and embedded, and builds must be reproducible.
const names = {
  entryFileNames: '[name].js',
  chunkFileNames: '[name].js',
  assetFileNames: 'studio[extname]',
};

/** Preloads the main script, so that it is fetched together with the entry script. */
const preload: Plugin = {
  name: 'preload',
  transformIndexHtml: {
    order: 'post',
    handler: () => [
      {
        tag: 'link',
        attrs: { rel: 'modulepreload', crossorigin: true, href: './main.js' },
        injectTo: 'head',
      },
    ],
  },
};

/** Folder of the installed package that a module belongs to, or null for own modules. */
function packageFolder(id: string): string | null {
  // Helpers for dynamic imports and CommonJS modules.
  for (const tool of ['vite', 'rolldown']) if (id.startsWith(`\0${tool}/`)) return `node_modules/${tool}`;
  return id.match(/node_modules\/(?:@[^/]+\/)?[^/]+/)?.[0] ?? null;
}

/** Lists the licenses of all bundled packages in one file, which the page links to. */
const notices: Plugin = {
  name: 'notices',
  apply: 'build',
  async generateBundle() {
    const folders = new Set([...this.getModuleIds()].map(packageFolder).filter((f) => f !== null));
    let source = 'The page of adwave studio contains the following third-party software.\n';
    for (const folder of [...folders].sort()) {
      const { name, version, license } = JSON.parse(await readFile(`${folder}/package.json`, 'utf8'));
      const file = readdirSync(folder).find((f) => /^licen[cs]e/i.test(f));
      if (!file || !existsSync(`${folder}/${file}`)) throw new Error(`${name} has no license file`);
      // Only the license of the package itself: Vite appends those of its own dependencies, which are not bundled.
      const [text] = (await readFile(`${folder}/${file}`, 'utf8')).split(
        /^# Licenses of bundled dependencies/m,
      );
      source += `\n${'-'.repeat(80)}\n${name} ${version} (${license})\n\n${text!.trim()}\n`;
    }
    this.emitFile({ type: 'asset', fileName: 'third-party-notices.txt', source });
  },
};

/** Builds script and style sheet of the exported HTML file, each as one piece that the server inserts. */
const viewer: Plugin = {
  name: 'viewer',
  apply: 'build',
  async generateBundle() {
    const built = await build({
      configFile: false,
      logLevel: 'warn',
      build: {
        write: false,
        target: 'es2022',
        lib: { entry: 'src/viewer/viewer.ts', formats: ['iife'], name: 'viewer' },
      },
    });
    const [output] = [built].flat();
    if (!output || !('output' in output)) throw new Error('the viewer was not built');
    const source = output.output[0].code;
    if (/<\/script|<!--/i.test(source)) throw new Error('the viewer would end its own script');
    // The exported file says that it contains no third-party code.
    const foreign = output.output[0].moduleIds.find((id) => packageFolder(id) !== null);
    if (foreign) throw new Error(`the viewer bundles ${foreign}, whose license it must then contain`);
    this.emitFile({ type: 'asset', fileName: 'viewer.js', source });
    const style = await readFile('src/viewer/viewer.css', 'utf8');
    this.emitFile({ type: 'asset', fileName: 'viewer.css', source: style.replace(/\s+/g, ' ') });
  },
};

export default defineConfig({
  plugins: [preload, notices, viewer],
  base: './',
  build: {
    outDir: 'dist',
    emptyOutDir: true,
    target: 'es2022',
    // The page's policy forbids inline scripts, and all browsers with WebGL 2 support module preloading.
    modulePreload: { polyfill: false },
    cssCodeSplit: false,
    reportCompressedSize: true,
    rollupOptions: { output: names },
  },
  worker: {
    format: 'es',
    rollupOptions: { output: { ...names, entryFileNames: 'worker.js' } },
  },
});
