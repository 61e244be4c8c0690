import { defineConfig } from 'vite';

// The page may be served under any path, asks nothing of other hosts, and runs under a content
// security policy without inline scripts or data: addresses, so nothing is inlined.
export default defineConfig({
  base: './',
  build: {
    target: 'es2022',
    assetsInlineLimit: 0,
    modulePreload: { polyfill: false },
    chunkSizeWarningLimit: 800,
  },
  worker: { format: 'es' },
  server: { proxy: { '/live': { target: 'ws://127.0.0.1:8080', ws: true }, '/original': 'http://127.0.0.1:8080' } },
});
