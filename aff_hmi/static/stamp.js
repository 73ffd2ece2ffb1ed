// Of when it is what is shown.
import { nowS } from "/static/clock.js";
import { at, byId, put } from "/static/see.js";

const words = byId("stamp-words").dataset;
let seen_s = null;

/** Say of when it is what is shown; without an answer, since when there is none. */
export function stamp(hasAnswer) {
  if (hasAnswer) seen_s = nowS();
  const text = seen_s === null ? "" : (hasAnswer ? words.seen : words.old).replace("{time}", at(seen_s));
  put(byId("seen-at"), text);
  byId("seen-at").classList.toggle("bad", !hasAnswer && seen_s !== null);
}
