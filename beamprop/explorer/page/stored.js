"use strict";
/* Stored results: a variable of the dataset as curves along one dimension or as a map of two; the others are selected. */
(() => {
  const byId = (id) => document.getElementById(id);
  const data = JSON.parse(byId("data").textContent);
  const MANY = 6; // curves in a picture
  const STYLES = ["a", "b", "c", "a dash", "b dash", "c dash"];
  const PARTS = { abs: "magnitude", real: "real part", imag: "imaginary part", phase: "phase" };
  const make = (tag, of = {}, ...inner) => { const node = Object.assign(document.createElement(tag), of); node.append(...inner); return node; };
  /** What is shown first: the variable of most dimensions, of several such the one that the question is about. */
  const FIRST = ["p", "fwhm_out", "transmissivity", "kz_over_k0", "fwhm"];
  const rank = (name) => data.variables[name].dims.length * 10 + (FIRST.includes(name) ? FIRST.length - FIRST.indexOf(name) : 0);
  const first = Object.keys(data.variables).reduce((best, name) => (rank(name) > rank(best) ? name : best));
  const choice = { variable: first, along: "", across: "", part: "abs", at: {} };

  /** Values of a variable: real parts, and of complex ones the imaginary parts behind them. */
  function values(variable) {
    if (!variable.array) {
      const bytes = Uint8Array.from(atob(variable.values), (c) => c.charCodeAt(0));
      variable.array = new Float32Array(bytes.buffer);
    }
    return variable.array;
  }

  const isNumeric = (dim) => data.coords[dim].values.every((v) => typeof v === "number");
  const named = (dim) => { const { long_name: name, units } = data.coords[dim]; return ["", "1"].includes(units) ? name : `${name} [${units}]`; };
  const sizeOf = (dim) => data.coords[dim].values.length;

  /** The value at an index of each dimension. */
  function reader(variable) {
    const array = values(variable), strides = {};
    let stride = 1;
    for (const dim of [...variable.dims].reverse()) { strides[dim] = stride; stride *= sizeOf(dim); }
    return (index) => {
      const at = variable.dims.reduce((sum, dim) => sum + strides[dim] * index[dim], 0);
      return variable.complex ? [array[at], array[stride + at]] : [array[at], 0];
    };
  }

  const partOf = (variable, [re, im]) => !variable.complex ? re : { abs: Math.hypot(re, im), real: re, imag: im, phase: (Math.atan2(im, re) * 180) / Math.PI }[choice.part];

  /** Make every choice one that the variable has. */
  function settle() {
    const { dims } = data.variables[choice.variable], numeric = dims.filter(isNumeric);
    if (!numeric.includes(choice.along)) choice.along = numeric.includes("z") && numeric.includes("x") ? "z" : numeric.sort((p, q) => sizeOf(q) - sizeOf(p))[0] || "";
    const rest = dims.filter((d) => d !== choice.along);
    if (choice.across.startsWith("map ") ? !numeric.includes(choice.across.slice(4)) || choice.across.slice(4) === choice.along : !rest.includes(choice.across)) choice.across = "";
    for (const dim of dims) choice.at[dim] = Math.min(choice.at[dim] || 0, sizeOf(dim) - 1);
  }

  function row(label, id, input, typed = "") {
    const labelled = make("label", { htmlFor: id, textContent: label });
    return make("div", { className: input.type === "range" ? "row" : "row whole" }, labelled, ...(typed ? [make("span", { className: "typed", textContent: typed })] : []), input);
  }

  function select(label, key, options) {
    const input = make("select", { id: key }, ...options.map(([value, text]) => make("option", { value, textContent: text })));
    input.value = choice[key];
    input.addEventListener("change", () => { choice[key] = input.value; show(key); });
    return row(label, key, input);
  }

  function slider(dim) {
    const coordinate = data.coords[dim], id = `at-${dim}`;
    const said = (i) => (isNumeric(dim) ? `${Plots.digits(coordinate.values[i], 6)} ${coordinate.units.replace(/^1$/, "")}` : coordinate.values[i]);
    const input = make("input", { id, type: "range", min: 0, max: sizeOf(dim) - 1, step: 1 });
    input.value = choice.at[dim];
    input.setAttribute("aria-valuetext", said(choice.at[dim]));
    const made = row(coordinate.long_name, id, input, said(choice.at[dim]));
    input.addEventListener("input", () => {
      choice.at[dim] = Number(input.value);
      input.setAttribute("aria-valuetext", said(choice.at[dim]));
      made.querySelector(".typed").textContent = said(choice.at[dim]);
      draw();
    });
    return made;
  }

  /** The form anew, with the focus where it was. */
  function show(focus) {
    settle();
    const variable = data.variables[choice.variable], numeric = variable.dims.filter(isNumeric), rest = variable.dims.filter((d) => d !== choice.along);
    const names = Object.keys(data.variables).map((name) => [name, name]);
    const rows = [select("Variable", "variable", names)];
    if (variable.complex) rows.push(select("Part", "part", Object.entries(PARTS)));
    if (numeric.length) rows.push(select("Along", "along", numeric.map((d) => [d, named(d)])));
    if (rest.length) rows.push(select("And", "across", [["", "no other dimension"], ...rest.filter(isNumeric).map((d) => [`map ${d}`, `map over ${named(d)}`]), ...rest.filter((d) => sizeOf(d) <= MANY).map((d) => [d, `a curve for each ${d}`])]));
    const used = choice.across.replace(/^map /, "");
    rows.push(...rest.filter((d) => d !== used && sizeOf(d) > 1).map(slider));
    byId("choices").replaceChildren(...rows);
    if (focus && byId(focus)) byId(focus).focus();
    draw();
  }

  /** Name and unit, short enough for an axis. */
  const short = (variable) => {
    const unit = variable.complex && choice.part === "phase" ? "°" : variable.units.replace(/^1$/, "");
    const name = variable.complex ? { abs: `|${choice.variable}|`, real: `Re ${choice.variable}`, imag: `Im ${choice.variable}`, phase: "phase" }[choice.part] : choice.variable;
    return unit ? `${name} [${unit}]` : name;
  };
  const title = (variable) => `${variable.long_name}${variable.complex ? `, ${PARTS[choice.part]}` : ""}${["", "1"].includes(variable.units) ? "" : ` [${choice.part === "phase" && variable.complex ? "°" : variable.units}]`}`;

  function draw() {
    const variable = data.variables[choice.variable], isMap = choice.across.startsWith("map ");
    byId("shown-title").textContent = title(variable);
    for (const [id, on] of [["map", isMap], ["curves", !isMap && choice.along], ["value", !choice.along]]) byId(id).hidden = !on;
    if (!choice.along) byId("value").textContent = Plots.digits(partOf(variable, reader(variable)(choice.at)), 6);
    else if (isMap) drawMap(variable, choice.across.slice(4));
    else drawCurves(variable);
    document.body.dataset.drawn = String(Number(document.body.dataset.drawn || 0) + 1);
  }

  let curves, map;

  function drawCurves(variable) {
    curves = curves || new Plots.Curves(byId("curves"), "Stored curve");
    const read = reader(variable), { along, across } = choice, x = data.coords[along].values;
    const lines = (across ? data.coords[across].values : [null]).map((value, i) => ({
      x, style: STYLES[i % STYLES.length], label: value === null ? choice.variable : `${across} ${typeof value === "number" ? Plots.digits(value) : value}`,
      y: x.map((_, k) => partOf(variable, read({ ...choice.at, [along]: k, ...(across ? { [across]: i } : {}) }))),
    }));
    curves.draw(lines, { xlabel: named(along), ylabel: short(variable), tall: true });
  }

  /** Even positions over a coordinate, and the index of the nearest value to each. */
  function even(values) {
    const low = Math.min(...values), high = Math.max(...values), count = Math.max(2, Math.min(400, values.length));
    const steps = values.slice(1).map((v, i) => Math.abs(v - values[i])), uneven = Math.max(...steps) > 1.001 * Math.min(...steps);
    const n = uneven ? 400 : count, at = Array.from({ length: n }, (_, i) => low + ((high - low) * i) / (n - 1));
    return [at, at.map((v) => values.reduce((best, w, i) => (Math.abs(w - v) < Math.abs(values[best] - v) ? i : best), 0))];
  }

  function drawMap(variable, across) {
    map = map || new FieldMap(byId("map"), "Stored map");
    const { along } = choice, read = reader(variable), [z, columns] = even(data.coords[along].values), [x, rows] = even(data.coords[across].values);
    const re = new Float32Array(x.length * z.length), im = new Float32Array(x.length * z.length);
    let low = Infinity, high = -Infinity;
    for (let i = 0, k = 0; i < x.length; i++) for (let j = 0; j < z.length; j++, k++) {
      const value = partOf(variable, read({ ...choice.at, [along]: columns[j], [across]: rows[i] }));
      re[k] = value;
      if (isFinite(value)) { low = Math.min(low, value); high = Math.max(high, value); }
    }
    const signed = low < 0 && high > 0, top = Math.max(Math.abs(low), Math.abs(high)) || 1, phase = variable.complex && choice.part === "phase";
    const about = { title: short(variable), low: phase ? -180 : signed ? -top : low, high: phase ? 180 : signed ? top : Math.max(high, low + 1e-300), colours: phase ? "cyclic" : signed ? "signed" : "sequential" };
    const places = along === "z" && across === "x";
    map.draw({ x, z, re, im, thickness: places ? data.thickness : null, value: about, equal: places, labels: places ? null : { z: named(along), x: named(across) } }, "value", 1, Math.min(520, window.innerHeight * 0.6));
  }

  Plots.useColours(data.colours);
  settle();
  const dims = data.variables[choice.variable].dims;
  if (dims.includes("x") && dims.includes("z")) choice.across = "map x";
  show();
  let wait = 0;
  addEventListener("resize", () => { clearTimeout(wait); wait = setTimeout(draw, 100); });
})();
