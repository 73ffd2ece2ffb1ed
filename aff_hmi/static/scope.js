// Every tick, as it arrives or around a trigger; two cursors; windows that are kept.
import { isOpen, isText, openBox } from "/static/box.js";
import { css, figure, legendLine, look, row, short } from "/static/curves.js";
import { laidOver, savePicture } from "/static/overlay.js";
import { at, byId, number, part, press, put, words } from "/static/see.js";
import { factorOf, unitName } from "/static/units.js";

const EVERY_MS = 500;
const PATIENCE_MS = 4000;
const AUTO_MS = 3000;
const MOST = 8;
const HIGH = 340;
const LEVELED = ["rise", "fall", "above", "below"];
const root = document.documentElement;
let shot = null; // what is drawn: head, x, columns, turns
let chart = null;
let drawn = "";
let isRunning = true;
let isAsking = false;
let asked_ms = -Infinity;
let fired_ms = performance.now();
let after = -1; // tick after which a trigger counts
let ended = null; // last tick of a picture that stands
let kept = null; // the window that is shown, null for what arrives
let sure = null;
let overlay = null; // a kept window over it: window, what it was asked with, what came
let about = null; // the tick that a link has asked for, and its wall time

// --- asking ------------------------------------------------------------------------------------

const boxes = () => [...document.querySelectorAll("input[name=signal]")];
const chosen = () => boxes().filter((box) => box.checked).map((box) => box.value);

/** What the picture is of; the same makes the file. */
function query() {
  const said = { signals: chosen().join(","), seconds: byId("seconds").value, roll: byId("roll").value };
  if (kept !== null) said.kept = kept.number;
  if (ended !== null) return { ...said, end: ended };
  const on = byId("on").value;
  if (!on) return said;
  said.on = on;
  said.pre = byId("pre").value;
  said.after = after;
  if (LEVELED.includes(on)) {
    said.of = byId("of").value;
    said.level = levelOf(byId("level").value.replace(",", "."));
  }
  return said;
}

/** A level as it was typed, in the unit of the plant; what is no number is told by the server. */
function levelOf(text) {
  const factor = factorOf(byId("of").selectedOptions[0]?.dataset.of ?? "");
  return factor === 1 || text.trim() === "" || Number.isNaN(Number(text)) ? text : String(Number(text) / factor);
}

async function fetchShot(said) {
  const asked = new URLSearchParams({ ...said, lang: root.lang });
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
    const of = head.orders[n];
    if (!of) return;
    of.amplitudes = of.amplitudes.map((size) => size && size * factor);
    of.floor = of.floor && of.floor * factor;
  });
  return { head, t, turns, columns };
}

async function renew() {
  if (isAsking || document.hidden) return;
  isAsking = true;
  asked_ms = performance.now();
  const said = query();
  const found = await fetchShot(said);
  isAsking = false;
  if (JSON.stringify(said) !== JSON.stringify(query())) {
    renew();
  } else if (found.text !== undefined) {
    put(byId("shot"), found.text);
  } else {
    took(found, said);
  }
}

/** Whether these are the ticks of a link: the same numbers come again with every start. */
function isOfLink({ head, t }) {
  const n = about.tick - head.first;
  return n >= 0 && n < head.n && Math.abs(head.utc_s + t[n] - about.at_s) < 1;
}

/** Show the ticks of a link, or say that they are gone; nothing else is taken for them. */
function tookLink(found) {
  if (found.head.n < 2 || !isOfLink(found)) {
    put(byId("shot"), words.goneTicks);
    about = ended = null;
    return;
  }
  const n = about.tick - found.head.first;
  byId("cursor-a").value = String(Math.round((1000 * n) / (found.head.n - 1)));
  about = null;
  show(found);
}

function took(found, said) {
  const { head } = found;
  if (about !== null) {
    tookLink(found);
    return;
  }
  if (head.n < 0) {
    put(byId("shot"), words.waits);
    const isAuto = byId("mode").value === "auto" && performance.now() - fired_ms > AUTO_MS;
    if (isAuto) fetchShot({ ...said, on: "" }).then((live) => live.head?.n > 0 && show(live));
    return;
  }
  show(found);
  if (head.trigger_tick !== null) {
    fired_ms = performance.now();
    after = head.trigger_tick + Math.round(head.n / 2);
    if (byId("mode").value === "single") stand();
  }
}

function stand() {
  isRunning = false;
  ended = shot === null || shot.head.last < 0 ? null : shot.head.last;
  buttons();
}

function run() {
  isRunning = true;
  ended = kept = null;
  after = -1;
  if (byId("on").value && shot !== null && shot.head.ring) after = shot.head.last;
  fired_ms = performance.now();
  buttons();
  renew();
}

function buttons() {
  put(byId("run"), isRunning ? words.stop : words.run);
  const picture = byId("picture");
  picture.classList.toggle("live", isRunning); // what stands is of its time, and says of which
  if (!isRunning) {
    picture.classList.remove("dead");
    put(picture.querySelector(".stale"), "");
  }
  const button = byId("keep-open");
  if (button) button.disabled = kept !== null || shot === null || shot.head.n < 2;
}

// --- the picture -------------------------------------------------------------------------------

/** Horizontal axis and curves with holes where ticks are missing. */
function holed({ head, t, turns, columns }) {
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

function options(signals) {
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
    hooks: { draw: [marks] },
  };
}

function line(one, n) {
  const { tone, dash } = lookOf(one, n);
  return { scale: one.unit, stroke: tone, width: 1.5, dash, points: { show: false }, spanGaps: false };
}

/** What lies over it has the tone of its own signal, and is dotted. */
function lookOf(one, n) {
  return one.over === undefined ? look(n) : { tone: look(one.over).tone, dash: [2, 4] };
}

/** Signals of the overlay, if what there is of it belongs to this picture. */
function overSignals() {
  if (overlay?.found === undefined) return [];
  const name = (one) => words.overlaid.replace("{signal}", one.label).replace("{name}", overlay.one.name);
  return overlay.found.head.signals.map((one, n) => ({ ...one, label: name(one), over: n }));
}

/** How far two neighbours of the picture are apart, and half as much again. */
function apartOf(x) {
  return x.length > 1 ? (1.5 * (x.at(-1) - x[0])) / (x.length - 1) : 0;
}

/** Ask for the overlay of these signals, over this length and this roll. */
async function renewOverlay() {
  const { signals, seconds, roll } = query();
  const said = { signals, seconds, roll, kept: overlay.one.number, end: overlay.one.last };
  const asked = JSON.stringify(said);
  if (overlay.asked === asked) return;
  overlay.asked = asked;
  overlay.found = undefined;
  const found = await fetchShot(said);
  if (overlay?.asked !== asked) return;
  if (found.text === undefined && found.head.n > 1) {
    overlay.found = found;
  } else {
    overlay = null;
    put(byId("kept-said"), found.text ?? words.nothing);
  }
  if (shot !== null) show(shot);
}

/** The two cursors, the trigger, and what happened, as lines across the picture. */
function marks(u) {
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
  for (const [name, n] of Object.entries(cursors())) stroke(of(n), css("--text"), [], name, 1);
}

/** Where the cursors are, as places in the columns. */
function cursors() {
  const place = (id) => Math.round((Number(byId(id).value) / 1000) * Math.max(0, shot.head.n - 1));
  return { A: place("cursor-a"), B: place("cursor-b") };
}

function show(found) {
  shot = found;
  if (overlay !== null) renewOverlay();
  const over = overSignals();
  const signals = [...shot.head.signals, ...over];
  const now = JSON.stringify([signals, shot.turns !== null, root.dataset.theme]);
  const data = holed(shot);
  if (over.length && data[0].length) {
    data.push(...laidOver(data[0], data[0][0], holed(overlay.found), apartOf(data[0])));
  } else {
    data.push(...over.map(() => []));
  }
  if (now !== drawn || chart === null) {
    chart?.destroy();
    byId("chart").replaceChildren();
    chart = new window.uPlot(options(signals), data, byId("chart"));
    drawn = now;
  } else {
    chart.setData(data);
  }
  const last = (one, n) => (one.over === undefined ? shot.columns[n].at(-1) : null);
  const lines = signals.map((one, n) => legendLine(one.label, last(one, n), one.unit, lookOf(one, n)));
  byId("curves").replaceChildren(...lines);
  tell();
  read();
  orders();
  buttons();
}

function tell() {
  const { head } = shot;
  let text = head.n ? words.live : words.nothing;
  const of = (utc_s, tick) => ({ "{time}": at(utc_s), "{tick}": String(tick) });
  const filled = (said, values) => Object.entries(values).reduce((s, [k, v]) => s.replace(k, v), said);
  if (head.trigger !== null) {
    text = filled(words.fired, of(head.utc_s + shot.t[head.trigger], head.trigger_tick));
  } else if (!isRunning && head.n) {
    text = filled(words.stopped, of(head.utc_s + shot.t[head.n - 1], head.last));
  }
  if (kept !== null) text = `${words.kept.replace("{name}", kept.name)}; ${text}`;
  if (head.missed) text += `; ${words.missed.replace("{count}", number(head.missed, 0))}`;
  put(byId("shot"), text);
}

// --- what is read off --------------------------------------------------------------------------

function read() {
  const { head, t, turns, columns } = shot;
  const table = byId("readout");
  if (!head.n) {
    table.tBodies[0].replaceChildren();
    return;
  }
  const { A, B } = cursors();
  const apart_s = t[B] - t[A];
  let text = `${words.between}: ${figure(1000 * apart_s)} ms`;
  if (apart_s) text += `, ${figure(1 / Math.abs(apart_s))} Hz`;
  if (turns) text += `, ${figure(turns[B] - turns[A])} ${words.turns}`;
  put(byId("between"), text);
  const names = [words.signal, "A", "B", "B − A", words.least, words.mean, words.largest];
  table.tHead.replaceChildren(row(names, "th"));
  const source = turns ?? t;
  const overlaid = overSignals();
  const apart = apartOf(source);
  const under = overlaid.length ? [A, B].map((n) => valuesUnder(source, n, apart)) : [];
  const rows = [...head.signals, ...overlaid].map((one, n) => {
    const column = one.over === undefined ? columns[n] : overlay.found.columns[one.over];
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

/** Values of the overlay under a place of the picture. */
function valuesUnder(source, n, apart) {
  return laidOver([source[n]], source[0], holed(overlay.found), apart).map(([value]) => value);
}

function orders() {
  const found = shot.head.orders;
  byId("orders").hidden = found.length === 0;
  if (found.length === 0) return;
  const table = byId("order-table");
  const names = shot.head.signals.map((one) => `${one.label} [${one.unit}]`);
  table.tHead.replaceChildren(row([words.order, ...names], "th"));
  const count = found[0].amplitudes.length;
  const rows = Array.from({ length: count }, (_, n) =>
    row([`${n + 1}x`, ...found.map((one) => figure(one.amplitudes[n]))]),
  );
  rows.push(row([words.floor, ...found.map((one) => figure(one.floor))]));
  if (found.every((one) => one.floor === null)) rows.push(row([words.few, ...found.map(() => "")]));
  table.tBodies[0].replaceChildren(...rows);
}

// --- kept windows ------------------------------------------------------------------------------

async function list() {
  try {
    const answer = await fetch(`/data/windows?lang=${root.lang}`, { signal: AbortSignal.timeout(PATIENCE_MS) });
    const found = await answer.json();
    const lines = found.ok ? found.windows.map(windowLine) : [part("li", "", found.text)];
    byId("windows").replaceChildren(...(lines.length ? lines : [part("li", "", words.noWindow)]));
  } catch {
    put(byId("kept-said"), words.failed);
  }
}

function windowLine(one) {
  const made = part("li");
  made.append(part("strong", "", one.name));
  if (one.note) made.append(part("p", "", one.note));
  const of = words.of.replace("{seconds}", number(one.seconds, 1)).replace("{time}", at(one.utc_s));
  made.append(part("p", "note", of.replace("{name}", one.who)));
  const where = words.where.replace("{run}", one.run || "—").replace("{first}", String(one.first));
  made.append(part("p", "note", where.replace("{last}", String(one.last)).replace("{config}", one.config || "—")));
  const buttons = part("p", "buttons");
  const open = part("button", "", words.open);
  open.type = "button";
  open.onclick = () => showKept(one);
  const over = part("button", "", overlay?.one.number === one.number ? words.layOff : words.layOver);
  over.type = "button";
  over.onclick = () => {
    overlay = overlay?.one.number === one.number ? null : { one };
    list();
    if (shot !== null) show(shot);
  };
  buttons.append(open, over);
  if (byId("keep")) {
    const go = part("button", "", words.letGo);
    go.type = "button";
    go.onclick = () => letGo(one, go);
    buttons.append(go);
  }
  made.append(buttons);
  return made;
}

async function showKept(one) {
  kept = one;
  isRunning = false;
  ended = one.last;
  const lengths = [...byId("seconds").options].map((option) => Number(option.value));
  byId("seconds").value = String(lengths.find((length) => length >= one.seconds) ?? lengths.at(-1));
  buttons();
  await renew();
  byId("shot").scrollIntoView({ block: "center" });
}

async function letGo(one, button) {
  if (sure !== one.number) {
    sure = one.number;
    put(button, words.sure);
    return;
  }
  sure = null;
  put(byId("kept-said"), await press("/let-go", { number: one.number }));
  list();
}

const dialog = byId("keep");
if (dialog) {
  byId("keep-open").onclick = () => {
    if (isRunning) stand();
    const { head, t } = shot;
    put(byId("keep-what"), `${at(head.utc_s)}, ${number(t[head.n - 1], 1)} s`);
    openBox(dialog);
  };
  byId("keep-close").onclick = () => dialog.close();
  byId("keep-do").onclick = async () => {
    const { first, last, ring } = shot.head;
    const said = { first, last, ring, name: byId("keep-name").value, note: byId("keep-note").value };
    put(byId("kept-said"), await press("/keep", said));
    dialog.close();
    list();
  };
}

// --- controls ----------------------------------------------------------------------------------

function controls() {
  const on = byId("on").value;
  for (const label of document.querySelectorAll(".leveled")) label.hidden = !LEVELED.includes(on);
  for (const label of document.querySelectorAll(".triggered")) label.hidden = !on;
  const count = chosen().length;
  for (const box of boxes()) box.disabled = count >= MOST && !box.checked;
  put(byId("chosen"), words.chosen.replace("{count}", String(count)));
}

for (const id of ["seconds", "roll", "on", "of", "level", "pre", "mode"]) {
  byId(id).onchange = () => {
    controls();
    if (["on", "of", "level", "pre", "mode"].includes(id)) run();
    else renew();
  };
}
for (const box of boxes()) {
  box.onchange = () => {
    controls();
    renew();
  };
}
for (const id of ["cursor-a", "cursor-b"]) {
  byId(id).oninput = () => {
    if (shot === null) return;
    chart?.redraw(false);
    read();
  };
}
byId("run").onclick = () => {
  if (isRunning) {
    stand();
    renew();
  } else {
    run();
  }
};
byId("save").onclick = (event) => {
  const last = shot?.head.last ?? -1;
  const said = { ...query(), on: "", end: last, lang: root.lang };
  event.currentTarget.href = `/data/scope.csv?${new URLSearchParams(said)}`;
};
byId("save-picture").onclick = () => {
  if (chart === null || shot === null) return;
  const stale = byId("picture").querySelector(".stale").textContent;
  const ends = new Date(1000 * (shot.head.utc_s + (shot.t?.at(-1) ?? 0))).toISOString();
  const of = `${document.querySelector("h1").textContent} … ${ends}`;
  const above = [of, `${byId("shot").textContent} ${stale}`];
  const below = [...byId("curves").children].map((one) => one.textContent);
  savePicture(chart, above, [...below, byId("between").textContent], "aff-scope.png");
};
// to a cursor, and to the other one; arrows, Home and End move it
document.addEventListener("keydown", (event) => {
  if (event.key !== "c" || event.ctrlKey || event.altKey || event.metaKey) return;
  if (isText(event) || isOpen()) return;
  event.preventDefault();
  byId(document.activeElement === byId("cursor-a") ? "cursor-b" : "cursor-a").focus();
});
new ResizeObserver(() => chart?.setSize({ width: byId("chart").clientWidth, height: HIGH })).observe(
  byId("chart"),
);
new MutationObserver(() => shot !== null && show(shot)).observe(root, {
  attributes: true,
  attributeFilter: ["data-theme"],
});
document.addEventListener("frame", (event) => {
  if (event.detail !== null && isRunning && performance.now() - asked_ms > EVERY_MS) renew();
});
for (const one of byId("of").options) {
  one.textContent = one.textContent.replace(`[${one.dataset.of}]`, `[${unitName(one.dataset.of)}]`);
}
for (const box of boxes().slice(0, 2)) box.checked = true;
const linked = new URLSearchParams(location.search);
if (["end", "tick", "at"].every((name) => /^[\d.]{1,15}$/.test(linked.get(name) ?? ""))) {
  about = { tick: Number(linked.get("tick")), at_s: Number(linked.get("at")) };
  ended = Number(linked.get("end"));
  isRunning = false;
  byId("seconds").value = "10";
}
controls();
buttons();
renew();
list();
