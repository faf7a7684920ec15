// Chewing cycles as they come: the last one against the average of those before it. A cycle goes from
// one crossing of the middle of the movement, away from zero, to the next.
import {fixed} from '../../hosted/page/numbers.js';
import {axes_of, with_interval} from './signals.js';

const kPoints = 60;
const kLongest_s = 5;
const kShortest_s = 0.2;
const kHysteresis = 0.15;  // of the range, on both sides of the middle
const kSmallest_m = 1e-3;  // range that counts as movement
const kTimesNoise = 8;
const k95 = 1.959963984540054;

class Mean {
  constructor() {
    this.n = 0;
    this.mean = 0;
    this.squares = 0;
  }

  add(value) {
    ++this.n;
    const step = value - this.mean;
    this.mean += step / this.n;
    this.squares += step * (value - this.mean);
  }

  sd() {
    return this.n > 1 ? Math.sqrt(this.squares / (this.n - 1)) : NaN;
  }
}

function shape_of(samples, begin_s, duration_s) {
  const shape = new Float64Array(kPoints);
  let k = 0;
  for (let i = 0; i < kPoints; ++i) {
    const time_s = begin_s + duration_s * i / (kPoints - 1);
    while (k < samples.length - 2 && samples[k + 1].time_s < time_s) ++k;
    const [a, b] = [samples[k], samples[k + 1]];
    const share = Math.min(1, Math.max(0, (time_s - a.time_s) / (b.time_s - a.time_s)));
    shape[i] = a.value + share * (b.value - a.value);
  }
  return shape;
}

export class Cycles {
  constructor(canvas, words) {
    this.canvas = canvas;
    this.words = words;
    this.forget();
  }

  forget() {
    this.axis = null;
    this.count = 0;
    this.last = null;
    this.before = null;  // the last one's shape before it joins the average
    this.points = Array.from({length: kPoints}, () => new Mean());
    this.duration = new Mean();
    this.amplitude = new Mean();
    this.break_off();
    this.is_new = true;
  }

  break_off() {
    this.samples = null;  // of the cycle that is under way
    this.side = 0;        // of the middle: -1 near zero, 1 away from it
    this.previous = null;
    this.crossing = null;
    this.since = [];      // samples from before the latest crossing on
  }

  /** `ring`: positions of the axes from zero. Chooses what to follow; call it now and then. */
  watch(line, ring, axes) {
    let best = null;
    axes.forEach((axis, i) => {
      let low = Infinity;
      let high = -Infinity;
      for (let k = ring.first_from(ring.newest_s() - 5); k < ring.size; ++k) {
        const value = ring.values[i][ring.place(k)];
        if (value < low) low = value;
        if (value > high) high = value;
      }
      if (high > low && (!best || high - low > best.range)) {
        best = {axis, i, range: 1e-3 * (high - low), middle: 0.5e-3 * (high + low)};
      }
    });
    if (!best) return;
    const noise = line[best.axis].noise_sd_m || 0;
    if (best.range < Math.max(kSmallest_m, kTimesNoise * noise)) {
      this.level = null;
      this.break_off();
      return;
    }
    if (best.axis !== this.axis) {
      if (this.axis !== null && this.level && best.range < 1.3 * this.level.range) return;
      this.forget();
      this.axis = best.axis;
    }
    this.level = {...best, away: best.middle < 0 ? -1 : 1};
  }

  add(line, time_s, has_gap, zero) {
    if (has_gap) this.break_off();
    if (!this.level || !axes_of(line).includes(this.axis)) return;
    const of = line[this.axis];
    if (of.position_m === null) return this.break_off();
    const sample = {time_s, value: of.position_m - zero[this.level.i], sd: of.position_sd_m,
      velocity: of.velocity_m_s, run: line.run};
    const {middle, range, away} = this.level;
    const beyond = (sample.value - middle) * away;
    if (this.previous && beyond > 0 && (this.previous.value - middle) * away <= 0) {
      this.crossing = {...sample, time_s: this.previous.time_s + (sample.time_s - this.previous.time_s) *
        (middle - this.previous.value) / (sample.value - this.previous.value)};
      this.since = [this.previous];
    }
    this.since.push(sample);
    if (time_s - this.since[0].time_s > kLongest_s) this.since = [];
    if (this.samples) {
      this.samples.push(sample);
      if (time_s - this.samples.begin.time_s > kLongest_s) this.samples = null;
    }
    if (this.side < 1 && beyond > kHysteresis * range) {
      if (this.side === -1 && this.crossing) {
        if (this.samples) this.complete(this.crossing);
        this.samples = this.since.slice();
        this.samples.begin = this.crossing;
      }
      this.side = 1;
    } else if (this.side > -1 && beyond < -kHysteresis * range) {
      this.side = -1;
    }
    this.previous = sample;
  }

  complete(end) {
    const samples = this.samples.filter((sample) => sample.time_s <= end.time_s);
    const {begin} = this.samples;
    const duration_s = end.time_s - begin.time_s;
    if (duration_s < kShortest_s || samples.length < 8) return;
    if (this.last) {
      this.last.shape.forEach((value, i) => this.points[i].add(value));
      this.duration.add(this.last.duration_s);
      this.amplitude.add(this.last.amplitude_m);
    }
    let [low, high] = [samples[0], samples[0]];
    for (const sample of samples) {
      if (sample.value < low.value) low = sample;
      if (sample.value > high.value) high = sample;
    }
    // How far a crossing may be off: the position's uncertainty over the velocity.
    const off_s = (sample) => sample.sd / Math.abs(sample.velocity || NaN);
    this.last = {
      shape: shape_of(samples, begin.time_s, duration_s), duration_s,
      duration_half_s: k95 * Math.hypot(off_s(begin), off_s(end)),
      amplitude_m: high.value - low.value, amplitude_half_m: k95 * Math.hypot(low.sd, high.sd),
    };
    ++this.count;
    this.is_new = true;
  }

  tell() {
    if (!this.is_new) return;
    this.is_new = false;
    if (!this.last) {
      this.words.textContent = 'No cycle yet: the movement must repeat within 5 s, by 1 mm or more.';
      return;
    }
    const {last} = this;
    let words = `Cycle ${this.count}, axis ${this.axis}: ${with_interval(last.duration_s, last.duration_half_s)} s, ` +
      `${with_interval(1e3 * last.amplitude_m, 1e3 * last.amplitude_half_m)} mm. `;
    const n = this.duration.n;
    words += n < 3 ? 'The average needs 3 cycles before it.' :
      `Average of the ${n} before: ${with_interval(this.duration.mean, k95 * this.duration.sd() / Math.sqrt(n))} s, ` +
      `${with_interval(1e3 * this.amplitude.mean, 1e3 * k95 * this.amplitude.sd() / Math.sqrt(n))} mm. ` +
      'Dashes: the average; grey: one standard deviation on both sides.';
    this.words.textContent = words;
    this.draw();
  }

  draw() {
    const {canvas, last} = this;
    const ratio = devicePixelRatio;
    canvas.width = Math.round(canvas.clientWidth * ratio);
    canvas.height = Math.round(canvas.clientHeight * ratio);
    const context = canvas.getContext('2d');
    if (!last) return;
    const has_average = this.duration.n >= 3;
    let [low, high] = [Infinity, -Infinity];
    const see = (value) => {
      low = Math.min(low, value);
      high = Math.max(high, value);
    };
    last.shape.forEach(see);
    if (has_average) {
      for (const point of this.points) {
        see(point.mean - point.sd());
        see(point.mean + point.sd());
      }
    }
    const [left, bottom] = [52 * ratio, canvas.height - 24 * ratio];
    const x = (i) => left + (canvas.width - left - 8 * ratio) * i / (kPoints - 1);
    const y = (value) => bottom - (bottom - 10 * ratio) * (value - low) / (high - low);
    context.font = `${13 * ratio}px system-ui, "Liberation Sans", Arial, sans-serif`;
    context.fillStyle = '#000000';
    context.textAlign = 'right';
    context.fillText(`${fixed(1e3 * high, 1)}`, left - 6 * ratio, y(high) + 8 * ratio);
    context.fillText(`${fixed(1e3 * low, 1)}`, left - 6 * ratio, y(low));
    context.fillText('mm', left - 6 * ratio, (y(high) + y(low)) / 2);
    context.fillText('100 % of the cycle', canvas.width - 8 * ratio, canvas.height - 5 * ratio);
    const line = (values) => {
      context.beginPath();
      values.forEach((value, i) => (i ? context.lineTo(x(i), y(value)) : context.moveTo(x(i), y(value))));
    };
    if (has_average) {
      context.fillStyle = '#c9cfd6';
      line(this.points.map((point) => point.mean + point.sd()));
      for (let i = kPoints - 1; i >= 0; --i) context.lineTo(x(i), y(this.points[i].mean - this.points[i].sd()));
      context.fill();
    }
    context.strokeStyle = '#003a75';
    context.lineWidth = 4 * ratio;
    line([...last.shape]);
    context.stroke();
    if (!has_average) return;
    context.strokeStyle = '#ffb000';
    context.lineWidth = 2 * ratio;
    context.setLineDash([6 * ratio, 5 * ratio]);
    line(this.points.map((point) => point.mean));
    context.stroke();
    context.setLineDash([]);
  }
}
