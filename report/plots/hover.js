// SPDX-License-Identifier: BSD-3-Clause
// Shows the values of the nearest drawn point of every <svg data-ax>.
(() => {
  const numbers = (text) => (text.match(/-?[\d.]+/g) || []).map(Number);
  const pairs = (list) => {
    const points = [];
    for (let i = 0; i + 1 < list.length; i += 2) points.push([list[i], list[i + 1]]);
    return points;
  };
  const drawnPoints = (svg) => {
    const found = [];
    svg.querySelectorAll('polyline.data').forEach((line) => found.push(...pairs(numbers(line.getAttribute('points')))));
    svg.querySelectorAll('path.pts').forEach((path) => found.push(...pairs(numbers(path.getAttribute('d')))));
    return found;
  };
  const reach = 16;  // px within which a point is named
  const show = (svg, state, event) => {
    state.points = state.points || drawnPoints(svg);
    const at = new DOMPoint(event.clientX, event.clientY).matrixTransform(svg.getScreenCTM().inverse());
    let best = null, least = reach * reach;
    for (const p of state.points) {
      const d = (p[0] - at.x) ** 2 + (p[1] - at.y) ** 2;
      if (d < least) { least = d; best = p; }
    }
    state.mark.style.display = best ? '' : 'none';
    if (!best) return;
    const [x0, x1, y0, y1, px0, px1, py0, py1] = state.axes;
    const x = x0 + (best[0] - px0) * (x1 - x0) / (px1 - px0);
    const y = y0 + (best[1] - py0) * (y1 - y0) / (py1 - py0);
    const text = state.mark.lastChild;
    text.textContent = `${+x.toPrecision(4)}, ${+y.toPrecision(4)}`;
    const right = best[0] > (px0 + px1) / 2;
    text.setAttribute('text-anchor', right ? 'end' : 'start');
    text.setAttribute('x', right ? -8 : 8);
    state.mark.setAttribute('transform', `translate(${best[0]} ${best[1]})`);
  };
  document.querySelectorAll('svg[data-ax]').forEach((svg) => {
    const mark = document.createElementNS('http://www.w3.org/2000/svg', 'g');
    mark.innerHTML = '<circle r="4" fill="none" stroke="#b00020" stroke-width="1.5"/>' +
      '<text y="-8" font-size="12" font-weight="600" fill="#1d232b" stroke="#fff" stroke-width="3" paint-order="stroke"></text>';
    mark.style.display = 'none';
    mark.style.pointerEvents = 'none';
    svg.append(mark);
    const state = {mark, axes: svg.dataset.ax.split(' ').map(Number), points: null};
    svg.addEventListener('pointermove', (event) => show(svg, state, event));
    svg.addEventListener('pointerleave', () => { mark.style.display = 'none'; });
  });
})();
