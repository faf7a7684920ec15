// Charts over time, with 95 % bands; one cursor and one zoom for all of a recording.
import uPlot from 'uplot';

import {times, values} from './data.js';

// Distinguishable in greyscale too: by darkness and by dashes.
const kCurves = [
  {stroke: '#0b4f8a', fill: 'rgba(11,79,138,0.18)', dash: []},
  {stroke: '#c2571a', fill: 'rgba(194,87,26,0.18)', dash: [9, 3]},
  {stroke: '#4f8f3a', fill: 'rgba(79,143,58,0.18)', dash: [3, 3]},
];
const kTask = {
  opening: '#dbe7f3', protrusion: '#f6e3d3', left: '#ddeed8', right: '#e9ddf0', chewing: '#e4e4e4',
  border: '#f3dbe3', rest: '#f4efcf',
};

function digits(value) {
  return value == null ? '' : Number(value.toPrecision(4)).toString();
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

function chartData(chart, time) {
  const data = [time];
  const series = [{label: 'time (s)', value: (u, v) => (v == null ? '' : v.toFixed(3))}];
  const bands = [];
  chart.curves.forEach((curve, i) => {
    const style = kCurves[i % kCurves.length];
    const low = values(curve.low);
    const high = values(curve.high);
    const half = values(curve.half);
    const middle = low.map((v, k) => (v == null || high[k] == null ? null : (v + high[k]) / 2));
    const at = data.length;
    data.push(middle);
    data.push(high.map((v, k) => (v == null || half[k] == null ? null : v + half[k])));
    data.push(low.map((v, k) => (v == null || half[k] == null ? null : v - half[k])));
    const assumed = chart.provenance === 'assumed';
    series.push({
      label: curve.name,
      stroke: style.stroke,
      width: 1,
      dash: assumed ? [1, 4] : style.dash,
      points: {show: false},
      value: (u, v, s, k) => {
        if (v == null || k == null) return 'none';
        const band = half[k] == null ? '' : ` \u00b1 ${digits(half[k] + (high[k] - low[k]) / 2)}`;
        return `${digits(v)}${band} ${chart.unit}`;
      },
    });
    for (let j = 0; j < 2; ++j) series.push({label: '', width: 0, points: {show: false}});
    bands.push({series: [at + 1, at + 2], fill: style.fill});
  });
  return {data, series, bands};
}

/** Draws the charts of `recording` into `section`. */
export function drawCharts(section, recording, moment) {
  const time = times(recording.series.time);
  const span = [time[0], time[time.length - 1]];
  const charts = [];
  for (const chart of recording.series.charts) {
    const place = section.querySelector(`[data-chart="${chart.key}"]`);
    if (!place) continue;
    const {data, series, bands} = chartData(chart, time);
    const u = new uPlot({
      width: place.clientWidth || 900,
      height: 190,
      series,
      bands,
      scales: {x: {time: false}},
      axes: [{size: 34}, {label: `${chart.title} (${chart.unit})`, labelSize: 20, size: 62}],
      cursor: {sync: {key: recording.name}, drag: {x: true, y: false}},
      legend: {live: true},
      hooks: {
        drawClear: [(self) => shadeTasks(self, recording.tasks)],
        draw: [(self) => markEvents(self, recording.series.events)],
        setCursor: [(self) => {
          if (self.cursor.idx != null) moment.show(time[self.cursor.idx]);
        }],
        setScale: [(self, key) => {
          if (key === 'x') moment.zoom(self.scales.x.min, self.scales.x.max);
        }],
      },
    }, data, place);
    // The ends of a band are not curves of their own.
    place.querySelectorAll('.u-legend .u-series').forEach((row, i) => {
      if (i > 0 && (i - 1) % 3 !== 0) row.classList.add('band');
    });
    charts.push(u);
  }
  moment.watchSpan((begin_s, end_s) => {
    for (const u of charts) {
      if (u.scales.x.min !== begin_s || u.scales.x.max !== end_s) {
        u.setScale('x', {min: begin_s, max: end_s});
      }
    }
  });
  const fit = () => {
    for (const u of charts) {
      u.setSize({width: u.root.parentElement.clientWidth, height: 190});
    }
  };
  addEventListener('resize', fit);
  return {charts, time, span};
}
