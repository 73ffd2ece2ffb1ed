// Parts of a proof by hand: how long the correction was on or off, as far as fresh data say so.

/**
 * Take what a fresh frame says.
 *
 * @param {{isOn: boolean, word: string, since: number, until: number}[]} parts the newest last
 * @param {{isOn: boolean, word: string, now: number}} seen
 * @param {number} most_ms what two fresh frames are apart at most: after a longer break nobody
 *   knows what the line did meanwhile, and a new part begins
 */
export function take(parts, { isOn, word, now }, most_ms) {
  const last = parts.at(-1);
  const isSame = last !== undefined && !last.isCut && last.isOn === isOn && now - last.until <= most_ms;
  if (isSame) last.until = now;
  else parts.push({ isOn, word, since: now, until: now, isCut: false });
}

/** What is shown is not fresh: the newest part has ended with the last fresh frame. */
export function cut(parts) {
  const last = parts.at(-1);
  if (last !== undefined) last.isCut = true;
}

/** How long a part has lasted, s. */
export const secondsOf = ({ since, until }) => (until - since) / 1000;
