// One trend over weeks: its readings with their errors, the line through them, the limit.
import { css, figure, legendLine, look, row, short } from "/static/curves.js";
import { byId, number, words } from "/static/see.js";

const HIGH = 320;
const root = document.documentElement;
const day = new Intl.DateTimeFormat(root.lang, { day: "2-digit", month: "2-digit" });
let chart = null;
let one = null;
let drawn = "";

function errorBars(u) {
  const context = u.ctx;
  context.save();
  context.strokeStyle = css("--now");
  context.lineWidth = 1;
  for (const [at_s, size, error] of one.readings) {
    const x = u.valToPos(at_s, "x", true);
    const [low, high] = [size - 2 * error, size + 2 * error].map((v) => u.valToPos(v, "y", true));
    context.beginPath();
    context.moveTo(x, low);
    context.lineTo(x, high);
    context.stroke();
  }
  context.restore();
}

function options() {
  const axis = { stroke: () => css("--text"), grid: { stroke: () => css("--line"), width: 0.5 } };
  const [readings, line, limit] = [look(0), look(1), look(2)];
  const dots = { show: true, size: 7, fill: readings.tone, stroke: readings.tone };
  return {
    width: byId("chart").clientWidth,
    height: HIGH,
    legend: { show: false },
    cursor: { drag: { x: false, y: false } },
    axes: [
      { ...axis, values: (u, splits) => splits.map((s) => day.format(new Date(1000 * s))), space: 70 },
      { ...axis, size: 60, values: (u, splits) => splits.map((v) => short(v)) },
    ],
    series: [
      {},
      { stroke: readings.tone, width: 0, points: dots },
      { stroke: line.tone, width: 2, dash: line.dash, points: { show: false }, spanGaps: true },
      { stroke: limit.tone, width: 2, dash: [3, 3], points: { show: false } },
    ],
    hooks: { draw: [errorBars] },
  };
}

function data() {
  const times = one.readings.map(([at_s]) => at_s);
  const last = times.length - 1;
  const line = times.map((at_s, n) => {
    if (one.line === null || !(times[last] > times[0])) return null;
    const share = (at_s - times[0]) / (times[last] - times[0]);
    return one.line.from_size + share * (one.line.to_size - one.line.from_size);
  });
  const limit = times.map(() => one.limit);
  return [times, one.readings.map(([, size]) => size), line, limit];
}

function draw() {
  const now = JSON.stringify([one, root.dataset.theme, byId("chart").clientWidth]);
  if (now === drawn && chart !== null) return;
  drawn = now;
  chart?.destroy();
  byId("chart").replaceChildren();
  chart = new window.uPlot(options(), data(), byId("chart"));
  const last = one.readings.at(-1)?.[1] ?? null;
  const legend = [legendLine(words.curve, last, one.unit, look(0))];
  if (one.line !== null) legend.push(legendLine(words.trend, one.line.to_size, one.unit, look(1)));
  if (one.limit !== null) {
    legend.push(legendLine(words.limit, one.limit, one.unit, { ...look(2), dash: [3, 3] }));
  }
  byId("curves").replaceChildren(...legend);
  const date = new Intl.DateTimeFormat(root.lang, { dateStyle: "medium" });
  const rows = [...one.readings].reverse().map(([at_s, size, error]) => {
    return row([date.format(new Date(1000 * at_s)), `${figure(size)} ${one.unit}`, number(error, 3)]);
  });
  byId("table").replaceChildren(row([words.day, words.size, words.error], "th"), ...rows);
}

/** Show one trend. */
export function drawTrend(trend) {
  one = trend;
  if (window.uPlot) draw();
  else addEventListener("load", draw, { once: true });
}

new ResizeObserver(() => one !== null && window.uPlot && draw()).observe(byId("chart"));
new MutationObserver(() => one !== null && window.uPlot && draw()).observe(root, {
  attributes: true,
  attributeFilter: ["data-theme"],
});
