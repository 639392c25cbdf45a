#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Opens the page of a replay in headless Chromium and plays with it.

usage: replay_browser_test.py WRITE_REPLAY_PAGE PNG_REGIONS

Proves, with the page opened as a file and without a GPU: no script error; the log says of every
frame what the record says of it, by slider, keys, events, timeline and playing; nothing is blank;
corners, images and suggestions are drawn where they belong; the scene turns; the player fits into
the window of a laptop; 1,500 stereo frames with images stay below 30 MB.
"""
import json
import math
import os
import subprocess
import sys
import tempfile

from browser import FLAT, STUDY_PROBE, Chromium, check_figures, fail

FIELDS = ["frame", "time", "stage", "mode", "reason", "mi", "entropy", "suggestion", "distance"]
# How the sentence on a frame of a reason begins, and what the error is called in its stage: a stamp
# of the camera stage jumped, and its frame was left out; IMU samples were missing before a frame of
# the camera-IMU stage, and it was kept.
WHYS = {"time-jump": ["Not kept: its stamp", "Predicted error in later use"],
        "imu-gap": ["Kept, but linked", "Points by the IMU, expected"]}
MOST_BYTES = 30_000_000

PROBE = """
const part = (name) => document.querySelector(`[data-part="${name}"]`);
const field = (name) => document.querySelector(`[data-field="${name}"] span`).textContent;
const slide = (f) => { const s = part('slider'); s.value = f; s.dispatchEvent(new Event('input', {bubbles: true})); };
const press = (key, more) => document.body.dispatchEvent(new KeyboardEvent('keydown', {key, bubbles: true, cancelable: true, ...more}));
// The player's pictures are decoded, and drawn, some time after a frame is shown.
const Picture = Image;
let pending = 0;
window.Image = class extends Picture { constructor() { super(); ++pending; this.addEventListener('load', () => --pending); } };
const decoded = () => until(() => pending === 0);
const frame = () => Number(field('frame').split(' ')[0]);
const pixels = (c) => c.getContext('2d').getImageData(0, 0, c.width, c.height).data;
const looks = (c) => {
  const seen = new Map(), data = pixels(c);
  for (let i = 0; i < data.length; i += 4) {
    const key = data[i] << 24 ^ data[i + 1] << 16 ^ data[i + 2] << 8 ^ data[i + 3];
    seen.set(key, (seen.get(key) || 0) + 1);
  }
  return {colours: seen.size, share: 1 - Math.max(...seen.values()) / (data.length / 4)};
};
const hash = (c) => pixels(c).reduce((h, v) => (h * 31 + v) | 0, 7);
// How many pixels have the hue of what is asked for: far more red than blue.
const asked = (c) => { let n = 0; const d = pixels(c); for (let i = 0; i < d.length; i += 4) if (d[i] > 150 && d[i] - d[i + 2] > 90) ++n; return n; };
const send = (target, kind, x, y, buttons) => target.dispatchEvent(new PointerEvent(kind, {clientX: x, clientY: y,
  pointerId: 1, pointerType: 'mouse', isPrimary: true, button: 0, buttons, bubbles: true, cancelable: true}));
const turn = (canvas) => {
  const box = canvas.getBoundingClientRect(), x = box.left + 80, y = box.top + 80;
  send(canvas, 'pointerdown', x, y, 1);
  for (let i = 1; i < 8; ++i) send(canvas, 'pointermove', x + 9 * i, y + 3 * i, 1);
  send(canvas, 'pointerup', x + 72, y + 24, 0);
};
const keys = () => {
  slide(40);
  const steps = [['ArrowRight', {}], ['ArrowLeft', {}], ['ArrowRight', {shiftKey: true}], ['ArrowLeft', {shiftKey: true}],
    ['ArrowDown', {}], ['ArrowUp', {}], ['End', {}], ['Home', {}]];
  return steps.map(([key, more]) => { press(key, more); return [key, frame()]; });
};
// Time is taken along: on a busy machine waiting lasts longer.
const playing = async () => {
  slide(10);
  let begun = performance.now();
  press(' ');
  await wait(700);
  const during = frame(), took = performance.now() - begun;
  press(' ');
  const stopped = frame();
  await wait(200);
  const resting = frame(), play = document.querySelector('[data-act="play"]');
  part('speed').value = '8';
  begun = performance.now();
  play.click();
  // Of the moment at which it came to the frame: on a busy machine the look may come later.
  let fast = {frame: resting, took: 0};
  await until(() => {
    if (frame() !== fast.frame) fast = {frame: frame(), took: performance.now() - begun};
    return frame() > resting + 30;
  });
  if (play.classList.contains('playing')) play.click();
  return {during, took, stopped, resting, fast};
};
const views = () => [...document.querySelectorAll('.player-view canvas')];
const result = {errors: pageErrors, log: [], looks: {}, tags: [], size: [innerWidth, innerHeight, document.getElementById('player').getBoundingClientRect().bottom + scrollY]};
const count = Number(part('slider').max) + 1;
result.opened = [frame(), window.plumblineReplay.player.data.events[0].frame, field('why')];
for (let f = 0; f < count; f += wanted.step) { slide(f); result.log.push(wanted.fields.map(field)); }
for (const [f, u, v, width] of wanted.tags) {
  slide(f);
  await decoded();
  const c = views()[0], s = c.width / width;
  result.tags.push([...c.getContext('2d').getImageData((u + 0.5) * s, (v + 0.5) * s, 1, 1).data]);
}
const scene = document.querySelector('.player-scene canvas');
slide(wanted.with_suggestion);
await decoded();
for (const c of document.querySelectorAll('#player canvas')) result.looks[Object.keys(result.looks).length] = looks(c);
result.asked = [asked(views()[0]), asked(scene)];
result.legend = part('legend').textContent;
const before = hash(scene);
turn(scene);
result.turned = hash(scene) !== before;
slide(wanted.trajectory);
result.candidates = part('candidates').hidden ? '' : part('candidates').textContent;
slide(wanted.without_suggestion);
await decoded();
result.not_asked = asked(views()[0]);
result.keys = keys();
const {data} = window.plumblineReplay.player;
slide(2);
result.withdrawn = [data.keptBy(3).includes(2), data.keptBy(4).includes(2), data.stays(2), data.stays(3), field('detail')];
result.whys = wanted.whys.map((f) => { slide(f); return [field('why'), document.querySelector('[data-field="error"] b').textContent]; });
result.events = [...document.querySelectorAll('.player-events button')].map((b) => { b.click(); return [b.className, frame(), b.textContent]; });
const line = document.querySelector('[data-line="scores"]').getBoundingClientRect();
send(document.querySelector('[data-line="scores"]'), 'pointerdown', line.left + 46 + (line.width - 56) / 2, line.top + 30, 1);
result.line = frame();
result.playing = await playing();
result.note = (document.querySelector('.player-note') || {textContent: ''}).textContent;
return result;
"""


def decisions_of(page):
    """Rows of what the record says, as write_page left them beside the page."""
    rows = []
    with open(page + ".decisions", encoding="utf-8") as file:
        for line in file:
            w = line.split()
            number = [None if v == "-" else float(v) for v in w[5:]]
            rows.append({"frame": int(w[0]), "seconds": float(w[1]), "stage": w[2], "mode": w[3],
                         "reason": w[4], "mi": number[0], "entropy": number[1],
                         "suggestion": number[2], "distance": number[3], "tag": number[4:6]})
    return rows


def expected_log(d, last):
    """The fields' texts, from the record's numbers and the units alone."""
    bits = 1 / math.log(2)
    none = "\u2013"
    gain = none
    if d["mi"] is not None:
        gain = "unbounded" if math.isinf(d["mi"]) else "%.3f bits (%.3f nats)" % (d["mi"] * bits,
                                                                                d["mi"])
    entropy = none if d["entropy"] is None else "%.3f nats (%.3f bits)" % (d["entropy"],
                                                                            d["entropy"] * bits)
    asked = none if d["suggestion"] is None else "#%d" % d["suggestion"]
    distance = none if d["distance"] is None else "%.1f px" % d["distance"]
    return ["%d of %d" % (d["frame"], last), "%.3f s" % d["seconds"], d["stage"], d["mode"],
            d["reason"], gain, entropy, asked, distance]


def check_log(name, result, decisions, step):
    shown = result["log"]
    if len(shown) != len(decisions[::step]):
        fail("%s: the slider has %d frames, the record %d" % (name, len(shown), len(decisions)))
    suggested = 0
    for said, d in zip(shown, decisions[::step]):
        said[7] = said[7].split(" ")[0]  # "#3 name"
        if said != expected_log(d, len(decisions) - 1):
            fail("%s: the log says %s where the record has %s" % (name, said, d))
        suggested += d["suggestion"] is not None
    if suggested < 5:
        fail(name + ": hardly any frame with a suggestion was compared")


def check_moves(name, result, decisions):
    last = len(decisions) - 1
    seconds = [d["seconds"] for d in decisions]
    keys = dict((key, frame) for key, frame in result["keys"][4:])
    moves = [frame for _, frame in result["keys"][:4]]
    if moves != [41, 40, 60, 40]:
        fail("%s: arrows lead to %s" % (name, moves))
    frames = [frame for _, frame, _ in result["events"]]
    after = min(f for f in frames if f > 40)
    if keys["ArrowDown"] != after or keys["ArrowUp"] != max(f for f in frames if f < after):
        fail("%s: up and down do not lead to the events: %s" % (name, keys))
    if keys["End"] != last or keys["Home"] != 0:
        fail("%s: home and end lead to %s" % (name, keys))
    if abs(result["line"] - last / 2) > 1:
        fail("%s: a click on the middle of the timeline leads to %s" % (name, result["line"]))
    p = result["playing"]
    played = (seconds[p["during"]] - seconds[10]) / (p["took"] / 1000)
    if not 0.4 < played < 1.5 or p["resting"] != p["stopped"] or not 0 <= p["stopped"] - p["during"] <= 2:
        fail("%s: playing shows %.2f s a second, %s" % (name, played, p))
    fast = (seconds[p["fast"]["frame"]] - seconds[p["resting"]]) / (p["fast"]["took"] / 1000)
    if not 3 < fast < 12:
        fail("%s: at eight times the speed %.2f s are shown a second: %s" % (name, fast, p))


def check_events(name, result, decisions):
    kinds = [kind.split()[0] for kind, _, _ in result["events"]]
    frames = [frame for _, frame, _ in result["events"]]
    if frames != sorted(frames) or not {"initialised", "opened", "reached", "expired", "withdrawn", "finished",
                                        "problem"} <= set(kinds):
        fail("%s: events %s at %s" % (name, kinds, frames))
    for kind, reason in (("initialised", "initialised"), ("problem", "time-jump")):
        there = [d["frame"] for d in decisions if d["reason"] == reason]
        if not set(there) <= {f for f, k in zip(frames, kinds) if k == kind}:
            fail("%s: no event at the frames %s that are %s" % (name, there, reason))
    if result["withdrawn"] != [True, False, False, True, "removed from the estimate at frame 4"]:
        fail("%s: frame 2, withdrawn with frame 4, is told as %s" % (name, result["withdrawn"]))
    for (why, label), (begin, named) in zip(result["whys"], WHYS.values()):
        if not why.startswith(begin) or label != named:
            fail("%s: '%s' and '%s' where '%s ...' and '%s' are due" % (name, why, label, begin, named))
    lost = [text for _, _, text in result["events"] if "target lost" in text]
    if len(lost) != 1 or "frames)" not in lost[0] or '> & "more"' not in lost[0]:
        fail("%s: the lost target is said as %s" % (name, lost))


def check_drawn(name, result):
    for index, looks in result["looks"].items():
        if looks["share"] < 0.01 or looks["colours"] < 5:
            fail("%s: canvas %s is blank: %s" % (name, index, looks))
    if result["opened"][0] != result["opened"][1]:
        fail("%s: opens on frame %d, the first event is at %d" % (name, *result["opened"][:2]))
    if not result["opened"][2].endswith("."):
        fail("%s: no sentence says why a frame was kept: %s" % (name, result["opened"][2]))
    if len(result["looks"]) != 5:
        fail("%s: %d canvases" % (name, len(result["looks"])))
    dark = [pixel for pixel in result["tags"] if max(pixel[:3]) < 110]
    if len(dark) < 3 or len(dark) != len(result["tags"]):
        fail("%s: tags are not drawn where the corners are: %s" % (name, result["tags"]))
    asked, in_scene = result["asked"]
    if asked < 100 or in_scene < 50 or result["not_asked"] > 0:
        fail("%s: suggestion drawn with %d and %d pixels, %d without one"
             % (name, asked, in_scene, result["not_asked"]))
    if not result["turned"]:
        fail(name + ": the scene does not turn when dragged")
    if "bits" not in result["legend"] or "figure 8" not in result["candidates"]:
        fail("%s: candidates are not explained: %s, %s" % (name, result["legend"], result["candidates"]))


def images_of(page):
    """The frames whose images the page has."""
    with open(page, encoding="utf-8") as file:
        text = file.read()
    start = text.index(">", text.index('id="replay-data"')) + 1
    return set(json.loads(text[start:text.index("</script>", start)])["images"]["frames"])


def wanted_of(decisions, step, images):
    """What the probe shall look at; tags where no earlier image shines through."""
    camera = [d for d in decisions if d["stage"] == "camera"]
    far = [d for d in camera if d["suggestion"] is not None and (d["distance"] or 0) > 60]
    plain = [d for d in camera if d["suggestion"] is None and d["tag"][0] is not None]
    sharp = [d for d in plain if not images or d["frame"] in images]
    path = [d for d in decisions if d["stage"] == "camera-imu" and d["suggestion"] is not None]
    return {"step": step, "fields": FIELDS, "with_suggestion": far[0]["frame"],
            "without_suggestion": plain[0]["frame"], "trajectory": path[0]["frame"],
            "whys": [[d["frame"] for d in decisions if d["reason"] == reason][0] for reason in WHYS],
            "tags": [[d["frame"], *d["tag"], 752] for d in sharp[::max(1, len(sharp) // 5)]]}


def check_page(browser, name, write_page, folder, options):
    """options: frames, columns of tags, images or not, every how many-th frame is read."""
    page = os.path.join(folder, "replay.html")
    words = [str(options["frames"]), str(options["columns"])] + ["images"] * options["images"]
    subprocess.run([write_page, page, *words], check=True)
    size = os.path.getsize(page)
    if size >= MOST_BYTES:
        fail("%s: %d bytes" % (name, size))
    decisions = decisions_of(page)
    wanted = wanted_of(decisions, options["step"], images_of(page))
    browser.open(page, 1366, 740)
    result = browser.run("const wanted = %s;" % json.dumps(wanted) + PROBE)
    if result["errors"]:
        fail("%s: script errors: %s" % (name, result["errors"][:5]))
    check_log(name, result, decisions, options["step"])
    check_events(name, result, decisions)
    check_drawn(name, result)
    if options["frames"] == 300:
        check_moves(name, result, decisions)
    left_out = bool(options["images"]) and options["frames"] == 1500
    if left_out != ("has its own" in result["note"]):
        fail("%s: of the images it says '%s'" % (name, result["note"]))
    width, height, bottom = result["size"]
    if bottom > height or height > 740:
        fail("%s: the player ends at %d px of a window of %d x %d" % (name, bottom, width, height))
    print("%s: %.1f MB; %d frames' logs are the record's; player %d px high in %d x %d; %s"
          % (name, size / 1e6, len(result["log"]), bottom, width, height, result["note"]))


BARE_PROBE = """
const views = [...document.querySelectorAll('.player-view canvas')].map((c) =>
  new Set(new Uint32Array(c.getContext('2d').getImageData(0, 0, c.width, c.height).data.buffer)).size);
return {errors: pageErrors, views, text: document.getElementById('player').innerText};
"""


def check_bare(browser, write_page, folder):
    """A replay that did not get anywhere still shows what was recorded; an empty one says so."""
    for words, views in ((["60", "6", "bare"], 2), (["0", "6"], 0)):
        page = os.path.join(folder, "bare.html")
        subprocess.run([write_page, page, *words], check=True)
        browser.open(page)
        result = browser.run(BARE_PROBE)
        blank = [colours for colours in result["views"] if colours < 5]
        if result["errors"] or len(result["views"]) != views or blank:
            fail("%s: %s, %s" % (words, result["views"], result["errors"]))
        if views == 0 and "no frames" not in result["text"]:
            fail("an empty replay says: " + result["text"])
    print("without decisions: the corners are shown; without frames: the page says so")


ERROR_PROBE = """
const field = (name) => document.querySelector(`[data-field="${name}"]`);
const slide = (f) => { const s = document.querySelector('[data-part="slider"]'); s.value = f; s.dispatchEvent(new Event('input', {bubbles: true})); };
const {data, scene} = window.plumblineReplay.player;
const frames = [...Array(data.frames).keys()].filter((f) => data.table.error_bound[f] > 0);
const log = frames.map((f) => { slide(f); return {kept: data.stays(f), gains: data.table.mi[f] >= data.table.threshold[f],
  green: ['mi', 'error_with', 'why'].map((n) => field(n).classList.contains('good')), px: field('error_with').innerText, why: field('why').innerText}; });
const round = data.rounds[0];
slide(round.frame);
const worth = [...round.error].map((px, i) => [scene.worth(round, i), round.error_before - px]).filter((w) => !Number.isNaN(w[0]));
return {errors: pageErrors, log, worth, legend: document.querySelector('[data-part="legend"]').textContent,
  key: document.querySelector('.player-key').textContent, bottom: document.getElementById('player').getBoundingClientRect().bottom + scrollY,
  height: innerHeight, lines: [...document.querySelectorAll('.player-lines canvas')].map((c) => c.getAttribute('aria-label'))};
"""


def check_by_error(browser, write_page, folder):
    """Where predicted errors decided, they are what is drawn, coloured and compared."""
    page = os.path.join(folder, "errors.html")
    subprocess.run([write_page, page, "300", "6", "errors"], check=True)
    browser.open(page, 1366, 740)
    result = browser.run(ERROR_PROBE)
    if result["errors"]:
        fail("by predicted error: script errors: %s" % result["errors"][:5])
    log = result["log"]
    if not any(d["gains"] and not d["kept"] for d in log):
        fail("by predicted error: no rejected frame gains more than the threshold")
    for d in log:
        if d["green"] != [False, d["kept"], d["kept"]] or "px (bound" not in d["px"] or "bound of" not in d["why"]:
            fail("by predicted error: a frame is shown as %s" % d)
    scores, course = result["lines"]
    if "[px]" not in scores or "bits" in scores or "[%]" not in course or "stop at 2 %" not in course:
        fail("by predicted error: the charts are %s" % result["lines"])
    if any(abs(shown - lowered) > 1e-6 for shown, lowered in result["worth"]) or len(result["worth"]) < 50:
        fail("by predicted error: candidates are coloured by %s" % result["worth"][:5])
    if "lower the error" not in result["legend"] or "bits" in result["legend"] or "bound" not in result["key"]:
        fail("by predicted error: legends '%s', '%s'" % (result["legend"], result["key"]))
    if result["bottom"] > result["height"]:
        fail("by predicted error: the player ends at %d px" % result["bottom"])
    print("by predicted error: %d frames are shown in px against their bounds" % len(log))


def check_static_part(browser, write_page, tool, folder):
    """The static part, as the pages of studies are looked at."""
    page = os.path.join(folder, "figures.html")
    subprocess.run([write_page, page, "300", "6"], check=True)
    browser.open(page)
    result = browser.run(STUDY_PROBE)
    figures = check_figures(browser, "static part", tool, 15000)
    if result["errors"] or figures < 3 or result["tables"] < 6:
        fail("static part: %d figures, %d tables, %s" % (figures, result["tables"], result["errors"]))
    print("static part: %d figures, none blank; %d tables" % (figures, result["tables"]))


def main():
    write_page, tool = sys.argv[1:3]
    with tempfile.TemporaryDirectory() as folder, Chromium(*FLAT) as browser:
        pages = (("300 frames", {"frames": 300, "columns": 6, "images": 0, "step": 1}),
                 ("300 frames, images", {"frames": 300, "columns": 6, "images": 1, "step": 7}),
                 ("1,500 frames, images", {"frames": 1500, "columns": 12, "images": 1, "step": 11}))
        for name, options in pages:
            check_page(browser, name, write_page, folder, options)
        check_by_error(browser, write_page, folder)
        check_bare(browser, write_page, folder)
        check_static_part(browser, write_page, tool, folder)


if __name__ == "__main__":
    main()
