// SPDX-License-Identifier: BSD-3-Clause
// Gain and entropy over the recording. The abscissa counts frames, labelled with their times, so that
// it runs as the slider does; stamps that jump stay readable.
(() => {
  const LEFT = 46, RIGHT = 10, TOP = 15, BOTTOM = 16;
  const BANDS = {reached: 'rgba(20,121,79,.16)', expired: 'rgba(179,32,44,.12)', withdrawn: 'rgba(92,20,120,.1)', none: 'rgba(217,138,0,.17)'};
  const LIGHT = {ink: '#1d232b', soft: '#5a6472', grid: '#e4e8ed', kept: '#14794f', not: '#9aa5b1', dropped: '#e3b9a4', bad: '#b3202c', end: '#5c1478', halo: 'rgba(255,255,255,.85)', now: '#005ea2'};
  const DARK = {ink: '#e6e9ed', soft: '#a3adba', grid: '#343b45', kept: '#4fc38a', not: '#7b8794', dropped: '#a5806b', bad: '#ff8a90', end: '#c7a3f0', halo: 'rgba(27,32,39,.85)', now: '#74b4ec'};
  const scheme = matchMedia('(prefers-color-scheme: dark)');
  let inks = scheme.matches ? DARK : LIGHT;

  const roundStep = (span, most) => {
    const raw = span / most, power = 10 ** Math.floor(Math.log10(raw));
    return power * ([1, 2, 5].find((m) => m * power >= raw) || 10);
  };

  /** Stretches of frames of one stage: {stage, from, to}. */
  const stretches = (data) => {
    const all = [];
    for (let f = 0; f < data.frames; ++f) {
      const stage = data.table.stage[f], last = all[all.length - 1];
      if (last && (last.stage === stage || Number.isNaN(stage))) last.to = f; else all.push({stage, from: f, to: f});
    }
    return all;
  };

  /** The frame at which each stage was over. */
  const finishes = (data) => {
    const found = new Map(), over = data.words.mode.indexOf('finished');
    for (let f = 0; f < data.frames; ++f) {
      const stage = data.table.stage[f];
      if (data.table.mode[f] === over && !found.has(stage)) found.set(stage, f);
    }
    return [...found.values()];
  };

  class Line {
    constructor(canvas, data, jump) {
      Object.assign(this, {canvas, data, still: document.createElement('canvas'), parts: stretches(data), ends: finishes(data)});
      this.busy = data.words.reason.indexOf('busy');
      const go = (e) => {
        const box = canvas.getBoundingClientRect();
        const share = (e.clientX - box.left - LEFT) / (box.width - LEFT - RIGHT);
        jump(Math.round(Math.min(1, Math.max(0, share)) * (data.frames - 1)));
      };
      canvas.addEventListener('pointerdown', (e) => { canvas.setPointerCapture(e.pointerId); go(e); });
      canvas.addEventListener('pointermove', (e) => { if (e.buttons & 1) go(e); });
    }

    x(frame) { return LEFT + (this.width - LEFT - RIGHT) * frame / Math.max(1, this.data.frames - 1); }
    y(unit) { return this.height - BOTTOM - unit * (this.height - TOP - BOTTOM); }

    layout() {
      this.ratio = window.devicePixelRatio || 1;
      this.width = this.canvas.clientWidth;
      this.height = this.canvas.clientHeight;
      for (const canvas of [this.canvas, this.still]) {
        canvas.width = Math.round(this.width * this.ratio);
        canvas.height = Math.round(this.height * this.ratio);
      }
      inks = scheme.matches ? DARK : LIGHT;
      const ctx = this.still.getContext('2d');
      ctx.setTransform(this.ratio, 0, 0, this.ratio, 0, 0);
      ctx.font = '12px Inter, "Helvetica Neue", Arial, "Liberation Sans", sans-serif';
      this.drawGround(ctx);
      this.drawValues(ctx);
      this.drawEnds(ctx);
    }

    draw(frame) {
      if (!this.still.width || !this.still.height) return;  // not shown
      const ctx = this.canvas.getContext('2d');
      ctx.setTransform(1, 0, 0, 1, 0, 0);
      ctx.clearRect(0, 0, this.canvas.width, this.canvas.height);
      ctx.drawImage(this.still, 0, 0);
      ctx.setTransform(this.ratio, 0, 0, this.ratio, 0, 0);
      ctx.fillStyle = inks.now;
      ctx.fillRect(this.x(frame) - 0.75, TOP - 1, 1.5, this.height - TOP - BOTTOM + 3);
    }

    drawGround(ctx) {
      for (const s of this.data.suggestions) {
        ctx.fillStyle = BANDS[s.end] || BANDS.none;
        ctx.fillRect(this.x(s.from), TOP, Math.max(1.5, this.x(s.to) - this.x(s.from)), this.height - TOP - BOTTOM);
      }
      ctx.strokeStyle = inks.grid;
      ctx.strokeRect(LEFT + 0.5, TOP + 0.5, this.width - LEFT - RIGHT - 1, this.height - TOP - BOTTOM - 1);
      this.drawTimes(ctx);
      for (const part of this.parts.slice(1)) this.rule(ctx, part.from, inks.soft, [2, 3]);
    }

    drawTimes(ctx) {
      const {offsets, frames} = this.data;
      const most = offsets.reduce((a, b) => Math.max(a, b), 0) / 1e9;
      if (!(most > 0)) return;
      const step = roundStep(most, Math.max(2, this.width / 90));
      let due = 0;  // as a multiple of the step
      ctx.fillStyle = inks.soft;
      ctx.textAlign = 'center';
      for (let f = 0; f < frames; ++f) {
        const number = Math.floor(offsets[f] / 1e9 / step + 1e-9);
        if (number < due) continue;
        ctx.textAlign = f === 0 ? 'left' : 'center';  // apart from the ordinate's least
        ctx.fillText(f === 0 ? '0 s' : `${+(step * number).toFixed(3)}`, this.x(f), this.height - 4);
        due = number + 1;
      }
    }

    rule(ctx, frame, colour, dashes) {
      ctx.strokeStyle = ctx.fillStyle = colour;
      ctx.setLineDash(dashes);
      ctx.lineWidth = 1.3;
      ctx.beginPath();
      ctx.moveTo(this.x(frame), TOP);
      ctx.lineTo(this.x(frame), this.height - BOTTOM);
      ctx.stroke();
      ctx.setLineDash([]);
    }

    halo(ctx, text, x, y) {
      const colour = ctx.fillStyle;
      ctx.lineWidth = 3;
      ctx.strokeStyle = inks.halo;
      ctx.strokeText(text, x, y);
      ctx.fillStyle = colour;
      ctx.fillText(text, x, y);
    }

    /** Each is named above the chart, or in it where the chart's own name is above. */
    drawEnds(ctx) {
      for (const f of this.ends) {
        this.rule(ctx, f, inks.end, []);
        const x = this.x(f), late = x > this.width - 80;
        ctx.textAlign = late ? 'right' : 'left';
        const begin = late ? x - 3 - ctx.measureText('end').width : x - 14;
        if (begin > this.nameEnd) ctx.fillText('end', late ? x - 3 : begin, TOP - 4);
        else this.halo(ctx, 'end', late ? x - 4 : x + 4, TOP + 12);
      }
    }

    tick(ctx, unit, label, from, to) {
      ctx.strokeStyle = inks.grid;
      ctx.lineWidth = 1;
      ctx.beginPath();
      ctx.moveTo(from, this.y(unit));
      ctx.lineTo(to, this.y(unit));
      ctx.stroke();
      ctx.fillStyle = inks.soft;
      ctx.textAlign = 'right';
      ctx.fillText(label, LEFT - 5, this.y(unit) + 4);
    }

    dot(ctx, frame, unit, colour, radius) {
      ctx.fillStyle = colour;
      ctx.beginPath();
      ctx.arc(this.x(frame), this.y(unit), radius, 0, 7);
      ctx.fill();
    }

    /** Smaller where frames lie close together. */
    dotSize() { return Math.min(2.6, Math.max(1.3, 2 * (this.x(1) - this.x(0)))); }

    /** In a narrow chart without what stands behind the last comma or equals sign. */
    name(ctx, text) {
      while (LEFT + ctx.measureText(text).width > this.width && /[,=]/.test(text)) text = text.replace(/\s*[,=][^,=]*$/, '');
      ctx.fillStyle = inks.ink;
      ctx.textAlign = 'left';
      ctx.fillText(text, LEFT, TOP - 4);
      this.nameEnd = LEFT + ctx.measureText(text).width + 8;
    }
  }

  /** Gain of every frame in bits, logarithmic. */
  class GainLine extends Line {
    drawValues(ctx) {
      const {table, frames} = this.data;
      const known = [...table.mi].filter((v) => Number.isFinite(v) && v > 0).map((v) => Math.log10(v / Math.LN2));
      const low = Math.max(-3, Math.floor(Math.min(-1, ...known))), high = Math.max(1, Math.ceil(Math.max(-9, ...known)));
      this.unit = (bits) => (bits === Infinity ? 1 : Math.min(1, Math.max(0, (Math.log10(Math.max(bits, 1e-12)) - low) / (high - low))));
      const step = this.height < 90 ? 2 : 1;
      const size = this.dotSize();
      for (let e = high; e >= low; e -= step) this.tick(ctx, this.unit(10 ** e), `${+(10 ** e).toPrecision(1)}`, LEFT, this.width - RIGHT);
      this.drawThreshold(ctx);
      for (const round of [0, 1]) {  // what was kept lies on top
        for (let f = 0; f < frames; ++f) {
          const accepted = this.data.stays(f);
          if (Boolean(round) !== accepted) continue;
          if (table.reason[f] === this.busy) { ctx.fillStyle = inks.dropped; ctx.fillRect(this.x(f) - 0.5, this.y(0) - 4, 1.2, 4); }
          if (!Number.isNaN(table.mi[f])) this.dot(ctx, f, this.unit(table.mi[f] / Math.LN2), accepted ? inks.kept : inks.not, accepted ? size : 0.65 * size);
        }
      }
      const nats = table.threshold.find((v) => v > 0);
      this.name(ctx, `Gain of each frame [bits]${nats ? `, threshold ${(nats / Math.LN2).toFixed(2)} bits = ${nats.toFixed(3)} nats` : ''}`);
    }

    drawThreshold(ctx) {
      const {table} = this.data;
      ctx.strokeStyle = inks.bad;
      ctx.setLineDash([5, 4]);
      ctx.lineWidth = 1.2;
      for (const part of this.parts) {
        const threshold = table.threshold[part.from] / Math.LN2;
        if (!(threshold > 0)) continue;
        ctx.beginPath();
        ctx.moveTo(this.x(part.from), this.y(this.unit(threshold)));
        ctx.lineTo(this.x(part.to), this.y(this.unit(threshold)));
        ctx.stroke();
      }
      ctx.setLineDash([]);
    }
  }

  /** Entropy in nats; each stage has its own parameters and its own scale. */
  class EntropyLine extends Line {
    drawValues(ctx) {
      this.parts.forEach((part, k) => this.drawPart(ctx, part, k));
      this.name(ctx, 'Entropy [nats]');
    }

    drawPart(ctx, part, k) {
      const {table} = this.data;
      const values = [...table.entropy.subarray(part.from, part.to + 1)].filter(Number.isFinite);
      if (!values.length) return;
      let low = Math.min(...values), high = Math.max(...values);
      if (high - low < 1e-6) { low -= 0.5; high += 0.5; }
      const margin = 0.08 * (high - low);
      const unit = (v) => (v - low + margin) / (high - low + 2 * margin);
      this.drawTicks(ctx, part, k, {low, high, unit});
      ctx.strokeStyle = inks.kept;
      ctx.lineWidth = 1.6;
      ctx.beginPath();
      let pen = false;
      for (let f = part.from; f <= part.to; ++f) {
        const v = table.entropy[f];
        if (!Number.isFinite(v)) continue;
        if (pen) ctx.lineTo(this.x(f), this.y(unit(v))); else ctx.moveTo(this.x(f), this.y(unit(v)));
        pen = true;
      }
      ctx.stroke();
      const size = this.dotSize();
      for (let f = part.from; k === 0 && f <= part.to; ++f) {
        if (this.data.stays(f) && Number.isFinite(table.entropy[f])) this.dot(ctx, f, unit(table.entropy[f]), inks.kept, 0.8 * size);
      }
    }

    drawTicks(ctx, part, k, scale) {
      const step = roundStep(scale.high - scale.low, Math.max(2.5, this.height / 22));
      for (let v = step * Math.ceil(scale.low / step); v <= scale.high + 1e-9; v += step) {
        const label = `${+v.toPrecision(6)}`;
        if (k === 0) { this.tick(ctx, scale.unit(v), label, this.x(part.from), this.x(part.to)); continue; }
        ctx.fillStyle = inks.soft;
        ctx.textAlign = 'right';
        this.halo(ctx, label, this.x(part.to) - 3, this.y(scale.unit(v)) + 4);
      }
      if (k > 0) { ctx.fillStyle = inks.ink; ctx.textAlign = 'left'; this.halo(ctx, `${this.data.words.stage[part.stage]}, own scale`, this.x(part.from) + 5, this.height - BOTTOM - 5); }
    }
  }

  window.plumblineReplay.timeline = (box, data, jump) => {
    const lines = [new GainLine(box.querySelector('[data-line="mi"]'), data, jump),
      new EntropyLine(box.querySelector('[data-line="entropy"]'), data, jump)];
    return {
      layout() { lines.forEach((l) => l.layout()); },
      draw(frame) { lines.forEach((l) => l.draw(frame)); },
    };
  };
})();
