// SPDX-License-Identifier: BSD-3-Clause
// The target, the cameras and the candidates in space, painted from back to front on a canvas: no
// GPU is needed. Coordinates are those of the target's frame F [m].
(() => {
  const BEST = '#e8590c', ASKED = '#e07b00';
  // What is worth most stands out most from the ground; .ramp of player.css has the same stops.
  const LIGHT = {stops: [[195, 211, 226], [90, 185, 225], [30, 111, 208], [92, 20, 120]], unscored: 'rgb(172,178,186)', kept: 'rgba(20,121,79,.5)'};
  const DARK = {stops: [[72, 84, 98], [45, 120, 190], [90, 185, 225], [226, 190, 255]], unscored: 'rgb(96,104,114)', kept: 'rgba(79,195,138,.5)'};
  const scheme = matchMedia('(prefers-color-scheme: dark)');
  const ink = () => scheme.matches ? DARK : LIGHT;

  const ramp = (unit) => {
    const {stops} = ink();
    const at = Math.min(0.9999, Math.max(0, unit)) * (stops.length - 1);
    const [a, b] = [stops[Math.floor(at)], stops[Math.floor(at) + 1]];
    return `rgb(${a.map((v, i) => Math.round(v + (at % 1) * (b[i] - v))).join(',')})`;
  };

  const apply = (T, x, y, z) => [T[0] * x + T[1] * y + T[2] * z + T[3],
    T[4] * x + T[5] * y + T[6] * z + T[7], T[8] * x + T[9] * y + T[10] * z + T[11]];
  const minus = (a, b) => [a[0] - b[0], a[1] - b[1], a[2] - b[2]];
  const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
  const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
  const unit = (a) => { const n = Math.hypot(...a) || 1; return a.map((v) => v / n); };

  /** Apex and image corners of a camera of the rig at T_FC0; `shape`: the same in camera 0 at depth 1. */
  const frustum = (T, shape, depth) => {
    const points = [];
    for (let k = 0; k < 5; ++k) {
      const p = [0, 1, 2].map((i) => shape[i] + depth * (shape[3 * k + i] - shape[i]));
      points.push(apply(T, ...p));
    }
    return points;
  };

  /** Turns about the focus with the target's y axis up. */
  class Eye {
    constructor(focus, distance) { this.home = {focus, distance, yaw: 0.62, pitch: 0.42}; this.reset(); }
    reset() { Object.assign(this, this.home); }
    /** `aside`: how far right of the middle the focus is seen, as a share of the width. */
    aim(width, height, aside) {
      const [cy, sy, cp, sp] = [Math.cos(this.yaw), Math.sin(this.yaw), Math.cos(this.pitch), Math.sin(this.pitch)];
      const back = [sy * cp, sp, cy * cp];
      this.at = this.focus.map((v, i) => v + this.distance * back[i]);
      this.forward = back.map((v) => -v);
      this.right = unit(cross(this.forward, [0, 1, 0]));
      this.down = cross(this.forward, this.right);
      Object.assign(this, {cx: (0.5 + aside) * width, cy: height / 2, f: 1.25 * Math.min(width, height)});
    }
    /** [x, y, depth] in pixels; null behind the eye. */
    project(p) {
      const d = minus(p, this.at);
      const z = dot(d, this.forward);
      if (z < 0.02) return null;
      return [this.cx + this.f * dot(d, this.right) / z, this.cy + this.f * dot(d, this.down) / z, z];
    }
    turn(dx, dy) {
      this.yaw -= dx * 0.008;
      this.pitch = Math.max(-1.5, Math.min(1.5, this.pitch + dy * 0.008));
    }
    move(dx, dy) {
      const s = this.distance / this.f;
      this.focus = this.focus.map((v, i) => v - s * (dx * this.right[i] + dy * this.down[i]));
    }
    zoom(steps) { this.distance = Math.min(50 * this.home.distance, Math.max(0.05 * this.home.distance, this.distance * Math.exp(0.0012 * steps))); }
  }

  class Scene {
    constructor(box, data) {
      Object.assign(this, {box, data, frame: 0, canvas: box.querySelector('canvas'), layout: () => this.resize()});
      this.size = Math.max(data.target.width, data.target.height);
      this.eye = this.firstEye();
      this.listen();
    }

    firstEye() {
      const {target, frames} = this.data;
      const poses = [];
      for (let f = 0; f < frames; f += Math.max(1, Math.floor(frames / 300))) poses.push(this.data.pose(f));
      this.data.rounds.slice(0, 3).forEach((r) => poses.push(...r.poses));
      this.known = poses.filter(Boolean).map((T) => [T[3], T[7], T[11]]);
      const depths = this.known.map((p) => Math.abs(p[2])).sort((a, b) => a - b);
      const far = depths.length ? depths[Math.floor(0.9 * (depths.length - 1))] : 2 * this.size;
      return new Eye([target.width / 2, target.height / 2, 0.45 * far], 1.25 * far + 1.15 * this.size);
    }

    /** Steps back until nearly all poses are in view. */
    fit() {
      const margin = 0.1 * Math.min(this.width, this.height);
      const inside = (p) => p && p[0] > margin && p[0] < this.width - margin && p[1] > margin && p[1] < this.height - 2 * margin;
      for (let k = 0; k < 20; ++k) {
        this.eye.aim(this.width, this.height, 0);
        if (this.known.filter((p) => inside(this.eye.project(p))).length >= 0.97 * this.known.length) break;
        this.eye.home.distance *= 1.08;
        this.eye.reset();
      }
      this.fitted = true;
    }

    resize() {
      const ratio = window.devicePixelRatio || 1;
      this.width = this.box.clientWidth;
      this.height = this.box.clientHeight;
      this.canvas.width = Math.round(this.width * ratio);
      this.canvas.height = Math.round(this.height * ratio);
      this.ratio = ratio;
      if (!this.fitted && this.width && this.height) this.fit();
      this.draw(this.frame);
    }

    line(ctx, points, closed) {
      let pen = false;
      for (const point of closed ? [...points, points[0]] : points) {
        const p = this.eye.project(point);
        if (p) { if (pen) ctx.lineTo(p[0], p[1]); else ctx.moveTo(p[0], p[1]); }
        pen = Boolean(p);
      }
    }

    stroke(ctx, colour, width, paint) {
      ctx.beginPath();
      paint();
      ctx.strokeStyle = colour;
      ctx.lineWidth = width;
      ctx.stroke();
    }

    frustumLines(ctx, p) {
      this.line(ctx, p.slice(1), true);
      this.line(ctx, [p[1], p[0], p[3]], false);
      this.line(ctx, [p[2], p[0], p[4]], false);
    }

    drawTarget(ctx) {
      const {width: w, height: h, margin: m, points, corners} = this.data.target;
      const front = this.eye.at[2] > 0;
      ctx.beginPath();
      this.line(ctx, [[-m, -m, 0], [w + m, -m, 0], [w + m, h + m, 0], [-m, h + m, 0]], true);
      ctx.fillStyle = front ? '#fff' : '#dde2e8';
      ctx.fill();
      this.stroke(ctx, '#969ca6', 1, () => this.line(ctx, [[-m, -m, 0], [w + m, -m, 0], [w + m, h + m, 0], [-m, h + m, 0]], true));
      if (front) {
        ctx.beginPath();
        for (let id = 0; id < corners; id += 4) {
          this.line(ctx, [0, 1, 2, 3].map((k) => [points[2 * (id + k)], points[2 * (id + k) + 1], 0]), true);
        }
        ctx.fillStyle = '#2a3038';
        ctx.fill();
      }
      const axes = [[[1, 0, 0], '#c81e28'], [[0, 1, 0], '#148c3c'], [[0, 0, 1], '#1e50c8']];
      for (const [d, colour] of axes) this.stroke(ctx, colour, 2, () => this.line(ctx, [[0, 0, 0], d.map((v) => 0.28 * this.size * v)], false));
    }

    drawKept(ctx) {
      const kept = this.data.keptBy(this.frame).filter((f) => this.data.pose(f));
      const stage = this.data.word('stage', this.frame);
      if (stage === 'camera-imu') {  // every frame is kept: their path says it
        this.stroke(ctx, ink().kept, 1.2, () => this.line(ctx, kept.map((f) => { const T = this.data.pose(f); return [T[3], T[7], T[11]]; }), false));
        return;
      }
      const step = Math.ceil(kept.length / 150) || 1;
      this.stroke(ctx, ink().kept, 1, () => {
        for (let i = 0; i < kept.length; i += step) this.frustumLines(ctx, frustum(this.data.pose(kept[i]), this.data.cameras[0].frustum, 0.07 * this.size));
      });
    }

    /** The camera for whose image a view was made: "cam1 tilt-x -30"; a trajectory is camera 0's. */
    cameraOf(name) {
      const found = /^cam(\d+) /.exec(name);
      return this.data.cameras[found ? Number(found[1]) : 0] || this.data.cameras[0];
    }

    candidateShape(round, i, size = 0.055) {
      return frustum(round.poses[i], this.cameraOf(round.names[i]).frustum, size * this.size);
    }

    drawCandidates(ctx, round) {
      this.spots = [];
      const most = Math.max(1e-9, ...round.poses.map((_, i) => this.worth(round, i)).filter(Number.isFinite));
      const order = round.poses.map((T, i) => ({i, shape: this.candidateShape(round, i), at: this.eye.project(frustum(T, this.cameraOf(round.names[i]).frustum, 0)[0])}))
        .filter((c) => c.at).sort((a, b) => b.at[2] - a.at[2]);
      for (const {i, shape, at} of order) {
        this.spots.push({x: at[0], y: at[1], text: `${round.names[i]}: ${this.score(round, i)}`});
        if (i === round.best) continue;
        const worth = this.worth(round, i), scored = !Number.isNaN(worth);
        const colour = scored ? ramp(worth / most) : ink().unscored;
        this.stroke(ctx, colour, scored ? 1.3 : 0.8, () => this.frustumLines(ctx, shape));
      }
      if (round.best < 0) return most;
      const best = this.candidateShape(round, round.best, 0.085);
      this.stroke(ctx, BEST, 2.2, () => this.frustumLines(ctx, best));
      const at = this.eye.project(best[0]);
      if (at) { ctx.beginPath(); ctx.arc(at[0], at[1], 6, 0, 7); ctx.lineWidth = 2; ctx.stroke(); }
      return most;
    }

    drawSuggestion(ctx, suggestion) {
      const p = suggestion.path, points = [];
      for (let i = 0; i < p.length; i += 3) points.push([p[i], p[i + 1], p[i + 2]]);
      if (points.length) this.stroke(ctx, ASKED, 2, () => this.line(ctx, points, false));
      ctx.setLineDash([4, 3]);
      this.stroke(ctx, ASKED, 2, () => this.frustumLines(ctx, frustum(suggestion.pose, this.data.cameras[suggestion.camera].frustum, 0.13 * this.size)));
      ctx.setLineDash([]);
    }

    drawRig(ctx) {
      const T = this.data.pose(this.frame);
      if (!T) return;
      for (const camera of this.data.cameras) {
        this.stroke(ctx, `rgb(${camera.colour.join(',')})`, 2.2, () => this.frustumLines(ctx, frustum(T, camera.frustum, 0.16 * this.size)));
      }
    }

    /** Whether the round's candidates were compared by their predicted errors. */
    byError(round) { return this.data.byError && Number.isFinite(round.error_before) && round.error.length > 0; }

    /** By the criterion: what a candidate lowers the predicted error by [px], or its gain [nats]; NaN: not scored. */
    worth(round, i) { return this.byError(round) ? round.error_before - round.error[i] : round.mi[i]; }

    worthText(round, worth) { return this.byError(round) ? `${worth.toFixed(3)} px` : this.gain(worth); }

    /** Bits, and the predicted error with it where that is known: first by what was decided. */
    score(round, i) {
      const px = round.error[i], bits = this.gain(round.mi[i]);
      if (!Number.isFinite(px)) return bits;
      return this.byError(round) ? `error ${px.toFixed(3)} px, ${bits}` : `${bits}, error ${px.toFixed(3)} px`;
    }

    gain(nats) {
      if (Number.isNaN(nats)) return 'not scored';
      return nats === Infinity ? 'unbounded' : `${(nats / Math.LN2).toFixed(2)} bits`;
    }

    draw(frame) {
      this.frame = frame;
      if (!this.width) return;
      const ctx = this.canvas.getContext('2d');
      ctx.setTransform(this.ratio, 0, 0, this.ratio, 0, 0);
      ctx.clearRect(0, 0, this.width, this.height);
      ctx.lineJoin = ctx.lineCap = 'round';
      const round = this.data.roundAt(frame);
      this.eye.aim(this.width, this.height, this.isListed(round) ? 0.17 : 0);
      this.drawTarget(ctx);
      this.drawKept(ctx);
      this.spots = [];
      const most = round ? this.drawCandidates(ctx, round) : 0;
      const suggestion = this.data.suggestionAt(frame);
      if (suggestion) this.drawSuggestion(ctx, suggestion);
      this.drawRig(ctx);
      this.say(round, most, suggestion);
    }

    say(round, most, suggestion) {
      const legend = this.box.querySelector('[data-part="legend"]');
      const parts = [this.data.pose(this.frame) ? '<span><b>current</b> thick</span>' : '<span><b>no pose</b> at this frame</span>',
        `<span class="kept">kept: ${this.data.table.kept[this.frame] || 0}</span>`];
      if (suggestion) parts.push('<span class="asked">suggested: dashed</span>');
      if (round && round.poses.length && !this.isListed(round)) {
        parts.push(`<span>candidates${this.byError(round) ? ' lower the error by' : ''} <i class="ramp"></i>0 to ${this.worthText(round, most)}</span><span>grey: not scored</span><span class="best">best: ring</span>`);
      }
      if (legend.innerHTML !== parts.join('')) legend.innerHTML = parts.join('');
      this.list(round);
    }

    /** Few candidates are named. */
    isListed(round) { return Boolean(round) && round.poses.length > 0 && round.poses.length <= 12; }

    list(round) {
      const box = this.box.querySelector('[data-part="candidates"]');
      box.hidden = !this.isListed(round);
      if (box.hidden || this.listed === round) return;
      this.listed = round;
      const table = document.createElement('table');
      round.names.forEach((name, i) => {
        const row = table.insertRow();
        row.className = i === round.best ? 'best' : '';
        row.insertCell().textContent = name;
        row.insertCell().textContent = this.score(round, i);
      });
      box.replaceChildren(table);
    }

    point(event) {
      const box = this.canvas.getBoundingClientRect();
      const [x, y] = [event.clientX - box.left, event.clientY - box.top];
      let best = null, least = 144;
      for (const s of this.spots || []) {
        const d = (s.x - x) ** 2 + (s.y - y) ** 2;
        if (d < least) { least = d; best = s; }
      }
      this.canvas.title = best ? best.text : '';
    }

    listen() {
      let last = null;
      const redraw = () => this.draw(this.frame);
      this.canvas.addEventListener('pointerdown', (e) => { if (e.button !== 0) return; last = [e.clientX, e.clientY]; this.canvas.setPointerCapture(e.pointerId); });
      for (const end of ['pointerup', 'pointercancel', 'lostpointercapture']) this.canvas.addEventListener(end, () => { last = null; });
      this.canvas.addEventListener('pointermove', (e) => {
        if (!last) { this.point(e); return; }
        this.eye[e.shiftKey ? 'move' : 'turn'](e.clientX - last[0], e.clientY - last[1]);
        last = [e.clientX, e.clientY];
        redraw();
      });
      this.canvas.addEventListener('wheel', (e) => { e.preventDefault(); this.eye.zoom(e.deltaY); redraw(); }, {passive: false});
      this.canvas.addEventListener('dblclick', () => { this.eye.reset(); redraw(); });
    }
  }

  window.plumblineReplay.scene = (box, data) => new Scene(box, data);
})();
