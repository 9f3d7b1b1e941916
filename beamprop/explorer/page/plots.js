"use strict";
/* Pictures: maps on a canvas under axes of SVG, curves in SVG. They know arrays alone, neither the server nor the study. */
const Plots = (() => {
  const escape = (text) => String(text).replace(/[&<>"]/g, (c) => ({ "&": "&amp;", "<": "&lt;", ">": "&gt;", '"': "&quot;" })[c]);
  let colours = {};

  /** Colour maps: kind -> 256 colours as hexadecimal digits. */
  function useColours(given) {
    for (const [kind, hex] of Object.entries(given)) {
      colours[kind] = Uint32Array.from({ length: 256 }, (_, i) => {
        const at = (j) => parseInt(hex.substr(6 * i + 2 * j, 2), 16);
        return (255 << 24) | (at(2) << 16) | (at(1) << 8) | at(0);
      });
    }
  }

  /** Round numbers from low to high, about `count` of them. */
  function ticks(low, high, count) {
    const rough = (high - low) / Math.max(1, count);
    if (!(rough > 0) || !isFinite(rough)) return [low];
    const power = 10 ** Math.floor(Math.log10(rough));
    const step = power * [1, 2, 5, 10].find((m) => m * power >= rough * 0.999);
    const values = [];
    for (let i = Math.ceil(low / step - 1e-9); i * step <= high + 1e-9 * step; i++) values.push(i * step);
    return values;
  }

  const digits = (v, n = 4) => (v === null || !isFinite(v) ? "–" : Number(v.toPrecision(n)).toString());

  /** A unit in which a largest value reads well: [factor, unit]. */
  function unitOf(unit, largest) {
    const of = { m: [[1, "m"], [0.1, "cm"], [0.01, "mm"], [1e-5, "µm"]], Hz: [[1e6, "MHz"], [1e3, "kHz"], [0, "Hz"]] }[unit];
    const factors = { m: 1, cm: 100, mm: 1e3, "µm": 1e6, MHz: 1e-6, kHz: 1e-3, Hz: 1 };
    if (!of || !(largest > 0)) return [1, unit];
    const name = (of.find(([least]) => largest >= least * (unit === "Hz" && least > 0 ? 10 : 1)) || of[of.length - 1])[1];
    return [factors[name], name];
  }

  /** Frame, grid, ticks and labels of a box; `scale` gives pixels of both axes. */
  function frame(box, xr, yr, about) {
    const sx = (v) => box.x + ((v - xr[0]) / (xr[1] - xr[0])) * box.w;
    const sy = (v) => box.y + box.h - ((v - yr[0]) / (yr[1] - yr[0])) * box.h;
    const parts = [];
    const text = (x, y, said, more = "") => parts.push(`<text x="${x.toFixed(1)}" y="${y.toFixed(1)}" ${more}>${escape(said)}</text>`);
    for (const v of ticks(xr[0], xr[1], box.w / 75)) {
      if (about.grid) parts.push(`<line class="gridline" x1="${sx(v)}" x2="${sx(v)}" y1="${box.y}" y2="${box.y + box.h}"/>`);
      parts.push(`<line class="frame" x1="${sx(v)}" x2="${sx(v)}" y1="${box.y + box.h}" y2="${box.y + box.h + 4}"/>`);
      text(sx(v), box.y + box.h + 17, digits(v), 'text-anchor="middle"');
    }
    for (const v of ticks(yr[0], yr[1], box.h / 45)) {
      if (about.grid) parts.push(`<line class="gridline" x1="${box.x}" x2="${box.x + box.w}" y1="${sy(v)}" y2="${sy(v)}"/>`);
      parts.push(`<line class="frame" x1="${box.x - 4}" x2="${box.x}" y1="${sy(v)}" y2="${sy(v)}"/>`);
      text(box.x - 7, sy(v) + 4, digits(v), 'text-anchor="end"');
    }
    parts.push(`<rect class="frame" x="${box.x}" y="${box.y}" width="${box.w}" height="${box.h}"/>`);
    text(box.x + box.w / 2, box.y + box.h + 35, about.xlabel, 'text-anchor="middle"');
    const y = box.y + box.h / 2;
    text(0, 0, about.ylabel, `text-anchor="middle" transform="translate(${box.x - 44} ${y}) rotate(-90)"`);
    return { sx, sy, markup: parts.join("") };
  }

  /** What both kinds of picture are in: a box that takes the focus, a line that reads values, a place for refusals. */
  function holder(root, name) {
    root.innerHTML = '<div class="plot" tabindex="0" role="group"></div><output class="read"></output><p class="refused" role="status"></p>';
    const plot = root.querySelector(".plot");
    plot.setAttribute("aria-label", `${name}; arrow keys read values`);
    return { plot, read: root.querySelector(".read"), refused: root.querySelector(".refused") };
  }

  /** A refusal in place of an answer: the last picture stays, faint. */
  function refuse(parts, message) {
    parts.refused.textContent = message || "";
    parts.plot.classList.toggle("stale", Boolean(message));
  }

  class Curves {
    constructor(root, name) {
      this.parts = holder(root, name);
      this.name = name;
      this.index = null;
      const { plot } = this.parts;
      this.key = document.createElement("ul");
      this.key.className = "key";
      plot.after(this.key);
      plot.addEventListener("pointermove", (e) => this.point(e));
      plot.addEventListener("pointerleave", () => this.readAt(null));
      plot.addEventListener("keydown", (e) => {
        const step = { ArrowLeft: -1, ArrowRight: 1 }[e.key];
        if (!step || !this.drawn) return;
        e.preventDefault();
        const last = this.drawn.lines[0].x.length - 1;
        this.readAt(Math.min(last, Math.max(0, (this.index ?? Math.round(last / 2)) + step * (e.shiftKey ? 10 : 1))));
      });
    }

    /** lines: [{x, y, style, label}] that share x by slot; about: {xlabel, ylabel, xr, yr, now}. */
    draw(lines, about) {
      this.drawn = { lines, about };
      const width = this.parts.plot.clientWidth || 320, height = Math.round(Math.min(about.tall ? 460 : 270, Math.max(190, width * 0.62)));
      const box = { x: 56, y: 8, w: Math.max(60, width - 66), h: height - 52 };
      const xr = about.xr || [lines[0].x[0], lines[0].x[lines[0].x.length - 1]];
      const yr = about.yr || range(lines);
      const axes = frame(box, xr, yr, { ...about, grid: true });
      this.axes = axes;
      this.box = box;
      const drawn = lines.map((line) => `<path class="line ${line.style}" d="${path(line, axes, yr, box)}"/>`).join("");
      const now = about.now >= xr[0] && about.now <= xr[1] ? `<line class="now" x1="${axes.sx(about.now)}" x2="${axes.sx(about.now)}" y1="${box.y}" y2="${box.y + box.h}"/>` : "";
      this.parts.plot.innerHTML = `<svg width="${width}" height="${height}" role="img" aria-label="${escape(this.name)}">${axes.markup}${now}<svg x="${box.x}" y="${box.y}" width="${box.w}" height="${box.h}" viewBox="${box.x} ${box.y} ${box.w} ${box.h}">${drawn}</svg><line class="cursor" visibility="hidden"/></svg>`;
      this.key.innerHTML = lines.map((l) => `<li><svg viewBox="0 0 24 8" aria-hidden="true"><line class="line ${l.style}" x1="0" x2="24" y1="4" y2="4"/></svg>${escape(l.label)}</li>`).join("");
      this.readAt(this.index);
    }

    point(e) {
      if (!this.drawn) return;
      const at = e.clientX - this.parts.plot.getBoundingClientRect().left, x = this.drawn.lines[0].x;
      let best = 0;
      for (let i = 0; i < x.length; i++) if (Math.abs(this.axes.sx(x[i]) - at) < Math.abs(this.axes.sx(x[best]) - at)) best = i;
      this.readAt(best);
    }

    readAt(index) {
      this.index = index;
      const cursor = this.parts.plot.querySelector(".cursor"), { lines, about } = this.drawn || {};
      if (!cursor) return;
      if (index === null || index >= lines[0].x.length) {
        cursor.setAttribute("visibility", "hidden");
        this.parts.read.textContent = "";
        return;
      }
      const at = this.axes.sx(lines[0].x[index]);
      for (const [k, v] of Object.entries({ x1: at, x2: at, y1: this.box.y, y2: this.box.y + this.box.h, visibility: "visible" })) cursor.setAttribute(k, v);
      const said = lines.map((l) => `${l.label} ${digits(l.y[index])}`).join(", ");
      this.parts.read.textContent = `${about.xlabel} ${digits(lines[0].x[index])}: ${said}`;
    }

    refuse(message) { refuse(this.parts, message); }
  }

  function range(lines) {
    let low = 0, high = 0;
    for (const l of lines) for (const v of l.y) if (isFinite(v)) { low = Math.min(low, v); high = Math.max(high, v); }
    const pad = 0.05 * (high - low || 1);
    return [low < 0 ? low - pad : 0, high + pad];
  }

  function path(line, axes, yr, box) {
    let d = "", pen = "M";
    for (let i = 0; i < line.x.length; i++) {
      const v = line.y[i];
      if (!isFinite(v)) { pen = "M"; continue; }
      const y = Math.max(-10 * box.h, Math.min(10 * box.h, axes.sy(v))); // what lies outside of the box is clipped
      d += `${pen}${axes.sx(line.x[i]).toFixed(1)} ${y.toFixed(1)}`;
      pen = "L";
    }
    return d;
  }

  return { useColours, colours: () => colours, ticks, digits, unitOf, frame, holder, refuse, escape, Curves };
})();
