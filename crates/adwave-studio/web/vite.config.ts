import { defineConfig, type Plugin } from 'vite';

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

export default defineConfig({
  plugins: [preload],
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
