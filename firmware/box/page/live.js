import {Charts} from './charts.js';
import {Connection} from './connection.js';
import {Cycles} from './cycles.js';
import {JawView} from './jaw_view.js';
import {Ring} from './ring.js';
import {Sessions} from './sessions.js';
import {
  axes_of, groups_of, identified_of, is_measured, mark_of, quantity_words,
} from './signals.js';
import {Stillness} from './stillness.js';

const kCapacity = 32768;      // samples: 10 s at 3 kHz
const kTell_ms = 250;         // between changes of numbers: they are to be read
const kCalm_ms = 1000;        // between pictures where motion is unwelcome
const kBack_ms = 30000;       // during which a regained connection is news
const kSilence_ms = 1000;     // without an estimate
const kSteps = 3;             // a longer step than so many usual ones is a gap
const $ = (id) => document.getElementById(id);
const calm = matchMedia('(prefers-reduced-motion: reduce)');

function set_text(id, words) {
  if ($(id).textContent !== words) $(id).textContent = words;
}

class Live {
  constructor() {
    this.sessions = new Sessions();
    this.jaw = new JawView($('jaw'), $('jaw-words'));
    this.cycles = new Cycles($('cycle'), $('cycle-words'));
    this.layout = '';
    this.line = null;
    this.status = null;
    this.was_answered = false;
    this.arrived_ms = -Infinity;
    this.has_gap = true;
    this.is_held = false;
    this.drawn_ms = -Infinity;
    this.told_ms = -Infinity;
    this.frames = 0;  // drawn, for tests
    this.connection = new Connection({
      line: (line) => this.add(line),
      gap: () => {
        this.has_gap = true;
      },
      status: (status, date) => this.take_status(status, date),
      change: () => this.tell_connection(),
    });
    this.listen();
    requestAnimationFrame((now_ms) => this.frame(now_ms));
  }

  // Starts anew for estimates of another kind.
  arrange(line) {
    this.axes = axes_of(line);
    this.groups = groups_of(line);
    this.signals = this.groups.flatMap((group) => group.signals.map((signal) => ({...signal, scale: group.scale})));
    this.ring = new Ring(kCapacity, 2 * this.signals.length);  // what is assumed comes second
    this.still = new Stillness(this.axes.length);
    this.zero = null;
    this.step_s = null;
    this.jaw.forget();
    this.cycles.forget();
    this.charts = new Charts($('charts'), this.groups, this.ring);
  }

  add(line) {
    if (line.node && line.node.away) {
      this.has_gap = true;
      this.jaw.lost();
      return;
    }
    const layout = `${Boolean(line.x)} ${Boolean(line.pose)}`;
    if (layout !== this.layout) this.arrange(line);
    this.layout = layout;
    if (line.time_s === null) {
      this.has_gap = true;
      return;
    }
    const time_s = line.time_s;
    const newest_s = this.ring.newest_s();
    if (time_s === newest_s || line.events.includes('time_reversed')) return;  // has no place of its own
    if (newest_s !== null && time_s < newest_s) {  // the clock was set back
      this.ring.clear();
      this.step_s = null;
      this.ahead_s = null;
      this.has_gap = true;
    } else if (newest_s !== null) {
      const step_s = time_s - newest_s;
      if (this.step_s !== null && step_s > kSteps * this.step_s) this.has_gap = true;
      else this.step_s = this.step_s === null ? step_s : 0.95 * this.step_s + 0.05 * step_s;
    }
    const is_there = is_measured(line);
    const has_gap = this.has_gap || !is_there || line.events.includes('time_gap') ||
      (this.line !== null && this.line.run !== line.run);
    this.has_gap = !is_there;
    const place = this.ring.add(time_s, has_gap);
    if (!this.zero && is_there) this.zero = this.axes.map((axis) => line[axis].position_m);
    this.signals.forEach((signal, s) => {
      const found = is_there ? signal.read(line) : null;
      const zero = s < this.axes.length && this.zero ? this.zero[s] : 0;
      const value = found ? (found.value - zero) * signal.scale : NaN;
      const is_assumed = found !== null && found.provenance === 'assumed';
      this.ring.put(s, place, is_assumed ? NaN : value);
      this.ring.put(this.signals.length + s, place, is_assumed ? value : NaN);
    });
    this.still.add(line, time_s, has_gap);
    this.jaw.add(line, time_s, has_gap);
    if (this.zero) this.cycles.add(line, time_s, has_gap, this.zero);
    this.line = line;
    const now_ms = performance.now();
    this.arrived_ms = now_ms;
    // How far the device's clock is ahead of the page's: by the promptest estimates.
    const ahead_s = time_s - now_ms / 1000;
    if (this.ahead_s == null || Math.abs(ahead_s - this.ahead_s) > 2) this.ahead_s = ahead_s;
    else this.ahead_s = Math.max(ahead_s, this.ahead_s - 2e-5);
  }

  set_zero() {
    if (!this.line || !this.zero) return;
    this.axes.forEach((axis, i) => {
      const position_m = this.line[axis].position_m;
      if (position_m === null) return;
      const change = (position_m - this.zero[i]) * 1e3;
      for (const values of [this.ring.values[i], this.ring.values[this.signals.length + i]]) {
        for (let k = 0; k < values.length; ++k) values[k] -= change;
      }
      this.zero[i] = position_m;
    });
    this.jaw.forget();
    this.cycles.forget();
    this.charts.fit();
  }

  frame(now_ms) {
    requestAnimationFrame((next_ms) => this.frame(next_ms));
    const wait_ms = calm.matches ? kCalm_ms : 0;
    if (now_ms - this.told_ms >= kTell_ms) {
      this.told_ms = now_ms;
      this.tell();
    }
    if (!this.charts || this.is_held || now_ms - this.drawn_ms < wait_ms) return;
    this.drawn_ms = now_ms;
    const newest_s = this.ring.newest_s();
    if (newest_s === null) return;
    this.charts.draw(Math.max(newest_s, this.ahead_s + now_ms / 1000));
    this.jaw.draw();
    ++this.frames;
  }

  tell() {
    this.tell_connection();
    if (!this.charts) return;
    const is_fresh = performance.now() - this.arrived_ms < kSilence_ms;
    if (!is_fresh) this.jaw.lost();
    const line = is_fresh ? this.line : null;
    if (this.zero) this.charts.tell(line, this.zero);
    const {still, noise} = is_fresh ? this.still.words() : {still: 'not known: no estimates', noise: 'not known: no estimates'};
    set_text('still', still);
    set_text('noise', noise);
    this.jaw.tell();
    if (line) this.cycles.watch(line, this.ring, this.axes);
    this.cycles.tell();
    this.tell_identified(line);
  }

  tell_identified(line) {
    const found = line ? identified_of(line) : [];
    const words = JSON.stringify(found);
    if (words === this.identified) return;
    this.identified = words;
    $('identified').replaceChildren(...found.flatMap((value) => {
      const name = document.createElement('dt');
      name.textContent = value.name;
      const text = document.createElement('dd');
      const known = value.value === null ? null : value;
      text.append(mark_of(value.provenance), ` ${quantity_words(known, 1, value.unit)}` +
        (value.limit && value.limit !== 'none' ? `; limit: ${value.limit.replaceAll('_', ' ')}` : ''));
      return [name, text];
    }));
  }

  take_status(status, date) {
    this.was_answered = status !== null;
    this.status = status || this.status;
    this.sessions.tell(status, date);
    if (!status) {
      set_text('rate', 'not known: the box does not answer');
      return;
    }
    const {device, estimator} = status;
    if (this.charts && estimator.assumed_mass_kg) {
      this.charts.name('force', `Force: the assumed ${estimator.assumed_mass_kg} kg times the acceleration`);
    }
    this.jaw.use(status.jaw || null);
    const nominal = device.nominal_rate_Hz ? ` of ${device.nominal_rate_Hz} nominal` : '';
    set_text('device', `${device.name} (${device.source})`);
    set_text('rate', `${device.rate_Hz.toFixed(1)} reports a second${nominal}`);
    const parts = [`${device.reports_lost} of ${device.reports_received + device.reports_lost} reports lost`];
    if (device.reports_bad > 0) parts.push(`${device.reports_bad} unusable`);
    if (device.gaps_of_unknown_length > 0) parts.push(`${device.gaps_of_unknown_length} gaps of unknown length`);
    if (device.disconnections > 0) parts.push(`${device.disconnections} disconnections`);
    if (this.connection.missed > 0) parts.push(`this page missed ${this.connection.missed} estimates`);
    if (this.connection.cuts > 0) {
      const times = this.connection.cuts === 1 ? 'once' : `${this.connection.cuts} times`;
      parts.push(`connection lost ${times}, ${this.connection.away_s.toFixed(0)} s in all`);
    }
    set_text('losses', parts.join(', '));
  }

  // Words and kind of the state of the connection.
  state() {
    const {connection, status} = this;
    const now_ms = performance.now();
    const seconds = (ms) => `${Math.round((now_ms - ms) / 1000)} s`;
    if (connection.needs_token) return ['The box asks for its token', 'bad'];
    if (!connection.is_open) {
      const is_first = connection.last === null && !this.status;
      return [`${is_first ? 'Not connected' : 'CONNECTION LOST'} for ${seconds(connection.lost_ms)}: ` +
        `${connection.problem || 'connecting'}; trying again`, 'bad'];
    }
    const device = status && status.device;
    if (device && this.was_answered) {
      if (device.ended) return ['The recording has been played to its end', 'bad'];
      if (!device.found) return [`FACEBOW NOT FOUND: ${device.problem}`, 'bad'];
      if (!device.connected) return ['FACEBOW DISCONNECTED; the box looks for it', 'bad'];
    }
    if (now_ms - this.arrived_ms > kSilence_ms) {
      return [this.arrived_ms > 0 ? `NO ESTIMATES for ${seconds(this.arrived_ms)}` : 'No estimates yet', 'bad'];
    }
    const back = now_ms - connection.back_ms < kBack_ms ?
      `; the connection was lost for ${connection.was_away_s.toFixed(0)} s` : '';
    return [`Connected${back}`, 'good'];
  }

  tell_connection() {
    const [words, kind] = this.state();
    set_text('connection', words);
    $('connection').className = `state ${kind}`;
    set_text('token-problem', this.connection.is_refused ? 'The box refuses this token.' : '');
    const form = $('token-form');
    if (form.hidden === this.connection.needs_token) {
      form.hidden = !this.connection.needs_token;
      if (!form.hidden) $('token').focus();
    }
  }

  hold() {
    this.is_held = !this.is_held;
    $('hold').setAttribute('aria-pressed', String(this.is_held));
  }

  listen() {
    const actions = {
      s: () => this.sessions.start(), e: () => this.sessions.stop(), m: () => this.sessions.mark(),
      z: () => this.set_zero(), f: () => this.charts && this.charts.fit(), h: () => this.hold(),
    };
    $('zero').addEventListener('click', actions.z);
    $('fit').addEventListener('click', actions.f);
    $('hold').addEventListener('click', actions.h);
    $('front').addEventListener('click', () => this.jaw.look(0, 0.1));
    $('side').addEventListener('click', () => this.jaw.look(-Math.PI / 2, 0));
    $('forget').addEventListener('click', () => this.cycles.forget());
    $('token-form').addEventListener('submit', (event) => {
      event.preventDefault();
      this.connection.use_token($('token').value);
      $('token').value = '';
    });
    addEventListener('keydown', (event) => {
      const field = event.target.closest('input:not([type="checkbox"])');
      if (field) {
        if (event.key === 'Escape') field.blur();
        return;
      }
      if (event.ctrlKey || event.altKey || event.metaKey || event.repeat || !$('keys').checked) return;
      const action = actions[event.key.toLowerCase()];
      if (!action) return;
      event.preventDefault();
      action();
    });
    addEventListener('resize', () => this.charts && this.charts.fit_width());
  }
}

// For tests: what was drawn.
window.condyle_live = new Live();
