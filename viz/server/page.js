// Starts rerun's web viewer on the recording served beside this page.
//
// The address may end in ?renderer=webgl or ?renderer=webgpu for computers on which the automatic choice fails.
"use strict";

// The viewer reports its use to its makers and cannot be told not to. The page's policy forbids that anyway; answering
// here keeps the console clean.
const fetch_here = window.fetch.bind(window);
window.fetch = (request, options) => {
  const address = new URL(request instanceof Request ? request.url : request, location.href);
  if (address.origin === location.origin) return fetch_here(request, options);
  return Promise.resolve(new Response(null, { status: 204 }));
};

const message = document.getElementById("message");

function say(text, details) {
  message.replaceChildren();
  const paragraph = message.appendChild(document.createElement("p"));
  paragraph.textContent = text;
  if (details) message.appendChild(document.createElement("pre")).textContent = details;
  message.hidden = false;
}

function failed(what, details) {
  console.error(what, details);
  document.getElementById("viewer").hidden = true;
  say(`${what} Reload the page to try again; if it fails again, try ?renderer=webgl at the end of the address.`,
    String(details));
}

async function wasm() {
  const response = await fetch("/re_viewer_bg.wasm");
  if (!response.ok) throw new Error(`The viewer cannot be loaded: ${response.status} ${response.statusText}`);
  const total = Number(response.headers.get("Content-Length"));
  const reader = response.body.getReader();
  let loaded = 0;
  const counted = new ReadableStream({
    async pull(controller) {
      const { done, value } = await reader.read();
      if (done) return controller.close();
      loaded += value.byteLength;
      if (total > 0) say(`Loading the viewer… ${Math.floor((100 * loaded) / total)} %`);
      controller.enqueue(value);
    },
  });
  return new Response(counted, { headers: { "Content-Type": "application/wasm" } });
}

async function start() {
  await wasm_bindgen({ module_or_path: await wasm() });
  const query = new URLSearchParams(location.search);
  const handle = new wasm_bindgen.WebHandle({
    url: [`${location.origin}/recording.rrd`],
    render_backend: query.get("renderer"),
    hide_welcome_screen: true,
    enable_history: false,
    notebook: false,
    persist: false,
  });
  const watch = () => {
    if (handle.has_panicked()) failed("The viewer has stopped.", handle.panic_message());
    else setTimeout(watch, 1000);
  };
  await handle.start(document.getElementById("viewer"));
  message.hidden = true;
  watch();
  if (document.body.dataset.isFinished === "true") play_from_start(handle);
}

// A finished recording plays from its start, even if it was made to be followed live.
function play_from_start(handle) {
  const recording = handle.get_active_recording_id();
  const range = recording && handle.get_timeline_time_range(recording, "time");
  if (!range) return setTimeout(() => play_from_start(handle), 100);
  handle.set_time_for_timeline(recording, "time", range.min);
  handle.set_playing(recording, true);
}

start().catch((error) => failed("The viewer cannot start.", error));
