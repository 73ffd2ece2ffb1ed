// A box over the page. It makes nothing else inert: the bypass at the lower edge stays one press.

let opener = null;

export const isOpen = () => document.querySelector("dialog[open]") !== null;

/** Show a box, with its first field in focus; who closes it is back where he was. */
export function openBox(box) {
  if (isOpen()) return;
  opener = document.activeElement;
  box.show();
  (box.querySelector("input, select") ?? box.querySelector("button")).focus();
}

/** Whether what is pressed on a key is text for a field, and no command to the page. */
export function isText(event) {
  const { target } = event;
  const kind = target.closest?.("input, select, textarea, [contenteditable]");
  const isPointed = ["checkbox", "radio", "range"].includes(kind?.type);
  return event.isComposing || (kind !== null && kind !== undefined && !isPointed);
}

for (const box of document.querySelectorAll("dialog")) box.onclose = () => opener?.focus();
document.addEventListener("keydown", (event) => {
  if (event.key === "Escape") document.querySelector("dialog[open]")?.close();
});
