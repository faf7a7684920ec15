// The jaw in three dimensions: condyles and lower incisor with their paths, at the moment.
import {nearest, times, values} from './data.js';

const kTurn = 0.15;  // rad for a key
const kInk = '#203040';

function point(packed) {
  const [x, y, z] = packed.map(values);
  return x.map((v, k) => [v, y[k], z[k]]);
}

// Lower jaw between two condyles and the incisor: rami, body and chin, as points of their plane and
// a height above it, in shares of the distances between the three.
function outline(left, right, incisor) {
  const middle = left.map((v, i) => (v + right[i]) / 2);
  const down = [0, 0, -1];
  const distance = Math.hypot(...incisor.map((v, i) => v - middle[i]));
  const along = (condyle, share, depth, spread) => condyle.map((v, i) => {
    const side = middle[i] + (v - middle[i]) * spread;
    return side + (incisor[i] - middle[i]) * share + down[i] * depth * distance;
  });
  const half = (condyle) => [
    condyle, along(condyle, 0.02, 0.25, 1), along(condyle, 0.12, 0.5, 0.95),
    along(condyle, 0.5, 0.42, 0.75), along(condyle, 0.9, 0.28, 0.3), along(condyle, 1, 0.24, 0),
  ];
  return [half(left), half(right), [incisor, along(left, 1, 0.24, 0)]];
}

// The rigid displacement that moves three points to three others, applied to `p`: by the frames of
// the two triangles.
function frame(a, b, c) {
  const minus = (u, v) => u.map((x, i) => x - v[i]);
  const cross = (u, v) => [
    u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]];
  const unit = (u) => u.map((x) => x / Math.hypot(...u));
  const x = unit(minus(b, a));
  const z = unit(cross(x, minus(c, a)));
  return [x, cross(z, x), z];
}

function moved(p, from, to) {
  const f = frame(...from);
  const t = frame(...to);
  const d = p.map((v, i) => v - from[0][i]);
  const local = f.map((axis) => axis[0] * d[0] + axis[1] * d[1] + axis[2] * d[2]);
  return to[0].map((v, i) => v + t[0][i] * local[0] + t[1][i] * local[1] + t[2][i] * local[2]);
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
  let at = 0;

  const project = (p) => {
    const c = Math.cos(view.turn);
    const s = Math.sin(view.turn);
    const x = p[0] - still[2][0] / 2;
    const across = -(s * x + c * p[1]);
    const depth = c * x - s * p[1];
    const up = p[2] * Math.cos(view.tilt) - depth * Math.sin(view.tilt);
    const scale = Math.min(canvas.width, canvas.height) / 190;
    return [canvas.width / 2 + across * scale, canvas.height * 0.36 - up * scale];
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
    canvas.height = 320 * devicePixelRatio;
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
