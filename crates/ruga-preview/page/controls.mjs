/** The panel: sliders of poses, views, light, keys of the keyboard. */

const element = (id) => document.getElementById(id);

/** Seconds that a pose takes on its way there and back while playing. */
const SECONDS_PER_POSE = 3;

/** Steps of the arrow keys: a turn of the camera (rad) and a factor of its distance. */
const TURN = 0.08;
const ZOOM = 1.08;

/** Connects the elements of the page with the picture. */
export class Controls {
  constructor(stage, preview) {
    this.stage = stage;
    this.preview = preview;
    this.sliders = preview.poses.map((pose, number) => this.addSlider(pose, number));
    this.playing = null;
    element('poses').hidden = preview.poses.length === 0;
    element('filter').hidden = preview.poses.length < 12;
    element('filter').addEventListener('input', () => this.filter());
    element('reset').addEventListener('click', () => this.reset());
    element('play').addEventListener('click', () => this.togglePlay());
    for (const radio of document.querySelectorAll('[name=view]')) {
      radio.addEventListener('change', () => this.setView(radio.value));
    }
    element('lines').addEventListener('change', (event) => this.setLines(event.target.checked));
    this.connect('strength', (value) => { stage.uniforms.strength.value = value; stage.redraw(); }, (value) => `${Math.round(100 * value)} %`);
    this.connect('light-turn', (value) => { stage.light.turn = value; stage.aimLight(); }, (value) => `${value}°`);
    this.connect('light-height', (value) => { stage.light.height = value; stage.aimLight(); }, (value) => `${value}°`);
    element('frame-focus').addEventListener('click', () => stage.frame('focus'));
    element('frame-whole').addEventListener('click', () => stage.frame('whole'));
    if (preview.about.plan) this.addPlan(preview.about.plan);
    this.dragLight();
    document.addEventListener('keydown', (event) => this.key(event));
  }

  addSlider(pose, number) {
    const row = element('pose-template').content.firstElementChild.cloneNode(true);
    const [label, output, input] = ['label', 'output', 'input'].map((name) => row.querySelector(name));
    label.textContent = pose.name;
    label.title = Object.entries(pose.weights).map(([shape, weight]) => `${shape} ${weight}`).join('\n');
    input.id = `pose${number}`;
    label.htmlFor = input.id;
    const slider = { row, input, show: () => { output.textContent = `${Math.round(100 * input.value)} %`; row.classList.toggle('on', input.value > 0); } };
    input.addEventListener('input', () => { this.stop(); this.apply(); });
    label.addEventListener('dblclick', () => { this.stop(); this.set(number, input.value > 0 ? 0 : 1); });
    element('pose-list').append(row);
    return slider;
  }

  /** A page of a plan: there is a view more and no map, and the colours have a legend. */
  addPlan({ layers, ramp, ends, colours, note }) {
    for (const id of ['view-map', 'strength-row']) element(id).hidden = true;
    element('view-plan').hidden = false;
    const css = ([red, green, blue]) => `rgb(${red} ${green} ${blue})`;
    const text = (words) => Object.assign(document.createElement('span'), { textContent: words });
    const bar = document.createElement('i');
    bar.style.background = `linear-gradient(90deg, ${ramp.map(css).join()})`;
    element('legend-ramp').append(text(ends[0]), bar, text(ends[1]));
    for (const [colour, words] of colours) {
      const row = document.createElement('li');
      const patch = document.createElement('i');
      patch.style.background = css(colour);
      row.append(patch, text(words));
      element('legend-colours').append(row);
    }
    element('legend-note').textContent = note;
    element('layer-row').hidden = layers.length < 2;
    element('layer').append(...layers.map((name, number) => new Option(name, number)));
    element('layer').addEventListener('change', (event) => this.stage.setLayer(Number(event.target.value)));
    element('notes').hidden = false;
    this.setView('plan');
  }

  /** What the plan says of the pose that is on, or was last. */
  showNotes() {
    const { plan, name } = this.preview.poses[this.stage.overlay.pose];
    const lines = plan.notes.length > 0 ? plan.notes : ['nothing wrinkles'];
    element('notes').textContent = [name, ...lines].join('\n');
  }

  /** Connects a range with what it changes and its number beside it. */
  connect(id, change, words) {
    const input = element(id);
    const apply = () => { change(Number(input.value)); element(`${id}-value`).textContent = words(Number(input.value)); };
    input.addEventListener('input', apply);
    input.addEventListener('dblclick', () => { input.value = input.defaultValue; apply(); });
    apply();
  }

  /** Sets one pose, a fraction from 0 to 1. */
  set(number, weight) {
    this.sliders[number].input.value = weight;
    return this.apply();
  }

  /** Takes what the sliders say. */
  async apply() {
    this.sliders.forEach((slider) => slider.show());
    const posed = this.stage.pose(this.sliders.map((slider) => Number(slider.input.value)));
    if (this.preview.about.plan && this.sliders.length > 0) this.showNotes();
    const fits = await posed;
    element('notice').hidden = fits;
    return fits;
  }

  reset() {
    this.stop();
    this.sliders.forEach((slider) => { slider.input.value = 0; });
    return this.apply();
  }

  filter() {
    const wanted = element('filter').value.toLowerCase();
    this.sliders.forEach(({ row }, number) => { row.hidden = !this.preview.poses[number].name.toLowerCase().includes(wanted); });
  }

  /** Shows the poses one after the other, there and back. */
  togglePlay() {
    if (this.playing !== null) { this.stop(); return; }
    const start = performance.now();
    const step = (now) => {
      const time = Math.max(now - start, 0) / 1000 / SECONDS_PER_POSE;
      const current = Math.floor(time) % this.sliders.length;
      const weight = 0.5 - 0.5 * Math.cos(2 * Math.PI * (time % 1));
      this.sliders.forEach(({ input }, number) => { input.value = number === current ? weight : 0; });
      this.apply();
      this.playing = requestAnimationFrame(step);
    };
    this.playing = requestAnimationFrame(step);
    element('play').textContent = 'Pause';
  }

  stop() {
    if (this.playing === null) return;
    cancelAnimationFrame(this.playing);
    this.playing = null;
    element('play').textContent = 'Play';
  }

  setView(view) {
    document.querySelector(`[name=view][value=${view}]`).checked = true;
    element('scale').hidden = view !== 'compression';
    element('legend').hidden = view !== 'plan';
    this.stage.setView(view);
  }

  setLines(visible) {
    element('lines').checked = visible;
    this.stage.lines.visible = visible;
    this.stage.redraw();
  }

  /** A drag with Shift held moves the light in place of the camera. */
  dragLight() {
    const { canvas, orbit, light } = this.stage;
    canvas.addEventListener('pointerdown', (event) => { orbit.enabled = !event.shiftKey; }, { capture: true });
    canvas.addEventListener('pointermove', (event) => {
      if (orbit.enabled || event.buttons === 0) return;
      const put = (id, value) => { element(id).value = value; element(id).dispatchEvent(new Event('input')); };
      put('light-turn', ((light.turn + event.movementX / 2 + 540) % 360) - 180);
      put('light-height', Math.min(90, Math.max(-90, light.height - event.movementY / 2)));
    });
    canvas.addEventListener('pointerup', () => { orbit.enabled = true; });
  }

  key(event) {
    if (event.ctrlKey || event.metaKey || event.altKey || event.target.type === 'search') return;
    const views = { 1: 'skin', 2: 'clay', 3: this.preview.about.plan ? 'plan' : 'map', 4: 'compression' };
    const general = {
      r: () => this.reset(),
      m: () => this.setLines(!this.stage.lines.visible),
      f: () => this.stage.frame('focus'),
      a: () => this.stage.frame('whole'),
      p: () => this.togglePlay(),
    };
    const camera = {
      ArrowLeft: () => this.stage.move(-TURN, 0, 1),
      ArrowRight: () => this.stage.move(TURN, 0, 1),
      ArrowUp: () => this.stage.move(0, -TURN, 1),
      ArrowDown: () => this.stage.move(0, TURN, 1),
      '+': () => this.stage.move(0, 0, 1 / ZOOM),
      '-': () => this.stage.move(0, 0, ZOOM),
    };
    const action = views[event.key] ? () => this.setView(views[event.key])
      : general[event.key] ?? (event.target === this.stage.canvas ? camera[event.key] : null);
    if (!action) return;
    action();
    event.preventDefault();
  }
}
