// How a picture of ticks is drawn: curves with holes, axes by unit, marks and cursors across it.
import { css, look, short } from "/static/curves.js";
import { byId, words } from "/static/see.js";

export const HIGH = 340;

/** Horizontal axis and curves with holes where ticks are missing. */
export function holed({ head, t, turns, columns }) {
  const source = turns ?? t;
  const x = [];
  const curves = columns.map(() => []);
  let furthest = -Infinity;
  for (let n = 0; n < head.n; n += 1) {
    if (Number.isNaN(source[n])) continue;
    if (n && t[n] - t[n - 1] > 1.5 * head.cycle_s) {
      x.push(furthest);
      for (const curve of curves) curve.push(null);
    }
    furthest = Math.max(furthest, source[n]); // a roll that stands trembles
    x.push(furthest);
    columns.forEach((column, c) => curves[c].push(Number.isNaN(column[n]) ? null : column[n]));
  }
  return [x, ...curves];
}

/** How uPlot draws a picture of these signals; `draw` lays marks over it. */
export function options(shot, signals, draw) {
  const grid = { stroke: () => css("--line"), width: 0.5 };
  const axis = { stroke: () => css("--text"), grid, size: 60 };
  const units = [...new Set(signals.map((one) => one.unit))];
  const values = (u, splits) => splits.map((v) => short(v));
  const axes = units.slice(0, 2).map((unit, n) => ({
    ...axis,
    scale: unit,
    side: n ? 1 : 3,
    grid: n ? { show: false } : grid,
    label: unit,
    labelSize: 20,
    values,
  }));
  const xLabel = shot.turns ? words.turns : "s";
  return {
    width: byId("chart").clientWidth,
    height: HIGH,
    legend: { show: false },
    cursor: { show: false },
    scales: { x: { time: false } },
    axes: [{ ...axis, size: 40, label: xLabel, labelSize: 20, values, space: 60 }, ...axes],
    series: [{}, ...signals.map((one, n) => line(one, n))],
    hooks: { draw: [draw] },
  };
}

function line(one, n) {
  const { tone, dash } = lookOf(one, n);
  return { scale: one.unit, stroke: tone, width: 1.5, dash, points: { show: false }, spanGaps: false };
}

/** What lies over it has the tone of its own signal, and is dotted. */
export function lookOf(one, n) {
  return one.over === undefined ? look(n) : { tone: look(one.over).tone, dash: [2, 4] };
}

/** How far two neighbours of the picture are apart, and half as much again. */
export function apartOf(x) {
  return x.length > 1 ? (1.5 * (x.at(-1) - x[0])) / (x.length - 1) : 0;
}

/** The two cursors, the trigger, and what happened, as lines across the picture. */
export function marks(u, shot, cursors) {
  const { ctx } = u;
  const { left, top, width, height } = u.bbox;
  const stroke = (x, tone, dash, name, high) => {
    const place = u.valToPos(x, "x", true);
    if (!(place >= left && place <= left + width)) return;
    ctx.save();
    ctx.strokeStyle = ctx.fillStyle = tone;
    ctx.lineWidth = 2 * devicePixelRatio;
    ctx.setLineDash(dash.map((d) => d * devicePixelRatio));
    ctx.beginPath();
    ctx.moveTo(place, top);
    ctx.lineTo(place, top + height);
    ctx.stroke();
    ctx.font = `${13 * devicePixelRatio}px sans-serif`;
    ctx.fillText(name, place + 4, top + high * 14 * devicePixelRatio);
    ctx.restore();
  };
  const { head } = shot;
  const of = (n) => (shot.turns ?? shot.t)[n];
  head.marks.forEach((mark, n) => {
    const place = shot.t.findIndex((t) => t >= mark.at_s);
    if (place >= 0) stroke(of(place), css("--muted"), [2, 3], mark.name, 3 + (n % 4));
  });
  if (head.trigger !== null) stroke(of(head.trigger), css("--high"), [8, 3], "T", 2);
  for (const [name, n] of Object.entries(cursors)) stroke(of(n), css("--text"), [], name, 1);
}
