"use strict";
/* The page: asks the server for the answers that a state needs, one request a question at a time, and draws them. */
(() => {
  const { make } = Sliders;
  const byId = (id) => document.getElementById(id);
  /** In the order in which they are asked: curves are quick, and wait for no map. */
  const QUESTIONS = ["scattering", "bloch", "beam_width", "field"];
  /** Values that a question does not depend on. */
  const IDLE = {
    field: /^view\.(kx|contour|from|to)$/,
    scattering: /^(beam\.|question\.angle|view\.(?!kx$))/,
    bloch: /^(beam\.|tolerance\.|question\.angle|slab\.periods$|slab\.medium$|view\.(?!contour$))/,
    beam_width: /^view\.(x|behind|kx|contour)$/,
  };
  const WIDTHS = [["fwhm_out", "Width behind the slab"], ["fwhm_in", "Width at the near face"], ["fwhm_air", "Width without the slab"]];
  const answers = { a: {}, b: {} }, running = new Map(), shown = {}, maps = {};
  let state, sliders, curves, remark = [], moving = 0, fading = 0;

  /** An answer that a newer state waits for is given up after so long, and pictures fade after so long without theirs [ms]. */
  const PATIENCE = 2000, FADE = 500;

  async function post(route, body, signal) {
    const gone = (error) => { throw signal?.aborted ? error : new Error("the server does not answer: start beamprop explore again"); };
    const response = await fetch(route, { method: "POST", headers: { "Content-Type": "application/json" }, body: JSON.stringify(body), signal }).catch(gone);
    if (response.ok) return response;
    const said = response.headers.get("Content-Type") === "application/json" ? (await response.json()).error : `${response.status} ${response.statusText}`;
    throw new Error(said);
  }

  /** An answer out of its bytes: the JSON, and arrays by name. */
  function unpack(buffer) {
    const length = new DataView(buffer).getUint32(0, true), meta = JSON.parse(new TextDecoder().decode(new Uint8Array(buffer, 4, length)));
    let at = 4 + length;
    for (const [name, shape] of meta.arrays) {
      const count = shape.reduce((a, b) => a * b, 1);
      meta[name] = new Float32Array(buffer, at, count);
      at += 4 * count;
    }
    return meta;
  }

  const needed = (question, slot) => JSON.stringify(Object.entries(state.slots[slot]).filter(([path]) => !IDLE[question].test(path)).sort());

  /** Ask for what the state needs and is not there; what is under way is looked at again when it has come. */
  function ask() {
    const slots = state.slots.b ? ["a", "b"] : ["a"];
    for (const question of QUESTIONS) for (const slot of slots) {
      const job = `${question} ${slot}`, wanted = needed(question, slot), have = answers[slot][question];
      if (running.has(job)) {
        const { of, since, control } = running.get(job);
        if (of !== wanted) setTimeout(() => { if (needed(question, slot) !== of) control.abort(); }, Math.max(0, since + PATIENCE - Date.now()));
        continue;
      }
      if (have && have.of === wanted) continue;
      // widths take longest of the curves: the others go first
      if (question === "beam_width" && (running.has(`scattering ${slot}`) || running.has(`bloch ${slot}`))) continue;
      const moved = state.slots[slot], control = new AbortController();
      running.set(job, { of: wanted, since: Date.now(), control });
      post(question === "field" ? "map" : "curve", { question, state: moved }, control.signal)
        .then(async (response) => ({ of: wanted, moved, ...unpack(await response.arrayBuffer()) }))
        .catch((error) => (control.signal.aborted ? null : { of: wanted, refused: error.message }))
        .then((answer) => {
          running.delete(job);
          if (!answer) { ask(); return; }
          const last = answers[slot][question];
          answers[slot][question] = answer.refused && last ? { ...last, of: wanted, refused: answer.refused } : answer;
          draw(question);
          ask();
        });
    }
    byId("busy").textContent = running.size ? "…" : spent();
    if (!running.size) { clearTimeout(fading); fading = 0; document.body.classList.remove("waiting"); }
    else if (!fading) fading = setTimeout(() => document.body.classList.add("waiting"), FADE);
    document.body.dataset.idle = String(running.size === 0);
  }

  function spent() {
    const field = answers[state.active].field;
    return field && field.seconds ? `answered in ${Math.round(1000 * field.seconds)} ms, error ${Plots.digits(field.error, 2)}` : "";
  }

  // --- drawing ----------------------------------------------------------------------------------------------

  function slotsShown() { return state.slots.b ? ["a", "b"] : ["a"]; }

  function drawField() {
    const fields = slotsShown().map((slot) => answers[slot].field).filter((f) => f && f.re);
    const top = Math.max(...fields.map((f) => f.peak)) || 1, height = Math.min(window.innerHeight * (window.innerWidth < 960 ? 0.4 : 0.55), 560);
    for (const slot of slotsShown()) {
      const field = answers[slot].field;
      if (!field || !maps[slot]) continue;
      maps[slot].refuse(field.refused);
      if (field.re) maps[slot].draw(field, byId("quantity").value, top, height);
    }
  }

  /** Curves of both slots in one frame; `styles` are those of the slots, `names` the arrays. */
  function lines(question, along, names, factor = 1) {
    const several = Boolean(state.slots.b);
    return slotsShown().flatMap((slot) => {
      const answer = answers[slot][question];
      if (!answer || !answer[along]) return [];
      return names.filter((n) => !n.alone || slot === "a").map((n) => ({
        x: answer[along].map((v) => v * (n.by || 1)), y: answer[n.of].map((v) => v * factor),
        style: n.alone ? n.style : `${slot} ${n.style}`, label: several && !n.alone ? `${slot.toUpperCase()}: ${n.label}` : n.label,
      }));
    });
  }

  const FRAMES = {
    scattering() {
      const drawn = lines("scattering", "kx_over_k0", [{ of: "transmissivity", label: "|t|²", style: "" }, { of: "reflectivity", label: "|r|²", style: "dot" }]);
      const high = Math.max(1, ...drawn.map((l) => l.y.reduce((m, v) => Math.max(m, v), 0)));
      return [drawn, { xlabel: "kx / k₀", ylabel: "power ratio", yr: [0, 1.05 * Math.min(high, 4)] }];
    },
    bloch() {
      const drawn = lines("bloch", "kx_over_k0", [{ of: "re", label: "Re kz/k₀", style: "" }, { of: "im", label: "Im kz/k₀", style: "dot" }]);
      return [drawn, { xlabel: "kx / k₀", ylabel: "kz / k₀" }];
    },
    beam_width() {
      const answer = slotsShown().map((s) => answers[s].beam_width).find((w) => w && w.fwhm_out);
      if (!answer) return [[], {}];
      const [factor, unit] = Plots.unitOf("m", Math.max(...answer.fwhm_air.filter(isFinite), 0));
      const [by, hertz] = Plots.unitOf("Hz", answer.frequency[answer.frequency.length - 1]);
      const names = [{ of: "fwhm_out", label: "behind the slab", style: "", by }, { of: "fwhm_air", label: "without the slab", style: "soft dash", alone: true, by }, { of: "fwhm_in", label: "near face", style: "c dot", alone: true, by }];
      return [lines("beam_width", "frequency", names, factor), { xlabel: `frequency [${hertz}]`, ylabel: `width [${unit}]`, now: state.value("question.frequency") * by }];
    },
  };

  function drawCurves(question) {
    const [drawn, about] = FRAMES[question]();
    const refusals = slotsShown().map((slot) => answers[slot][question]).filter((a) => a && a.refused).map((a) => a.refused);
    if (drawn.length) curves[question].draw(drawn, about);
    curves[question].refuse(refusals[0]);
  }

  function drawNumbers() {
    byId("numbers").replaceChildren(...slotsShown().filter((slot) => (answers[slot].beam_width || {}).fwhm_out).map((slot) => {
      const widths = answers[slot].beam_width, [factor, unit] = Plots.unitOf("m", widths.here.fwhm_air || widths.here.fwhm_out);
      const cards = WIDTHS.map(([name, label]) => [label, name, widths.here[name]]);
      const list = make("dl", { className: slot }, ...cards.map(([label, name, v]) => {
        const value = make("dd", { textContent: v === null ? "–" : `${Plots.digits(v * factor, 6)} ${unit}` });
        Object.assign(value.dataset, { name, slot, value: v });
        return make("div", {}, make("dt", { textContent: state.slots.b ? `${slot.toUpperCase()}: ${label}` : label }), value);
      }));
      const ratio = widths.here.fwhm_out / widths.here.fwhm_air;
      list.append(make("div", {}, make("dt", { textContent: "Behind over without" }), make("dd", { textContent: Plots.digits(ratio, 3) })));
      return list;
    }));
  }

  function drawNotes() {
    const said = slotsShown().flatMap((slot) => QUESTIONS.flatMap((q) => (answers[slot][q] || {}).warnings || []));
    byId("notes").replaceChildren(...[...new Set([...remark, ...said])].map((text) => make("p", { textContent: text })));
  }

  function draw(question) {
    if (question === "field") drawField();
    else drawCurves(question);
    if (question === "beam_width") drawNumbers();
    drawNotes();
    shown[question] = (shown[question] || 0) + 1;
    document.body.dataset[`drawn${question}`] = shown[question];
  }

  // --- the state, and what is done with it --------------------------------------------------------------------

  function changed(settled) {
    sliders.show();
    layOut();
    if (settled) {
      history.replaceState(null, "", `#${state.text()}`);
      byId("undo").disabled = !state.past.length;
      byId("redo").disabled = !state.future.length;
    }
    ask();
  }

  /** One map or two, and which of them the sliders move. */
  function layOut() {
    const slots = slotsShown(), key = slots.join("");
    for (const radio of document.querySelectorAll("#which input")) radio.checked = radio.value === state.active;
    if (byId("maps").dataset.slots === key) return;
    byId("maps").dataset.slots = key;
    byId("maps").replaceChildren(...slots.map((slot) => {
      const root = make("div");
      root.id = `map-${slot}`;
      maps[slot] = new FieldMap(root, slots.length > 1 ? `Field of ${slot.toUpperCase()}` : "Field");
      if (slots.length > 1) root.prepend(make("h3", { className: `slot ${slot}`, textContent: slot.toUpperCase() }));
      return root;
    }));
    if (slots.length < 2) answers.b = {};
    byId("compare").setAttribute("aria-pressed", String(slots.length > 1));
    byId("which").hidden = slots.length < 2;
    byId("which").replaceChildren(...(slots.length < 2 ? [] : slots.map((slot) => {
      const radio = make("input", { type: "radio", name: "slot", value: slot, checked: slot === state.active });
      radio.addEventListener("change", () => state.choose(slot));
      return make("label", {}, radio, ` sliders move ${slot.toUpperCase()}`);
    })));
    for (const question of QUESTIONS) if (answers.a[question]) draw(question);
  }

  /** Motion of one period in two seconds: Re p exp(-i w t). */
  function play(on) {
    byId("play").setAttribute("aria-pressed", String(on));
    byId("play").textContent = on ? "Stop" : "Play";
    cancelAnimationFrame(moving);
    if (on && byId("quantity").value !== "real") { byId("quantity").value = "real"; drawField(); }
    const step = (now) => {
      for (const slot of slotsShown()) if (maps[slot] && maps[slot].data) {
        maps[slot].turn = on ? ((now / 2000) % 1) * 2 * Math.PI : 0;
        maps[slot].paint();
      }
      if (on) moving = requestAnimationFrame(step);
    };
    step(0);
  }

  async function copy(text, button) {
    const before = button.textContent;
    try { await navigator.clipboard.writeText(text); button.textContent = "Copied"; } catch { button.textContent = "Press Ctrl+C"; getSelection().selectAllChildren(button.closest(".text")?.querySelector("pre") || document.body); }
    setTimeout(() => { button.textContent = before; }, 1500);
  }

  function save(blob, name) {
    const link = make("a", { href: URL.createObjectURL(blob), download: name });
    link.click();
    setTimeout(() => URL.revokeObjectURL(link.href), 10000);
  }

  async function showTexts() {
    const question = byId("question").value, body = { question, state: state.slots[state.active] };
    byId("said").textContent = "";
    try {
      const texts = await (await post("texts", body)).json();
      byId("texts").replaceChildren(...texts.map(({ title, file, text }) => {
        const button = make("button", { type: "button", textContent: "Copy" }), keep = make("button", { type: "button", textContent: file });
        button.addEventListener("click", () => copy(text, button));
        keep.addEventListener("click", () => save(new Blob([text], { type: "text/plain" }), file));
        const pre = make("pre", { textContent: text, tabIndex: 0 });
        pre.dataset.file = file;
        return make("div", { className: "text" }, make("div", { className: "text-head" }, make("h3", { textContent: title }), button, keep), pre);
      }));
    } catch (error) { byId("said").textContent = error.message; byId("texts").replaceChildren(); }
  }

  async function download(kind) {
    const question = byId("question").value, quantity = byId("quantity").value;
    byId("said").textContent = "…";
    try {
      const response = await post("file", { question, state: state.slots[state.active], kind, quantity });
      save(await response.blob(), `${question}.${kind}`);
      byId("said").textContent = `${question}.${kind} is made`;
    } catch (error) { byId("said").textContent = error.message; }
  }

  function listen() {
    byId("undo").addEventListener("click", () => state.undo());
    byId("redo").addEventListener("click", () => state.redo());
    byId("reset").addEventListener("click", () => state.reset());
    byId("compare").addEventListener("click", () => state.compare(!state.slots.b));
    byId("link").addEventListener("click", (e) => copy(location.href, e.target));
    byId("play").addEventListener("click", () => play(byId("play").getAttribute("aria-pressed") !== "true"));
    byId("quantity").addEventListener("change", () => { if (byId("quantity").value !== "real") play(false); drawField(); });
    byId("take").addEventListener("click", () => { byId("handout").showModal(); showTexts(); });
    byId("close").addEventListener("click", () => byId("handout").close());
    byId("question").addEventListener("change", showTexts);
    for (const button of document.querySelectorAll("[data-kind]")) button.addEventListener("click", () => download(button.dataset.kind));
    addEventListener("keydown", (e) => {
      if (!(e.ctrlKey || e.metaKey) || e.target.type === "text" || e.key.toLowerCase() !== "z") return;
      e.preventDefault();
      if (e.shiftKey) state.redo(); else state.undo();
    });
    addEventListener("hashchange", () => { if (location.hash.slice(1) !== state.text()) open(); });
    let wait = 0;
    addEventListener("resize", () => { clearTimeout(wait); wait = setTimeout(() => QUESTIONS.forEach((q) => answers.a[q] && draw(q)), 100); });
  }

  function open() {
    const unknown = state.open(location.hash.slice(1));
    remark = unknown.length ? [`The link has values that this study has not: ${unknown.join(", ")}`] : [];
    drawNotes();
  }

  async function start() {
    const board = await (await fetch("board")).json();
    byId("study").textContent = board.title;
    Plots.useColours(board.colours);
    curves = { scattering: new Plots.Curves(byId("scattering"), "Transmission"), bloch: new Plots.Curves(byId("bloch"), "Equifrequency contour"), beam_width: new Plots.Curves(byId("beam_width"), "Width by frequency") };
    state = new State.State(board.controls, changed);
    sliders = new Sliders.Sliders(byId("controls"), state);
    listen();
    open();
  }

  start().catch((error) => byId("notes").replaceChildren(make("p", { textContent: `The page could not start: ${error.message}` })));
})();
