// The estimates and the state of the box. The token goes into a header: EventSource could not send one.

const kSilence_ms = 8000;   // the box sends a sign of life every 5 s
const kStatus_ms = 1000;
const kPatience_ms = 4000;  // with an answer
const kToken = 'condyle-token';
const kLongestAway_ms = 9000;  // after a longer absence only what is new is of use

/** Kept for the tab, never in an address. */
const token = {
  get() {
    try {
      return sessionStorage.getItem(kToken) || '';
    } catch (error) {
      return this.kept || '';
    }
  },
  set(text) {
    this.kept = text;
    try {
      sessionStorage.setItem(kToken, text);
    } catch (error) {
      // Without storage it is kept until the page is left.
    }
  },
};

function headers(more) {
  const own = token.get() ? {Authorization: `Bearer ${token.get()}`} : {};
  return {...own, ...more};
}

const pause = (ms) => new Promise((done) => setTimeout(done, ms));

export function has_token() {
  return token.get() !== '';
}

/** What to ask the box, with the token; rejects if it does not answer in time. */
export async function ask(path, options = {}, patience_ms = kPatience_ms) {
  const end = new AbortController();
  const timer = setTimeout(() => end.abort(), patience_ms);
  try {
    return await fetch(path, {
      ...options, headers: headers(options.headers), signal: end.signal, cache: 'no-store',
    });
  } finally {
    clearTimeout(timer);
  }
}

/** A command: {ok, words}. */
export async function command(path, body) {
  try {
    const answer = await ask(path, {
      method: 'POST', headers: {'Content-Type': 'application/json'}, body: JSON.stringify(body),
    }, 8000);
    const json = await answer.json();
    return {ok: answer.ok, words: String(answer.ok ? json.done : json.problem)};
  } catch (error) {
    return {ok: false, words: 'The box does not answer.'};
  }
}

/** Follows the box for ever. `on`: line(estimate), gap(missed), status(json, date), change(). */
export class Connection {
  constructor(on) {
    this.on = on;
    this.is_open = false;
    this.needs_token = false;
    this.is_refused = false;  // the token
    this.problem = '';
    this.lost_ms = performance.now();
    this.cuts = 0;         // times that the connection was lost and came back
    this.away_s = 0;       // in all of them
    this.was_away_s = 0;   // in the last one
    this.back_ms = -Infinity;
    this.missed = 0;
    this.last = null;  // number of the last line
    this.wake = null;
    this.follow();
    this.watch();
  }

  /** Tries again, with this token. */
  use_token(text) {
    token.set(text.trim());
    this.needs_token = false;
    if (this.wake) this.wake();
  }

  async follow() {
    for (let tries = 0;; ++tries) {
      const begin_ms = performance.now();
      try {
        await this.listen();
        this.problem = 'the box ended the connection';
      } catch (error) {
        if (!this.is_open && error.words) this.problem = error.words;
        else this.problem = 'the box cannot be reached';
      }
      if (this.is_open) {
        this.is_open = false;
        this.lost_ms = performance.now();
        tries = 0;
      }
      this.on.change();
      if (this.needs_token) {
        await new Promise((done) => {
          this.wake = done;
        });
        this.wake = null;
      } else {
        await pause(Math.max(0, begin_ms + Math.min(250 << Math.min(tries, 3), 2000) - performance.now()));
      }
    }
  }

  async listen() {
    const away_ms = performance.now() - this.lost_ms;
    const goes_on = this.last !== null && away_ms < kLongestAway_ms;
    const end = new AbortController();
    let timer = setTimeout(() => end.abort(), kSilence_ms);
    try {
      const answer = await fetch(goes_on ? `/v1/estimates?after=${this.last}` : '/v1/estimates',
          {headers: headers(), signal: end.signal, cache: 'no-store'});
      if (answer.status === 401) {
        this.needs_token = true;
        this.is_refused = has_token();
      }
      if (!answer.ok) throw {words: String((await answer.json()).problem)};
      if (this.last !== null) {
        ++this.cuts;
        this.was_away_s = away_ms / 1000;
        this.away_s += this.was_away_s;
        this.back_ms = performance.now();
        if (!goes_on) this.on.gap(0);
      }
      this.is_open = true;
      this.needs_token = false;
      this.problem = '';
      this.on.change();
      const reader = answer.body.getReader();
      const decoder = new TextDecoder();
      let text = '';
      for (;;) {
        const {done, value} = await reader.read();
        clearTimeout(timer);
        if (done) return;
        timer = setTimeout(() => end.abort(), kSilence_ms);
        text += decoder.decode(value, {stream: true});
        text = this.take(text);
      }
    } finally {
      clearTimeout(timer);
    }
  }

  // Events end with an empty line; returns what is left of `text`.
  take(text) {
    let from = 0;
    for (let to = 0; (to = text.indexOf('\n\n', from)) >= 0; from = to + 2) {
      let name = '';
      let data = '';
      let id = null;
      for (const line of text.slice(from, to).split('\n')) {
        if (line.startsWith('data: ')) data = line.slice(6);
        else if (line.startsWith('id: ')) id = Number(line.slice(4));
        else if (line.startsWith('event: ')) name = line.slice(7);
      }
      if (!data) continue;
      if (name === 'missed') {
        const {missed} = JSON.parse(data);
        this.missed += missed;
        this.on.gap(missed);
      } else {
        if (id !== null) this.last = id;
        this.on.line(JSON.parse(data));
      }
    }
    return text.slice(from);
  }

  async watch() {
    for (;; await pause(kStatus_ms)) {
      if (this.needs_token) continue;
      try {
        const answer = await ask('/v1/status');
        if (answer.ok) this.on.status(await answer.json(), answer.headers.get('Date'));
        else if (answer.status === 401 && !this.is_open) this.needs_token = true;
      } catch (error) {
        this.on.status(null, null);
      }
      this.on.change();
    }
  }
}
