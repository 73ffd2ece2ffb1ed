// The commissioning card: every step with its figures, what it waits for, and its signature.
import { done, keepTyped } from "/static/draft.js";
import { ask, byId, number, part, put, words } from "/static/see.js";
import { showTried } from "/static/trying.js";
import { LONG_MS, act, button, field, lookAfter, post, whenDone } from "/static/work.js";

const EVERY_MS = 2500;
let isOpen = false;
let isBusy = false;

// --- what a step says --------------------------------------------------------------------------

/** A list with its title; `language` where its texts are in another one than the page. */
function listed(title, texts, language = "") {
  if (!texts.length) return [];
  const list = part("ul");
  if (language) list.lang = language;
  list.append(...texts.map((text) => part("li", "", text)));
  return [part("p", "title", `${title}:`), list];
}

function figures(rows) {
  if (!rows.length) return [];
  const table = part("table", "wide");
  const head = part("tr");
  const heads = [words.figure, words.value, words.span, words.limit, ""];
  head.append(...heads.map((text) => part("th", "", text)));
  const body = rows.map((one) => {
    const row = part("tr", one.good === false ? "failed" : "");
    const mark = one.good === null ? "" : one.good ? "✓" : "✗";
    row.append(part("td", "", one.name), part("td", "figure", one.value));
    row.append(part("td", "figure", one.span), part("td", "", one.limit), part("td", "mark", mark));
    return row;
  });
  const told = part("tbody");
  told.lang = "en"; // as on the card; the heads are the page's own
  told.append(...body);
  table.append(part("thead"), told);
  table.tHead.append(head);
  const box = part("div", "scroll");
  box.tabIndex = 0;
  box.append(table);
  return [box];
}

function windows(rows) {
  const texts = rows.flatMap((one) => [
    `${one.folder}, ${number(one.from_s, 2)} s – ${number(one.to_s, 2)} s`,
    ...one.segments.map((s) => `${s.name}, ${s.size} B, SHA-256 ${s.sha256}`),
  ]);
  return listed(words.window, texts);
}

function entry(step) {
  const one = step.entry;
  if (one === null) return [];
  const made = words.entry.replace("{number}", one.number).replace("{utc}", one.utc);
  const said = part("p", "note", made.replace("{by}", one.by));
  const hash = part("p", "note hash", `SHA-256 ${one.sha256}`);
  const earlier = step.earlier ? [part("p", "note", words.earlier.replace("{count}", step.earlier))] : [];
  return [
    ...listed(words.again, step.why),
    ...listed(words.reason, one.reason ? [one.reason] : []),
    ...figures(one.figures),
    ...listed(words.missing, one.waits_for, "en"),
    ...listed(words.proposed, one.proposals, "en"),
    ...listed(words.remarks, one.remarks, "en"),
    ...listed(words.typed, one.typed),
    ...windows(one.windows),
    said,
    hash,
    ...earlier,
    ...signature(step),
  ];
}

function signature(step) {
  const one = step.signed;
  if (one === null) return [part("p", "title", words.unsigned)];
  const said = words.signed.replace("{utc}", one.utc).replace("{name}", one.name);
  const more = part("p", "note hash", `${one.by} · SHA-256 ${one.sha256}`);
  return [part("p", "title", `✓ ${said}: ${one.reason}`), more];
}

// --- what can be done with a step --------------------------------------------------------------

/** Keep what is typed into the fields of a form, `about` what it is. Returns what takes note of
 *  what is sent now, and gives what drops that once it is done. */
function keepForm(name, about, fields) {
  const named = fields.map(({ input }) => [input, `${name} ${about} ${input.name}`]);
  for (const [input, draft] of named) keepTyped(input, draft);
  return () => {
    const texts = named.map(([input, draft]) => [draft, input.value]);
    return () => texts.forEach(([draft, text]) => done(draft, text));
  };
}

/** How long the parts of the proof take, at the speed of now. */
function proofTimes(proof) {
  const { off_s, on_s } = proof ?? {};
  return proof ? words.off.replace("{off}", number(off_s, 0)).replace("{on}", number(on_s, 0)) : "";
}

function measuring(step, card) {
  const form = part("form", "measure");
  const boxes = step.typed_names.map((name, n) => field(step.typed_labels[n], name, { maxLength: 80 }));
  const plc = field(words.plc, "plc", { maxLength: 80 });
  const hints = [];
  if (step.seconds) hints.push(words.look.replace("{seconds}", number(step.seconds, 0)));
  if (boxes.length) hints.push(words.display);
  const fields = part("p", "fields");
  fields.append(...boxes.map((one) => one.box), plc.box);
  const why = field(words.why, "leave", { maxLength: 500 });
  const about = `${card.first} ${step.number}`;
  const measured = keepForm("measure", about, [...boxes, plc]);
  const left = keepForm("leave", about, [why]);
  const typed = () =>
    boxes.filter((one) => one.input.value.trim()).map((one) => `${one.input.name}=${one.input.value.trim()}`);
  const send = async (leave_out) => {
    const said = { step: step.number, typed: leave_out ? "" : typed().join("\n") };
    const drop = leave_out ? left() : measured();
    const answer = await post("/card/step", { ...said, plc: plc.input.value, leave_out });
    if (answer.ok) whenDone("step", step.number, drop);
  };
  const go = part("button", "", words.measure);
  go.type = "submit";
  form.onsubmit = (event) => {
    event.preventDefault();
    send("");
  };
  const leave = button(words.leave, () => send(why.input.value || " "));
  const row = part("p", "fields");
  row.append(why.box, leave);
  form.append(...hints.map((text) => part("p", "note", text)));
  if (step.number === 12) form.append(part("p", "note times", proofTimes(card.proof)));
  form.append(fields, go, row);
  return form;
}

function signing(step) {
  const form = part("form", "signing");
  const why = field(words.why, "reason", { maxLength: 500, minLength: 8, required: true });
  const more = { type: "password", autocomplete: "current-password", required: true, maxLength: 256 };
  const password = field(words.password, "password", more);
  const go = part("button", "", words.sign);
  go.type = "submit";
  const row = part("p", "fields");
  row.append(why.box, password.box, go);
  const name = document.createElement("input"); // a password of whom, for keepers of passwords
  Object.assign(name, { type: "text", autocomplete: "username", hidden: true });
  name.value = byId("hand")?.dataset.account ?? "";
  form.append(part("p", "note", words.seen), name, row);
  const signed = keepForm("sign", step.entry.sha256, [why]);
  form.onsubmit = async (event) => {
    event.preventDefault();
    const said = { step: step.number, measured: step.entry.sha256, reason: why.input.value };
    const drop = signed();
    const answer = await post("/card/sign", { ...said, password: password.input.value });
    password.input.value = "";
    if (answer.ok) drop(); // the answer is that of the job
    look();
  };
  return form;
}

function trying(step) {
  const form = part("form", "trying");
  const why = field(words.why, "reason", { maxLength: 200, minLength: 8, required: true });
  const seconds = field(words.for, "seconds", { type: "number", min: 5, max: 3600, value: 120, required: true });
  const go = part("button", "", words.try);
  go.type = "submit";
  go.dataset.may = "try";
  const row = part("p", "fields");
  row.append(why.box, seconds.box, go);
  form.append(row);
  const tried = keepForm("try", step.entry.sha256, [why]);
  form.onsubmit = async (event) => {
    event.preventDefault();
    const said = { do: "try", step: step.number, measured: step.entry.sha256, reason: why.input.value };
    const drop = tried();
    const answer = await post("/card/settings", { ...said, seconds: Number(seconds.input.value) });
    if (answer.ok) whenDone("try", step.number, drop);
  };
  return form;
}

function stepped(step, card, old) {
  const box = part("details", "step");
  box.dataset.step = step.number;
  box.dataset.stand = step.stand;
  box.open = old?.open ?? false;
  const head = part("summary");
  const title = part("span", "what");
  title.append(part("span", "figure", `${step.number}.`), " ", part("strong", "", step.title));
  head.append(title, part("span", "stand", `${step.mark} ${step.stand_word}`));
  const signed = step.signed ? `✓ ${step.signed.name}` : step.entry ? words.unsigned : "";
  head.append(part("span", "by", signed));
  const about = `${words.measured}: ${step.measured}; ${words.good}: ${step.limit}`;
  box.append(head, part("p", "note", about), ...entry(step));
  if (isOpen) {
    if (step.can_sign && step.entry) box.append(signing(step));
    if (step.entry?.proposals.length) box.append(trying(step));
    box.append(measuring(step, card));
  }
  return box;
}

// --- the card ----------------------------------------------------------------------------------

const rows = new Map();
let linked = location.hash.slice(1); // the step that a link has asked for

/** Open the step of a link, once it is there. */
function openLinked() {
  const wanted = rows.get(Number(linked));
  if (!linked || !wanted) return;
  linked = "";
  wanted.box.open = true;
  wanted.box.querySelector("summary").focus();
}

addEventListener("hashchange", () => {
  linked = location.hash.slice(1);
  openLinked();
});

function show(answer) {
  const card = answer?.ok ? answer.card : null;
  byId("card").hidden = card === null;
  put(byId("card-said"), answer === null ? words.failed : answer.ok ? "" : answer.text);
  byId("begin").hidden = card !== null || !isOpen || answer === null;
  if (card === null) return;
  put(byId("card-line"), card.line);
  put(byId("card-newest"), `${card.entries}, ${card.utc}`);
  put(byId("card-hash"), card.newest);
  listing(byId("card-remarks"), card.remarks);
  listing(byId("undone"), card.undone.length ? card.undone : [words.holds]);
  for (const step of card.steps) {
    const said = JSON.stringify([step, isOpen, card.first]);
    const old = rows.get(step.number);
    if (old?.said === said) continue;
    const made = stepped(step, card, old?.box);
    if (old) old.box.replaceWith(made);
    else byId("steps").append(made);
    rows.set(step.number, { said, box: made });
  }
  put(document.querySelector(".times"), proofTimes(card.proof)); // in place: a form is half typed
  openLinked();
}

function listing(list, texts) {
  const said = JSON.stringify(texts);
  if (list.dataset.said === said) return;
  list.dataset.said = said;
  list.replaceChildren(...texts.map((text) => part("li", "", text)));
}

let isAsking = false;
async function look() {
  if (isAsking || document.hidden) return;
  isAsking = true;
  const answer = await ask("/data/card", {}, LONG_MS);
  isAsking = false;
  document.documentElement.dataset.card = answer?.ok ? "shown" : "none";
  show(answer);
}

lookAfter((state) => {
  const wasBusy = isBusy;
  const wasOpen = isOpen;
  const isOk = state?.ok === true;
  isBusy = isOk && state.job !== null;
  if (isOk) isOpen = state.is_open; // one answer that is missed empties no form
  for (const one of document.querySelectorAll("#steps form button:not([data-may])")) one.disabled = !isOk;
  if ((wasBusy && !isBusy) || wasOpen !== isOpen) look();
  showTried(state);
});
look();
setInterval(look, EVERY_MS);
byId("begin").onclick = () => act("begin");
byId("verify").onclick = () => act("verify");
byId("print").onclick = () => window.print();
// on paper every step that has something to say is open
let wereOpen = [];
addEventListener("beforeprint", () => {
  wereOpen = [...document.querySelectorAll("details.step")].map((one) => [one, one.open]);
  for (const [one] of wereOpen) one.open = one.dataset.stand !== "not measured";
});
addEventListener("afterprint", () => wereOpen.forEach(([one, open]) => (one.open = open)));
