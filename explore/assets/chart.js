// Charts as SVG: axes, lines, marks with labels that keep clear of the lines, and the point that is selected.

const SVG = "http://www.w3.org/2000/svg";
const MARGIN = { left: 66, right: 14, top: 10, bottom: 46 };

/** An element of SVG with attributes. */
export const shape = (name, attributes = {}, ...children) => {
  const made = document.createElementNS(SVG, name);
  for (const [key, value] of Object.entries(attributes)) {
    // the page's policy forbids styles as attributes
    if (key === "style") made.style.cssText = value;
    else made.setAttribute(key, value);
  }
  made.append(...children);
  return made;
};

/** Text in which `_{…}` stands below the line and `^{…}` above it. */
const written = (text, attributes) => {
  const made = shape("text", attributes);
  let off = 0;
  for (const [, level, small, plain] of text.matchAll(/([_^])\{([^}]*)\}|([^_^]+|[_^])/gu)) {
    const wanted = level === "_" ? 0.28 : level === "^" ? -0.4 : 0;
    // lengths of a small part are in its own size
    const size = level ? 0.74 : 1;
    const part = shape("tspan", { dy: `${((wanted - off) / size).toFixed(2)}em`, style: `font-size: ${size}em` }, small ?? plain);
    off = wanted;
    made.append(part);
  }
  return made;
};

/** Markers of special points, as in the pictures and reports of the program. */
export const FORMS = {
  disc: "M5 0A5 5 0 1 1-5 0A5 5 0 1 1 5 0Z", square: "M-5-5H5V5H-5Z", up: "M0-7L6 5H-6Z",
  down: "M0 7L6-5H-6Z", diamond: "M0-6L5 0L0 6L-5 0Z", cross: "M-3-3L3 3M3-3L-3 3",
};
export const form = (kind) => {
  if (kind === "fold") return ["disc", true];
  if (kind === "branch-point") return ["square", true];
  if (kind === "zero-force") return ["up", true];
  if (kind === "pull-off") return ["down", true];
  if (kind === "hopf") return ["disc", false];
  if (kind.endsWith("-maximum")) return ["diamond", true];
  if (kind.endsWith("-minimum")) return ["diamond", false];
  return ["cross", false];
};

const good = (value) => value !== null && value !== undefined && Number.isFinite(value);

/** Least and greatest of lists, with some room. */
export const extent = (lists, room = 0.05) => {
  let [low, high] = [Infinity, -Infinity];
  for (const list of lists) {
    for (const value of list) {
      if (good(value)) {
        low = Math.min(low, value);
        high = Math.max(high, value);
      }
    }
  }
  if (low > high) return [0, 1];
  const size = Math.max(Math.abs(low), Math.abs(high));
  if (high - low <= 1e-9 * size || size < 1e-25) {
    const half = size < 1e-25 ? 1 : 0.1 * size;
    return [low - half, high + half];
  }
  return [low - room * (high - low), high + room * (high - low)];
};

const SUPERSCRIPT = { "-": "⁻", 0: "⁰", 1: "¹", 2: "²", 3: "³", 4: "⁴", 5: "⁵", 6: "⁶", 7: "⁷", 8: "⁸", 9: "⁹" };

/** Places of ticks, their labels, and the power of ten that the axis' title takes. */
const ticksOf = ([low, high], count) => {
  const rough = (high - low) / Math.max(2, count);
  const power = 10 ** Math.floor(Math.log10(rough));
  const step = power * ([1, 2, 5].find((m) => m * power >= rough * 0.999999) ?? 10);
  const largest = Math.max(Math.abs(low), Math.abs(high));
  const exponent = Math.floor(Math.log10(largest));
  const far = exponent < -2 || exponent > 4 ? exponent : 0;
  const unit = 10 ** far;
  const digits = Math.max(0, Math.min(12, -Math.floor(Math.log10(step / unit) + 1e-6)));
  const places = [];
  for (let k = Math.ceil(low / step - 1e-9); k * step <= high + 1e-9 * step && places.length < 60; k += 1) places.push(k * step);
  const label = (value) => {
    const text = (value / unit).toFixed(digits);
    return Number(text) === 0 ? "0" : text.replace("-", "−");
  };
  const raised = String(far).replace(/./gu, (digit) => SUPERSCRIPT[digit]);
  return { places, label, power: far === 0 ? "" : ` ×10${raised}` };
};

export class Chart {
  /** In `host`; `height` of its width; `equal` gives both axes the same unit. */
  constructor(host, { name, height, equal = false, onPick = null }) {
    this.host = host;
    this.height = height;
    this.equal = equal;
    this.svg = shape("svg", { role: "img", "aria-label": name, class: "chart" });
    this.layers = Object.fromEntries(["back", "lines", "points", "marks", "top", "here"].map((layer) => {
      const group = shape("g", { class: layer });
      this.svg.append(group);
      return [layer, group];
    }));
    this.clip = `clip-${name.replace(/\W/gu, "-")}`;
    this.clipper = shape("rect");
    this.svg.prepend(shape("defs", {}, shape("clipPath", { id: this.clip }, this.clipper)));
    for (const layer of ["lines", "points"]) this.layers[layer].setAttribute("clip-path", `url(#${this.clip})`);
    host.append(this.svg);
    this.content = null;
    new ResizeObserver(() => this.content && this.draw(this.content)).observe(host);
    if (onPick) {
      const pick = (event) => {
        const box = this.svg.getBoundingClientRect();
        const found = this.nearest(event.clientX - box.left, event.clientY - box.top);
        if (found !== null) onPick(found);
      };
      this.svg.addEventListener("pointermove", pick);
      this.svg.addEventListener("pointerdown", pick);
    }
  }

  /** Draws `{ x, y, lines, points, marks, here, range }` anew. */
  draw(content) {
    this.content = content;
    const width = Math.max(220, Math.round(this.host.clientWidth));
    const height = Math.round(this.height(width));
    this.svg.setAttribute("viewBox", `0 0 ${width} ${height}`);
    this.svg.setAttribute("width", width);
    this.svg.setAttribute("height", height);
    const inner = { width: width - MARGIN.left - MARGIN.right, height: height - MARGIN.top - MARGIN.bottom };
    const { lines = [], points = [], marks = [] } = content;
    let xs = content.range?.x ?? extent(lines.map((line) => line.x).concat(points.map((set) => set.x)));
    let ys = content.range?.y ?? extent(lines.map((line) => line.y).concat(points.map((set) => set.y)));
    if (this.equal) {
      const unit = Math.min(inner.width / (xs[1] - xs[0]), inner.height / (ys[1] - ys[0]));
      const around = ([low, high], size) => [0.5 * (low + high - size / unit), 0.5 * (low + high + size / unit)];
      [xs, ys] = [around(xs, inner.width), around(ys, inner.height)];
    }
    const [kx, ky] = [inner.width / (xs[1] - xs[0]), inner.height / (ys[1] - ys[0])];
    this.px = (value) => MARGIN.left + (value - xs[0]) * kx;
    this.py = (value) => MARGIN.top + inner.height - (value - ys[0]) * ky;
    this.axes(content, xs, ys, inner);
    for (const [key, value] of Object.entries({ x: MARGIN.left, y: MARGIN.top, ...inner })) this.clipper.setAttribute(key, value);
    this.layers.lines.replaceChildren(...lines.map((line) => shape("path", {
      d: this.path(line), class: `line ${line.kind ?? ""}`, style: `stroke: ${line.colour}`, "stroke-width": line.width ?? 2,
    })));
    this.layers.points.replaceChildren(...points.map((set) => shape("path", {
      d: this.dots(set), class: "measured", style: `stroke: ${set.colour}`,
    })));
    this.label(marks, lines, inner);
    this.move(content.here);
    this.pixels = null;
  }

  axes(content, xs, ys, inner) {
    const { left, top } = MARGIN;
    const [right, bottom] = [left + inner.width, top + inner.height];
    const [across, down] = [ticksOf(xs, inner.width / 75), ticksOf(ys, inner.height / 45)];
    const parts = [];
    for (const value of across.places) {
      const at = this.px(value).toFixed(1);
      parts.push(shape("path", { d: `M${at} ${top}V${bottom}`, class: "grid" }));
      parts.push(shape("text", { x: at, y: bottom + 17, class: "tick", "text-anchor": "middle" }, across.label(value)));
    }
    for (const value of down.places) {
      const at = this.py(value).toFixed(1);
      parts.push(shape("path", { d: `M${left} ${at}H${right}`, class: value === 0 ? "grid zero" : "grid" }));
      parts.push(shape("text", { x: left - 7, y: Number(at) + 4, class: "tick", "text-anchor": "end" }, down.label(value)));
    }
    parts.push(shape("rect", { x: left, y: top, ...inner, class: "frame" }));
    const middle = { "text-anchor": "middle", class: "title" };
    parts.push(written(content.x + across.power, { x: (left + right) / 2, y: bottom + 39, ...middle }));
    const turn = `translate(15 ${(top + bottom) / 2}) rotate(-90)`;
    parts.push(written(content.y + down.power, { transform: turn, ...middle }));
    this.layers.back.replaceChildren(...parts);
  }

  path({ x, y, from = 0, to = x.length - 1 }) {
    let d = "";
    let pen = false;
    for (let k = from; k <= to; k += 1) {
      if (good(x[k]) && good(y[k])) {
        d += `${pen ? "L" : "M"}${this.px(x[k]).toFixed(2)} ${this.py(y[k]).toFixed(2)}`;
        pen = true;
      } else pen = false;
    }
    return d;
  }

  dots({ x, y }) {
    const seen = new Set();
    let d = "";
    for (let k = 0; k < x.length; k += 1) {
      if (!good(x[k]) || !good(y[k])) continue;
      const place = `${Math.round(this.px(x[k]))} ${Math.round(this.py(y[k]))}`;
      // many samples may fall on one pixel
      if (seen.has(place)) continue;
      seen.add(place);
      d += `M${place}h0`;
    }
    return d;
  }

  /** Marks, the more important ones on top, with their labels where there is room. */
  label(marks, lines, inner) {
    const rank = (kind) => ["fold", "branch-point", "hopf"].includes(kind) ? 2 : kind === "pull-off" ? 1 : 0;
    const inside = marks
      .filter(({ x, y }) => good(x) && good(y))
      .map((mark) => ({ ...mark, left: this.px(mark.x), up: this.py(mark.y) }))
      .filter(({ left, up }) => left >= MARGIN.left - 1 && left <= MARGIN.left + inner.width + 1
        && up >= MARGIN.top - 1 && up <= MARGIN.top + inner.height + 1)
      .sort((a, b) => rank(a.kind) - rank(b.kind));
    const taken = inside.map(({ left, up }) => [left - 6, up - 6, left + 6, up + 6]);
    const places = [];
    for (const { x, y } of lines) {
      for (let k = 0; k < x.length; k += 1) if (good(x[k]) && good(y[k])) places.push([this.px(x[k]), this.py(y[k])]);
    }
    const labels = [];
    for (const mark of [...inside].reverse()) {
      if (!mark.label) continue;
      const [wide, high] = [8 * mark.label.length + 2, 14];
      let best = null;
      for (const away of [11, 20]) {
        for (let turn = 0; turn < 8; turn += 1) {
          const angle = (turn * Math.PI) / 4 - Math.PI / 4;
          const left = mark.left + Math.cos(angle) * (away + wide / 2) - wide / 2;
          const up = mark.up + Math.sin(angle) * (away + high / 2) - high / 2;
          const box = [left, up, left + wide, up + high];
          const covers = (b) => box[0] < b[2] && box[2] > b[0] && box[1] < b[3] && box[3] > b[1];
          let cost = away / 20 + 6 * taken.filter(covers).length;
          for (const [a, b] of places) if (a > box[0] && a < box[2] && b > box[1] && b < box[3]) cost += 1;
          if (box[0] < MARGIN.left || box[2] > MARGIN.left + inner.width || box[1] < MARGIN.top || box[3] > MARGIN.top + inner.height) cost += 20;
          if (!best || cost < best.cost) best = { cost, box };
        }
      }
      taken.push(best.box);
      labels.push(shape("text", {
        x: ((best.box[0] + best.box[2]) / 2).toFixed(1), y: (best.box[3] - 3).toFixed(1), class: "label", "text-anchor": "middle",
      }, mark.label));
    }
    const drawn = inside.map((mark) => {
      const [name, filled] = form(mark.kind);
      const place = `translate(${mark.left.toFixed(2)} ${mark.up.toFixed(2)})`;
      return shape("path", { d: FORMS[name], transform: place, class: `mark ${filled ? "filled" : "hollow"} ${name}`, "data-kind": mark.kind });
    });
    this.layers.marks.replaceChildren(...drawn);
    this.layers.top.replaceChildren(...labels);
  }

  /** The marker of the selected point. */
  move(here) {
    this.content.here = here;
    const visible = here && good(here.x) && good(here.y);
    this.layers.here.replaceChildren(...(visible
      ? [shape("circle", { cx: this.px(here.x).toFixed(2), cy: this.py(here.y).toFixed(2), r: 7 })]
      : []));
  }

  /** The point of the lines that can be picked nearest to a place, or null where none is near. */
  nearest(left, up) {
    this.pixels ??= (this.content?.pick ? [this.content.pick] : []).map(({ x, y }) => (
      x.map((value, k) => (good(value) && good(y[k]) ? [this.px(value), this.py(y[k])] : null))));
    let best = { distance: 40 * 40, at: null };
    for (const places of this.pixels) {
      places.forEach((place, at) => {
        if (!place) return;
        const distance = (place[0] - left) ** 2 + (place[1] - up) ** 2;
        if (distance < best.distance) best = { distance, at };
      });
    }
    return best.at;
  }
}
