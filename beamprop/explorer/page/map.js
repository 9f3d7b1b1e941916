"use strict";
/* The map of a complex pressure on (x, z), rows of z: colours on a canvas, axes, faces of the slab and a colour bar over it. */
const FieldMap = (() => {
  const FLOOR = -40; // of the level [dB]
  const QUANTITIES = {
    abs: { title: "|p| [Pa]", colours: "sequential", ends: (top) => [0, top], of: (re, im) => Math.sqrt(re * re + im * im) },
    real: { title: "Re p [Pa]", colours: "signed", ends: (top) => [-top, top], of: (re) => re },
    phase: { title: "phase [°]", colours: "cyclic", ends: () => [-180, 180], of: (re, im) => (Math.atan2(im, re) * 180) / Math.PI },
    dB: { title: "level [dB]", colours: "sequential", ends: () => [FLOOR, 0], of: (re, im, top) => Math.max(FLOOR, 10 * Math.log10((re * re + im * im) / (top * top) + 1e-12)) },
    value: { colours: "sequential", ends: () => [0, 1], of: (re) => re }, // of any variable: what is missing comes with the data
    intensity: { title: "|p|² [Pa²]", colours: "sequential", ends: (top) => [0, top * top], of: (re, im) => re * re + im * im },
  };

  class FieldMap {
    constructor(root, name) {
      this.parts = Plots.holder(root, name);
      this.name = name;
      this.small = document.createElement("canvas");
      this.parts.plot.innerHTML = '<canvas aria-hidden="true"></canvas><div class="over"></div>';
      this.canvas = this.parts.plot.querySelector("canvas");
      this.over = this.parts.plot.querySelector(".over");
      this.turn = 0; // of the phase, for motion
      const { plot } = this.parts;
      plot.addEventListener("pointermove", (e) => this.point(e));
      plot.addEventListener("pointerleave", () => this.readAt(null));
      plot.addEventListener("keydown", (e) => {
        const step = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1] }[e.key];
        if (!step || !this.data) return;
        e.preventDefault();
        const { x, z } = this.data, by = e.shiftKey ? 20 : 4;
        const [j, i] = this.at || [z.length >> 1, x.length >> 1];
        const kept = (v, n) => Math.min(n - 1, Math.max(0, v));
        this.readAt([kept(j + by * step[0], z.length), kept(i + by * step[1], x.length)]);
      });
    }

    /** data: {x, z, re, im, thickness, peak}; top: end of the colours; height: of the map at most. */
    draw(data, quantity, top, height) {
      Object.assign(this, { data, quantity, top, height });
      this.place();
      this.paint();
    }

    get about() {
      const { value } = this.data;
      return this.quantity === "value" ? { ...QUANTITIES.value, title: value.title, colours: value.colours, ends: () => [value.low, value.high] } : QUANTITIES[this.quantity];
    }

    /** Size and axes: equal scales, centred, the colour bar as high as the map. */
    place() {
      const { x, z, thickness, labels, equal = true } = this.data, width = this.parts.plot.clientWidth || 320;
      const step = (v) => Math.abs(v[1] - v[0]) || 1, ends = (v) => [Math.min(v[0], v[v.length - 1]) - step(v) / 2, Math.max(v[0], v[v.length - 1]) + step(v) / 2];
      const zr = ends(z), xr = ends(x), [factor, unit] = labels ? [1, ""] : Plots.unitOf("m", Math.max(...zr.map(Math.abs), ...xr.map(Math.abs)));
      const left = 58, right = 74, room = width - left - right, scale = Math.min(room / (zr[1] - zr[0]), this.height / (xr[1] - xr[0]));
      const [w, h] = equal ? [Math.max(40, (zr[1] - zr[0]) * scale), Math.max(40, (xr[1] - xr[0]) * scale)] : [room, this.height];
      const box = { x: left + Math.max(0, (room - w) / 2), y: 24, w, h }, q = this.about;
      const scaled = (r) => r.map((v) => v * factor);
      const axes = Plots.frame(box, scaled(zr), scaled(xr), labels ? { xlabel: labels.z, ylabel: labels.x } : { xlabel: `z [${unit}]`, ylabel: `x [${unit}]` });
      const faces = (thickness ? [0, thickness * factor] : []).filter((v) => v > zr[0] * factor && v < zr[1] * factor)
        .map((v) => ["face under", "face"].map((c) => `<line class="${c}" x1="${axes.sx(v)}" x2="${axes.sx(v)}" y1="${box.y}" y2="${box.y + h}"/>`).join("")).join("");
      const bar = { x: box.x + w + 14, y: box.y, w: 14, h }, barEnds = q.ends(this.top);
      const side = Plots.ticks(...barEnds, Math.max(2, h / 60)).map((v) => {
        const y = bar.y + bar.h - ((v - barEnds[0]) / (barEnds[1] - barEnds[0])) * bar.h;
        return `<line class="frame" x1="${bar.x + bar.w}" x2="${bar.x + bar.w + 4}" y1="${y}" y2="${y}"/><text x="${bar.x + bar.w + 7}" y="${y + 4}">${Plots.digits(v, 3)}</text>`;
      }).join("");
      const total = Math.round(box.y + h + 42);
      this.over.innerHTML = `<svg width="${width}" height="${total}" role="img" aria-label="${Plots.escape(this.name)}: ${Plots.escape(q.title)}">${axes.markup}${faces}<rect class="frame" x="${bar.x}" y="${bar.y}" width="${bar.w}" height="${bar.h}"/>${side}<text class="title" x="${bar.x + bar.w + 50}" y="14" text-anchor="end">${Plots.escape(q.title)}</text><g class="cursors" visibility="hidden"><line class="cursor light"/><line class="cursor light"/></g></svg>`;
      Object.assign(this, { box, bar, zr, xr, factor, unit });
      const ratio = window.devicePixelRatio || 1, full = bar.x + bar.w - box.x;
      const size = { left: box.x, top: box.y, width: full, height: h };
      for (const [k, v] of Object.entries(size)) this.canvas.style[k] = `${v}px`;
      const pixels = [Math.round(full * ratio), Math.round(h * ratio)];
      if (this.canvas.width !== pixels[0]) this.canvas.width = pixels[0];
      if (this.canvas.height !== pixels[1]) this.canvas.height = pixels[1];
      this.readAt(this.at || null);
    }

    /** Colours of the map at the present turn of the phase. */
    paint() {
      const { x, z, re, im } = this.data, q = this.about, table = Plots.colours()[q.colours];
      const nx = x.length, nz = z.length, [low, high] = q.ends(this.top), gain = 255.999 / (high - low);
      if (this.small.width !== nz || this.small.height !== nx) Object.assign(this.small, { width: nz, height: nx });
      const pen = this.small.getContext("2d"), image = pen.createImageData(nz, nx), out = new Uint32Array(image.data.buffer);
      const cos = Math.cos(this.turn), sin = Math.sin(this.turn), turned = this.turn !== 0;
      for (let i = 0; i < nx; i++) {
        const row = (nx - 1 - i) * nz; // x points up
        for (let j = 0, k = i * nz; j < nz; j++, k++) {
          let a = re[k], b = im[k];
          if (turned) [a, b] = [a * cos + b * sin, b * cos - a * sin]; // p exp(-i turn)
          const level = (q.of(a, b, this.top) - low) * gain;
          out[row + j] = table[level > 255 ? 255 : level > 0 ? level | 0 : 0];
        }
      }
      pen.putImageData(image, 0, 0);
      const on = this.canvas.getContext("2d"), ratio = this.canvas.height / this.box.h, w = this.box.w * ratio, h = this.canvas.height;
      on.clearRect(0, 0, this.canvas.width, h);
      on.imageSmoothingEnabled = this.quantity !== "phase";
      on.drawImage(this.small, 0, 0, w, h);
      const bar = on.createImageData(1, 256), colours = new Uint32Array(bar.data.buffer);
      for (let i = 0; i < 256; i++) colours[i] = table[255 - i];
      if (!this.strip) this.strip = Object.assign(document.createElement("canvas"), { width: 1, height: 256 });
      this.strip.getContext("2d").putImageData(bar, 0, 0);
      on.drawImage(this.strip, (this.bar.x - this.box.x) * ratio, 0, this.bar.w * ratio, h);
    }

    point(e) {
      if (!this.data) return;
      const r = this.parts.plot.getBoundingClientRect(), { x, z } = this.data;
      const u = (e.clientX - r.left - this.box.x) / this.box.w, v = (e.clientY - r.top - this.box.y) / this.box.h;
      if (u < 0 || u >= 1 || v < 0 || v >= 1) return this.readAt(null);
      this.readAt([Math.floor(u * z.length), Math.floor((1 - v) * x.length)]);
    }

    readAt(at) {
      this.at = at;
      const group = this.over.querySelector(".cursors");
      if (!group) return;
      group.setAttribute("visibility", at ? "visible" : "hidden");
      if (!at || at[0] >= this.data.z.length || at[1] >= this.data.x.length) { this.parts.read.textContent = ""; this.at = null; group.setAttribute("visibility", "hidden"); return; }
      const [j, i] = at, { x, z, re, im } = this.data, { box } = this, k = i * z.length + j;
      const px = box.x + ((j + 0.5) / z.length) * box.w, py = box.y + box.h - ((i + 0.5) / x.length) * box.h;
      const set = (line, of) => Object.entries(of).forEach(([name, v]) => line.setAttribute(name, v));
      set(group.children[0], { x1: px, x2: px, y1: box.y, y2: box.y + box.h });
      set(group.children[1], { x1: box.x, x2: box.x + box.w, y1: py, y2: py });
      const size = Math.hypot(re[k], im[k]), angle = (Math.atan2(im[k], re[k]) * 180) / Math.PI;
      if (this.quantity === "value") {
        const { labels } = this.data, [h, v] = labels ? [labels.z, labels.x] : ["z [m]", "x [m]"];
        this.parts.read.textContent = `${h} ${Plots.digits(z[j])}, ${v} ${Plots.digits(x[i])}: ${Plots.digits(re[k])}`;
        return;
      }
      const where = (v) => `${Plots.digits(v * this.factor)} ${this.unit}`;
      this.parts.read.textContent = `z ${where(z[j])}, x ${where(x[i])}: |p| ${Plots.digits(size)} Pa, phase ${angle.toFixed(0)}°`;
    }

    refuse(message) { Plots.refuse(this.parts, message); }
  }
  return FieldMap;
})();
