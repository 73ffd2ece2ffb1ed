// Settings that are tried: shown to who commissions, kept or taken back with a reason.
import { done, keepTyped } from "/static/draft.js";
import { byId, put } from "/static/see.js";
import { post, whenDone } from "/static/work.js";

const FRESH_MS = 3000;
let heard_ms = -Infinity;

/** A count that nobody renews is none. */
function count() {
  const box = byId("tried-left");
  const isFresh = performance.now() - heard_ms < FRESH_MS;
  const { left, unknown } = box.dataset;
  put(box, isFresh ? (box.dataset.seconds ? left.replace("{seconds}", box.dataset.seconds) : "") : unknown);
  box.classList.toggle("bad", !isFresh);
}

/** Name of the reason that is typed: of what is shown as tried, and of nothing else. */
const draft = () => `tried ${byId("trying").dataset.sha256}`;

/** Show what is tried, as the commissioner says it stands; returns it, empty where nothing is. */
export function showTried(state) {
  if (state?.ok !== true || !state.service.answers) {
    count();
    return byId("tried").textContent; // nobody says that it has ended
  }
  const tried = state.service.trying ?? "";
  byId("trying").hidden = !(tried && state.is_open);
  put(byId("tried"), tried);
  byId("tried-left").dataset.seconds = state.left_s ?? "";
  const isAnother = tried && byId("trying").dataset.sha256 !== state.service.tried;
  byId("trying").dataset.sha256 = state.service.tried ?? "";
  if (isAnother) keepTyped(byId("tried-why"), draft());
  heard_ms = performance.now();
  count();
  return tried;
}

byId("trying").onsubmit = async (event) => {
  event.preventDefault();
  const measured = byId("trying").dataset.sha256; // of what is shown as tried: nothing else is kept or ended
  const said = { do: event.submitter.value, step: 0, measured, seconds: 0 };
  const [name, reason] = [draft(), byId("tried-why").value];
  const answer = await post("/card/settings", { ...said, reason });
  if (answer.ok) whenDone(said.do, -1, () => done(name, reason));
};
setInterval(count, 500);
