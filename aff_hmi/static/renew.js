// Puts what a part says now in the place of what it said, and leaves what can have the keyboard:
// a button, a table that scrolls, the slider of a picture.
const STAYS = ".side, .scroll, .time, details";
const KINDS = [".angle input", "summary", ".scroll"];

/** Make an old part say what a fresh one does; the fresh one is used up. */
export function renew(old, fresh) {
  const held = KINDS.find((kind) => old.querySelector(kind) === document.activeElement);
  into(old, fresh);
  const place = held ? old.querySelector(held) : null;
  if (place !== document.activeElement) place?.focus({ preventScroll: true });
}

function into(old, fresh) {
  for (const { name, value } of fresh.attributes) {
    if (name !== "open" && old.getAttribute(name) !== value) old.setAttribute(name, value);
  }
  const [before, after] = [[...old.childNodes], [...fresh.childNodes]];
  const isAlike = before.length === after.length && before.every((one, n) => one.nodeName === after[n].nodeName);
  if (!isAlike) {
    const [was, is] = [old, fresh].map((one) => one.querySelector("details"));
    if (was && is) is.open = was.open;
    old.replaceChildren(...after);
    return;
  }
  before.forEach((one, n) => {
    const next = after[n];
    if (one.nodeType === Node.ELEMENT_NODE && one.matches(STAYS) && next.matches(STAYS)) into(one, next);
    // a summary that says the same keeps the keyboard; all else may hold data of before
    else if (one.nodeName !== "SUMMARY" || !one.isEqualNode(next)) one.replaceWith(next);
  });
}
