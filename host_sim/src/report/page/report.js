import {drawCharts} from './charts.js';
import {addControls} from './controls.js';
import {reportData} from './data.js';
import {drawJaw} from './jaw.js';
import {Moment} from './moment.js';
import {followPlanes} from './planes.js';
import {addTableButtons} from './tables.js';

const report = reportData();
report.recordings.forEach((recording, i) => {
  const section = document.getElementById(`recording-${i + 1}`);
  const moment = new Moment();
  if (recording.series) drawCharts(section, recording, moment);
  addControls(section, recording, moment);
  followPlanes(section, recording, moment);
  drawJaw(section, recording, moment);
});
addTableButtons();

// Everything is printed, what is folded too.
let folded = [];
addEventListener('beforeprint', () => {
  folded = Array.from(document.querySelectorAll('details:not([open])'));
  for (const details of folded) details.open = true;
});
addEventListener('afterprint', () => {
  for (const details of folded) details.open = false;
});
document.body.classList.add('ready');
