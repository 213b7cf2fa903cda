// ---- Clock

let last = null;
let frames = 0;
/** Pad and buttons of this frame. */
let input = [[], 0];
let frameStart = 0;
let paused = false;
let scheduled = 0;
/** One callback at a time, however often it is asked for. */
function schedule() { if (!scheduled) scheduled = requestAnimationFrame(frame); }

function frame(now) {
  scheduled = 0;
  if (document.hidden || told.error) { last = null; return; }
  // After a pause the clock begins anew, and so does the count of frames.
  if (last === null) [frames, frameStart] = [0, now];
  // At most three ticks a picture: a machine that can't keep up shows slow motion, not a row of stills.
  const secs = last === null || paused ? 0 : Math.min((now - last) / 1000, 0.1);
  last = now;
  advance(secs);
  if (told.error) return;
  const began = performance.now();
  const drawn = demo.draw();
  told.drawMs += 0.1 * (performance.now() - began - told.drawMs);
  if (drawn && told.firstFrameMs === null) firstPicture();
  tickPrompts();
  if (frames % 6 === 0) showWeights();
  frames += 1;
  if (now - frameStart > 1000) everySecond(now);
  schedule();
}

/** The time counts once the browser asks for the next picture: it has taken this one. */
function firstPicture() {
  step('drawn');
  told.firstFrameMs = 0;
  showControls();
  requestAnimationFrame(() => { step('first'); told.firstFrameMs = performance.now(); });
}

function advance(secs) {
  const began = performance.now();
  const mode = demo.mode();
  try {
    input = [pad(), buttons()];
    const ticks = demo.advance(secs, ...input);
    if (ticks > 0) {
      told.physicsMs += 0.1 * ((performance.now() - began) / ticks - told.physicsMs);
      tellThrown();
      tapped.clear();
    }
    if (mode !== demo.mode()) note(mode === 'playing' ? 'The replay is over: every state was the recorded one. Restart to play yourself.' : 'The script is over. Restart to play yourself.');
  } catch (error) {
    if (error instanceof WebAssembly.RuntimeError) return problem(`The demo stopped: ${error.message}. Reload the page to begin anew.`);
    note(mode === 'playing' ? `The replay stopped: ${error.message ?? error}. Restart to play yourself.` : String(error.message ?? error));
  }
}

function everySecond(now) {
  told.fps = frames * 1000 / (now - frameStart);
  [frames, frameStart] = [0, now];
  const lost = demo.lost();
  if (lost) return problem(`The graphics device was lost: ${lost}. Reload the page to begin anew.`);
  at('doing').textContent = demo.doing();
  showCourse();
  showReplay();
  if (told.fps < 24) drawLess();
  at('rate').textContent = `${told.fps.toFixed(0)} fps, physics ${told.physicsMs.toFixed(1)} ms a tick`;
}

function pause(on) {
  paused = on;
  at('pause').textContent = on ? 'Continue' : 'Pause';
  if (on) note('Paused. P continues.');
}
document.addEventListener('visibilitychange', () => {
  if (!document.hidden && demo && !told.error) { last = null; schedule(); }
});
