// The picture of a roll over its angle, and a cursor that reads angle and deviation off it.
import { number, part, put, words } from "/static/see.js";
import { digitsOf, inUnit, unitName } from "/static/units.js";

const SVG = "http://www.w3.org/2000/svg";
const SIDE = 320;
const ROUND = 78; // radius of the round roll, and the room that the largest deviation has: pixels
const ROOM = 42;
const MIDDLE = SIDE / 2;
const cursors = new Map(); // angle by roll: it stays where it is when the picture is drawn anew

export const SHAPE = "mm of shape";

/** A number with its unit, in the reader's. */
export function said(value, digits, unit) {
  return `${number(inUnit(value, unit), digitsOf(digits, unit))} ${unitName(unit)}`;
}

export function signed(mm, digits = 2) {
  return `${mm > 0 ? "+" : ""}${said(mm, digits, SHAPE)}`;
}

/** Highest and lowest place in words. */
export function extremes(roll) {
  const [high, low] = [signed(roll.high_mm ?? 0), signed(roll.low_mm ?? 0)];
  return roll.extremes.replace("{high}", high).replace("{low}", low);
}

export function shape(tag, attributes, text) {
  const made = document.createElementNS(SVG, tag);
  for (const [name, value] of Object.entries(attributes)) made.setAttribute(name, String(value));
  if (text !== undefined) made.textContent = text;
  return made;
}

/** The picture and its cursor. */
export function polar(roll) {
  const size = Math.max(1e-3, ...roll.outline_mm.map(Math.abs));
  const place = (deg, mm) => {
    const radius = ROUND + (ROOM * mm) / size;
    const turn = (Math.PI * deg) / 180;
    return [MIDDLE + radius * Math.cos(turn), MIDDLE - radius * Math.sin(turn)];
  };
  const label = `${words.shape} ${roll.roll}: ${extremes(roll)}`;
  const picture = shape("svg", {
    viewBox: `-16 0 ${SIDE + 32} ${SIDE}`,
    role: "img",
    "aria-label": label,
    class: "polar",
  });
  for (const share of [-1, 0, 1]) {
    const radius = ROUND + ROOM * share;
    const kind = share ? "ring" : "round";
    picture.append(shape("circle", { cx: MIDDLE, cy: MIDDLE, r: radius, class: kind }));
    picture.append(shape("text", { x: MIDDLE + 4, y: MIDDLE - radius - 3 }, signed(share * size)));
  }
  for (const deg of [0, 90, 180, 270]) {
    const [x, y] = place(deg, 1.75 * size);
    picture.append(shape("text", { x, y: y + 4, "text-anchor": "middle" }, `${deg}°`));
  }
  if (roll.scatter_mm.length) {
    const edge = (sign) =>
      roll.outline_mm.map((mm, n) => place(n * roll.step_deg, mm + sign * roll.scatter_mm[n]).join(" "));
    const both = [edge(1), edge(-1)].map((points) => `M${points.join("L")}Z`).join("");
    picture.append(shape("path", { d: both, class: "scatter" }));
  }
  const points = roll.outline_mm.map((mm, n) => place(n * roll.step_deg, mm).join(",")).join(" ");
  picture.append(shape("polygon", { points, class: "outline" }));
  return [picture, cursor(roll, picture, place, size)];
}

/** A mark at an angle, and what is there; by the slider below, or by a finger on the picture. */
function cursor(roll, picture, place, size) {
  const ray = shape("line", { x1: MIDDLE, y1: MIDDLE, class: "cursor" });
  const mark = shape("circle", { r: 5, class: "cursor" });
  picture.append(ray, mark);
  const row = part("label", "angle");
  const slider = part("input");
  const step = roll.step_deg;
  for (const [name, value] of Object.entries({ type: "range", min: 0, max: 360 - step, step })) slider[name] = value;
  const told = part("output", "");
  row.append(part("span", "", words.angle), slider, told);
  const show = () => {
    const deg = Number(slider.value);
    cursors.set(roll.key, deg);
    const mm = roll.outline_mm[deg / step];
    const scatter = roll.scatter_mm[deg / step];
    const band = scatter === undefined ? "" : ` ± ${said(scatter, 3, SHAPE)}`;
    const text = `${number(deg, 0)}°: ${signed(mm, 3)}${band}`;
    put(told, text);
    slider.setAttribute("aria-valuetext", text);
    const [x2, y2] = place(deg, 1.4 * size);
    for (const [name, value] of Object.entries({ x2, y2 })) ray.setAttribute(name, String(value));
    const [cx, cy] = place(deg, mm);
    for (const [name, value] of Object.entries({ cx, cy })) mark.setAttribute(name, String(value));
  };
  slider.value = String(cursors.get(roll.key) ?? 0);
  slider.oninput = show;
  const point = (event) => {
    if (event.type === "pointermove" && !event.buttons) return;
    const { left, top, width, height } = picture.getBoundingClientRect();
    const x = ((event.clientX - left) / width) * (SIDE + 32) - 16 - MIDDLE;
    const y = MIDDLE - ((event.clientY - top) / height) * SIDE;
    const deg = (360 + (180 * Math.atan2(y, x)) / Math.PI) % 360;
    slider.value = String((Math.round(deg / step) * step) % 360);
    show();
  };
  picture.onpointerdown = picture.onpointermove = point;
  show();
  return row;
}

export function enlarged(roll) {
  const size = Math.max(1e-3, ...roll.outline_mm.map(Math.abs));
  const times = roll.radius_mm ? ((ROOM / size) * roll.radius_mm) / ROUND : null;
  return words.enlarged.replace("{times}", number(times, 0));
}
