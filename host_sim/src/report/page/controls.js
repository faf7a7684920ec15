// The moment and the span of a recording, by buttons and keys.
import {times} from './data.js';

const kShare = 0.02;  // of the span, for a key

/** Lets the controls of `section` move `moment` between the ends of `time`. */
export function addControls(section, recording, moment) {
  const controls = section.querySelector('.controls');
  if (!controls || !recording.series) return;
  const time = times(recording.series.time);
  const whole = [time[0], time[time.length - 1]];
  const span = () => moment.span || whole;
  const within = (time_s) => Math.min(Math.max(time_s, whole[0]), whole[1]);
  const button = (name) => controls.querySelector(`button[data-do="${name}"]`);
  const slider = controls.querySelector('input');
  const [now, shown] = controls.querySelectorAll('output');
  slider.min = String(whole[0]);
  slider.max = String(whole[1]);
  slider.value = slider.min;
  slider.addEventListener('input', () => moment.show(Number(slider.value)));
  moment.watch((time_s) => {
    slider.value = String(time_s);
    now.textContent = `${time_s.toFixed(2)} s`;
  });
  const tell = (begin_s, end_s) => {
    shown.textContent = `shown: ${begin_s.toFixed(2)} to ${end_s.toFixed(2)} s`;
  };
  moment.watchSpan(tell);
  tell(...span());

  const zoom = (factor) => {
    const [begin, end] = span();
    const at = moment.time_s != null && moment.time_s >= begin && moment.time_s <= end ?
      moment.time_s : (begin + end) / 2;
    const length = (end - begin) * factor;
    if (length >= whole[1] - whole[0]) {
      moment.zoom(...whole);
      return;
    }
    const first = Math.min(Math.max(at - length / 2, whole[0]), whole[1] - length);
    moment.zoom(first, first + length);
  };
  const step = (shares) => {
    const [begin, end] = span();
    const from = moment.time_s == null ? begin : moment.time_s;
    const time_s = within(from + shares * (end - begin));
    moment.show(time_s);
    if (time_s >= begin && time_s <= end) return;
    const shift = shares * (end - begin);
    const first = Math.min(Math.max(begin + shift, whole[0]), whole[1] - (end - begin));
    moment.zoom(first, first + end - begin);
  };
  const actions = {
    'zoom-in': () => zoom(0.5),
    'zoom-out': () => zoom(2),
    'zoom-all': () => moment.zoom(...whole),
  };
  for (const name of Object.keys(actions)) button(name).addEventListener('click', actions[name]);
  const keys = {
    ArrowLeft: () => step(-kShare),
    ArrowRight: () => step(kShare),
    Home: () => moment.show(whole[0]),
    End: () => moment.show(whole[1]),
    '+': actions['zoom-in'],
    '-': actions['zoom-out'],
    0: actions['zoom-all'],
  };
  for (const place of section.querySelectorAll('.charts')) {
    place.addEventListener('keydown', (event) => {
      const action = keys[event.key];
      if (!action || event.ctrlKey || event.altKey || event.metaKey) return;
      event.preventDefault();
      action();
    });
  }
  play(button('play'), whole, moment);
}

// The button that lets time run.
function play(button, whole, moment) {
  let since = null;
  let from = 0;
  const stop = () => {
    since = null;
    button.textContent = 'Play';
  };
  const step = (now_ms) => {
    if (since === null) return;
    const time_s = from + (now_ms - since) / 1000;
    moment.show(Math.min(time_s, whole[1]));
    if (time_s >= whole[1]) stop();
    else requestAnimationFrame(step);
  };
  button.addEventListener('click', () => {
    if (since !== null) {
      stop();
      return;
    }
    from = moment.time_s == null || moment.time_s >= whole[1] - 0.1 ? whole[0] : moment.time_s;
    button.textContent = 'Pause';
    since = performance.now();
    requestAnimationFrame(step);
  });
}
