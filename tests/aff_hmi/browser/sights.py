"""What the browser can measure of how a page looks: contrast, sizes, what does not fit."""

from __future__ import annotations

MIN_CONTRAST = 4.5  # WCAG 2.2, 1.4.3
# lowest contrast of any text with the ground behind it, and where
CONTRAST = """() => {
  const lum = (c) => {
    const [r, g, b] = c.match(/[0-9.]+/g).slice(0, 3).map(Number)
      .map(v => v / 255).map(v => v <= 0.03928 ? v / 12.92 : ((v + 0.055) / 1.055) ** 2.4);
    return 0.2126 * r + 0.7152 * g + 0.0722 * b;
  };
  const ground = (e) => {
    for (; e; e = e.parentElement) {
      const c = getComputedStyle(e).backgroundColor;
      if (!/rgba\\(.*, 0\\)/.test(c)) return c;
    }
    return "rgb(255, 255, 255)";
  };
  let worst = [99, ""];
  for (const e of document.querySelectorAll("body *")) {
    const text = [...e.childNodes].some(n => n.nodeType === 3 && n.textContent.trim());
    if (!text || !e.getClientRects().length) continue;
    const [a, b] = [lum(getComputedStyle(e).color), lum(ground(e))].sort((x, y) => y - x);
    const ratio = (a + 0.05) / (b + 0.05);
    if (ratio < worst[0]) worst = [ratio, e.outerHTML.slice(0, 120)];
  }
  return worst;
}"""
# what a gloved finger misses
SMALL = """() => [...document.querySelectorAll('a:not(.skip), button, input, select')]
  .filter(e => e.getClientRects().length)
  .map(e => [e.textContent || e.id, e.getBoundingClientRect()])
  .filter(([, r]) => r.width < 48 || r.height < 48).map(([t]) => t)"""
# text that is cut, by its element or by the edge of the window; what scrolls by itself may be
CLIPPED = """() => {
  const found = [];
  for (const e of document.querySelectorAll("body *")) {
    const text = [...e.childNodes].some(n => n.nodeType === 3 && n.textContent.trim());
    if (!text || !e.getClientRects().length || e.closest(".skip, .scroll")) continue;
    const box = e.getBoundingClientRect();
    const cut = getComputedStyle(e).overflow !== "visible" &&
      (e.scrollWidth > e.clientWidth + 1 || e.scrollHeight > e.clientHeight + 1);
    if (cut || box.left < -1 || box.right > innerWidth + 1) found.push(e.outerHTML.slice(0, 120));
  }
  return found;
}"""
# parts that lie over one another; what stays at the edge of the window may
OVERLAPS = """() => {
  const parts = [...document.querySelectorAll("header, nav, .who, main > section, footer")]
    .filter(e => e.getClientRects().length).map(e => [e, e.getBoundingClientRect()]);
  const found = [];
  for (const [i, [a, p]] of parts.entries()) {
    for (const [b, q] of parts.slice(i + 1)) {
      if (a.contains(b)) continue;
      const wide = Math.min(p.right, q.right) - Math.max(p.left, q.left);
      const high = Math.min(p.bottom, q.bottom) - Math.max(p.top, q.top);
      if (wide > 1 && high > 1) found.push(`${a.className} over ${b.className}`);
    }
  }
  return found;
}"""
