// Numbers for people.

/// The ends of ranges in pictures, too (src/core/rounded_range.h).
const ROUNDED = [1, 1.2, 1.5, 2, 2.5, 3, 4, 5, 6, 8, 10];

/// The least rounded number that is not below the value; 0 if that is not positive.
export function niceAbove(value, steps = ROUNDED) {
  if (!(value > 0)) return 0;
  const decade = 10 ** Math.floor(Math.log10(value));
  return steps.find((one) => one * decade >= value * (1 - 1e-12)) * decade;
}

/// `digits` significant digits without an exponent where that is readable.
export function short(value, digits = 3) {
  if (!Number.isFinite(value)) return "-";
  if (value === 0) return "0";
  const size = Math.abs(value);
  if (size < 1e-4 || size >= 1e6) return value.toExponential(digits - 1).replace("e+", "e");
  return String(Number(value.toPrecision(digits)));
}

const PREFIXES = [[1e6, "M"], [1e3, "k"], [1, ""], [1e-3, "m"], [1e-6, "\u00b5"], [1e-9, "n"]];

/// The prefix in which numbers up to `most` are readable: {scale, unit}; value / scale is in that unit.
export function unitFor(most, unit) {
  const [scale, prefix] = PREFIXES.find(([one]) => most >= one * 0.9999) || [1, ""];
  return { scale, unit: prefix + unit };
}

/// "1.23 mJ"; numbers below a thousandth of the least prefix are zero.
export function withUnit(value, unit, digits = 3) {
  if (!Number.isFinite(value)) return "-";
  const shown = unitFor(Math.abs(value), unit);
  return `${short(Math.abs(value) < 1e-9 ? 0 : value / shown.scale, digits)} ${shown.unit}`;
}
