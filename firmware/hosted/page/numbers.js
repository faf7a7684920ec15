/** `value` with so many decimals; a zero has no sign. */
export function fixed(value, decimals) {
  return value.toFixed(decimals).replace(/^-(?=0(\.0*)?$)/, '');
}
