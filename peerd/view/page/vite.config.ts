import { defineConfig } from 'vite';

// One script and one style sheet, with names made of their contents: the daemon serves them as immutable. Nothing is
// inlined as a data: address and nothing is loaded from elsewhere, because the page's policy allows its own origin alone.
export default defineConfig({
  base: './',
  resolve: { alias: { peerd: '/client/index.ts' } },
  build: {
    target: 'es2022',
    assetsInlineLimit: 0,
    modulePreload: { polyfill: false },
    sourcemap: false,
    chunkSizeWarningLimit: 1500,
  },
});
