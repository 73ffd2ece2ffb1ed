// What is half typed outlives the page: it begins anew with every start of the screen server, and
// with the end of a session. It stays in this tab, for the account that typed it, by a name that
// says what it is about, until it is sent, that account logs out in this tab, or a day has passed.
// A password is never kept.
const FIRST = "draft";
const MOST_AGE_MS = 24 * 3600 * 1000; // what is older is of another day's work
const account = document.getElementById("hand")?.dataset.account ?? "";
const names = new WeakMap(); // of what a field shows
const fields = new Map(); // that show a text now, by its name

const nameOf = (name) => `${FIRST} ${account} ${location.pathname} ${name}`;

/** A text with the time at which it was typed, taken apart; empty where it is too old. */
function young(saved) {
  const end = saved.indexOf(" ");
  const age_ms = Math.abs(Date.now() - Number(saved.slice(0, end)));
  return end > 0 && age_ms < MOST_AGE_MS ? saved.slice(end + 1) : "";
}

/** Keep a text of this page by its name; an empty one is dropped. */
export function keep(name, text) {
  if (account === "") return;
  try {
    if (text) sessionStorage.setItem(nameOf(name), `${Date.now()} ${text}`);
    else sessionStorage.removeItem(nameOf(name));
  } catch {
    // a browser that keeps nothing, or has no room: the page still has what it shows
  }
}

/** What is kept by a name, empty for nothing. */
export function kept(name) {
  if (account === "") return "";
  try {
    return young(sessionStorage.getItem(nameOf(name)) ?? "");
  } catch {
    return "";
  }
}

/** Fill a field with what was kept of it, and keep what is typed from now on.
 *  By another name the field is about something else: what it showed before is none of it. */
export function keepTyped(input, name) {
  if (input.type === "password") return;
  const before = names.get(input);
  if (before === undefined) input.addEventListener("input", () => keep(names.get(input), input.value));
  names.set(input, name);
  fields.set(name, input);
  input.value = kept(name) || (before === undefined || before === name ? input.value : "");
}

/** What was typed into a field is sent: nothing of it is kept, and the field is empty. */
export function sent(input, name) {
  keep(name, "");
  input.value = "";
}

/** A text was sent, and what it was for is done: as `sent`, for the field that shows it by now.
 *  Another text that was typed meanwhile stays. */
export function done(name, text) {
  if (kept(name) === text) keep(name, "");
  const input = fields.get(name);
  if (input?.value === text) input.value = "";
}

/** Drop what this tab keeps, all of it or what is of `isSo`. */
function drop(isSo) {
  try {
    for (const name of Object.keys(sessionStorage)) {
      if (name.startsWith(`${FIRST} `) && isSo(sessionStorage.getItem(name))) sessionStorage.removeItem(name);
    }
  } catch {
    // nothing is kept
  }
}

/** Who logs out leaves nothing behind in this tab; another tab keeps its own. */
export const dropAll = () => drop(() => true);

drop((saved) => young(saved) === "");
