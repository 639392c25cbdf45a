// SPDX-License-Identifier: BSD-3-Clause
// Zoom of plots with two axes of numbers: drag over a range or a box, double-click (or 0) to see all, + and - and the
// arrows where a plot has the focus; two fingers pinch and move, and one moves a plot that is zoomed. Plots over the
// same axis of time move together along it.
(() => {
  const make = (name, attributes, text) => {
    const made = document.createElementNS('http://www.w3.org/2000/svg', name);
    for (const [key, value] of Object.entries(attributes)) made.setAttribute(key, value);
    if (text !== undefined) made.textContent = text;
    return made;
  };
  const LEAST = 8;      // px of a drag that is meant
  const NARROW = 20;    // px below which the other direction is left as it is
  const CLOSEST = 500;  // times as large as drawn
  const placeOf = (text) => (text.getAttribute('transform').match(/-?[\d.]+/g) || []).map(Number);
  // Whether an axis' labels say the numbers where they stand; not so for names and powers.
  const isPlain = (labels, at, valueAt, span) => labels.length > 1 && labels.every((t) => {
    const said = Number(t.textContent.replace('\u2212', '-'));
    return t.textContent.trim() !== '' && Math.abs(said - valueAt(placeOf(t)[at])) < 0.02 * Math.abs(span);
  });
  const plots = [...document.querySelectorAll('figure svg[data-ax]')].map((svg) => svg.plumbline).filter((plot) => {
    const {svg, home: [x0, x1, y0, y1, px0, px1, py0, py1]} = plot;
    plot.groups = [...svg.querySelectorAll('g[clip-path]')];
    if (plot.groups.length === 0 || plot.groups.some((g) => g.querySelector('text'))) return false;
    return isPlain([...svg.querySelectorAll('text.tx')], 0, (p) => x0 + (p - px0) * (x1 - x0) / (px1 - px0), x1 - x0) &&
      isPlain([...svg.querySelectorAll('text.ty')], 1, (p) => y0 + (p - py0) * (y1 - y0) / (py1 - py0), y1 - y0);
  });
  const ticks = (from, to, count) => {
    const span = Math.abs(to - from), rough = span / count, ten = 10 ** Math.floor(Math.log10(rough));
    const step = [1, 2, 5, 10].map((k) => k * ten).find((s) => s >= rough * 0.999);
    const digits = Math.max(0, -Math.floor(Math.log10(step) + 1e-9));
    const found = [];
    for (let i = Math.ceil(Math.min(from, to) / step - 1e-9); i * step <= Math.max(from, to) + 1e-9 * step; ++i)
      found.push([i * step, digits > 6 ? (i * step).toPrecision(6) : (i * step + 0).toFixed(digits)]);
    return found;
  };
  const prepare = (plot) => {
    for (const group of plot.groups) {
      const content = make('g', {class: 'zoom-content'});
      content.append(...group.childNodes);
      group.append(content);
    }
    plot.contents = plot.groups.map((g) => g.firstChild);
    // What stands at the ticks as drawn: labels, marks and grid.
    plot.still = [...plot.svg.querySelectorAll('text.tx, text.ty, polyline[stroke="#e4e7ec"]')];
    for (const line of plot.svg.querySelectorAll('polyline[stroke="#969ca6"]')) {
      const [a, b, c, d] = line.getAttribute('points').match(/-?[\d.]+/g).map(Number);
      if (Math.hypot(a - c, b - d) < 6) plot.still.push(line);
    }
    plot.room = Math.max(...[...plot.svg.querySelectorAll('text.ty')].map((t) => t.textContent.length));
    plot.grid = make('g', {});
    plot.groups[0].prepend(plot.grid);
    plot.labels = make('g', {});
    plot.svg.querySelector('g').append(plot.labels);
  };
  const drawAxes = (plot) => {
    const [x0, x1, y0, y1, px0, px1, py0, py1] = plot.axes;
    const size = plot.svg.viewBox.baseVal;
    const label = (x, y, anchor, text, name) => plot.labels.append(
      make('text', {class: name, transform: `translate(${x},${y})`, dy: '0.33em', 'text-anchor': anchor, 'font-size': 12, fill: '#404650'}, text));
    const line = (points, stroke, into) => into.append(make('polyline', {points: points.join(' '), stroke, fill: 'none', 'stroke-width': 1}));
    const shift = placeOf(plot.svg.querySelector('text.tx'))[1], side = placeOf(plot.svg.querySelector('text.ty'))[0];
    for (const [value, text] of ticks(x0, x1, Math.max(2, size.width / 110))) {
      const p = px0 + (value - x0) * (px1 - px0) / (x1 - x0);
      line([p, py0, p, py1], '#e4e7ec', plot.grid);
      line([p, py0, p, py0 + 4], '#969ca6', plot.labels);
      label(p, shift, 'middle', text, 'tx');
    }
    for (const [value, text] of ticks(y0, y1, Math.max(2, size.height / 60))) {
      const p = py0 + (value - y0) * (py1 - py0) / (y1 - y0);
      line([px0, p, px1, p], '#e4e7ec', plot.grid);
      line([px0 - 4, p, px0, p], '#969ca6', plot.labels);
      // Left of the axis there is room for the labels as drawn: powers of ten if they are shorter, else narrower letters.
      const power = value === 0 ? '0' : Number(value.toPrecision(4)).toExponential(), said = text.length > plot.room && power.length < text.length ? power : text;
      label(side, p, 'end', said, 'ty');
      if (said.length > plot.room) {
        plot.labels.lastChild.setAttribute('textLength', 6.6 * plot.room);
        plot.labels.lastChild.setAttribute('lengthAdjust', 'spacingAndGlyphs');
      }
    }
  };
  const isHome = (plot) => plot.axes.slice(0, 4).every((v, i) => v === plot.home[i]);
  const show = (plot, x0, x1, y0, y1) => {
    const [X0, X1, Y0, Y1, px0, px1, py0, py1] = plot.home;
    if (!plot.contents) prepare(plot);
    plot.axes = [x0, x1, y0, y1, px0, px1, py0, py1];
    const sx = (X1 - X0) / (x1 - x0), sy = (Y1 - Y0) / (y1 - y0);
    plot.view = {sx, tx: px0 - sx * (px0 + (x0 - X0) / (X1 - X0) * (px1 - px0)), sy, ty: py0 - sy * (py0 + (y0 - Y0) / (Y1 - Y0) * (py1 - py0))};
    const {tx, ty} = plot.view, home = isHome(plot);
    plot.contents.forEach((g) => g.setAttribute('transform', home ? '' : `matrix(${sx} 0 0 ${sy} ${tx} ${ty})`));
    plot.still.forEach((e) => { e.style.display = home ? '' : 'none'; });
    plot.grid.replaceChildren();
    plot.labels.replaceChildren();
    if (!home) drawAxes(plot);
    plot.button.hidden = home;
    plot.refresh();
  };
  const sameTime = (plot) => plot.axis ? plots.filter((p) => p.axis === plot.axis) : [plot];
  const inside = (from, to, home0, home1) => {
    const low = Math.min(home0, home1), high = Math.max(home0, home1), span = to - from;
    if (span >= high - low) return [low, high];
    const start = Math.max(low, Math.min(from, high - span));
    return [start, start + span];
  };
  // A range of values along each axis, low to high; null leaves an axis as it is.
  const zoom = (plot, x, y) => {
    const [X0, X1, Y0, Y1] = plot.home;
    let [x0, x1, y0, y1] = plot.axes;
    if (x && x[1] - x[0] >= (X1 - X0) / CLOSEST) [x0, x1] = inside(x[0], x[1], X0, X1);
    if (y && y[1] - y[0] >= Math.abs(Y1 - Y0) / CLOSEST) {
      const [low, high] = inside(y[0], y[1], Y0, Y1);
      [y0, y1] = Y1 > Y0 ? [low, high] : [high, low];
    }
    const all = x0 === X0 && x1 === X1;
    show(plot, x0, x1, y0, y1);
    for (const other of sameTime(plot)) {
      if (other === plot) continue;
      const at = all ? other.home : [x0, x1];
      show(other, at[0], at[1], other.axes[2], other.axes[3]);
    }
  };
  const reset = (plot) => sameTime(plot).forEach((p) => show(p, ...(p === plot ? p.home.slice(0, 4) : [p.home[0], p.home[1], p.axes[2], p.axes[3]])));
  // One unit of both axes stays as long where it was so: image planes.
  const isSquare = ({home: [x0, x1, y0, y1, px0, px1, py0, py1]}) => Math.abs(Math.abs((px1 - px0) / (x1 - x0) / ((py1 - py0) / (y1 - y0))) - 1) < 0.02;
  const zoomTo = (plot, from, to) => {
    const [x0, x1, y0, y1, px0, px1, py0, py1] = plot.axes;
    let left = Math.max(px0, Math.min(from.x, to.x)), right = Math.min(px1, Math.max(from.x, to.x));
    let top = Math.max(py1, Math.min(from.y, to.y)), bottom = Math.min(py0, Math.max(from.y, to.y));
    let wide = right - left >= NARROW, tall = bottom - top >= NARROW;
    if (!wide && !tall) return;
    if (isSquare(plot) && !plot.axis) {
      const half = Math.max((right - left) / (px1 - px0), (bottom - top) / (py0 - py1)) / 2, cx = (left + right) / 2, cy = (top + bottom) / 2;
      [left, right, top, bottom] = [cx - half * (px1 - px0), cx + half * (px1 - px0), cy - half * (py0 - py1), cy + half * (py0 - py1)];
      wide = tall = true;
    }
    const vx = (p) => x0 + (p - px0) * (x1 - x0) / (px1 - px0), vy = (p) => y0 + (p - py0) * (y1 - y0) / (py1 - py0);
    zoom(plot, wide ? [vx(left), vx(right)] : null, tall ? [vy(top), vy(bottom)].sort((a, b) => a - b) : null);
  };
  const scaled = (from, to, by, move) => {
    const middle = (from + to) / 2 + move * (to - from), half = Math.abs(to - from) / 2 * by;
    return [middle - half, middle + half];
  };
  const KEYS = {'+': [0.5, 0, 0], '=': [0.5, 0, 0], '-': [2, 0, 0], ArrowLeft: [1, -0.2, 0], ArrowRight: [1, 0.2, 0], ArrowUp: [1, 0, 0.2], ArrowDown: [1, 0, -0.2]};
  const onKey = (plot, event) => {
    if (event.ctrlKey || event.metaKey || event.altKey || event.target !== plot.svg) return;
    if (event.key === '0' || event.key === 'Escape') {
      reset(plot);
    } else if (KEYS[event.key] && !(KEYS[event.key][0] === 1 && isHome(plot))) {
      const [by, right, up] = KEYS[event.key], [x0, x1, y0, y1] = plot.axes;
      const y = scaled(Math.min(y0, y1), Math.max(y0, y1), plot.axis && up === 0 ? 1 : by, y1 > y0 ? up : -up);
      zoom(plot, scaled(x0, x1, by, right), plot.axis && up === 0 ? null : y);
    } else return;
    event.preventDefault();
  };
  // Two fingers: the values under them stay under them; over time along that axis alone, on image planes equally along both.
  const pinch = (plot, begun, [a, b]) => {
    const [, , , , px0, px1, py0, py1] = plot.home, [x0, x1, y0, y1] = begun.axes;
    const [p, q] = begun.at, wide = Math.abs(q.x - p.x), tall = Math.abs(q.y - p.y);
    const both = Math.hypot(q.x - p.x, q.y - p.y) / Math.max(1, Math.hypot(b.x - a.x, b.y - a.y));
    // A direction in which the fingers were side by side is moved, not scaled.
    const scale = (was, is, other) => plot.axis || isSquare(plot) ? both : was < 3 * LEAST ? 1 : was < other / 4 ? both : was / Math.max(1, is);
    const sx = scale(wide, Math.abs(b.x - a.x), tall), sy = scale(tall, Math.abs(b.y - a.y), wide);
    const mid = {x: (a.x + b.x) / 2, y: (a.y + b.y) / 2}, was = {x: (p.x + q.x) / 2, y: (p.y + q.y) / 2};
    const range = (from, to, p0, p1, then, now, by) => {
      const span = (to - from) * by, value = from + (then - p0) / (p1 - p0) * (to - from), start = value - (now - p0) / (p1 - p0) * span;
      return [start, start + span].sort((m, n) => m - n);
    };
    zoom(plot, range(x0, x1, px0, px1, was.x, mid.x, sx), plot.axis ? null : range(y0, y1, py0, py1, was.y, mid.y, sy));
  };
  // One finger moves a plot that is zoomed; else the page scrolls.
  const touch = (plot, place) => {
    const {svg} = plot;
    let begun = null;
    const fingers = (event) => [...event.touches].slice(0, 2).map(place);
    const begin = (event) => { begun = event.touches.length > 0 ? {at: fingers(event), axes: [...plot.axes]} : null; };
    svg.addEventListener('touchstart', begin, {passive: true});
    svg.addEventListener('touchend', begin, {passive: true});
    svg.addEventListener('touchcancel', begin, {passive: true});
    svg.addEventListener('touchmove', (event) => {
      const now = fingers(event);
      if (!begun || now.length !== begun.at.length || (now.length === 1 && isHome(plot))) return;
      if (event.cancelable) event.preventDefault();
      // A second finger that stands still against the first: a move.
      const aside = ({x, y}) => ({x: x + 100, y});
      const pair = (at) => at.length === 1 ? [at[0], aside(at[0])] : at;
      pinch(plot, {at: pair(begun.at), axes: begun.axes}, pair(now));
    }, {passive: false});
  };
  const start = (plot) => {
    const {svg} = plot;
    const place = (event) => new DOMPoint(event.clientX, event.clientY).matrixTransform(svg.getScreenCTM().inverse());
    const box = make('rect', {fill: '#005ea2', 'fill-opacity': 0.12, stroke: '#005ea2', 'stroke-opacity': 0.6});
    box.style.display = 'none';
    box.style.pointerEvents = 'none';
    svg.append(box);
    plot.button = document.createElement('button');
    plot.button.type = 'button';
    plot.button.className = 'tool zoom-reset';
    plot.button.textContent = 'Show all';
    plot.button.hidden = true;
    plot.button.addEventListener('click', () => reset(plot));
    svg.closest('figure').append(plot.button);
    let from = null;
    const stop = () => { from = null; box.style.display = 'none'; };
    svg.addEventListener('pointerdown', (event) => {
      plot.dragged = false;
      if (event.button !== 0 || event.pointerType === 'touch' || event.target.closest('a, [role=button]')) return;
      const at = place(event), [, , , , px0, px1, py0, py1] = plot.axes;
      if (at.x < px0 - 4 || at.x > px1 + 4 || at.y > py0 + 4 || at.y < py1 - 4) return;
      from = at;
      svg.setPointerCapture(event.pointerId);
    });
    svg.addEventListener('pointermove', (event) => {
      if (!from) return;
      const at = place(event), [, , , , px0, px1, py0, py1] = plot.axes;
      const wide = Math.abs(at.x - from.x), tall = Math.abs(at.y - from.y);
      if (Math.max(wide, tall) < LEAST) return;
      const whole = isSquare(plot) && !plot.axis;
      const [left, right] = wide < NARROW && !whole ? [px0, px1] : [Math.max(px0, Math.min(at.x, from.x)), Math.min(px1, Math.max(at.x, from.x))];
      const [top, bottom] = tall < NARROW && !whole ? [py1, py0] : [Math.max(py1, Math.min(at.y, from.y)), Math.min(py0, Math.max(at.y, from.y))];
      for (const [key, value] of Object.entries({x: left, y: top, width: right - left, height: bottom - top})) box.setAttribute(key, Math.max(0, value));
      box.style.display = '';
    });
    svg.addEventListener('pointerup', (event) => {
      if (!from) return;
      const at = place(event), begun = from;
      stop();
      if (Math.hypot(at.x - begun.x, at.y - begun.y) < LEAST) return;
      plot.dragged = true;
      zoomTo(plot, begun, at);
    });
    svg.addEventListener('pointercancel', stop);
    touch(plot, place);
    svg.addEventListener('dblclick', () => reset(plot));
    svg.addEventListener('keydown', (event) => onKey(plot, event));
    svg.setAttribute('tabindex', 0);
    svg.setAttribute('aria-description', 'Plus and minus zoom, arrows move, 0 shows all; so do two fingers.');
    svg.classList.add('zooms');
  };
  plots.forEach(start);
})();
