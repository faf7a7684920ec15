// The jaw in three dimensions as the pose moves it. Three points of the jaw, if the box sends them under
// these names; otherwise a sketch of assumed size.
import {moved, nameCondyles, outline} from '../../hosted/page/jaw_shape.js';

const kNames = ['condyle_left', 'condyle_right', 'incisor'];
const kTurn = 0.15;  // rad for a key
const kMiddle = 0.36;  // of the height: the jaw opens downward
const kTrail = 400;
const kTrail_s = 0.025;
// mm in the frame of the head: x forward, y left, z up. The measured centre is at the incisor.
const kSketch = [[-85, 50, 30], [-85, -50, 30], [0, 0, 0]];

function matrix([x, y, z]) {
  const angle = Math.hypot(x, y, z);
  if (angle < 1e-12) return [[1, 0, 0], [0, 1, 0], [0, 0, 1]];
  const [a, b, c] = [x / angle, y / angle, z / angle];
  const s = Math.sin(angle);
  const v = 1 - Math.cos(angle);
  return [
    [1 - v * (b * b + c * c), v * a * b - s * c, v * a * c + s * b],
    [v * a * b + s * c, 1 - v * (a * a + c * c), v * b * c - s * a],
    [v * a * c - s * b, v * b * c + s * a, 1 - v * (a * a + b * b)],
  ];
}

const times_vector = (m, p) => m.map((row) => row[0] * p[0] + row[1] * p[1] + row[2] * p[2]);
const times_transposed = (m, p) => [0, 1, 2].map((i) => m[0][i] * p[0] + m[1][i] * p[1] + m[2][i] * p[2]);
// The instrument's axes for the head's, as the synthetic facebow has them: y backward, z up.
const to_head = (p) => [-p[1], p[0], p[2]];
const from_head = (p) => [p[1], -p[0], p[2]];
const kSketched = {points: kSketch.map(from_head), to_head};
const is_known = (vector) => vector && vector.every((v) => v !== null);

export class JawView {
  constructor(canvas, words) {
    this.canvas = canvas;
    this.words = words;
    this.view = {turn: -0.6, tilt: 0.25};
    this.trail = [];
    this.places = null;
    this.sketch = kSketched;
    this.forget();
    canvas.addEventListener('keydown', (event) => {
      const turn = {ArrowLeft: [-kTurn, 0], ArrowRight: [kTurn, 0], ArrowUp: [0, kTurn],
        ArrowDown: [0, -kTurn]}[event.key];
      if (!turn) return;
      event.preventDefault();
      this.turn(...turn);
    });
    canvas.addEventListener('pointermove', (event) => {
      if (event.buttons) this.turn(event.movementX * 0.01, event.movementY * 0.01);
    });
  }

  turn(turn, tilt) {
    this.view.turn += turn;
    this.view.tilt = Math.max(-1.5, Math.min(1.5, this.view.tilt + tilt));
    this.draw();
  }

  look(turn, tilt) {
    this.view = {turn, tilt};
    this.draw();
  }

  /** Size and axes of the jaw by landmarks; null: not known. */
  use(places) {
    const words = JSON.stringify(places);
    if (words === this.place_words) return;
    this.place_words = words;
    this.places = places;
    this.sketch = places ? {
      points: kNames.map((name) => places[`${name}_mm`]),
      to_head: (p) => places.head_axes.map((axis) => axis[0] * p[0] + axis[1] * p[1] + axis[2] * p[2]),
    } : kSketched;
    this.forget();
  }

  /** The next pose is where the jaw is at rest. */
  forget() {
    this.reference = null;
    this.points = null;
    this.trail.length = 0;
    this.trail_s = -Infinity;
  }

  add(line, time_s, has_gap) {
    const pose = line.pose;
    this.has_pose = Boolean(pose);
    if (has_gap) this.trail.push(null);
    if (!pose || !is_known(pose.centre_m) || !is_known(pose.rotation_vector_rad)) {
      this.points = null;
      return;
    }
    this.are_named = kNames.every((name) => is_known(pose[`${name}_m`]));
    if (this.are_named) {
      this.points = kNames.map((name) => to_head(pose[`${name}_m`].map((v) => 1e3 * v)));
      if (!this.reference) this.reference = {points: this.points};
    } else {
      const turned = matrix(pose.rotation_vector_rad);
      const centre = pose.centre_m.map((v) => 1e3 * v);
      const {points, to_head: turn_to_head} = this.sketch;
      // The measured centre is at the sketch's incisor, and where it is among the landmarks.
      if (!this.reference) {
        this.reference = {points: points.map(turn_to_head), turned, centre, from: this.places ? centre : [0, 0, 0]};
      }
      const {turned: from_turned, centre: from_centre, from} = this.reference;
      if (!from_turned) return this.forget();  // the points have lost their names
      this.points = points.map((p) => turn_to_head(
          times_vector(turned, times_transposed(from_turned, p.map((v, i) => v - from[i])))
              .map((v, i) => v + centre[i] - from_centre[i] + from[i])));
    }
    if (time_s - this.trail_s < kTrail_s) return;
    this.trail_s = time_s;
    this.trail.push(this.points);
    if (this.trail.length > kTrail) this.trail.shift();
  }

  lost() {
    this.points = null;
    if (this.trail.length > 0 && this.trail[this.trail.length - 1]) this.trail.push(null);
  }

  tell() {
    let words = 'No pose: the jaw is not drawn.';
    if (this.points) {
      words = this.are_named ?
        'Condyles and incisor as the box computes them. The lines between them are a sketch.' :
        this.places ?
        'Condyles and incisor by the landmarks, which hold if the jaw was in the reference position at ' +
        '"Zero here". The lines between them are a sketch.' :
        'The motion is measured. Size and place of the jaw are assumed, and so is that the y axis points ' +
        'backward and the z axis up: give landmarks, or name condyle_left, condyle_right and incisor as points of the jaw.';
    } else if (this.has_pose === false) {
      words = 'The pose is not estimated: set estimate = true in [pose] of the configuration.';
    }
    if (this.words.textContent !== words) this.words.textContent = words;
  }

  draw() {
    const canvas = this.canvas;
    const ratio = devicePixelRatio;
    const width = Math.round(canvas.clientWidth * ratio);
    const height = Math.round(canvas.clientHeight * ratio);
    if (canvas.width !== width || canvas.height !== height) {
      canvas.width = width;
      canvas.height = height;
    }
    const context = canvas.getContext('2d');
    context.clearRect(0, 0, width, height);
    if (!this.reference) return;
    const still = this.reference.points;
    const middle = [0, 1, 2].map((i) => (still[0][i] + still[1][i] + 2 * still[2][i]) / 4);
    const [c, s] = [Math.cos(this.view.turn), Math.sin(this.view.turn)];
    const [ct, st] = [Math.cos(this.view.tilt), Math.sin(this.view.tilt)];
    const scale = Math.min(width, height) / 160;
    const project = (p) => {
      const [x, y, z] = p.map((v, i) => v - middle[i]);
      const depth = c * x - s * y;
      return [width / 2 - (s * x + c * y) * scale, height * kMiddle - (z * ct - depth * st) * scale];
    };
    const trace = (points, colour, thickness) => {
      context.strokeStyle = colour;
      context.lineWidth = thickness * ratio;
      context.beginPath();
      let is_down = false;
      for (const p of points) {
        if (p) {
          const [x, y] = project(p);
          if (is_down) context.lineTo(x, y);
          else context.moveTo(x, y);
        }
        is_down = Boolean(p);
      }
      context.stroke();
    };
    for (let i = 0; i < 3; ++i) trace(this.trail.map((points) => points && points[i]), '#a33c00', 1);
    if (!this.points) return;
    for (const line of outline(...still)) {
      trace(line.map((p) => moved(p, still, this.points)), '#101820', 2.5);
    }
    context.fillStyle = '#a33c00';
    for (const p of this.points) {
      const [x, y] = project(p);
      context.beginPath();
      context.arc(x, y, 4 * ratio, 0, 2 * Math.PI);
      context.fill();
    }
    context.fillStyle = '#101820';
    nameCondyles(context, project(this.points[0]), project(this.points[1]), ratio);
  }
}
