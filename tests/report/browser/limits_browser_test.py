#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Holds the pages that the program itself makes to their limits.

usage: limits_browser_test.py PLUMBLINE

Proves of a calibration, a comparison, a perturbation study, scores, trajectories and a replay with images:
a calibration prints on eight sheets at most; no page is above 10 MB (12 MB with a replay's images); each
begins with its verdict's sentence; no number in sight is a zero with a minus sign; what a page is made to
load from outside is refused by its own policy. Rendering that takes long tells the time left.
"""
import html
import os
import re
import subprocess
import sys
import tempfile
import time

from browser import FLAT, Chromium, fail
from layout_browser_test import MOST_SHEETS, sheets_of

PAGE_MB = 10
REPLAY_MB = 12

POLICY_PROBE = """
let refused = 0;
document.addEventListener('securitypolicyviolation', () => { ++refused; });
for (const kind of ['img', 'script', 'iframe']) {
  const e = document.createElement(kind);
  e.src = 'https://example.invalid/' + kind;
  document.body.append(e);
}
fetch('https://example.invalid/data').catch(() => {});
await until(() => refused >= 4);
return refused;
"""


def jobs(folder):
    """Name of a page, the command that makes it."""
    at = lambda name: os.path.join(folder, name)
    session, images = at("session"), at("images")
    truth = session + "/truth/camchain-imucam.yaml"
    return [
        ("calibration", "calibrate %s --no-cache" % session),
        ("comparison", "compare %s/calibration.json %s --labels ours,truth --session %s --no-cache"
         % (at("calibration"), truth, session)),
        ("perturbation", "perturb %s --offsets-ms 10,-10 --to 8 --no-cache" % session),
        ("scores", "evaluate calibration %s %s --folds 2 --no-cache" % (truth, session)),
        ("trajectory", "evaluate trajectory %s/truth/trajectory.csv %s/truth/trajectory.csv"
         % (session, session)),
        ("replay", "replay %s --no-cache --no-counterfactuals" % images),
    ]


def run(program, words):
    done = subprocess.run([program, *words.split()], capture_output=True, text=True, check=False)
    if done.returncode != 0:
        fail("plumbline %s: %d: %s" % (words, done.returncode, done.stderr[-500:]))
    return done.stderr


def text_of(page):
    """What a reader sees, markup and programs taken out."""
    text = re.sub(r"<(script|style)\b.*?</\1>", "", page, flags=re.S)
    return html.unescape(re.sub(r"<[^>]+>", "\n", text))


def check(browser, name, path):
    size = os.path.getsize(path) / 1e6
    limit = REPLAY_MB if name == "replay" else PAGE_MB
    if size > limit:
        fail("%s: %.1f MB, %d may be" % (name, size, limit))
    with open(path, encoding="utf-8") as file:
        page = file.read()
    if not re.search(r'class="verdict (good|caution|bad|neutral)".*?<p[^>]*>[^<]{20,}', page, re.S):
        fail(name + ": the page does not begin with its verdict's sentence")
    zeros = re.findall(r"(?<![\w.\-])[-\u2212]0(?:\.0+)?(?![\d.\w])", text_of(page))
    if zeros:
        fail("%s: zeros with a minus sign: %s" % (name, zeros[:5]))
    sheets = sheets_of(browser, path) if name == "calibration" else 0
    if sheets > MOST_SHEETS:
        fail("a calibration is printed on %d sheets" % sheets)
    browser.open(path)
    refused = browser.run(POLICY_PROBE)
    if refused < 4:
        fail("%s: only %d of 4 loads from outside were refused" % (name, refused))
    return "%s %.1f MB" % (name, size) + (", %d sheets" % sheets if sheets else "")


def main():
    program = sys.argv[1]
    with tempfile.TemporaryDirectory() as folder:
        run(program, "simulate --rig euroc --seed 7 --duration 12 --out %s/session" % folder)
        begun = time.monotonic()
        said = run(program, "simulate --rig d435i --seed 7 --duration 6 --camera-rate 8 --images --out %s/images"
                   % folder)
        if time.monotonic() - begun > 15 and not re.search(r"^plumbline: \w+: \d+ %, \d+ (s|min) left$", said, re.M):
            fail("rendering for %.0f s said no time left: %s" % (time.monotonic() - begun, said))
        told_of = []
        with Chromium(*FLAT) as browser:
            for name, command in jobs(folder):
                run(program, "%s --out %s" % (command, os.path.join(folder, name)))
                told_of.append(check(browser, name, os.path.join(folder, name, "report.html")))
        print("; ".join(told_of))


if __name__ == "__main__":
    main()
