#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Opens the calibration page in headless Chromium and looks at what is painted.

usage: browser_test.py WRITE_PAGE PNG_REGIONS calibration|studies

Proves: no script error; every figure has a size and is not blank; the 3D canvas is not blank and
changes when it is dragged or turned by keys; a click on a frustum picks its view and marks it; hovering
names a point, with the value of a logarithmic axis; a drag and two fingers zoom all plots over time alike, and keys,
button and double-click undo it; the data of a plot are saved as they are drawn; the worst view has its image, and
zooms; without WebGL the still picture stands in.
"""
import os
import re
import subprocess
import sys
import tempfile

from browser import Chromium, FLAT, GPU, STUDY_PROBE, check_figures, fail, painted

# What a reader does with a page; for every page that is opened.
ACTS = """
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
  const text = plot.plumbline.mark.textContent;
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
const close = (a, b, share) => Math.abs(a - b) <= share * Math.abs(b);
// Zoom: by drag, linked over the plots over time; hover and ticks follow; undone by key, button and double-click.
const zoom = () => {
  const svg = document.getElementById('camera-frames'), plot = svg.plumbline, wrong = [];
  const other = [...document.querySelectorAll('svg.zooms')].find((s) => s !== svg && s.plumbline.axis === plot.axis);
  const [x0, x1, y0, y1, px0, px1, py0, py1] = plot.home;
  const say = (what, ok) => { if (!ok) wrong.push(what); };
  const at = (u, v) => new DOMPoint(px0 + u * (px1 - px0), py0 + v * (py1 - py0)).matrixTransform(svg.getScreenCTM());
  const dragTo = (a, b) => {
    send(svg, 'pointerdown', a.x, a.y, 1);
    send(svg, 'pointermove', (a.x + b.x) / 2, (a.y + b.y) / 2, 1);
    send(svg, 'pointermove', b.x, b.y, 1);
    send(svg, 'pointerup', b.x, b.y, 0);
    svg.dispatchEvent(new MouseEvent('click', {clientX: b.x, clientY: b.y, bubbles: true}));  // as a browser does
  };
  const isHome = (p) => p.axes.slice(0, 4).every((v, i) => v === p.home[i]);
  const timeOfView = () => document.querySelector('.views dl').textContent, first = timeOfView();
  const from = x0 + 0.25 * (x1 - x0), to = x0 + 0.75 * (x1 - x0);
  dragTo(at(0.25, 0.5), at(0.75, 0.5));
  say('range of the drag', close(plot.axes[0] - x0, from - x0, 0.01) && close(plot.axes[1] - x0, to - x0, 0.01));
  say('a drag picks nothing', timeOfView() === first);
  say('height left as it is', plot.axes[2] === y0 && plot.axes[3] === y1);
  say('linked plot', !other || (other.plumbline.axes[0] === plot.axes[0] && other.plumbline.axes[1] === plot.axes[1]));
  const labels = [...svg.querySelectorAll('text.tx')].filter((t) => t.getClientRects().length).map((t) => Number(t.textContent));
  say('ticks', labels.length >= 2 && labels.every((v) => v >= plot.axes[0] - 1e-9 && v <= plot.axes[1] + 1e-9));
  // The last point of the middle: where it is shown now, it is named with the value that it had.
  const [px, py] = svg.querySelector('polyline.data').getAttribute('points').split(' ').map((t) => t.split(',').map(Number)).find(([x]) => x > (px0 + px1) / 2);
  const {sx, tx, sy, ty} = plot.view, shown = new DOMPoint(sx * px + tx, sy * py + ty).matrixTransform(svg.getScreenCTM());
  send(svg, 'pointermove', shown.x, shown.y, 0);
  const named = (plot.mark.lastChild.textContent.match(/: (.*), (.*)$/) || []).slice(1).map(Number);
  say('hover', close(named[0], x0 + (px - px0) * (x1 - x0) / (px1 - px0), 0.01) && close(named[1], y0 + (py - py0) * (y1 - y0) / (py1 - py0), 0.01));
  send(svg, 'pointerleave', shown.x, shown.y, 0);
  const button = svg.closest('figure').querySelector('.zoom-reset');
  say('button shown', !button.hidden);
  button.click();
  say('button', isHome(plot) && (!other || isHome(other.plumbline)) && button.hidden);
  const key = (k) => svg.dispatchEvent(new KeyboardEvent('keydown', {key: k, bubbles: true, cancelable: true}));
  key('+');
  say('key +', close(plot.axes[1] - plot.axes[0], (x1 - x0) / 2, 1e-6));
  const before = plot.axes[0];
  key('ArrowRight');
  say('key right', close(plot.axes[0] - before, 0.1 * (x1 - x0), 1e-6));
  key('0');
  say('key 0', isHome(plot));
  dragTo(at(0.3, 0.2), at(0.6, 0.8));
  say('box', plot.axes[3] < y1 && plot.axes[2] > y0);
  svg.dispatchEvent(new MouseEvent('dblclick', {bubbles: true}));
  say('double-click', isHome(plot));
  const plane = document.getElementById('camera-cam0-field'), {home} = plane.plumbline;
  const scale = ([a, b, c, d, e, f, g, h]) => Math.abs((f - e) / (b - a) / ((h - g) / (d - c)));
  plane.dispatchEvent(new KeyboardEvent('keydown', {key: '+', bubbles: true, cancelable: true}));
  say('image plane', !isHome(plane.plumbline) && close(scale(plane.plumbline.axes), scale(home), 0.01));
  plane.dispatchEvent(new KeyboardEvent('keydown', {key: '0', bubbles: true, cancelable: true}));
  say('image plane back', isHome(plane.plumbline));
  return wrong;
};
// Fingers from some places to others, in client pixels.
const fingers = (svg, from, to) => {
  const touches = (points) => points.map((p, i) => new Touch({identifier: i, target: svg, clientX: p.x, clientY: p.y}));
  const tell = (kind, points) => svg.dispatchEvent(new TouchEvent(kind, {touches: touches(points), bubbles: true, cancelable: true}));
  tell('touchstart', from);
  const moved = !tell('touchmove', to);  // the page does not scroll then
  tell('touchend', []);
  return moved;
};
// Two fingers: what was under them stays under them; one moves a zoomed plot, and scrolls the page where none is.
const pinch = () => {
  const wrong = [], say = (what, ok) => { if (!ok) wrong.push(what); };
  const svg = document.getElementById('camera-frames'), plot = svg.plumbline, [x0, x1, y0, y1, px0, px1, py0, py1] = plot.home;
  const other = [...document.querySelectorAll('svg.zooms')].find((s) => s !== svg && s.plumbline.axis === plot.axis);
  const at = (on, u, v) => { const [, , , , l, r, b, t] = on.plumbline.home; return new DOMPoint(l + u * (r - l), b + v * (t - b)).matrixTransform(on.getScreenCTM()); };
  say('one finger on a whole plot scrolls', !fingers(svg, [at(svg, 0.5, 0.5)], [at(svg, 0.3, 0.5)]) && plot.axes[0] === x0);
  say('pinch is taken', fingers(svg, [at(svg, 0.4, 0.5), at(svg, 0.6, 0.5)], [at(svg, 0.3, 0.5), at(svg, 0.7, 0.5)]));
  say('range of the pinch', close(plot.axes[1] - plot.axes[0], (x1 - x0) / 2, 1e-3) && close(plot.axes[0] - x0, 0.25 * (x1 - x0), 1e-3));
  say('height left as it is', plot.axes[2] === y0 && plot.axes[3] === y1);
  say('linked', !other || other.plumbline.axes[0] === plot.axes[0]);
  const before = plot.axes[0];
  say('one finger moves', fingers(svg, [at(svg, 0.5, 0.5)], [at(svg, 0.4, 0.5)]) && close(plot.axes[0] - before, 0.05 * (x1 - x0), 1e-3));
  fingers(svg, [at(svg, 0.1, 0.5), at(svg, 0.9, 0.5)], [at(svg, 0.45, 0.5), at(svg, 0.55, 0.5)]);
  say('back to all', plot.axes[0] === x0 && plot.axes[1] === x1);
  const plane = document.getElementById('camera-cam0-field'), scale = ([a, b, c, d, e, f, g, h]) => Math.abs((f - e) / (b - a) / ((h - g) / (d - c)));
  const {home} = plane.plumbline;
  fingers(plane, [at(plane, 0.4, 0.4), at(plane, 0.6, 0.6)], [at(plane, 0.3, 0.3), at(plane, 0.7, 0.7)]);
  const {axes} = plane.plumbline;
  say('image plane', close(axes[1] - axes[0], (home[1] - home[0]) / 2, 1e-3) && close(scale(axes), scale(home), 1e-3));
  plane.dispatchEvent(new MouseEvent('dblclick', {bubbles: true}));
  const view = document.querySelector('.views svg'), box = view.getBoundingClientRect(), whole = view.viewBox.baseVal.width;
  const place = (u, v) => ({x: box.left + u * box.width, y: box.top + v * box.height});
  fingers(view, [place(0.4, 0.5), place(0.6, 0.5)], [place(0.3, 0.5), place(0.7, 0.5)]);
  const seen = view.viewBox.baseVal;
  say('single view', close(seen.width, whole / 2, 1e-3) && close(seen.x + seen.width / 2 + 1, whole / 2, 1e-2));
  view.dispatchEvent(new MouseEvent('dblclick', {bubbles: true}));
  return wrong;
};
const data = () => {
  const plot = document.getElementById('camera-frames');
  const rows = (saved(plot, '.save-csv')).trim().split('\\n').slice(2).map((line) => line.split(','));
  const map = (saved(document.getElementById('camera-cam0-region'), '.save-csv')).trim().split('\\n');
  const bars = (saved(document.getElementById('camera-cam0-histogram'), '.save-csv')).trim().split('\\n');
  const worst = Number([...document.querySelectorAll('#views table tbody tr')][0].cells[2].textContent);
  return {series: [...new Set(rows.map((r) => r[0]))], rows: rows.length, top: Math.max(...rows.map((r) => Number(r[2]))), worst,
    cells: map.length - 1, columns: document.getElementById('camera-cam0-region').plumbline.cells.columns,
    bars: bars.filter((l) => / to .*: /.test(l)).length, svg: (saved(plot, '.save-svg')).slice(0, 40)};
};
const worstView = async () => {
  const row = document.querySelector('#views table tbody a');
  location.hash = row.hash;
  await until(() => document.querySelector('.views svg image'));
  const svg = document.querySelector('.views svg'), image = svg.querySelector('image');
  if (!image) return {image: false};
  // Height and width stand behind the marker FFC0 of a JPEG.
  const box = image.getBBox(), bytes = Uint8Array.from(atob(image.getAttribute('href').split(',')[1]), (c) => c.charCodeAt(0));
  const head = bytes.findIndex((b, i) => b === 0xff && bytes[i + 1] === 0xc0);
  const whole = svg.viewBox.baseVal.width, area = svg.getBoundingClientRect();
  const seen = {image: true, width: box.width, height: box.height, pixels: 256 * bytes[head + 7] + bytes[head + 8]};
  document.querySelector('[data-image]').click();
  seen.hidden = svg.querySelector('image') === null;
  document.querySelector('[data-image]').click();
  send(svg, 'pointerdown', area.left + 100, area.top + 100, 1);
  send(svg, 'pointermove', area.left + 200, area.top + 160, 1);
  send(svg, 'pointerup', area.left + 200, area.top + 160, 0);
  seen.zoom = svg.viewBox.baseVal.width / whole;
  seen.asked = 100 / area.width;
  svg.dispatchEvent(new MouseEvent('dblclick', {bubbles: true}));
  seen.back = svg.viewBox.baseVal.width === whole;
  document.querySelector('.views [data-step="1"]').click();
  seen.next = svg.querySelector('image') === null;
  document.querySelector('.views [data-step="-1"]').click();  // is photographed with its image
  return seen;
};
// Clicks on the scene until one hits a frustum; what it picks, and what the view then says. The places are
// scattered, for each click draws the scene anew and frusta lie together.
const pickInScene = () => {
  const area = document.querySelector('.scene-canvas'), box = area.getBoundingClientRect();
  let asked = null, picked = null;
  document.addEventListener('plumbline-moment', ({detail}) => { asked = detail; });
  document.addEventListener('plumbline-picked', ({detail}) => { picked = detail; });
  for (let i = 0; i < 900 && !picked; ++i) {
    const at = 377 * i % 900;  // prime to 900: every place of the 30 x 30 once
    const x = box.left + box.width * (0.2 + 0.6 * (at % 30) / 30), y = box.top + box.height * (0.15 + 0.7 * Math.floor(at / 30) / 30);
    send(area, 'pointerdown', x, y, 1);
    send(area, 'pointerup', x, y, 0);
  }
  return {asked, picked};
};
const turnByKeys = () => {
  const area = document.querySelector('.scene-canvas');
  for (let i = 0; i < 6; ++i) area.dispatchEvent(new KeyboardEvent('keydown', {key: 'ArrowLeft', bubbles: true, cancelable: true}));
};
"""

USE = """
const picked = pick(), more = {zoom: [...zoom(), ...pinch()], data: data(), view: await worstView()};
return {...more, errors: pageErrors, live: document.getElementById('scene-box').classList.contains('live'), hover: hover(), pick: picked};
"""


def check_clicked(name, clicked, marked):
    """A click on a frustum asks for its camera and moment, and gets that view, which is marked."""
    asked, picked = clicked["asked"], clicked["picked"]
    if not asked or not picked:
        fail(name + ": no click on the scene picks a view")
    if picked["camera"] != asked["series"] or abs(picked["seconds"] - asked["seconds"]) > 0.01:
        fail("%s: a click on the frustum %s picks %s" % (name, asked, picked))
    if not marked:
        fail(name + ": the view that is picked is not marked in the scene")


def check_scene(browser, name, page, tool, turns):
    """The live scene at rest, clicked and, where it `turns`, at rest again, dragged and turned by keys: the
    scene of both kinds is one script. The share of the window that it covers."""
    browser.open(page, height=900)

    def after(act):
        result = browser.run("""const clicked = %s ?? null; await settled();
            return {clicked, live: document.getElementById('scene-box').classList.contains('live'), errors: pageErrors};""" % act)
        if result["errors"]:
            fail("%s: script errors: %s" % (name, result["errors"][:5]))
        if not result["live"]:
            fail(name + ": the 3D scene did not start although WebGL is there")
        return result["clicked"], painted(browser, tool, ".scene.live .scene-canvas")[0]

    _, rest = after("null")
    if rest[1] < 0.03 or rest[2] < 10:
        fail("%s: the 3D scene is blank (%.3f, %d colours)" % (name, rest[1], rest[2]))
    before = rest
    if turns:
        _, before = after("null")
        if before[3] != rest[3]:
            fail(name + ": the scene at rest differs between two looks, so turning proves nothing")
        for act, how in (("drag()", "when dragged"), ("turnByKeys()", "by its keys")):
            _, turned = after(act)
            if turned[1] < 0.03 or turned[3] == before[3]:
                fail("%s: the 3D scene does not turn %s" % (name, how))
            before = turned
    clicked, picked = after("pickInScene()")
    check_clicked(name, clicked, picked[3] != before[3])
    return rest[1]


def check_pick(name, pick):
    if abs(pick["after"] - pick["asked"]) > 0.5 or pick["marked"] < 1:
        fail("%s: a click at %.1f s shows the view at %.1f s and marks %d plots"
             % (name, pick["asked"], pick["after"], pick["marked"]))
    if pick["arrows"] != pick["corners"] or pick["arrows"] < 4:
        fail("%s: %d shapes for the %d corners of the view" % (name, pick["arrows"], pick["corners"]))


def check_use(name, result):
    if result["errors"]:
        fail("%s: script errors: %s" % (name, result["errors"][:5]))
    if result["zoom"]:
        fail("%s: zoom: %s" % (name, ", ".join(result["zoom"])))
    data, view = result["data"], result["view"]
    if data["series"] != ["cam0", "cam1"] or abs(data["top"] - data["worst"]) > 0.005:
        fail("%s: the saved data of the frames are %s" % (name, data))
    if data["cells"] < 12 or data["cells"] % data["columns"] or data["bars"] < 10 or not data["svg"].startswith("<svg"):
        fail("%s: the saved data of a map, a histogram and a plot are %s" % (name, data))
    if not view["image"] or (view["width"], view["height"], view["pixels"]) != (752, 480, 376):
        fail("%s: the image of the worst view: %s" % (name, view))
    if not (view["hidden"] and view["back"] and view["next"]) or not 0 < view["zoom"] < 0.5:
        fail("%s: hiding or zooming the view: %s" % (name, view))


def check_page(live, flat, name, page, tool, turns):
    covered = check_scene(live, name, page, tool, turns)
    flat.open(page)
    result = flat.run(USE)
    check_pick(name, result["pick"])
    check_use(name, result)
    if not re.match(r"^cam\d: -?[\d.e+-]+, -?[\d.e+-]+$", result["hover"]):
        fail("%s: hovering over a point says '%s'" % (name, result["hover"]))
    figures = check_figures(flat, name, tool, 20000)
    if figures < 8:
        fail("%s: only %d figures" % (name, figures))
    flat.dress(1400, 1000)
    single, still = painted(flat, tool, ".views svg")[0], painted(flat, tool, ".scene-still")[0]
    if single[1] < 0.3:
        fail("%s: the image of the worst view is not painted: %.3f of its place" % (name, single[1]))
    if result["live"]:
        fail(name + ": the 3D scene is live without WebGL")
    if still[1] < 0.03 or still[2] < 10:
        fail(name + ", without WebGL: the still picture is blank")
    print("%s: %d figures, none blank; scene covers %.1f %% and turns; hover says %s; without WebGL "
          "a still picture stands in" % (name, figures, 100 * covered, result["hover"]))


def check_basin(name, basin):
    """Hover and CSV name the bound by its own series, and tell it in seconds, not their logarithm."""
    says = re.match(r"bound of the basin, 2 ms: [-\d.]+, ([\d.e-]+)$", basin["says"][0])
    if not says or abs(float(says[1]) - 2e-3) > 1e-5:
        fail("%s: hovering over the bound of 2 ms says '%s'" % (name, basin["says"][0]))
    rows = [line.rsplit(",", 3) for line in basin["csv"].splitlines() if "bound of the basin" in line]
    if len(rows) != 2 or any(abs(float(row[2]) - 2e-3) > 2e-5 for row in rows):
        fail("%s: the saved data of the bound of 2 ms are %s" % (name, rows))
    failed = [line.rsplit(",", 3) for line in basin["csv"].splitlines() if line.startswith("failed")]
    if not failed or any(row[2] != "" for row in failed):
        fail("%s: the saved data of cases that failed are %s" % (name, failed))
    if not any(re.match(r"failed: [-\d.]+, no value$", says) for says in basin["says"]):
        fail("%s: hovering over a case that failed says none of %s" % (name, basin["says"]))
    if not re.match(r"# as drawn: x to within [\d.]+, y to within [\d.]+ %\n", basin["csv"]):
        fail("%s: the saved data begin with '%s'" % (name, basin["csv"].splitlines()[0]))


def check_study(browser, name, page, tool):
    browser.open(page)
    result = browser.run(STUDY_PROBE)
    if result["errors"]:
        fail("%s: script errors: %s" % (name, result["errors"][:5]))
    figures = check_figures(browser, name, tool, 15000)
    if figures < 4 or not result["tables"]:
        fail("%s: only %d figures" % (name, figures))
    if name == "perturbation":
        check_basin(name, {plot["id"]: plot for plot in result["logarithmic"]}["perturbation-basin"])
    print("%s: %d figures, none blank" % (name, figures))


def check_calibrations(write_page, tool, folder):
    with Chromium(*GPU, script=ACTS) as live, Chromium(*FLAT, script=ACTS) as flat:
        for name, options in (("camera-IMU", ["60"]), ("cameras only", ["30", "camera-only"])):
            page = os.path.join(folder, "page.html")
            subprocess.run([write_page, page, *options], check=True, stdout=subprocess.DEVNULL)
            check_page(live, flat, name, page, tool, turns=name == "camera-IMU")


def check_studies(write_page, tool, folder):
    with Chromium(*FLAT) as browser:
        for study in ("perturbation", "trajectory", "comparison", "study"):
            page = os.path.join(folder, study + ".html")
            subprocess.run([write_page, page, study], check=True)
            check_study(browser, study, page, tool)


def main():
    write_page, tool, pages = sys.argv[1:4]
    with tempfile.TemporaryDirectory() as folder:
        check = {"calibration": check_calibrations, "studies": check_studies}[pages]
        check(write_page, tool, folder)


if __name__ == "__main__":
    main()
