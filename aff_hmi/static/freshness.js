// How old is what is shown? One judgement per link of the chain, from the newest frame and the
// browser's own clock. Nothing here touches the page.

export const WORN_MS = 350;
export const DEAD_MS = 700;
export const FACTS_MS = 800; // the supervisor speaks twice a second

/** @typedef {"good" | "worn" | "dead" | "none"} Quality  none: it cannot be known */
/** @typedef {{age_ms: number | null, quality: Quality}} Link */

/** @returns {Quality} */
function quality(age_ms) {
  return age_ms < WORN_MS ? "good" : age_ms < DEAD_MS ? "worn" : "dead";
}

/**
 * Judge every link.
 *
 * The frame carries the newest stamp of this browser that the server had heard when it made the
 * frame. The age of that stamp bounds the age of the frame, whatever held it up on its way.
 *
 * @param {object | null} frame newest frame, null before the first
 * @param {number} arrived_ms when it came
 * @param {number} now_ms
 * @returns {{browser: Link, hmi: Link, service: Link, plc: Link, supervisor: Link}}
 */
export function judge(frame, arrived_ms, now_ms) {
  const unknown = { age_ms: null, quality: /** @type {Quality} */ ("none") };
  const links = { browser: unknown, hmi: unknown, service: unknown, plc: unknown, supervisor: unknown };
  if (frame === null) return links;
  const bound_ms = now_ms - frame.echo;
  const since_ms = now_ms - arrived_ms;
  links.browser = { age_ms: bound_ms, quality: quality(bound_ms) };
  links.hmi = { age_ms: since_ms, quality: links.browser.quality };
  if (links.browser.quality === "dead") return links;
  if (frame.facts_age_s !== null) {
    const facts_ms = 1000 * frame.facts_age_s + since_ms;
    links.supervisor = { age_ms: facts_ms, quality: facts_ms < FACTS_MS ? "good" : "dead" };
  }
  if (frame.tick_age_s === null) {
    links.service = { age_ms: null, quality: "dead" };
    return links;
  }
  const tick_ms = 1000 * frame.tick_age_s + since_ms;
  links.service = { age_ms: tick_ms, quality: quality(tick_ms) };
  if (links.service.quality === "dead") return links;
  const plc = frame.plc_age_s;
  if (plc === null) {
    links.plc = { age_ms: null, quality: "dead" };
  } else {
    const kind = plc <= frame.plc_late_s ? "good" : plc <= frame.plc_dead_s ? "worn" : "dead";
    links.plc = { age_ms: 1000 * plc + since_ms, quality: kind };
  }
  return links;
}

/**
 * The link that has stopped, seen from here: what lies behind it cannot be known.
 *
 * @returns {"hmi" | "service" | "plc" | "supervisor" | ""}
 */
export function broken(links) {
  for (const name of ["hmi", "service", "plc", "supervisor"]) {
    if (links[name].quality === "dead") return name;
  }
  return "";
}

const NEEDED = {
  hmi: ["hmi"],
  service: ["hmi", "service"],
  plc: ["hmi", "service", "plc"],
  supervisor: ["hmi", "service", "supervisor"],
  facts: ["hmi", "supervisor"], // what it says where there is no tick
};

/** Whether what comes from `source` (one of `NEEDED`) is too old to be taken for true. */
export function isDead(source, links) {
  return NEEDED[source].some((name) => links[name].quality === "dead" || links[name].quality === "none");
}
