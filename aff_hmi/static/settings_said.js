// What the check says of settings, and what a change of them would do.
import { diff } from "/static/diff.js";
import { part, words } from "/static/see.js";

/** What the check says, as a list; `withPath`: of which setting, too. */
export function said(list, found, withPath = false) {
  const texts = found.map((one) => (withPath && one.path ? `${one.path}: ${one.text}` : one.text));
  const text = JSON.stringify(texts);
  list.hidden = texts.length === 0;
  if (list.dataset.said === text) return;
  list.dataset.said = text;
  list.lang = "en";
  list.replaceChildren(...texts.map((one) => part("li", "complain", one)));
}

/** What would change with its units, what the check says of it, and the lines of the text. */
export function difference(one) {
  const parts = [];
  if (one.refused) parts.push(part("p", "bad", words.refused));
  if (one.changes.length) {
    const list = part("ul", "changes");
    list.append(...one.changes.map((text) => part("li", "", text)));
    parts.push(part("p", "title", words.changes), list);
  }
  if (one.said.length) {
    const list = part("ul", "said");
    said(list, one.said, true);
    parts.push(part("p", "title", words.remarks), list);
  }
  if (!one.refused && !one.changes.length && !one.lines.length) parts.push(part("p", "", words.same));
  if (one.lines.length) parts.push(diff(one.lines));
  return parts;
}
