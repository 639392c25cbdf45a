// SPDX-License-Identifier: BSD-3-Clause
// The player: one frame is shown at a time, in all parts at once.
(() => {
  const root = document.getElementById('player');
  if (!root) return;
  const {read, views, scene, timeline, lastUpTo} = window.plumblineReplay;
  const data = read();
  if (!data.frames) { root.textContent = 'The recording has no frames: there is nothing to replay.'; return; }
  const part = (name) => root.querySelector(`[data-part="${name}"]`);
  const NONE = '\u2013';
  const known = (v) => !Number.isNaN(v);
  const fixed = (v, digits, unit) => (known(v) ? `${v.toFixed(digits)} ${unit}` : NONE);
  const inBits = (nats) => (nats / Math.LN2).toFixed(3);

  const gainText = (nats) => {
    if (!known(nats)) return NONE;
    return nats === Infinity ? 'unbounded' : `${inBits(nats)} bits (${nats.toFixed(3)} nats)`;
  };
  const entropyText = (nats) => (known(nats) ? `${nats.toFixed(3)} nats (${inBits(nats)} bits)` : NONE);
  const askedText = (f) => {
    const s = data.suggestionAt(f);
    if (!s) return known(data.table.suggestion[f]) ? `#${data.table.suggestion[f]}` : NONE;
    return `#${s.id} ${s.name}`;
  };

  const leftText = (f) => (data.leftAt(f) === undefined ? '' : `removed from the estimate at frame ${data.leftAt(f)}`);

  const errorText = (f) => {
    const {error, excess} = data.table;
    if (!known(error[f])) return NONE;
    return `${error[f].toFixed(4)} px${known(excess[f]) ? ` (+${(100 * excess[f]).toFixed(1)} %)` : ''}`;
  };

  /** Whether the gain is what a frame was judged by. */
  const gainDecides = (f) => !data.byError || (data.word('stage', f) === 'camera' && (!known(data.table.error_bound[f]) || data.table.mi[f] === Infinity));
  const errorWithText = (f) => {
    const {error_with: withIt, error_bound: bound} = data.table;
    if (!known(withIt[f])) return NONE;
    if (!known(bound[f])) return fixed(withIt[f], 4, 'px');
    const [error, bar] = apart(withIt[f], bound[f], 4);
    return `${error} px (bound ${bar} px)`;
  };

  /** Two numbers with as many digits as tell them apart, `digits` at least. */
  const apart = (a, b, digits) => {
    let n = digits;
    while (n < 12 && a !== b && a.toFixed(n) === b.toFixed(n)) ++n;
    return [a.toFixed(n), b.toFixed(n)];
  };

  /** Why a frame was kept or not, in a sentence. */
  const byGain = (f) => {
    const {mi, threshold} = data.table;
    if (mi[f] === Infinity) return 'the views before do not determine all parameters';
    const [gain, bar] = apart(mi[f] / Math.LN2, threshold[f] / Math.LN2, 3);
    return `its expected information gain is ${gain} bits, ${mi[f] < threshold[f] ? 'below' : 'at or above'} the threshold of ${bar} bits`;
  };
  const byCriterion = (f) => {
    const {mi, error_with: withIt, error_bound: bound} = data.table;
    if (!known(bound[f]) || mi[f] === Infinity) return byGain(f);
    const [error, bar] = apart(withIt[f], bound[f], 4);
    return `with it the predicted error is ${error} px, ${withIt[f] > bound[f] ? 'above' : 'not above'} the bound of ${bar} px`;
  };
  /** Of the first frames, which the start may leave out. */
  const toStart = (f) => (data.leftAt(f) === undefined ? 'Kept: one of the first frames, from which the estimate starts.' : 'Kept as one of the first frames, and removed from the estimate again.');
  /** In the camera-IMU stage a frame after a pause is used, but not joined by the IMU. */
  const afterPause = (f, pause, not) => (data.table.accepted[f] ? `Kept, but linked to the frames before by the random walk of the biases alone: ${pause}.` : `Not kept: ${not}.`);
  const reasons = {
    initialising: (f) => (data.table.accepted[f] ? toStart(f) : 'Not kept: hardly moved since the frame kept before it.'),
    initialised: () => 'Kept: the estimate starts with it.',
    'initialise-failed': (f) => (data.table.accepted[f] ? `${toStart(f)} With it the start failed, and is tried again later.` : 'Not kept: the start was given up, and the frames kept for it were removed.'),
    informative: (f) => `Kept: ${byCriterion(f)}.`,
    'not-informative': (f) => `Not kept: ${byCriterion(f)}.`,
    used: (f) => (data.table.accepted[f] ? 'Kept: in this stage every frame enters the estimate.' : 'Removed from the estimate again.'),
    busy: () => 'Not kept: it came while the guide was busy with an earlier frame.',
    'no-target': () => 'Not kept: no camera saw enough corners of the target.',
    'no-pose': () => 'Not kept: its corners give no plausible pose.',
    'bad-fit': () => 'Not kept: the error of its corners is more than three times that of the views kept.',
    'time-jump': (f) => afterPause(f, 'the pause before it is too long', 'its stamp is not after that of the frame before, or far after it'),
    'no-imu': () => 'Not kept: IMU samples do not cover it.',
    'imu-gap': (f) => afterPause(f, 'IMU samples are missing before it', 'IMU samples are missing before it'),
    'not-solved': () => 'Not kept: the estimate with it did not converge.',
    finished: () => 'Not processed: the stage was finished.',
  };
  const whyText = (f) => { const say = reasons[data.word('reason', f)]; return say ? say(f) : NONE; };

  /** What the log says of a frame: text, and a class where it matters. */
  const fields = {
    time: (f) => [`${(data.offsets[f] / 1e9).toFixed(3)} s`],
    frame: (f) => [`${f} of ${data.frames - 1}`],
    stage: (f) => [data.word('stage', f) || NONE],
    mode: (f) => [data.word('mode', f) || 'not given'],
    reason: (f) => [data.word('reason', f) || NONE, data.stays(f) ? 'good' : ''],
    corners: (f) => [known(data.table.corners[f]) ? `${data.table.corners[f]}` : NONE],
    kept: (f) => [known(data.table.kept[f]) ? `${data.table.kept[f]} (${data.table.without[f]} since)` : NONE],
    mi: (f) => [gainText(data.table.mi[f]), gainDecides(f) && data.table.mi[f] >= data.table.threshold[f] ? 'good' : ''],
    entropy: (f) => [entropyText(data.table.entropy[f])],
    error: (f) => [errorText(f)],
    error_with: (f) => [errorWithText(f), !gainDecides(f) && data.table.error_with[f] <= data.table.error_bound[f] ? 'good' : ''],
    why: (f) => [whyText(f), data.stays(f) ? 'good' : ''],
    rmse: (f) => [fixed(data.table.rmse[f], 3, 'px')],
    suggestion: (f) => [askedText(f), known(data.table.suggestion[f]) ? 'warn' : ''],
    distance: (f) => [fixed(data.table.distance[f], 1, 'px')],
    held: (f) => [known(data.table.suggestion[f]) ? fixed(data.table.held[f], 2, 's') : NONE, data.table.held[f] > 0 ? 'good' : ''],
    detail: (f) => [[data.word('event', f), leftText(f), data.details.get(f)].filter((t) => t && t !== 'none').join(': ') || NONE, data.details.has(f) ? 'bad' : ''],
  };
  /** Names of values that mean something else in each stage. */
  const names = {error: (f) => (data.word('stage', f) === 'camera-imu' ? 'Points by the IMU, expected' : 'Predicted error in later use')};
  const cells = Object.keys(fields).filter((name) => root.querySelector(`[data-field="${name}"]`)).map((name) => {
    const cell = root.querySelector(`[data-field="${name}"]`);
    return {name, cell, label: cell.querySelector('b'), text: cell.querySelector('span'), base: cell.className};
  });
  const showLog = (f) => {
    for (const {name, cell, label, text, base} of cells) {
      const [value, kind] = fields[name](f);
      if (names[name]) label.textContent = names[name](f);
      text.textContent = value;
      text.title = name === 'time' ? `${data.start + BigInt(data.offsets[f])} ns` : value;
      cell.className = `${base} ${kind || ''}`.trim();
    }
  };

  const list = part('events');
  const buttons = data.events.map((event) => {
    const item = document.createElement('li');
    const button = document.createElement('button');
    const [when, what] = [document.createElement('span'), document.createElement('span')];
    when.textContent = (data.offsets[event.frame] / 1e9).toFixed(1);
    what.textContent = event.text;
    button.type = 'button';
    button.className = event.kind;
    button.title = event.text;
    button.append(when, what);
    button.addEventListener('click', () => jump(event.frame));
    item.append(button);
    list.append(item);
    return button;
  });
  const eventFrames = data.events.map((e) => e.frame);
  let marked = -1;
  const showEvent = (f) => {
    const current = lastUpTo(eventFrames, f);
    if (current === marked) return;
    if (buttons[marked]) buttons[marked].classList.remove('here');
    marked = current;
    if (!buttons[marked]) { list.scrollTop = 0; return; }
    buttons[marked].classList.add('here');
    const top = buttons[marked].offsetTop, bottom = top + buttons[marked].offsetHeight;
    if (top < list.scrollTop || bottom > list.scrollTop + list.clientHeight) list.scrollTop = top - list.clientHeight / 2;
  };

  const slider = part('slider');
  let frame = 0;
  const shown = [views(part('views'), data), scene(part('scene'), data), timeline(part('lines'), data, (f) => jump(f))];
  const show = () => {
    slider.value = frame;
    shown.forEach((s) => s.draw(frame));
    showLog(frame);
    showEvent(frame);
  };
  const go = (f) => {
    frame = Math.min(data.frames - 1, Math.max(0, Math.round(f)));
    show();
  };

  // Playing: time passes by the recording's stamps.
  const play = root.querySelector('[data-act="play"]');
  const speed = part('speed');
  let at = 0, last = null;  // seconds of playing; null: it rests
  const rest = () => { last = null; play.classList.remove('playing'); play.setAttribute('aria-label', 'Play'); };
  const step = () => {
    if (last === null) return;
    const now = performance.now();
    at += Math.max(0, now - last) / 1000 * Number(speed.value);
    last = now;
    const due = lastUpTo(data.play, at);
    if (due !== frame) go(due);
    if (frame >= data.frames - 1) { rest(); return; }
    setTimeout(step, 16);
  };
  const toggle = () => {
    if (last !== null) { rest(); return; }
    if (frame >= data.frames - 1) go(0);
    at = data.play[frame];
    last = performance.now();
    play.classList.add('playing');
    play.setAttribute('aria-label', 'Pause');
    setTimeout(step, 16);
  };
  const jump = (f) => { go(f); at = data.play[frame]; };
  const second = (sign) => {
    const due = data.play[frame] + sign;
    const below = Math.max(0, lastUpTo(data.play, due)), above = Math.min(data.frames - 1, below + 1);
    const f = due - data.play[below] <= data.play[above] - due ? below : above;
    jump(sign > 0 ? Math.max(f, frame + 1) : Math.min(f, frame - 1));
  };
  const eventAfter = () => { const f = eventFrames.find((e) => e > frame); if (f !== undefined) jump(f); };
  const eventBefore = () => { const k = lastUpTo(eventFrames, frame - 1); if (k >= 0) jump(eventFrames[k]); };

  const acts = {'event-before': eventBefore, 'event-after': eventAfter, play: toggle,
    'frame-before': () => jump(frame - 1), 'frame-after': () => jump(frame + 1)};
  for (const [name, act] of Object.entries(acts)) root.querySelector(`[data-act="${name}"]`).addEventListener('click', act);
  slider.addEventListener('input', () => jump(Number(slider.value)));

  const keys = {
    ' ': toggle, ArrowLeft: (e) => (e.shiftKey ? second(-1) : jump(frame - 1)),
    ArrowRight: (e) => (e.shiftKey ? second(1) : jump(frame + 1)),
    ArrowUp: eventBefore, ArrowDown: eventAfter, Home: () => jump(0), End: () => jump(data.frames - 1),
  };
  const inView = () => { const box = root.getBoundingClientRect(); return box.bottom > 0.4 * window.innerHeight && box.top < 0.6 * window.innerHeight; };
  document.addEventListener('keydown', (e) => {
    const typing = e.target.closest && e.target.closest('select, textarea, summary, input:not([type="range"])');
    if (!keys[e.key] || typing || e.ctrlKey || e.metaKey || e.altKey || !inView()) return;
    if (e.key === ' ' && e.target.closest && e.target.closest('button')) e.target.blur();
    e.preventDefault();
    keys[e.key](e);
  });

  const layout = () => { shown.forEach((s) => s.layout()); show(); };
  matchMedia('(prefers-color-scheme: dark)').addEventListener('change', layout);
  new ResizeObserver(layout).observe(root.querySelector('.player-body'));
  window.addEventListener('hashchange', () => fromHash());
  const fromHash = () => { const wanted = /^#frame=(\d+)$/.exec(location.hash); if (wanted) jump(Number(wanted[1])); };
  layout();
  if (eventFrames.length) jump(eventFrames[0]);
  fromHash();
  window.plumblineReplay.player = {data, go: jump, frame: () => frame, playing: () => last !== null, scene: shown[1]};
})();
