import { readFile } from 'node:fs/promises';
import { build, defineConfig, type Plugin } from 'vite';

// Names without hashes: the bundle is committed and embedded, and a build has to give the same files.
const names = {
  entryFileNames: '[name].js',
  chunkFileNames: '[name].js',
  assetFileNames: 'studio[extname]',
};

/** The page says itself what its first script will import, so that both are fetched at once. */
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

/** Script and style of the page in one file, each as one piece that the server puts into it. */
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
    this.emitFile({ type: 'asset', fileName: 'viewer.js', source });
    const style = await readFile('src/viewer/viewer.css', 'utf8');
    this.emitFile({ type: 'asset', fileName: 'viewer.css', source: style.replace(/\s+/g, ' ') });
  },
};

export default defineConfig({
  plugins: [preload, viewer],
  base: './',
  build: {
    outDir: 'dist',
    emptyOutDir: true,
    target: 'es2022',
    // The page's policy forbids scripts in the page itself, and browsers with WebGL 2 know module preloading.
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
