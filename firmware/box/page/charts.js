// The scrolling charts. Scales stay as they are until a value leaves them or the user fits them.
import uPlot from 'uplot';

import {lineSample} from '../../hosted/page/line_sample.js';
import {chart_arrays, fill_chart} from './ring.js';
import {mark_of, quantity_words, set_mark} from './signals.js';

/** Length of the charts. */
const kSpan_s = 10;
const kHeight = 150;
// Told apart by darkness and by dashes too.
const kLines = [
  {stroke: '#003a75', dash: []},
  {stroke: '#a33c00', dash: [9, 4]},
  {stroke: '#2a6a12', dash: [4, 3]},
];
const kAssumed = [1, 4];

// The next of 1, 2, 5, 10, ... from `value` on.
function round_up(value) {
  const power = 10 ** Math.floor(Math.log10(value));
  return [1, 2, 5, 10].map((step) => step * power).find((step) => step >= value * 0.999);
}

class Chart {
  // `first`: the group's first signal among `all` of the ring, whose assumed values follow.
  constructor(parent, group, first, all, ring) {
    this.group = group;
    this.ring = ring;
    this.chosen = [0, all].flatMap((from) => group.signals.map((signal, i) => from + first + i));
    this.range = [-1e-9, 1e-9];
    const figure = document.createElement('div');
    figure.className = 'chart';
    this.title = document.createElement('h3');
    this.name(group.title);
    const values = document.createElement('div');
    values.className = 'values';
    this.words = group.signals.map((signal, i) => {
      const words = document.createElement('span');
      words.className = 'value';
      const text = document.createElement('span');
      const mark = mark_of('');
      words.append(lineSample(kLines[i].stroke, kLines[i].dash), ` ${signal.name} `, mark, ' ', text);
      values.append(words);
      return {text, mark};
    });
    this.place = document.createElement('div');
    figure.append(this.title, values, this.place);
    parent.append(figure);
    this.make();
  }

  make() {
    const width = Math.max(240, this.place.clientWidth);
    this.data = chart_arrays(Math.min(width - 60, 600), this.chosen.length);
    this.plot = new uPlot({
      width,
      height: kHeight,
      legend: {show: false},
      cursor: {show: false},
      scales: {x: {time: false, auto: false}, y: {auto: false, range: () => this.range}},
      axes: [
        {size: 28, splits: (u) => [-10, -8, -6, -4, -2, 0].map((s) => u.scales.x.max + s),
          values: () => ['-10 s', '-8', '-6', '-4', '-2', 'now'], stroke: '#000000'},
        {size: 56, stroke: '#000000'},
      ],
      series: [{}, ...this.chosen.map((signal, i) => {
        const line = kLines[i % this.group.signals.length];
        const dash = i < this.group.signals.length ? line.dash : kAssumed;
        return {stroke: line.stroke, dash, width: 1, points: {show: false}, auto: false};
      })],
      hooks: {draw: [(u) => this.mark_gaps(u)]},
    }, this.data, this.place);
  }

  name(title) {
    this.title.textContent = `${title} (${this.group.unit})`;
  }

  fit_width() {
    if (this.place.clientWidth === this.plot.width) return;
    this.plot.destroy();
    this.make();
  }

  mark_gaps(u) {
    const {ctx, bbox} = u;
    ctx.fillStyle = '#b00000';
    for (let k = this.ring.first_from(u.scales.x.min); k < this.ring.size; ++k) {
      const place = this.ring.place(k);
      if (!this.ring.breaks[place]) continue;
      const x = u.valToPos(this.ring.time[place], 'x', true);
      ctx.fillRect(x - devicePixelRatio, bbox.top, 2 * devicePixelRatio, 8 * devicePixelRatio);
    }
  }

  // The lowest and highest value shown; none: null.
  extent() {
    let low = Infinity;
    let high = -Infinity;
    for (let s = 1; s < this.data.length; ++s) {
      if (!this.plot.series[s].show) continue;
      for (const value of this.data[s]) {
        if (value == null) continue;
        if (value < low) low = value;
        if (value > high) high = value;
      }
    }
    return high >= low ? [low, high] : null;
  }

  widen(is_to_fit) {
    const extent = this.extent();
    if (!extent) return;
    const present = is_to_fit ? [-1e-9, 1e-9] : this.range;
    const margin = 0.02 * Math.max(extent[1] - extent[0], 1e-6);
    this.range = [
      extent[0] < present[0] ? -round_up(Math.max(1e-6, margin - extent[0])) : present[0],
      extent[1] > present[1] ? round_up(Math.max(1e-6, extent[1] + margin)) : present[1],
    ];
    // A thin line below or above zero is enough if there is nothing.
    const height = this.range[1] - this.range[0];
    this.range[0] = Math.min(this.range[0], -0.05 * height);
    this.range[1] = Math.max(this.range[1], 0.05 * height);
  }

  // Lines without values are left out, or they would take time.
  choose_lines(begin_s) {
    this.chosen.forEach((series, i) => {
      const show = this.ring.latest_s[series] >= begin_s;
      if (this.plot.series[i + 1].show !== show) this.plot.setSeries(i + 1, {show});
    });
  }

  draw(end_s, is_to_fit) {
    fill_chart(this.ring, this.chosen, end_s, kSpan_s, this.data);
    this.choose_lines(end_s - kSpan_s);
    this.widen(is_to_fit);
    const [low, high] = this.range;
    this.plot.batch(() => {
      this.plot.setData(this.data, false);
      this.plot.setScale('x', {min: end_s - kSpan_s, max: end_s});
      this.plot.setScale('y', {min: low, max: high});
    });
  }

  tell(line, zero) {
    this.group.signals.forEach((signal, i) => {
      let found = line && signal.read(line);
      const provenance = found ? found.provenance : '';
      if (found && this.group.from_zero) found = {...found, value: found.value - zero[i]};
      this.words[i].text.textContent = quantity_words(found, this.group.scale, this.group.unit);
      set_mark(this.words[i].mark, provenance);
    });
  }
}

/** All charts of `groups`, whose signals stand in this order in `ring`. */
export class Charts {
  constructor(parent, groups, ring) {
    parent.replaceChildren();
    let first = 0;
    const all = groups.reduce((sum, group) => sum + group.signals.length, 0);
    this.charts = groups.map((group) => {
      const chart = new Chart(parent, group, first, all, ring);
      first += group.signals.length;
      return chart;
    });
    this.is_to_fit = false;
  }

  /** Entitles the chart of the group `key`. */
  name(key, title) {
    for (const chart of this.charts) if (chart.group.key === key) chart.name(title);
  }

  fit() {
    this.is_to_fit = true;
  }

  fit_width() {
    for (const chart of this.charts) chart.fit_width();
  }

  draw(end_s) {
    for (const chart of this.charts) chart.draw(end_s, this.is_to_fit);
    this.is_to_fit = false;
  }

  /** Shows the values of `line`; null: not known. */
  tell(line, zero) {
    for (const chart of this.charts) chart.tell(line, zero);
  }
}
