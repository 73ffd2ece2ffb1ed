// Shared by the pages of who commissions: how the commissioner stands, a password that opens it,
// the job under way.
import { ask, byId, part, put, send, words } from "/static/see.js";

export const LONG_MS = 120000;
const EVERY_MS = 1000;

export function button(text, press, kind = "") {
  const made = part("button", kind, text);
  made.type = "button";
  made.onclick = press;
  return made;
}

/** A labelled field. */
export function field(label, name, more = {}) {
  const box = part("label", "", label);
  const input = document.createElement("input");
  Object.assign(input, { name, autocomplete: "off", spellcheck: false }, more);
  box.append(input);
  return { box, input };
}

export async function post(path, said) {
  put(byId("work-said"), words.sent);
  const answer = await send(path, said, LONG_MS);
  put(byId("work-said"), answer.text);
  return answer;
}

export const act = (what, again = "") => post("/commission/do", { do: what, again });

/** Look for ever; a page that nobody sees looks at nothing. */
export function lookAfter(show) {
  let isAsking = false;
  const look = async () => {
    if (isAsking || document.hidden) return;
    isAsking = true;
    const state = await ask("/data/commissioning", {}); // from memory: who is silent for long hangs
    isAsking = false;
    standing(state);
    show(state);
    if (state?.ok === true) tellWhoWaits(state);
  };
  look();
  setInterval(look, EVERY_MS);
  return look;
}

// A job takes what was sent and answers at once; whether it is done is heard of it later.
let waiting = [];

/** Call `then` once the job that has just begun has ended well; of one that is refused, never. */
export function whenDone(job, step, then) {
  waiting.push({ job, step, then, isSeen: false });
}

/** One look may have been under way before the job began: who never saw it run waits for two. */
function tellWhoWaits({ job, last }) {
  const still = waiting.filter((one) => {
    if (job === null && one.isSeen) {
      if (last?.ok && last.do === one.job && last.step === one.step) one.then();
      return false;
    }
    one.isSeen = true;
    return true;
  });
  waiting = still;
}

let lastJob = "";

function standing(state) {
  const isThere = state?.ok === true;
  byId("work-silent").hidden = isThere;
  if (!isThere) put(byId("work-silent"), state?.text ?? words.failed);
  const isOpen = isThere && state.is_open;
  byId("open").hidden = !isThere || isOpen || !state.may;
  byId("opened").hidden = !isOpen;
  byId("may-not").hidden = !isThere || state.may;
  const by = isThere && state.by && !isOpen ? words.other.replace("{name}", state.by) : "";
  put(byId("by"), by);
  const job = isThere ? state.job : null;
  byId("job").hidden = job === null;
  byId("stop").hidden = !isOpen;
  if (job !== null) {
    put(byId("job-name"), job.step >= 0 ? `${job.name} (${job.step})` : job.name);
    lines(byId("job-lines"), job.said ?? []);
  }
  const last = isThere ? state.last : null;
  const said = JSON.stringify(last);
  if (last && said !== lastJob && job === null) {
    const mark = last.ok ? "✓" : "✗";
    put(byId("job-last"), `${mark} ${last.name}: ${last.text}`);
  }
  lastJob = said;
}

/** Lines that a job has said; the same ones are left as they are. */
export function lines(list, said) {
  const text = JSON.stringify(said);
  if (list.dataset.text === text) return;
  list.dataset.text = text;
  list.replaceChildren(
    ...said.map((one) => {
      const line = part("li", one.kind, one.text);
      if (one.lang) line.lang = one.lang;
      return line;
    }),
  );
  list.scrollTop = list.scrollHeight;
}

byId("open").onsubmit = async (event) => {
  event.preventDefault();
  const box = byId("open-password");
  const over = byId("open").dataset.over === "yes";
  const answer = await post("/commission/open", { password: box.value, over });
  box.value = answer.ok ? "" : box.value;
  byId("open").dataset.over = answer.code === "busy" ? "yes" : "no";
};
byId("close-work").onclick = () => act("close");
byId("stop").onclick = () => act("stop");
