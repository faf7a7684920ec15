// What an estimate holds that a chart can show: groups of signals, with their units and letters.
import {fixed} from '../../hosted/page/numbers.js';

const kDegrees = 180 / Math.PI;
const k95 = 1.959963984540054;  // half-width of the central 95 % of a normal distribution

function quantity(of, name, unit) {
  const [value, sd, provenance] = [`${name}_${unit}`, `${name}_sd_${unit}`, `${name}_provenance`];
  return (line) => {
    const from = of(line);
    return from && from[value] !== null && from[value] !== undefined ?
      {value: from[value], sd: from[sd], provenance: from[provenance]} : null;
  };
}

/** Names of the axes of `line`: x, y, z or axis. */
export function axes_of(line) {
  return line.x ? ['x', 'y', 'z'] : ['axis'];
}

/** Groups of signals of estimates like `line`: {key, title, unit, scale, signals: [{name, read}]}. */
export function groups_of(line) {
  const axes = axes_of(line);
  const motion = (name, unit) => axes.map((axis) => (
    {name: axis === 'axis' ? 'along the axis' : axis, read: quantity((l) => l[axis], name, unit)}));
  const groups = [
    {key: 'position', title: 'Position from zero', unit: 'mm', scale: 1e3, from_zero: true,
      signals: motion('position', 'm')},
    {key: 'velocity', title: 'Velocity', unit: 'mm/s', scale: 1e3, signals: motion('velocity', 'm_s')},
  ];
  if (line.pose) {
    const turn = (name) => ({name, read: quantity((l) => l.pose, name, 'rad')});
    groups.push({key: 'turn', title: 'Rotation', unit: 'deg', scale: kDegrees,
      signals: [turn('twist'), turn('swing')]});
  }
  groups.push({key: 'force', title: 'Force: an assumed mass times the acceleration', unit: 'N', scale: 1,
    signals: motion('force', 'N')});
  return groups;
}

/** Friction and mass, where a drive is measured: [{name, unit, value, sd, provenance, limit}]. */
export function identified_of(line) {
  if (!line.impedance) return [];
  const read = (name, unit, shown) => ({
    name, unit: shown, value: line.impedance[`${name}_${unit}`],
    sd: line.impedance[`${name}_sd_${unit}`], provenance: line.impedance[`${name}_provenance`],
    limit: line.impedance[`${name}_limit`],
  });
  return [read('friction', 'Ns_m', 'N s/m'), read('mass', 'kg', 'kg')];
}

/** True if the position of the sample itself was measured: not predicted, not missing. */
export function is_measured(line) {
  return axes_of(line).every((axis) => line[axis].position_provenance === 'measured');
}

/** Digits that the interval allows: "-12.3 \u00b1 0.2". */
export function with_interval(value, half) {
  if (!(half > 0)) return `${Number(value.toPrecision(4))}, interval not known`;
  const digits = Math.min(6, Math.max(0, 1 - Math.floor(Math.log10(half))));
  return `${fixed(value, digits)} \u00b1 ${half.toFixed(digits)}`;
}

/** A quantity of `read`, in the unit of its group. */
export function quantity_words(found, scale, unit) {
  if (!found) return 'not known';
  return `${with_interval(found.value * scale, k95 * found.sd * scale)} ${unit}`;
}

/** The letter of a provenance, as an element of class mark. */
export function mark_of(provenance) {
  const mark = document.createElement('span');
  set_mark(mark, provenance);
  return mark;
}

/** Makes `mark` the mark of `provenance`. */
export function set_mark(mark, provenance) {
  const letter = {measured: 'M', derived: 'D', assumed: 'A'}[provenance] || '\u2013';
  if (mark.textContent === letter) return;
  mark.textContent = letter;
  mark.className = `mark ${provenance || 'none'}`;
  mark.title = provenance || 'no value';
}
