// One refinement: what was found, the figures before and after, what to do, what can be tried.
import { done, keepTyped } from "/static/draft.js";
import { row, short } from "/static/curves.js";
import { diff } from "/static/diff.js";
import { number, part, words } from "/static/see.js";
import { field, post, whenDone } from "/static/work.js";

const root = document.documentElement;

function table(heads, rows) {
  const made = part("table", "wide");
  made.append(row(heads, "th"), ...rows);
  const box = part("div", "scroll");
  box.tabIndex = 0;
  box.append(made);
  return box;
}

const english = (tag, kind, text) => {
  const made = part(tag, kind, text);
  made.lang = "en";
  return made;
};

function list(title, texts, language = root.lang) {
  if (!texts.length) return [];
  const made = part("ul");
  made.lang = language;
  made.append(...texts.map((text) => part("li", "", text)));
  return [part("p", "title", title), made];
}

function effect(one) {
  const box = part("div", "effect");
  const others = one.others.length ? ` (${words.others} ${one.others.join(", ")})` : "";
  box.append(part("h4", "", `${one.place}${others}`), part("p", "note", one.text));
  const rows = one.numbers.map((n) => {
    const interval = n.low ? `${n.low} – ${n.high}` : words.assumed;
    return row([n.name, `${n.value} ${n.unit}`.trim(), interval]);
  });
  box.append(table([words.name, words.value, words.interval], rows));
  box.append(part("p", "", one.can_cancel ? words.cancel : words.noCancel));
  box.append(...list(words.do, [one.to_do]), ...list(words.tell, one.experiments, "en"));
  return box;
}

function errors(summary) {
  const title = (summary.held_out ? words.held : words.fitted).replace("{name}", summary.judged_on);
  const rows = summary.errors.map((e) => {
    const ratio = e.floor > 0 ? e.after / e.floor : NaN;
    const cells = [e.channel, e.before, e.after, e.floor].map((v, n) => (n ? `${short(v, 3)} ${e.unit}` : v));
    const made = row([...cells, Number.isFinite(ratio) ? number(ratio, 2) : "—"]);
    if (ratio >= 1.1) made.className = "failed";
    return made;
  });
  const heads = [words.channel, words.before, words.after, words.floor, words.ratio];
  return [part("p", "title", title), table(heads, rows)];
}

function trying(one, proposal) {
  const form = part("form", "measure");
  form.id = "try-refined";
  const why = field(words.why, "reason", { maxLength: 200, minLength: 8, required: true });
  const seconds = field(words.for, "seconds", { type: "number", min: 5, max: 3600, value: 120, required: true });
  const go = part("button", "", words.try);
  go.dataset.may = "try";
  go.type = "submit";
  const line = part("p", "fields");
  line.append(why.box, seconds.box, go);
  form.append(part("p", "note", words.hand), line);
  const draft = `try ${proposal.sha256}`;
  keepTyped(why.input, draft);
  form.onsubmit = async (event) => {
    event.preventDefault();
    const said = { number: one.number, measured: proposal.sha256, reason: why.input.value };
    const answer = await post("/refine/try", { ...said, seconds: Number(seconds.input.value) });
    if (answer.ok) whenDone("try_refined", -1, () => done(draft, said.reason));
  };
  return form;
}

function proposed(one, proposal, isOpen) {
  const box = part("div", "proposal");
  box.id = "proposal";
  box.append(part("h4", "", words.proposed));
  if (proposal.against) box.append(part("p", "bad", proposal.against));
  box.append(...list(words.changes, proposal.changes, "en"), ...list(words.remarks, proposal.remarks, "en"));
  box.append(diff(proposal.lines));
  if (isOpen && !proposal.against) box.append(trying(one, proposal));
  return box;
}

/** The parts of one refinement; without a verdict why there is none. */
export function showVerdict(one, summary, proposal, command, isOpen) {
  const again = [part("p", "note", words.again), english("code", "", command)];
  if (summary === null) return [english("p", "bad", one.text || one.means), ...again];
  const page = part("a", "button", words.page);
  page.href = `/data/refined.html?number=${one.number}&lang=${root.lang}`;
  const buttons = part("p", "buttons");
  buttons.append(page);
  return [
    part("p", "asked", summary.headline),
    ...list(words.next, [summary.next_step]),
    ...summary.effects.map(effect),
    ...list(words.unknown, summary.unknown),
    ...errors(summary),
    part("p", "note", summary.gain),
    ...(summary.sure ? [part("p", "note", summary.sure)] : []),
    ...list(words.limits, summary.limits),
    ...list(words.site, summary.site_said, "en"),
    ...(proposal ? [proposed(one, proposal, isOpen)] : []),
    buttons,
    ...again,
  ];
}
