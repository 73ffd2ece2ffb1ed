// What takes minutes to hours beside the other jobs.
import { byId, put } from "/static/see.js";
import { lines, post } from "/static/work.js";

const words = byId("long-words").dataset;
let wasBusy = false;
let lastSaid = "";

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

byId("long-stop").onclick = () => post("/refine/stop", {});
