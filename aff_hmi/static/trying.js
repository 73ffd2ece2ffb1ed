// Settings that are tried: shown to who commissions, kept or taken back with a reason.
import { keepTyped, sent } from "/static/draft.js";
import { byId, put } from "/static/see.js";
import { post } from "/static/work.js";

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
  byId("trying").dataset.sha256 = state.service.tried ?? "";
  heard_ms = performance.now();
  count();
  return tried;
}

keepTyped(byId("tried-why"), "tried");
byId("trying").onsubmit = async (event) => {
  event.preventDefault();
  const measured = byId("trying").dataset.sha256; // of what is shown as tried: nothing else is kept or ended
  const said = { do: event.submitter.value, step: 0, measured, seconds: 0 };
  const answer = await post("/card/settings", { ...said, reason: byId("tried-why").value });
  if (answer.ok) sent(byId("tried-why"), "tried");
};
setInterval(count, 500);
