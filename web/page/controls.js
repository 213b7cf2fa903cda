// ---- Buttons of the page

function restart(script) {
  attempt(() => demo?.restart(script));
  showReplay();
  canvas.focus();
}
at('restart').onclick = () => restart(false);
at('script').onclick = () => restart(true);
at('pause').onclick = () => { pause(!paused); canvas.focus(); };
/** One of the two at a time. */
function toggle(name) {
  for (const panel of ['keys', 'settings']) at(panel).hidden = panel !== name || !at(panel).hidden;
}
at('help').onclick = () => { toggle('keys'); canvas.focus(); };
at('set').onclick = () => toggle('settings');

// ---- Settings

const settings = { sensitivity: Math.min(3, Math.max(0.2, Number(kept('sensitivity')) || 1)) };
at('sensitivity').value = settings.sensitivity;
at('sensitivity').oninput = () => {
  settings.sensitivity = Number(at('sensitivity').value);
  kept('sensitivity', settings.sensitivity);
};
at('picture').value = ['full', 'coarse'].includes(kept('picture')) ? kept('picture') : 'auto';
at('picture').onchange = () => {
  const chosen = at('picture').value;
  kept('picture', chosen);
  if (chosen === 'coarse') drawLess();
  else {
    [drawScale, drawsCheaply] = [1, demo.is_software()];
    demo.draw_cheaply(drawsCheaply);
    fit();
  }
  canvas.focus();
};
at('again').onclick = () => {
  kept('first steps', false);
  at('prompts').replaceChildren();
  showPrompts();
  canvas.focus();
};

// ---- Full screen, links, files

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
  try { await navigator.clipboard.writeText(url.href); note('The link is in the clipboard.'); } catch { history.replaceState(null, '', url.href); note('The link is in the address bar.'); }
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
  ? { ...told, pad: [...input[0]], bits: input[1], ticks: demo.ticks(), hash: demo.hash(), mode: demo.mode(), doing: demo.doing(), memory: (performance.memory?.usedJSHeapSize ?? 0) + exports.memory.buffer.byteLength }
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
