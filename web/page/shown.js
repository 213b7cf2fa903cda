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

/** What to try first: with keys, on a touch screen, with a pad; and when it is done. */
const prompts = [
  [['Walk with W A S D', 'Walk with the left stick', 'Walk with the left stick'], ([x, y]) => Math.hypot(x, y) > 0.5],
  [['Run: hold Shift', 'Run: hold Run', 'Run: hold the right trigger'], ([x, y, , , , fast]) => Math.hypot(x, y) > 0.5 && fast > 0.5],
  [['Crouch: hold C', 'Crouch: hold Low', 'Crouch: hold the left trigger'], ([, , , , low]) => low > 0.5],
  [['Roll with E', 'Roll', 'Roll with the east button'], (_, bits) => bits & 2],
  [['Fall and get up with Q', 'Fall and get up: Shove', 'Fall and get up with the left shoulder'], (_, bits) => bits & 16],
  [['Throw a ball with T', 'Throw a ball: Throw', 'Throw a ball with d-pad up'], (_, bits) => bits & 64],
];
/** 0 keys, 1 touch screen, 2 pad: what was used last. */
let used = matchMedia('(pointer: coarse)').matches ? 1 : 0;
function use(way) {
  if (way === used) return;
  used = way;
  [...at('prompts').children].forEach((row, index) => { row.textContent = prompts[index][0][used]; });
}
function showPrompts() {
  if (kept('first steps')) return;
  for (const [text] of prompts) at('prompts').append(Object.assign(document.createElement('li'), { textContent: text[used] }));
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

let lastBits = 0;
/** A key that does nothing looks broken. */
function tellThrown() {
  const pressed = input[1] & ~lastBits;
  lastBits = input[1];
  if (demo.mode() !== 'recording') return;
  if (pressed & 64 && demo.left(true) === 0) note('No ball is left. Restart brings them back.');
  if (pressed & 128 && demo.left(false) === 0) note('Nothing is left to put down. Restart brings it back.');
}

/** How much of a replay there still is. */
function showReplay() {
  const secs = demo.replay_left();
  at('replay').hidden = secs === undefined;
  if (secs !== undefined) at('replay').textContent = `Replay: ${secs.toFixed(0)} s left`;
}

// A slow machine draws coarser shadows and meshes, then fewer pixels, down to half as many along each side.
let drawScale = 1;
let drawsCheaply = false;
function drawLess() {
  if (kept('picture') === 'full') return;
  if (!drawsCheaply) { drawsCheaply = true; demo.draw_cheaply(true); } else if (drawScale > 0.5) { drawScale -= 0.25; fit(); }
}
function fit() {
  const ratio = Math.min(devicePixelRatio || 1, 2) * drawScale;
  canvas.width = Math.max(1, Math.round(innerWidth * ratio));
  canvas.height = Math.max(1, Math.round(innerHeight * ratio));
  demo?.resize(canvas.width, canvas.height);
}
addEventListener('resize', fit);

