// SPDX-License-Identifier: BSD-3-Clause
// What the page carries of a replay, decoded; report/html/replay/data.cpp wrote it.
window.plumblineReplay = {};
(() => {
  const bytesOf = (text) => {
    const raw = atob(text);
    const bytes = new Uint8Array(raw.length);
    for (let i = 0; i < raw.length; ++i) bytes[i] = raw.charCodeAt(i);
    return bytes;
  };
  const typed = (Type, text) => new Type(bytesOf(text).buffer);

  /** Index of the last element that is not above `value` in an ascending list; -1: all are above. */
  const lastUpTo = (list, value) => {
    let low = 0, high = list.length;
    while (low < high) {
      const middle = (low + high) >> 1;
      if (list[middle] <= value) low = middle + 1; else high = middle;
    }
    return low - 1;
  };

  /** The corners that a camera saw: a bit for each id and frame, then positions in quarter pixels. */
  class Corners {
    constructor(json, ids, frames) {
      this.masks = bytesOf(json.masks);
      this.uv = typed(Int16Array, json.uv);
      this.stride = Math.ceil(ids / 8);
      this.starts = new Uint32Array(frames + 1);
      for (let f = 0; f < frames; ++f) {
        let seen = 0;
        for (let b = 0; b < this.stride; ++b) {
          for (let m = this.masks[f * this.stride + b]; m; m &= m - 1) ++seen;
        }
        this.starts[f + 1] = this.starts[f] + seen;
      }
    }

    /** Map from id to [u, v] in pixels. */
    of(frame) {
      const found = new Map();
      let at = 2 * this.starts[frame];
      for (let b = 0; b < this.stride; ++b) {
        const mask = this.masks[frame * this.stride + b];
        for (let bit = 0; bit < 8; ++bit) {
          if (!(mask >> bit & 1)) continue;
          found.set(8 * b + bit, [this.uv[at] / 4, this.uv[at + 1] / 4]);
          at += 2;
        }
      }
      return found;
    }
  }

  const overlayOf = (json) => {
    const ids = typed(Uint16Array, json.ids), uv = typed(Int16Array, json.uv);
    return new Map([...ids].map((id, i) => [id, [uv[2 * i] / 4, uv[2 * i + 1] / 4]]));
  };

  /** Rows of [R t] from a position [mm] and a quaternion x y z w [1/32767]. */
  const matrixOf = (p) => {
    const n = Math.hypot(p[3], p[4], p[5], p[6]) || 1;
    const [x, y, z, w] = [p[3] / n, p[4] / n, p[5] / n, p[6] / n];
    return [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w), p[0] / 1000,
      2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w), p[1] / 1000,
      2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y), p[2] / 1000];
  };

  const roundsOf = (json) => {
    const poses = typed(Int16Array, json.poses);
    return json.rounds.map((r) => {
      const names = typed(Uint32Array, r.names), places = typed(Uint32Array, r.poses);
      return {...r, mi: typed(Float32Array, r.mi), error: typed(Float32Array, r.error), names: [...names].map((i) => json.names[i]),
        poses: [...places].map((i) => matrixOf(poses.subarray(7 * i, 7 * i + 7)))};
    });
  };

  const imagesOf = (json, cameras) => {
    let lines = null;
    return {
      any: json.frames.length > 0,
      /** The image that is shown at a frame: {frame, key, url}; null: none. */
      at(frame, camera) {
        const k = lastUpTo(json.frames, frame);
        if (k < 0 || frame - json.frames[k] >= 2 * json.step) return null;
        lines = lines || document.getElementById('replay-images').textContent.split('\n');
        const text = lines[k * cameras + camera];
        return text ? {frame: json.frames[k], key: `${k} ${camera}`, url: `data:image/jpeg;base64,${text}`} : null;
      },
    };
  };

  /** Seconds of playing up to each frame: stamps that jump back or far do not stop it. */
  const playTimes = (offsets) => {
    const times = new Float64Array(offsets.length);
    for (let i = 1; i < offsets.length; ++i) {
      times[i] = times[i - 1] + Math.min(1, Math.max(0.001, (offsets[i] - offsets[i - 1]) / 1e9));
    }
    return times;
  };

  window.plumblineReplay.lastUpTo = lastUpTo;
  window.plumblineReplay.read = () => {
    const json = JSON.parse(document.getElementById('replay-data').textContent);
    const offsets = typed(Float64Array, json.times.offsets);
    const frames = offsets.length;
    const table = Object.fromEntries(Object.entries(json.table).map(([k, v]) => [k, typed(Float64Array, v)]));
    const left = new Map(json.withdrawn);  // frame -> that at which it left the estimate again
    const kept = new Map();  // stage -> frames that it accepted
    for (let f = 0; f < frames; ++f) {
      if (table.accepted[f] !== 1) continue;
      if (!kept.has(table.stage[f])) kept.set(table.stage[f], []);
      kept.get(table.stage[f]).push(f);
    }
    const poses = typed(Float32Array, json.poses);
    const rounds = roundsOf(json.candidates);
    const roundFrames = rounds.map((r) => r.frame);
    const suggestions = json.suggestions.map((s) => ({...s, overlay: s.overlay.map(overlayOf)}));
    const byId = new Map(suggestions.map((s) => [s.id, s]));
    return {
      // Whether predicted errors decided, and not gains; the excess at which the camera stage stops, or null.
      byError: json.by_error, stopExcess: json.stop_excess,
      frames, table, words: json.words, target: {...json.target, points: typed(Float32Array, json.target.points)},
      start: BigInt(json.times.start), offsets, play: playTimes(offsets), details: new Map(json.details),
      cameras: json.cameras.map((c) => ({...c, corners: new Corners(c.corners, json.target.corners, frames)})),
      rounds, suggestions, events: json.events.map(([frame, kind, text]) => ({frame, kind, text})),
      images: imagesOf(json.images, json.cameras.length),
      word: (column, frame) => json.words[column][table[column][frame]] || '',
      pose: (frame) => (Number.isFinite(poses[12 * frame]) ? poses.subarray(12 * frame, 12 * frame + 12) : null),
      /** Frames that the stage of `frame` had kept by then. */
      keptBy: (frame) => {
        const all = kept.get(table.stage[frame]) || [];
        return all.slice(0, lastUpTo(all, frame) + 1).filter((f) => !(left.get(f) <= frame));
      },
      /** Whether a frame was accepted and not withdrawn. */
      stays: (frame) => table.accepted[frame] === 1 && !left.has(frame),
      /** The frame at which an accepted one was withdrawn; undefined: it was not. */
      leftAt: (frame) => left.get(frame),
      /** The candidates scored last in the stage of `frame`. */
      roundAt: (frame) => {
        const round = rounds[lastUpTo(roundFrames, frame)];
        return round && table.stage[round.frame] === table.stage[frame] ? round : null;
      },
      suggestionAt: (frame) => byId.get(table.suggestion[frame]) || null,
    };
  };
})();
