// From the box to ACTIVE: every step with what is known of it, and what is to be done next.
import { ask, byId, number, part, put, words } from "/static/see.js";
import { keep, kept, keepTyped, sent } from "/static/draft.js";
import { short as shortly } from "/static/curves.js";
import { fill } from "/static/fill.js";
import { DEAD_MS } from "/static/freshness.js";
import { cut, secondsOf, take } from "/static/parts.js";
import { LONG_MS, act, lookAfter, post } from "/static/work.js";

const LINE_MS = 3000;
const ARMED = ["ARMED", "ACTIVE"];
const UNKNOWN = "—";
let state = null;
let line = null;
let card = null;
let isProbing = false; // as was heard last

function say(name, text, isBad = false) {
  const element = document.querySelector(`[data-says="${name}"]`);
  put(element, text);
  element.classList.toggle("bad", isBad);
}

/** A list of texts, the first `english` of which are in English, whatever the page is in. */
function listing(list, texts, kind = "", english = 0) {
  const said = JSON.stringify(texts);
  if (list.dataset.said === said) return;
  list.dataset.said = said;
  const items = texts.map((text) => part("li", kind, text));
  for (const one of items.slice(0, english)) one.lang = "en";
  list.replaceChildren(...items);
}

// --- the interview -----------------------------------------------------------------------------

let asked = 0;
let draft = ""; // name of what is typed as the answer to it, in no language
let answered = ""; // name of what was sent last, while nobody has said whether it is taken
let labels = new Map(); // of the answers that have a button

function question(one, said) {
  byId("question").hidden = one === null;
  if (one === null) {
    asked = 0;
    return;
  }
  if (asked === one.number) return;
  asked = one.number;
  put(byId("asked"), one.text);
  byId("question").dataset.name = one.name;
  const last = said.at(-1); // of an answer that was not taken: why not
  put(byId("refused"), last?.kind === "complain" ? last.text : "");
  draft = `answer ${state.site.path} ${one.name} ${one.choices.map(([value]) => value)}`;
  if (answered && !(answered === draft && last?.kind === "complain")) keep(answered, "");
  answered = "";
  byId("answer").value = kept(draft);
  put(byId("answer-label"), words.typed);
  labels = new Map(one.choices);
  const called = labels.get(one.default) ?? one.default;
  put(byId("default"), called ? fill(words.default, { text: called }) : "");
  const picks = [...one.rows.map(([value, row]) => [value, `${value}: ${row}`]), ...one.choices];
  byId("rows").replaceChildren(
    ...picks.map(([value, row]) => {
      const made = part("button", "pick", row);
      made.type = "button";
      made.dataset.value = value;
      made.onclick = () => answer(value);
      return made;
    }),
  );
  byId("question").scrollIntoView({ block: "center" });
  byId("answer").focus({ preventScroll: true });
}

async function answer(text) {
  const said = { number: asked, text };
  answered = draft;
  const found = await post("/commission/answer", said);
  if (found.ok) put(byId("work-said"), "");
  else answered = "";
  look();
}
byId("answer").oninput = () => keep(draft, byId("answer").value);

/** What is typed; the name of a button stands for its answer. */
function typed(text) {
  const name = text.trim().toLowerCase();
  return [...labels].find(([, label]) => label.toLowerCase() === name)?.[0] ?? text;
}

byId("question").onsubmit = (event) => {
  event.preventDefault();
  answer(typed(byId("answer").value));
};
keepTyped(byId("again"), "again");
byId("find-words").onclick = async () => {
  const answer = await act("words", byId("again").value);
  if (answer.ok) sent(byId("again"), "again");
  look();
};

// --- what is known of every step ---------------------------------------------------------------

function done(stage, isDone) {
  const row = document.querySelector(`[data-stage="${stage}"]`);
  row.dataset.done = isDone ? "yes" : "no";
}

/** Without an answer nothing is known, and the question stays with what is typed. */
function showState() {
  const isOk = state?.ok === true;
  const job = isOk ? state.job : null;
  document.querySelector("[data-open]").hidden = !(isOk && state.is_open && job === null);
  if (!isOk) {
    for (const name of ["file", "contact", "probe"]) say(name, UNKNOWN);
    for (const name of ["words", "contact"]) done(name, false);
    return;
  }
  const { site, service } = state;
  const file = site.path ? fill(words.file, { path: site.path, hash: site.sha256 }) : words.there;
  say("file", site.there ? file : words.noFile);
  done("words", site.there);
  question(state.is_open ? (job?.ask ?? null) : null, job?.said ?? []);
  const contact = !service.answers ? words.silent : service.heard ? words.heard : words.unheard;
  say("contact", service.trouble || contact, service.answers && !service.heard);
  done("contact", service.answers && service.heard);
  const nothing = service.probed && service.probed !== "measured";
  const probed = nothing ? fill(words.nothing, { why: service.probed }) : service.probed ? words.probed : "";
  const probe = service.probing ? words.probing : probed;
  say("probe", service.answers ? probe : UNKNOWN, Boolean(nothing));
  const root = document.documentElement;
  root.dataset.probed = service.probing ? "now" : nothing ? "nothing" : service.probed ? "yes" : "no";
}

function table(heads, rows) {
  const made = part("table", "wide");
  const head = part("tr");
  head.append(...heads.map((text) => part("th", "", text)));
  made.append(
    head,
    ...rows.map((cells) => {
      const row = part("tr");
      row.append(...cells.map((text, n) => part("td", n ? "figure" : "", text)));
      return row;
    }),
  );
  const box = part("div", "scroll");
  box.tabIndex = 0;
  box.append(made);
  return box;
}

const short = (value) => (value === null ? "—" : shortly(value, 3));

function response(one) {
  const when = { actuator: one.actuator, when: one.measured_at, speed: short(one.speed_m_s) };
  const made = part("div", "response");
  made.append(part("p", "title", fill(words.of, { ...when, radius: short(one.radius_m) })));
  if (one.repeat_sigmas !== null) {
    const isWide = one.repeat_sigmas > one.repeat_most;
    const figures = { sigmas: number(one.repeat_sigmas, 2), most: short(one.repeat_most) };
    made.append(part("p", "note", fill(isWide ? words.repeatWide : words.repeat, figures)));
  }
  if (one.drive.length) {
    const rows = one.drive.map((row) => [
      `${row.name}${row.is_sure ? "" : ` (${words.unsure})`}`,
      `${short(row.value)} ${row.unit}`,
      `${short(row.low)} – ${short(row.high)}`,
    ]);
    made.append(table([words.number, words.value, words.span], rows));
  }
  if (one.no_drive) made.append(part("p", "note", fill(words.noDrive, { why: one.no_drive })));
  const points = one.points.map(([f, gain, phase, error, coherence]) => [
    `${number(f, 2)} Hz`,
    `${short(gain)} ${one.unit}`,
    number(phase, 0),
    number(error, 1),
    number(coherence, 3),
  ]);
  const more = part("details");
  more.append(part("summary", "", `P(f), ${points.length}`));
  more.append(table(["f", words.gain, words.phase, words.error, words.coherence], points));
  made.append(more);
  return made;
}

// what the commissioner says is lacking beside keys of the site file, and the word for it
const LACKING = { "a line that runs": "aLineThatRuns", "a speed reference that moves a tension": "aSpeedReference" };

function bound(row, seconds) {
  const size = { amplitude: short(row.amplitude), limit: short(row.limit), unit: row.unit };
  const said = fill(words.bound, { actuator: row.actuator, seconds: number(seconds, 0), ...size });
  const isFirst = row.ripple === null;
  const moved = !isFirst ? words.ripple : row.expected_ripple_N === null ? words.first : words.firstKnown;
  const by = { ripple: short(isFirst ? row.expected_ripple_N : row.ripple), speed: short(row.speed_m_s) };
  const lacks = row.lacks.map((one) => words[LACKING[one]] ?? one).join(", ");
  const parts = [
    said,
    row.is_chosen ? words.chosen : words.given,
    fill(moved, { signal: row.signal, ...by, unit: row.signal_unit, lacks }),
  ];
  if (row.bound_N !== null) {
    parts.push(fill(words.movesN, { signal: row.signal, bound: short(row.bound_N) }));
  } else if (row.bound_share !== null) {
    parts.push(fill(words.movesShare, { signal: row.signal, bound: short(100 * row.bound_share) }));
  }
  if (row.sent !== null) parts.push(fill(words.sentAtMost, { amplitude: short(row.sent), unit: row.unit }));
  if (row.louder !== null) {
    parts.push(fill(words.louder, { louder: short(row.louder), unit: row.unit }));
  }
  return parts.join("; ");
}

let foundSaid = "";

/** What probes have found, made anew only where it is another: somebody reads in it. */
function showResponses(responses) {
  const said = JSON.stringify(responses);
  if (said === foundSaid) return;
  foundSaid = said;
  byId("found").replaceChildren(...responses.map(response));
}

let lineSaid = "";
function showLine() {
  const said = JSON.stringify(line);
  if (said === lineSaid) return;
  lineSaid = said;
  const errors = line?.errors ?? [];
  byId("errors").hidden = errors.length === 0;
  listing(byId("errors"), errors, "complain");
  const warnings = line?.warnings ?? [];
  listing(byId("facts"), [...warnings, ...(line?.limits ?? []), ...(line?.orders ?? [])], "", warnings.length);
  put(byId("warned"), line?.warnings.length ? ` ▲ ${line.warnings.length}` : "");
  listing(byId("bounds"), (line?.probe?.rows ?? []).map((row) => bound(row, line.probe.duration_s)));
  const isFaint = (line?.probe?.rows ?? []).some((row) => row.louder !== null);
  if (byId("louder")) byId("louder").hidden = !isFaint;
  byId("probe-louder-why").hidden = !isFaint;
  listing(byId("drives"), line?.drives ?? []);
  showResponses(line?.responses ?? []);
  const isProbed = (line?.responses.length ?? 0) > 0;
  done("check", line !== null && errors.length === 0);
  done("probe", isProbed);
  done("found", isProbed);
  done("tune", isProbed && line.stands_in.length === 0);
}

// --- arm and proof: what the line shows, since when ---------------------------------------------

const parts = [];
document.addEventListener("frame", (event) => {
  const frame = event.detail;
  if (frame === null || document.documentElement.dataset.broken) {
    notFresh();
    return;
  }
  const isOn = ARMED.includes(frame.state) && !isProbing; // a probe is no proof
  take(parts, { isOn, word: frame.word, now: performance.now() }, DEAD_MS);
  const seconds = secondsOf(parts.at(-1));
  say("arm", fill(words.state, { state: frame.word, seconds: number(seconds, 0) }));
  done("arm", frame.state === "ACTIVE");
});

/** What the line does is not known now: the part has ended, and its state is none of now. */
function notFresh() {
  cut(parts);
  say("arm", UNKNOWN);
  done("arm", false);
}

function showProof() {
  if (document.documentElement.dataset.broken) notFresh();
  const times = line?.proof;
  say("proof", times ? fill(words.off, { off: number(times.off_s, 0), on: number(times.on_s, 0) }) : "");
  const rows = parts.slice(-4).map((one) => {
    const seconds = secondsOf(one);
    const isEnough = times && seconds >= (one.isOn ? times.on_s : times.off_s);
    return `${isEnough ? words.done : words.todo} ${fill(words.state, { state: one.word, seconds: number(seconds, 0) })}`;
  });
  listing(byId("parts"), rows);
  const signed = card?.steps.filter((one) => one.signed).length ?? 0;
  const counts = { count: signed, left: (card?.steps.length ?? 0) - signed };
  const none = state?.ok === true && !state.card ? words.noCard : UNKNOWN;
  say("sign", card ? fill(words.signed, counts) : none);
  done("sign", signed > 0);
  done("proof", card?.steps.some((one) => one.number === 12 && one.stand === "pass") ?? false);
}

let isAsking = false;
async function lookLonger() {
  if (isAsking || document.hidden) return;
  isAsking = true;
  const found = state?.site?.there ? await ask("/data/line", {}, LONG_MS) : null;
  line = found?.ok ? found.line : null;
  const shown = await ask("/data/card", {}, LONG_MS);
  card = shown?.ok ? shown.card : null;
  isAsking = false;
  showLine();
}

let wasThere = "";
const look = lookAfter((found) => {
  state = found;
  if (found?.ok === true && found.service.answers) isProbing = found.service.probing;
  showState();
  const now = `${found?.site?.there}${found?.site?.sha256}${found?.service?.probing}`;
  if (now !== wasThere) lookLonger();
  wasThere = now;
});
setInterval(lookLonger, LINE_MS);
setInterval(showProof, 500);
