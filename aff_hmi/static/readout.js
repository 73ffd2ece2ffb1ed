// What is read off a picture of ticks: every signal at both cursors, and the orders of a roll.
import { figure, row } from "/static/curves.js";
import { laidOver } from "/static/overlay.js";
import { apartOf, holed } from "/static/picture.js";
import { byId, put, words } from "/static/see.js";

/** Between the cursors, and every signal at both; `over` : signals of what is laid over, `laid`. */
export function readOut(shot, { A, B }, over, laid) {
  const { head, t, turns, columns } = shot;
  const table = byId("readout");
  if (!head.n) {
    table.tBodies[0].replaceChildren();
    return;
  }
  const apart_s = t[B] - t[A];
  let text = `${words.between}: ${figure(1000 * apart_s)} ms`;
  if (apart_s) text += `, ${figure(1 / Math.abs(apart_s))} Hz`;
  if (turns) text += `, ${figure(turns[B] - turns[A])} ${words.turns}`;
  put(byId("between"), text);
  const names = [words.signal, "A", "B", "B − A", words.least, words.mean, words.largest];
  table.tHead.replaceChildren(row(names, "th"));
  const source = turns ?? t;
  const apart = apartOf(source);
  const under = over.length ? [A, B].map((n) => valuesUnder(laid, source, n, apart)) : [];
  const rows = [...head.signals, ...over].map((one, n) => {
    const column = one.over === undefined ? columns[n] : laid.columns[one.over];
    const known = column.filter((v) => !Number.isNaN(v));
    const sum = known.reduce((a, v) => a + v, 0);
    const least = known.reduce((a, v) => Math.min(a, v), Infinity);
    const largest = known.reduce((a, v) => Math.max(a, v), -Infinity);
    const [a, b] = one.over === undefined ? [column[A], column[B]] : under.map((all) => all[one.over] ?? NaN);
    const whole = known.length ? [least, sum / known.length, largest] : [null, null, null];
    return row([`${one.label} [${one.unit}]`, ...[a, b, b - a, ...whole].map(figure)]);
  });
  table.tBodies[0].replaceChildren(...rows);
}

/** Values of what is laid over, under a place of the picture. */
function valuesUnder(laid, source, n, apart) {
  return laidOver([source[n]], source[0], holed(laid), apart).map(([value]) => value);
}

/** The strongest frequencies of every signal, the largest first. */
export function lineTable(head) {
  const table = byId("line-table");
  if (!byId("lines").open) return;
  table.tHead.replaceChildren(row([words.signal, "Hz", words.amplitude], "th"));
  const rows = head.signals.flatMap((one, n) => {
    const name = `${one.label} [${one.unit}]`;
    const found = head.lines[n] ?? [];
    if (!found.length) return [row([name, "—", words.noLine])];
    return found.map(([f, size], place) => row([place ? "" : name, figure(f), figure(size)]));
  });
  table.tBodies[0].replaceChildren(...rows);
}

/** Amplitudes of the orders of a roll beside the noise between them. */
export function orderTable(head) {
  const found = head.orders;
  byId("orders").hidden = found.length === 0;
  if (found.length === 0) return;
  const table = byId("order-table");
  const names = head.signals.map((one) => `${one.label} [${one.unit}]`);
  table.tHead.replaceChildren(row([words.order, ...names], "th"));
  const count = found[0].amplitudes.length;
  const rows = Array.from({ length: count }, (_, n) =>
    row([`${n + 1}x`, ...found.map((one) => figure(one.amplitudes[n]))]),
  );
  rows.push(row([words.floor, ...found.map((one) => figure(one.floor))]));
  if (found.every((one) => one.floor === null)) rows.push(row([words.few, ...found.map(() => "")]));
  table.tBodies[0].replaceChildren(...rows);
}
