// Charts over time, with 95 % bands; one cursor and one zoom for all of a recording.
import uPlot from 'uplot';

import {lineSample} from '../../../../firmware/hosted/page/line_sample.js';
import {fixed} from '../../../../firmware/hosted/page/numbers.js';
import {nearest, times, values} from './data.js';

const kHeight = 190;  // px
const kTaskFont = 11;  // px
const kPrintedWidth = 1000;  // px; the style fits it to the paper

// Distinguishable in greyscale too: by darkness and by dashes.
const kCurves = [
  {stroke: '#0b4f8a', fill: 'rgba(11,79,138,0.18)', dash: []},
  {stroke: '#c2571a', fill: 'rgba(194,87,26,0.18)', dash: [9, 3]},
  {stroke: '#4f8f3a', fill: 'rgba(79,143,58,0.18)', dash: [3, 3]},
];
const kAssumed = [1, 4];
const kSeries = 4;  // of a curve: what is not assumed, the ends of its band, what is assumed
const kTask = {
  opening: '#dbe7f3', protrusion: '#f6e3d3', left: '#ddeed8', right: '#e9ddf0', chewing: '#e4e4e4',
  border: '#f3dbe3', rest: '#f4efcf',
};

// `value`, with as many digits as its interval supports.
function digits(value, half) {
  if (!(half > 0)) return Number(value.toPrecision(4)).toString();
  const decimals = Math.max(0, 1 - Math.floor(Math.log10(half)));
  return `${fixed(value, decimals)} \u00b1 ${half.toFixed(decimals)}`;
}

function shadeTasks(u, tasks) {
  const {ctx, bbox} = u;
  ctx.save();
  ctx.beginPath();
  ctx.rect(bbox.left, bbox.top, bbox.width, bbox.height);
  ctx.clip();
  for (const task of tasks) {
    const left = u.valToPos(task.begin_s, 'x', true);
    const right = u.valToPos(task.end_s, 'x', true);
    ctx.fillStyle = kTask[task.task] || '#eeeeee';
    ctx.fillRect(left, bbox.top, right - left, bbox.height);
  }
  ctx.restore();
}

// In words too: shades of grey do not tell tasks apart.
function nameTasks(u, tasks) {
  const {ctx, bbox} = u;
  ctx.save();
  ctx.fillStyle = '#44525f';
  ctx.font = `${kTaskFont * devicePixelRatio}px system-ui, "Liberation Sans", Arial, sans-serif`;
  ctx.textBaseline = 'top';
  ctx.textAlign = 'left';
  for (const task of tasks) {
    const left = Math.max(u.valToPos(task.begin_s, 'x', true), bbox.left) + 3 * devicePixelRatio;
    const right = Math.min(u.valToPos(task.end_s, 'x', true), bbox.left + bbox.width);
    if (ctx.measureText(task.task).width > right - left) continue;
    ctx.fillText(task.task, left, bbox.top + 3 * devicePixelRatio);
  }
  ctx.restore();
}

function markEvents(u, events) {
  const {ctx, bbox} = u;
  ctx.save();
  ctx.fillStyle = '#a00000';
  for (const time_s of events) {
    const x = u.valToPos(time_s, 'x', true);
    if (x < bbox.left || x > bbox.left + bbox.width) continue;
    ctx.fillRect(x - 1, bbox.top, 2, 7 * devicePixelRatio);
  }
  ctx.restore();
}

// Which values are assumed.
function assumedOf(curve, length) {
  const assumed = new Array(length).fill(false);
  for (const [first, last] of curve.assumed || []) assumed.fill(true, first, last + 1);
  return assumed;
}

// One resolution of a chart. `bands`: the curves of the whole, from which a closer look takes its
// intervals.
function levelOf(time, curves, bands) {
  return {
    time,
    curves: curves.map((curve, i) => {
      const low = values(curve.low);
      const high = curve.high ? values(curve.high) : low;
      const half = curve.half ? values(curve.half) :
          time.map((t) => bands.curves[i].half[nearest(bands.time, t)]);
      return {low, high, half, assumed: assumedOf(curve, time.length)};
    }),
  };
}

function dataOf(level) {
  const data = [level.time];
  for (const {low, high, half, assumed} of level.curves) {
    const middle = low.map((v, k) => (v == null || high[k] == null ? null : (v + high[k]) / 2));
    data.push(middle.map((v, k) => (assumed[k] ? null : v)));
    data.push(high.map((v, k) => (v == null || half[k] == null ? null : v + half[k])));
    data.push(low.map((v, k) => (v == null || half[k] == null ? null : v - half[k])));
    // Up to the value after them.
    data.push(middle.map((v, k) => (assumed[k] || (k > 0 && assumed[k - 1]) ? v : null)));
  }
  return data;
}

// The curves of a chart at the resolutions that the report has.
class ChartLevels {
  constructor(chart, time, fine) {
    this.chart = chart;
    this.whole = levelOf(time, chart.curves, null);
    this.packed = fine && fine[chart.key] ? fine : null;
    this.closer = null;
    this.now = this.whole;
  }

  // Chooses the resolution for a span; true if it is another one.
  choose(begin_s, end_s) {
    const {time} = this.whole;
    const isClose = this.packed && end_s - begin_s < (time[time.length - 1] - time[0]) / 4;
    if (isClose && !this.closer) {
      this.closer = levelOf(times(this.packed.time), this.packed[this.chart.key], this.whole);
    }
    const before = this.now;
    this.now = isClose ? this.closer : this.whole;
    return this.now !== before;
  }

  text(curve, k) {
    if (k == null) return '';  // no moment is chosen
    const {low, high, half, assumed} = this.now.curves[curve];
    if (low[k] == null || high[k] == null) return 'none';
    const halfOfAll = half[k] == null ? 0 : half[k] + (high[k] - low[k]) / 2;
    return `${digits((low[k] + high[k]) / 2, halfOfAll)} ${this.chart.unit}${assumed[k] ? ', assumed' : ''}`;
  }
}

function seriesOf(levels) {
  const {chart} = levels;
  const series = [{label: 'time (s)', value: (u, v) => (v == null ? '' : v.toFixed(3))}];
  const bands = [];
  chart.curves.forEach((curve, i) => {
    const style = kCurves[i % kCurves.length];
    const at = series.length;
    series.push({
      label: curve.name,
      stroke: style.stroke,
      width: 1,
      dash: style.dash,
      points: {show: false},
      value: (u, v, s, k) => levels.text(i, k),
    });
    for (let j = 0; j < 2; ++j) series.push({label: '', width: 0, points: {show: false}});
    series.push({label: '', stroke: style.stroke, width: 1, dash: kAssumed, points: {show: false}});
    bands.push({series: [at + 1, at + 2], fill: style.fill});
  });
  return {series, bands};
}

function drawChart(place, levels, recording, moment) {
  const {chart} = levels;
  const {series, bands} = seriesOf(levels);
  let isFollowing = false;
  const u = new uPlot({
    width: place.clientWidth || 900,
    height: kHeight,
    series,
    bands,
    // Where nothing is known the axis stays, so that all charts are equally wide.
    scales: {
      x: {time: false},
      y: {range: (self, low, high) => (low == null ? [0, 1] : uPlot.rangeNum(low, high, 0.1, true))},
    },
    axes: [{size: 34}, {label: `${chart.title} (${chart.unit})`, labelSize: 20, size: 62}],
    cursor: {drag: {x: true, y: false}, y: false},
    legend: {live: true},
    hooks: {
      drawClear: [(self) => shadeTasks(self, recording.tasks)],
      draw: [(self) => {
        nameTasks(self, recording.tasks);
        markEvents(self, recording.series.events);
      }],
      setCursor: [(self) => {
        if (isFollowing || self.cursor.idx == null) return;
        moment.show(self.data[0][self.cursor.idx]);
      }],
      setScale: [(self, key) => {
        if (key === 'x') moment.zoom(self.scales.x.min, self.scales.x.max);
      }],
    },
  }, dataOf(levels.now), place);
  const follow = () => {
    if (moment.time_s == null) return;
    isFollowing = true;
    u.setCursor({left: u.valToPos(moment.time_s, 'x'), top: kHeight / 2}, true, false);
    isFollowing = false;
  };
  moment.watch(follow);
  u.over.addEventListener('mouseleave', follow);
  // Later: a chart that tells its span is at work.
  moment.watchSpan((begin_s, end_s) => queueMicrotask(() => {
    const isOther = levels.choose(begin_s, end_s);
    if (isOther) u.setData(dataOf(levels.now), false);
    if (isOther || u.scales.x.min !== begin_s || u.scales.x.max !== end_s) {
      u.setScale('x', {min: begin_s, max: end_s});
    }
  }));
  // Only the first series of a curve is named.
  place.querySelectorAll('.u-legend .u-series').forEach((row, i) => {
    if (i === 0) return;
    const curve = (i - 1) / kSeries;
    if (!Number.isInteger(curve)) {
      row.classList.add('unnamed');
      return;
    }
    const {stroke, dash} = kCurves[curve % kCurves.length];
    row.querySelector('.u-marker').replaceWith(lineSample(stroke, dash));
  });
  return u;
}

/** Draws the charts of `recording` into `section`. */
export function drawCharts(section, recording, moment) {
  const time = times(recording.series.time);
  const charts = [];
  for (const chart of recording.series.charts) {
    const place = section.querySelector(`[data-chart="${chart.key}"]`);
    if (!place) continue;
    const levels = new ChartLevels(chart, time, recording.series.fine);
    charts.push(drawChart(place, levels, recording, moment));
  }
  const fit = (width) => {
    for (const u of charts) {
      u.setSize({width: width || u.root.parentElement.clientWidth, height: kHeight});
    }
  };
  addEventListener('resize', () => fit(0));
  addEventListener('beforeprint', () => fit(kPrintedWidth));
  addEventListener('afterprint', () => fit(0));
}
