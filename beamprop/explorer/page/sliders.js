"use strict";
/* The rows of the form: a slider, a choice or a switch for each value of the study, and a place to type it. */
const Sliders = (() => {
  const OPEN = new Set(["Beam", "Slab", "Part 1"]);
  const make = (tag, of = {}, ...inner) => {
    const node = Object.assign(document.createElement(tag), of);
    node.append(...inner);
    return node;
  };
  const idOf = (path) => `v-${path.replace(/\./g, "-")}`;

  class Sliders {
    constructor(form, state) {
      this.state = state;
      this.rows = new Map();
      const groups = new Map();
      for (const control of state.controls.values()) {
        if (!groups.has(control.group)) {
          const box = make("details", { open: OPEN.has(control.group) }, make("summary", { textContent: control.group }));
          groups.set(control.group, box);
          form.append(box);
        }
        groups.get(control.group).append(this.row(control));
      }
      form.addEventListener("submit", (e) => e.preventDefault());
    }

    row(control) {
      const id = idOf(control.path), row = make("div", { className: "row" }, make("label", { htmlFor: id, textContent: control.label }));
      const parts = { row };
      if (control.kind === "word") {
        parts.choice = make("select", { id }, ...control.words.map((w) => make("option", { value: w, textContent: w })));
        parts.choice.addEventListener("change", () => this.state.move(control.path, parts.choice.value));
        row.append(parts.choice);
      } else if (control.kind === "switch") {
        parts.check = make("input", { id, type: "checkbox" });
        parts.check.addEventListener("change", () => this.state.move(control.path, parts.check.checked));
        row.append(parts.check);
      } else this.number(control, parts, id);
      this.rows.set(control.path, parts);
      return row;
    }

    number(control, parts, id) {
      parts.typed = make("input", { id: `${id}-typed`, type: "text", inputMode: "decimal", spellcheck: false });
      parts.typed.setAttribute("aria-label", `${control.label}, typed`);
      parts.wrong = make("p", { id: `${id}-wrong`, className: "wrong" });
      parts.wrong.setAttribute("role", "alert");
      parts.typed.setAttribute("aria-describedby", parts.wrong.id);
      parts.slider = make("input", { id, type: "range", min: 0, max: State.steps(control), step: 1 });
      parts.row.append(make("span", { className: "typed" }, parts.typed, make("span", { className: "unit", textContent: control.unit })), parts.slider, parts.wrong);
      parts.slider.addEventListener("input", () => this.state.move(control.path, State.at(control, Number(parts.slider.value)), false));
      parts.slider.addEventListener("change", () => this.state.done(true));
      parts.typed.addEventListener("change", () => {
        const value = State.valueOf(control, parts.typed.value);
        parts.typed.setAttribute("aria-invalid", String(value === undefined));
        const whole = control.kind === "count" ? "a whole number" : "a number", unit = control.unit ? ` in ${control.unit}` : "";
        parts.wrong.textContent = value === undefined ? `expected ${whole}${unit}, got ${parts.typed.value}` : "";
        if (value !== undefined) this.state.move(control.path, value);
      });
    }

    /** Show the values of the slot that the sliders move. */
    show() {
      const { state } = this, source = state.value("beam.source"), lossless = state.controls.has("slab.lossless") && state.value("slab.lossless");
      for (const [path, parts] of this.rows) {
        const control = state.controls.get(path), value = state.value(path);
        if (parts.choice) parts.choice.value = value;
        if (parts.check) parts.check.checked = value;
        if (parts.slider) {
          const position = String(State.position(control, value));
          if (parts.slider.value !== position) parts.slider.value = position;
          const said = Plots.digits(value, 6);
          parts.slider.setAttribute("aria-valuetext", `${said} ${control.unit}`.trim());
          if (document.activeElement !== parts.typed || parts.typed.getAttribute("aria-invalid") !== "true") {
            parts.typed.value = said;
            parts.typed.removeAttribute("aria-invalid");
            parts.wrong.textContent = "";
          }
          for (const input of [parts.slider, parts.typed]) input.disabled = lossless && ["slab.rho_m.im", "slab.delta_rho"].includes(path);
        }
        if (/^beam\.(fwhm|x0|form|width_of)$/.test(path)) parts.row.hidden = source !== "gaussian";
        if (path.startsWith("beam.slits.")) parts.row.hidden = source !== "slits";
      }
    }
  }
  return { Sliders, make };
})();
