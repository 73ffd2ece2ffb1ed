// The last ten minutes on the overview: ripple as a line, and the band in which a tension usually is.
// They go with what they stand beside: crossed out with it, gone when the tab slept.
import { digitsOf, inUnit, unitName } from "/static/units.js";

const EVERY_MS = 10000;
const PATIENCE_MS = 4000;
const OLD_MS = 30000;
const LONG = 100; // of a picture, in its own units
const HIGH = 24;
const root = document.documentElement;
const words = document.getElementById("words").dataset;
const clock = new Intl.DateTimeFormat(root.lang, { timeStyle: "medium", hourCycle: "h23" });
const places = [...document.querySelectorAll("[data-recent]")];
let recent = null;
let came_ms = 0;
let asked_ms = -Infinity;
let isAsking = false;

function said(value, { digits, unit }) {
  const count = digitsOf(Number(digits), unit);
  const how = { minimumFractionDigits: count, maximumFractionDigits: count };
  return new Intl.NumberFormat(root.lang, how).format(inUnit(value, unit));
}

function put(element, text) {
  if (element.textContent !== text) element.textContent = text;
}

async function renew() {
  if (isAsking || document.hidden) return;
  isAsking = true;
  asked_ms = performance.now();
  try {
    const answer = await fetch("/data/recent", { signal: AbortSignal.timeout(PATIENCE_MS) });
    const found = await answer.json();
    if (found.ok) {
      recent = found.recent;
      came_ms = performance.now();
    }
  } catch {
    // what there is grows old, and is taken away
  }
  isAsking = false;
  draw();
}

function draw() {
  if (performance.now() - came_ms > OLD_MS) recent = null;
  for (const place of places) {
    const { recent: slot } = place.dataset;
    const line = recent?.lines.find((one) => one.slot === slot);
    const band = recent?.bands.find((one) => one.slot === slot);
    if (line) drawLine(place, line.means);
    else if (band) drawBand(place, band);
    place.hidden = !(band || line?.means.some((mean) => mean !== null));
  }
}

/** Of a window there is a line where there were numbers, and nothing where there were none. */
function drawLine(place, means) {
  const most = Math.max(...means.map((mean) => mean ?? 0)) || 1;
  let path = "";
  means.forEach((mean, n) => {
    if (mean === null) return;
    const begins = n === 0 || means[n - 1] === null;
    const y = (HIGH - 1 - ((HIGH - 2) * mean) / most).toFixed(1);
    const x = ((LONG * n) / means.length).toFixed(2);
    const end = ((LONG * (n + 1)) / means.length).toFixed(2);
    path += `${begins ? "M" : "L"}${x} ${y}L${end} ${y}`;
  });
  place.querySelector(".line").setAttribute("d", path);
  const text = words.recentMost.replace("{most}", `${said(most, place.dataset)} ${unitName(place.dataset.unit)}`);
  put(place.querySelector(".note"), text.replace("{time}", clock.format(new Date(1000 * recent.to_s))));
}

/** From a band's width below it to a width above it. */
function axisOf({ low, high }) {
  const wide = Math.max(high - low, 0.01 * Math.abs(high), 1e-9);
  return { from: low - wide, per: LONG / (high - low + 2 * wide) };
}

function drawBand(place, band) {
  const { from, per } = axisOf(band);
  const usual = place.querySelector(".usual");
  usual.setAttribute("x", ((band.low - from) * per).toFixed(2));
  usual.setAttribute("width", Math.max(0.5, (band.high - band.low) * per).toFixed(2));
  const text = words.recentUsual.replace("{low}", said(band.low, place.dataset));
  const unit = unitName(place.dataset.unit);
  const whole = text.replace("{high}", `${said(band.high, place.dataset)} ${unit}`);
  put(place.querySelector(".note"), whole.replace("{time}", clock.format(new Date(1000 * recent.to_s))));
}

/** Where the number is now, against its band. */
function mark(frame) {
  for (const band of recent?.bands ?? []) {
    const place = places.find((one) => one.dataset.recent === band.slot);
    const value = frame.doubted.includes(band.slot) ? null : frame.values[band.slot];
    const now = place?.querySelector(".mark");
    if (!now) continue;
    now.classList.toggle("none", value === null || value === undefined);
    if (value === null || value === undefined) continue;
    const { from, per } = axisOf(band);
    now.setAttribute("x", Math.min(LONG - 1.5, Math.max(0, (value - from) * per)).toFixed(1));
  }
}

document.addEventListener("frame", (event) => {
  if (event.detail === null) {
    recent = null;
    asked_ms = -Infinity;
    draw();
    return;
  }
  mark(event.detail);
  if (places.length && performance.now() - asked_ms > EVERY_MS) renew();
});
draw();
