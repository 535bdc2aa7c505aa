/** Buffers of events in the `libcaer` encoding: two 32-bit words each, address with polarity, and time. */

/** Calls act(x, y, on, us) for each event on the sensor; us: time after the packet's `time_base`. */
export function each(buffer, width, height, act) {
  const words = new Uint32Array(buffer);
  for (let i = 0; i < words.length; i += 2) {
    const word = words[i];
    const x = word >>> 17;
    const y = (word >>> 2) & 0x7fff;
    if (word & 1 && x < width && y < height) act(x, y, (word >>> 1) & 1, words[i + 1]);
  }
}

/** The start of a packet in microseconds of the events' clock. */
export function baseUs({ time_base }) {
  return Number(BigInt(time_base) / 1000n);
}
