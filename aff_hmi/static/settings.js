// Settings: the site file as a form. What is edited is looked at, tried, kept or taken back.
import { row } from "/static/curves.js";
import { fill } from "/static/fill.js";
import { ask, at, byId, part, put, send, words } from "/static/see.js";
import { difference, said } from "/static/settings_said.js";
import { stamp } from "/static/stamp.js";
import { showTried } from "/static/trying.js";
import { LONG_MS, button, lookAfter, post } from "/static/work.js";

const EVERY_MS = 2000;
const edits = new Map(); // path of a setting: what is to be written
let view = null; // the newest that was told
let shown = null; // the one that is edited
let looked = null; // what the edits would do
let isOpen = false;
let openVersion = 0;

// --- the form ----------------------------------------------------------------------------------

function input(one) {
  const isChoice = one.choices.length > 0;
  const made = document.createElement(isChoice ? "select" : "input");
  if (isChoice) {
    const written = one.choices.includes(one.written) ? [] : [one.written];
    const named = (text) => new Option(text || fill(words.default, { value: one.default }), text);
    made.append(...[...written, ...one.choices].map(named));
  } else {
    Object.assign(made, { type: "text", maxLength: 80, autocomplete: "off", spellcheck: false });
    if (one.written === "") made.placeholder = one.default; // left to it: what is typed is written into the file
  }
  made.name = one.path;
  made.value = edits.get(one.path) ?? one.written;
  made.oninput = () => {
    const value = made.value.trim();
    if (value === one.written || value === "") edits.delete(one.path);
    else edits.set(one.path, value);
    looked = null;
    mark();
  };
  return made;
}

/** What can be tried stands first; what takes effect at the next bypass is shown on demand. */
const canTry = (one) => one.can_edit && one.live;

function setting(one, roll) {
  const box = part("div", "setting");
  Object.assign(box.dataset, { path: one.path, can: canTry(one) ? "yes" : "no", waits: one.live ? "no" : "yes" });
  box.dataset.kind = one.kind;
  box.dataset.words = `${one.path} ${roll} ${one.help}`.toLowerCase();
  if (one.can_edit) {
    const label = part("label", "name", `${one.name}${one.unit ? `, ${one.unit}` : ""} `);
    label.append(input(one));
    box.append(label);
  } else {
    const line = part("p");
    line.append(part("span", "name", `${one.name}: `), part("span", "value", one.shown));
    box.append(line);
  }
  const facts = [one.kind_word, one.allowed && fill(words.allowed, { range: one.allowed })];
  facts.push(fill(words.default, { value: one.default }));
  const help = part("p", "", one.help);
  if (one.is_english) help.lang = "en";
  box.append(help, part("p", "note", facts.filter(Boolean).join("; ")), part("p", "note does", one.does));
  box.append(part("p", "note earlier"), part("ul", "said of"));
  return box;
}

function form() {
  byId("sections").replaceChildren(
    ...shown.sections.map((section) => {
      const box = document.createElement("details");
      box.open = section.settings.some(canTry);
      const of = section.roll ? `, ${fill(words.ofRoll, { name: section.roll })}` : "";
      const settings = section.settings.map((one) => setting(one, section.roll));
      box.append(part("summary", "", `${section.path || "·"}${of}`), ...settings);
      return box;
    }),
  );
  const all = shown.sections.flatMap((section) => section.settings);
  const saved = all.filter((one) => one.can_edit && !one.live).length;
  put(byId("can"), fill(words.can, { count: all.filter(canTry).length, saved, all: all.length }));
  mark();
  filter();
}

/** Say of every setting what was edited, and what the check says of it. */
function mark() {
  const warnings = looked === null ? shown.said : [...shown.said, ...looked.said];
  const known = new Map(shown.sections.flatMap((s) => s.settings.map((one) => [one.path, one])));
  for (const box of document.querySelectorAll(".setting")) {
    const one = known.get(box.dataset.path);
    const isEdited = edits.has(one.path);
    box.dataset.edited = isEdited ? "yes" : "no";
    const theirs = one.theirs === undefined ? "" : fill(words.theirs, { value: one.theirs });
    put(box.querySelector(".earlier"), [isEdited ? fill(words.before, { value: one.shown }) : "", theirs].filter(Boolean).join("; "));
    said(box.querySelector(".of"), warnings.filter((w) => w.path === one.path));
    const field = box.querySelector("input, select");
    const isWrong = looked?.refused === true && looked.said.some((w) => w.path === one.path);
    if (field) field.ariaInvalid = String(isWrong);
  }
  said(byId("said"), shown.said.filter((w) => !known.has(w.path)), true);
  byId("difference").hidden = looked === null;
  const isGood = looked !== null && !looked.refused && looked.changes.length > 0;
  byId("try").dataset.ready = isGood && !looked.waits ? "yes" : "no";
  byId("save").dataset.ready = isGood && looked.waits ? "yes" : "no";
  put(byId("count"), edits.size ? fill(words.edited, { count: edits.size }) : "");
  document.querySelector("[data-edit]").hidden = edits.size === 0;
  openings();
}

/** What needs an opened commissioner, and an answer that is fresh. */
function openings() {
  const isFresh = document.documentElement.dataset.settings === "shown";
  const isSame = view !== null && shown !== null && view.sha256 === shown.sha256;
  for (const name of ["try", "save"]) {
    const isReady = byId(name).dataset.ready === "yes";
    byId(name).hidden = !(isOpen && isFresh && isSame && isReady);
  }
  byId("back").hidden = !(isOpen && isFresh && byId("back").dataset.ready === "yes");
  byId("changed").hidden = isSame || edits.size === 0;
  byId("edit").querySelector("[type=submit]").disabled = !(isFresh && isSame);
}

function filter() {
  const wanted = byId("find").value.trim().toLowerCase();
  const all = byId("all").checked;
  for (const section of byId("sections").children) {
    let count = 0;
    for (const box of section.querySelectorAll(".setting")) {
      box.hidden = !(all || box.dataset.can === "yes") || !box.dataset.words.includes(wanted);
      count += box.hidden ? 0 : 1;
    }
    section.hidden = count === 0;
    if (wanted && count) section.open = true;
  }
}
byId("find").oninput = filter;
byId("all").onchange = filter;

// --- edits -------------------------------------------------------------------------------------

const lines = () => [...edits].map(([path, value]) => `${path}: ${value}`).join("\n");

byId("edit").onsubmit = async (event) => {
  event.preventDefault();
  put(byId("work-said"), words.sent);
  const asked = { base: shown.sha256, edits: lines() };
  const answer = await send("/settings/diff", asked, LONG_MS);
  put(byId("work-said"), answer.ok ? "" : answer.text);
  if (!answer.ok || asked.edits !== lines()) return;
  looked = answer.difference;
  byId("changes").replaceChildren(...difference(looked));
  mark();
  byId("difference-title").focus();
};
byId("try").onsubmit = (event) => {
  event.preventDefault();
  const asked = { base: shown.sha256, edits: lines(), measured: looked.sha256 };
  post("/settings/try", { ...asked, seconds: Number(byId("try-seconds").value), reason: byId("try-why").value });
};
byId("save").onsubmit = (event) => {
  event.preventDefault();
  const asked = { base: shown.sha256, edits: lines(), measured: looked.sha256 };
  post("/settings/save", { ...asked, reason: byId("save-why").value });
};
byId("drop").onclick = () => {
  edits.clear();
  take();
};
byId("rebase").onclick = () => {
  const former = new Map(shown.sections.flatMap((s) => s.settings.map((one) => [one.path, one])));
  for (const one of view.sections.flatMap((section) => section.settings)) {
    const before = former.get(one.path);
    if (before && before.shown !== one.shown) one.theirs = before.shown;
    if (edits.get(one.path) === one.written || !one.can_edit) edits.delete(one.path);
  }
  take();
};

/** Edit the newest from now on. */
function take() {
  shown = view;
  looked = null;
  form();
}

// --- versions ----------------------------------------------------------------------------------

const when = (one) => at(Date.parse(one.when) / 1000);

function versions() {
  const box = byId("versions");
  const text = JSON.stringify(view.versions);
  if (box.dataset.said === text) return;
  box.dataset.said = text;
  box.replaceChildren(
    row([words.number, words.when, words.what, words.who, words.why, ""], "th"),
    ...view.versions.map((one) => {
      const made = row([String(one.number), when(one), one.verb_word, one.who, one.why]);
      const cell = part("td");
      const open = button(words.open, () => show(one.number));
      open.setAttribute("aria-label", `${words.open}: ${one.number}`);
      cell.append(open);
      made.append(cell);
      return made;
    }),
  );
}

async function show(number, focuses = true) {
  openVersion = number;
  const found = await ask("/data/settings/version", { number }, LONG_MS);
  if (number !== openVersion) return;
  byId("version").hidden = false;
  byId("back").dataset.ready = "no";
  if (!found?.ok) {
    put(byId("version-title"), found?.text ?? words.failed);
    for (const name of ["version-lines", "back-changes"]) byId(name).replaceChildren();
    openings();
    return;
  }
  const { version, lines: text, back, running, against } = found.version;
  const named = { number: version.number, verb: version.verb_word, who: version.who };
  put(byId("version-title"), fill(words.version, named));
  put(byId("version-of"), [when(version), version.why].filter(Boolean).join(": "));
  byId("version-lines").replaceChildren(...difference({ changes: [], said: [], lines: text, refused: false }));
  put(byId("version-against"), against);
  byId("version-back").hidden = back === null;
  byId("back-changes").replaceChildren(...(back ? difference(back) : []));
  Object.assign(byId("back").dataset, {
    ready: back !== null && !back.refused && back.lines.length ? "yes" : "no", // a comment may be all
    measured: back?.sha256 ?? "",
    base: running, // of what the difference is against, and not of what runs by now
  });
  openings();
  if (focuses) byId("version-title").focus();
}

byId("back").onsubmit = (event) => {
  event.preventDefault();
  const { base, measured } = byId("back").dataset;
  post("/settings/back", { number: openVersion, base, measured, reason: byId("back-why").value });
};

// --- looking -----------------------------------------------------------------------------------

let isAsking = false;
async function look() {
  if (isAsking || document.hidden) return;
  isAsking = true;
  const found = await ask("/data/settings", {}, LONG_MS);
  isAsking = false;
  stamp(found?.ok === true);
  document.documentElement.dataset.settings = found?.ok ? "shown" : "none";
  for (const one of document.querySelectorAll("section.settings")) one.classList.toggle("old", !found?.ok);
  if (found?.ok) told(found.settings);
  else if (shown !== null) openings();
}

function told(now) {
  const wasRunning = view?.running;
  view = now;
  put(byId("site"), now.site);
  byId("against").hidden = now.against === "";
  put(byId("against"), now.against);
  if (looked !== null && now.sha256 === looked.sha256) edits.clear(); // kept
  const newest = now.versions.find((one) => one.sha256 === now.sha256);
  let text = words.savedByNobody;
  if (newest) {
    const named = { number: newest.number, verb: newest.verb_word, who: newest.who };
    text = fill(words.saved, { ...named, time: when(newest) });
  }
  put(byId("changed-said"), text);
  const isSame = shown !== null && JSON.stringify([shown.sections, shown.said, shown.sha256]) === JSON.stringify([now.sections, now.said, now.sha256]);
  if (!isSame && (shown === null || edits.size === 0)) take();
  versions();
  openings();
  if (openVersion && wasRunning !== undefined && wasRunning !== now.running) show(openVersion, false);
}

let wasBusy = false;
let wasTried = "";
lookAfter((state) => {
  const wasOpen = isOpen;
  isOpen = state?.ok === true && state.is_open;
  const isTried = showTried(state) !== "";
  const isBusy = state?.ok === true && state.job !== null;
  if (wasOpen !== isOpen && shown !== null) openings();
  if (wasBusy && !isBusy) look();
  if (openVersion && isTried !== wasTried) show(openVersion, false);
  [wasBusy, wasTried] = [isBusy, isTried];
});
look();
setInterval(look, EVERY_MS);
