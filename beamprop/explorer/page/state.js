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
      return path in moved ? moved[path] : this.controls.get(path).value;
    }

    /** Move a value; `settle` ends a step of undo. */
    move(path, value, settle = true) {
      const moved = { ...this.slots[this.active] };
      if (value === this.controls.get(path).value) delete moved[path];
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

  /** The value at a position of a slider: few digits, whole where it is a count. */
  function at(control, position) {
    const t = position / steps(control), { low, high } = control;
    if (position === 0) return low;
    const value = control.ratio ? low * (high / low) ** t : low + (high - low) * t;
    if (control.kind === "count") return Math.round(value);
    const step = 10 ** Math.floor(Math.log10(control.ratio ? value / 50 : (high - low) / 100));
    return Number((Math.round(value / step) * step).toPrecision(12));
  }

  /** How many positions a slider has: of a count that does not run by ratios, as many as there are values. */
  function steps(control) {
    return control.kind === "count" && !control.ratio && control.high - control.low < POSITIONS ? control.high - control.low : POSITIONS;
  }

  /** Where on the slider a value is. */
  function position(control, value) {
    const { low, high } = control, clipped = Math.min(high, Math.max(low, value));
    const t = control.ratio ? Math.log(clipped / low) / Math.log(high / low) : (clipped - low) / (high - low);
    return Math.round(t * steps(control));
  }

  return { State, valueOf, at, steps, position };
})();
