/** The page: what the daemon says goes into index.html, what the user sets goes to the daemon. */

import { ask, Backoff } from "./daemon.js";
import { Diagnosis } from "./diagnosis.js";
import { element } from "./element.js";
import { Live } from "./live.js";
import { buildPanel } from "./parameters.js";
import { listCameras, listPresets, setUpPresets } from "./presets.js";
import { Recording } from "./recording.js";
import { Source } from "./source.js";

const STATUS_PERIOD_MS = 1000;

const find = (id) => document.getElementById(id);
const live = new Live((version) => version > shown.version && refresh().catch(() => {})); // `watch` will say why
const diagnosis = new Diagnosis();
const source = new Source();
const recording = new Recording();
const backoff = new Backoff();
const shown = { version: -1, uptime_s: 0, built: "", state: "", panel: null };
let here = false; // the daemon answered the last time

async function watch() {
  try {
    const status = await ask("status");
    if (!here || status.uptime_s < shown.uptime_s) await load();
    shown.uptime_s = status.uptime_s;
    if (!here && !document.hidden) open();
    here = true;
    find("session").hidden = true;
    backoff.reset();
    if (status.parameters_version !== shown.version) await refresh();
    showStatus(status);
  } catch (error) {
    here = false;
    close();
    find("session").hidden = !error.needsToken;
    if (error.needsToken) showState("locked", "");
    else showState("gone", `${error.message} Trying again…`);
  }
  setTimeout(watch, here ? STATUS_PERIOD_MS : backoff.next());
}

function open() {
  live.open();
  diagnosis.open();
}

function close() {
  live.close();
  diagnosis.close();
}

/** The panel, when the daemon is new or another one. */
async function load() {
  const [camera, schema, presets] = await Promise.all(["camera", "parameters/schema", "presets"].map((what) => ask(what)));
  find("camera").textContent = `${camera.name}, ${camera.width} × ${camera.height}`;
  document.title = `${camera.name} · Voltcam`;
  const built = JSON.stringify([camera, schema]);
  if (built !== shown.built)
    shown.panel = buildPanel(find("parameters"), schema, camera.parameters, presets.noisy ?? {}, change);
  await Promise.all([listPresets(), listCameras(camera.name)]);
  shown.built = built;
  shown.version = -1;
}

/** Asks for a change; the answer says what holds. */
async function change(patch) {
  holds(await ask("parameters", "PATCH", patch));
}

let refreshing = null;

function refresh() {
  refreshing ??= ask("parameters")
    .then(holds)
    .finally(() => (refreshing = null));
  return refreshing;
}

/** Shows the parameters that hold. */
function holds({ parameters, parameters_version }) {
  if (parameters_version < shown.version) return; // an answer overtaken by a newer one
  shown.version = parameters_version;
  shown.panel.show(parameters);
  find("version").textContent = parameters_version;
}

/** The mark in the header; and in a banner what keeps the pictures from coming, and what can be done. */
function showState(state, words) {
  const mark = find("source-state");
  mark.textContent = state === "gone" ? "no daemon" : state;
  mark.dataset.state = state;
  find("banner").hidden = words === "";
  if (shown.state === state + words) return; // a screen reader repeats what is set again
  shown.state = state + words;
  find("banner-words").textContent = words;
  find("remedies").replaceChildren(...source.remedies(state));
}

function showStatus(status) {
  const { state, reason, load, frames, latency, uptime_s } = status;
  const well = state === "running" || state === "starting";
  showState(state, well ? "" : `${state[0].toUpperCase()}${state.slice(1)}: ${reason}`);
  source.show(status.source);
  recording.show(status.recording);
  const { granted, fps } = status.source;
  const size = granted ? `${granted.width} × ${granted.height}, ` : "";
  find("frame-about").textContent = `${size}${fps.toFixed(1)} frames/s`;
  showCounts({
    "age of events": `${latency.age_ms.toFixed(1)} ms`,
    load: load.toFixed(2),
    "frames received": frames.received,
    "frames dropped": frames.dropped,
    "frames skipped": frames.skipped,
    "packets lost here": live.lost,
    "events not drawn here": live.skipped,
    "up for": duration(uptime_s),
  });
  showSubscribers(status.transports);
}

/** Who listens over WebSocket; of ZeroMQ only sums are known. */
function showSubscribers(transports) {
  const rows = Object.entries(transports).flatMap(([name, { address, packets_sent, packets_dropped, clients }]) => [
    [name, address, packets_sent, packets_dropped],
    ...clients.map((client) => [client.topic, client.address, client.sent, client.dropped]),
  ]);
  const cells = (row) => row.map((value, i) => element(i ? "td" : "th", {}, [String(value)]));
  find("subscribers").tBodies[0].replaceChildren(...rows.map((row) => element("tr", {}, cells(row))));
}

function showCounts(counts) {
  const rows = Object.entries(counts).map(([name, value]) =>
    element("div", {}, [element("dt", {}, [name]), element("dd", {}, [String(value)])]),
  );
  find("counts").replaceChildren(...rows);
}

function duration(seconds) {
  const parts = [seconds / 3600, (seconds / 60) % 60, seconds % 60];
  return parts.map((part) => String(Math.floor(part)).padStart(2, "0")).join(":");
}

find("session").addEventListener("submit", async (event) => {
  event.preventDefault();
  try {
    await ask("session", "POST", { token: find("token").value });
    find("token").value = find("session-error").textContent = "";
    backoff.reset();
  } catch ({ message }) {
    find("session-error").textContent = message;
  }
});

find("search").oninput = () => shown.panel?.search(find("search").value);
setUpPresets(holds);

const KEYS = { "/": () => find("search").focus(), " ": () => live.pause(), v: () => live.nextView() };

document.addEventListener("keydown", (event) => {
  const typing = event.target.closest("input, select, textarea, button, summary, a");
  if (typing || event.ctrlKey || event.metaKey || event.altKey || !(event.key in KEYS)) return;
  event.preventDefault();
  KEYS[event.key]();
});

// A hidden page takes no stream: it costs the daemon nothing, and comes back with the newest.
document.addEventListener("visibilitychange", () => {
  if (document.hidden) close();
  else if (here) open();
});
matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => live.paint());

watch();
