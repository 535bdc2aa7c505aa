/** The daemon as the page sees it: REST with errors in words, and streams that come back by themselves. */

import { decode } from "./msgpack.js";

const API = new URL("api/v1/", document.baseURI);
const FIRST_RETRY_MS = 250;
const LONGEST_RETRY_MS = 4000;
const GET_PATIENCE_MS = 5000;
const CHANGE_PATIENCE_MS = 60_000; // a network source takes its time to open

/** GET, or another method with a JSON body. Throws an Error whose message a person can read. */
export async function ask(path, method = "GET", body = undefined) {
  const response = await fetch(new URL(path, API), {
    method,
    headers: { "Content-Type": "application/json" },
    body: JSON.stringify(body),
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
  #onMessage;
  #onOpen;
  #backoff = new Backoff();
  #socket = null;
  #retry = 0;

  /** onMessage(header, ArrayBuffer) or onMessage(json) for each message, onOpen() for each connection. */
  constructor(path, onMessage, onOpen = () => {}) {
    this.#url = new URL(path, API);
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
      const parts = read(data);
      this.#backoff.reset();
      this.#onMessage(...parts);
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

function read(data) {
  if (typeof data === "string") return [JSON.parse(data)];
  const [header, used] = decode(data);
  return [header, data.slice(used)];
}
