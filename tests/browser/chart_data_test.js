// SPDX-License-Identifier: Apache-2.0
// What the live charts draw of random samples: every extreme, every gap, and nothing that was not measured.
import {Ring, chart_arrays, fill_chart} from '../../firmware/box/page/ring.js';

const kSpan_s = 10;
let seed = 1;

// Park and Miller's generator: 0 to 1.
function random() {
  seed = seed * 48271 % 2147483647;
  return seed / 2147483647;
}

function expect(holds, words) {
  if (holds) return;
  console.error(`failed: ${words}`);
  process.exit(1);
}

// Samples at about `rate_Hz`, with pauses before a share of them, and some values missing.
function samples_at(rate_Hz, share_of_gaps, share_missing) {
  const samples = [];
  for (let time_s = 100 * random(); samples.length < 8000 && time_s < 140;) {
    const has_gap = samples.length === 0 || random() < share_of_gaps;
    time_s += (has_gap ? 1 + 40 * random() : 0.7 + 0.6 * random()) / rate_Hz;
    samples.push({time_s, has_gap, value: random() < share_missing ? NaN : Math.fround(200 * random() - 100)});
  }
  return samples;
}

function check(samples, columns) {
  const ring = new Ring(Math.ceil(samples.length * (0.5 + random())), 2);
  // The second series ends early, perhaps before what is shown.
  const length = Math.floor(samples.length * random());
  samples.forEach((sample, k) => {
    const place = ring.add(sample.time_s, sample.has_gap);
    sample.early = k < length ? -sample.value : NaN;
    ring.put(0, place, sample.value);
    ring.put(1, place, sample.early);
  });
  const kept = samples.slice(-ring.size);
  const end_s = kept[kept.length - 1].time_s + (random() < 0.5 ? 0 : 3 * random());
  const data = chart_arrays(columns, 2);
  fill_chart(ring, [0, 1], end_s, kSpan_s, data);
  const [times, values, early] = data;
  for (let i = 1; i < times.length; ++i) expect(times[i] >= times[i - 1], 'times rise');

  const width_s = kSpan_s / columns;
  const begin_s = (Math.floor((end_s - kSpan_s) / width_s) + 1) * width_s;
  const shown = kept.filter((sample) => sample.time_s >= begin_s);
  const there = shown.map((sample) => sample.value).filter((value) => value === value);
  const there_early = shown.map((sample) => sample.early).filter((value) => value === value);
  for (const [series, of_samples] of [[values, there], [early, there_early]]) {
    const drawn = series.filter((value) => value !== null && value !== undefined);
    const known = new Set(of_samples);
    expect(drawn.every((value) => known.has(value)), 'only samples are drawn');
    expect(drawn.length > 0 === of_samples.length > 0, 'what is there is drawn');
    if (drawn.length === 0) continue;
    expect(Math.max(...drawn) === Math.max(...of_samples), 'the highest is drawn');
    expect(Math.min(...drawn) === Math.min(...of_samples), 'the lowest is drawn');
  }
  // No line goes from a sample to the next over a gap, or over a missing value.
  const is_cut = (from_s, to_s) => values.some(
      (value, i) => value === null && times[i] >= from_s - width_s && times[i] <= to_s + width_s);
  for (let k = 1; k < shown.length; ++k) {
    const missing = shown[k].value !== shown[k].value;
    if (shown[k].has_gap || missing) {
      expect(is_cut(shown[k - 1].time_s, shown[k].time_s), `a gap at ${shown[k].time_s} s is drawn`);
    }
  }
  // And no gap where there is none.
  if (shown.length > 1 && shown.slice(1).every((sample) => !sample.has_gap) && there.length === shown.length) {
    const first = values.findIndex((value) => typeof value === 'number');
    const last = values.length - 1 - [...values].reverse().findIndex((value) => typeof value === 'number');
    expect(!values.slice(first, last).includes(null), 'a whole stretch is drawn whole');
  }
}

for (let run = 0; run < 400; ++run) {
  const rate_Hz = 2 * 1000 ** random();
  const gaps = [0, 0.001, 0.02, 0.3][run % 4];
  check(samples_at(rate_Hz, gaps, run % 3 === 0 ? 0.05 * random() : 0), 20 + Math.floor(500 * random()));
}
console.log('400 charts');
