// The page: files, clock, devices, text. The world is in the module.

const files = JSON.parse(document.getElementById('files').textContent);
const query = new URLSearchParams(location.search);
const at = (id) => document.getElementById(id);
const canvas = at('view');

const told = { error: null, firstFrameMs: null, fps: 0, physicsMs: 0, adapter: '' };
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

// ---- Loading

const sizes = Object.values(files).reduce((sum, file) => sum + file.bytes, 0);
const loaded = {};

async function bytesOf(name) {
  const file = files[name];
  const response = await fetch(file.path);
  if (!response.ok) throw new Error(`${file.path}: the server says ${response.status} ${response.statusText}`);
  const reader = response.body.getReader();
  const parts = new Uint8Array(file.bytes);
  let length = 0;
  for (;;) {
    const { done, value } = await reader.read();
    if (done) break;
    if (length + value.length > file.bytes) throw new Error(`${file.path}: expected ${file.bytes} bytes, found more`);
    parts.set(value, length);
    length += value.length;
    loaded[name] = length;
    at('progress').value = Object.values(loaded).reduce((sum, n) => sum + n, 0) / sizes;
  }
  if (length !== file.bytes) throw new Error(`${file.path}: expected ${file.bytes} bytes, found ${length}`);
  return parts;
}

async function start() {
  if (typeof WebAssembly !== 'object') return problem('This browser runs no WebAssembly, or it is turned off. The demo needs it.');
  if (!navigator.gpu && !document.createElement('canvas').getContext('webgl2')) {
    return problem('This browser has neither WebGPU nor WebGL2, or they are turned off. The demo draws with one of them.');
  }
  const [code, wasm, pack, mesh] = await Promise.all([
    import(files.code.path), bytesOf('wasm'), bytesOf('pack'), bytesOf('mesh'),
  ]);
  loaded.code = files.code.bytes;
  at('step').textContent = 'Starting';
  exports = await code.default({ module_or_path: wasm });
  fit();
  const players = Math.min(8, Math.max(1, Number(query.get('players')) || 1));
  demo = await code.Demo.start(canvas, pack, mesh, players, query.get('scene') === 'flat');
  told.adapter = demo.adapter();
  at('progress').value = 1;
  at('loading').hidden = true;
  at('hud').hidden = false;
  at('touch').hidden = !matchMedia('(pointer: coarse)').matches;
  if (query.get('input') === 'script') demo.restart(true);
  showPolicies();
  showPrompts();
  playFragment();
  canvas.focus();
  requestAnimationFrame(frame);
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

// ---- Clock

let last = null;
let frames = 0;
/** Pad and buttons of this frame. */
let input = [[], 0];
let frameStart = 0;
function frame(now) {
  if (document.hidden || told.error) { last = null; return; }
  const secs = last === null ? 0 : Math.min((now - last) / 1000, 0.25);
  last = now;
  const began = performance.now();
  try {
    const mode = demo.mode();
    input = [pad(), buttons()];
    const ticks = demo.advance(secs, ...input);
    if (ticks > 0) tapped.clear();
    if (ticks > 0) told.physicsMs += 0.1 * ((performance.now() - began) / ticks - told.physicsMs);
    if (mode !== demo.mode()) note(mode === 'playing' ? 'The replay is over: every state was the recorded one.' : 'The script is over.');
  } catch (error) {
    if (error instanceof WebAssembly.RuntimeError) return problem(`The demo stopped: ${error.message}`);
    note(`The replay stopped: ${error.message ?? error}`);
  }
  const drawn = demo.draw();
  tickPrompts();
  if (frames % 6 === 0) showWeights();
  if (drawn && told.firstFrameMs === null) told.firstFrameMs = performance.now();
  frames += 1;
  if (now - frameStart > 1000) {
    told.fps = frames * 1000 / (now - frameStart);
    [frames, frameStart] = [0, now];
    at('doing').textContent = demo.doing();
    showCourse();
    if (told.fps < 24) drawLess();
    at('rate').textContent = `${told.fps.toFixed(0)} fps, physics ${told.physicsMs.toFixed(1)} ms a tick`;
  }
  requestAnimationFrame(frame);
}
document.addEventListener('visibilitychange', () => {
  if (!document.hidden && demo && !told.error) { last = null; requestAnimationFrame(frame); }
});

// ---- What the controller does, the course, and the first steps

/** One bar for each policy. */
const bars = [];
function showPolicies() {
  for (const name of demo.policies()) {
    const row = document.createElement('div');
    const bar = document.createElement('i');
    row.append(name, bar);
    at('weights').append(row);
    bars.push(bar);
  }
}
function showWeights() {
  demo.weights().forEach((weight, index) => {
    bars[index].style.width = `${Math.round(100 * Math.max(0, Math.min(1, weight)))}%`;
  });
}

/** Kept from visit to visit, where the browser allows it. */
function kept(name, value) {
  try {
    if (value === undefined) return JSON.parse(localStorage.getItem(`policy-space.${name}`));
    localStorage.setItem(`policy-space.${name}`, JSON.stringify(value));
  } catch { /* a browser that keeps nothing */ }
  return null;
}

let counted = false;
function showCourse() {
  const [secs, falls] = demo.finished();
  let best = kept('best');
  // A replay is nobody's own time.
  if (secs !== undefined && !counted && demo.mode() === 'recording') {
    counted = true;
    if (!(best?.secs <= secs)) {
      best = { secs, falls };
      kept('best', best);
      note(`The best time so far: ${secs.toFixed(1)} s.`);
    }
  }
  if (secs === undefined) counted = false;
  const course = demo.course();
  at('course').textContent = course && best?.secs ? `${course} (best ${best.secs.toFixed(1)} s)` : course;
}

const prompts = [
  ['Walk with W A S D or the left stick', ([x, y]) => Math.hypot(x, y) > 0.5],
  ['Run with Shift or the right trigger', ([x, y, , , , fast]) => Math.hypot(x, y) > 0.5 && fast > 0.5],
  ['Crouch with C or the left trigger', ([, , , , low]) => low > 0.5],
  ['Roll with E', (_, bits) => bits & 2],
  ['Fall and get up with Q', (_, bits) => bits & 16],
];
function showPrompts() {
  if (kept('first steps')) return;
  for (const [text] of prompts) at('prompts').append(Object.assign(document.createElement('li'), { textContent: text }));
  at('prompts').hidden = false;
}
function tickPrompts() {
  if (at('prompts').hidden || demo.mode() !== 'recording') return;
  const [now, bits] = input;
  const rows = [...at('prompts').children];
  rows.forEach((row, index) => { if (prompts[index][1](now, bits)) row.className = 'done'; });
  if (rows.every((row) => row.className)) {
    kept('first steps', true);
    setTimeout(() => { at('prompts').hidden = true; }, 2000);
  }
}

// A slow machine draws coarser shadows and meshes, then fewer pixels, down to half as many along each side.
let drawScale = 1;
let drawsCheaply = false;
function drawLess() {
  if (!drawsCheaply) { drawsCheaply = true; demo.draw_cheaply(); } else if (drawScale > 0.5) { drawScale -= 0.25; fit(); }
}
function fit() {
  const ratio = Math.min(devicePixelRatio || 1, 2) * drawScale;
  canvas.width = Math.max(1, Math.round(innerWidth * ratio));
  canvas.height = Math.max(1, Math.round(innerHeight * ratio));
  demo?.resize(canvas.width, canvas.height);
}
addEventListener('resize', fit);

// ---- Keyboard, mouse, touch, pads

const held = new Set();
/** Keys that went down since the last frame: a tap between two frames of a slow machine counts. */
const tapped = new Set();
addEventListener('keydown', (event) => {
  if (event.ctrlKey || event.metaKey || event.altKey) return;
  held.add(event.code);
  tapped.add(event.code);
  if (event.code.startsWith('Arrow') || event.code === 'Space') event.preventDefault();
  if (event.code === 'KeyR' && !event.repeat) restart(false);
});
addEventListener('keyup', (event) => held.delete(event.code));
addEventListener('blur', () => held.clear());

const keyBits = { Space: 1, KeyE: 2, KeyQ: 16, KeyZ: 32 };
const touch = { left: [0, 0], right: [0, 0], run: 0, low: 0, bits: 0 };
const padBits = [[0, 1], [1, 2], [3, 4], [2, 8], [4, 16], [5, 32]];
const dead = (value) => (Math.abs(value) < 0.12 ? 0 : value);
const device = () => Array.from(navigator.getGamepads?.() ?? []).find((found) => found?.connected && found.mapping === 'standard');
let keyStick = [0, 0];

function pad() {
  const any = (...codes) => (codes.some((code) => held.has(code)) ? 1 : 0);
  const want = [any('KeyD', 'ArrowRight') - any('KeyA', 'ArrowLeft'), any('KeyW', 'ArrowUp') - any('KeyS', 'ArrowDown')];
  const length = Math.max(1, Math.hypot(...want));
  // A key is all or nothing; the stick that it stands for moves there in a fifth of a second or so.
  keyStick = keyStick.map((value, i) => value + Math.max(-0.12, Math.min(0.12, want[i] / length - value)));
  let [lx, ly] = keyStick.map((value) => (Math.abs(value) < 0.01 ? 0 : value));
  let [rx, ry] = touch.right;
  let low = Math.max(any('KeyC'), touch.low);
  let fast = Math.max(any('ShiftLeft', 'ShiftRight'), touch.run);
  if (touch.left[0] || touch.left[1]) [lx, ly] = touch.left;
  const found = device();
  if (found) {
    const [x, y, cx, cy] = found.axes.map(dead);
    if (x || y) [lx, ly] = [x, -y];
    if (cx || cy) [rx, ry] = [cx, -cy];
    low = Math.max(low, found.buttons[6]?.value ?? 0);
    fast = Math.max(fast, found.buttons[7]?.value ?? 0);
  }
  return new Float32Array([lx, ly, rx, -ry, low, fast]);
}

function buttons() {
  let bits = touch.bits;
  for (const [code, bit] of Object.entries(keyBits)) if (held.has(code) || tapped.has(code)) bits |= bit;
  const found = device();
  if (found) for (const [index, bit] of padBits) if (found.buttons[index]?.pressed) bits |= bit;
  return bits;
}

canvas.addEventListener('pointerdown', (event) => { if (event.pointerType === 'mouse') canvas.setPointerCapture(event.pointerId); canvas.focus(); });
canvas.addEventListener('pointermove', (event) => {
  if (event.pointerType === 'mouse' && event.buttons && demo) demo.turn(event.movementX * 0.006, event.movementY * 0.006);
});
canvas.addEventListener('wheel', (event) => { event.preventDefault(); demo?.zoom(2 ** (event.deltaY / 800)); }, { passive: false });
addEventListener('touchstart', () => { at('touch').hidden = !demo; }, { passive: true });

for (const side of ['left', 'right']) {
  const stick = at(`stick-${side}`);
  const knob = stick.firstElementChild;
  const move = (event) => {
    const box = stick.getBoundingClientRect();
    let [x, y] = [(event.clientX - box.left) / box.width * 2 - 1, 1 - (event.clientY - box.top) / box.height * 2];
    const length = Math.max(1, Math.hypot(x, y));
    [x, y] = [x / length, y / length];
    touch[side] = [x, y];
    knob.style.transform = `translate(${x * 40}px, ${-y * 40}px)`;
  };
  const end = () => { touch[side] = [0, 0]; knob.style.transform = ''; };
  stick.addEventListener('pointerdown', (event) => { stick.setPointerCapture(event.pointerId); move(event); });
  stick.addEventListener('pointermove', (event) => { if (stick.hasPointerCapture(event.pointerId)) move(event); });
  stick.addEventListener('pointerup', end);
  stick.addEventListener('pointercancel', end);
}
for (const button of document.querySelectorAll('#pads button')) {
  const set = (on) => {
    const { hold, bit } = button.dataset;
    if (hold) touch[hold] = on ? 1 : 0;
    else touch.bits = on ? touch.bits | Number(bit) : touch.bits & ~Number(bit);
  };
  button.addEventListener('pointerdown', (event) => { button.setPointerCapture(event.pointerId); set(true); });
  button.addEventListener('pointerup', () => set(false));
  button.addEventListener('pointercancel', () => set(false));
}

// ---- Buttons of the page

function restart(script) { attempt(() => demo?.restart(script)); canvas.focus(); }
at('restart').onclick = () => restart(false);
at('script').onclick = () => restart(true);
at('help').onclick = () => { at('keys').hidden = !at('keys').hidden; canvas.focus(); };
at('full').onclick = async () => {
  try { await (document.fullscreenElement ? document.exitFullscreen() : document.documentElement.requestFullscreen()); } catch (error) { note(String(error.message ?? error)); }
  canvas.focus();
};
at('copy').onclick = async () => {
  const link = attempt(() => demo.link());
  if (!link) return;
  const url = new URL(location.href);
  url.search = '';
  url.hash = `replay=${link}`;
  try { await navigator.clipboard.writeText(url.href); note('The link is in the clipboard.'); } catch { location.hash = url.hash; note('The link is in the address bar.'); }
  canvas.focus();
};
at('save').onclick = () => {
  const bytes = attempt(() => demo.replay_file());
  if (!bytes) return;
  const link = Object.assign(document.createElement('a'), { href: URL.createObjectURL(new Blob([bytes])), download: 'policy-space.replay' });
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 1000);
  canvas.focus();
};
addEventListener('hashchange', playFragment);
addEventListener('dragover', (event) => event.preventDefault());
addEventListener('drop', async (event) => {
  event.preventDefault();
  const file = event.dataTransfer?.files[0];
  if (!file || !demo) return;
  if (file.size > (8 << 20)) return note(`Expected a replay of at most 8388608 bytes, found ${file.size}.`);
  const bytes = new Uint8Array(await file.arrayBuffer());
  attempt(() => { demo.play_file(bytes); note(`Playing ${file.name}.`); });
});

// ---- For checks

window.policySpace = () => (demo && !told.error
  ? { ...told, ticks: demo.ticks(), hash: demo.hash(), mode: demo.mode(), doing: demo.doing(), memory: (performance.memory?.usedJSHeapSize ?? 0) + exports.memory.buffer.byteLength }
  : { ...told, ticks: 0 });
window.policySpacePicture = () => {
  const copy = Object.assign(document.createElement('canvas'), { width: canvas.width, height: canvas.height });
  const pixels = copy.getContext('2d');
  demo.draw();
  pixels.drawImage(canvas, 0, 0);
  const colours = new Set(new Uint32Array(pixels.getImageData(0, 0, copy.width, copy.height).data.buffer)).size;
  return { colours, png: copy.toDataURL('image/png').split(',')[1] };
};
window.policySpaceLink = () => demo.link();

addEventListener('error', (event) => problem(`The page stopped: ${event.message}`));
addEventListener('unhandledrejection', (event) => problem(`The page stopped: ${event.reason?.message ?? event.reason}`));
start().catch((error) => problem(`The demo can't start: ${error.message ?? error}`));
