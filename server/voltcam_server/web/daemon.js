/** The daemon as the page sees it: REST with errors in words, and streams that come back by themselves. */

import { decode } from "./msgpack.js";

const API = new URL("api/v1/", document.baseURI);
const CAMERA = new URLSearchParams(location.search).get("camera"); // which of several; null: the first
const FIRST_RETRY_MS = 250;
const LONGEST_RETRY_MS = 4000;
const GET_PATIENCE_MS = 5000;
const CHANGE_PATIENCE_MS = 60_000; // a network source takes its time to open

/** Where something of this page's camera is. */
export function address(path) {
  const url = new URL(path, API);
  if (CAMERA !== null) url.searchParams.set("camera", CAMERA);
  return url;
}

/** GET, or another method with a body: JSON, or text as it is. Throws an Error whose message a person can read. */
export async function ask(path, method = "GET", body = undefined) {
  const text = typeof body === "string";
  const response = await fetch(address(path), {
    method,
    headers: { "Content-Type": text ? "application/yaml" : "application/json" },
    body: text ? body : JSON.stringify(body),
    signal: AbortSignal.timeout(method === "GET" ? GET_PATIENCE_MS : CHANGE_PATIENCE_MS),
    cache: "no-store",
  }).catch(() => {
    throw new Error("The daemon does not answer.");
  });
  const answer = await response.json().catch(() => ({}));
  if (response.ok) return answer;
  const error = new Error(answer.detail ?? `The daemon answers ${response.status}.`);
  error.needsToken = response.status === 401;
  throw error;
}

/** Waits that double: call it for the next one in ms, `reset` it after a success. */
export class Backoff {
  #next = FIRST_RETRY_MS;

  next() {
    const wait = this.#next;
    this.#next = Math.min(2 * wait, LONGEST_RETRY_MS);
    return wait;
  }

  reset() {
    this.#next = FIRST_RETRY_MS;
  }
}

/** A WebSocket of messages, each a MessagePack header and a raw buffer, or JSON text, reopened until `close`. */
export class Stream {
  #url;
  #bundled;
  #onMessage;
  #onOpen;
  #backoff = new Backoff();
  #socket = null;
  #retry = 0;

  /** onMessage(header, ArrayBuffer) or onMessage(json) for each message, onOpen() for each connection. */
  constructor(path, onMessage, onOpen = () => {}) {
    this.#url = address(path);
    this.#bundled = this.#url.searchParams.has("bundle_ms");
    this.#url.protocol = this.#url.protocol.replace("http", "ws");
    this.#onMessage = onMessage;
    this.#onOpen = onOpen;
  }

  open() {
    if (this.#socket) return;
    const socket = (this.#socket = new WebSocket(this.#url));
    socket.binaryType = "arraybuffer";
    socket.onopen = () => this.#onOpen();
    socket.onmessage = ({ data }) => {
      this.#backoff.reset();
      for (const message of this.#bundled ? unbundled(data) : [data]) this.#onMessage(...read(message));
    };
    socket.onclose = () => {
      if (socket !== this.#socket) return;
      this.#socket = null;
      this.#retry = setTimeout(() => this.open(), this.#backoff.next());
    };
  }

  close() {
    clearTimeout(this.#retry);
    const socket = this.#socket;
    this.#socket = null;
    socket?.close();
  }
}

/** Messages, each after its length. */
function* unbundled(data) {
  const view = new DataView(data);
  for (let at = 0; at < data.byteLength; ) {
    const length = view.getUint32(at, true);
    yield data.slice(at + 4, at + 4 + length);
    at += 4 + length;
  }
}

function read(data) {
  if (typeof data === "string") return [JSON.parse(data)];
  const [header, used] = decode(data);
  return [header, data.slice(used)];
}
