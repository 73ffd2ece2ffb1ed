// The windows that somebody has kept: a list, each with what can be done with it.
import { ask, at, byId, number, part, press, put, words } from "/static/see.js";

let sure = null; // number of the window that is let go of with the next press

/** List the kept windows; `open` shows one, `lay` lays one over or takes it off, `isLaid` asks. */
export async function listWindows(of) {
  const found = await ask("/data/windows", {});
  if (found === null) {
    put(byId("kept-said"), words.failed);
    return;
  }
  const lines = found.ok ? found.windows.map((one) => line(one, of)) : [part("li", "", found.text)];
  byId("windows").replaceChildren(...(lines.length ? lines : [part("li", "", words.noWindow)]));
}

function button(text, press) {
  const made = part("button", "", text);
  made.type = "button";
  made.onclick = () => press(made);
  return made;
}

function line(one, of) {
  const made = part("li");
  made.append(part("strong", "", one.name));
  if (one.note) made.append(part("p", "", one.note));
  const when = words.of.replace("{seconds}", number(one.seconds, 1)).replace("{time}", at(one.utc_s));
  made.append(part("p", "note", when.replace("{name}", one.who || words.itself)));
  const where = words.where.replace("{run}", one.run || "—").replace("{first}", String(one.first));
  made.append(part("p", "note", where.replace("{last}", String(one.last)).replace("{config}", one.config || "—")));
  const buttons = part("p", "buttons");
  buttons.append(button(words.open, () => of.open(one)));
  buttons.append(button(of.isLaid(one) ? words.layOff : words.layOver, () => of.lay(one)));
  const isSure = sure === one.number; // a list that is made anew still asks
  if (byId("keep")) buttons.append(button(isSure ? words.sure : words.letGo, (pressed) => letGo(one, pressed, of)));
  made.append(buttons);
  return made;
}

async function letGo(one, pressed, of) {
  if (sure !== one.number) {
    sure = one.number;
    put(pressed, words.sure);
    return;
  }
  sure = null;
  put(byId("kept-said"), await press("/let-go", { number: one.number }));
  listWindows(of);
}
