"use strict";
/* The state of the page: values that were moved, in two slots; undo, redo, and the link that restores it. */
const State = (() => {
  const POSITIONS = 400; // of a slider

  class State {
    /** controls: as the server lists them; changed: called after every change, with whether it has settled. */
    constructor(controls, changed) {
      this.controls = new Map(controls.map((c) => [c.path, c]));
      this.changed = changed;
      this.slots = { a: {}, b: null };
      this.active = "a";
      this.past = [];
      this.future = [];
      this.settled = this.text();
    }

    /** The value of a control in a slot. */
    value(path, slot = this.active) {
      const moved = this.slots[slot];
      return path in moved ? moved[path] : this.start(path, slot);
    }

    /** Where a control starts: the launch plane of slits that were chosen is in front of the slab. */
    start(path, slot = this.active) {
      const { value, slits } = this.controls.get(path);
      return slits !== null && this.slots[slot]["beam.source"] === "slits" ? slits : value;
    }

    /** Move a value; `settle` ends a step of undo. */
    move(path, value, settle = true) {
      const moved = { ...this.slots[this.active] };
      if (value === this.start(path)) delete moved[path];
      else moved[path] = value;
      this.slots = { ...this.slots, [this.active]: moved };
      this.done(settle);
    }

    /** Compare with a copy of the present state, or end that. */
    compare(on) {
      this.slots = { a: on ? this.slots.a : this.slots[this.active], b: on ? { ...this.slots.a } : null };
      this.active = on ? "b" : "a";
      this.done(true);
    }

    choose(slot) { this.active = slot; this.done(true); }

    reset() { this.slots = { ...this.slots, [this.active]: {} }; this.done(true); }

    done(settle) {
      if (settle && this.text() !== this.settled) {
        this.past.push(this.settled);
        this.future = [];
        this.settled = this.text();
      }
      this.changed(settle);
    }

    undo() { this.step(this.past, this.future); }
    redo() { this.step(this.future, this.past); }

    step(from, to) {
      if (!from.length) return;
      to.push(this.settled);
      this.settled = from.pop();
      this.read(this.settled);
      this.changed(true);
    }

    /** As the part of a link after #. */
    text() {
      const parts = new URLSearchParams();
      for (const slot of ["a", "b"]) for (const [path, v] of Object.entries(this.slots[slot] || {})) parts.append(slot === "a" ? path : `b:${path}`, String(v));
      if (this.slots.b) parts.append("sliders", this.active);
      return parts.toString();
    }

    /** Take the state of a link; what is no value of this study is left out, and returned. */
    read(text) {
      const slots = { a: {}, b: null }, unknown = [];
      let active = "a";
      for (const [key, said] of new URLSearchParams(text)) {
        if (key === "sliders") { slots.b = slots.b || {}; active = said === "b" ? "b" : "a"; continue; }
        const slot = key.startsWith("b:") ? "b" : "a", path = slot === "b" ? key.slice(2) : key;
        const value = this.controls.has(path) ? valueOf(this.controls.get(path), said) : undefined;
        if (value === undefined) unknown.push(key);
        else (slots[slot] = slots[slot] || {})[path] = value;
      }
      Object.assign(this, { slots, active });
      return unknown;
    }

    /** The state of a link that was opened. */
    open(text) {
      const unknown = this.read(text);
      this.done(true);
      return unknown;
    }
  }

  /** A value out of text, or undefined. */
  function valueOf(control, said) {
    if (control.kind === "switch") return { true: true, false: false }[said];
    if (control.kind === "word") return control.words.includes(said) ? said : undefined;
    const [upper, lower, more] = said.split("/").map((part) => (part.trim() === "" ? NaN : Number(part)));
    const value = more === undefined ? upper / (lower === undefined ? 1 : lower) : NaN;
    return isFinite(value) && (control.kind !== "count" || Number.isInteger(value)) ? value : undefined;
  }

  const lists = new Map(); // of controls

  /** The values of a slider in their order: each differs from the next, with the fewest digits; whole where they are counts. */
  function values(control) {
    if (!lists.has(control)) {
      const { low, high, ratio, kind } = control, list = [];
      const exact = (i) => (ratio ? low * (high / low) ** (i / POSITIONS) : low + ((high - low) * i) / POSITIONS);
      const whole = kind === "count" && !ratio && high - low < POSITIONS;
      for (let i = 0; i <= (whole ? high - low : POSITIONS); i++) {
        const v = whole ? low + i : exact(i), step = 10 ** Math.floor(Math.log10(Math.abs(exact(i + 1) - exact(i))));
        list.push(kind === "count" ? Math.round(v) : i === 0 || i === POSITIONS ? v : Number((Math.round(v / step) * step).toPrecision(12)));
      }
      lists.set(control, [...new Set(list)]);
    }
    return lists.get(control);
  }

  const at = (control, position) => values(control)[position];
  const steps = (control) => values(control).length - 1;

  /** Where on the slider a value is: the nearest of its values. */
  function position(control, value) {
    const near = (v) => Math.abs(v - value);
    return values(control).reduce((best, v, i, all) => (near(v) < near(all[best]) ? i : best), 0);
  }

  return { State, valueOf, at, steps, position };
})();
