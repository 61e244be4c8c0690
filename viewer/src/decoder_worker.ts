// The worker: decodes frames, and measures errors against originals, off the page's thread.
import wasmUrl from '../build/decoder.wasm?url';
import { errorsAgainst } from './nearest';
import { buffersOf, DamagedFrame, WasmDecoder, type Cloud, type DecodeOptions } from './wasm_decoder';

export interface DecodeRequest {
  id: number;
  frame: Uint8Array;
  options: DecodeOptions;
  original: Float32Array | null; // x, y, z; errors are measured where there is one
  token: string | null; // the page's, for fetching the decoder itself
}

export type DecodeReply =
  | { id: number; cloud: Cloud; errors: Float32Array | null; decodeMs: number }
  | { id: number; message: string; fatal: boolean };

let decoder: Promise<WasmDecoder> | null = null;

async function load(token: string | null): Promise<WasmDecoder> {
  const url = new URL(wasmUrl, location.href);
  if (token !== null) url.searchParams.set('token', token);
  const answer = await fetch(url);
  if (!answer.ok) throw new Error(`the decoder could not be fetched (HTTP ${answer.status})`);
  return WasmDecoder.create(await WebAssembly.compile(await answer.arrayBuffer()));
}

async function decode(request: DecodeRequest): Promise<[DecodeReply, ArrayBuffer[]]> {
  const wasm = await (decoder ??= load(request.token));
  const begin = performance.now();
  const cloud = wasm.decode(request.frame, request.options);
  const decodeMs = performance.now() - begin;
  const errors = request.original ? errorsAgainst(cloud.xyz, request.original) : null;
  const buffers = buffersOf(cloud);
  if (errors) buffers.push(errors.buffer as ArrayBuffer);
  return [{ id: request.id, cloud, errors, decodeMs }, buffers];
}

self.onmessage = async (event: MessageEvent<DecodeRequest>) => {
  const { id } = event.data;
  try {
    const [reply, buffers] = await decode(event.data);
    self.postMessage(reply, { transfer: buffers });
  } catch (error) {
    const fatal = !(error instanceof DamagedFrame);
    if (fatal) decoder = null; // the next frame gets a fresh one
    self.postMessage({ id, message: error instanceof Error ? error.message : String(error), fatal } satisfies DecodeReply);
  }
};
