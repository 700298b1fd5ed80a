// SPDX-License-Identifier: MIT
// Ways to strike: keys on the screen, the computer's keys, MIDI.

// By their places, which other layouts than the American one give other letters.
const kComputerKeys = [..."AWSEDFTGYHUJKOLP"].map((letter) => `Key${letter}`);
const kOctaves = { KeyZ: -1, KeyX: 1 };
const kText = "textarea, input:not([type='range'], [type='checkbox'])"; // what takes letters itself
const kSoftest = 0.3; // velocity at the far end of a key
const kBlack = new Set([1, 3, 6, 8, 10]);
const kNames = ["C", "C♯", "D", "E♭", "E", "F", "F♯", "G", "A♭", "A", "B♭", "B"];

/** The name of a key, as C4. */
export const keyName = (key) => `${kNames[key % 12]}${Math.floor(key / 12) - 1}`;

export class Keys {
  /** strike(key, velocity 0 to 1, or null where it has none), release(key); midi(bytes) of a message; moved() after an
   * octave. */
  constructor(element, { strike, release, midi, moved }) {
    Object.assign(this, { element, strike, release, midi, moved, first: 60, focused: 60, hasLetters: true, held: new Map() });
    this.build();
    new ResizeObserver(() => this.build()).observe(element);
    this.listenToPointers();
    this.listenToComputerKeys();
  }

  octaves() {
    return this.element.clientWidth > 900 ? 3 : this.element.clientWidth > 560 ? 2 : 1;
  }

  shift(octaves) {
    this.goTo(this.first + 12 * octaves);
    this.moved();
  }

  /** Shows the octave that begins with this C. */
  goTo(first) {
    this.first = Math.max(24, Math.min(96, first));
    this.built = null;
    this.build();
  }

  build() {
    const octaves = this.octaves();
    if (this.built === octaves) return;
    this.built = octaves;
    const begin = Math.max(24, Math.min(this.first - (octaves > 1 ? 12 : 0), 108 - 12 * octaves));
    const end = begin + 12 * octaves;
    if (this.focused < begin || this.focused > end) this.focused = Math.min(this.first, end);
    const white = 7 * octaves + 1;
    let place = 0;
    this.element.replaceChildren();
    for (let key = begin; key <= end; ++key) {
      const button = document.createElement("button");
      const isBlack = kBlack.has(key % 12);
      button.dataset.key = key;
      button.className = isBlack ? "black" : "white";
      button.setAttribute("aria-label", keyName(key));
      button.tabIndex = key === this.focused ? 0 : -1;
      const size = 100 / white;
      button.style.width = `${isBlack ? size * 0.62 : size}%`;
      button.style.left = `${isBlack ? place * size - size * 0.31 : place * size}%`;
      if (key % 12 === 0) button.textContent = keyName(key);
      if (!isBlack) ++place;
      this.element.append(button);
    }
  }

  press(key, velocity, by) {
    if (this.held.has(by)) this.lift(by);
    this.held.set(by, key);
    this.mark(key, true);
    this.strike(key, velocity);
  }

  lift(by) {
    const key = this.held.get(by);
    if (key === undefined) return;
    this.held.delete(by);
    this.mark(key, false);
    this.release(key);
  }

  mark(key, isDown) {
    this.element.querySelector(`[data-key="${key}"]`)?.classList.toggle("down", isDown);
  }

  unmark() {
    for (const key of this.element.querySelectorAll(".down")) key.classList.remove("down");
  }

  listenToPointers() {
    const { element } = this;
    const keyAt = (event) => {
      const button = document.elementFromPoint(event.clientX, event.clientY)?.closest("#keys button");
      return button ? Number(button.dataset.key) : null;
    };
    // Further towards the player a key is struck harder.
    const velocityAt = ({ clientX, clientY }) => {
      const { top, height } = document.elementFromPoint(clientX, clientY).getBoundingClientRect();
      return kSoftest + (1 - kSoftest) * Math.min(1, (1.2 * (clientY - top)) / height);
    };
    element.addEventListener("pointerdown", (event) => {
      const key = keyAt(event);
      if (key === null) return;
      event.preventDefault();
      element.setPointerCapture(event.pointerId);
      this.press(key, velocityAt(event), event.pointerId);
    });
    element.addEventListener("pointermove", (event) => {
      const key = keyAt(event);
      if (!this.held.has(event.pointerId) || key === null || key === this.held.get(event.pointerId)) return;
      this.press(key, velocityAt(event), event.pointerId);
    });
    for (const end of ["pointerup", "pointercancel"])
      element.addEventListener(end, (event) => this.lift(event.pointerId));
    element.addEventListener("keydown", (event) => {
      const button = event.target.closest("button");
      const step = { ArrowRight: 1, ArrowUp: 1, ArrowLeft: -1, ArrowDown: -1 }[event.key];
      if (step) {
        const next = element.querySelector(`[data-key="${Number(button.dataset.key) + step}"]`);
        next?.focus();
        event.preventDefault();
      }
      if ((event.key === "Enter" || event.key === " ") && !event.repeat) {
        this.press(Number(button.dataset.key), null, "focus");
        event.preventDefault();
      }
    });
    element.addEventListener("keyup", () => this.lift("focus"));
    element.addEventListener("focusin", ({ target }) => this.stay(target));
  }

  // Tab comes back to the key that had the focus.
  stay(button) {
    this.element.querySelector("[tabindex='0']").tabIndex = -1;
    button.tabIndex = 0;
    this.focused = Number(button.dataset.key);
  }

  // Everywhere but in text: a menu that has the focus must not take the letter for a search.
  listenToComputerKeys() {
    addEventListener("keydown", (event) => {
      if (!this.hasLetters || event.ctrlKey || event.metaKey || event.altKey || event.target.closest?.(kText)) return;
      const index = kComputerKeys.indexOf(event.code);
      const octaves = kOctaves[event.code];
      if (index < 0 && octaves === undefined) return;
      event.preventDefault();
      if (event.repeat) return;
      if (octaves) this.shift(octaves);
      else this.press(this.first + index, null, event.code);
    });
    addEventListener("keyup", ({ code }) => this.lift(code));
    addEventListener("blur", () => this.liftAll());
  }

  /** Lets all keys go. */
  liftAll() {
    [...this.held.keys()].forEach((by) => this.lift(by));
  }

  /** Listens to MIDI where there is some. Returns what to tell; a refusal is no error. */
  async listenToMidi() {
    if (!navigator.requestMIDIAccess) return "No MIDI in this browser.";
    let access;
    try {
      access = await navigator.requestMIDIAccess();
    } catch {
      return "MIDI was not allowed.";
    }
    const onMessage = ({ data }) => this.midi(data);
    const listen = () => access.inputs.forEach((input) => (input.onmidimessage = onMessage));
    access.onstatechange = listen;
    listen();
    return access.inputs.size > 0 ? `MIDI: ${[...access.inputs.values()].map((input) => input.name).join(", ")}.` : "MIDI: no device.";
  }
}
