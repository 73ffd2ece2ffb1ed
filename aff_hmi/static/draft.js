// What is half typed outlives the page: it begins anew with every start of the screen server, and
// with the end of a session. It stays in this tab, for the account that typed it, until it is sent
// or that account logs out by itself. A password is never kept.
const FIRST = "draft";
const account = document.getElementById("hand")?.dataset.account ?? "";

const nameOf = (name) => `${FIRST} ${account} ${location.pathname} ${name}`;

/** Keep a text of this page by its name; an empty one is dropped. */
export function keep(name, text) {
  if (account === "") return;
  try {
    if (text) sessionStorage.setItem(nameOf(name), text);
    else sessionStorage.removeItem(nameOf(name));
  } catch {
    // a browser that keeps nothing, or has no room: the page still has what it shows
  }
}

/** What is kept by a name, empty for nothing. */
export function kept(name) {
  if (account === "") return "";
  try {
    return sessionStorage.getItem(nameOf(name)) ?? "";
  } catch {
    return "";
  }
}

/** Fill a field with what was kept of it, and keep what is typed from now on. */
export function keepTyped(input, name) {
  if (input.type === "password") return;
  input.value = kept(name) || input.value;
  input.addEventListener("input", () => keep(name, input.value));
}

/** What was typed into a field is sent: nothing of it is kept, and the field is empty. */
export function sent(input, name) {
  keep(name, "");
  input.value = "";
}

/** Who logs out leaves nothing behind. */
export function dropAll() {
  try {
    for (const name of Object.keys(sessionStorage)) {
      if (name.startsWith(`${FIRST} `)) sessionStorage.removeItem(name);
    }
  } catch {
    // nothing is kept
  }
}
