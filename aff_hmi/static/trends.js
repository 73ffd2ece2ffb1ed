// Curves over time from what the screen keeps; drawn by uPlot, with a table behind.
import { holed, lonely, tabled } from "/static/bins.js";
import { css, figure, legendLine, look, short } from "/static/curves.js";
import { ask, at, byId, number, part, put, words } from "/static/see.js";
import { factorOf, inUnit, unitName } from "/static/units.js";

const EVERY_MS = { "1min": 2000, "10min": 5000, "1h": 15000, "8h": 60000, "7d": 300000, "1y": 300000 };
const UNKNOWN_MS = 1000; // until the screen knows the line, and with it what there is to choose
const HIGH = 320;
const MOST_ROWS = 60;
const BAND = 8; // height of the states above the curves, pixels
const MOST_FLAGS = 12; // in the list; more are lines in the picture alone
const FLAG_ROOM = 14; // between two numbers on the picture, pixels
const root = document.documentElement;
let chart = null;
let kind = "";
let answer = null;
let asked_ms = -Infinity;
let isAsking = false;

function clock(u, splits) {
  const isLong = answer !== null && answer.to_s - answer.from_s > 100000;
  const how = isLong
    ? { day: "2-digit", month: "2-digit" }
    : answer !== null && answer.to_s - answer.from_s < 3000
      ? { hour: "2-digit", minute: "2-digit", second: "2-digit" }
      : { hour: "2-digit", minute: "2-digit" };
  const format = new Intl.DateTimeFormat(root.lang, { ...how, hourCycle: "h23" });
  return splits.map((s) => format.format(new Date(1000 * s)));
}

function states(u) {
  const { left, top, width } = u.bbox;
  const context = u.ctx;
  const per_s = width / (answer.to_s - answer.from_s);
  context.save();
  answer.t_s.forEach((t, n) => {
    const x = u.valToPos(t, "x", true);
    if (x < left || x > left + width) return;
    const wide = Math.max(1, per_s * answer.wide_s[n]);
    for (const [shares, tone, low] of [[answer.active, "--now", 0], [answer.fault, "--high", 1]]) {
      const share = shares[n] ?? 0;
      if (share <= 0) continue;
      context.fillStyle = css(tone);
      context.globalAlpha = share;
      context.fillRect(x, top + BAND * low, wide, low ? BAND : BAND / 2);
    }
  });
  context.restore();
}

/** A line where something happened, with the number that it has in the list. */
function flags(u) {
  const { left, top, width, height } = u.bbox;
  const context = u.ctx;
  const first = Math.max(0, answer.flags.length - MOST_FLAGS);
  let [free, drawn] = [-Infinity, -Infinity];
  context.save();
  context.strokeStyle = context.fillStyle = css("--text");
  context.setLineDash([4, 4]);
  context.font = `${12 * devicePixelRatio}px sans-serif`;
  answer.flags.forEach((flag, n) => {
    const x = Math.round(u.valToPos(flag.utc_s, "x", true));
    if (x < left || x > left + width || x < drawn + 2) return; // a splice a minute is no black field
    drawn = x;
    context.beginPath();
    context.moveTo(x, top + 2 * BAND);
    context.lineTo(x, top + height);
    context.stroke();
    if (n < first || x < free) return;
    context.fillText(String(n - first + 1), x + 3, top + 2 * BAND + 12 * devicePixelRatio);
    free = x + FLAG_ROOM * devicePixelRatio;
  });
  context.restore();
}

/** The same in words, which is all that a reader without the picture has. */
function listFlags() {
  const shown = answer.flags.slice(-MOST_FLAGS);
  const lines = shown.map((flag) => {
    const line = part("li");
    line.append(part("span", "when", at(flag.utc_s)), " ", part("b", "", flag.name), " ");
    line.append(part("span", "", flag.text));
    return line;
  });
  byId("flagged").hidden = !lines.length;
  byId("flags").replaceChildren(...lines);
  const earlier = answer.flags.length - shown.length;
  put(byId("earlier"), earlier ? words.more.replace("{count}", number(earlier, 0)) : "");
}

/** A value between two holes is a point: no line leads to it. */
const POINTS = { show: false, size: 5, filter: (u, n) => lonely(u.data[n]) };

function options(curves) {
  const axis = { stroke: () => css("--text"), grid: { stroke: () => css("--line"), width: 0.5 } };
  const series = [{}];
  const bands = [];
  curves.forEach((curve, n) => {
    const { tone, dash } = look(n, curve.dashed);
    const first = series.length;
    series.push({ stroke: tone, width: 2, dash, points: { ...POINTS, fill: tone } });
    series.push({ stroke: "transparent", width: 0, points: { show: false } });
    series.push({ stroke: "transparent", width: 0, points: { show: false } });
    if (!curve.dashed) bands.push({ series: [first + 2, first + 1], fill: `${tone}33` });
  });
  return {
    width: byId("chart").clientWidth,
    height: HIGH,
    legend: { show: false },
    cursor: { drag: { x: false, y: false } },
    scales: { x: { range: () => [answer.from_s, answer.to_s] } },
    axes: [
      { ...axis, values: clock, space: 70 },
      { ...axis, size: 60, values: (u, splits) => splits.map((v) => short(v)) },
    ],
    series,
    bands,
    hooks: { draw: [states, flags] },
  };
}

function draw() {
  const { curves, t_s } = answer;
  const data = holed(answer);
  const now = JSON.stringify([curves.map((c) => [c.label, c.unit]), root.dataset.theme]);
  if (now !== kind || chart === null) {
    chart?.destroy();
    byId("chart").replaceChildren();
    chart = new window.uPlot(options(curves), data, byId("chart"));
    kind = now;
  } else {
    chart.setData(data);
  }
  put(byId("good"), answer.good);
  const until = words.until.replace("{time}", at(answer.to_s));
  put(byId("until"), t_s.length ? until.replace("{seconds}", number(answer.bin_s, 0)) : words.nothing);
  byId("curves").replaceChildren(...curves.map(legend));
  listFlags();
  if (byId("as-table").open) tabulate();
}

function legend(curve, n) {
  return legendLine(curve.label, curve.mean.at(-1) ?? null, curve.unit, look(n, curve.dashed));
}

function tabulate() {
  const head = part("tr");
  head.append(part("th", "", words.time));
  for (const curve of answer.curves) {
    const unit = curve.unit ? ` [${curve.unit}]` : "";
    const name = `${curve.label}${unit}: ${words.mean} (${words.least} … ${words.largest})`;
    head.append(part("th", "", name));
  }
  for (const cell of head.children) cell.scope = "col";
  const rows = tabled(answer, MOST_ROWS).reverse().map(({ t_s, curves }) => {
    const row = part("tr");
    row.append(part("td", "when", at(t_s)));
    if (curves === null) {
      const none = part("td", "", words.hole);
      none.colSpan = answer.curves.length;
      row.append(none);
    }
    for (const { least, mean, largest } of curves ?? []) {
      const text = `${figure(mean)} (${figure(least)} … ${figure(largest)})`;
      row.append(part("td", "figure", text));
    }
    return row;
  });
  byId("table").tHead.replaceChildren(head);
  byId("table").tBodies[0].replaceChildren(...rows);
}

/** Bring a curve into the reader's unit. */
function turn(curve, isShape) {
  const unit = isShape ? "mm of shape" : curve.unit;
  curve.unit = unitName(unit);
  if (factorOf(unit) === 1) return;
  for (const name of ["least", "mean", "largest"]) curve[name] = curve[name].map((v) => inUnit(v, unit));
}

/** What there is to choose from, where the page was made before the line was known. */
function offer(groups) {
  const before = byId("group").value;
  const options = groups.map(([value, name]) => {
    const one = part("option", "", name);
    one.value = value;
    return one;
  });
  byId("group").replaceChildren(...options);
  if (groups.some(([value]) => value === before)) byId("group").value = before;
}

async function renew() {
  if (isAsking || document.hidden) return;
  isAsking = true;
  asked_ms = performance.now();
  const query = { group: byId("group").value, window: byId("window").value };
  const found = await ask("/data/trend", query);
  isAsking = false;
  const isOther = found?.groups?.length > 0;
  if (isOther) offer(found.groups);
  if (query.group !== byId("group").value || query.window !== byId("window").value) {
    renew();
  } else if (found?.ok) {
    answer = found.trend;
    for (const curve of answer.curves) turn(curve, query.group.startsWith("mm "));
    draw();
  } else if (found?.groups && !isOther) {
    put(byId("until"), words.nothing);
  } else {
    put(byId("until"), found?.text ?? words.failed);
  }
}

for (const name of ["group", "window"]) byId(name).onchange = renew;
byId("as-table").ontoggle = () => answer !== null && tabulate();
new ResizeObserver(() => chart?.setSize({ width: byId("chart").clientWidth, height: HIGH })).observe(
  byId("chart"),
);
new MutationObserver(() => answer !== null && draw()).observe(root, {
  attributes: true,
  attributeFilter: ["data-theme"],
});
// asked again while the line is heard: what is shown of a line that is not is crossed out with its age
document.addEventListener("frame", (event) => {
  const wait_ms = byId("group").value ? EVERY_MS[byId("window").value] : UNKNOWN_MS;
  if (event.detail !== null && performance.now() - asked_ms > wait_ms) renew();
});
renew();
