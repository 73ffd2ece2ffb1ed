// Settings as a text: a field with the whole site file, and the places of which the check says something.
import { fill } from "/static/fill.js";
import { byId, part, put, words } from "/static/see.js";
import { button } from "/static/work.js";

/** What is edited, empty where it is the file's own; the file's, on which that was begun, and its SHA-256. */
export const typed = { text: "", file: "", base: "" };
const box = byId("text");

export const isText = () => !byId("text-view").hidden;

/** Show the field with a text, or the form in its place. */
export function showText(text) {
  const shows = text !== null;
  byId("text-view").hidden = !shows;
  for (const id of ["sections", "form-tools", "can"]) byId(id).hidden = shows;
  byId("as-text").ariaPressed = String(shows);
  byId("as-form").ariaPressed = String(!shows);
  if (shows && box.value !== text) box.value = text; // the same one keeps its place and its way back
  place();
}

/** Call what is to be done when somebody has typed. */
export function onTyped(done) {
  box.addEventListener("input", () => {
    typed.text = box.value === typed.file ? "" : box.value || "\n"; // an empty one is no file's
    place();
    done();
  });
}

/** What the check says of the text, each with the way to its place. */
export function saidOfText(found) {
  const rows = found.map((one) => {
    const row = part("li", "complain");
    const said = part("span", "", ` ${one.path ? `${one.path}: ` : ""}${one.text}`);
    said.lang = "en";
    if (one.line) row.append(wayTo(one.line, one.column));
    row.append(said);
    return row;
  });
  show("text-said", rows);
}

/** Lines that somebody else has changed too: what is typed here stands in them. */
export function showClashes(clashes) {
  const rows = clashes.map((one) => {
    const row = part("li", "complain");
    row.append(wayTo(one.line, 1), part("span", "", ` ${words.clash}`), part("pre", "diff", one.theirs.join("\n")));
    return row;
  });
  show("clashes", rows);
}

function show(id, rows) {
  byId(id).hidden = rows.length === 0;
  byId(id).replaceChildren(...rows);
}

const wayTo = (line, column) => button(fill(words.place, { line, column }), () => goTo(line, column));

function goTo(line, column) {
  const before = box.value.split("\n").slice(0, line - 1);
  const at = before.reduce((sum, one) => sum + one.length + 1, 0) + column - 1;
  box.focus();
  box.setSelectionRange(at, at);
  const height = parseFloat(getComputedStyle(box).lineHeight);
  box.scrollTop = Math.max(0, (line - 4) * height);
  place();
}

/** Line and column of the cursor: the check names its places so. */
function place() {
  const before = box.value.slice(0, box.selectionStart).split("\n");
  put(byId("text-at"), fill(words.place, { line: before.length, column: before.at(-1).length + 1 }));
}
for (const name of ["keyup", "click", "focus"]) box.addEventListener(name, place);
