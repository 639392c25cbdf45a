// SPDX-License-Identifier: BSD-3-Clause
// Shows series and values of the nearest drawn point of every <svg data-ax>, or the value of a map's cell, the same moment in all plots over
// the same axis, and hides a series whose legend is clicked. svg.plumbline is what zoom.js and page.js know of a plot.
(() => {
  const numbers = (text) => (text.match(/-?[\d.]+(e-?\d+)?/g) || []).map(Number);
  const pairs = (list) => {
    const points = [];
    for (let i = 0; i + 1 < list.length; i += 2) points.push([list[i], list[i + 1]]);
    return points;
  };
  const drawn = (svg) => [...svg.querySelectorAll('polyline.data, path.pts, polygon.data')];
  // A legend is a small polygon in the colour of its series, and the name after it.
  const legendOf = (svg) => new Map([...svg.querySelectorAll('polygon + text')].map((text) => [text.previousElementSibling.getAttribute('fill'), text]));
  const colourOf = (shape) => shape.getAttribute(shape.tagName === 'polygon' ? 'fill' : 'stroke');
  const pointsOf = (shape) => pairs(numbers(shape.getAttribute(shape.tagName === 'path' ? 'd' : 'points')));
  // Where the points of lines and clouds are shown, each with the name of its series.
  const shownPoints = ({svg, legend, view: {sx, tx, sy, ty}}) => drawn(svg).flatMap((shape) => {
    if (shape.style.display === 'none' || shape.tagName === 'polygon') return [];
    const name = legend.get(colourOf(shape))?.textContent || '';
    return pointsOf(shape).map(([x, y]) => [sx * x + tx, sy * y + ty, name]);
  });
  const node = (name, attributes) => {
    const made = document.createElementNS('http://www.w3.org/2000/svg', name);
    for (const [key, value] of Object.entries(attributes)) made.setAttribute(key, value);
    return made;
  };
  const rounded = (value) => { if (Number.isNaN(value)) return 'no value'; const text = +value.toPrecision(4); return Object.is(text, -0) ? 0 : text; };
  const plots = [];
  const axisOf = (svg) => [...svg.querySelectorAll('text')].find((t) => /\[(s|min|h)\]$/.test(t.textContent) && !/rotate/.test(t.getAttribute('transform') || ''))?.textContent || '';
  // The same moment in every plot over the same axis of time; null: no moment.
  const pointAll = (plot, x) => {
    for (const other of plots) {
      const [x0, x1, , , px0, px1, py0, py1] = other.axes;
      const at = x === null ? NaN : px0 + (x - x0) * (px1 - px0) / (x1 - x0);
      const inside = plot.axis && other.axis === plot.axis && at >= Math.min(px0, px1) && at <= Math.max(px0, px1);
      other.cursor.style.display = inside ? '' : 'none';
      if (!inside) continue;
      for (const [key, value] of [['x1', at], ['x2', at], ['y1', py0], ['y2', py1]]) other.cursor.setAttribute(key, value);
    }
  };
  const show = (plot, event) => {
    const {svg, mark} = plot;
    plot.points = plot.points || shownPoints(plot);
    const at = new DOMPoint(event.clientX, event.clientY).matrixTransform(svg.getScreenCTM().inverse());
    const reach = 16;  // px within which a point is named
    let best = null, least = reach * reach;
    const [, , , , left, end, low, high] = plot.axes;
    for (const p of plot.points) {
      if (p[0] < left - 1 || p[0] > end + 1 || p[1] < high - 1 || p[1] > low + 1) continue;
      const d = (p[0] - at.x) ** 2 + (p[1] - at.y) ** 2;
      if (d < least) { least = d; best = p; }
    }
    const [x0, x1, y0, y1, px0, px1, py0, py1] = plot.axes;
    const valueX = (px) => x0 + (px - px0) * (x1 - x0) / (px1 - px0);
    const inside = at.x >= Math.min(px0, px1) && at.x <= Math.max(px0, px1);
    pointAll(plot, inside ? valueX(best ? best[0] : at.x) : null);
    mark.style.display = best ? '' : 'none';
    if (!best) return;
    const y = y0 + (best[1] - py0) * (y1 - y0) / (py1 - py0);
    const text = mark.lastChild;
    text.textContent = `${best[2] ? best[2] + ': ' : ''}${rounded(plot.valueOf('x', valueX(best[0])))}, ${rounded(plot.valueOf('y', y))}`;
    const right = best[0] > (px0 + px1) / 2;
    text.setAttribute('text-anchor', right ? 'end' : 'start');
    text.setAttribute('x', right ? -8 : 8);
    mark.setAttribute('transform', `translate(${best[0]} ${best[1]})`);
  };
  // The cell of a map under the pointer, by the names of its column and row where it has some.
  const showCell = (plot, event) => {
    const {svg, mark, cells} = plot;
    const at = new DOMPoint(event.clientX, event.clientY).matrixTransform(svg.getScreenCTM().inverse());
    const [x0, x1, y0, y1, px0, px1, py0, py1] = plot.home;
    // The cells fill the axes as they are without zoom.
    const {sx, tx, sy, ty} = plot.view;
    const across = ((at.x - tx) / sx - px0) / (px1 - px0), down = ((at.y - ty) / sy - py1) / (py0 - py1);
    const inside = at.x >= px0 && at.x < px1 && at.y >= py1 && at.y < py0 && across >= 0 && across < 1 && down >= 0 && down < 1;
    const column = Math.floor(across * cells.columns), row = Math.floor(down * cells.rows);
    const value = inside ? cells.values[row * cells.columns + column] : null;
    mark.style.display = value === null ? 'none' : '';
    if (value === null) return;
    const middle = (names, i, n, from, to) => names ? names[i] : rounded(from + (i + 0.5) / n * (to - from));
    const place = `${middle(cells.x, column, cells.columns, x0, x1)}, ${middle(cells.y, row, cells.rows, y1, y0)}`;
    const text = mark.lastChild;
    text.textContent = `${place}: ${cells.label} ${value}`;
    const right = at.x > (px0 + px1) / 2;
    text.setAttribute('text-anchor', right ? 'end' : 'start');
    text.setAttribute('x', right ? -8 : 8);
    const middles = [sx * (px0 + (column + 0.5) / cells.columns * (px1 - px0)) + tx, sy * (py1 + (row + 0.5) / cells.rows * (py0 - py1)) + ty];
    mark.setAttribute('transform', `translate(${middles.join(' ')})`);
  };
  // A click on a plot over time picks the moment, and the series if one is near; all such plots keep it marked.
  const pick = (plot, event) => {
    const moment = plot.axis && document.querySelector('.views');
    const dragged = plot.dragged;
    plot.dragged = false;
    if (!moment || dragged || event.target.closest('text')) return;
    const at = new DOMPoint(event.clientX, event.clientY).matrixTransform(plot.svg.getScreenCTM().inverse());
    const [x0, x1, , , px0, px1] = plot.axes;
    if (at.x < Math.min(px0, px1) || at.x > Math.max(px0, px1)) return;
    const series = plot.mark.style.display === 'none' ? '' : plot.mark.lastChild.textContent.split(':')[0];
    const seconds = x0 + (at.x - px0) * (x1 - x0) / (px1 - px0);
    document.dispatchEvent(new CustomEvent('plumbline-moment', {detail: {seconds, series}}));
  };
  let now = null;  // seconds of the moment that is picked
  const markPicked = ({axis, axes: [x0, x1, , , px0, px1, py0, py1], picked}) => {
    const at = px0 + (now - x0) * (px1 - px0) / (x1 - x0);
    const inside = now !== null && axis.startsWith('time since the first frame') && at >= Math.min(px0, px1) && at <= Math.max(px0, px1);
    picked.style.display = inside ? '' : 'none';
    if (inside) for (const [key, value] of [['x1', at], ['x2', at], ['y1', py0], ['y2', py1]]) picked.setAttribute(key, value);
  };
  document.addEventListener('plumbline-picked', ({detail: {seconds}}) => {
    now = seconds;
    plots.forEach(markPicked);
  });
  const toggle = (plot, colour, text) => {
    const hide = text.style.textDecoration !== 'line-through';
    text.style.textDecoration = hide ? 'line-through' : '';
    text.setAttribute('aria-pressed', String(!hide));
    drawn(plot.svg).filter((shape) => colourOf(shape) === colour).forEach((shape) => { shape.style.display = hide ? 'none' : ''; });
    plot.points = null;
  };
  document.querySelectorAll('svg[data-ax]').forEach((svg) => {
    const mark = node('g', {});
    mark.append(node('circle', {r: 4, fill: 'none', stroke: '#b00020', 'stroke-width': 1.5}),
      node('text', {y: -8, 'font-size': 12, 'font-weight': 600, fill: '#1d232b', stroke: '#fff', 'stroke-width': 3, 'paint-order': 'stroke'}));
    const cursor = node('line', {stroke: '#5a6472', 'stroke-width': 1, 'stroke-dasharray': '3 3'});
    const picked = node('line', {stroke: '#c8500a', 'stroke-width': 1.6});
    for (const part of [picked, cursor, mark]) { part.style.display = 'none'; part.style.pointerEvents = 'none'; }
    svg.append(picked, cursor, mark);
    const axes = svg.dataset.ax.split(' ').map(Number);
    // `axes` as shown, `home` as drawn; `view` takes drawn pixels to shown ones.
    const plot = {svg, mark, cursor, picked, legend: legendOf(svg), axis: axisOf(svg), axes, home: axes, view: {sx: 1, tx: 0, sy: 1, ty: 0}, points: null,
      cells: svg.dataset.cells ? JSON.parse(svg.dataset.cells) : null, dragged: false};
    plot.refresh = () => { plot.points = null; mark.style.display = 'none'; cursor.style.display = 'none'; markPicked(plot); };
    plot.isLog = (axis) => (svg.dataset.log || '').includes(axis);
    // NaN: the point has none.
    plot.valueOf = (axis, place) => axis === 'y' && place > Number(svg.dataset.highest) ? NaN : plot.isLog(axis) ? 10 ** place : place;
    plot.shapes = () => drawn(svg).map((shape) => ({shape, name: plot.legend.get(colourOf(shape))?.textContent || '', points: pointsOf(shape)}));
    svg.plumbline = plot;
    plots.push(plot);
    svg.addEventListener('pointermove', (event) => (plot.cells ? showCell : show)(plot, event));
    svg.addEventListener('click', (event) => pick(plot, event));
    svg.addEventListener('pointerleave', () => { mark.style.display = 'none'; pointAll(plot, null); });
    for (const [colour, text] of plot.legend) {
      if (!drawn(svg).some((shape) => colourOf(shape) === colour)) continue;
      text.style.cursor = 'pointer';
      text.setAttribute('tabindex', 0);
      text.setAttribute('role', 'button');
      text.setAttribute('aria-pressed', 'true');
      text.addEventListener('click', () => toggle(plot, colour, text));
      text.addEventListener('keydown', (event) => { if (event.key === 'Enter') toggle(plot, colour, text); });
    }
  });
})();
