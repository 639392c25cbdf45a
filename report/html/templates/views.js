// SPDX-License-Identifier: BSD-3-Clause
// Single views: draws the corners of the one that is picked with their errors, over its image where the page has it,
// and tells its moment and camera to the plots and the scene. Zoom: drag, double-click, keys, two fingers.
(() => {
  const node = (parent, name, attributes, text) => {
    const made = document.createElementNS('http://www.w3.org/2000/svg', name);
    for (const [key, value] of Object.entries(attributes)) made.setAttribute(key, value);
    if (text) made.textContent = text;
    parent.append(made);
    return made;
  };
  const unpacked = (text) => new Int16Array(Uint8Array.from(atob(text), (c) => c.charCodeAt(0)).buffer);
  // Drag over a part, or + - and arrows with the focus; double-click or 0 shows all.
  const zooms = (svg, whole, setBox) => {
    const now = () => { const b = svg.viewBox.baseVal; return [b.x, b.y, b.width, b.height]; };
    const place = (event) => new DOMPoint(event.clientX, event.clientY).matrixTransform(svg.getScreenCTM().inverse());
    const apply = (cx, cy, share) => {  // share of the whole that is seen
      const [x, y, w, h] = whole(), s = Math.min(1, Math.max(share, 0.02));
      const inside = (middle, from, size) => Math.max(from, Math.min(middle - s * size / 2, from + (1 - s) * size));
      setBox(inside(cx, x, w), inside(cy, y, h), s * w, s * h);
    };
    let from = null, shape = null;
    const stop = () => { shape?.remove(); from = shape = null; };
    svg.addEventListener('pointerdown', (event) => {
      if (event.button !== 0 || event.pointerType === 'touch') return;
      from = place(event);
      svg.setPointerCapture(event.pointerId);
    });
    svg.addEventListener('pointermove', (event) => {
      if (!from) return;
      const to = place(event), sizes = {x: Math.min(from.x, to.x), y: Math.min(from.y, to.y), width: Math.abs(to.x - from.x), height: Math.abs(to.y - from.y)};
      shape = shape || node(svg, 'rect', {class: 'drag'});
      for (const [key, value] of Object.entries(sizes)) shape.setAttribute(key, value);
    });
    svg.addEventListener('pointerup', (event) => {
      if (!from) return;
      const to = place(event), [, , w, h] = whole(), begun = from;
      stop();
      const share = Math.max(Math.abs(to.x - begun.x) / w, Math.abs(to.y - begun.y) / h);
      if (share > 0.02) apply((begun.x + to.x) / 2, (begun.y + to.y) / 2, share);
    });
    svg.addEventListener('pointercancel', stop);
    // Two fingers pinch and move: what is under them stays there. One moves what is zoomed; else the page scrolls.
    let touched = null;
    const fingers = ({touches}) => {
      const r = svg.getBoundingClientRect(), at = [...touches].slice(0, 2).map((t) => [(t.clientX - r.left) / r.width, (t.clientY - r.top) / r.height]);
      const sum = at.reduce((s, p) => [s[0] + p[0], s[1] + p[1]], [0, 0]);
      return {count: at.length, middle: sum.map((s) => s / at.length), apart: at.length === 2 ? Math.hypot((at[0][0] - at[1][0]) * r.width, (at[0][1] - at[1][1]) * r.height) : 1};
    };
    const begin = (event) => { touched = event.touches.length > 0 ? {...fingers(event), box: now()} : null; };
    for (const kind of ['touchstart', 'touchend', 'touchcancel']) svg.addEventListener(kind, begin, {passive: true});
    svg.addEventListener('touchmove', (event) => {
      const at = fingers(event);
      if (!touched || at.count !== touched.count || (at.count === 1 && now()[2] >= whole()[2])) return;
      if (event.cancelable) event.preventDefault();
      const [x, y, w, h] = touched.box, by = Math.min(whole()[2] / w, touched.apart / Math.max(1, at.apart));
      apply(x + w * (touched.middle[0] + by * (0.5 - at.middle[0])), y + h * (touched.middle[1] + by * (0.5 - at.middle[1])), by * w / whole()[2]);
    }, {passive: false});
    svg.addEventListener('dblclick', () => setBox(...whole()));
    svg.addEventListener('keydown', (event) => {
      if (event.ctrlKey || event.metaKey || event.altKey) return;
      const [x, y, w, h] = now(), share = w / whole()[2];
      const moves = {'+': [0, 0, 0.5], '=': [0, 0, 0.5], '-': [0, 0, 2], ArrowLeft: [-0.2, 0, 1], ArrowRight: [0.2, 0, 1], ArrowUp: [0, -0.2, 1], ArrowDown: [0, 0.2, 1]};
      const move = moves[event.key];
      if (event.key === '0' || event.key === 'Escape') setBox(...whole());
      else if (move && !(move[2] === 1 && share >= 1)) apply(x + w / 2 + move[0] * w, y + h / 2 + move[1] * h, share * move[2]);
      else return;
      event.preventDefault();
    });
  };
  const start = (box) => {
    const all = JSON.parse(box.querySelector('.views-data').textContent);
    const corners = unpacked(all.corners);
    const svg = box.querySelector('svg'), list = box.querySelector('dl'), slider = box.querySelector('input');
    const arrow = (u, v, du, dv) => `M${u} ${v}l${du} ${dv}m${-0.3 * (du + 0.5 * dv)} ${-0.3 * (dv - 0.5 * du)}L${u + du} ${v + dv}l${-0.3 * (du - 0.5 * dv)} ${-0.3 * (dv + 0.5 * du)}`;
    let box0 = [0, 0, 1, 1], shownCamera = -1, withImage = true;  // all of the image; of which camera
    const setBox = (x, y, w, h) => svg.setAttribute('viewBox', `${x} ${y} ${w} ${h}`);
    // The image under the corners: the centre of its first pixel is (0, 0), made smaller by a factor from the top left.
    const drawImage = (index) => {
      const image = withImage && all.images[index];
      svg.classList.toggle('over-image', Boolean(image));
      if (!image) return;
      const shape = node(svg, 'image', {x: -0.5, y: -0.5, href: `data:image/jpeg;base64,${image.jpeg}`, preserveAspectRatio: 'none'});
      const {width, height} = all.cameras[all.views[index][0]];
      for (const [key, size] of [['width', width], ['height', height]]) shape.setAttribute(key, Math.floor(size / image.factor) * image.factor);
    };
    const draw = (view, index) => {
      const [c, , rmse, , , first, count] = view;
      const {width, height} = all.cameras[c];
      svg.replaceChildren();
      if (c !== shownCamera) setBox(...(box0 = [-1, -1, width + 2, height + 2]));
      shownCamera = c;
      node(svg, 'rect', {x: 0, y: 0, width, height, class: 'frame'});
      drawImage(index);
      if (first < 0) {
        node(svg, 'text', {x: width / 2, y: height / 2, 'text-anchor': 'middle', 'font-size': width / 30}, 'The corners of this view are not included in the page.');
        return 0;
      }
      const scale = rmse === null ? 0 : Math.max(1, Math.round(width / 40 / Math.max(rmse, 1e-3)));
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
      const scale = draw(view, index);
      const [x, y, z, tilt] = all.poses[f];
      const rows = [['camera', all.cameras[c].name], ['frame', f], ['time', `${all.seconds[f].toFixed(2)} s`], ['RMSE', rmse === null ? '–' : `${rmse.toFixed(3)} px`],
        ['largest error', largest === null ? '–' : `${largest.toFixed(2)} px`], ['corners used', used], ['rejected', count - used],
        ['camera 0 in the target’s frame', `(${x}, ${y}, ${z}) mm`], ['tilt against the target', `${tilt}°`], ['arrows', scale ? `magnified ${scale} times` : '–']];
      if (all.images[index]) rows.push(['image', withImage ? 'shown' : 'hidden']);
      list.replaceChildren(...rows.flatMap(([name, value]) => {
        const dt = document.createElement('dt'), dd = document.createElement('dd');
        dt.textContent = name;
        dd.textContent = value;
        return [dt, dd];
      }));
      slider.setAttribute('aria-valuetext', `${all.cameras[c].name}, ${all.seconds[f].toFixed(2)} s`);
      if (!told) document.dispatchEvent(new CustomEvent('plumbline-picked', {detail: {seconds: all.seconds[f], camera: all.cameras[c].name}}));
    };
    slider.addEventListener('input', () => show(Number(slider.value)));
    box.querySelectorAll('[data-step]').forEach((b) => b.addEventListener('click', () => show(Number(slider.value) + Number(b.dataset.step))));
    box.querySelector('[data-image]')?.addEventListener('click', ({target}) => {
      withImage = !withImage;
      target.setAttribute('aria-pressed', String(withImage));
      show(Number(slider.value));
    });
    document.addEventListener('plumbline-step', ({detail: {by}}) => show(Number(slider.value) + by));
    zooms(svg, () => box0, setBox);
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
