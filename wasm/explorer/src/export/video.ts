import { ArrayBufferTarget, Muxer } from "mp4-muxer";

/** Frames a second. */
export const RATE = 30;
const BITS_PER_PIXEL = 0.3;
/** Frames that wait for the encoder: more would only take memory. */
const WAITING = 8;

/** The codec that most players know comes first. Both levels hold 2560 x 1440 at 30 frames a second. */
const CODECS = [
  { codec: "avc1.640032", container: "avc" },
  { codec: "vp09.00.50.08", container: "vp9" },
] as const;

/** The frames of a video. */
export interface Film {
  readonly width: number;
  readonly height: number;
  readonly count: number;
  /** Draws a frame; false ends the film before it. */
  readonly draw: (context: CanvasRenderingContext2D, frame: number) => Promise<boolean>;
}

/** A film as an MP4 file. Throws where the browser encodes none of the formats. */
export async function toVideo({ width, height, count, draw }: Film): Promise<ArrayBuffer> {
  // The encoders ask for even numbers.
  const canvas = Object.assign(document.createElement("canvas"), { width: width & ~1, height: height & ~1 });
  const context = canvas.getContext("2d");
  if (context === null) throw new Error("this browser draws no pixels");
  const { config, container } = await configuration(canvas);
  const target = new ArrayBufferTarget();
  const video = { codec: container, width: canvas.width, height: canvas.height, frameRate: RATE };
  const muxer = new Muxer({ target, video, fastStart: "in-memory" });
  let onError: (error: DOMException) => void = () => {};
  const failed = new Promise<never>((_, reject) => {
    onError = reject;
  });
  const encoder = new VideoEncoder({ output: (chunk, meta) => muxer.addVideoChunk(chunk, meta), error: onError });
  try {
    encoder.configure(config);
    for (let i = 0; i < count && (await draw(context, i)); i++) {
      const frame = new VideoFrame(canvas, { timestamp: (1e6 * i) / RATE, duration: 1e6 / RATE });
      encoder.encode(frame, { keyFrame: i % RATE === 0 });
      frame.close();
      while (encoder.encodeQueueSize > WAITING) await Promise.race([dequeued(encoder), failed]);
    }
    await Promise.race([encoder.flush(), failed]);
  } finally {
    if (encoder.state !== "closed") encoder.close();
  }
  muxer.finalize();
  return target.buffer;
}

async function configuration({ width, height }: HTMLCanvasElement) {
  for (const { codec, container } of CODECS) {
    const bitrate = Math.round(width * height * RATE * BITS_PER_PIXEL);
    const config: VideoEncoderConfig = { codec, width, height, bitrate, framerate: RATE };
    const { supported } = await VideoEncoder.isConfigSupported(config);
    if (supported) return { config, container };
  }
  throw new Error(`this browser encodes neither H.264 nor VP9 at ${width} by ${height} pixels`);
}

function dequeued(encoder: VideoEncoder): Promise<unknown> {
  return new Promise((wake) => encoder.addEventListener("dequeue", wake, { once: true }));
}
