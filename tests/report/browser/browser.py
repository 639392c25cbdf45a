# SPDX-License-Identifier: BSD-3-Clause
"""Headless Chromium for the tests of pages: one that stays for all pages of a test, is told over a socket what to
open and to run, and gives statistics of what is painted. No test by itself.
"""
import base64
import json
import os
import shutil
import socket
import subprocess
import sys
import tempfile

PATIENCE = 300  # for any answer [s]; a busy machine is slow

# Runs in every page before its own scripts.
COLLECTOR = """
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
// Client coordinates: those of a screenshot.
const place = (e) => { const r = e.getBoundingClientRect(); return [r.left, r.top, r.width, r.height]; };
const wait = (ms) => new Promise((done) => setTimeout(done, ms));
// Until something holds; what does not hold after 30 s is the test's to see.
const until = async (holds) => { for (const end = Date.now() + 30000; !holds() && Date.now() < end;) await wait(20); };
// Loaded, every image decoded, and painted twice since.
const settled = async () => {
  if (document.readyState !== 'complete') await new Promise((done) => addEventListener('load', done));
  await document.fonts.ready;
  await Promise.allSettled([...document.querySelectorAll('img, image')].map((image) => image.decode()));
  for (let i = 0; i < 2; ++i) await new Promise((done) => requestAnimationFrame(done));
  await wait(0);
};
"""

STUDY_PROBE = """
// Of each plot with a logarithmic axis: what pointing at the first point of each series says, and what is saved.
const logarithmic = [...document.querySelectorAll('figure svg[data-log]')].map((svg) => {
  const says = svg.plumbline.shapes().map(({points: [[x, y]]}) => {
    const at = new DOMPoint(x, y).matrixTransform(svg.getScreenCTM());
    svg.dispatchEvent(new PointerEvent('pointermove', {clientX: at.x, clientY: at.y, bubbles: true}));
    return svg.plumbline.mark.lastChild.textContent;
  });
  svg.dispatchEvent(new PointerEvent('pointerleave'));
  return {id: svg.id, says, csv: saved(svg, '.save-csv')};
});
return {errors: pageErrors, logarithmic, tables: document.querySelectorAll('table').length};
"""

# WebGL in software; what surrounds it is painted by the processor at once, not through WebGL.
GPU = ["--use-angle=swiftshader", "--enable-unsafe-swiftshader", "--disable-gpu-rasterization"]
# Everything but the live scene is looked at without: painting tall windows takes a fifth of the time.
FLAT = ["--disable-gpu", "--disable-3d-apis"]


def fail(message):
    print("FAIL: " + message)
    sys.exit(1)


class Chromium:
    """Speaks DevTools' protocol: JSON, every message ended by a zero byte, over the descriptors 3 and 4. When this
    end is closed Chromium ends."""

    def __init__(self, *options, script=""):
        program = shutil.which("chromium") or shutil.which("chromium-browser")
        if not program:
            fail("chromium is missing; install Debian's package chromium")
        self.folder = tempfile.TemporaryDirectory(ignore_cleanup_errors=True)
        self.said = os.path.join(self.folder.name, "stderr")
        self.line, theirs = socket.socketpair()
        self.line.settimeout(PATIENCE)
        theirs.set_inheritable(True)
        command = [program, "--headless=new", "--no-sandbox", "--disable-background-networking", "--no-first-run",
                   "--disable-component-update", "--disable-sync", "--disable-dev-shm-usage", "--hide-scrollbars",
                   "--disable-extensions", "--remote-debugging-pipe", "--user-data-dir=" + self.folder.name, *options]
        with open(self.said, "wb") as said:
            self.process = subprocess.Popen(
                command, stdin=subprocess.DEVNULL, stdout=said, stderr=said, close_fds=False,
                preexec_fn=lambda: [os.dup2(theirs.fileno(), fd) for fd in (3, 4)])
        theirs.close()
        self.pending, self.count, self.session, self.loaded = b"", 0, None, set()
        target = self.call("Target.createTarget", url="about:blank")["targetId"]
        self.session = self.call("Target.attachToTarget", targetId=target, flatten=True)["sessionId"]
        self.call("Inspector.enable")
        self.call("Page.enable")
        self.call("Page.setLifecycleEventsEnabled", enabled=True)
        self.call("Page.addScriptToEvaluateOnNewDocument", source=COLLECTOR + script)

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.line.close()
        try:
            self.process.wait(30)
        except subprocess.TimeoutExpired:
            self.process.kill()
        self.folder.cleanup()

    def receive(self, doing):
        """The next message, of an event or an answer."""
        parts = [self.pending]
        while b"\0" not in parts[-1]:
            try:
                parts.append(self.line.recv(1 << 20))
            except (TimeoutError, ConnectionError):
                parts.append(b"")
            if not parts[-1]:
                with open(self.said, encoding="utf-8", errors="replace") as said:
                    fail("chromium ended, or was silent for %d s, at %s: %s" % (PATIENCE, doing, said.read()[-800:]))
        message, self.pending = b"".join(parts).split(b"\0", 1)
        message = json.loads(message)
        event = message.get("params", {})
        if message.get("method") == "Page.lifecycleEvent" and event["name"] == "load":
            self.loaded.add(event["loaderId"])
        if message.get("method") == "Inspector.targetCrashed":
            fail("chromium's page crashed at " + doing)
        return message

    def call(self, method, **parameters):
        self.count += 1
        message = {"id": self.count, "method": method, "params": parameters}
        if self.session:
            message["sessionId"] = self.session
        doing = "%s %s" % (method, str(parameters)[:200])
        try:
            self.line.sendall(json.dumps(message).encode() + b"\0")
        except ConnectionError:
            pass  # what Chromium said last is told by receiving
        while True:
            answer = self.receive(doing)
            if answer.get("id") == self.count:
                break
        if "error" in answer:
            fail("chromium at %s: %s" % (doing, answer["error"]))
        return answer["result"]

    def dress(self, width, height, scheme="light"):
        """Size of the window, and the reader's scheme of colours."""
        self.call("Emulation.setDeviceMetricsOverride", width=width, height=height, deviceScaleFactor=1, mobile=False)
        self.call("Emulation.setEmulatedMedia", features=[{"name": "prefers-color-scheme", "value": scheme}])

    def open(self, page, width=1400, height=1000, scheme="light"):
        """Opens a file anew, and waits until it is loaded and painted."""
        self.dress(width, height, scheme)
        begun = self.call("Page.navigate", url="file://" + page)
        if "errorText" in begun:
            fail("chromium cannot open %s: %s" % (page, begun["errorText"]))
        while begun["loaderId"] not in self.loaded:
            self.receive("loading " + page)
        self.run("await settled();")

    def run(self, script):
        """What the body of an asynchronous function returns."""
        done = self.call("Runtime.evaluate", expression="(async () => {%s})()" % script, awaitPromise=True,
                         returnByValue=True)
        if "exceptionDetails" in done:
            fail("script in the page: " + json.dumps(done["exceptionDetails"])[:800])
        return done["result"].get("value")

    def regions(self, tool, places):
        """Of what is painted now, per place: pixels, share that differs from the commonest colour, colours, hash."""
        self.run("await settled();")
        shot = os.path.join(self.folder.name, "shot.png")
        with open(shot, "wb") as file:
            file.write(base64.b64decode(self.call("Page.captureScreenshot", optimizeForSpeed=True)["data"]))
        text = "\n".join(" ".join(str(v) for v in p) for p in places)
        out = subprocess.run([tool, shot], input=text, capture_output=True, text=True, check=True)
        rows = [line.split() for line in out.stdout.splitlines()]
        return [(int(r[0]), float(r[1]), int(r[2]), r[3]) for r in rows]


def is_blank(statistics):
    _, share, colours, _ = statistics
    return share < 0.02 or colours < 10


def painted(browser, tool, selector):
    """Statistics of all that is selected of the open page, the first of it scrolled into sight. What is blank is
    looked at again: on a busy machine the last of it may not be painted."""
    for _ in range(6):
        places = browser.run("""const all = [...document.querySelectorAll('%s')];
            all[0]?.scrollIntoView({block: 'center', behavior: 'instant'}); await settled(); return all.map(place);""" % selector)
        found = browser.regions(tool, places)
        if not any(is_blank(statistics) for statistics in found):
            break
    return found


def check_figures(browser, name, tool, least_pixels):
    """How many figures the open page has; none is blank. They are looked at in one window that shows all."""
    browser.dress(1400, browser.run("return document.documentElement.scrollHeight;"))
    names = browser.run("return [...document.querySelectorAll('figure svg')].map((s) => s.id);")
    for figure, statistics in zip(names, painted(browser, tool, "figure svg"), strict=True):
        if statistics[0] < least_pixels or is_blank(statistics):
            fail("%s: figure %s is blank (%d px, %.3f, %d colours)" % (name, figure, *statistics[:3]))
    return len(names)
