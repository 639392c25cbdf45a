# SPDX-License-Identifier: BSD-3-Clause
"""Headless Chromium for the tests of pages: starts it on a page that was instrumented, reads what the page's
probe tells, and takes statistics of what is painted. No test by itself.
"""
import json
import os
import re
import shutil
import subprocess
import sys
import tempfile
import time

COLLECTOR = """<script>
window.pageErrors = [];
window.addEventListener('error', (e) => pageErrors.push(String(e.message)));
window.addEventListener('unhandledrejection', (e) => pageErrors.push(String(e.reason)));
const tell = console.error;
console.error = (...words) => { pageErrors.push(words.join(' ')); tell(...words); };
// What is written on a canvas is no element: its size on the screen is noted as it is painted.
window.canvasTexts = new Map();
const fillText = CanvasRenderingContext2D.prototype.fillText;
CanvasRenderingContext2D.prototype.fillText = function (text, ...where) {
  const m = this.getTransform(), shown = this.canvas.clientWidth / this.canvas.width;
  if (shown > 0) canvasTexts.set(String(text), parseFloat(this.font.match(/([0-9.]+)px/)[1]) * Math.hypot(m.a, m.b) * shown);
  return fillText.call(this, text, ...where);
};
// What the buttons would save, as texts.
const saved = (figure, kind) => {
  const texts = [], make = URL.createObjectURL, click = HTMLAnchorElement.prototype.click, made = Blob;
  window.Blob = function (parts) { texts.push(parts.join('')); };
  URL.createObjectURL = () => 'blob:none';
  HTMLAnchorElement.prototype.click = () => {};
  figure.closest('figure').querySelector(kind).click();
  [window.Blob, URL.createObjectURL, HTMLAnchorElement.prototype.click] = [made, make, click];
  return texts[0];
};
Element.prototype.setPointerCapture = () => {};  // made-up pointers cannot be captured
// ?top=N moves the page up by N pixels, so that a window of moderate height sees any part of it.
const moveUp = (by) => { document.body.style.marginTop = `-${by}px`; };
addEventListener('DOMContentLoaded', () => {
  const by = new URLSearchParams(location.search).get('top');
  if (by) moveUp(Number(by));
});
</script>"""

STUDY_PROBE = """<script>
// Of each plot with a logarithmic axis: what pointing at the first point of each series says, and what is saved.
const logarithmic = () => [...document.querySelectorAll('figure svg[data-log]')].map((svg) => {
  const says = svg.plumbline.shapes().map(({points: [[x, y]]}) => {
    const at = new DOMPoint(x, y).matrixTransform(svg.getScreenCTM());
    svg.dispatchEvent(new PointerEvent('pointermove', {clientX: at.x, clientY: at.y, bubbles: true}));
    return svg.plumbline.mark.lastChild.textContent;
  });
  svg.dispatchEvent(new PointerEvent('pointerleave'));
  return {id: svg.id, says, csv: saved(svg, '.save-csv')};
});
setTimeout(() => {
  const place = (e) => { const r = e.getBoundingClientRect(); return [r.left + scrollX, r.top + scrollY, r.width, r.height]; };
  const out = document.createElement('script');
  out.type = 'application/json';
  out.id = 'probe';
  out.textContent = JSON.stringify({errors: pageErrors, logarithmic: logarithmic(),
    figures: [...document.querySelectorAll('figure svg')].map((s) => [s.id, ...place(s)]),
    tables: [...document.querySelectorAll('table')].map((t) => place(t))});
  document.body.append(out);
}, 500);
</script>"""


def fail(message):
    print("FAIL: " + message)
    sys.exit(1)


def chromium(url, *options):
    program = shutil.which("chromium") or shutil.which("chromium-browser")
    if not program:
        fail("chromium is missing; install Debian's package chromium")
    with tempfile.TemporaryDirectory() as profile:
        command = [program, "--headless=new", "--no-sandbox", "--disable-background-networking",
                   "--no-first-run", "--disable-component-update", "--disable-sync",
                   "--disable-dev-shm-usage", "--hide-scrollbars", "--user-data-dir=" + profile,
                   "--virtual-time-budget=3000", *options, url]
        try:
            done = subprocess.run(command, capture_output=True, text=True, timeout=240, check=False)
        except subprocess.TimeoutExpired:
            fail("chromium did not finish within 240 s: " + " ".join(command[-3:]))
    if done.returncode != 0:
        fail("chromium ended with %d: %s" % (done.returncode, done.stderr[-800:]))
    return done.stdout


# WebGL in software; what surrounds it is painted by the processor at once, not through WebGL.
GPU = ["--use-angle=swiftshader", "--enable-unsafe-swiftshader", "--disable-gpu-rasterization"]
# Everything but the live scene is looked at without: painting tall windows takes a fifth of the time.
FLAT = ["--disable-gpu", "--disable-3d-apis"]
SLICE = 8000  # height of a window [px]


def told(dom):
    """What the page's probe left in it."""
    found = re.search(r'<script type="application/json" id="probe">(.*?)</script>', dom, re.S)
    if not found:
        fail("the page's scripts did not run to their end")
    return json.loads(found.group(1))


def probe(url, *options):
    return told(chromium(url, "--dump-dom", "--window-size=1400,1000", *options))


def regions(tool, image, places):
    """Per place: pixels, share that differs from the commonest colour, colours, hash."""
    text = "\n".join(" ".join(str(v) for v in p) for p in places)
    out = subprocess.run([tool, image], input=text, capture_output=True, text=True, check=True)
    rows = [line.split() for line in out.stdout.splitlines()]
    return [(int(r[0]), float(r[1]), int(r[2]), r[3]) for r in rows]


def look(url, tool, folder, height, graphics):
    """One start of Chromium: what the probe tells, and a function that gives the statistics of
    places as they are painted."""
    shot = os.path.join(folder, "shot.png")
    dom = chromium(url, "--dump-dom", "--screenshot=" + shot, "--window-size=1400,%d" % height,
                   *graphics)
    return told(dom), lambda places: regions(tool, shot, places)


def is_blank(statistics):
    _, share, colours, _ = statistics
    return share < 0.02 or colours < 10


def look_until_painted(url, tool, folder, places_of):
    """What the probe tells, and the statistics of the places whole in sight. On a busy machine the
    window is sometimes taken before the last of it is painted: what is blank is looked at again, after
    ever longer waits."""
    for attempt in range(6):
        time.sleep(attempt)
        result, painted = look(url, tool, folder, SLICE, FLAT)
        seen = {i: p for i, p in enumerate(places_of(result)) if p[1] >= 0 and p[1] + p[3] <= SLICE}
        found = dict(zip(seen, painted(seen.values())))
        if not any(is_blank(statistics) for statistics in found.values()):
            break
    return result, found


def photograph(url, tool, folder):
    """What the probe tells of the whole page, and the statistics of each of its figures and of
    what stands for the scene and of the single view, without a GPU; as many windows as it takes."""
    def places_of(result):
        return [f[1:] for f in result["figures"]] + [result[key] for key in ("single", "scene") if key in result]

    first, found, top = None, {}, 0
    while True:
        result, seen = look_until_painted("%s?top=%d" % (url, top), tool, folder, places_of)
        first = first or result
        places = places_of(result)
        if not seen.keys() - found.keys():
            fail("no figure is whole in a window that starts at %d px" % top)
        found = {**seen, **found}
        missing = [p[1] for i, p in enumerate(places) if i not in found]
        if not missing:
            return first, [found[i] for i in range(len(places))]
        top += max(0, int(min(missing)) - 10)


def check_figures(name, result, painted, least_pixels):
    for figure, statistics in zip(result["figures"], painted):
        if statistics[0] < least_pixels or is_blank(statistics):
            fail("%s: figure %s is blank (%d px, %.3f, %d colours)" % (name, figure[0], *statistics[:3]))


def instrument(page, probe_script):
    with open(page, encoding="utf-8") as file:
        text = file.read().replace("<head>", "<head>" + COLLECTOR, 1)
    body = text.rindex("</body>")
    with open(page, "w", encoding="utf-8") as file:
        file.write(text[:body] + probe_script + text[body:])
