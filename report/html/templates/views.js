// SPDX-License-Identifier: BSD-3-Clause
// Single views: draws the corners of the one that is picked with their errors, and tells its moment to the plots.
(() => {
  const node = (parent, name, attributes, text) => {
    const made = document.createElementNS('http://www.w3.org/2000/svg', name);
    for (const [key, value] of Object.entries(attributes)) made.setAttribute(key, value);
    if (text) made.textContent = text;
    parent.append(made);
    return made;
  };
  const unpacked = (text) => new Int16Array(Uint8Array.from(atob(text), (c) => c.charCodeAt(0)).buffer);
  const start = (box) => {
    const all = JSON.parse(box.querySelector('.views-data').textContent);
    const corners = unpacked(all.corners);
    const svg = box.querySelector('svg'), list = box.querySelector('dl'), slider = box.querySelector('input');
    const arrow = (u, v, du, dv) => `M${u} ${v}l${du} ${dv}m${-0.3 * (du + 0.5 * dv)} ${-0.3 * (dv - 0.5 * du)}L${u + du} ${v + dv}l${-0.3 * (du - 0.5 * dv)} ${-0.3 * (dv + 0.5 * du)}`;
    const draw = (view) => {
      const [c, , rmse, , , first, count] = view;
      const {width, height} = all.cameras[c];
      svg.replaceChildren();
      svg.setAttribute('viewBox', `-1 -1 ${width + 2} ${height + 2}`);
      node(svg, 'rect', {x: 0, y: 0, width, height, class: 'frame'});
      if (first < 0) {
        node(svg, 'text', {x: width / 2, y: height / 2, 'text-anchor': 'middle', 'font-size': width / 30}, 'The corners of this view are not kept in the page.');
        return 0;
      }
      const scale = Math.max(1, Math.round(width / 40 / Math.max(rmse, 1e-3)));
      const longest = width / 12;
      for (let i = first; i < first + count; ++i) {
        const rejected = corners[4 * i] < 0;
        const u = (rejected ? -1 - corners[4 * i] : corners[4 * i]) / 4, v = corners[4 * i + 1] / 4;
        const eu = corners[4 * i + 2] / 1000, ev = corners[4 * i + 3] / 1000, length = scale * Math.hypot(eu, ev);
        const shown = length > longest ? longest / length : 1;
        const r = width / 150;
        const shape = rejected ? node(svg, 'path', {class: 'rejected', d: `M${u - r} ${v - r}l${2 * r} ${2 * r}m0 ${-2 * r}l${-2 * r} ${2 * r}`})
          : node(svg, 'path', {class: shown < 1 ? 'cut' : 'error', d: arrow(u, v, scale * eu * shown, scale * ev * shown)});
        node(shape, 'title', {}, `(${u.toFixed(1)}, ${v.toFixed(1)}) px: error (${eu.toFixed(3)}, ${ev.toFixed(3)}) px${rejected ? ', rejected' : ''}`);
      }
      return scale;
    };
    const show = (index, told) => {
      const view = all.views[index];
      if (!view) return;
      slider.value = index;
      const [c, f, rmse, largest, used, , count] = view;
      const scale = draw(view);
      const [x, y, z, tilt] = all.poses[f];
      const rows = [['camera', all.cameras[c].name], ['frame', f], ['time', `${all.seconds[f].toFixed(2)} s`], ['RMSE', `${rmse.toFixed(3)} px`],
        ['largest error', `${largest.toFixed(2)} px`], ['corners used', used], ['rejected', count - used],
        ['camera 0 in the target’s frame', `(${x}, ${y}, ${z}) mm`], ['tilt against the target', `${tilt}°`], ['arrows', scale ? `magnified ${scale} times` : '–']];
      list.replaceChildren(...rows.flatMap(([name, value]) => {
        const dt = document.createElement('dt'), dd = document.createElement('dd');
        dt.textContent = name;
        dd.textContent = value;
        return [dt, dd];
      }));
      slider.setAttribute('aria-valuetext', `${all.cameras[c].name}, ${all.seconds[f].toFixed(2)} s`);
      if (!told) document.dispatchEvent(new CustomEvent('plumbline-picked', {detail: {seconds: all.seconds[f]}}));
    };
    slider.addEventListener('input', () => show(Number(slider.value)));
    box.querySelectorAll('[data-step]').forEach((b) => b.addEventListener('click', () => show(Number(slider.value) + Number(b.dataset.step))));
    // A moment of a plot: the view of the same camera, if the plot names one, that is nearest in time.
    document.addEventListener('plumbline-moment', ({detail: {seconds, series}}) => {
      const camera = all.cameras.findIndex((c) => c.name === series);
      let best = -1, least = Infinity;
      all.views.forEach(([c, f], i) => {
        const d = Math.abs(all.seconds[f] - seconds) + (camera >= 0 && c !== camera ? 1e6 : 0);
        if (d < least) { least = d; best = i; }
      });
      show(best);
    });
    const named = () => {
      const found = location.hash.match(new RegExp(`^#${box.dataset.stage}-view-(\\d+)$`));
      if (!found) return false;
      show(Number(found[1]));
      box.scrollIntoView({block: 'center'});
      return true;
    };
    addEventListener('hashchange', named);
    if (!named()) show(Number(slider.value), true);
  };
  document.querySelectorAll('.views').forEach(start);
})();
