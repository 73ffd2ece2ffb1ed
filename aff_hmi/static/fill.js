// Texts of the catalogue with what is measured in them.
/** A text with values for its {names}. */
export function fill(text, values) {
  return Object.entries(values).reduce((said, [key, value]) => said.replaceAll(`{${key}}`, value), text);
}
