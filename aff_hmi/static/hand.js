// Bypass in one press, arming by holding. What the service would refuse cannot be pressed, and says
// why. A press is done when the line shows it, not when the server has answered.
import { nowS } from "/static/clock.js";
import { dropAll } from "/static/draft.js";

const HOLD_MS = 1000;
const CONFIRM_MS = { bypass: 1000, arm: 2000, probe: 4000, "probe-louder": 4000, shadow: 2000, "end-shadow": 2000 };
const PATIENCE_MS = 4000;
const ON = ["ARMED", "ACTIVE"];
const rests = ["OFF", "READY", "BYPASS", "FAULT"];
const SHOWS = {
  bypass: ["BYPASS", "FAULT"],
  arm: ON,
  probe: ON,
  "probe-louder": ON,
  shadow: ["SHADOW"],
  "end-shadow": rests,
};
const root = document.documentElement;
const byId = (name) => document.getElementById(name);
const hand = byId("hand");
const words = byId("hand-words").dataset;
const arm = byId("arm");
const bypass = byId("bypass");
// those beside bypass are held; not every page has all of them
const heldOnes = [arm, ...["probe", "probe-louder", "shadow", "end-shadow", "forget"].map(byId)].filter(Boolean);

const figure = new Intl.NumberFormat(root.lang, { maximumSignificantDigits: 6, useGrouping: false });

let frame = null;
let hold = null;
let awaited = null;
let heldBy = null; // whose hand it was in the newest frame
let swallowed = ""; // a button whose press came in a moment without fresh data

function put(element, text) {
  if (element && element.textContent !== text) element.textContent = text;
}

/** What became of a press, and when: it stays until the next one; `isBad`: nobody saw it done. */
function tell(text, isBad = false) {
  const told = byId("hand-said");
  put(told, text && `${now().toLocaleTimeString(root.lang)} ${text}`);
  told.classList.toggle("unconfirmed", isBad);
}

function newId() {
  const bytes = crypto.getRandomValues(new Uint8Array(16));
  return Array.from(bytes, (byte) => byte.toString(16).padStart(2, "0")).join("");
}

async function post(path, said) {
  const answer = await fetch(`${path}?lang=${root.lang}`, {
    method: "POST",
    headers: { "content-type": "application/json", "x-aff-token": hand.dataset.token },
    body: JSON.stringify(said),
    signal: AbortSignal.timeout(PATIENCE_MS),
  });
  return answer.json();
}

// --- what may be pressed now -------------------------------------------------------------------

function isStale() {
  return frame === null || root.dataset.broken !== "";
}

/** Why something cannot be pressed; of a silent PLC the service itself says why. */
function against(action) {
  if (frame === null) return [words.stale];
  const why = frame.own.why[action];
  const isKnown = !isStale() || (root.dataset.broken === "plc" && why.length > 0);
  return isKnown ? why : [words.stale];
}

function show() {
  const own = frame?.own;
  if (frame !== null && !own) return;
  if (own && own.account !== hand.dataset.account) {
    location.reload();
    return;
  }
  for (const button of heldOnes) {
    const why = against(button.id);
    const cannot = why.length > 0;
    // what is disabled hears no press: of one without fresh data it is said that nothing is done
    const hears = why.length === 1 && why[0] === words.stale && button.dataset.could === "yes";
    if (button.disabled !== (cannot && !hears)) button.disabled = cannot && !hears;
    button.ariaDisabled = String(cannot);
    if (!isStale()) button.dataset.could = cannot ? "no" : "yes";
    put(byId(`${button.id}-why`), why.join("; "));
  }
  for (const button of document.querySelectorAll("button[data-may]")) {
    const why = against(button.dataset.may);
    button.disabled = why.length > 0;
    button.title = why.join("; ");
  }
  if (!own) {
    put(byId("hand-of"), "—"); // bypass stays as it was: it goes out without fresh data, too
    return;
  }
  bypass.disabled = own.why.bypass.length > 0;
  put(byId("bypass-why"), own.why.bypass.join("; "));
  const lost = own.lost_to ? words.lost.replace("{name}", own.lost_to) : "";
  put(byId("hand-of"), lost || held(own));
  byId("hand-of")?.classList.toggle("lost", lost !== "");
  if (byId("take")) {
    if (own.hand_of !== heldBy && byId("take").dataset.whose !== own.hand_of) offerHand("");
    heldBy = own.hand_of;
    byId("take").hidden = own.has_hand;
    byId("release").hidden = !own.has_hand;
  }
}

const now = () => new Date(1000 * nowS());

/** Who has the hand, since when, and from where. */
function held(own) {
  if (!own.hand_of) return words.none;
  const since = new Date(1000 * own.hand_since_s);
  const day = since.toDateString() === now().toDateString() ? {} : { day: "numeric", month: "short" };
  const time = since.toLocaleTimeString(root.lang, { ...day, hour: "2-digit", minute: "2-digit", hourCycle: "h23" });
  const said = (own.has_hand ? words.mine : words.other).replace("{name}", own.hand_of);
  const place = own.hand_from === "panel" ? words.panel : words.network;
  return said.replace("{time}", time).replace("{place}", place);
}

function confirmPress() {
  if (awaited === null) return;
  if (!isStale() && frame.q > awaited.after && SHOWS[awaited.action].includes(frame.state)) {
    tell(`${called(awaited.action)}: ${words.seen}`);
    if (awaited.action === "bypass") navigator.vibrate?.(200);
    awaited = null;
  } else if (performance.now() > awaited.until_ms) {
    tell(`${called(awaited.action)}: ${words.unseen}`, true);
    awaited = null;
  }
}

/** What a button is called, as it says itself. */
function called(action) {
  return byId(action).querySelector(".label").textContent;
}

document.addEventListener("frame", (event) => {
  frame = event.detail;
  if (hold !== null && frame !== null && frame.state !== hold.state) {
    tell(words.changed.replace("{name}", frame.word));
    letGo();
  }
  confirmPress();
  show();
  offerAgain();
});
setInterval(() => {
  if (hold !== null && isStale()) swallow(hold.button);
  confirmPress();
  show();
}, 100);

// --- pressing ----------------------------------------------------------------------------------

async function act(action, seen, number) {
  swallowed = "";
  const after = frame?.q ?? 0;
  tell(words.sent);
  awaited = null;
  const said = { action, id: newId(), seen, frame: number };
  try {
    // towards zero twice is no harm, and a connection may just have gone to sleep
    const first = post("/act", said);
    const answer = await (action === "bypass" ? first.catch(() => post("/act", said)) : first);
    if (!answer.ok) {
      tell(answer.text);
    } else if (action in SHOWS) {
      awaited = { action, after, until_ms: performance.now() + CONFIRM_MS[action] };
    } else {
      tell(answer.text); // nothing of it shows in the line
    }
  } catch {
    tell(`${called(action)}: ${words.failed}`, true);
  }
}

function pressBypass() {
  if (!bypass.disabled) act("bypass", "", frame?.q ?? 0);
}

/** Nothing is done without fresh data, and never later: whoever pressed is told so. */
function swallow(button) {
  letGo();
  swallowed = button.id;
  tell(`${called(button.id)}: ${words.swallowed}`);
}

/** Say when a press that came to nothing can be repeated. */
function offerAgain() {
  if (swallowed === "" || isStale()) return;
  if (!byId(swallowed).disabled) tell(`${called(swallowed)}: ${words.again}`);
  swallowed = "";
}

function begin(button) {
  if (hold !== null || button.disabled) return;
  if (isStale()) {
    swallow(button);
    return;
  }
  swallowed = "";
  hold = { button, state: frame.state, timer: setTimeout(finish, HOLD_MS) };
  button.classList.add("holding");
  if (button === arm) tell(`${words.arms}: ${armed()}`);
}

/** What will be armed: every output with the limit of now, and the configuration. */
function armed() {
  const outputs = [...hand.querySelectorAll("[data-armed]")].map(({ dataset }) => {
    const limit = frame.limits[dataset.armed] ?? Number(dataset.limit);
    return `${dataset.label} ≤ ${figure.format(limit)} ${dataset.unit}`;
  });
  return [...outputs, `${words.configuration} ${frame.config}`].join(", ");
}

function finish() {
  const { button, state } = hold;
  if (isStale()) {
    swallow(button);
    return;
  }
  letGo();
  const why = against(button.id);
  if (frame.state !== state) tell(words.changed.replace("{name}", frame.word));
  else if (why.length > 0) tell(`${called(button.id)}: ${why.join("; ")}`);
  else act(button.id, frame.state, frame.q);
}

function letGo() {
  if (hold === null) return;
  clearTimeout(hold.timer);
  hold.button.classList.remove("holding");
  hold = null;
}

function letGoEarly() {
  if (hold === null) return;
  letGo();
  tell(words.held);
}

bypass.onclick = pressBypass;
for (const button of heldOnes) {
  button.onpointerdown = (event) => {
    if (event.isPrimary && event.button === 0) begin(button);
  };
  for (const name of ["pointerup", "pointerleave", "pointercancel", "blur"]) {
    button.addEventListener(name, letGoEarly);
  }
  button.oncontextmenu = (event) => event.preventDefault();
  button.onkeydown = (event) => {
    if (event.key !== " " && event.key !== "Enter") return;
    event.preventDefault();
    if (!event.repeat) begin(button);
  };
  button.onkeyup = letGoEarly;
}
document.addEventListener("visibilitychange", letGoEarly);
document.addEventListener("keydown", (event) => {
  if (event.key !== "F9" || event.repeat) return;
  event.preventDefault();
  pressBypass();
});

async function ask(path, said) {
  try {
    return await post(path, said);
  } catch {
    return { ok: false, text: words.failed };
  }
}

/** Have the button take the hand, or take it over from the one who is named. */
function offerHand(whose) {
  const button = byId("take");
  button.dataset.whose = whose;
  button.dataset.do = whose ? "take over" : "take";
  put(button, whose ? words.over : words.take);
}

// no dialog asks: it would stand before the bypass
async function take() {
  const whose = byId("take").dataset.whose ?? "";
  const answer = await ask("/hand", { do: whose ? "take over" : "take", of: whose });
  offerHand(answer.code === "other hand" ? answer.name : "");
  tell(answer.ok ? "" : answer.text); // who has the hand stands above
}

byId("take")?.addEventListener("click", take);
byId("release")?.addEventListener("click", async () => {
  const answer = await ask("/hand", { do: "release", of: "" });
  tell(answer.ok ? "" : answer.text);
});
byId("logout")?.addEventListener("click", async () => {
  await ask("/logout", {});
  dropAll();
  location.reload();
});
