// The moment that all views of a recording show, and the span of time that its charts show.

export class Moment {
  constructor() {
    this.time_s = null;
    this.span = null;
    this.watchers = [];
    this.spanWatchers = [];
  }

  /** Calls `watcher(time_s)` whenever the moment changes. */
  watch(watcher) {
    this.watchers.push(watcher);
  }

  watchSpan(watcher) {
    this.spanWatchers.push(watcher);
  }

  show(time_s) {
    if (time_s === this.time_s) return;
    this.time_s = time_s;
    for (const watcher of this.watchers) watcher(time_s);
  }

  zoom(begin_s, end_s) {
    if (this.span && this.span[0] === begin_s && this.span[1] === end_s) return;
    this.span = [begin_s, end_s];
    for (const watcher of this.spanWatchers) watcher(begin_s, end_s);
  }
}
