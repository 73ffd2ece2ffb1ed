// The one clock of a page, the gateway's: that of a browser may be hours off.
let ahead_s = 0; // against this browser's
document.addEventListener("frame", ({ detail: frame }) => {
  if (frame !== null) ahead_s = frame.utc_s - Date.now() / 1000;
});

/** Time of the gateway, which everything on a page was stamped with; s since 1970. */
export const nowS = () => Date.now() / 1000 + ahead_s;
