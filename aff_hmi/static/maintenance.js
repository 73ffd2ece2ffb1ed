// A line over weeks: what grows, lives of rollers, exchanges, rolls of web and suppliers by rank.
// `roll` of a trend or a life is a body by its name in the site file, a roller or a roll of web.
import { row } from "/static/curves.js";
import { drawTrend } from "/static/weeks.js";
import { done, keepTyped } from "/static/draft.js";
import { showLong } from "/static/long.js";
import { stamp } from "/static/stamp.js";
import { ask, byId, number, part, put, words } from "/static/see.js";
import { LONG_MS, button, lookAfter, post, whenDone } from "/static/work.js";

const EVERY_MS = 10000;
const root = document.documentElement;
const day = new Intl.DateTimeFormat(root.lang, { dateStyle: "medium" });
const dayText = (at_s) => day.format(new Date(1000 * at_s));
const short = (value) => new Intl.NumberFormat(root.lang, { maximumSignificantDigits: 3 }).format(value);
let openTrendName = ""; // whose curve is shown

function fill(text, values) {
  return Object.entries(values).reduce((said, [key, value]) => said.replaceAll(`{${key}}`, value), text);
}

/** Replace the children only where the data changed: focus and typing survive. */
function renewIfChanged(box, said, make) {
  const text = JSON.stringify(said);
  if (box.dataset.said === text) return;
  box.dataset.said = text;
  box.replaceChildren(...make());
}

// --- trends ------------------------------------------------------------------------------------

const placeOf = (one) => (one.order ? `${one.roll} ${one.order}x` : one.roll); // 0: of the whole roll
const nameOf = (one) => `${placeOf(one)} ${one.quantity} ${one.signal}`;
const sized = (value, unit) => `${short(value)} ${unit}`.trim();

function slope(one) {
  const found = one.per_1000_km;
  if (found === null) return words.few;
  return `${sized(found.value, one.unit)} (${short(found.low)} … ${short(found.high)})`;
}

function reached(one) {
  if (one.jump_s !== null) return fill(words.jumped, { day: dayText(one.jump_s) });
  if (one.reached === null) return one.stands_out ? "—" : words.no;
  const late = one.reached.late_s === null ? words.never : dayText(one.reached.late_s);
  return `${dayText(one.reached.at_s)} (${dayText(one.reached.early_s)} … ${late})`;
}

function trendRow(one) {
  const needsAttention = one.stands_out || one.jump_s !== null;
  const made = row([
    `${needsAttention ? "▲ " : ""}${placeOf(one)}`,
    one.quantity,
    one.signal.replaceAll("_", " "),
    sized(one.now, one.unit),
    one.limit === null ? "—" : sized(one.limit, one.unit),
    slope(one),
    reached(one),
    String(one.count),
  ]);
  made.dataset.told = needsAttention ? "yes" : "no";
  made.dataset.trend = nameOf(one);
  const cell = part("td");
  const open = button(words.show, () => openTrend(one));
  open.setAttribute("aria-label", `${words.show}: ${nameOf(one)}`);
  cell.append(open);
  made.append(cell);
  return made;
}

function trends(rows) {
  const heads = [words.roller, words.quantity, words.tension, words.now, words.limit, words.slope];
  renewIfChanged(byId("trends"), rows, () => [
    row([...heads, words.reached, words.readings, ""], "th"),
    ...rows.map(trendRow),
  ]);
  const open = rows.find((one) => nameOf(one) === openTrendName) ?? rows.find((one) => one.stands_out);
  if (open) showTrend(open);
  byId("trend").hidden = open === undefined;
}

function openTrend(one) {
  byId("trend").hidden = false;
  showTrend(one);
  byId("trend-title").focus();
}

function showTrend(one) {
  openTrendName = nameOf(one);
  for (const line of byId("trends").querySelectorAll("tr")) {
    line.setAttribute("aria-current", String(line.dataset.trend === openTrendName));
  }
  const of = { place: placeOf(one), quantity: one.quantity, unit: one.unit || "1" };
  put(byId("trend-title"), fill(words.of, { ...of, speed: short(one.speed_m_s) }));
  put(byId("trend-note"), one.left_out ? fill(words.left, { count: one.left_out }) : "");
  drawTrend(one);
}

// --- lives, exchanges, rolls -------------------------------------------------------------------

function lives(rows) {
  const heads = [words.roller, words.life, words.since, words.until, words.km, words.hours];
  renewIfChanged(byId("lives"), rows, () => [
    row([...heads, words.turns, words.why], "th"),
    ...rows.map((one) =>
      row([
        one.roll,
        String(one.number),
        one.since_s === null ? words.before : dayText(one.since_s),
        one.until_s === null ? words.today : dayText(one.until_s),
        number(one.web_km, 1),
        number(one.running_h, 0),
        one.turns === null ? "—" : number(one.turns, 0),
        one.why,
      ]),
    ),
  ]);
  const names = [...new Set(rows.map((one) => one.roll))];
  renewIfChanged(byId("exchange-roll"), names, () =>
    names.map((name) => {
      const option = part("option", "", name);
      option.value = name;
      return option;
    }),
  );
}

const worst = (one) =>
  one === null ? "—" : `${short(one.size)} ± ${short(one.error)} ${one.unit} (${one.order}x)`;

function ranking(one) {
  const box = part("div", "ranking");
  const said = one.by ? fill(words.ranked, { roll: one.roll, quantity: one.by }) : "";
  box.append(part("h3", "", said || fill(words.unranked, { roll: one.roll })));
  const table = part("table", "wide");
  const heads = [words.rank, words.rollId, words.shape, words.stroke, words.ripple, words.remains];
  const rows = one.rolls.map((roll, n) =>
    row([
      String(n + 1),
      String(roll.roll_id),
      worst(roll.shape),
      worst(roll.stroke),
      worst(roll.ripple),
      worst(roll.left),
      `${dayText(roll.first_s)} – ${dayText(roll.last_s)}`,
    ]),
  );
  table.append(row([...heads, words.seen], "th"), ...rows);
  box.append(scrolled(table));
  return box;
}

function scrolled(table) {
  const scroll = part("div", "scroll");
  scroll.tabIndex = 0;
  scroll.append(table);
  return scroll;
}

function median(found, order) {
  const one = found.find((each) => each.order === order);
  if (one === undefined) return "—";
  const interval = one.low === null ? words.fewRolls : `${short(one.low)} … ${short(one.high)}`;
  return `${short(one.size)} (${interval})`;
}

function suppliers(one) {
  const box = part("div", "ranking");
  if (!one.suppliers.length) {
    box.append(part("p", "", fill(words.noNumber, { roll: one.roll })));
    return box;
  }
  const of = { roll: one.roll, quantity: one.by, unit: one.unit || "1" };
  box.append(part("h3", "", fill(words.suppliersBy, of)));
  const table = part("table", "wide");
  const orders = one.orders.map((order) => `${order}x`);
  const rows = one.suppliers.map((who, n) =>
    row([
      String(n + 1),
      String(who.number),
      String(who.rolls),
      ...one.orders.map((order) => median(who.medians, order)),
      who.worst_roll === null ? "—" : `${who.worst_roll}: ${worst(who.worst)}`,
    ]),
  );
  table.append(row([words.rank, words.supplier, words.rolls, ...orders, words.worstRoll], "th"), ...rows);
  box.append(scrolled(table));
  if (one.unknown) box.append(part("p", "note", fill(words.withoutNumber, { count: one.unknown })));
  return box;
}

function showView(view) {
  const { store, nothing } = view;
  put(byId("store"), store);
  byId("nothing").hidden = !nothing;
  put(byId("nothing"), nothing);
  const span = view.from_s === null ? null : { from: dayText(view.from_s), to: dayText(view.to_s) };
  const facts = { line: view.line, hours: view.hours, km: number(view.web_km, 1) };
  put(byId("facts"), span === null ? "" : fill(words.facts, { ...facts, ...span }));
  renewIfChanged(byId("notes"), view.notes, () => view.notes.map((text) => part("li", "", text)));
  byId("quiet").hidden = view.notes.length > 0 || view.trends.length === 0;
  put(byId("quiet"), words.quiet);
  trends(view.trends);
  const without = view.without_a_line;
  renewIfChanged(byId("without-a-line"), without, () => without.map((text) => part("li", "", text)));
  lives(view.lives);
  renewIfChanged(byId("rankings"), view.rankings, () =>
    view.rankings.length ? view.rankings.map(ranking) : [part("p", "", words.noRolls)],
  );
  renewIfChanged(byId("suppliers"), view.suppliers, () =>
    view.suppliers.length ? view.suppliers.map(suppliers) : [part("p", "", words.noSuppliers)],
  );
}

// --- looking -----------------------------------------------------------------------------------

let isAsking = false;
let asked_ms = -Infinity;
async function look() {
  if (isAsking || document.hidden) return;
  isAsking = true;
  asked_ms = performance.now();
  const found = await ask("/data/maintenance", {}, LONG_MS);
  isAsking = false;
  stamp(found?.ok === true);
  root.dataset.maintenance = found?.ok ? "shown" : "none";
  if (found?.ok) showView(found.maintenance);
}

let wasBusy = false;
lookAfter((state) => {
  const isOpen = state?.ok === true && state.is_open;
  for (const box of document.querySelectorAll("[data-open]")) box.hidden = !isOpen;
  const isBusy = state?.ok === true && state.job !== null;
  const hasEnded = showLong(state) || (wasBusy && !isBusy);
  wasBusy = isBusy;
  if (hasEnded || performance.now() - asked_ms > EVERY_MS) look();
});

byId("read").onclick = () => post("/maintenance/read", {});
keepTyped(byId("exchange-why"), "exchange-why"); // an exchange stays: roller and moment are said anew
byId("exchange").onsubmit = async (event) => {
  event.preventDefault();
  const on = new Date(byId("exchange-on").value).toISOString();
  const reason = byId("exchange-why").value;
  const answer = await post("/maintenance/exchange", { roll: byId("exchange-roll").value, on, reason });
  if (!answer.ok) return;
  whenDone("exchange", -1, () => {
    done("exchange-why", reason);
    byId("exchange-on").value = "";
  });
};
look();
