// ---- Keyboard, mouse, touch, pads

const held = new Set();
/** Keys that went down since the last frame: a tap between two frames of a slow machine counts. */
const tapped = new Set();
addEventListener('keydown', (event) => {
  if (event.ctrlKey || event.metaKey || event.altKey) return;
  // A control that has the focus keeps its keys.
  if (event.target.closest?.('input,select,button')) return;
  held.add(event.code);
  tapped.add(event.code);
  if (event.code.startsWith('Arrow') || event.code === 'Space') event.preventDefault();
  if (event.repeat) return;
  use(0);
  if (event.code === 'KeyR') restart(false);
  if (event.code === 'KeyP') pause(!paused);
});
addEventListener('keyup', (event) => held.delete(event.code));
addEventListener('blur', () => held.clear());

const keyBits = { Space: 1, KeyE: 2, KeyQ: 16, KeyZ: 32, KeyT: 64, KeyY: 128 };
const touch = { left: [0, 0], right: [0, 0], run: 0, low: 0, bits: 0 };
const padBits = [[0, 1], [1, 2], [3, 4], [2, 8], [4, 16], [5, 32], [12, 64], [13, 128]];
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
    if (x || y || found.buttons.some((button) => button.pressed)) use(2);
    if (x || y) [lx, ly] = [x, -y];
    if (cx || cy) [rx, ry] = [cx, -cy];
    low = Math.max(low, found.buttons[6]?.value ?? 0);
    fast = Math.max(fast, found.buttons[7]?.value ?? 0);
  }
  const turn = settings.sensitivity;
  return new Float32Array([lx, ly, rx * turn, -ry * turn, low, fast]);
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
  if (event.pointerType === 'mouse' && event.buttons && demo) demo.turn(event.movementX * 0.006 * settings.sensitivity, event.movementY * 0.006 * settings.sensitivity);
});
canvas.addEventListener('wheel', (event) => { event.preventDefault(); demo?.zoom(2 ** (event.deltaY / 800)); }, { passive: false });
addEventListener('touchstart', () => { at('touch').hidden = !demo; use(1); }, { passive: true });

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

