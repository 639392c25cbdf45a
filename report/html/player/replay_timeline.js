// SPDX-License-Identifier: BSD-3-Clause
// Over the recording: each frame's score by the criterion, and what the stages stop by or their entropy. The abscissa counts frames, labelled with their times, so that
// it runs as the slider does; stamps that jump stay readable.
(() => {
  const LEFT = 46, RIGHT = 10, TOP = 15, BOTTOM = 16;
  const BANDS = {reached: 'rgba(20,121,79,.16)', expired: 'rgba(179,32,44,.12)', withdrawn: 'rgba(92,20,120,.1)', none: 'rgba(217,138,0,.17)'};
  const DARK_BANDS = {reached: 'rgba(79,195,138,.25)', expired: 'rgba(255,138,144,.25)', withdrawn: 'rgba(199,163,240,.25)', none: 'rgba(229,169,78,.28)'};
  const LIGHT = {ink: '#1d232b', soft: '#5a6472', grid: '#e4e8ed', kept: '#14794f', not: '#9aa5b1', dropped: '#e3b9a4', bad: '#b3202c', end: '#5c1478', halo: 'rgba(255,255,255,.85)', now: '#005ea2'};
  const DARK = {ink: '#e6e9ed', soft: '#a3adba', grid: '#343b45', kept: '#4fc38a', not: '#7b8794', dropped: '#a5806b', bad: '#ff8a90', end: '#c7a3f0', halo: 'rgba(27,32,39,.85)', now: '#74b4ec'};
  const scheme = matchMedia('(prefers-color-scheme: dark)');
  let inks = scheme.matches ? DARK : LIGHT;

  const roundStep = (span, most) => {
    const raw = span / most, power = 10 ** Math.floor(Math.log10(raw));
    return power * ([1, 2, 5].find((m) => m * power >= raw) || 10);
  };

  const linear = {
    to: (v) => v,
    /** Values with a label, about `most` of them. */
    ticks(low, high, most) {
      const step = roundStep(high - low, most), values = [];
      for (let v = step * Math.ceil(low / step); v <= high + 1e-9; v += step) values.push(v);
      return values;
    },
  };
  const logarithmic = {
    to: Math.log10,
    /** 1, 2, 5, 10, ...; powers of ten alone where these are too many. */
    ticks(low, high, most) {
      const of = (mantissas) => {
        const values = [];
        for (let e = Math.floor(Math.log10(low)); e <= Math.ceil(Math.log10(high)); ++e) values.push(...mantissas.map((m) => m * 10 ** e));
        return values.filter((v) => v >= low * (1 - 1e-9) && v <= high * (1 + 1e-9));
      };
      const fine = of([1, 2, 5]);
      return fine.length > most ? of([1]) : fine;
    },
  };
  /** From values to 0 ... 1 with a margin; `to`: linear or logarithmic. */
  const scaleOf = (kind, values) => {
    let low = values.reduce((a, b) => Math.min(a, b), Infinity), high = values.reduce((a, b) => Math.max(a, b), -Infinity);
    const [least, most] = [low, high];
    [low, high] = [kind.to(low), kind.to(high)];
    if (high - low < 1e-6) { low -= 0.5; high += 0.5; }
    const margin = 0.08 * (high - low);
    return {low: least, high: most, unit: (v) => (kind.to(v) - low + margin) / (high - low + 2 * margin)};
  };
  const percent = (share) => `${+(100 * share).toPrecision(3)} %`;

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
        const bands = scheme.matches ? DARK_BANDS : BANDS;
        ctx.fillStyle = bands[s.end] || bands.none;
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

    /** What values are compared with. */
    dashed(ctx, paint) {
      ctx.strokeStyle = inks.bad;
      ctx.setLineDash([5, 4]);
      ctx.lineWidth = 1.2;
      ctx.beginPath();
      paint();
      ctx.stroke();
      ctx.setLineDash([]);
    }

    /** Smaller where frames lie close together. */
    dotSize() { return Math.min(2.6, Math.max(1.3, 2 * (this.x(1) - this.x(0)))); }

    /** What the chart shows; in a narrow one without what stands behind the last comma or equals sign. */
    name(ctx, text) {
      this.canvas.setAttribute('aria-label', `${text}; click to jump`);
      while (LEFT + ctx.measureText(text).width > this.width && /[,=]/.test(text)) text = text.replace(/\s*[,=][^,=]*$/, '');
      ctx.fillStyle = inks.ink;
      ctx.textAlign = 'left';
      ctx.fillText(text, LEFT, TOP - 4);
      this.nameEnd = LEFT + ctx.measureText(text).width + 8;
    }
  }

  /** A score of every frame, logarithmic. */
  class ScoreLine extends Line {
    /** `at`: the height of a frame's score; NaN: it has none. */
    drawScores(ctx, at) {
      const size = this.dotSize();
      for (const round of [0, 1]) {  // what was kept lies on top
        for (let f = 0; f < this.data.frames; ++f) {
          const accepted = this.data.stays(f);
          if (Boolean(round) !== accepted) continue;
          if (this.data.table.reason[f] === this.busy) { ctx.fillStyle = inks.dropped; ctx.fillRect(this.x(f) - 0.5, this.y(0) - 4, 1.2, 4); }
          const unit = at(f);
          if (!Number.isNaN(unit)) this.dot(ctx, f, unit, accepted ? inks.kept : inks.not, accepted ? size : 0.65 * size);
        }
      }
    }
  }

  /** Gain of every frame in bits. */
  class GainLine extends ScoreLine {
    drawValues(ctx) {
      const {table} = this.data;
      const known = [...table.mi].filter((v) => Number.isFinite(v) && v > 0).map((v) => Math.log10(v / Math.LN2));
      const low = Math.max(-3, Math.floor(Math.min(-1, ...known))), high = Math.max(1, Math.ceil(Math.max(-9, ...known)));
      this.unit = (bits) => (bits === Infinity ? 1 : Math.min(1, Math.max(0, (Math.log10(Math.max(bits, 1e-12)) - low) / (high - low))));
      const step = this.height < 90 ? 2 : 1;
      for (let e = high; e >= low; e -= step) this.tick(ctx, this.unit(10 ** e), `${+(10 ** e).toPrecision(1)}`, LEFT, this.width - RIGHT);
      this.drawThreshold(ctx);
      this.drawScores(ctx, (f) => (Number.isNaN(table.mi[f]) ? NaN : this.unit(table.mi[f] / Math.LN2)));
      const nats = table.threshold.find((v) => v > 0);
      this.name(ctx, `Gain of each frame [bits]${nats ? `, threshold ${(nats / Math.LN2).toFixed(2)} bits = ${nats.toFixed(3)} nats` : ''}`);
    }

    drawThreshold(ctx) {
      for (const part of this.parts) {
        const threshold = this.data.table.threshold[part.from] / Math.LN2;
        if (!(threshold > 0)) continue;
        this.dashed(ctx, () => {
          ctx.moveTo(this.x(part.from), this.y(this.unit(threshold)));
          ctx.lineTo(this.x(part.to), this.y(this.unit(threshold)));
        });
      }
    }
  }

  /** Predicted error in px: with each frame; in the camera-IMU stage, which keeps every frame, after it. */
  class ErrorLine extends ScoreLine {
    drawValues(ctx) {
      const {table, frames, word} = this.data;
      const imu = (f) => word('stage', f) === 'camera-imu';
      const error = (f) => (imu(f) ? table.error[f] : table.error_with[f]);
      const known = [];
      for (let f = 0; f < frames; ++f) known.push(error(f), table.error_bound[f]);
      const values = known.filter((v) => v > 0 && Number.isFinite(v));
      this.name(ctx, 'Predicted error with each frame [px], dashed: bound');
      if (!values.length) return;
      const scale = scaleOf(logarithmic, values);
      for (const v of logarithmic.ticks(scale.low, scale.high, this.height / 18)) this.tick(ctx, scale.unit(v), `${+v.toPrecision(1)}`, LEFT, this.width - RIGHT);
      this.drawBound(ctx, scale);  // below the scores, which are close to it
      this.drawScores(ctx, (f) => (error(f) > 0 ? scale.unit(error(f)) : NaN));
      const part = this.parts.find((p) => imu(p.from));
      if (part) this.noteAbove(ctx, part, 'camera-imu: points predicted by the IMU');
    }

    /** At the part's end, where errors have fallen. */
    noteAbove(ctx, part, text) {
      ctx.fillStyle = inks.ink;
      ctx.textAlign = 'right';
      this.halo(ctx, text, this.x(part.to) - 5, TOP + 12);
    }

    drawBound(ctx, scale) {
      const {error_bound: bound} = this.data.table;
      this.dashed(ctx, () => {
        let stage = NaN;  // of the frame before that has a bound
        for (let f = 0; f < this.data.frames; ++f) {
          if (!(bound[f] > 0)) continue;
          const y = this.y(scale.unit(bound[f]));
          if (stage === this.data.table.stage[f]) ctx.lineTo(this.x(f), y); else ctx.moveTo(this.x(f), y);
          stage = this.data.table.stage[f];
        }
      });
    }
  }

  /** A quantity over each stage on the stage's own scale: entropy, or the excess that it stops by. */
  class CourseLine extends Line {
    drawValues(ctx) {
      this.parts.forEach((part, k) => this.drawPart(ctx, part, k));
      this.name(ctx, this.courseOf(this.parts[0]).title);
    }

    courseOf(part) {
      const {table, byError, stopExcess} = this.data;
      const excess = table.excess.subarray(part.from, part.to + 1).some((v) => v > 0 && Number.isFinite(v));
      if (!byError || !excess) return {title: 'Entropy [nats]', kind: linear, value: (f) => table.entropy[f]};
      const stop = stopExcess === null ? '' : `, stop at ${percent(stopExcess)}`;
      return {title: `Predicted excess over a corner's error [%]${stop}`, kind: logarithmic, stop: 100 * (stopExcess === null ? NaN : stopExcess),
        value: (f) => (table.excess[f] > 0 ? 100 * table.excess[f] : NaN)};
    }

    /** Named in the chart: what a later stage shows otherwise. */
    note(ctx, part, text) {
      ctx.fillStyle = inks.ink;
      ctx.textAlign = 'left';
      this.halo(ctx, text, this.x(part.from) + 5, this.height - BOTTOM - 5);
    }

    drawPart(ctx, part, k) {
      const {kind, value, stop, title} = this.courseOf(part);
      const values = [];
      for (let f = part.from; f <= part.to; ++f) values.push(value(f));
      const known = [...values, stop].filter(Number.isFinite);
      if (!values.some(Number.isFinite)) return;
      const scale = scaleOf(kind, known);
      this.drawTicks(ctx, part, k, {...scale, ticks: kind.ticks});
      if (k > 0) this.note(ctx, part, `${this.data.words.stage[part.stage]}${this.data.byError ? `: ${title.toLowerCase()}` : ''}, own scale`);
      if (Number.isFinite(stop)) this.dashed(ctx, () => { ctx.moveTo(this.x(part.from), this.y(scale.unit(stop))); ctx.lineTo(this.x(part.to), this.y(scale.unit(stop))); });
      ctx.strokeStyle = inks.kept;
      ctx.lineWidth = 1.6;
      ctx.beginPath();
      let pen = false;
      for (let f = part.from; f <= part.to; ++f) {
        const v = value(f);
        if (!Number.isFinite(v)) continue;
        const y = this.y(scale.unit(v));
        if (pen) ctx.lineTo(this.x(f), y); else ctx.moveTo(this.x(f), y);
        pen = true;
      }
      ctx.stroke();
      const size = this.dotSize();
      for (let f = part.from; k === 0 && f <= part.to; ++f) {
        if (this.data.stays(f) && Number.isFinite(value(f))) this.dot(ctx, f, scale.unit(value(f)), inks.kept, 0.8 * size);
      }
    }

    drawTicks(ctx, part, k, scale) {
      for (const v of scale.ticks(scale.low, scale.high, Math.max(2.5, this.height / 22))) {
        const label = `${+v.toPrecision(6)}`;
        if (k === 0) { this.tick(ctx, scale.unit(v), label, this.x(part.from), this.x(part.to)); continue; }
        ctx.fillStyle = inks.soft;
        ctx.textAlign = 'right';
        this.halo(ctx, label, this.x(part.to) - 3, this.y(scale.unit(v)) + 4);
      }
    }
  }

  window.plumblineReplay.timeline = (box, data, jump) => {
    const Scores = data.byError ? ErrorLine : GainLine;
    const lines = [new Scores(box.querySelector('[data-line="scores"]'), data, jump),
      new CourseLine(box.querySelector('[data-line="course"]'), data, jump)];
    return {
      layout() { lines.forEach((l) => l.layout()); },
      draw(frame) { lines.forEach((l) => l.draw(frame)); },
    };
  };
})();
