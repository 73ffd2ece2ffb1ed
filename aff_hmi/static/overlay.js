// A kept window laid over what the scope shows, and the picture saved as a file.
import { css } from "/static/curves.js";

/**
 * Curves of one picture at the places of another; both begin at the same place.
 *
 * @param {number[]} x places that are asked for, rising
 * @param {number} first the place at which the other picture begins
 * @param {[number[], ...(number | null)[][]]} over its places and curves
 * @param {number} apart farther away than this there is nothing
 */
export function laidOver(x, first, over, apart) {
  const [places, ...curves] = over;
  if (!places.length) return curves.map(() => x.map(() => null));
  const shift = first - places[0];
  let near = 0;
  const found = x.map((at) => {
    const off = (n) => Math.abs(places[n] + shift - at);
    while (near + 1 < places.length && off(near + 1) <= off(near)) near += 1;
    return off(near) <= apart ? near : -1;
  });
  return curves.map((curve) => found.map((n) => (n < 0 ? null : curve[n])));
}

const LINE = 20;
const EDGE = 10;

/** Save a picture with its sentences: above the chart what it is of, below it what is in it. */
export function savePicture(chart, above, below, name) {
  const from = chart.ctx.canvas;
  const ratio = devicePixelRatio;
  const canvas = document.createElement("canvas");
  canvas.width = from.width;
  canvas.height = from.height + (LINE * (above.length + below.length) + 3 * EDGE) * ratio;
  const context = canvas.getContext("2d");
  context.fillStyle = css("--panel");
  context.fillRect(0, 0, canvas.width, canvas.height);
  context.font = `${14 * ratio}px sans-serif`;
  let y = EDGE * ratio;
  const write = (text) => {
    context.fillStyle = css("--text");
    y += LINE * ratio;
    context.fillText(text, EDGE * ratio, y, canvas.width - 2 * EDGE * ratio);
  };
  above.forEach(write);
  y += EDGE * ratio;
  context.drawImage(from, 0, y);
  y += from.height;
  below.forEach(write);
  canvas.toBlob((blob) => {
    const link = document.createElement("a");
    link.href = URL.createObjectURL(blob);
    link.download = name;
    link.click();
    setTimeout(() => URL.revokeObjectURL(link.href), 10000);
  });
}
