// Bins of curves over time: where nothing was kept there is a hole, in the picture and in the table.
const APART = 1.5; // of a bin's own time: the one that would come next lies nearer than that

/** Whether nothing was kept between the n-th bin and the one before it. */
const isHole = ({ t_s, wide_s }, n) => n > 0 && t_s[n] - t_s[n - 1] > APART * wide_s[n - 1];

/** What is drawn: the middle of every bin, then mean, least and largest of each curve. */
export function holed(answer) {
  const { t_s, wide_s } = answer;
  const columns = answer.curves.flatMap((one) => [one.mean, one.least, one.largest]);
  const found = [[], ...columns.map(() => [])];
  const add = (x, values) => [x, ...values].forEach((value, c) => found[c].push(value));
  t_s.forEach((t, n) => {
    if (isHole(answer, n)) add(t_s[n - 1] + wide_s[n - 1], columns.map(() => null));
    add(t + wide_s[n] / 2, columns.map((column) => column[n]));
  });
  return found;
}

/** Values that have no neighbour: no line shows them. */
export function lonely(values) {
  const isNone = (n) => values[n] === null || values[n] === undefined;
  return values.flatMap((_, n) => (!isNone(n) && isNone(n - 1) && isNone(n + 1) ? [n] : []));
}

/** Several bins of a curve as one: every bin counts, the mean by the time that each is of. */
function joined(curve, from, to, wide_s) {
  const found = { least: null, mean: null, largest: null };
  let [sum, weight] = [0, 0];
  for (let n = from; n < to; n += 1) {
    if (curve.mean[n] === null) continue;
    found.least = Math.min(found.least ?? Infinity, curve.least[n]);
    found.largest = Math.max(found.largest ?? -Infinity, curve.largest[n]);
    sum += curve.mean[n] * wide_s[n];
    weight += wide_s[n];
  }
  if (weight) found.mean = sum / weight;
  return found;
}

/** Rows of a table, oldest first: when each begins, its curves; `curves` is null for a hole. */
export function tabled(answer, most) {
  const { t_s, wide_s, curves } = answer;
  const long_s = t_s.length ? (t_s.at(-1) + wide_s.at(-1) - t_s[0]) / most : 0;
  const rows = [];
  let from = 0;
  for (let n = 1; n <= t_s.length; n += 1) {
    const ends = n === t_s.length || isHole(answer, n);
    if (!ends && t_s[n] < t_s[from] + long_s) continue;
    rows.push({ t_s: t_s[from], curves: curves.map((one) => joined(one, from, n, wide_s)) });
    if (n < t_s.length && isHole(answer, n)) rows.push({ t_s: t_s[n - 1] + wide_s[n - 1], curves: null });
    from = n;
  }
  return rows;
}
