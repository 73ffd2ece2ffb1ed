// Alarms with their life, and the events behind them.
import { openBox } from "/static/box.js";
import { ask, at, byId, number, onPart, part, press, put, words } from "/static/see.js";

const MARKS = ["■", "▲", "●"];
const hand = byId("hand");
let newest = -1;
let shown = [];
let isAsking = false;

// --- alarms ------------------------------------------------------------------------------------

function said(one) {
  const line = part("li");
  line.dataset.rank = String(one.rank);
  line.dataset.life = one.life;
  const head = part("p", "what");
  head.append(part("span", "mark", `${MARKS[one.rank - 1]}${one.rank}`), " ");
  head.append(part("strong", "", one.name), " ", part("span", "", one.text));
  line.append(head);
  const facts = [one.life_word, `${words.since} ${at(one.since_s)}`];
  if (one.tick !== null) facts.push(`${words.tick} ${number(one.tick, 0)}`);
  if (one.gone_s !== null) facts.push(`${words.over} ${at(one.gone_s)}`);
  if (one.times > 1) facts.push(words.times.replace("{count}", number(one.times, 0)));
  if (one.seen_by) facts.push(`${words.seenBy} ${one.seen_by}`);
  if (one.shelved) facts.push(one.shelved);
  line.append(part("p", "note", facts.join(" · ")));
  if (one.is_first) line.append(part("p", "first", words.first));
  if (one.led_by) line.append(part("p", "first", one.led_by));
  if (one.followers.length) {
    line.append(part("p", "note", `${words.together}: ${one.followers.join(", ")}`));
  }
  line.append(part("p", "do", `${words.todo}: ${one.to_do}`));
  const row = part("p", "buttons");
  if (one.page) row.append(link(one));
  if (hand?.dataset.token) row.append(...buttons(one));
  if (row.childElementCount) line.append(row);
  line.dataset.key = one.key;
  line.dataset.seen = one.seen_by ? "yes" : "";
  line.tabIndex = -1;
  return line;
}

/** To the ticks around it, to its roll, or to the machine. */
function link(one) {
  const where = new URL(one.page, location.href);
  where.searchParams.set("lang", document.documentElement.lang);
  const made = part("a", "button", words.show);
  made.href = where.href;
  made.setAttribute("aria-label", `${words.show}: ${one.name}`);
  return made;
}

function buttons(one) {
  const made = [];
  if (!one.seen_by && one.life !== "shelved") {
    made.push(button(words.acknowledge, () => send("/acknowledge", { key: one.key })));
  }
  if (one.life === "shelved") {
    const back = { key: one.key, minutes: 0, reason: "" };
    made.push(button(words.unshelve, () => send("/shelve", back)));
  } else if (one.can_shelve) {
    made.push(button(words.shelve, () => askWhy(one)));
  }
  return made;
}

function button(text, press) {
  const made = part("button", "", text);
  made.type = "button";
  made.onclick = press;
  return made;
}

async function send(path, what) {
  put(byId("book-said"), await press(path, what));
}

function askWhy(one) {
  const box = byId("shelve");
  put(byId("shelve-what"), `${one.name}: ${one.text}`);
  byId("reason").value = "";
  byId("shelve-do").onclick = () => {
    if (!byId("reason").reportValidity()) return;
    box.close();
    const minutes = Number(byId("minutes").value);
    send("/shelve", { key: one.key, minutes, reason: byId("reason").value });
  };
  openBox(box);
}

byId("shelve-close").onclick = () => byId("shelve").close();

/** The rows are made anew only where what they say has changed: a finger stays on its button. */
const rows = new Map();
onPart((page) => {
  const wanted = page?.alarms ?? [];
  const lines = wanted.map((one) => {
    const text = JSON.stringify(one);
    const old = rows.get(one.key);
    if (old?.text === text) return old.line;
    const line = said(one);
    rows.set(one.key, { text, line });
    return line;
  });
  for (const key of [...rows.keys()]) if (!wanted.some((one) => one.key === key)) rows.delete(key);
  const nothing = page === null ? "—" : words.noAlarm;
  const list = byId("book");
  const next = lines.length ? lines : [part("li", "", nothing)];
  const isSame = next.length === list.children.length && next.every((l, i) => l === list.children[i]);
  if (!isSame) {
    const chosen = keyOf(document.activeElement);
    list.replaceChildren(...next);
    next.find((one) => chosen !== "" && one.dataset.key === chosen)?.focus();
  }
  for (const [n, one] of lines.entries()) one.tabIndex = n ? -1 : 0;
  put(byId("load"), page?.load ?? "");
  byId("load").classList.toggle("flood", page?.is_flood ?? false);
  put(byId("history"), page?.history ?? "");
  if (page !== null && page.newest !== newest) {
    newest = page.newest;
    look();
  }
});

/** Key of the alarm in whose line something is, empty for none. */
const keyOf = (place) => place?.closest?.("#book li[data-key]")?.dataset.key ?? "";

// arrows choose an alarm; on the chosen one the key that goes to the alarms says that it was seen
byId("book").addEventListener("keydown", (event) => {
  const line = event.target;
  if (!line.matches("li[data-key]") || event.ctrlKey || event.altKey || event.metaKey) return;
  const other = { ArrowDown: line.nextElementSibling, ArrowUp: line.previousElementSibling };
  if (event.key in other) {
    event.preventDefault();
    other[event.key]?.focus();
  } else if (event.key === "a" && !event.repeat && hand?.dataset.token && !line.dataset.seen) {
    event.stopPropagation();
    send("/acknowledge", { key: line.dataset.key });
  }
});

// an alarm of high priority that nobody has seen blinks with the frames, and by nothing else
document.addEventListener("frame", (event) => {
  const isOn = event.detail !== null && Math.floor(event.detail.q / 5) % 2 === 0;
  byId("book").classList.toggle("blink", isOn);
});

// --- events ------------------------------------------------------------------------------------

function wanted() {
  return { kind: byId("kind").value, roll: byId("roll").value };
}

/** The tick of an event leads to the ticks around it. */
function tickOf(one) {
  const cell = part("td", "figure", one.tick === null || one.page ? "" : number(one.tick, 0));
  if (one.tick === null) cell.textContent = "—";
  if (!one.page) return cell;
  const to = link(one);
  to.className = "";
  to.textContent = number(one.tick, 0);
  cell.append(to);
  return cell;
}

function row(one) {
  const line = part("tr");
  line.append(
    part("td", "when", at(one.utc_s)),
    part("td", "", one.kind),
    part("td", "", one.roll),
    part("td", "", `${one.name}: ${one.text}`),
    part("td", "", one.who),
    tickOf(one),
  );
  return line;
}

async function look(before = 0) {
  if (isAsking) return;
  isAsking = true;
  const asked = JSON.stringify(wanted());
  const at_newest = newest;
  const answer = await ask("/data/events", { ...wanted(), before: String(before) });
  isAsking = false;
  if (asked !== JSON.stringify(wanted()) || (before === 0 && at_newest !== newest)) {
    look();
    return;
  }
  if (!answer?.ok) {
    put(byId("book-said"), answer?.text ?? words.failed);
    return;
  }
  shown = before ? [...shown, ...answer.events] : answer.events;
  const lines = shown.map(row);
  if (!lines.length) {
    const cell = part("td", "", words.noEvent);
    cell.colSpan = 6;
    lines.push(part("tr"));
    lines[0].append(cell);
  }
  byId("log").replaceChildren(...lines);
  byId("older").hidden = answer.events.length < 100;
}

for (const name of ["kind", "roll"]) {
  byId(name).onchange = () => {
    const query = new URLSearchParams({ ...wanted(), lang: document.documentElement.lang });
    byId("save").href = `/data/events.csv?${query}`;
    look();
  };
}
byId("older").onclick = () => look(shown.at(-1).number);
