#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Opens the calibration page in headless Chromium and looks at what is painted.

usage: browser_test.py WRITE_PAGE PNG_REGIONS calibration|studies

Proves: no script error; every figure has a size and is not blank; the 3D canvas is not blank and
changes when it is dragged; hovering names a point; without WebGL the still picture stands in.
"""
import json
import os
import re
import shutil
import subprocess
import sys
import tempfile

COLLECTOR = """<script>
window.pageErrors = [];
window.addEventListener('error', (e) => pageErrors.push(String(e.message)));
window.addEventListener('unhandledrejection', (e) => pageErrors.push(String(e.reason)));
const tell = console.error;
console.error = (...words) => { pageErrors.push(words.join(' ')); tell(...words); };
Element.prototype.setPointerCapture = () => {};  // made-up pointers cannot be captured
// ?top=N moves the page up by N pixels, so that a window of moderate height sees any part of it.
const moveUp = (by) => { document.body.style.marginTop = `-${by}px`; };
addEventListener('DOMContentLoaded', () => {
  const by = new URLSearchParams(location.search).get('top');
  if (by) moveUp(Number(by));
});
</script>"""

PROBE = """<script>
const place = (e) => { const r = e.getBoundingClientRect(); return [r.left + scrollX, r.top + scrollY, r.width, r.height]; };
const send = (target, kind, x, y, buttons) => target.dispatchEvent(new PointerEvent(kind, {clientX: x, clientY: y,
  pointerId: 1, pointerType: 'mouse', isPrimary: true, button: 0, buttons, bubbles: true, cancelable: true}));
const drag = () => {
  const area = document.querySelector('.scene-canvas');
  const [x, y] = [area.getBoundingClientRect().left + 300, area.getBoundingClientRect().top + 200];
  send(area, 'pointerdown', x, y, 1);
  for (let i = 1; i <= 12; ++i) send(area, 'pointermove', x + 12 * i, y + 3 * i, 1);
  send(area, 'pointerup', x + 144, y + 36, 0);
};
const hover = () => {
  const plot = document.getElementById('camera-frames');
  const line = plot.querySelector('polyline.data');
  const [px, py] = line.getAttribute('points').split(' ')[5].split(',').map(Number);
  const at = new DOMPoint(px, py).matrixTransform(plot.getScreenCTM());
  send(plot, 'pointermove', at.x, at.y, 0);
  const text = plot.lastElementChild.textContent;
  send(plot, 'pointerleave', at.x, at.y, 0);
  return text;
};
// A click on a moment of a plot shows the view of then, and every plot over time marks it.
const pick = () => {
  const plot = document.getElementById('camera-frames'), list = document.querySelector('.views dl');
  const told = (name) => [...list.querySelectorAll('dt')].find((t) => t.textContent === name).nextSibling.textContent;
  const before = told('time'), [x0, x1, , , px0, px1, py0, py1] = plot.dataset.ax.split(' ').map(Number);
  const at = new DOMPoint(px0 + 0.75 * (px1 - px0), (py0 + py1) / 2).matrixTransform(plot.getScreenCTM());
  plot.dispatchEvent(new MouseEvent('click', {clientX: at.x, clientY: at.y, bubbles: true}));
  const marked = [...document.querySelectorAll('svg[data-ax] line[stroke="#c8500a"]')].filter((l) => l.style.display === '').length;
  return {before, after: parseFloat(told('time')), asked: x0 + 0.75 * (x1 - x0), marked,
    arrows: document.querySelectorAll('.views path').length, corners: Number(told('corners used')) + Number(told('rejected'))};
};
if (location.hash) moveUp(document.getElementById('scene-box').getBoundingClientRect().top - 20);
setTimeout(() => {
  if (location.hash === '#drag') drag();
  const result = {errors: pageErrors, height: document.documentElement.scrollHeight,
    live: document.getElementById('scene-box').classList.contains('live'), hover: hover(), pick: pick(),
    scene: place(document.querySelector('#scene-box.live .scene-canvas') || document.querySelector('.scene-still')),
    figures: [...document.querySelectorAll('figure svg')].map((s) => [s.id, ...place(s)])};
  const out = document.createElement('script');
  out.type = 'application/json';
  out.id = 'probe';
  out.textContent = JSON.stringify(result);
  document.body.append(out);
}, 1500);
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


def photograph(url, tool, folder):
    """What the probe tells of the whole page, and the statistics of each of its figures and of
    what stands for the scene, without a GPU; as many windows as it takes."""
    first, found, top = None, {}, 0
    while True:
        result, painted = look("%s?top=%d" % (url, top), tool, folder, SLICE, FLAT)
        first = first or result
        places = [f[1:] for f in result["figures"]] + [result[key] for key in ("scene",) if key in result]
        seen = [i for i, p in enumerate(places)
                if i not in found and p[1] >= 0 and p[1] + p[3] <= SLICE]
        if not seen:
            fail("no figure is whole in a window that starts at %d px" % top)
        found.update(zip(seen, painted([places[i] for i in seen])))
        missing = [p[1] for i, p in enumerate(places) if i not in found]
        if not missing:
            return first, [found[i] for i in range(len(places))]
        top += max(0, int(min(missing)) - 10)


def check_figures(name, result, painted, least_pixels):
    for figure, (pixels, share, colours, _) in zip(result["figures"], painted):
        if pixels < least_pixels or share < 0.02 or colours < 10:
            fail("%s: figure %s is blank (%d px, %.3f, %d colours)"
                 % (name, figure[0], pixels, share, colours))


def check_scene(name, page, tool, folder):
    """The live scene, at rest, dragged, and at rest again. The share of the window that it covers,
    and what hovering over a figure says."""
    painted = []
    for fragment in ("#rest", "#drag", "#rest"):
        result, statistics = look("file://" + page + fragment, tool, folder, 900, GPU)
        if result["errors"]:
            fail("%s: script errors: %s" % (name, result["errors"][:5]))
        if not result["live"]:
            fail(name + ": the 3D scene did not start although WebGL is there")
        if result["scene"][1] < 0 or result["scene"][1] + result["scene"][3] > 900:
            fail(name + ": the 3D scene is not in sight")
        painted.append(statistics([result["scene"]])[0])
    rest, moved, again = painted
    if again[3] != rest[3]:
        fail(name + ": the scene at rest differs between two looks, so turning proves nothing")
    if rest[1] < 0.03 or rest[2] < 10:
        fail("%s: the 3D scene is blank (%.3f, %d colours)" % (name, rest[1], rest[2]))
    if moved[1] < 0.03 or moved[3] == rest[3]:
        fail(name + ": the 3D scene does not turn when dragged")
    return rest[1], result["hover"]


def check_pick(name, pick):
    if abs(pick["after"] - pick["asked"]) > 0.5 or pick["marked"] < 1:
        fail("%s: a click at %.1f s shows the view at %.1f s and marks %d plots"
             % (name, pick["asked"], pick["after"], pick["marked"]))
    if pick["arrows"] != pick["corners"] or pick["arrows"] < 4:
        fail("%s: %d shapes for the %d corners of the view" % (name, pick["arrows"], pick["corners"]))


def check_page(name, page, tool, folder):
    covered, hover = check_scene(name, page, tool, folder)
    if not re.match(r"^cam\d: -?[\d.e+-]+, -?[\d.e+-]+$", hover):
        fail("%s: hovering over a point says '%s'" % (name, hover))
    check_pick(name, told(chromium("file://" + page, "--dump-dom", *FLAT))["pick"])
    result, (*figures, still) = photograph("file://" + page, tool, folder)
    if len(result["figures"]) < 8:
        fail("%s: only %d figures" % (name, len(result["figures"])))
    check_figures(name, result, figures, 20000)
    if result["errors"] or result["live"]:
        fail("%s, without WebGL: live %s, errors %s" % (name, result["live"], result["errors"][:5]))
    if still[1] < 0.03 or still[2] < 10:
        fail(name + ", without WebGL: the still picture is blank")
    print("%s: %d figures, none blank; scene covers %.1f %% and turns; hover says %s; without WebGL "
          "a still picture stands in" % (name, len(figures), 100 * covered, hover))


STUDY_PROBE = """<script>
setTimeout(() => {
  const place = (e) => { const r = e.getBoundingClientRect(); return [r.left + scrollX, r.top + scrollY, r.width, r.height]; };
  const out = document.createElement('script');
  out.type = 'application/json';
  out.id = 'probe';
  out.textContent = JSON.stringify({errors: pageErrors,
    figures: [...document.querySelectorAll('figure svg')].map((s) => [s.id, ...place(s)]),
    tables: [...document.querySelectorAll('table')].map((t) => place(t))});
  document.body.append(out);
}, 500);
</script>"""


def check_study(name, page, tool, folder):
    result, figures = photograph("file://" + page, tool, folder)
    if result["errors"]:
        fail("%s: script errors: %s" % (name, result["errors"][:5]))
    if len(result["figures"]) < 4 or not result["tables"]:
        fail("%s: only %d figures" % (name, len(result["figures"])))
    check_figures(name, result, figures, 15000)
    print("%s: %d figures, none blank" % (name, len(figures)))


def instrument(page, probe_script):
    with open(page, encoding="utf-8") as file:
        text = file.read().replace("<head>", "<head>" + COLLECTOR, 1)
    body = text.rindex("</body>")
    with open(page, "w", encoding="utf-8") as file:
        file.write(text[:body] + probe_script + text[body:])


def check_calibrations(write_page, tool, folder):
    for name, options in (("camera-IMU", ["60"]), ("cameras only", ["30", "camera-only"])):
        page = os.path.join(folder, "page.html")
        subprocess.run([write_page, page, *options], check=True, stdout=subprocess.DEVNULL)
        instrument(page, PROBE)
        check_page(name, page, tool, folder)


def check_studies(write_page, tool, folder):
    for study in ("perturbation", "trajectory", "comparison", "study"):
        page = os.path.join(folder, study + ".html")
        subprocess.run([write_page, page, study], check=True)
        instrument(page, STUDY_PROBE)
        check_study(study, page, tool, folder)


def main():
    write_page, tool, pages = sys.argv[1:4]
    with tempfile.TemporaryDirectory() as folder:
        check = {"calibration": check_calibrations, "studies": check_studies}[pages]
        check(write_page, tool, folder)


if __name__ == "__main__":
    main()
