// What takes minutes to hours beside the other jobs; and how old what is shown is.
import { at, byId, put } from "/static/see.js";
import { lines, post } from "/static/work.js";

const words = byId("long-words").dataset;
let wasBusy = false;
let lastSaid = "";
let seen_s = null;

/** Show what runs; whether something has ended since the last time. */
export function showLong(state) {
  const isThere = state?.ok === true;
  const job = isThere ? state.long : null;
  byId("long").hidden = job === null;
  byId("long-stop").hidden = !(isThere && state.is_open);
  if (job !== null) {
    put(byId("long-name"), job.name);
    put(byId("long-for"), words.for.replace("{minutes}", Math.floor(job.seconds / 60)));
    lines(byId("long-lines"), job.said ?? []);
  }
  const last = isThere ? state.long_last : null;
  if (last !== null && job === null) {
    const said = words.last.replace("{name}", last.name).replace("{text}", last.text);
    put(byId("long-last"), `${last.ok ? "✓" : "✗"} ${said}`);
  } else {
    put(byId("long-last"), "");
  }
  const said = JSON.stringify(last);
  const hasEnded = (wasBusy && job === null) || (isThere && said !== lastSaid);
  wasBusy = job !== null;
  if (isThere) lastSaid = said;
  return hasEnded;
}

/** Say of when it is what is shown; without an answer, since when there is none. */
export function stamp(hasAnswer) {
  if (hasAnswer) seen_s = Date.now() / 1000;
  const text = seen_s === null ? "" : (hasAnswer ? words.seen : words.old).replace("{time}", at(seen_s));
  put(byId("seen-at"), text);
  byId("seen-at").classList.toggle("bad", !hasAnswer && seen_s !== null);
}

byId("long-stop").onclick = () => post("/refine/stop", {});
