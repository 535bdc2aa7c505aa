/**
 * The value at the start of an ArrayBuffer in MessagePack (https://github.com/msgpack/msgpack/blob/master/spec.md),
 * all types but extensions. Returns [value, bytes it took]. Integers beyond 2^53 come as BigInt.
 */
export function decode(buffer) {
  const view = new DataView(buffer);
  let at = 0;

  const take = (bytes) => (at += bytes) - bytes;
  const whole = (big) => (Number.isSafeInteger(Number(big)) ? Number(big) : big);
  const bytes = (length) => new Uint8Array(buffer, take(length), length);
  const text = (length) => utf8.decode(bytes(length));
  const array = (length) => Array.from({ length }, value);
  const map = (length) => {
    const result = {};
    for (let i = 0; i < length; i++) {
      const key = value();
      result[key] = value();
    }
    return result;
  };

  const byTag = {
    0xc0: () => null,
    0xc2: () => false,
    0xc3: () => true,
    0xc4: () => bytes(view.getUint8(take(1))),
    0xc5: () => bytes(view.getUint16(take(2))),
    0xc6: () => bytes(view.getUint32(take(4))),
    0xca: () => view.getFloat32(take(4)),
    0xcb: () => view.getFloat64(take(8)),
    0xcc: () => view.getUint8(take(1)),
    0xcd: () => view.getUint16(take(2)),
    0xce: () => view.getUint32(take(4)),
    0xcf: () => whole(view.getBigUint64(take(8))),
    0xd0: () => view.getInt8(take(1)),
    0xd1: () => view.getInt16(take(2)),
    0xd2: () => view.getInt32(take(4)),
    0xd3: () => whole(view.getBigInt64(take(8))),
    0xd9: () => text(view.getUint8(take(1))),
    0xda: () => text(view.getUint16(take(2))),
    0xdb: () => text(view.getUint32(take(4))),
    0xdc: () => array(view.getUint16(take(2))),
    0xdd: () => array(view.getUint32(take(4))),
    0xde: () => map(view.getUint16(take(2))),
    0xdf: () => map(view.getUint32(take(4))),
  };

  function value() {
    const tag = view.getUint8(take(1));
    if (tag < 0x80) return tag;
    if (tag < 0x90) return map(tag & 0x0f);
    if (tag < 0xa0) return array(tag & 0x0f);
    if (tag < 0xc0) return text(tag & 0x1f);
    if (tag >= 0xe0) return tag - 0x100;
    if (!(tag in byTag)) throw new Error(`MessagePack type 0x${tag.toString(16)} is not known here`);
    return byTag[tag]();
  }

  return [value(), at];
}

const utf8 = new TextDecoder();
