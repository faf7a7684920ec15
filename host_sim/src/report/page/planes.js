// The dots of the moment in the drawings of paths, whose unit is the millimetre.
import {nearest, times, values} from './data.js';

/** Moves the dots of `section`. */
export function followPlanes(section, recording, moment) {
  const path = recording.path;
  if (!path) return;
  const time = times(path.time);
  const tracks = {};
  for (const dot of section.querySelectorAll('circle.now')) {
    const name = dot.dataset.point;
    if (!path[name]) continue;
    if (!tracks[name]) tracks[name] = path[name].map(values);
  }
  moment.watch((time_s) => {
    const k = nearest(time, time_s);
    for (const dot of section.querySelectorAll('circle.now')) {
      const track = tracks[dot.dataset.point];
      const x = track && track[dot.dataset.x][k];
      const y = track && track[dot.dataset.y][k];
      const has = x != null && y != null;
      dot.setAttribute('visibility', has ? 'visible' : 'hidden');
      if (!has) continue;
      dot.setAttribute('cx', Number(dot.dataset.sign) * x);
      dot.setAttribute('cy', -y);
    }
  });
}
