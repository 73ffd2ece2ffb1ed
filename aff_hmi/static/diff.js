// The lines in which two texts differ, as the unified form has them.
import { part } from "/static/see.js";

export function diff(lines) {
  const text = part("pre", "diff scroll");
  text.tabIndex = 0;
  text.append(
    ...lines.map((line) => {
      const kind = line.startsWith("+") ? "plus" : line.startsWith("-") ? "minus" : "";
      return part("span", kind, `${line}\n`);
    }),
  );
  return text;
}
