#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Measures every kind of page in headless Chromium as a reader's window, tablet and telephone show it.

usage: layout_browser_test.py WRITE_PAGE WRITE_REPLAY_PAGE [PAGE.html ...]

Proves in the document's own measures, at 1400 px in light and dark, at 800 px in dark and at 390 px in light:
the page is no wider than the window; no text is cut off by its plot or its box, none lies over another of the
same plot, none is smaller than 12 px (11 px in narrow windows), on canvases neither; text stands out from its
ground (WCAG AA, 4.5:1, large text 3:1) and so do lines; no section or table is empty; heads of tables have
their scope, pictures and controls a name; the contents are there or unfold; every control can be used, and
nothing is said on the console; a calibration is printed on eight sheets at most. With PAGE.html given, those
pages are measured instead.
"""
import base64
import os
import re
import subprocess
import sys
import tempfile
import zlib

from browser import FLAT, Chromium, fail

WIDTHS = (1400, 800, 390)
KINDS = ("calibration", "perturbation", "trajectory", "long-names", "comparison", "study", "replay")
MOST_SHEETS = 8
SHOWN = 6  # faults of a page that are printed

PROBE = """
await settled();
const faults = [];
const say = (kind, what, more) => faults.push(`${kind}: ${what}${more ? ' (' + more + ')' : ''}`);
const nameOf = (e) => {
  const home = e.closest('section, header, nav, footer, figure');
  return `'${(e.textContent || e.value || e.tagName).trim().slice(0, 40)}' of ${home ? home.id || home.className || home.tagName : 'page'}`;
};
// What is laid out and not behind a fold.
const visible = (e) => e.checkVisibility({opacityProperty: true, visibilityProperty: true}) && e.getClientRects().length > 0;
const texts = () => {
  const walk = document.createTreeWalker(document.body, NodeFilter.SHOW_TEXT);
  const found = [];
  for (let n = walk.nextNode(); n; n = walk.nextNode()) {
    const e = n.parentElement;
    if (!n.textContent.trim() || ['SCRIPT', 'STYLE', 'NOSCRIPT', 'OPTION', 'TITLE', 'DESC'].includes(e.tagName.toUpperCase()) || !visible(e)) continue;
    found.push([n, e]);
  }
  return found;
};
const scaleOf = (e) => {
  const svg = e.ownerSVGElement;
  return svg ? Math.abs(e.getScreenCTM().d || e.getScreenCTM().b) || Math.hypot(e.getScreenCTM().a, e.getScreenCTM().b) : 1;
};
const checkSizes = (all) => {
  const least = innerWidth >= 1400 ? 12 : 11;
  for (const [, e] of all) {
    if (e.closest('sub, sup')) continue;
    const m = e.ownerSVGElement ? e.getScreenCTM() : null;
    const px = parseFloat(getComputedStyle(e).fontSize) * (m ? Math.hypot(m.a, m.b) : 1);
    if (px < least - 0.05) say('small text', nameOf(e), px.toFixed(1) + ' px');
  }
};
const checkCanvases = () => {
  const least = innerWidth >= 1400 ? 12 : 11;
  for (const [text, px] of canvasTexts) if (px < least - 0.05) say('small text on a canvas', `'${text.slice(0, 40)}'`, px.toFixed(1) + ' px');
};
const overlapOf = (a, b) => Math.min(Math.min(a.right, b.right) - Math.max(a.left, b.left), Math.min(a.bottom, b.bottom) - Math.max(a.top, b.top));
// Words in plots: whole, and apart from each other. A box of text has air above and below; 3 px are none.
const checkPlots = () => {
  for (const svg of document.querySelectorAll('figure svg')) {
    if (!visible(svg)) continue;
    const frame = svg.getBoundingClientRect();
    const words = [...svg.querySelectorAll('text')].filter((t) => t.textContent.trim() && visible(t));
    const boxes = words.map((t) => t.getBoundingClientRect());
    words.forEach((t, i) => {
      const r = boxes[i];
      if (r.left < frame.left - 1 || r.right > frame.right + 1 || r.top < frame.top - 2 || r.bottom > frame.bottom + 2)
        say('cut off by its plot', nameOf(t), svg.id);
      for (let j = i + 1; j < words.length; ++j)
        if (overlapOf(r, boxes[j]) > 3) say('over another', nameOf(t) + ' and ' + nameOf(words[j]), svg.id);
    });
  }
};
// A box that hides what does not fit, without a bar to scroll it.
const checkBoxes = () => {
  for (const e of document.querySelectorAll('main *, nav *')) {
    if (!visible(e) || e.ownerSVGElement) continue;
    const style = getComputedStyle(e);
    if (style.overflowX === 'hidden' && e.scrollWidth > e.clientWidth + 1 && style.textOverflow !== 'ellipsis' && e.textContent.trim())
      say('cut off by its box', nameOf(e), `${e.scrollWidth} in ${e.clientWidth} px`);
    if (style.textOverflow === 'ellipsis' && e.scrollWidth > e.clientWidth + 1 && !e.title)
      say('shortened without a title', nameOf(e));
    if (innerWidth >= 1400 && e.matches('.scroll') && e.scrollWidth > e.clientWidth + 1)
      say('to be scrolled in a wide window', nameOf(e), `${e.scrollWidth} in ${e.clientWidth} px`);
  }
};
const checkEmpty = () => {
  for (const s of document.querySelectorAll('main section'))
    if (s.innerText.trim().split('\\n').length < 2 && !s.querySelector('svg, canvas')) say('empty section', s.id);
  for (const t of document.querySelectorAll('main table'))
    if (visible(t) && t.querySelectorAll('tbody tr').length === 0) say('empty table', nameOf(t));
  for (const f of document.querySelectorAll('main figure')) {
    const r = f.getBoundingClientRect();
    if (visible(f) && (r.width < 100 || r.height < 40)) say('no room for a figure', nameOf(f));
  }
};
// The list of contents is there where there is room, and unfolds where there is none.
const checkContents = () => {
  const fold = document.querySelector('.toc details'), handle = fold && fold.querySelector('summary');
  if (!fold) return;
  const links = () => [...fold.querySelectorAll('a')].filter(visible).length;
  if (!links() && !visible(handle)) { say('no contents', `${innerWidth} px`); return; }
  if (innerWidth <= 900 && !visible(handle)) say('contents cannot be folded', `${innerWidth} px`);
  const was = fold.open;
  fold.open = true;
  if (!links()) say('contents do not unfold', `${innerWidth} px`);
  fold.open = was;
};
const colour = (text) => {
  const n = (text.match(/[\\d.]+/g) || []).map(Number);
  return text.startsWith('color(srgb') ? [n[0] * 255, n[1] * 255, n[2] * 255, n[3] ?? 1] : [n[0], n[1], n[2], n[3] ?? 1];
};
const over = (top, under) => [0, 1, 2].map((k) => top[k] * top[3] + under[k] * (1 - top[3]));
const groundOf = (e) => {
  const layers = [];
  for (let p = e; p; p = p.parentElement) {
    const c = getComputedStyle(p).backgroundColor;
    if (c && c !== 'transparent') layers.push(colour(c));
    if (layers.length && layers[layers.length - 1][3] === 1) break;
  }
  return layers.reverse().reduce((ground, layer) => over(layer, ground), [255, 255, 255]);
};
const luminance = (c) => { const [r, g, b] = c.map((v) => { v /= 255; return v <= 0.03928 ? v / 12.92 : ((v + 0.055) / 1.055) ** 2.4; }); return 0.2126 * r + 0.7152 * g + 0.0722 * b; };
// The shape of a plot that was filled before the text, where its middle is: a coloured cell.
const shapeBelow = (text) => {
  const r = text.getBoundingClientRect(), x = (r.left + r.right) / 2, y = (r.top + r.bottom) / 2;
  const below = [...text.ownerSVGElement.querySelectorAll('rect, polygon, path')].filter((s) => {
    const b = s.getBoundingClientRect();
    return s.compareDocumentPosition(text) & Node.DOCUMENT_POSITION_FOLLOWING && getComputedStyle(s).fill !== 'none' &&
      b.left <= x && b.right >= x && b.top <= y && b.bottom >= y;
  });
  const last = below.pop();
  return last ? over(colour(getComputedStyle(last).fill), groundOf(text.ownerSVGElement)) : null;
};
const checkContrast = (all) => {
  for (const [, e] of all) {
    const style = getComputedStyle(e);
    if (e.ownerSVGElement && (style.fill === 'none' || e.ownerSVGElement.querySelector('image'))) continue;
    const ground = e.ownerSVGElement ? shapeBelow(e) || groundOf(e.ownerSVGElement) : groundOf(e);
    const ink = over(colour(e.ownerSVGElement ? style.fill : style.color), ground);
    const [x, y] = [luminance(ink), luminance(ground)].sort((a, b) => b - a);
    const large = parseFloat(style.fontSize) >= 24 || (parseFloat(style.fontSize) >= 18.6 && Number(style.fontWeight) >= 700);
    if ((x + 0.05) / (y + 0.05) < (large ? 3 : 4.45)) say('faint', nameOf(e), ((x + 0.05) / (y + 0.05)).toFixed(1));
  }
};
// Lines of plots stand out as well, 2.5:1: the palette's yellow on white has 2.9. Thinner ones are the grid.
const checkLines = () => {
  for (const svg of document.querySelectorAll('figure svg')) {
    if (!visible(svg) || svg.querySelector('image')) continue;
    const ground = groundOf(svg);
    const lines = [...svg.querySelectorAll('polyline, path, line')].filter((line) => {
      const style = getComputedStyle(line);
      return style.stroke !== 'none' && style.fill === 'none' && parseFloat(style.strokeWidth) >= 1.4;
    });
    if (new Set(lines.map((line) => getComputedStyle(line).stroke)).size > 8) continue;  // a scale of colours
    for (const line of lines) {
      const style = getComputedStyle(line);
      const [x, y] = [luminance(over(colour(style.stroke), ground)), luminance(ground)].sort((a, b) => b - a);
      if ((x + 0.05) / (y + 0.05) < 2.5) say('faint line', `${svg.id} ${style.stroke}`, ((x + 0.05) / (y + 0.05)).toFixed(1));
    }
  }
};
const use = () => {
  let saved = 0;  // a real download would leave the browser waiting
  HTMLAnchorElement.prototype.click = function () { if (this.download && this.href.startsWith('blob:')) ++saved; };
  document.querySelectorAll('summary').forEach((s) => { s.click(); s.click(); });
  for (const e of document.querySelectorAll('button, input, select, th.sorts')) {
    if (!visible(e)) continue;
    if (e.tagName === 'SELECT') { e.selectedIndex = e.options.length - 1; e.dispatchEvent(new Event('change', {bubbles: true})); continue; }
    if (e.type === 'range') { e.value = e.max; e.dispatchEvent(new Event('input', {bubbles: true})); continue; }
    e.click();
  }
  // Every plot that zooms is zoomed and moved by keys; its words stay whole and apart.
  for (const svg of document.querySelectorAll('svg.zooms'))
    for (const key of ['+', '+', 'ArrowRight']) svg.dispatchEvent(new KeyboardEvent('keydown', {key, bubbles: true, cancelable: true}));
  checkPlots();
  const buttons = [...document.querySelectorAll('.save-svg, .save-csv')].filter(visible).length;
  if (saved < buttons) say('not saved', `${buttons - saved} of ${buttons} plots or their data`);
};
// What a reader without a screen has: heads of tables that say what they head, pictures and controls with a name.
const nameless = (e) => !(e.getAttribute('aria-label') || e.getAttribute('aria-labelledby') || e.title || e.textContent.trim() || (e.labels && e.labels.length));
const checkNames = () => {
  for (const th of document.querySelectorAll('main th')) if (!th.scope) say('table head without scope', nameOf(th));
  for (const e of document.querySelectorAll('main img')) if (!e.hasAttribute('alt')) say('image without alt', nameOf(e));
  for (const e of document.querySelectorAll('main figure svg')) if (visible(e) && !e.querySelector('title') && nameless(e)) say('plot without a name', e.id);
  for (const e of document.querySelectorAll('canvas, button, input, select')) if (visible(e) && nameless(e)) say('control without a name', nameOf(e));
};
const all = texts();
if (document.documentElement.scrollWidth > innerWidth + 1) {
  say('wider than the window', `${document.documentElement.scrollWidth} px`);
  for (const e of document.querySelectorAll('main *'))
    if (visible(e) && e.getBoundingClientRect().right > innerWidth + 1 && !e.closest('section, header, .scroll, figure')) say('reaches beyond', nameOf(e));
}
checkSizes(all);
checkPlots();
checkBoxes();
checkEmpty();
checkContents();
checkNames();
checkContrast(all);
checkLines();
if (used) use();
await settled();
checkCanvases();
pageErrors.forEach((e) => say('console', e));
return {faults: [...new Set(faults)], width: innerWidth, dark: matchMedia('(prefers-color-scheme: dark)').matches};
"""


def faults_of(browser, width, scheme, used):
    browser.dress(width, 900, scheme)
    result = browser.run("const used = %s;" % str(used).lower() + PROBE)
    if (result["width"], result["dark"]) != (width, scheme == "dark"):
        fail("measured at %d px; asked for %d, %s" % (result["width"], width, scheme))
    return result["faults"]


def check_page(browser, name, page):
    """Opened anew at every width, now in light and now in dark, at the widest then changed to the other: colours do
    not depend on the width. The controls are used where there is most room, and last: they leave plots zoomed and
    tables sorted."""
    found = 0
    for width, schemes in zip(WIDTHS, (("light", "dark"), ("dark",), ("light",)), strict=True):
        browser.open(page, width, 900, schemes[0])
        for scheme in schemes:
            faults = faults_of(browser, width, scheme, used=(width, scheme) == (WIDTHS[0], schemes[-1]))
            found += len(faults)
            if faults:
                print("%s at %d px, %s: %d faults" % (name, width, scheme, len(faults)))
                print("\n".join("  " + fault for fault in faults[:SHOWN]))
    return found


def sheets_of(browser, page):
    """How many sheets the page is printed on: the largest count in its PDF's tree of pages."""
    browser.open(page)
    data = base64.b64decode(browser.call("Page.printToPDF", printBackground=True,
                                         preferCSSPageSize=True)["data"])
    parts = [data]
    for stream in re.findall(rb"stream\r?\n(.*?)\r?\nendstream", data, re.S):
        try:
            parts.append(zlib.decompress(stream))
        except zlib.error:
            pass  # an image or a font
    return max(int(n) for part in parts for n in re.findall(rb"/Count (\d+)", part))


def written(kind, write_page, write_replay_page, folder):
    page = os.path.join(folder, kind + ".html")
    command = {"calibration": [write_page, page, "60"], "replay": [write_replay_page, page, "60", "6", "images"]}
    subprocess.run(command.get(kind, [write_page, page, kind]), check=True, stdout=subprocess.DEVNULL)
    return page


def main():
    write_page, write_replay_page, *given = sys.argv[1:]
    found = 0
    with tempfile.TemporaryDirectory() as folder, Chromium(*FLAT) as browser:
        for page in given:
            found += check_page(browser, page, os.path.abspath(page))
        for kind in KINDS if not given else ():
            page = written(kind, write_page, write_replay_page, folder)
            sheets = sheets_of(browser, page) if kind == "calibration" else 0
            if sheets > MOST_SHEETS:
                fail("a calibration is printed on %d sheets" % sheets)
            found += check_page(browser, kind, page)
    if found:
        fail("%d faults of layout" % found)
    print("%d pages, each at %s px: nothing wrong" % (len(given or KINDS), WIDTHS))


if __name__ == "__main__":
    main()
