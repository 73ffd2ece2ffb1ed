// Choose windows of recorded runs, see what they lack, refine, read what was found, try it.
import { row } from "/static/curves.js";
import { keep, kept, keepTyped } from "/static/draft.js";
import { showLong } from "/static/long.js";
import { stamp } from "/static/stamp.js";
import { showVerdict } from "/static/verdict.js";
import { ask, byId, number, part, put, words } from "/static/see.js";
import { showTried } from "/static/trying.js";
import { LONG_MS, button, field, lookAfter, post } from "/static/work.js";

const EVERY_MS = 5000;
let isOpen = false;
let shown = ""; // number of the refinement that is open

const digits = (value, count) => (value === null ? "—" : number(value, count));

/** Put the same children only once, so that who reads or types is not disturbed. */
function renewed(box, said, make) {
  const text = JSON.stringify(said);
  if (box.dataset.said === text) return;
  box.dataset.said = text;
  box.replaceChildren(...make());
}

// --- choosing ----------------------------------------------------------------------------------

function choose(name, [from, to, use] = ["", "", byId("chosen").childElementCount ? "judge" : "fit"]) {
  const box = part("p", "fields chosen");
  box.dataset.run = name;
  box.append(part("span", "name", name));
  const more = { maxLength: 14, pattern: "[0-9:.]*" };
  const choice = document.createElement("select");
  for (const [value, text] of [["fit", words.fit], ["judge", words.judge]]) {
    const option = part("option", "", text);
    option.value = value;
    choice.append(option);
  }
  choice.value = use;
  const label = part("label", "", words.use);
  label.append(choice);
  const ends = [["from", from], ["to", to]].map(([end, value]) => field(words[end], end, { ...more, value }).box);
  const remove = button(words.remove, () => {
    box.remove();
    keepChosen();
  });
  box.append(...ends, label, remove);
  byId("chosen").append(box);
  return box;
}

/** Choose a run that is listed, and go on with its times. */
function add(run) {
  choose(run.name).querySelector("input").focus();
  keepChosen();
}

/** What is chosen is kept until somebody removes it: it is asked for more than once. */
function keepChosen() {
  const rows = [...byId("chosen").children].map((box) => {
    const fields = [...box.querySelectorAll("input, select")].map((one) => one.value);
    return [box.dataset.run, fields];
  });
  keep("chosen", rows.length ? JSON.stringify(rows) : "");
}

byId("chosen").addEventListener("input", keepChosen);
for (const [name, fields] of JSON.parse(kept("chosen") || "[]")) choose(name, fields);
keepTyped(byId("without"), "without");

function runs(view) {
  put(byId("runs-count"), `(${view.runs.length})`);
  renewed(byId("runs"), view.runs, () => [
    row([words.run, words.began, words.line, words.span, ""], "th"),
    ...view.runs.map((run) => {
      const span = `${digits(run.from_s, 0)} – ${digits(run.to_s, 0)}`;
      const made = row([run.name, run.start_utc.slice(0, 19), run.line, span]);
      const cell = part("td");
      const choosing = button(words.add, () => add(run));
      choosing.setAttribute("aria-label", `${words.add}: ${run.name}`);
      cell.append(choosing);
      made.append(cell);
      return made;
    }),
  ]);
}

/** What is chosen, as the commissioner takes it: a part of a run a line. */
function chosen() {
  const texts = { fit: [], judge: [] };
  for (const box of byId("chosen").children) {
    const [from, to] = ["from", "to"].map((name) => box.querySelector(`[name="${name}"]`).value.trim());
    const part = from || to ? `@${from}..${to}` : "";
    texts[box.querySelector("select").value].push(`${box.dataset.run}${part}`);
  }
  const said = { windows: texts.fit.join("\n"), holdout: texts.judge.join("\n") };
  return { ...said, without: byId("without").value };
}

byId("look").onclick = async () => {
  await post("/refine/lacks", chosen());
  look();
};
byId("choose").onsubmit = async (event) => {
  event.preventDefault();
  await post("/refine/start", chosen());
  look();
};

// --- what they lack ----------------------------------------------------------------------------

function asked(one) {
  const said = words.asked.replace("{by}", one.by).replace("{utc}", one.utc.slice(0, 19));
  const windows = one.windows.join(", ");
  return said.replace("{windows}", windows).replace("{holdout}", one.holdout.join(", ") || words.nothing);
}

function listed(title, texts, kind = "", language = "") {
  if (!texts.length) return [];
  const list = part("ul", kind);
  if (language) list.lang = language;
  list.append(...texts.map((text) => part("li", "", text)));
  return [part("p", "title", title), list];
}

function record(one) {
  const box = part("div", "record");
  box.append(part("h4", "", `${one.name} (${one.is_held ? words.judge : words.fit})`));
  if (one.refused) {
    box.append(...listed(`✗ ${words.refused}`, [one.refused], "bad-list", "en"));
    return box;
  }
  const ends = ([low, high], count) => `${digits(low, count)} – ${digits(high, count)}`;
  const facts = part("dl", "figures");
  const rows = [
    [words.length, digits(one.length_s, 0)],
    [words.speed, ends(one.speed_m_s, 2)],
    [words.tension, ends(one.tension_N, 1)],
    [words.radius, digits(1e3 * one.radius_m, 1)],
  ];
  for (const [name, value] of rows) facts.append(part("dt", "", name), part("dd", "", value));
  box.append(facts, ...listed(words.lacks, one.lacks.length ? one.lacks : [words.lacksNothing]));
  const more = part("details");
  more.append(part("summary", "", `${words.found} (${one.said.length})`), ...listed("", one.said, "", "en"));
  box.append(more);
  return box;
}

function lacking(view) {
  byId("lacking").hidden = view === null;
  if (view === null) return;
  put(byId("lacking-of"), asked(view.asked));
  renewed(byId("lacks"), view.found, () => [
    ...view.found.records.map(record),
    ...listed(words.together, view.found.together),
  ]);
}

// --- what was refined --------------------------------------------------------------------------

function refined(view) {
  renewed(byId("refined"), view.refined, () => [
    row([words.number, words.verdict, words.what, words.by, ""], "th"),
    ...view.refined.map((one) => {
      const made = row([String(one.number), `${one.mark} ${one.word}`, one.text || one.means, one.asked.by]);
      made.dataset.kind = one.kind;
      const cell = part("td");
      const open = button(words.open, () => openOne(one.number));
      open.setAttribute("aria-label", `${words.open}: ${one.number}`);
      cell.append(open);
      made.append(cell);
      return made;
    }),
  ]);
}

async function openOne(which) {
  shown = String(which);
  history.replaceState(null, "", `#${shown}`);
  await lookAtOne();
  byId("one-title").focus();
}

async function lookAtOne() {
  if (!shown) return;
  const found = await ask("/data/refined", { number: shown }, LONG_MS);
  byId("one").hidden = false;
  if (!found?.ok) {
    put(byId("one-title"), found?.text ?? words.failed);
    return;
  }
  const { row: short, summary, proposal, command } = found.refined;
  put(byId("one-title"), `${short.number}: ${short.mark} ${short.word} – ${short.means}`);
  put(byId("one-of"), asked(short.asked));
  renewed(byId("one-body"), [found.refined, isOpen], () =>
    showVerdict(short, summary, proposal, command, isOpen),
  );
}

// --- looking -----------------------------------------------------------------------------------

let isAsking = false;
async function look() {
  if (isAsking || document.hidden) return;
  isAsking = true;
  const found = await ask("/data/refining", {}, LONG_MS);
  isAsking = false;
  stamp(found?.ok === true);
  document.documentElement.dataset.refining = found?.ok ? "shown" : "none";
  if (!found?.ok) return;
  const view = found.refining;
  byId("missing").hidden = view.missing.length === 0;
  renewed(byId("missing"), view.missing, () => view.missing.map((text) => part("li", "complain", text)));
  put(byId("command"), view.command);
  runs(view);
  lacking(view.lacking);
  refined(view);
}

let wasTried = "";
lookAfter((state) => {
  const wasOpen = isOpen;
  const isOk = state?.ok === true;
  if (isOk) isOpen = state.is_open; // one answer that is missed ends nothing, and no form is made anew
  for (const box of document.querySelectorAll("[data-open]")) box.hidden = !(isOk && isOpen);
  const tried = showTried(state);
  const hasEnded = showLong(state);
  if (hasEnded) look();
  const isTried = tried !== "";
  if (hasEnded || wasOpen !== isOpen || isTried !== (wasTried !== "")) lookAtOne();
  wasTried = tried;
});
shown = /^\d+$/.test(location.hash.slice(1)) ? location.hash.slice(1) : "";
look();
lookAtOne();
setInterval(look, EVERY_MS);
