/** How a slider's whole-number positions stand for a parameter's values. */

const DECADES = 2; // a logarithmic slider goes this far to both sides of its centre
const STEPS = 200; // to each side
const FINE = 0.25; // how fine it is near the centre, beside the mean
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

/** Half a percent for each step near the centre, ever more away from it; 0 as the leftmost one where allowed. */
function logarithmic(low, high, centre, zero) {
  const start = zero ? 1 : 0;
  const value = (position) => {
    if (position < start) return 0;
    const decades = bent((position - start - STEPS) / STEPS);
    return Math.min(high, Math.max(low, rounded(centre * 10 ** decades)));
  };
  return {
    steps: start + 2 * STEPS,
    value,
    position: (wanted) => {
      if (wanted <= 0) return 0;
      const decades = Math.log10(wanted / centre);
      let [below, above] = [start, start + 2 * STEPS];
      while (above - below > 1) {
        const middle = (below + above) >> 1;
        if (bent((middle - start - STEPS) / STEPS) <= decades) below = middle;
        else above = middle;
      }
      const nearer = (p) => Math.abs(bent((p - start - STEPS) / STEPS) - decades);
      return nearer(below) <= nearer(above) ? below : above;
    },
  };
}

/** Decades from the centre for -1 to 1: a cubic that rises everywhere, least in the middle. */
function bent(share) {
  return DECADES * (FINE * share + (1 - FINE) * share ** 3);
}

/** To three digits, but whole numbers as they are. */
function rounded(value) {
  return Number.isInteger(value) ? value : Number(value.toPrecision(3));
}
