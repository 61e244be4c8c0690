// The page's own modules, in node.
import { build } from 'esbuild';
import { mkdtempSync, readFileSync, rmSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { fileURLToPath, pathToFileURL } from 'node:url';

const kSource = fileURLToPath(new URL('../src', import.meta.url));
export const kWasm = fileURLToPath(new URL('../build/decoder.wasm', import.meta.url));

/** What ../src/NAME.ts exports. */
export async function loadModule(name) {
  const folder = mkdtempSync(join(tmpdir(), 'sweepcast-module-'));
  const outfile = join(folder, `${name}.mjs`);
  try {
    await build({ entryPoints: [join(kSource, `${name}.ts`)], outfile, bundle: true, format: 'esm', platform: 'node', logLevel: 'error' });
    return await import(pathToFileURL(outfile).href);
  } finally {
    rmSync(folder, { recursive: true, force: true });
  }
}

/** The decoder that the page uses. */
export async function loadDecoder() {
  const { WasmDecoder } = await loadModule('wasm_decoder');
  return WasmDecoder.create(await WebAssembly.compile(readFileSync(kWasm)));
}
