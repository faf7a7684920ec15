// The samples of the last seconds in arrays that never grow, and what a chart draws of them.

/** Samples: time, values (NaN: none) and whether a gap is before them. */
export class Ring {
  constructor(capacity, series) {
    this.capacity = capacity;
    this.time = new Float64Array(capacity);
    this.breaks = new Uint8Array(capacity);
    this.values = Array.from({length: series}, () => new Float32Array(capacity));
    this.latest_s = new Array(series).fill(-Infinity);  // of a value that `put` gave
    this.size = 0;
    this.end = 0;  // place of the next sample
  }

  clear() {
    this.latest_s.fill(-Infinity);
    this.size = 0;
    this.end = 0;
  }

  /** Adds a sample; its place takes the values. */
  add(time_s, has_gap) {
    const place = this.end;
    this.time[place] = time_s;
    this.breaks[place] = has_gap ? 1 : 0;
    this.end = (place + 1) % this.capacity;
    this.size = Math.min(this.size + 1, this.capacity);
    return place;
  }

  /** Gives series `s` its value at `place`; a chart draws only what came by this way. */
  put(s, place, value) {
    this.values[s][place] = value;
    if (value === value) this.latest_s[s] = this.time[place];
  }

  /** Place of the k-th sample, 0: the oldest. */
  place(k) {
    return (this.end - this.size + k + this.capacity) % this.capacity;
  }

  newest_s() {
    return this.size > 0 ? this.time[this.place(this.size - 1)] : null;
  }

  /** The first k whose time is `time_s` or later. */
  first_from(time_s) {
    let low = 0;
    let high = this.size;
    while (low < high) {
      const middle = (low + high) >> 1;
      if (this.time[this.place(middle)] < time_s) low = middle + 1;
      else high = middle;
    }
    return low;
  }
}

const kPoints = 3;  // of a column: one for a gap, the lowest and the highest

/** Arrays for `columns` columns of a chart, times in [0]. null: a gap; undefined: no point. */
export function chart_arrays(columns, series) {
  return Array.from({length: series + 1}, () => new Array(kPoints * columns).fill(null));
}

function clear_from(data, at, end_s, step) {
  for (let i = at; i < data[0].length; ++i) {
    data[0][i] = end_s + (i - at + 1) * step;
    for (let s = 1; s < data.length; ++s) data[s][i] = null;
  }
}

// Few samples: each with a place before it for a gap.
function all_samples(ring, chosen, k, end_s, data) {
  let at = 0;
  let before_s = null;
  for (; k < ring.size; ++k, at += 2) {
    const place = ring.place(k);
    const time_s = ring.time[place];
    data[0][at] = before_s === null ? time_s : (before_s + time_s) / 2;
    data[0][at + 1] = time_s;
    before_s = time_s;
    for (let s = 0; s < chosen.length; ++s) {
      const value = ring.values[chosen[s]][place];
      const is_there = value === value;  // not NaN
      data[s + 1][at] = ring.breaks[place] || !is_there ? null : undefined;
      data[s + 1][at + 1] = is_there ? value : null;
    }
  }
  clear_from(data, at, end_s, 1e-3);
}

// Many samples: the lowest and the highest of each column, in the order in which they came.
function extremes(ring, chosen, k, begin_s, width_s, data) {
  const columns = data[0].length / kPoints;
  for (let i = 0; i < data[0].length; ++i) data[0][i] = begin_s + (i + 0.5) / kPoints * width_s;
  const first = k;
  for (let s = 0; s < chosen.length; ++s) {
    const values = ring.values[chosen[s]];
    const out = data[s + 1];
    if (ring.latest_s[chosen[s]] < begin_s) {
      out.fill(null);
      continue;
    }
    const fill = (c, value) => out.fill(value, kPoints * c, kPoints * (c + 1));
    let c = -1;
    for (k = first; k < ring.size;) {
      const place = ring.place(k);
      const column = Math.min(columns - 1, Math.floor((ring.time[place] - begin_s) / width_s));
      // Empty columns: a gap, or only fewer samples than columns.
      for (++c; c < column; ++c) fill(c, ring.breaks[place] ? null : undefined);
      let has_gap = false;
      let low = Infinity;
      let high = -Infinity;
      let low_k = 0;
      let high_k = 0;
      for (; k < ring.size; ++k) {
        const here = ring.place(k);
        if (Math.min(columns - 1, Math.floor((ring.time[here] - begin_s) / width_s)) > column) break;
        const value = values[here];
        if (ring.breaks[here] || !(value === value)) has_gap = true;
        if (value < low) {
          low = value;
          low_k = k;
        }
        if (value > high) {
          high = value;
          high_k = k;
        }
      }
      const is_there = high >= low;
      const [a, b] = low_k < high_k ? [low, high] : [high, low];
      out[kPoints * column] = has_gap || !is_there ? null : undefined;
      out[kPoints * column + 1] = is_there ? a : null;
      out[kPoints * column + 2] = is_there ? b : null;
    }
    for (++c; c < columns; ++c) fill(c, null);
  }
}

/** Fills `data` with the series `chosen` of the time from `end_s - span_s` to `end_s`. */
export function fill_chart(ring, chosen, end_s, span_s, data) {
  const columns = data[0].length / kPoints;
  const width_s = span_s / columns;
  // Columns stand still in time, so that extremes do not flicker.
  const begin_s = (Math.floor((end_s - span_s) / width_s) + 1) * width_s;
  const k = ring.first_from(begin_s);
  if (ring.size - k <= columns) all_samples(ring, chosen, k, end_s, data);
  else extremes(ring, chosen, k, begin_s, width_s, data);
}
