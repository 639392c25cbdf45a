// SPDX-License-Identifier: BSD-3-Clause
// What each camera saw, and over it what the guide asked for.
(() => {
  const SEEN = '#11875a', ASKED = '#e07b00', NEAR = '#11b36b';

  const quads = (corners) => {
    const found = [], alone = [];
    for (const [id, uv] of corners) {
      if (id % 4) continue;
      const all = [uv, corners.get(id + 1), corners.get(id + 2), corners.get(id + 3)];
      if (all.every(Boolean)) found.push(all);
    }
    for (const [id, uv] of corners) {
      const first = id - id % 4;
      if (![0, 1, 2, 3].every((k) => corners.has(first + k))) alone.push(uv);
    }
    return {found, alone};
  };

  const trace = (ctx, list) => {
    ctx.beginPath();
    for (const quad of list) {
      quad.forEach(([u, v], k) => (k ? ctx.lineTo(u, v) : ctx.moveTo(u, v)));
      ctx.closePath();
    }
  };

  const dots = (ctx, list, radius) => {
    ctx.beginPath();
    for (const [u, v] of list) { ctx.moveTo(u + radius, v); ctx.arc(u, v, radius, 0, 7); }
    ctx.fill();
  };

  class View {
    constructor(data, camera, redraw) {
      Object.assign(this, {data, camera, redraw, pictures: new Map()});
      this.box = document.createElement('figure');
      this.box.className = 'player-view';
      this.canvas = document.createElement('canvas');
      this.canvas.setAttribute('aria-label', `View of ${data.cameras[camera].name}; described below it`);
      this.caption = document.createElement('figcaption');
      this.box.append(this.canvas, this.caption);
    }

    resize(width) {
      const {width: w, height: h} = this.data.cameras[this.camera];
      const ratio = window.devicePixelRatio || 1;
      this.scale = width * ratio / w;
      this.canvas.width = Math.round(width * ratio);
      this.canvas.height = Math.round(width * ratio * h / w);
      this.canvas.style.width = `${width}px`;
      this.canvas.style.height = `${width * h / w}px`;
    }

    /** The decoded picture, or null until it is. */
    picture(image) {
      const known = this.pictures.get(image.key);
      if (known) return known.complete && known.naturalWidth ? known : null;
      if (this.pictures.size > 40) this.pictures.delete(this.pictures.keys().next().value);
      const picture = new Image();
      this.pictures.set(image.key, picture);
      picture.onload = () => this.redraw();
      picture.src = image.url;
      return null;
    }

    drawSeen(ctx, corners, on_picture) {
      const {found, alone} = quads(corners);
      trace(ctx, found);
      if (on_picture) {
        ctx.strokeStyle = SEEN;
        ctx.lineWidth = 1.6 / this.pixel;
        ctx.stroke();
      } else {
        ctx.fillStyle = '#2a3038';
        ctx.fill();
      }
      ctx.fillStyle = on_picture ? SEEN : '#2a3038';
      dots(ctx, alone, 2 / this.pixel);
    }

    drawAsked(ctx, corners, near) {
      const {found, alone} = quads(corners);
      ctx.strokeStyle = ctx.fillStyle = near ? NEAR : ASKED;
      ctx.lineWidth = 1.8 / this.pixel;
      trace(ctx, found);
      ctx.globalAlpha = 0.16;
      ctx.fill();
      ctx.globalAlpha = 1;
      ctx.stroke();
      dots(ctx, alone, 2.2 / this.pixel);
    }

    say(frame, image, suggestion) {
      const camera = this.data.cameras[this.camera];
      const parts = [camera.name];
      if (suggestion && !suggestion.path.length && suggestion.camera === this.camera) parts.push(`#${suggestion.id} suggested here`);
      if (suggestion && suggestion.path.length) parts.push(`#${suggestion.id}: its start`);
      if (image && image.frame !== frame) parts.push(`image of frame ${image.frame}`);
      this.caption.textContent = parts.join(' \u00b7 ');
    }

    draw(frame) {
      const {data} = this;
      const ctx = this.canvas.getContext('2d');
      const camera = data.cameras[this.camera];
      ctx.setTransform(1, 0, 0, 1, 0, 0);
      ctx.fillStyle = '#fff';
      ctx.fillRect(0, 0, this.canvas.width, this.canvas.height);
      const image = data.images.at(frame, this.camera);
      const picture = image && (this.picture(image) || this.last);  // the one before while it loads
      const next = frame + 1 < data.frames && data.images.at(frame + 1, this.camera);
      if (next) this.picture(next);
      this.last = picture;
      if (picture) {
        ctx.globalAlpha = image.frame === frame ? 1 : 0.5;
        ctx.drawImage(picture, 0, 0, this.canvas.width, this.canvas.height);
        ctx.globalAlpha = 1;
      }
      // The first pixel's centre is (0, 0).
      ctx.setTransform(this.scale, 0, 0, this.scale, this.scale / 2, this.scale / 2);
      this.pixel = this.scale / (window.devicePixelRatio || 1);
      const seen = camera.corners.of(frame);
      this.drawSeen(ctx, seen, Boolean(image));
      const suggestion = data.suggestionAt(frame);
      const overlay = suggestion && suggestion.overlay[this.camera];
      if (overlay && overlay.size) this.drawAsked(ctx, overlay, data.table.held[frame] > 0);
      if (!seen.size && !image) {
        ctx.setTransform(1, 0, 0, 1, 0, 0);
        ctx.fillStyle = '#8a94a0';
        ctx.font = `${13 * (window.devicePixelRatio || 1)}px sans-serif`;
        ctx.textAlign = 'center';
        ctx.fillText('no target in view', this.canvas.width / 2, this.canvas.height / 2);
      }
      this.say(frame, image, suggestion);
    }
  }

  window.plumblineReplay.views = (box, data) => {
    let shown = 0;
    const draw = () => views.forEach((v) => v.draw(shown));
    const views = data.cameras.map((_, camera) => new View(data, camera, draw));
    box.append(...views.map((v) => v.box));
    const layout = () => {  // as many columns as make the images largest
      if (!views.length) return;
      const aspect = Math.max(...data.cameras.map((c) => c.height / c.width));
      let best = 0, columns = 1;
      for (let n = 1; n <= views.length; ++n) {
        const rows = Math.ceil(views.length / n);
        const width = Math.min((box.clientWidth - 6 * (n + 1)) / n, (box.clientHeight - 6 * (rows + 1)) / rows / aspect);
        if (width > best) { best = width; columns = n; }
      }
      box.style.gridTemplateColumns = `repeat(${columns}, auto)`;
      views.forEach((v) => v.resize(Math.max(60, Math.floor(best))));
      draw();
    };
    return {layout, draw(frame) { shown = frame; draw(); }};
  };
})();
