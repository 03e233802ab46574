import { PLAY_SECONDS, type State } from "../app/schema";
import { drawPicture, type Picture, pictureSize } from "./figure";

/** Whether the browser encodes video at all. */
export const canFilm = () => "VideoEncoder" in window;

/**
 * The space view from the first instant to the last, as fast as it plays, as an MP4 file; it ends where there is no
 * shape. `onShare` hears how much is done, and ends the work by throwing.
 */
export async function film(
  { end, speed }: State,
  seek: (t: number) => void,
  picture: () => Picture | undefined,
  onShare: (share: number) => void,
): Promise<ArrayBuffer> {
  const { RATE, toVideo } = await import("./video");
  const count = Math.round((RATE * PLAY_SECONDS) / speed) + 1;
  const at = (frame: number) => {
    seek((end * frame) / (count - 1));
    return picture();
  };
  const first = at(0);
  if (first === undefined) throw new Error("there is no shape to show");
  const ratio = first.canvas.width / first.canvas.clientWidth;
  const [width, height] = pictureSize(first);
  const draw = async (context: CanvasRenderingContext2D, frame: number) => {
    const shown = at(frame);
    if (shown === undefined) return false;
    context.setTransform(ratio, 0, 0, ratio, 0, 0);
    await drawPicture(context, shown);
    onShare((frame + 1) / count);
    return true;
  };
  return toVideo({ width: Math.round(ratio * width), height: Math.round(ratio * height), count, draw });
}
