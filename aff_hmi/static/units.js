// Units as the reader chose them: of the plant, or those of the US. What comes over the wire and
// what is saved as a file has the plant's; a page turns it where it is written.

// unit of the plant: what it is called there, what it is multiplied with, digits more behind the point
const US = {
  N: ["lbf", 0.224809, 1],
  "N m": ["lbf·ft", 0.737562, 0],
  "m/min": ["FPM", 3.28084, 0],
  "mm/s": ["FPM", 0.19685, 1],
  mm: ["in", 1 / 25.4, 1],
  "mm of shape": ["mil", 1 / 0.0254, -2],
};
const NAME = "units";

function kept() {
  try {
    return localStorage.getItem(NAME);
  } catch {
    return null; // a browser that keeps nothing shows the plant's
  }
}

const table = kept() === "us" ? US : {};

/** Name of a unit as it is shown; "mm of shape" is how much a roll deviates from round. */
export const unitName = (unit) => table[unit]?.[0] ?? unit.replace(" of shape", "");
export const factorOf = (unit) => table[unit]?.[1] ?? 1;
export const digitsOf = (digits, unit) => Math.max(0, digits + (table[unit]?.[2] ?? 0));

/** A number in the reader's unit; nothing stays nothing. */
export const inUnit = (value, unit) =>
  value === null || value === undefined ? value : value * factorOf(unit);

export function otherUnits() {
  try {
    localStorage.setItem(NAME, kept() === "us" ? "plant" : "us");
  } catch {
    return;
  }
  location.reload();
}

for (const place of document.querySelectorAll("[data-unit]:not([data-digits])")) {
  const name = unitName(place.dataset.unit);
  if (place.textContent !== name) place.textContent = name;
}
