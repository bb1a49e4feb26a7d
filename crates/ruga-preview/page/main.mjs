/** The preview page: reads what `ruga` has put into it, and shows it. */

import { Controls } from './controls.mjs';
import { readPreview } from './data.mjs';
import { Stage } from './stage.mjs';

/** Says on the page why there is nothing to see. */
function fail(reason) {
  const failure = document.getElementById('failure');
  failure.textContent = `This preview cannot be shown: ${reason}`;
  failure.hidden = false;
}

/** Loads, while nothing else is to do, the maps that no slider has asked for yet. */
function loadAhead({ slots }) {
  const later = window.requestIdleCallback ?? ((work) => setTimeout(work, 50));
  const next = async (map) => {
    if (map >= slots.about.maps.length || !slots.layers.includes(null)) return;
    await slots.load(map);
    later(() => next(map + 1));
  };
  later(() => next(0));
}

async function start() {
  const preview = readPreview();
  const stage = new Stage(document.getElementById('picture'), preview);
  const controls = new Controls(stage, preview);
  // For tests and for the console of the browser.
  window.ruga = { preview, stage, controls };
  if (preview.poses.length > 0) await controls.set(0, 1);
  document.body.dataset.ready = 'true';
  loadAhead(stage);
}

if (!document.createElement('canvas').getContext('webgl2')) {
  fail('this browser has no WebGL 2. Any browser of today has it; it may be switched off in its settings.');
} else {
  start().catch((error) => {
    fail(error.message);
    throw error;
  });
}
