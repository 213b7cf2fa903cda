// The page: files, clock, devices, text. The world is in the module. The files of this folder make one script, in the order
// start, clock, shown, devices, controls.

const files = JSON.parse(document.getElementById('files').textContent);
const query = new URLSearchParams(location.search);
const at = (id) => document.getElementById(id);
const canvas = at('view');

/** For checks: what became of the start, and when each step of it was done, milliseconds since the page was asked for. */
const told = { error: null, firstFrameMs: null, steps: {}, fps: 0, physicsMs: 0, drawMs: 0, adapter: '' };
const step = (name) => { told.steps[name] = Math.round(performance.now()); };
let demo = null;
/** Of the module. */
let exports = null;

function problem(text) {
  told.error ??= text;
  at('loading').hidden = true;
  at('problem').textContent = text;
  at('problem').hidden = false;
}

let noteTimer = 0;
function note(text) {
  at('note').textContent = text;
  at('note').hidden = false;
  clearTimeout(noteTimer);
  noteTimer = setTimeout(() => { at('note').hidden = true; }, 5000);
}

/** Kept from visit to visit, where the browser allows it. */
function kept(name, value) {
  try {
    if (value === undefined) return JSON.parse(localStorage.getItem(`policy-space.${name}`));
    localStorage.setItem(`policy-space.${name}`, JSON.stringify(value));
  } catch { /* a browser that keeps nothing */ }
  return null;
}

// ---- Loading

const sizes = Object.values(files).reduce((sum, file) => sum + file.bytes, 0);
const loaded = {};

/** The answer for a file, whose bytes are counted on their way. */
async function answerOf(name) {
  const file = files[name];
  const response = await fetch(file.path);
  if (!response.ok) throw new Error(`${file.path}: the server says ${response.status} ${response.statusText}`);
  let length = 0;
  const count = new TransformStream({
    transform(part, out) {
      length += part.length;
      if (length > file.bytes) throw new Error(`${file.path}: expected ${file.bytes} bytes, found more`);
      loaded[name] = length;
      at('progress').value = Object.values(loaded).reduce((sum, n) => sum + n, 0) / sizes;
      out.enqueue(part);
    },
    flush() {
      if (length < file.bytes) throw new Error(`${file.path}: expected ${file.bytes} bytes, found ${length}`);
      step(name);
    },
  });
  return new Response(response.body.pipeThrough(count), { headers: { 'Content-Type': response.headers.get('Content-Type') } });
}
const bytesOf = async (name) => new Uint8Array(await (await answerOf(name)).arrayBuffer());

async function start() {
  if (typeof WebAssembly !== 'object') return problem('This browser runs no WebAssembly, or it is turned off. The demo needs it.');
  step('script');
  // All files are on their way at once; the module is compiled while it comes.
  const [pack, mesh, code] = [bytesOf('pack'), bytesOf('mesh'), import(files.code.path)];
  const module = await code;
  const compiled = module.default({ module_or_path: answerOf('wasm') });
  // With the module's own options, so that the module finds this context opened.
  if (!await globalThis.adapter && !canvas.getContext('webgl2', { antialias: false })) {
    return problem('This browser has neither WebGPU nor WebGL2, or they are turned off. The demo draws with one of them.');
  }
  step('adapter');
  exports = await compiled;
  loaded.code = files.code.bytes;
  step('module');
  at('step').textContent = 'Starting';
  fit();
  // The world is made while the graphics process of the browser opens the canvas.
  const opening = module.Screen.open(canvas);
  opening.then(() => step('screen'), () => {});
  const players = Math.min(8, Math.max(1, Number(query.get('players')) || 1));
  const flat = query.get('scene') === 'flat' || query.get('input') === 'script';
  const ready = module.Ready.make(await pack, await mesh, players, flat);
  step('world');
  demo = module.Demo.start(ready, await opening);
  step('renderer');
  told.adapter = demo.adapter();
  drawsCheaply = demo.is_software();
  if (drawsCheaply) drawScale = 0.75;
  fit();
  if (kept('picture') === 'coarse') drawLess();
  schedule();
}

/** What is not needed for the first picture. */
function showControls() {
  at('progress').value = 1;
  at('loading').hidden = true;
  at('hud').hidden = false;
  at('touch').hidden = !matchMedia('(pointer: coarse)').matches;
  showPolicies();
  showPrompts();
  if (query.get('input') === 'script') demo.restart(true);
  playFragment();
  canvas.focus();
}

function playFragment() {
  const link = new URLSearchParams(location.hash.slice(1)).get('replay');
  if (!link || !demo) return;
  attempt(() => { demo.play_link(link); note('Playing the replay of this link.'); });
}

/** Runs something of the module; what it complains of is said. */
function attempt(work) {
  try { return work(); } catch (error) { note(String(error.message ?? error)); return undefined; }
}
