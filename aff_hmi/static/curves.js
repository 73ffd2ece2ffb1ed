// How curves look wherever there are any: tone and dash both tell them apart.
import { number, part } from "/static/see.js";

const TONES = ["--now", "--medium", "--low", "--focus", "--text", "--muted"];
const DASHES = [[], [10, 4], [3, 3], [10, 3, 3, 3]];
export const css = (name) => getComputedStyle(document.documentElement).getPropertyValue(name).trim();

/** Tone and dash of the n-th curve; `dashed` belongs to the curve before it. */
export function look(n, dashed = false) {
  const dash = dashed ? [5, 5] : DASHES[Math.floor(n / 2) % DASHES.length];
  return { tone: css(TONES[(dashed ? n - 1 : n) % TONES.length] ?? "--now") || css("--now"), dash };
}

/** A number of an axis: as short as it is exact to so many digits. */
export function short(value, digits = 5) {
  const how = { maximumSignificantDigits: digits };
  return new Intl.NumberFormat(document.documentElement.lang, how).format(value);
}

/** A number to be read off: more digits the smaller it is. */
export function figure(value) {
  if (value === null || value === undefined || Number.isNaN(value)) return "—";
  const digits = Math.abs(value) >= 100 ? 1 : Math.abs(value) >= 1 ? 2 : 4;
  return number(value, digits);
}

/** One line of a legend: a sample of the curve, its name, its last value. */
export function legendLine(name, value, unit, { tone, dash }) {
  const line = part("li");
  const sample = document.createElementNS("http://www.w3.org/2000/svg", "svg");
  sample.setAttribute("viewBox", "0 0 36 8");
  sample.setAttribute("aria-hidden", "true");
  const stroke = document.createElementNS("http://www.w3.org/2000/svg", "line");
  const drawn = { x1: 0, x2: 36, y1: 4, y2: 4, stroke: tone, "stroke-width": 3 };
  if (dash.length) drawn["stroke-dasharray"] = dash.join(" ");
  for (const [key, text] of Object.entries(drawn)) stroke.setAttribute(key, String(text));
  sample.append(stroke);
  line.append(sample, part("span", "", `${name}: `));
  line.append(part("span", "number", figure(value)), ` ${unit}`);
  return line;
}

/** A row of a table; the first cell is its head. */
export function row(cells, kind = "td") {
  const made = part("tr");
  cells.forEach((text, n) => {
    const cell = part(n === 0 || kind === "th" ? "th" : kind, n ? "figure" : "", text);
    if (cell.tagName === "TH") cell.scope = kind === "th" ? "col" : "row";
    made.append(cell);
  });
  return made;
}
