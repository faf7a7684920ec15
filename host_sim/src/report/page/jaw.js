// The jaw in three dimensions: condyles and lower incisor with their paths, at the moment.
import {moved, nameCondyles, outline} from '../../../../firmware/hosted/page/jaw_shape.js';
import {nearest, times, values} from './data.js';

const kTurn = 0.15;  // rad for a key
const kInk = '#203040';

function point(packed) {
  const [x, y, z] = packed.map(values);
  return x.map((v, k) => [v, y[k], z[k]]);
}

/** Draws the jaw of `recording` into the canvas of `section`. */
export function drawJaw(section, recording, moment) {
  const canvas = section.querySelector('canvas.jaw');
  if (!canvas || !recording.path || !recording.path.condyle_left) return;
  const path = recording.path;
  const time = times(path.time);
  const names = ['condyle_left', 'condyle_right', 'incisor'];
  const still = names.map((name) => path.at[name]);
  const tracks = names.map((name, i) => point(path[name]).map(
      (d) => (d[0] == null ? null : d.map((v, j) => v + still[i][j]))));
  const lines = outline(...still);
  const view = {turn: -0.6, tilt: 0.25};
  // A ball that holds the sketch at rest and widest open: every view of it fits.
  const far = (points) => (points.some((p) => !p) ? 0 : Math.hypot(...points[2].map((v, i) => v - still[2][i])));
  let open = still;
  for (let k = 0; k < time.length; ++k) {
    const points = tracks.map((track) => track[k]);
    if (far(points) > far(open)) open = points;
  }
  const drawn = [...lines.flat(), ...lines.flat().map((p) => moved(p, still, open))];
  const middle = [0, 1, 2].map((i) => {
    const along = drawn.map((p) => p[i]);
    return (Math.min(...along) + Math.max(...along)) / 2;
  });
  const radius = Math.max(...drawn.map((p) => Math.hypot(...p.map((v, i) => v - middle[i]))));
  let at = 0;

  const project = (p) => {
    const c = Math.cos(view.turn);
    const s = Math.sin(view.turn);
    const [x, y, z] = p.map((v, i) => v - middle[i]);
    const across = -(s * x + c * y);
    const depth = c * x - s * y;
    const up = z * Math.cos(view.tilt) - depth * Math.sin(view.tilt);
    const scale = 0.46 * Math.min(canvas.width, canvas.height) / radius;
    return [canvas.width / 2 + across * scale, canvas.height / 2 - up * scale];
  };
  const trace = (context, points, colour, width) => {
    context.strokeStyle = colour;
    context.lineWidth = width * devicePixelRatio;
    context.beginPath();
    let down = false;
    for (const p of points) {
      if (!p) {
        down = false;
        continue;
      }
      const [x, y] = project(p);
      if (down) context.lineTo(x, y);
      else context.moveTo(x, y);
      down = true;
    }
    context.stroke();
  };
  const draw = () => {
    const width = canvas.clientWidth || 480;
    canvas.width = width * devicePixelRatio;
    canvas.height = (canvas.clientHeight || 380) * devicePixelRatio;
    const context = canvas.getContext('2d');
    const stride = Math.max(1, Math.floor(time.length / 4000));
    const thin = (track) => track.filter((p, k) => k % stride === 0);
    tracks.forEach((track) => trace(context, thin(track), '#b9c4cf', 1));
    const now = tracks.map((track) => track[at]);
    if (now.some((p) => !p)) return;
    for (const line of lines) {
      trace(context, line.map((p) => moved(p, still, now)), kInk, 2.5);
    }
    context.fillStyle = '#c2571a';
    for (const p of now) {
      const [x, y] = project(p);
      context.beginPath();
      context.arc(x, y, 4 * devicePixelRatio, 0, 2 * Math.PI);
      context.fill();
    }
    context.fillStyle = kInk;
    nameCondyles(context, project(now[0]), project(now[1]), devicePixelRatio);
  };
  let waits = false;
  const redraw = () => {
    if (waits) return;
    waits = true;
    requestAnimationFrame(() => {
      waits = false;
      draw();
    });
  };
  moment.watch((time_s) => {
    at = nearest(time, time_s);
    redraw();
  });
  canvas.addEventListener('keydown', (event) => {
    const turns = {ArrowLeft: [-kTurn, 0], ArrowRight: [kTurn, 0], ArrowUp: [0, kTurn],
      ArrowDown: [0, -kTurn]};
    const turn = turns[event.key];
    if (!turn) return;
    event.preventDefault();
    view.turn += turn[0];
    view.tilt += turn[1];
    redraw();
  });
  canvas.addEventListener('pointermove', (event) => {
    if (!event.buttons) return;
    view.turn += event.movementX * 0.01;
    view.tilt += event.movementY * 0.01;
    redraw();
  });
  addEventListener('resize', redraw);
  draw();
}
