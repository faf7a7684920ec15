// The numbers of the report, as C++ packed them (report_data.cpp).

const kNone = -32768;  // of a packed value: none

function bytes(base64) {
  return Uint8Array.from(atob(base64), (c) => c.charCodeAt(0)).buffer;
}

/** Seconds: base64 of little-endian 32-bit floats. */
export function times(base64) {
  return Array.from(new Float32Array(bytes(base64)));
}

/** Values low + step * k, k packed as 16-bit integers; null where there are none. */
export function values(packed) {
  const out = [];
  for (const k of new Int16Array(bytes(packed.data))) {
    out.push(k === kNone ? null : packed.low + packed.step * (k - kNone));
  }
  return out;
}

/** The whole report. */
export function reportData() {
  return JSON.parse(document.getElementById('condyle-report-1').textContent);
}

/** Index of the sample nearest to `time_s` in rising `time`. */
export function nearest(time, time_s) {
  let low = 0;
  let high = time.length - 1;
  while (high - low > 1) {
    const middle = (low + high) >> 1;
    if (time[middle] <= time_s) low = middle;
    else high = middle;
  }
  return time_s - time[low] <= time[high] - time_s ? low : high;
}
