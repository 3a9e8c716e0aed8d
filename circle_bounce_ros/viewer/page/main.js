// Brings it all together: what comes in, what is drawn, what the buttons say.

import { Camera, clamp } from './camera.js';
import { IDENTITY, LOOKS, SPEED_RAMP } from './colours.js';
import { Picture } from './gl.js';
import { Keyboard } from './keyboard.js';
import { Link } from './link.js';
import { Overlay } from './overlay.js';
import { find, showApproach, showContact, showDiagnostics, showSquares, showTime, write } from './panel.js';
import { EnergyPlot, drawSpeeds } from './plots.js';
import { Story } from './story.js';
import { World } from './world.js';

const SPEEDS = [0.01, 0.02, 0.05, 0.1, 0.25, 0.5, 1, 2, 4, 8, 16, 32];
const FEW_TRAILS = 64; // circles whose trails can be told apart
const OWN = '…'; // the entry of the chooser for a file
const FEW = 8; // circles that are told apart by colour rather than by speed
const MOST_SAMPLES = 4000; // circles looked at for a histogram
const SILENCE = 2000; // ms after which there is something to be said
const PLOT_PERIOD = 300; // ms
const SLOWDOWN = 0.12; // of the speed chosen
const SLOW_BEFORE = 0.3; // s of the wall, before a contact
const SLOW_AFTER = 1200; // ms of the wall, after one
const CALM = window.matchMedia('(prefers-reduced-motion: reduce)');

class App {
  constructor() {
    this.world = new World();
    this.story = new Story();
    this.camera = new Camera();
    this.canvas = find('bodies');
    this.overlay = new Overlay(find('overlay'));
    this.energyPlot = new EnergyPlot(find('energy'));
    this.afterDraw = null; // for tests: called right after a frame has been drawn, while it can be read back
    this.pending = null;
    this.received = 0;
    this.drawTimes = [];
    this.path = [];
    this.frameArrived = -Infinity;
    this.lookedAt = { scene: -1 };
    this.fastest = 1;
    this.largest = 0;
    this.trail = 0;
    this.mode = null; // what the user chose, else what suits the scene
    this.timeScale = 1;
    this.isSlow = false;
    this.slowUntil = 0;
    this.quiet = 0; // answers not to be announced
    this.connected = false;
    this.publishers = null;
    this.values = {};
    this.isDirty = true;
    this.last = performance.now();
    this.plotted = 0;
  }

  start() {
    this.chooseTheme(localStorage.getItem('theme') ?? (window.matchMedia('(prefers-color-scheme: light)').matches ? 'light' : 'dark'));
    try {
      this.picture = new Picture(this.canvas);
    } catch (error) {
      this.notice('This page cannot draw here', `${error.message}.`);
      return;
    }
    this.canvas.addEventListener('webglcontextlost', (event) => event.preventDefault());
    this.canvas.addEventListener('webglcontextrestored', () => {
      this.picture.start();
      this.lookedAt.scene = -1;
    });
    new ResizeObserver(() => this.resize()).observe(find('stage'));
    this.resize();
    this.bindPointer();
    this.bindControls();
    this.link = new Link({
      opened: () => {
        this.connected = true;
        this.frameArrived = performance.now();
        if (this.story.circle >= 0) this.link.send({ type: 'select', circle: this.story.circle });
      },
      closed: () => {
        this.connected = false;
        this.publishers = null;
        this.received = 0;
        this.pending = null;
      },
      text: (message) => this.hear(message),
      frame: (frame) => this.receive(frame),
    });
    requestAnimationFrame((now) => this.animate(now));
    window.setInterval(() => this.checkSilence(), 250);
    window.addEventListener('pagehide', () => this.endSlowMotion());
  }

  // What comes in

  receive(frame) {
    try {
      if (frame.kind === 'static') {
        this.world.setStatic(frame.buffer, frame.start);
        this.story.restart();
      } else if (frame.kind === 'bodies') {
        this.pending = frame;
        this.received = frame.number;
        this.frameArrived = performance.now();
      }
    } catch (error) {
      this.notice('What is published cannot be read', error.message);
    }
    this.isDirty = true;
  }

  hear(message) {
    if (message.type === 'hello') this.greet(message);
    else if (message.type === 'status') this.publishers = message.publishers;
    else if (message.type === 'diagnostics') this.hearDiagnostics(message);
    else if (message.type === 'contacts') this.story.hear(message);
    else if (message.type === 'answer') this.hearAnswer(message);
  }

  greet({ node, topic, scenes }) {
    this.node = node;
    this.topic = topic;
    const chooser = find('scene');
    const chosen = chooser.value;
    chooser.replaceChildren(...scenes.map((name) => new Option(name.replaceAll('_', ' '), name)), new Option('a file …', OWN));
    chooser.value = chosen || this.values.scene || 'lesson';
  }

  hearDiagnostics(message) {
    const { values } = message;
    const isOther = values.scene !== this.values.scene || values.seed !== this.values.seed;
    this.values = values;
    this.paused = values.paused === 'true';
    showDiagnostics(message);
    if (isOther) {
      this.energyPlot.forget();
      const names = [...find('scene').options].map((option) => option.value);
      find('scene').value = names.includes(values.scene) ? values.scene : OWN;
      find('own-field').hidden = find('scene').value !== OWN;
    }
    this.energyPlot.add(performance.now() / 1000, Number(values['energy error']));
    if (!this.isSlow && this.quiet === 0) this.timeScale = Number(values.time_scale);
    this.showSpeed();
    const words = this.paused ? 'Go on' : 'Pause';
    find('pause').querySelector('span').textContent = words;
    find('pause-icon').setAttribute('d', this.paused ? 'M4 2l10 6-10 6z' : 'M3 2h4v12H3zM9 2h4v12H9z');
  }

  hearAnswer({ to, done, text }) {
    if (to === 'time_scale' && this.quiet > 0) {
      this.quiet -= 1;
      if (done) return;
    }
    this.announce(text, !done);
  }

  announce(text, isRefusal) {
    const answer = find('answer');
    answer.textContent = isRefusal ? `Refused: ${text}` : text;
    answer.className = isRefusal ? 'shown refused' : 'shown';
    window.clearTimeout(this.answerTimer);
    this.answerTimer = window.setTimeout(() => { answer.className = answer.className.replace('shown', ''); }, isRefusal ? 9000 : 3500);
  }

  ask(message) {
    if (!this.link.send(message)) this.announce('no connection to the viewer', true);
  }

  // Drawing

  animate(now) {
    requestAnimationFrame((then) => this.animate(then));
    const passed = now - this.last;
    this.last = now;
    const { pending } = this;
    try {
      this.show(now, passed);
    } finally {
      // Only now: what is sent next is then as new as it can be when it is drawn, however long this took.
      if (pending) this.link.send({ type: 'ack', frame: pending.number });
    }
  }

  show(now, passed) {
    const isNew = this.takeFrame();
    if (this.story.circle >= 0 && this.world.cloud) {
      const come = this.story.update(this.world, passed, this.paused);
      if (come.length) this.onContacts(now);
      if (isNew) this.follow();
      this.slowMotion(now);
      this.isDirty ||= isNew || this.story.freshness > 0;
    }
    if (isNew || this.isDirty) this.draw(now, isNew);
    if (now - this.plotted > PLOT_PERIOD) {
      this.plotted = now;
      this.refreshNumbers(now);
    }
  }

  takeFrame() {
    const frame = this.pending;
    if (!frame) return false;
    this.pending = null;
    try {
      const goesOn = this.world.setBodies(frame.buffer, frame.start, frame.timeLength);
      if (!goesOn) {
        this.path = [];
        this.story.restart();
      }
      this.lookAtScene();
      this.picture.setBodies(this.world, goesOn, this.trail);
      this.hideNotice();
    } catch (error) {
      this.notice('What is published cannot be read', error.message);
      return false;
    }
    return true;
  }

  // Once for each scene: what its circles and walls have to do with the picture.
  lookAtScene() {
    const { world } = this;
    if (this.lookedAt.scene === world.generation) return;
    this.lookedAt.scene = world.generation;
    this.largest = world.largestRadius();
    this.measureSpeeds(true);
    this.picture.setStatic(world);
    this.picture.forget();
    this.path = [];
    if (!this.trailChosen) this.setTrail(null);
    if (this.story.circle >= 0 && world.rowOf(this.story.circle) < 0) this.select(-1);
    this.fit();
    this.showLegend();
    write('n-circles', world.count.toLocaleString('en'));
    write('n-static', `${world.locked.length.toLocaleString('en')}, ${world.walls.length.toLocaleString('en')}`);
  }

  measureSpeeds(anew) {
    this.speeds = this.world.speeds(MOST_SAMPLES);
    const sorted = [...this.speeds].sort((a, b) => a - b);
    const high = sorted.length ? Math.max(sorted[Math.floor(0.98 * (sorted.length - 1))], 0.25 * sorted[sorted.length - 1]) : 1;
    this.fastest = anew ? high || 1 : this.fastest + 0.1 * ((high || 1) - this.fastest);
  }

  draw(now, isNew) {
    this.isDirty = false;
    if (isNew) this.drawTimes.push(now);
    while (this.drawTimes.length && now - this.drawTimes[0] > 1000) this.drawTimes.shift();
    if (isNew && this.story.now && this.world.seconds !== null) {
      const { x, y } = this.story.now;
      this.path.push({ x, y, time: this.world.seconds });
      while (this.path.length && this.world.seconds - this.path[0].time > this.trail) this.path.shift();
    }
    const view = {
      camera: this.camera, ratio: this.ratio, look: this.look, mode: this.colourMode, fastest: this.fastest, largest: this.largest,
      trail: this.trail, world: this.world, story: this.story, path: this.path, squares: find('squares').checked, untilNext: this.untilNext,
    };
    this.picture.draw(view);
    if (this.afterDraw) this.afterDraw(this);
    this.overlay.draw(view);
  }

  // Milliseconds of the wall until the selected circle's next contact.
  get untilNext() {
    const { next } = this.story;
    const rate = this.isSlow ? this.timeScale * SLOWDOWN : this.timeScale;
    return next && rate ? (1000 * next.time) / rate : Infinity;
  }

  refreshNumbers(now) {
    while (this.drawTimes.length && now - this.drawTimes[0] > 1000) this.drawTimes.shift();
    write('n-frames', String(this.drawTimes.length));
    write('n-time', this.world.cloud ? showTime(this.world.seconds) : '–');
    if (!this.world.cloud) return;
    showApproach(this.story);
    showSquares(this.overlay.corners);
    this.measureSpeeds(false);
    if (this.colourMode === 'speed') write('legend-high', `${this.fastest.toPrecision(2)} m/s`);
    write('histogram-note', drawSpeeds(find('histogram'), this.speeds, this.look));
    write('energy-note', this.energyPlot.draw(this.look));
    this.describe(now);
  }

  // For those who do not see the picture, not more often than one can listen to it.
  describe(now) {
    if (now - (this.described ?? -Infinity) < 3000) return;
    this.described = now;
    const { world, values } = this;
    const own = this.story.now ? ` Circle ${this.story.circle} is selected, at ${this.story.now.x.toFixed(2)}, ${this.story.now.y.toFixed(2)} m.` : '';
    this.canvas.setAttribute('aria-label', `Scene ${values.scene ?? world.scene}: ${world.count} moving and ${world.locked.length} locked circles, ${world.walls.length} walls, ${this.paused ? 'paused' : 'running'}.${own} Arrow keys move the view, plus and minus zoom.`);
  }

  // Saying what is missing

  checkSilence() {
    const silent = performance.now() - this.frameArrived;
    if (!this.connected) {
      this.setState('no viewer');
      this.notice('No connection to the viewer', 'Is bounce_viewer running? Trying again every second.');
    } else if (silent > SILENCE) {
      this.setState('silent');
      const none = this.publishers === 0;
      this.notice('Nothing is published', none
        ? `Nobody publishes ${this.topic}. Start the node, for example with “make run”; this page goes on by itself.`
        : `${this.topic} is silent. The node may be waiting for /clock, or be very busy.`);
    }
  }

  setState(text) {
    write('state', text);
    find('state').dataset.state = 'missing';
    this.stateIsMissing = true;
  }

  notice(title, text) {
    write('notice-title', title);
    write('notice-text', text);
    find('notice').hidden = false;
  }

  hideNotice() {
    find('notice').hidden = true;
    if (this.stateIsMissing) {
      this.stateIsMissing = false;
      write('state', this.paused ? 'paused' : 'running');
      find('state').dataset.state = this.paused ? 'paused' : 'running';
    }
  }

  // The view

  resize() {
    const { clientWidth: width, clientHeight: height } = find('stage');
    this.ratio = Math.min(2, window.devicePixelRatio || 1);
    for (const canvas of [this.canvas, this.overlay.canvas]) {
      canvas.width = Math.round(width * this.ratio);
      canvas.height = Math.round(height * this.ratio);
    }
    const { fits } = this.camera;
    this.camera.resize(canvasWidth(this.canvas, this.ratio), this.canvas.height / this.ratio);
    if (fits) this.fit();
    this.isDirty = true;
  }

  fit() {
    find('follow').checked = false;
    this.camera.fit(this.world.bounds());
    this.isDirty = true;
  }

  move(right, down) {
    find('follow').checked = false;
    this.camera.pan(right, down);
    this.isDirty = true;
  }

  zoom(factor, px, py) {
    this.camera.zoom(factor, px, py);
    this.isDirty = true;
  }

  follow() {
    const { now } = this.story;
    if (!find('follow').checked || !now) return;
    this.camera.x = now.x;
    this.camera.y = now.y;
    this.camera.fits = false;
  }

  startFollowing(on) {
    find('follow').checked = on;
    if (!on) {
      this.fit();
      return;
    }
    if (this.story.circle < 0) this.selectNext(1);
    const row = this.world.rowOf(this.story.circle);
    if (row < 0) return;
    const size = Math.min(this.camera.width, this.camera.height);
    const wanted = (0.07 * size) / this.world.get(row, 'radius');
    if (wanted > this.camera.scale) this.zoom(wanted / this.camera.scale);
    this.follow();
  }

  bindPointer() {
    const { canvas } = this;
    const touches = new Map();
    let moved = 0;
    const place = (event) => {
      const box = canvas.getBoundingClientRect();
      return [event.clientX - box.left, event.clientY - box.top];
    };
    canvas.addEventListener('wheel', (event) => {
      event.preventDefault();
      this.zoom(Math.exp(-clamp(event.deltaY, -200, 200) * 0.0022), ...place(event));
    }, { passive: false });
    canvas.addEventListener('pointerdown', (event) => {
      canvas.setPointerCapture(event.pointerId);
      touches.set(event.pointerId, place(event));
      if (touches.size === 1) moved = 0;
    });
    canvas.addEventListener('pointermove', (event) => {
      const before = touches.get(event.pointerId);
      if (!before) return;
      const now = place(event);
      const step = [now[0] - before[0], now[1] - before[1]];
      moved += Math.hypot(...step);
      if (touches.size === 1) {
        if (moved > 4) this.move(...step);
      } else {
        const [other] = [...touches].filter(([id]) => id !== event.pointerId).map(([, at]) => at);
        const gap = (at) => Math.hypot(at[0] - other[0], at[1] - other[1]);
        this.zoom(gap(now) / Math.max(1, gap(before)), ...other);
      }
      touches.set(event.pointerId, now);
    });
    const lift = (event) => {
      if (touches.delete(event.pointerId) && !touches.size && moved <= 4 && event.type === 'pointerup') this.selectAt(place(event));
    };
    canvas.addEventListener('pointerup', lift);
    canvas.addEventListener('pointercancel', lift);
    canvas.addEventListener('dblclick', () => this.fit());
  }

  // The selected circle

  selectAt(place) {
    if (!this.world.cloud) return;
    this.select(this.world.pick(...this.camera.toWorld(...place), 14 / this.camera.scale));
  }

  select(circle) {
    if (circle === this.story.circle) return;
    this.story.select(circle);
    this.path = [];
    this.link.send({ type: 'select', circle });
    if (circle < 0) {
      this.endSlowMotion();
      find('follow').checked = false;
    }
    showContact(null);
    this.story.update(this.world, 0, true);
    showApproach(this.story);
    this.isDirty = true;
  }

  selectNext(step) {
    const { world } = this;
    if (!world.cloud || !world.count) return;
    const row = world.rowOf(this.story.circle);
    const next = row < 0 ? (step > 0 ? 0 : world.count - 1) : (row + step + world.count) % world.count;
    this.select(world.get(next, 'id'));
  }

  onContacts(now) {
    showContact(this.story.last);
    if (find('slow').checked) this.slowUntil = now + SLOW_AFTER;
  }

  slowMotion(now) {
    if (!find('slow').checked || !this.story.now) {
      this.endSlowMotion();
      return;
    }
    const { next } = this.story;
    const soon = next && next.time / this.timeScale < SLOW_BEFORE;
    const wanted = Boolean(soon || now < this.slowUntil);
    if (wanted === this.isSlow || this.quiet > 0 || this.paused) return;
    this.isSlow = wanted;
    this.sendTimeScale();
  }

  endSlowMotion() {
    if (!this.isSlow) return;
    this.isSlow = false;
    this.sendTimeScale();
  }

  sendTimeScale() {
    if (this.link.send({ type: 'time_scale', value: this.isSlow ? this.timeScale * SLOWDOWN : this.timeScale })) this.quiet += 1;
    this.showSpeed();
  }

  // Choices

  get colourMode() {
    return this.mode ?? (this.world.count <= FEW ? 'identity' : 'speed');
  }

  chooseColours(mode) {
    this.mode = mode;
    this.showLegend();
    this.isDirty = true;
  }

  showLegend() {
    const { colourMode } = this;
    document.querySelector(`input[name="colour"][value="${colourMode}"]`).checked = true;
    const bySpeed = colourMode === 'speed';
    write('legend-title', bySpeed ? 'speed' : 'each circle its own');
    const colours = bySpeed ? SPEED_RAMP : IDENTITY.slice(0, Math.max(1, this.world.count));
    const part = 100 / colours.length;
    find('legend-ramp').style.background = bySpeed
      ? `linear-gradient(90deg, ${colours.join(',')})`
      : `linear-gradient(90deg, ${colours.map((colour, i) => `${colour} ${i * part}% ${(i + 1) * part}%`).join(',')})`;
    write('legend-low', bySpeed ? '0' : '');
    write('legend-high', bySpeed ? `${this.fastest.toPrecision(2)} m/s` : this.world.count > IDENTITY.length ? 'colours repeat' : '');
    find('legend-locked').hidden = !this.world.locked.length;
  }

  chooseTheme(theme) {
    this.theme = theme;
    this.look = LOOKS[theme];
    document.documentElement.dataset.theme = theme;
    this.plotted = 0;
    this.isDirty = true;
  }

  switchTheme() {
    this.chooseTheme(this.theme === 'dark' ? 'light' : 'dark');
    localStorage.setItem('theme', this.theme);
  }

  // null: what suits the scene. Many trails tell nothing and cost much.
  setTrail(seconds) {
    this.trailChosen = seconds !== null;
    this.trail = Number(seconds ?? (CALM.matches || this.world.count > FEW_TRAILS ? 0 : 1));
    find('trails').value = String(this.trail);
    write('trails-value', this.trail ? `${this.trail} s` : 'off');
    if (!this.trail) this.path = [];
    this.isDirty = true;
  }

  setSpeed(index) {
    this.timeScale = SPEEDS[clamp(index, 0, SPEEDS.length - 1)];
    this.showSpeed();
    window.clearTimeout(this.speedTimer);
    this.speedTimer = window.setTimeout(() => {
      this.ask({ type: 'time_scale', value: this.isSlow ? this.timeScale * SLOWDOWN : this.timeScale });
    }, 80);
  }

  nearestSpeed() {
    const gap = (speed) => Math.abs(Math.log(speed / (this.timeScale || SPEEDS[0])));
    return SPEEDS.reduce((best, speed, i) => (gap(speed) < gap(SPEEDS[best]) ? i : best), 0);
  }

  showSpeed() {
    const slider = find('speed');
    if (document.activeElement !== slider) slider.value = String(this.nearestSpeed());
    const shown = this.timeScale === 0 ? 'as fast as possible' : `${this.timeScale} ×`;
    slider.setAttribute('aria-valuetext', shown);
    write('speed-value', this.isSlow ? `slow ${shown}` : shown);
  }

  load() {
    const own = find('scene').value === OWN;
    const scene = own ? find('own').value.trim() : find('scene').value;
    const seed = find('seed').value === '' ? -1 : Math.floor(Number(find('seed').value));
    if (!scene) {
      this.announce('which file? A path as the node sees it, ending in .yaml', true);
      find('own').focus();
      return;
    }
    this.mode = null;
    this.endSlowMotion();
    this.ask({ type: 'scene', scene, seed });
  }

  bindControls() {
    find('speed').max = String(SPEEDS.length - 1);
    const pause = () => this.ask({ type: 'pause', paused: !this.paused });
    const step = () => this.ask({ type: 'step' });
    const reset = () => this.ask({ type: 'reset' });
    const colours = () => this.chooseColours(this.colourMode === 'speed' ? 'identity' : 'speed');
    const flip = (id) => () => {
      find(id).checked = !find(id).checked;
      find(id).dispatchEvent(new Event('change'));
    };
    const trails = () => this.setTrail(this.trail >= 2 ? 0 : this.trail ? this.trail * 2 : 0.5);
    const help = () => (find('keys').open ? find('keys').close() : find('keys').showModal());
    const clicks = {
      pause, step, reset, help,
      theme: () => this.switchTheme(),
      fit: () => this.fit(),
      'zoom-in': () => this.zoom(1.3),
      'zoom-out': () => this.zoom(1 / 1.3),
      previous: () => this.selectNext(-1),
      next: () => this.selectNext(1),
      deselect: () => this.select(-1),
    };
    for (const [id, does] of Object.entries(clicks)) find(id).addEventListener('click', does);
    find('scene-form').addEventListener('submit', (event) => {
      event.preventDefault();
      this.load();
    });
    find('scene').addEventListener('change', () => {
      const own = find('scene').value === OWN;
      find('own-field').hidden = !own;
      if (own) find('own').focus();
      else this.load();
    });
    find('speed').addEventListener('input', () => this.setSpeed(Number(find('speed').value)));
    find('trails').addEventListener('input', () => this.setTrail(find('trails').value));
    find('slow').addEventListener('change', () => {
      if (find('slow').checked && this.story.circle < 0) this.selectNext(1);
    });
    find('follow').addEventListener('change', () => this.startFollowing(find('follow').checked));
    find('squares').addEventListener('change', () => { this.isDirty = true; });
    for (const radio of document.querySelectorAll('input[name="colour"]')) {
      radio.addEventListener('change', () => this.chooseColours(radio.value));
    }
    this.keyboard = new Keyboard({
      ' ': ['Stop and go on', pause, 'Space'],
      '.': ['While paused: one period further', step],
      r: ['From the first instant', reset],
      '[': ['Slower', () => this.setSpeed(this.nearestSpeed() - 1)],
      ']': ['Faster', () => this.setSpeed(this.nearestSpeed() + 1)],
      s: ['Choose a scene', () => find('scene').focus()],
      k: ['Next circle', () => this.selectNext(1)],
      j: ['Previous circle', () => this.selectNext(-1)],
      Escape: ['No circle', () => this.select(-1), 'Esc'],
      m: ['Slow motion into a contact', flip('slow')],
      z: ['Follow the selected circle', flip('follow')],
      b: ['Bounding squares', flip('squares')],
      t: ['Trails: longer, then off', trails],
      c: ['Colours by speed or by circle', colours],
      d: ['Dark or light', () => this.switchTheme()],
      f: ['All of the scene', () => this.fit()],
      '+': ['Closer', () => this.zoom(1.3)],
      '=': ['Closer', () => this.zoom(1.3), '='],
      '-': ['Further away', () => this.zoom(1 / 1.3), '−'],
      ArrowLeft: ['Move the view', () => this.move(60, 0), '←'],
      ArrowRight: ['Move the view', () => this.move(-60, 0), '→'],
      ArrowUp: ['Move the view', () => this.move(0, 60), '↑'],
      ArrowDown: ['Move the view', () => this.move(0, -60), '↓'],
      '?': ['These keys', help],
    });
    this.keyboard.list(find('key-list'));
    find('keys-on').addEventListener('change', () => { this.keyboard.isOn = find('keys-on').checked; });
    this.setTrail(null);
  }
}

function canvasWidth(canvas, ratio) {
  return canvas.width / ratio;
}

globalThis.bounce = new App();
globalThis.bounce.start();
