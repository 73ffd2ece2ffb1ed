// Sound of this screen, for an alarm of high priority that stands and that nobody has seen. It is off
// until somebody switches it on at this browser, which keeps that.
const EVERY_MS = 2000;
const BEEPS = [
  { Hz: 880, at_s: 0 },
  { Hz: 660, at_s: 0.22 },
];
const LONG_S = 0.18;
const VOLUME = 0.2;
const NAME = "sound";
const words = document.getElementById("words").dataset;
let context = null;
let sounded_ms = -Infinity;
let isOn = kept();

function kept() {
  try {
    return localStorage.getItem(NAME) === "on";
  } catch {
    return false;
  }
}

/** A browser lets nothing be heard before somebody has pressed something on the page. */
const waits = () => context !== null && context.state !== "running";

function say() {
  const text = isOn ? (waits() ? words.soundWaits : words.soundOn) : words.soundOff;
  for (const place of document.querySelectorAll("[data-sound]")) {
    if (place.textContent !== text) place.textContent = text;
  }
  const button = document.getElementById("sound");
  if (button) {
    button.textContent = isOn ? words.soundSwitchOff : words.soundSwitchOn;
    button.setAttribute("aria-pressed", String(isOn));
  }
}

function open() {
  if (context !== null) return;
  context = new AudioContext();
  context.onstatechange = say;
}

function beep() {
  for (const { Hz, at_s } of BEEPS) {
    const tone = new OscillatorNode(context, { frequency: Hz });
    const level = new GainNode(context, { gain: VOLUME });
    tone.connect(level).connect(context.destination);
    tone.start(context.currentTime + at_s);
    tone.stop(context.currentTime + at_s + LONG_S);
  }
}

/** Switch on or off; who switches on hears how it sounds. */
export function otherSound() {
  isOn = !isOn;
  try {
    localStorage.setItem(NAME, isOn ? "on" : "off");
  } catch {
    // it holds until this page is left
  }
  if (isOn) {
    open();
    context.resume().then(beep);
  }
  say();
}

document.addEventListener("frame", (event) => {
  if (!isOn || !event.detail?.loud || performance.now() - sounded_ms < EVERY_MS) return;
  sounded_ms = performance.now();
  open();
  if (waits()) say();
  else beep();
});
for (const kind of ["pointerdown", "keydown"]) {
  document.addEventListener(kind, () => isOn && (open(), context.resume()));
}
document.getElementById("sound")?.addEventListener("click", otherSound);
say();
