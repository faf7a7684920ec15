import {drawCharts} from './charts.js';
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
  followPlanes(section, recording, moment);
  drawJaw(section, recording, moment);
});
addTableButtons();
document.body.classList.add('ready');
