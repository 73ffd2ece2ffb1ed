// Fills the overview from whole frames. Text goes in as text, never as markup.
import { isOpen, isText, openBox } from "/static/box.js";
import { broken, isDead, judge } from "/static/freshness.js";
import { otherSound } from "/static/sound.js";
import { digitsOf, inUnit, otherUnits, unitName } from "/static/units.js";

const LOOK_MS = 50;
const UNSEEN_MS = 130; // every frame looks; where none comes, the clock does
const RETRY_MS = [250, 500, 1000, 2000];
const SILENT_MS = 3000;
const root = document.documentElement;
const language = root.lang;
const words = document.getElementById("words").dataset;
const byId = (name) => document.getElementById(name);
const line = document.title;
const hasRows = byId("login") === null; // who types a password sees none, and is not disturbed

let frame = null;
let arrived_ms = null; // when the newest frame came, though it is not shown any more
const heard_ms = {}; // when a link was last known not to be dead
let socket = null;
let tries = 0;
let beat = 0;
let opened_ms = 0;
let looked_ms = 0;
const shownLists = new Map();

// --- numbers and ages --------------------------------------------------------------------------

const formats = new Map();
function number(value, digits) {
  if (value === null || value === undefined) return words.none;
  if (!formats.has(digits)) {
    const both = { minimumFractionDigits: digits, maximumFractionDigits: digits };
    formats.set(digits, new Intl.NumberFormat(language, both));
  }
  return formats.get(digits).format(value);
}

function age(ms) {
  if (ms === null) return words.none;
  const s = ms / 1000;
  return s < 100 ? `${number(s, s < 10 ? 1 : 0)} s` : `${number(s / 60, 0)} min`;
}

/** A number of a place of the page, in the reader's unit. */
function inPlace({ digits, unit = "" }, value) {
  return number(inUnit(value, unit), digitsOf(Number(digits), unit));
}

function put(element, text) {
  if (element && element.textContent !== text) element.textContent = text;
}

// --- what is new -------------------------------------------------------------------------------

function showFrame() {
  for (const slot of document.querySelectorAll("[data-slot]")) {
    put(slot, inPlace(slot.dataset, frame.values[slot.dataset.slot]));
    slot.closest("p").classList.toggle("doubted", frame.doubted.includes(slot.dataset.slot));
  }
  for (const note of document.querySelectorAll("[data-note]")) {
    put(note, frame.notes[note.dataset.note] ?? "");
    note.classList.toggle("doubt", frame.doubted.includes(note.dataset.note));
  }
  for (const bar of document.querySelectorAll("[data-bar]")) {
    const share = Math.min(1, frame.values[bar.dataset.bar] ?? 0);
    bar.setAttribute("width", String(100 * share));
    bar.classList.toggle("full", share > 0.95);
  }
  put(byId("why"), frame.why);
  put(byId("to-do"), frame.to_do);
  for (const name of ["why", "to-do"]) byId(name).closest(".live").dataset.from = frame.why_from;
  byId("also-part").hidden = frame.also.length === 0;
  fill("also", frame.also, alsoItem, "");
  put(byId("config"), frame.config || words.none);
  showLimits();
  root.dataset.state = frame.state;
  root.dataset.urgent = String(frame.alarms[0]?.rank ?? "");
  fill("alarms", frame.alarms, alarmItem, words.noAlarm);
  fill("coming", frame.coming, comingItem, words.nothing);
}

const limitOf = new Intl.NumberFormat(language, { maximumSignificantDigits: 3 });

/** Limits of the outputs: a setting that is tried changes one while the page is open. */
function showLimits() {
  for (const limit of document.querySelectorAll(".limit")) {
    const { of, number: first, numberUnit } = limit.dataset;
    put(limit, limitOf.format(inUnit(frame?.limits[of] ?? Number(first), numberUnit)));
  }
}

function fill(name, entries, make, empty) {
  if (byId(name) === null) return; // another page than the overview
  const said = JSON.stringify(entries);
  if (shownLists.get(name) === said) return;
  shownLists.set(name, said);
  const items = entries.map(make);
  byId(name).replaceChildren(...(items.length ? items : [item([["span", "", empty]])]));
}

function item(parts) {
  const line = document.createElement("li");
  for (const [tag, kind, text] of parts) {
    const part = document.createElement(tag);
    if (kind) part.className = kind;
    part.textContent = text;
    part.dir = "auto";
    line.append(part, " ");
  }
  return line;
}

function comingItem({ text, radius_mm }) {
  const radius = `${number(inUnit(radius_mm, "mm"), digitsOf(0, "mm"))} ${unitName("mm")}`;
  return item([["span", "", text.replace("{radius}", radius)]]);
}

function alsoItem({ why, to_do }) {
  return item([["span", "", why], ["span", "do", `${words.todo}: ${to_do}`]]);
}

function alarmItem(alarm) {
  const line = item([
    ["span", "mark", `${["■", "▲", "●"][alarm.rank - 1]}${alarm.rank}`],
    ["strong", "", alarm.name],
    ["span", "", alarm.text],
    ["span", "do", `${words.todo}: ${alarm.to_do}`],
  ]);
  line.dataset.rank = String(alarm.rank);
  return line;
}

function showEvents(since_ms) {
  const entries = frame.events.map((one) => [one, age(1000 * one.ago_s + since_ms)]);
  const make = ([one, ago]) =>
    item([["strong", "", one.name], ["span", "", one.text], ["span", "ago", words.ago.replace("{age}", ago)]]);
  fill("events", entries, make, words.noEvent);
}

// --- what is old -------------------------------------------------------------------------------

function look() {
  const now_ms = performance.now();
  looked_ms = now_ms;
  const links = judge(frame, arrived_ms, now_ms);
  for (const node of document.querySelectorAll("[data-node]")) {
    const link = links[node.dataset.node];
    node.dataset.quality = link.quality;
    put(node.querySelector(".age"), age(link.age_ms));
  }
  for (const [of, { quality, age_ms }] of Object.entries(links)) {
    if (quality === "good" || quality === "worn") heard_ms[of] = now_ms - age_ms;
  }
  const name = frame === null ? "" : broken(links);
  const since_ms = arrived_ms === null ? null : now_ms - arrived_ms;
  const old_ms = frame === null ? since_ms : name === "" ? null : ageOf(name, links, now_ms);
  for (const part of document.querySelectorAll(".live")) {
    const dead = frame === null ? arrived_ms !== null : isDead(part.dataset.from, links);
    part.classList.toggle("dead", dead);
    const stale = part.querySelector(":scope > .stale");
    put(stale, dead ? words.old.replace("{age}", age(old_ms)) : "");
  }
  const gone = frame !== null && isDead("service", links);
  put(byId("state"), frame === null || gone ? words.unknown : frame.word);
  put(byId("shape"), frame === null || gone ? "?" : frame.shape);
  document.title = `${byId("shape").textContent} ${byId("state").textContent} · ${line}`;
  put(byId("was"), gone && frame.word !== words.unknown ? `${words.was} ${frame.word}` : "");
  root.dataset.broken = frame === null ? "waiting" : name;
  const { deadHmi, deadService, deadPlc, deadSupervisor } = words;
  const texts = { hmi: deadHmi, service: deadService, plc: deadPlc, supervisor: deadSupervisor };
  const { todoHmi, todoService, todoPlc, todoSupervisor } = words;
  const steps = { hmi: todoHmi, service: todoService, plc: todoPlc, supervisor: todoSupervisor };
  const sentence = name ? `${texts[name]} ${steps[name]}` : "";
  put(byId("broken-said"), frame === null ? words.waiting : sentence); // said aloud, so without its age
  byId("broken").hidden = frame !== null && !name;
  const isAged = name !== "" && old_ms !== null;
  put(byId("broken-age"), isAged ? words.since.replace("{age}", age(old_ms)) : "");
  root.classList.toggle("waiting", frame === null);
  if (frame !== null && !gone) showEvents(since_ms);
  if (socket && now_ms - Math.max(arrived_ms, opened_ms) > SILENT_MS) socket.close();
}

/** How long ago the link stopped; a service that was gone from the start has no age. */
function ageOf(name, links, now_ms) {
  const known_ms = name === "hmi" ? links.browser.age_ms : links[name].age_ms;
  return known_ms ?? (name in heard_ms ? now_ms - heard_ms[name] : null);
}

// --- the socket --------------------------------------------------------------------------------

function connect() {
  if (socket !== null || document.hidden) return;
  const scheme = location.protocol === "https:" ? "wss:" : "ws:";
  const own = new WebSocket(`${scheme}//${location.host}/live?lang=${language}&page=${root.dataset.page}`);
  socket = own;
  opened_ms = performance.now();
  const answer = (shown) => own.send(JSON.stringify({ a: shown, t: performance.now() }));
  own.onopen = () => answer(0);
  own.onmessage = (message) => {
    if (own !== socket) return;
    const fresh = JSON.parse(message.data);
    if (fresh.boot !== root.dataset.boot || (fresh.layout !== root.dataset.layout && hasRows)) {
      location.reload();
      return;
    }
    tries = 0;
    if (frame !== null && fresh.heart !== frame.heart) beat = (beat + 1) % 8;
    frame = fresh;
    arrived_ms = performance.now();
    byId("heart").dataset.beat = String(beat);
    showFrame();
    look();
    root.dataset.seq = String(frame.q);
    document.dispatchEvent(new CustomEvent("frame", { detail: frame }));
    answer(frame.q);
  };
  own.onclose = () => {
    if (own !== socket) return;
    socket = null;
    setTimeout(connect, RETRY_MS[Math.min(tries++, RETRY_MS.length - 1)]);
  };
}

/** Nothing that was shown before a pause is shown after it. */
function blank() {
  frame = null;
  for (const link of Object.keys(heard_ms)) delete heard_ms[link];
  document.dispatchEvent(new CustomEvent("frame", { detail: null }));
  for (const slot of document.querySelectorAll("[data-slot]")) put(slot, words.none);
  for (const name of ["alarms", "coming", "events"]) {
    shownLists.delete(name);
    fill(name, [], item, words.none);
    shownLists.delete(name);
  }
  for (const note of document.querySelectorAll("[data-note]")) put(note, "");
  for (const bar of document.querySelectorAll("[data-bar]")) bar.setAttribute("width", "0");
  put(byId("config"), words.none);
  for (const name of ["why", "to-do", "was"]) put(byId(name), "");
  byId("also-part").hidden = true;
  look();
}

document.addEventListener("visibilitychange", () => {
  blank();
  const left = socket;
  socket = null;
  left?.close();
  connect();
});
window.addEventListener("pageshow", (event) => event.persisted && location.reload());
window.addEventListener("online", connect);

// --- keys and colours --------------------------------------------------------------------------

function keep(name, value) {
  try {
    localStorage.setItem(name, value);
  } catch {
    // a browser that keeps nothing shows the machine's own colours again
  }
}

function kept(name) {
  try {
    return localStorage.getItem(name);
  } catch {
    return null;
  }
}

function otherTheme() {
  const dark = matchMedia("(prefers-color-scheme: dark)").matches ? "dark" : "light";
  root.dataset.theme = (root.dataset.theme ?? dark) === "dark" ? "light" : "dark";
  keep("theme", root.dataset.theme);
}

/** To another language, and by way of the login: the place on the page goes along. */
for (const link of document.querySelectorAll("a[data-keeps-place]")) {
  for (const kind of ["pointerdown", "click"]) {
    link.addEventListener(kind, () => (link.hash = location.hash)); // pointerdown: into a new tab
  }
}

const actions = {
  t: otherTheme,
  u: otherUnits,
  l: () => byId("language").click(),
  a: () => {
    const list = [byId("book"), byId("alarms")].find((one) => one?.offsetParent) ?? byId("main");
    const first = list.querySelector("li[tabindex]");
    if (!first) list.tabIndex = -1;
    (first ?? list).focus();
  },
  m: otherSound,
  "/": () => [...byId("main").querySelectorAll("select, input")].find((one) => one.checkVisibility())?.focus(),
  "?": () => openBox(byId("help")),
};
const PAGE_KEY_MS = 2000;
let page_key_ms = -Infinity; // when `g` was pressed: the key after it is a page

/** Go to a page by its key; whether the key was for that. */
function isPageKey({ key }) {
  const isSecond = performance.now() - page_key_ms < PAGE_KEY_MS;
  page_key_ms = key === "g" ? performance.now() : -Infinity;
  const pages = isSecond ? [...document.querySelectorAll("nav.pages a")] : [];
  const page = pages.find((one) => one.dataset.key === key);
  page?.click();
  return key === "g" || page !== undefined;
}

document.addEventListener("keydown", (event) => {
  if (event.ctrlKey || event.altKey || event.metaKey || isText(event) || isOpen()) return;
  if (isPageKey(event)) {
    event.preventDefault();
    return;
  }
  const action = actions[event.key];
  if (action) {
    event.preventDefault();
    action();
  }
});
byId("theme").onclick = otherTheme;
byId("units").onclick = otherUnits;
byId("keys").onclick = actions["?"];
byId("close").onclick = () => byId("help").close();
if (["light", "dark"].includes(kept("theme"))) root.dataset.theme = kept("theme");
showLimits();

blank();
setInterval(() => performance.now() - looked_ms > UNSEEN_MS && look(), LOOK_MS);
connect();
