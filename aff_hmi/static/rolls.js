// Rolls as pictures in mm, with the orders behind them.
import { renew } from "/static/renew.js";
import { SHAPE, enlarged, extremes, polar, said, shape } from "/static/polar.js";
import { at, byId, number, onPart, part, put, words } from "/static/see.js";

// --- tables ------------------------------------------------------------------------------------

function table(kind, heads, rows) {
  const made = part("table", kind);
  const head = part("tr");
  for (const text of heads) {
    const cell = part("th", "", text);
    cell.scope = "col";
    head.append(cell);
  }
  made.append(part("thead"), part("tbody"));
  made.tHead.append(head);
  made.tBodies[0].append(...rows);
  return made;
}

function bar(dB) {
  const long = Math.min(1, Math.max(0, -dB / 60));
  const made = shape("svg", { viewBox: "0 0 60 8", class: "gain", "aria-hidden": "true" });
  made.append(shape("rect", { class: "room", width: 60, height: 8 }));
  made.append(shape("rect", { class: dB > 0 ? "fill full" : "fill", height: 8 }));
  made.lastChild.setAttribute("width", String(60 * (dB > 0 ? 1 : long)));
  return made;
}

function orderRow(order, unit) {
  const row = part("tr", order.why ? "rests" : "");
  const figure = (value, digits, after) =>
    part("td", "figure", value === null ? "—" : `${number(value, digits)}${after}`);
  const sized = (value, of) => part("td", "figure", value === null ? "—" : said(value, 3, of));
  const gain = figure(order.change_dB, 0, " dB");
  if (order.change_dB !== null) gain.append(" ", bar(order.change_dB));
  const stands = order.why ? `▲ ${words.rests}, ${order.state}` : order.state;
  const state = order.grows ? `${stands} ↗ ${words.grows}` : stands;
  row.append(
    part("td", "name", order.name),
    part("td", "stands", state), // second: on a phone it is seen without a push to the side
    figure(order.frequency_Hz, 2, " Hz"),
    sized(order.size, order.unit === "mm" ? SHAPE : order.unit),
    figure(order.deg, 0, "°"),
    figure(order.out_percent, 0, " %"),
    sized(order.without, unit),
    sized(order.now, unit),
    gain,
    figure(order.ratio, 2, ""),
  );
  if (!order.why) return [row];
  const because = part("tr", "because");
  const why = part("td", "", order.why);
  why.colSpan = row.cells.length - 1;
  because.append(part("td"), why);
  return [row, because];
}

function orders(roll) {
  const heads = [
    ...[words.order, words.state, "Hz", words.size, words.angle, words.out],
    ...[words.without, words.now, "dB", words.ratio],
  ];
  const box = part("div", "scroll");
  box.tabIndex = 0;
  box.setAttribute("role", "region");
  box.setAttribute("aria-label", `${words.order}: ${roll.roll}`);
  const rows = roll.orders.flatMap((order) => orderRow(order, roll.signal_unit));
  box.append(table("wide", heads, rows));
  return box;
}

function outlineTable(roll) {
  const box = document.createElement("details");
  box.dataset.key = roll.key;
  box.append(part("summary", "", words.table));
  const rows = [];
  for (let n = 0; n < roll.outline_mm.length; n += 30 / roll.step_deg) {
    const row = part("tr");
    row.append(part("td", "figure", `${n * roll.step_deg}°`));
    row.append(part("td", "figure", said(roll.outline_mm[n], 3, SHAPE)));
    const scatter = roll.scatter_mm[n];
    row.append(part("td", "figure", scatter === undefined ? "—" : `± ${said(scatter, 3, SHAPE)}`));
    rows.push(row);
  }
  box.append(table("", [words.angle, words.deviation, words.scatter], rows));
  return box;
}

function crossings(roll) {
  const list = part("ul", "crossings");
  let isAbove = true;
  for (const one of roll.crossings) {
    if (isAbove && roll.radius_mm !== null && one.radius_mm < roll.radius_mm) {
      list.append(part("li", "here", `▶ ${said(roll.radius_mm, 1, "mm")} ${words.here}`));
      isAbove = false;
    }
    list.append(part("li", "", `${said(one.radius_mm, 1, "mm")}  ${one.text}`));
  }
  if (isAbove && roll.radius_mm !== null) {
    list.append(part("li", "here", `▶ ${said(roll.radius_mm, 1, "mm")} ${words.here}`));
  }
  return [part("h4", "", words.crossings), list];
}

function section(roll) {
  const box = part("div", "roll");
  const title = words.learned.replace("{roll}", roll.roll).replace("{actuator}", roll.actuator);
  box.append(part("h2", "", title));
  const side = part("div", "side");
  if (roll.outline_mm.length) side.append(...polar(roll));
  const notes = [extremes(roll)];
  if (roll.outline_mm.length) notes.push(enlarged(roll), roll.zero);
  if (roll.scatter_mm.length) notes.push(words.band);
  if (roll.radius_mm !== null) notes.unshift(`${words.radius} ${said(roll.radius_mm, 1, "mm")}`);
  side.append(part("p", "note", notes.join(" · ")));
  if (roll.outline_mm.length) side.append(outlineTable(roll));
  if (roll.crossings.length) side.append(...crossings(roll));
  box.append(side, orders(roll));
  return box;
}

const drawn = new Map();
let linked = placeOf(location.hash); // the roll that a link has asked for

function placeOf(hash) {
  try {
    return decodeURIComponent(hash.slice(1));
  } catch {
    return ""; // typed by hand
  }
}

/** A roll says anew what is new of it; what was opened, pushed aside or chosen by a key stays so. */
onPart((page) => {
  const rolls = page?.rolls ?? [];
  const next = rolls.map((roll) => {
    const text = JSON.stringify(roll);
    const old = drawn.get(roll.key);
    if (old?.text === text) return old.box;
    const fresh = section(roll);
    if (old) renew(old.box, fresh);
    const box = old?.box ?? fresh;
    drawn.set(roll.key, { text, box });
    return box;
  });
  const list = byId("rolls");
  const isSame = next.length === list.children.length && next.every((b, n) => b === list.children[n]);
  if (!next.length) list.replaceChildren(part("p", "", page === null ? "—" : words.none));
  else if (!isSame) list.replaceChildren(...next);
  const wanted = rolls.findIndex((roll) => roll.key === linked);
  if (wanted >= 0) {
    linked = "";
    next[wanted].tabIndex = -1;
    next[wanted].focus();
  }
  const since = page?.roll_since_s ?? null;
  const other = words.otherRoll.replace("{number}", number(page?.roll_number ?? null, 0));
  put(byId("other-roll"), since === null ? "" : other.replace("{time}", at(since)));
  const texts = page?.texts ?? [];
  byId("texts").replaceChildren(...(texts.length ? texts : ["—"]).map((text) => part("li", "", text)));
});
