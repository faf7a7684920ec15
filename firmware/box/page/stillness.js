// Is the fork still? The spread of the measured positions of the last second, against the
// instrument's noise as the estimator knows it.
import {axes_of} from './signals.js';
import {Ring} from './ring.js';

const kWindow_s = 1;
const kFewest = 30;       // samples for a verdict
const kStill = 1.5;       // times the noise
const kCapacity = 4096;

const um = (m) => `${Number((m * 1e6).toPrecision(2))} \u00b5m`;

export class Stillness {
  constructor(axes) {
    this.ring = new Ring(kCapacity, axes);
    this.origin = [];
    this.line = null;
  }

  add(line, time_s, has_gap) {
    if (has_gap) this.ring.clear();
    const place = this.ring.add(time_s, has_gap);
    axes_of(line).forEach((axis, i) => {
      const value = line[axis].measured_position_m;
      const is_there = value !== null;
      if (is_there && this.origin[i] === undefined) this.origin[i] = value;  // keeps the digits
      this.ring.values[i][place] = is_there ? value - this.origin[i] : NaN;
    });
    this.line = line;
  }

  /** {still, noise, is_still}: words, and true, false or null for not known. */
  words() {
    const unknown = {still: 'not known yet', noise: 'not known yet', is_still: null};
    if (!this.line || this.ring.size === 0) return unknown;
    const first = this.ring.first_from(this.ring.newest_s() - kWindow_s);
    let largest = 0;
    let fewest = Infinity;
    for (const values of this.ring.values) {
      let n = 0;
      let mean = 0;
      let squares = 0;
      for (let k = first; k < this.ring.size; ++k) {
        const value = values[this.ring.place(k)];
        if (!(value === value)) continue;
        ++n;
        const step = value - mean;
        mean += step / n;
        squares += step * (value - mean);
      }
      fewest = Math.min(fewest, n);
      if (n > 1) largest = Math.max(largest, Math.sqrt(squares / (n - 1)));
    }
    const noise = Math.max(...axes_of(this.line).map((axis) => this.line[axis].noise_sd_m || NaN));
    const is_limited = this.line.events.includes('noise_at_limit');
    const noise_words = !(noise > 0) ? 'not known yet' :
      `${um(noise)} (sd) by the estimator${is_limited ? '; at its limit' : ''}`;
    if (fewest < kFewest) return {...unknown, noise: noise_words};
    // Standard error of a standard deviation, for independent samples.
    const half = 1.96 * largest / Math.sqrt(2 * (fewest - 1));
    const spread = `spread ${um(largest)} \u00b1 ${um(half)} (sd of 1 s)`;
    if (!(noise > 0) || is_limited) return {still: `${spread}; noise not known`, noise: noise_words, is_still: null};
    const is_still = largest < kStill * noise;
    return {
      still: `${is_still ? 'still' : 'moves'}: ${spread}, ${Number((largest / noise).toPrecision(2))} times the noise`,
      noise: noise_words, is_still,
    };
  }
}
