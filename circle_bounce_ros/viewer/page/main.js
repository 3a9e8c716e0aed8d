// Brings the parts together: what comes in, what is drawn of it, and which circle it is about.

import { bindControls } from './controls.js';
import { find, write } from './dom.js';
import { Picture } from './gl.js';
import { Link } from './link.js';
import { Looks } from './looks.js';
import { RemoteNode } from './node.js';
import { announce, showState, whatIsMissing } from './notices.js';
import { Overlay } from './overlay.js';
import { PlaybackSpeed } from './playback.js';
import { describeScene, showApproach, showContact, showReport, showSquares, showTime } from './panel.js';
import { EnergyPlot, drawSpeeds } from './plots.js';
import { fillScenes, hearRefusal, showScene } from './scenes.js';
import { Story } from './story.js';
import { View } from './view.js';
import { World } from './world.js';

const MOST_SAMPLES = 4000; // circles looked at for a histogram
const NUMBERS_PERIOD = 300; // ms
const DESCRIPTION_PERIOD = 3000; // ms: not more often than one can listen to it
const WATCH_PERIOD = 250; // ms
const CLICK_REACH = 14; // CSS pixels around a circle that still mean it

class App {
  constructor() {
    const changed = () => { this.isDirty = true; };
    const send = (message) => this.link.send(message);
    this.isDirty = true;
    this.world = new World();
    this.story = new Story();
    this.looks = new Looks(changed);
    this.view = new View([find('bodies'), find('overlay')], () => this.world.bounds(), changed);
    this.overlay = new Overlay(find('overlay'));
    this.energyPlot = new EnergyPlot(find('energy'));
    this.node = new RemoteNode(send);
    this.playback = new PlaybackSpeed(send);
    this.afterDraw = null; // for tests: called right after a frame has been drawn, while it can be read back
    this.pending = null; // the newest frame, not looked at yet
    this.received = 0; // its number
    this.drawTimes = []; // ms: of the last second
    this.frameArrived = -Infinity; // ms
    this.connected = false;
    this.faults = {}; // what could not be read, by kind of frame
    this.seen = { scene: -1, numbers: -Infinity, description: -Infinity }; // what the panel is about, and since when (ms)
    this.last = performance.now();
  }

  start() {
    try {
      this.picture = new Picture(find('bodies'));
    } catch (error) {
      showState({ state: 'no picture', title: 'This page cannot draw here', text: `${error.message}.` }, null);
      return;
    }
    find('bodies').addEventListener('webglcontextlost', (event) => event.preventDefault());
    find('bodies').addEventListener('webglcontextrestored', () => {
      this.picture.start();
      this.seen.scene = -1;
    });
    this.link = new Link({
      opened: () => this.onOpened(),
      closed: () => this.onClosed(),
      text: (message) => this.hear(message),
      frame: (frame) => this.receive(frame),
    });
    bindControls(this);
    requestAnimationFrame((now) => this.animate(now));
    window.setInterval(() => this.watch(), WATCH_PERIOD);
    window.addEventListener('pagehide', () => this.playback.endSlow());
    // What is hidden is not drawn, and it is the drawing that ends slow motion.
    document.addEventListener('visibilitychange', () => document.hidden && this.playback.endSlow());
  }

  // What comes in

  onOpened() {
    this.connected = true;
    this.frameArrived = performance.now();
    if (this.story.circle >= 0) this.link.send({ type: 'select', circle: this.story.circle });
  }

  onClosed() {
    this.connected = false;
    this.pending = null;
    this.received = 0;
    this.node.publishers = null;
    this.node.faults = {};
    this.playback.forget();
    this.watch();
  }

  receive(frame) {
    if (frame.kind === 'static') {
      this.read('static', () => this.world.setStatic(frame.buffer, frame.start));
      this.story.restart();
      this.watch();
    } else if (frame.kind === 'bodies') {
      this.pending = frame;
      this.received = frame.number;
      this.frameArrived = performance.now();
    }
  }

  hear(message) {
    if (message.type === 'hello') {
      this.node.topic = message.topic;
      fillScenes(message.scenes, this.node.values.scene);
    } else if (message.type === 'status') {
      this.node.publishers = message.publishers;
      this.node.faults = message.faults;
      this.watch();
    }
    if (message.type === 'diagnostics') this.hearReport(message);
    else if (message.type === 'contacts') this.story.hear(message);
    else if (message.type === 'answer') {
      const { to, done, text } = message;
      if (to === 'scene' && !done) hearRefusal(this.node.values.scene);
      if (to !== 'time_scale' || this.playback.hearAnswer(done)) announce(text, !done);
    }
  }

  hearReport(message) {
    const { values } = message;
    if (this.node.report(values)) {
      this.energyPlot.forget();
      showScene(values.scene);
    }
    this.energyPlot.add(performance.now() / 1000, Number(values['energy error']));
    this.playback.hear(Number(values.time_scale), performance.now());
    showReport(message, this.node.paused);
    this.watch();
  }

  // Returns what a reader of a kind of frame returns, or null, and then the page says why.
  read(kind, reader) {
    try {
      const result = reader();
      this.faults[kind] = null;
      return result;
    } catch (error) {
      this.faults[kind] = `${kind}: ${error.message}`;
      return null;
    }
  }

  watch() {
    const { connected, faults, node } = this;
    const silentFor = performance.now() - this.frameArrived;
    const [channel] = Object.keys(node.faults);
    const fault = faults.static ?? faults.bodies ?? (channel ? `${channel}: ${node.faults[channel]}` : null);
    showState(whatIsMissing({ connected, silentFor, fault, publishers: node.publishers, topic: node.topic }), node.paused);
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
    if (this.story.circle >= 0 && this.world.cloud) this.tellStory(now, passed, isNew);
    if (isNew || this.isDirty) this.draw(now, isNew);
    if (now - this.seen.numbers > NUMBERS_PERIOD) this.refreshNumbers(now);
  }

  takeFrame() {
    const frame = this.pending;
    this.pending = null;
    if (!frame) return false;
    const { world } = this;
    const goesOn = this.read('bodies', () => world.setBodies(frame.buffer, frame.start, frame.timeLength));
    this.watch();
    if (goesOn === null) return false;
    if (!goesOn) this.story.restart();
    if (this.seen.scene !== world.generation) this.lookAtScene();
    this.picture.setBodies(world, goesOn, this.looks.trail);
    return true;
  }

  // Once for each scene: what its circles and walls have to do with the picture.
  lookAtScene() {
    const { world } = this;
    this.seen.scene = world.generation;
    this.largest = world.largestRadius();
    this.picture.setStatic(world);
    this.picture.forget();
    this.looks.suit(world.count, world.locked.length);
    this.looks.measure(world.speeds(MOST_SAMPLES));
    this.story.restart();
    if (this.story.circle >= 0 && world.rowOf(this.story.circle) < 0) this.select(-1);
    this.view.fit();
    write('n-circles', world.count.toLocaleString('en'));
    write('n-static', `${world.locked.length.toLocaleString('en')}, ${world.walls.length.toLocaleString('en')}`);
  }

  tellStory(now, passed, isNew) {
    const { node, playback, story, world } = this;
    if (story.update(world, passed, node.paused).length) {
      showContact(story.last);
      playback.touched(now);
    }
    if (isNew) story.remember(world.seconds, this.looks.trail);
    if (isNew && find('follow').checked && story.now) this.view.follow(story.now);
    if (!find('slow').checked || !story.now) playback.endSlow();
    else if (!node.paused) playback.followContact(now, story.next);
    this.isDirty ||= isNew || story.freshness > 0;
  }

  draw(now, isNew) {
    this.isDirty = false;
    if (isNew) this.drawTimes.push(now);
    const { looks, playback, story, view, world } = this;
    const all = {
      camera: view.camera, ratio: view.ratio, look: looks.colours, mode: looks.mode, fastest: looks.fastest, trail: looks.trail,
      largest: this.largest, world, story, squares: find('squares').checked, untilNext: story.untilNext(playback.rate),
    };
    this.picture.draw(all);
    if (this.afterDraw) this.afterDraw(this);
    this.overlay.draw(all);
  }

  refreshNumbers(now) {
    const { looks, world } = this;
    this.seen.numbers = now;
    while (this.drawTimes.length && now - this.drawTimes[0] > 1000) this.drawTimes.shift();
    write('n-frames', String(this.drawTimes.length));
    write('n-time', world.cloud ? showTime(world.seconds) : '–');
    if (!world.cloud) return;
    const speeds = world.speeds(MOST_SAMPLES);
    looks.measure(speeds);
    showApproach(this.story);
    showSquares(this.overlay.corners);
    write('histogram-note', drawSpeeds(find('histogram'), speeds, looks.colours));
    write('energy-note', this.energyPlot.draw(looks.colours));
    if (now - this.seen.description > DESCRIPTION_PERIOD) {
      this.seen.description = now;
      describeScene(find('bodies'), world, this.story, this.node);
    }
  }

  // The selected circle

  selectAt(x, y) {
    if (!this.world.cloud) return;
    const { camera } = this.view;
    this.select(this.world.pick(...camera.toWorld(x, y), CLICK_REACH / camera.scale));
  }

  select(circle) {
    if (circle === this.story.circle) return;
    this.story.select(circle);
    this.link.send({ type: 'select', circle });
    if (circle < 0) {
      this.playback.endSlow();
      find('follow').checked = false;
    }
    showContact(null);
    this.story.update(this.world, 0, true);
    showApproach(this.story);
    this.isDirty = true;
  }

  selectNext(step) {
    const { world } = this;
    if (!world.count) return;
    const row = world.rowOf(this.story.circle);
    const first = step > 0 ? 0 : world.count - 1;
    this.select(world.get(row < 0 ? first : (row + step + world.count) % world.count, 'id'));
  }

  // Something that is about a circle was switched on.
  selectAny() {
    if (this.story.circle < 0) this.selectNext(1);
  }

  followSelected(on) {
    if (!on) {
      this.view.fit();
      return;
    }
    this.selectAny();
    const row = this.world.rowOf(this.story.circle);
    if (row >= 0) this.view.comeClose(this.world.circle(row));
  }
}

globalThis.bounce = new App();
globalThis.bounce.start();
