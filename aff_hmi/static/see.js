// What the pages beside the overview share. Text goes in as text, never as markup.
import { nowS } from "/static/clock.js";

const root = document.documentElement;
export const byId = (name) => document.getElementById(name);
export const words = byId("see-words").dataset;
const PATIENCE_MS = 4000;

export function put(element, text) {
  if (element && element.textContent !== text) element.textContent = text;
}

/** An element with its class and text; the text may run in any direction. */
export function part(tag, kind, text) {
  const made = document.createElement(tag);
  if (kind) made.className = kind;
  if (text !== undefined) {
    made.textContent = text;
    made.dir = "auto";
  }
  return made;
}

const formats = new Map();

/** A number as this language writes it; a dash where none is known. */
export function number(value, digits) {
  if (value === null || value === undefined) return "—";
  if (!formats.has(digits)) {
    const both = { minimumFractionDigits: digits, maximumFractionDigits: digits };
    formats.set(digits, new Intl.NumberFormat(root.lang, both));
  }
  return formats.get(digits).format(value);
}

const day = new Intl.DateTimeFormat(root.lang, { dateStyle: "short" });
const clock = new Intl.DateTimeFormat(root.lang, { timeStyle: "medium", hourCycle: "h23" });

/** A time in the zone of this browser; the day is said when it is not today's. */
export function at(utc_s) {
  const when = new Date(1000 * utc_s);
  const isToday = when.toDateString() === new Date(1000 * nowS()).toDateString();
  return isToday ? clock.format(when) : `${day.format(when)} ${clock.format(when)}`;
}

/** What is asked of history; null when there is no answer. */
export async function ask(path, query, patience_ms = PATIENCE_MS) {
  const asked = new URLSearchParams({ ...query, lang: root.lang });
  try {
    const answer = await fetch(`${path}?${asked}`, { signal: AbortSignal.timeout(patience_ms) });
    return await answer.json();
  } catch {
    return null;
  }
}

/** A press that needs a login; the words of the answer. */
export async function press(path, said) {
  return (await send(path, said)).text;
}

/** A press that needs a login; the whole answer. */
export async function send(path, said, patience_ms = PATIENCE_MS) {
  const token = byId("hand")?.dataset.token ?? "";
  try {
    const answer = await fetch(`${path}?lang=${root.lang}`, {
      method: "POST",
      headers: { "content-type": "application/json", "x-aff-token": token },
      body: JSON.stringify(said),
      signal: AbortSignal.timeout(patience_ms),
    });
    return await answer.json();
  } catch {
    return { ok: false, text: words.failed };
  }
}

/** Call with what the page's part of a frame says, when it says something new; null: nothing. */
export function onPart(show) {
  let last = "";
  document.addEventListener("frame", (event) => {
    const page = event.detail?.page ?? null;
    const said = JSON.stringify(page);
    if (said === last) return;
    last = said;
    show(page);
  });
}
