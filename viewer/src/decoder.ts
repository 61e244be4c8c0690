// The page's side of the decoder's worker.
import type { DecodeReply, DecodeRequest } from './decoder_worker';
import type { Cloud, DecodeOptions } from './wasm_decoder';

export interface Decoded {
  cloud: Cloud;
  errors: Float32Array | null; // metres, against the original
  decodeMs: number;
}

/** The decoder itself does not work, whatever the frame. */
export class DecoderFailed extends Error {}

interface Waiting {
  resolve(decoded: Decoded): void;
  reject(error: Error): void;
}

export class Decoder {
  private readonly worker = new Worker(new URL('./decoder_worker.ts', import.meta.url), { type: 'module' });
  private readonly waiting = new Map<number, Waiting>();
  private readonly token = new URLSearchParams(location.search).get('token');
  private next = 0;

  constructor() {
    this.worker.onmessage = (event: MessageEvent<DecodeReply>) => {
      const reply = event.data;
      const waiting = this.waiting.get(reply.id);
      this.waiting.delete(reply.id);
      if ('message' in reply) waiting?.reject(new (reply.fatal ? DecoderFailed : Error)(reply.message));
      else waiting?.resolve(reply);
    };
    this.worker.onerror = () => {
      for (const waiting of this.waiting.values()) waiting.reject(new DecoderFailed('its worker could not be started'));
      this.waiting.clear();
    };
  }

  /** Rejects with the decoder's message where the frame is damaged, with DecoderFailed where it is not the frame. */
  decode(frame: Uint8Array, options: DecodeOptions, original: Float32Array | null): Promise<Decoded> {
    const request: DecodeRequest = { id: this.next++, frame, options, original, token: this.token };
    return new Promise((resolve, reject) => {
      this.waiting.set(request.id, { resolve, reject });
      this.worker.postMessage(request);
    });
  }
}
