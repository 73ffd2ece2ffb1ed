// A picture's ticks as the screen server has them: asked for, and brought into the reader's units.
import { words } from "/static/see.js";
import { factorOf, unitName } from "/static/units.js";

const PATIENCE_MS = 4000;

/** What is asked for: head, times, turns and columns; or a text that says why there is nothing. */
export async function fetchShot(said) {
  const asked = new URLSearchParams({ ...said, lang: document.documentElement.lang });
  try {
    const answer = await fetch(`/data/scope?${asked}`, { signal: AbortSignal.timeout(PATIENCE_MS) });
    if (!answer.ok) return { text: (await answer.json()).text };
    return decode(await answer.arrayBuffer());
  } catch {
    return { text: words.failed };
  }
}

/** Length of the head, head, times, then four bytes a number. */
function decode(bytes) {
  const length = new DataView(bytes).getUint32(0, true);
  const head = JSON.parse(new TextDecoder().decode(new Uint8Array(bytes, 4, length)));
  if (head.n < 0) return { head };
  let from = 4 + length;
  const t = new Float64Array(bytes, from, head.n);
  from += 8 * head.n;
  const columns = [];
  for (let n = 0; n < head.signals.length + (head.turns ? 1 : 0); n += 1) {
    columns.push(new Float32Array(bytes, from, head.n));
    from += 4 * head.n;
  }
  const turns = head.turns ? columns.pop() : null;
  head.signals.forEach((one, n) => {
    const factor = factorOf(one.unit);
    one.unit = unitName(one.unit);
    if (factor === 1) return;
    columns[n] = columns[n].map((value) => value * factor);
    if (head.lines[n]) head.lines[n] = head.lines[n].map(([f, size]) => [f, size * factor]);
    const of = head.orders[n];
    if (!of) return;
    of.amplitudes = of.amplitudes.map((size) => size && size * factor);
    of.floor = of.floor && of.floor * factor;
  });
  return { head, t, turns, columns };
}
