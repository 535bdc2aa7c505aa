/** How a slider's whole-number positions stand for a parameter's values. */

const DECADES = 2; // a logarithmic slider goes this far to both sides of its centre
const PER_DECADE = 100;
const WIDE = 20; // limits this many times the centre call for a logarithm

/**
 * The scale for the limits of a JSON schema around `centre`, what the camera has:
 * { steps, value(position), position(value) }, positions 0 to steps. Values beyond it are at its ends.
 */
export function scaleOf({ minimum, exclusiveMinimum, maximum }, centre) {
  const low = minimum ?? exclusiveMinimum;
  return low >= 0 && centre > 0 && maximum > WIDE * centre
    ? logarithmic(low, maximum, centre, minimum === 0)
    : linear(low, maximum);
}

/** Steps of a round size, about a hundred. */
function linear(low, high) {
  const step = 10 ** Math.floor(Math.log10((high - low) / 100));
  return {
    steps: Math.round((high - low) / step),
    value: (position) => Math.min(high, rounded(low + position * step)),
    position: (value) => Math.round((value - low) / step),
  };
}

/** A hundredth of a decade for each step, and 0 as the leftmost one where it is allowed. */
function logarithmic(low, high, centre, zero) {
  const first = Math.max(low, centre / 10 ** DECADES);
  const last = Math.min(high, centre * 10 ** DECADES);
  const below = Math.round(Math.log10(centre / first) * PER_DECADE);
  const above = Math.round(Math.log10(last / centre) * PER_DECADE);
  const start = zero ? 1 : 0;
  return {
    steps: start + below + above,
    value: (position) =>
      position < start ? 0 : rounded(centre * 10 ** ((position - start - below) / PER_DECADE)),
    position: (value) =>
      value <= 0 ? 0 : start + Math.max(0, below + Math.round(Math.log10(value / centre) * PER_DECADE)),
  };
}

/** To three digits, but whole numbers as they are. */
function rounded(value) {
  return Number.isInteger(value) ? value : Number(value.toPrecision(3));
}
