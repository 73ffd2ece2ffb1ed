// Settings: the site file as a form. What is edited is looked at, tried, kept or taken back.
import { row } from "/static/curves.js";
import { keep, kept, keepTyped, sent } from "/static/draft.js";
import { fill } from "/static/fill.js";
import { ask, at, byId, part, put, send, words } from "/static/see.js";
import { difference, said } from "/static/settings_said.js";
import { isText, onTyped, saidOfText, showClashes, showText, typed } from "/static/settings_text.js";
import { stamp } from "/static/stamp.js";
import { showTried } from "/static/trying.js";
import { LONG_MS, button, lookAfter, post } from "/static/work.js";

const EVERY_MS = 2000;
const DRAFT = "edits";
const edits = new Map(); // path of a setting: what is to be written
let were = new Map(); // path of a setting: what it was in the file that is edited
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
    if (one.written === "") made.placeholder = one.default; // what is typed is written into the file
  }
  made.name = one.path;
  made.value = edits.get(one.path) ?? one.written;
  made.oninput = () => {
    const value = made.value.trim();
    if (value === one.written || value === "") edits.delete(one.path);
    else edits.set(one.path, value);
    looked = null;
    keepEdits();
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
    const before = were.get(one.path);
    const isEdited = edits.has(one.path) || (typed.text !== "" && before !== one.shown);
    box.dataset.edited = isEdited ? "yes" : "no";
    const theirs = one.theirs === undefined ? "" : fill(words.theirs, { value: one.theirs });
    put(box.querySelector(".earlier"), [isEdited && before !== undefined ? fill(words.before, { value: before }) : "", theirs].filter(Boolean).join("; "));
    said(box.querySelector(".of"), warnings.filter((w) => w.path === one.path));
    const field = box.querySelector("input, select");
    const isWrong = looked?.refused === true && looked.said.some((w) => w.path === one.path);
    if (field) field.ariaInvalid = String(isWrong);
  }
  said(byId("said"), shown.said.filter((w) => !known.has(w.path)), true);
  byId("difference").hidden = looked === null;
  let way = "";
  if (looked?.refused === false && looked.lines.length) way = looked.changes.length && !looked.waits ? "try" : "save";
  for (const name of ["try", "save"]) byId(name).dataset.ready = name === way ? "yes" : "no";
  const count = edits.size ? fill(words.edited, { count: edits.size }) : "";
  put(byId("count"), [typed.text ? words.textEdited : "", count].filter(Boolean).join("; "));
  document.querySelector("[data-edit]").hidden = !isPending();
  openings();
}

/** What needs an opened commissioner, and an answer that is fresh. */
function openings() {
  const isFresh = document.documentElement.dataset.settings === "shown";
  const isSame = shown !== null && view.sha256 === base();
  for (const name of ["try", "save"]) {
    const isReady = byId(name).dataset.ready === "yes";
    byId(name).hidden = !(isOpen && isFresh && isSame && isReady);
  }
  byId("back").hidden = !(isOpen && isFresh && byId("back").dataset.ready === "yes");
  byId("changed").hidden = isSame || !isPending();
  for (const id of ["as-form", "as-text"]) byId(id).disabled = !isFresh;
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

const isPending = () => edits.size > 0 || typed.text !== "";
const lines = () => [...edits].map(([path, value]) => `${path}: ${value}`).join("\n");

/** Of what is edited: a text is of the file that it came with, whatever has been told since. */
const base = () => (typed.text ? typed.base : shown.sha256);
const edit = () => ({ base: base(), edits: lines(), text: typed.text });

/** Ask about what is edited; null where that failed, or something was edited meanwhile. */
async function answered(path, asked) {
  const before = JSON.stringify(edit());
  put(byId("work-said"), words.sent);
  const answer = await send(path, asked, LONG_MS);
  put(byId("work-said"), answer.ok ? "" : answer.text);
  return answer.ok && before === JSON.stringify(edit()) ? answer : null;
}

byId("edit").onsubmit = async (event) => {
  event.preventDefault();
  const answer = await answered("/settings/diff", edit());
  if (answer === null) return;
  looked = answer.difference;
  byId("changes").replaceChildren(...difference(looked));
  saidOfText(looked.said);
  mark();
  byId("difference-title").focus();
};
byId("try").onsubmit = (event) => {
  event.preventDefault();
  const asked = { ...edit(), measured: looked.sha256 };
  sendWith("try-why", "/settings/try", { ...asked, seconds: Number(byId("try-seconds").value) });
};
byId("save").onsubmit = (event) => {
  event.preventDefault();
  const asked = { ...edit(), measured: looked.sha256 };
  sendWith("save-why", "/settings/save", asked);
};
byId("drop").onclick = () => {
  dropEdits();
  take();
};
byId("rebase").onclick = async () => {
  if (typed.text !== "") return rebaseText();
  const all = settingsOf(view);
  for (const one of all) {
    const before = were.get(one.path);
    if (before !== undefined && before !== one.shown) one.theirs = before;
  }
  dropDone(all);
  take();
};

/** Send what needs a reason; the reason is kept until it was taken. */
async function sendWith(why, path, asked) {
  const reason = byId(why);
  const answer = await post(path, { ...asked, reason: reason.value });
  if (answer.ok) sent(reason, why);
}

/** Edit on as a text with the form's edits in it, or as the form of what was typed. */
async function turn(asText) {
  const answer = await answered("/settings/text", { ...edit(), former: "" });
  if (answer !== null) edited(answer.edited, asText);
}

function edited(now, asText) {
  Object.assign(typed, { text: now.text === now.file ? "" : now.text, file: now.file, base: now.base });
  edits.clear();
  looked = null;
  const isGood = now.sections.length > 0;
  if (isGood) shown = { ...shown, sections: now.sections, said: now.said };
  else if (!asText) put(byId("work-said"), words.textFirst);
  saidOfText(now.said);
  showClashes(now.clashes);
  showText(asText || !isGood ? now.text : null);
  keepEdits();
  form();
}

/** Put what is typed onto the text that somebody else has saved since. */
async function rebaseText() {
  const [now, text] = [view, { ...edit(), base: view.sha256, former: typed.file }];
  const answer = await answered("/settings/text", text);
  if (answer === null) return;
  shown = now;
  remember();
  edited(answer.edited, true);
}

byId("as-form").onclick = () => isText() && turn(false);
byId("as-text").onclick = () => isText() || turn(true);
onTyped(() => {
  looked = null;
  keepEdits();
  mark();
});

function dropEdits() {
  edits.clear();
  typed.text = "";
}

const settingsOf = (told) => told.sections.flatMap((section) => section.settings);

/** Drop the edits that the file says already, or has no place for. */
function dropDone(all) {
  for (const one of all) {
    if (edits.get(one.path) === one.written || !one.can_edit) edits.delete(one.path);
  }
}

/** Edit the newest from now on. */
function take() {
  shown = view;
  looked = null;
  remember();
  keepEdits();
  form();
  if (isText()) turn(true);
}

/** Remember what the file says, for what is edited from now on. */
function remember() {
  were = new Map(settingsOf(shown).map((one) => [one.path, one.shown]));
}

/** Keep what is edited, with the text that it was begun on, for a page that begins anew. */
function keepEdits() {
  const all = { ...typed, base: base(), were: [...were], edits: [...edits] };
  keep(DRAFT, isPending() ? JSON.stringify(all) : "");
}

/** Edit on with what was kept, on the text that it was begun on: another one by now is noticed. */
function takeUp() {
  const found = JSON.parse(kept(DRAFT) || "null");
  for (const [path, value] of found?.edits ?? []) edits.set(path, value);
  if (found !== null && found.base !== view.sha256) dropDone(settingsOf(view)); // kept meanwhile
  if (found !== null) Object.assign(typed, { text: found.text, file: found.file, base: found.base });
  if (!isPending()) return take();
  shown = { ...view, sha256: found.base };
  were = new Map(found.were);
  if (typed.text !== "") showText(typed.text);
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
    ready: back !== null && !back.refused && back.lines.length ? "yes" : "no",
    measured: back?.sha256 ?? "",
    base: running, // of what the difference is against, and not of what runs by now
  });
  openings();
  if (focuses) byId("version-title").focus();
}

byId("back").onsubmit = (event) => {
  event.preventDefault();
  const { base, measured } = byId("back").dataset;
  sendWith("back-why", "/settings/back", { number: openVersion, base, measured });
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
  if (looked !== null && !looked.refused && now.sha256 === looked.sha256) dropEdits(); // kept
  if (shown === null) takeUp();
  const newest = now.versions.find((one) => one.sha256 === now.sha256);
  let text = words.savedByNobody;
  if (newest) {
    const named = { number: newest.number, verb: newest.verb_word, who: newest.who };
    text = fill(words.saved, { ...named, time: when(newest) });
  }
  put(byId("changed-said"), text);
  const of = (one) => JSON.stringify([one.sections, one.said, one.sha256]);
  const isSame = shown !== null && of(shown) === of(now);
  if (!isSame && !isPending()) take();
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
for (const why of ["try-why", "save-why", "back-why"]) keepTyped(byId(why), why);
look();
setInterval(look, EVERY_MS);
