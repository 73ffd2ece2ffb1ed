// Times of the ticks, rights, who may what: all of it comes in the frames.
import { row, short } from "/static/curves.js";
import { renew } from "/static/renew.js";
import { byId, number, onPart, part, put, send, words } from "/static/see.js";

const NS = "http://www.w3.org/2000/svg";
const HIGH = 60;
const drawn = new Map();

/** Do what a part of the page needs only when it says something else than before. */
function when(name, said, make) {
  const text = JSON.stringify(said);
  if (drawn.get(name) === text) return;
  drawn.set(name, text);
  make();
}

function ms(us) {
  return us === null ? "—" : `${short(us / 1000, 3)} ms`;
}

/** Bars over classes of equal ratio; heights by the logarithm, so that one single tick shows. */
function bars(counts, edges, name) {
  const svg = document.createElementNS(NS, "svg");
  svg.setAttribute("class", "bars");
  svg.setAttribute("viewBox", `0 0 ${10 * counts.length} ${HIGH}`);
  svg.setAttribute("preserveAspectRatio", "none");
  svg.setAttribute("role", "img");
  svg.setAttribute("aria-label", name);
  const most = Math.log10(1 + Math.max(1, ...counts));
  counts.forEach((count, n) => {
    if (count === 0) return;
    const high = Math.max(2, (HIGH * Math.log10(1 + count)) / most);
    const bar = document.createElementNS(NS, "rect");
    for (const [key, value] of Object.entries({ x: 10 * n + 1, y: HIGH - high, width: 8, height: high })) {
      bar.setAttribute(key, String(value));
    }
    svg.append(bar);
  });
  const scale = part("p", "scale");
  for (const edge of [edges[0], edges[10], edges[20], edges[30], edges[40]]) scale.append(part("span", "", ms(edge)));
  const box = part("div", "");
  box.append(svg, scale);
  return box;
}

function timeBlock(one, edges) {
  const block = part("div", "time");
  block.append(part("h3", "", one.name), bars(one.counts, edges, one.name));
  const scroll = part("div", "scroll");
  scroll.tabIndex = 0;
  scroll.setAttribute("role", "region");
  scroll.setAttribute("aria-label", one.name);
  const table = part("table", "");
  const head = document.createElement("thead");
  head.append(row(["", words.ticks, "p50", "p99", "p99.9", words.largest], "th"));
  const body = document.createElement("tbody");
  for (const [name, of] of [[words.minute, one.minute], [words.whole, one.whole]]) {
    body.append(row([name, number(of.count, 0), ms(of.p50), ms(of.p99), ms(of.p999), ms(of.largest)]));
  }
  table.append(head, body);
  scroll.append(table);
  block.append(scroll);
  return block;
}

function rightLine(one) {
  const made = part("li", one.granted ? "granted" : "refused");
  made.append(part("span", "mark", one.granted ? "✓" : "✖"), " ");
  made.append(part("strong", "", one.name), ": ", part("span", "", one.granted ? words.granted : words.refused));
  if (one.cost) made.append("; ", part("span", "", one.cost));
  made.append(part("p", "note", one.said));
  return made;
}

function whoRow(one) {
  const cell = (why) => (why.length ? `✖ ${words.no}: ${why.join("; ")}` : `✓ ${words.may}`);
  const made = part("tr");
  const role = part("th", "", one.role);
  role.scope = "row";
  const names = [...document.querySelectorAll(".who-may thead th")].map((head) => head.textContent);
  const may = [one.bypass, one.arm].map((why, n) => {
    const found = part("td", "long", cell(why));
    found.dataset.name = names[n + 2]; // where the table is too narrow for its head
    return found;
  });
  made.append(role, part("td", "", one.place), ...may);
  return made;
}

function show(page) {
  if (page === null) {
    for (const slot of document.querySelectorAll("[data-of]")) put(slot, "—");
    return;
  }
  for (const slot of document.querySelectorAll("[data-of]")) {
    const value = slot.dataset.of.split(".").reduce((from, name) => from?.[name], page) ?? null;
    put(slot, number(value, Number(slot.dataset.digits)));
    if (slot.dataset.bad) slot.classList.toggle("bad", (value ?? 0) > 0);
  }
  when("times", page.times, () => {
    const blocks = page.times.map((one) => timeBlock(one, page.edges_us));
    const olds = [...byId("times").children];
    if (olds.length !== blocks.length) byId("times").replaceChildren(...blocks);
    else olds.forEach((old, n) => renew(old, blocks[n]));
  });
  when("rights", page.rights, () => {
    const lines = page.rights.map(rightLine);
    byId("rights").replaceChildren(...(lines.length ? lines : [part("li", "", words.noRights)]));
  });
  when("who", page.who, () => byId("who")?.replaceChildren(...page.who.map(whoRow)));
  const { machine } = page;
  const realtime = machine.is_realtime === null ? words.unknown : machine.is_realtime ? words.yes : words.no;
  put(byId("kernel"), page.kernel || words.unknown);
  put(byId("realtime"), realtime);
  put(byId("processors"), number(machine.processors, 0));
  put(byId("governors"), machine.governors || words.unknown);
  put(byId("isolated"), machine.isolated === "-" ? words.no : machine.isolated || words.unknown);
  put(byId("history"), page.history || "✓");
}

onPart(show);
// ages of the links are judged by the head of the page; the table says the same words
setInterval(() => {
  for (const cell of document.querySelectorAll("[data-age-of]")) {
    put(cell, document.querySelector(`[data-age="${cell.dataset.ageOf}"]`).textContent);
  }
}, 200);

// --- sessions ----------------------------------------------------------------------------------

const SESSIONS_MS = 10000;
let sessions_ms = -Infinity;
let sure = 0;

async function listSessions() {
  sessions_ms = performance.now();
  const answer = await send("/sessions", {});
  if (answer.ok) byId("sessions").replaceChildren(...answer.sessions.map(sessionLine));
  else put(byId("sessions-said"), answer.text);
}

function sessionLine(one) {
  const made = part("li");
  made.append(part("strong", "", one.account), " ");
  const minutes = (s) => number(Math.floor(s / 60), 0);
  const said = words.session.replace("{role}", one.role).replace("{place}", one.place);
  const marks = [one.has_hand && words.hand, one.is_own && words.own].filter(Boolean);
  const whole = said.replace("{minutes}", minutes(one.since_s)).replace("{still}", minutes(one.still_s));
  made.append(part("span", "note", [whole, ...marks].join(" · ")));
  if (one.can_end && !one.is_own) {
    const row = part("p", "buttons");
    const button = part("button", "", sure === one.number ? words.sure : words.end);
    button.type = "button";
    button.onclick = () => endSession(one.number, button);
    row.append(button);
    made.append(row);
  }
  return made;
}

async function endSession(which, button) {
  if (sure !== which) {
    sure = which;
    put(button, words.sure);
    return;
  }
  sure = 0;
  put(byId("sessions-said"), (await send("/sessions/end", { number: which })).text);
  listSessions();
}

if (byId("sessions")) {
  document.addEventListener("frame", (event) => {
    if (event.detail !== null && performance.now() - sessions_ms > SESSIONS_MS) listSessions();
  });
}
