// Start, stop and mark; the sessions that are recorded.
import {ask, command, has_token} from './connection.js';

const kList_ms = 10000;
const $ = (id) => document.getElementById(id);

function size_words(bytes) {
  return bytes < 1e6 ? `${Math.ceil(bytes / 1e3)} kB` : `${(bytes / 1e6).toFixed(1)} MB`;
}

function clock_words(seconds) {
  const two = (n) => String(Math.floor(n)).padStart(2, '0');
  return `${two(seconds / 3600)}:${two(seconds / 60 % 60)}:${two(seconds % 60)}`;
}

// The box writes the time of the start into the name of the file; `date`: the box's time.
function clock_of(file, date) {
  const parts = /(\d{4})(\d\d)(\d\d)T(\d\d)(\d\d)(\d\d)Z[^/]*$/.exec(file);
  if (!parts || !date) return '';
  const [, year, month, day, hour, minute, second] = parts.map(Number);
  const since_s = (Date.parse(date) - Date.UTC(year, month - 1, day, hour, minute, second)) / 1000;
  return since_s >= 0 ? clock_words(since_s) : '';
}

function say(answer, words) {
  $('answer').textContent = answer.ok ? words : `Refused: ${answer.words}`;
}

export class Sessions {
  constructor() {
    this.phase = '';
    this.asked_ms = -Infinity;
    this.status = null;
    $('start').addEventListener('click', () => this.start());
    $('stop').addEventListener('click', () => this.stop());
    $('mark').addEventListener('click', () => this.mark());
    $('subject').addEventListener('keydown', (event) => event.key === 'Enter' && this.start());
    $('marker').addEventListener('keydown', (event) => event.key === 'Enter' && this.mark());
  }

  async start() {
    const answer = await command('/v1/session/start', {subject: $('subject').value.trim()});
    say(answer, `Recording ${answer.words}`);
    this.asked_ms = -Infinity;
  }

  async stop() {
    const answer = await command('/v1/session/stop', {});
    say(answer, `Recorded ${answer.words}`);
    this.asked_ms = -Infinity;
  }

  async mark() {
    const text = $('marker').value.trim() || 'marker';
    const answer = await command('/v1/session/marker', {text});
    say(answer, `${answer.words}: ${text}`);
  }

  /** Shows the session of `status`; null: not known. */
  tell(status, date) {
    const session = status && status.session;
    let words = 'not known: the box does not answer';
    if (session && !session.possible) {
      words = 'Recording is off: set [recording] folder in the configuration.';
    } else if (session && session.phase === 'idle') {
      words = 'No session is recorded.';
    } else if (session) {
      const subject = session.subject ? ` ${session.subject}` : '';
      const lost = session.reports_lost > 0 ? `, ${session.reports_lost} reports lost` : '';
      words = `${session.phase === 'paused' ? 'PAUSED' : 'Recording'}${subject} ${clock_of(session.file, date)}, ` +
        `${session.reports_written} reports${lost}, ${session.markers} marker${session.markers === 1 ? '' : 's'}`;
    }
    if (session && session.problem) words += ` Problem: ${session.problem}`;
    const state = $('session');
    if (state.textContent !== words) state.textContent = words;
    const is_bad = !session || session.phase === 'paused' || Boolean(session.problem);
    state.className = is_bad ? 'state bad' : session.phase === 'recording' ? 'state recording' : 'state';
    if (session && session.phase !== this.phase) {
      this.phase = session.phase;
      this.asked_ms = -Infinity;
    }
    if (status && performance.now() - this.asked_ms > kList_ms) this.list();
  }

  async list() {
    this.asked_ms = performance.now();
    let found = null;
    try {
      const answer = await ask('/v1/sessions', {}, 8000);
      found = await answer.json();
      if (!answer.ok) return this.show([], false, String(found.problem));
    } catch (error) {
      return;
    }
    const words = found.sessions.length === 0 ? 'No session is recorded yet.' :
      found.reports ? 'A report is made when you ask for it; that takes a while.' :
        'condyle report FILE makes the report of a recording.';
    this.show(found.sessions, found.reports, found.more > 0 ? `${words} ${found.more} older ones are left out.` : words);
  }

  show(sessions, has_reports, words) {
    $('list-words').textContent = words;
    $('list').hidden = sessions.length === 0;
    const body = $('list').tBodies[0];
    const shown = JSON.stringify(sessions);
    if (shown === this.shown) return;
    this.shown = shown;
    body.replaceChildren(...sessions.map((session) => {
      const row = document.createElement('tr');
      const cell = (text, kind) => {
        const made = document.createElement('td');
        made.textContent = text;
        if (kind) made.className = kind;
        row.append(made);
        return made;
      };
      cell(session.name);
      cell(size_words(session.bytes), 'n');
      const downloads = cell('');
      const add = (text, path, file) => {
        const button = document.createElement('button');
        button.type = 'button';
        button.textContent = text;
        button.setAttribute('aria-label', `${text} of ${session.name}`);
        button.addEventListener('click', () => this.download(path, file, button));
        downloads.append(button);
      };
      if (session.recording) {
        downloads.textContent = 'is being recorded';
        return row;
      }
      const path = `/v1/sessions/${encodeURIComponent(session.name)}`;
      add('Log', path, session.name);
      if (has_reports) add('Report', `${path}/report`, session.name.replace(/\.mcap$/, '.html'));
      return row;
    }));
  }

  async download(path, file, button) {
    const link = document.createElement('a');
    link.download = file;
    if (!has_token() && !path.endsWith('/report')) {
      link.href = path;  // the browser saves it piece by piece
      link.click();
      return;
    }
    const words = button.textContent;
    button.textContent = `${words} ...`;
    try {
      const answer = await ask(path, {}, 600000);
      if (!answer.ok) throw new Error(String((await answer.json()).problem));
      link.href = URL.createObjectURL(await answer.blob());
      link.click();
      setTimeout(() => URL.revokeObjectURL(link.href), 60000);
    } catch (error) {
      $('list-words').textContent = `${file} cannot be downloaded: ${error.message}`;
    } finally {
      button.textContent = words;
    }
  }
}
