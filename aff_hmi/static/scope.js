// Every tick, as it arrives or around a trigger; two cursors; windows that are kept.
import { isOpen, isText, openBox } from "/static/box.js";
import { legendLine } from "/static/curves.js";
import { laidOver, savePicture } from "/static/overlay.js";
import { HIGH, apartOf, holed, lookOf, marks, options } from "/static/picture.js";
import { lineTable, orderTable, readOut } from "/static/readout.js";
import { ask, at, byId, number, press, put, words } from "/static/see.js";
import { fetchShot } from "/static/ticks.js";
import { factorOf, unitName } from "/static/units.js";
import { listWindows } from "/static/windows.js";

const EVERY_MS = 500;
const AUTO_MS = 3000;
const MOST = 8;
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
let overlay = null; // a kept window over it: window, what it was asked with, what came
let about = null; // the tick that a link has asked for, and its wall time

// --- asking ------------------------------------------------------------------------------------

const boxes = () => [...document.querySelectorAll("input[name=signal]")];
const chosen = () => boxes().filter((box) => box.checked).map((box) => box.value);

/** What the picture is of; the same makes the file. */
function query() {
  const said = { signals: chosen().join(","), seconds: byId("seconds").value, roll: byId("roll").value };
  if (kept !== null) said.kept = kept.number;
  if (byId("lines").open) said.lines = 1;
  if (ended !== null) return { ...said, end: ended };
  const on = byId("on").value;
  if (!on) return said;
  said.on = on;
  said.pre = byId("pre").value;
  said.after = after;
  if (on === "event") said.event = byId("event").value;
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

/** The window that was kept of the ticks of a link, if there is one. */
async function keptOfLink({ tick, at_s }) {
  const found = await ask("/data/windows", {});
  const isOfIt = (one) => {
    const share = (tick - one.first) / Math.max(1, one.last - one.first);
    return share >= 0 && share <= 1 && Math.abs(one.utc_s + share * one.seconds - at_s) < 1;
  };
  return found?.ok ? found.windows.find(isOfIt) : undefined;
}

/** Show the ticks of a link, those that were kept, or say that they are gone. */
async function tookLink(found) {
  if (found.head.n < 2 || !isOfLink(found)) {
    const link = about;
    about = ended = null;
    const one = await keptOfLink(link);
    if (one === undefined) {
      put(byId("shot"), words.goneTicks);
      return;
    }
    await showKept(one);
    const share = (link.tick - one.first) / Math.max(1, one.last - one.first);
    byId("cursor-a").value = String(Math.round(1000 * share));
    read();
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

/** Signals of the overlay, if what there is of it belongs to this picture. */
function overSignals() {
  if (overlay?.found === undefined) return [];
  const name = (one) => words.overlaid.replace("{signal}", one.label).replace("{name}", overlay.one.name);
  return overlay.found.head.signals.map((one, n) => ({ ...one, label: name(one), over: n }));
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
    chart = new window.uPlot(options(shot, signals, (u) => marks(u, shot, cursors())), data, byId("chart"));
    drawn = now;
  } else {
    chart.setData(data);
  }
  const last = (one, n) => (one.over === undefined ? shot.columns[n].at(-1) : null);
  const lines = signals.map((one, n) => legendLine(one.label, last(one, n), one.unit, lookOf(one, n)));
  byId("curves").replaceChildren(...lines);
  tell();
  read();
  orderTable(shot.head);
  lineTable(shot.head);
  buttons();
}

const read = () => readOut(shot, cursors(), overSignals(), overlay?.found);

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

// --- kept windows ------------------------------------------------------------------------------

const list = () => listWindows({ open: showKept, lay, isLaid });
const isLaid = (one) => overlay?.one.number === one.number;

/** Lay a kept window over the picture, or take it off. */
function lay(one) {
  overlay = isLaid(one) ? null : { one };
  list();
  if (shot !== null) show(shot);
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
  byId("event-part").hidden = on !== "event";
  const count = chosen().length;
  for (const box of boxes()) box.disabled = count >= MOST && !box.checked;
  put(byId("chosen"), words.chosen.replace("{count}", String(count)));
}

for (const id of ["seconds", "roll", "on", "of", "event", "level", "pre", "mode"]) {
  byId(id).onchange = () => {
    controls();
    if (["on", "of", "event", "level", "pre", "mode"].includes(id)) run();
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
byId("lines").ontoggle = () => renew();
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
