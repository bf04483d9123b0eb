(() => {
  "use strict";
  const data = JSON.parse(document.getElementById("data").textContent);
  const { charts, curves } = data;
  const SVG = "http://www.w3.org/2000/svg";
  const element = (name, properties = {}, ...children) => {
    const made = Object.assign(document.createElement(name), properties);
    made.append(...children);
    return made;
  };
  const title = document.getElementById("title");
  title.textContent = data.title;
  document.getElementById("subtitle").textContent = data.subtitle;
  // small letters below and above the line
  const small = (text) => text.split(/([_^]\{[^}]*\})/u).map((part) => (
    /^[_^]\{/u.test(part) ? element(part[0] === "_" ? "sub" : "sup", { textContent: part.slice(2, -1) }) : part));
  document.getElementById("about").append(...small(data.about));

  // ---- units: the page is loaded again in others, at the same point
  const asked = new URLSearchParams(location.hash.slice(1));
  const { laboratory } = data;
  const physical = Boolean(laboratory) && asked.get("units") === "physical";
  const radius = physical ? laboratory.length[1] : 1;
  if (physical) {
    const times = (values, factor) => values.map((value) => (value === null ? null : factor * value));
    for (const curve of curves) {
      for (const [name, values] of Object.entries(curve.columns)) {
        const unit = laboratory.columns[name];
        if (unit) curve.columns[name] = times(values, unit[1]);
      }
      for (const state of curve.states) {
        if (state.plate !== null) state.plate *= radius;
        if (state.below) state.below *= radius;
        state.sigma = times(state.sigma, radius);
        state.z = times(state.z, radius);
        state.pressure = times(state.pressure, laboratory.film[1]);
      }
    }
    for (const chart of charts) if (chart.physical) [chart.x[1], chart.y] = chart.physical;
  }
  const lengths = physical ? ["distance from the axis σ", "height z"].map((name) => `${name} [${laboratory.length[0]}]`)
    : ["distance from the axis σ/R₀", "height z/R₀"];

  // ---- numbers as text
  const words = (name) => {
    const unit = physical ? laboratory.columns[name]?.[0] : null;
    return `${name.replaceAll("_", " ")}${unit ? ` [${unit}]` : ""}`;
  };
  const text = (value) => {
    if (value === null || value === undefined) return "–";
    if (value === 0) return "0";
    const size = Math.abs(value);
    const shown = size >= 1e-3 && size < 1e6 ? String(Number(value.toPrecision(6))) : value.toExponential(4);
    return shown.replace("-", "−").replace("e-", "e−");
  };
  const ticks = (u, splits) => {
    const largest = Math.max(...splits.map(Math.abs));
    const step = splits.length > 1 ? Math.abs(splits[1] - splits[0]) : largest;
    const far = largest >= 1e5 || (largest > 0 && largest < 1e-2);
    let digits = 0;
    while (digits < 12 && Math.abs(step * 10 ** digits - Math.round(step * 10 ** digits)) > 1e-6 * step * 10 ** digits) digits += 1;
    const exponent = far ? Math.floor(Math.log10(largest)) : 0;
    return splits.map((value) => {
      if (Math.abs(value) < step * 1e-6) return "0";
      const shown = far
        ? `${Number((value / 10 ** exponent).toPrecision(4))}e${exponent}`
        : value.toFixed(digits);
      return shown.replaceAll("-", "−");
    });
  };

  // ---- colours of the page's scheme
  const ink = {};
  const readColours = () => {
    const style = getComputedStyle(document.documentElement);
    for (const name of ["back", "ink", "soft", "grid", "edge"]) {
      ink[name] = style.getPropertyValue(`--${name}`).trim();
    }
    ink.curve = [0, 1, 2, 3, 4, 5, 6].map((k) => style.getPropertyValue(`--c${k}`).trim());
  };
  const colour = (k) => ink.curve[k % ink.curve.length];

  // ---- markers of special points
  const FORMS = {
    disc: "M5 0A5 5 0 1 1-5 0A5 5 0 1 1 5 0Z", square: "M-5-5H5V5H-5Z", up: "M0-7L6 5H-6Z",
    down: "M0 7L6-5H-6Z", diamond: "M0-7L6 0L0 7L-6 0Z", cross: "M-5-5L5 5M5-5L-5 5",
  };
  const form = (kind) => {
    if (kind === "fold") return ["disc", true];
    if (kind === "branch-point") return ["square", true];
    if (kind === "zero-force") return ["up", true];
    if (kind === "pull-off") return ["down", true];
    if (kind === "hopf") return ["disc", false];
    if (kind.endsWith("-maximum")) return ["diamond", true];
    if (kind.endsWith("-minimum")) return ["diamond", false];
    return ["cross", false];
  };
  const sketch = (width, ...paths) => {
    const svg = document.createElementNS(SVG, "svg");
    svg.setAttribute("width", width);
    svg.setAttribute("height", 14);
    svg.setAttribute("viewBox", `${-width / 2} -7 ${width} 14`);
    svg.setAttribute("aria-hidden", "true");
    for (const attributes of paths) {
      const path = document.createElementNS(SVG, "path");
      for (const [name, value] of Object.entries(attributes)) path.setAttribute(name, value);
      svg.append(path);
    }
    return svg;
  };
  const glyph = (kind) => {
    const [shape, filled] = form(kind);
    const fill = filled ? "currentColor" : "none";
    return sketch(14, { d: FORMS[shape], fill, stroke: "currentColor", "stroke-width": filled ? 0 : 2 });
  };
  const sample = (stroke, dashes = "none") => sketch(26, {
    d: "M-13 0H13", style: `stroke: ${stroke}`, "stroke-width": 2.5, "stroke-dasharray": dashes,
  });
  const DASHED = "6 4";
  const DOTTED = "2 3";

  // ---- the curves: stretches of one stability, neighbours sharing the point between them
  const marked = curves.map((curve) => new Map(curve.marks.map((mark) => [mark.point, mark.kind])));
  const stretches = (curve, k) => {
    const bad = (i) => curve.unstable[i] > 0;
    // where stability changes at a special point the segment goes with its other end
    const dashed = (i) => (bad(i) === bad(i + 1) || !(marked[k].has(i) && !marked[k].has(i + 1)) ? bad(i) : bad(i + 1));
    const found = [];
    const jumps = new Set(curve.jumps);
    for (let i = 0; i + 1 < curve.unstable.length; i += 1) {
      const last = found[found.length - 1];
      if (jumps.has(i + 1)) found.push({ from: i, to: i + 1, dashed: false, jump: true });
      else if (last && !last.jump && last.dashed === dashed(i)) last.to = i + 1;
      else found.push({ from: i, to: i + 1, dashed: dashed(i) });
    }
    return found;
  };
  curves.forEach((curve, k) => {
    curve.size = curve.unstable.length;
    // what rounding leaves of zero
    for (const values of Object.values(curve.columns)) {
      const least = 1e-12 * values.reduce((largest, value) => Math.max(largest, Math.abs(value ?? 0)), 0);
      values.forEach((value, i) => { if (value !== null && Math.abs(value) < least) values[i] = 0; });
    }
    curve.stretches = stretches(curve, k);
    curve.point = 0;
  });

  const opened = Number(asked.get("curve") ?? data.selected) || 0;
  const selected = { curve: Math.min(Math.max(0, opened), Math.max(0, curves.length - 1)) };
  if (curves.length > 0) {
    const at = Number(asked.get("point")) || 0;
    curves[selected.curve].point = Math.min(Math.max(0, at), curves[selected.curve].size - 1);
  }
  const current = () => curves[selected.curve];
  const state = (curve) => {
    // the nearest one that is kept
    let low = 0;
    let high = curve.states.length - 1;
    while (low < high) {
      const middle = (low + high) >> 1;
      if (curve.states[middle].point < curve.point) low = middle + 1;
      else high = middle;
    }
    const before = curve.states[low - 1];
    const here = curve.states[low];
    return before && curve.point - before.point < here.point - curve.point ? before : here;
  };

  // ---- figures
  const extent = (lists, room = 0.04) => {
    let low = Infinity;
    let high = -Infinity;
    for (const list of lists) {
      for (const value of list) {
        if (value !== null && value !== undefined) {
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

  const AXIS = { x: 46, y: 72, top: 8, right: 14 };
  const TOGETHER = 8;
  const figures = [];

  /** One chart: `lines()` says what is drawn in it, `range(axis)` what it shows. */
  const figure = ({ name, kind, x, y, height, range: whole, lines, marks, point, pick, legend, zooms }) => {
    const caption = element("figcaption", {}, element("span", { textContent: name }));
    const place = element("div");
    const key = element("div", { className: "legend" });
    const host = element("figure", { className: kind }, caption, place, key);
    host.setAttribute("aria-label", name);
    if (kind === "first" || kind.includes("shape")) document.getElementById("state").before(host);
    else document.getElementById("charts").append(host);
    const here = element("div", { className: "here", hidden: true });
    const self = { kind, host, key, legend, point, pixels: null, view: null };
    const range = (scale) => self.view?.[scale] ?? whole(scale, self);
    const width = () => Math.max(240, place.clientWidth);
    const font = "12px system-ui, sans-serif";
    const axis = (scale, label, size) => ({
      scale, label, size, font, labelFont: `13px system-ui, sans-serif`, labelSize: 20, labelGap: 0,
      stroke: () => ink.ink, values: ticks, space: scale === "x" ? 58 : 34,
      grid: { stroke: () => ink.grid, width: 1 }, ticks: { stroke: () => ink.edge, width: 1, size: 5 },
    });
    /** The head of an arrow in the middle of a jump. */
    const arrow = (u, line, ratio) => {
      const ends = [line.from, line.to].map((i) => [line.x[i], line.y[i]]);
      if (ends.flat().some((value) => value === null || value === undefined)) return;
      const [[x0, y0], [x1, y1]] = ends.map(([a, b]) => [u.valToPos(a, "x", true), u.valToPos(b, "y", true)]);
      if (Math.hypot(x1 - x0, y1 - y0) < 14 * ratio) return;
      const { ctx } = u;
      ctx.save();
      ctx.translate(0.5 * (x0 + x1), 0.5 * (y0 + y1));
      ctx.rotate(Math.atan2(y1 - y0, x1 - x0));
      ctx.scale(ratio, ratio);
      ctx.fillStyle = line.colour;
      ctx.fill(new Path2D("M7 0L-5 5V-5Z"));
      ctx.restore();
    };
    const draw = (u) => {
      const { ctx, bbox } = u;
      const ratio = devicePixelRatio;
      ctx.save();
      ctx.beginPath();
      ctx.rect(bbox.left, bbox.top, bbox.width, bbox.height);
      ctx.clip();
      ctx.lineJoin = "round";
      for (const line of lines(u)) {
        ctx.strokeStyle = line.colour;
        ctx.lineWidth = line.width * ratio;
        const dashes = line.jump ? [2, 3] : line.dashed ? [7, 5] : [];
        ctx.setLineDash(dashes.map((length) => length * ratio));
        ctx.beginPath();
        let pen = false;
        for (let i = line.from; i <= line.to; i += 1) {
          const a = line.x[i];
          const b = line.y[i];
          if (a === null || b === null || a === undefined || b === undefined) {
            pen = false;
            continue;
          }
          const left = u.valToPos((line.right ?? 1) * a, "x", true);
          const top = u.valToPos((line.up ?? 1) * b, "y", true);
          if (pen) ctx.lineTo(left, top);
          else ctx.moveTo(left, top);
          pen = true;
        }
        ctx.stroke();
        if (line.jump) arrow(u, line, ratio);
      }
      ctx.setLineDash([]);
      for (const mark of marks ? marks() : []) {
        if (mark.x === null || mark.y === null) continue;
        const [shape, filled] = form(mark.kind);
        const path = new Path2D(FORMS[shape]);
        ctx.save();
        ctx.translate(u.valToPos(mark.x, "x", true), u.valToPos(mark.y, "y", true));
        ctx.scale(ratio, ratio);
        ctx.lineWidth = 4;
        ctx.strokeStyle = ink.back;
        ctx.stroke(path);
        if (filled) {
          ctx.fillStyle = ink.ink;
          ctx.fill(path);
        } else {
          if (shape !== "cross") {
            ctx.fillStyle = ink.back;
            ctx.fill(path);
          }
          ctx.lineWidth = 2;
          ctx.strokeStyle = ink.ink;
          ctx.stroke(path);
        }
        ctx.restore();
      }
      ctx.restore();
    };
    const u = new uPlot({
      mode: 2, width: width(), height: height(width()), padding: [AXIS.top, AXIS.right, 0, 0],
      legend: { show: false }, cursor: { show: false }, hooks: { draw: [draw] },
      scales: { x: { time: false, range: () => range("x") }, y: { range: () => range("y") } },
      axes: [axis("x", x, AXIS.x - 20), axis("y", y, AXIS.y - 20)],
      series: [{}, { facets: [{ scale: "x", auto: true }, { scale: "y", auto: true }], paths: () => null }],
    }, [null, [[0, 1], [0, 1]]], place);
    self.u = u;
    const canvas = place.querySelector("canvas");
    canvas.setAttribute("role", "img");
    canvas.setAttribute("aria-label", `${name}: ${y} over ${x}`);
    u.over.append(here);

    /** The marker of the selected point. */
    self.move = () => {
      const at = point ? point() : null;
      here.hidden = !at || at.x === null || at.y === null || at.x === undefined || at.y === undefined;
      if (here.hidden) return;
      const [left, top] = [u.valToPos(at.x, "x"), u.valToPos(at.y, "y")];
      const [right, bottom] = [u.bbox.width / devicePixelRatio, u.bbox.height / devicePixelRatio];
      here.hidden = left < 0 || top < 0 || left > right || top > bottom;
      here.style.transform = `translate(${left}px, ${top}px)`;
    };
    self.redraw = () => u.redraw(false, false);
    self.rescale = () => {
      self.pixels = null;
      u.batch(() => {
        for (const scale of ["x", "y"]) {
          const [min, max] = range(scale);
          u.setScale(scale, { min, max });
        }
      });
    };
    self.resize = () => {
      const now = width();
      if (now === u.width) return;
      u.setSize({ width: now, height: height(now) });
      self.rescale();
    };
    /** Shows a part around the selected point, or all again. */
    const zoom = (factor) => {
      const at = point();
      const view = {};
      for (const scale of ["x", "y"]) {
        const [low, high] = range(scale);
        const [bottom, top] = whole(scale, self);
        const half = 0.5 * factor * (high - low);
        if (!(half < 0.499 * (top - bottom)) || at[scale] === null || at[scale] === undefined) {
          self.view = null;
          break;
        }
        view[scale] = [at[scale] - half, at[scale] + half];
        if (scale === "y") self.view = view;
      }
      self.rescale();
      self.move();
    };
    if (zooms) {
      const button = (sign, label, factor) => {
        const made = element("button", { type: "button", textContent: sign, title: label });
        made.setAttribute("aria-label", `${label}: ${name}`);
        made.addEventListener("click", () => zoom(factor));
        caption.append(made);
      };
      button("+", "zoom in on the selected point", 0.5);
      button("−", "zoom out", 2);
      button("⤢", "show all", Infinity);
    }
    /** The point nearest to a place of the pointer, if it is near enough. */
    self.nearest = (left, top, reach) => {
      self.pixels ??= pick().map((line) => {
        const places = new Float64Array(2 * line.x.length);
        line.x.forEach((value, i) => {
          const good = value !== null && line.y[i] !== null;
          places[2 * i] = good ? u.valToPos(value, "x") : NaN;
          places[2 * i + 1] = good ? u.valToPos(line.y[i], "y") : NaN;
        });
        return { curve: line.curve, places };
      });
      const none = { distance: reach * reach };
      let best = none;
      let own = none;
      for (const { curve, places } of self.pixels) {
        for (let i = 0; i < places.length; i += 2) {
          const distance = (places[i] - left) ** 2 + (places[i + 1] - top) ** 2;
          if (distance < best.distance) best = { curve, point: i / 2, distance };
          if (curve === selected.curve && distance < own.distance) own = { curve, point: i / 2, distance };
        }
      }
      // where curves run together, the selected one stays selected
      const near = Math.sqrt(own.distance) < Math.sqrt(best.distance) + TOGETHER;
      if (own !== none && near) best = own;
      return best === none ? null : best;
    };
    if (pick) {
      const heard = (event, reach) => want({ figure: self, left: event.offsetX, top: event.offsetY, reach });
      u.over.addEventListener("pointermove", (event) => {
        if (event.pointerType === "mouse" || event.buttons) heard(event, 60);
      });
      u.over.addEventListener("pointerdown", (event) => heard(event, Infinity));
    }
    figures.push(self);
    return self;
  };

  // ---- moving along the curves, once for each frame
  let wanted = null;
  const want = (what) => {
    if (!wanted) requestAnimationFrame(fulfil);
    wanted = what;
  };
  const fulfil = () => {
    const { figure: from, left, top, reach, curve, point } = wanted;
    wanted = null;
    const found = from ? from.nearest(left, top, reach) : { curve, point };
    if (found && (found.curve !== selected.curve || found.point !== curves[found.curve].point)) {
      select(found.curve, found.point);
    }
  };
  const select = (k, point) => {
    const other = k !== selected.curve;
    selected.curve = k;
    curves[k].point = Math.min(curves[k].size - 1, Math.max(0, point));
    show(other);
  };

  // ---- the sliders, one for each curve
  const sliders = curves.map((curve, k) => {
    const input = element("input", { type: "range", id: `curve-${k}`, min: 0, max: curve.size - 1, step: 1, value: 0 });
    const output = element("output", { htmlFor: `curve-${k}` });
    const swatch = element("i");
    swatch.style.background = `var(--c${k % 7})`;
    const label = element("label", { htmlFor: `curve-${k}`, textContent: curve.label, title: curve.label });
    const row = element("div", { className: "curve" }, swatch, label, input, output);
    input.addEventListener("input", () => want({ curve: k, point: Number(input.value) }));
    input.addEventListener("focus", () => want({ curve: k, point: Number(input.value) }));
    document.getElementById("curves").append(row);
    return { row, input, output };
  });
  document.addEventListener("keydown", (event) => {
    const step = { ArrowRight: 1, ArrowLeft: -1 }[event.key];
    const busy = event.target.closest?.("input, .scroll") || event.ctrlKey || event.altKey || event.metaKey;
    if (!step || busy) return;
    event.preventDefault();
    want({ curve: selected.curve, point: current().point + step });
  });

  // ---- the state and the special points, in numbers
  const names = [...new Set(curves.flatMap((curve) => Object.keys(curve.columns)))];
  const flags = [...new Set(curves.flatMap((curve) => Object.keys(curve.flags)))];
  const fields = new Map(["curve", ...names, ...flags, "stability", "special point"].map((name) => [name, element("dd")]));
  document.getElementById("state").append(element("dl", {},
    ...[...fields].map(([name, field]) => element("div", {}, element("dt", { textContent: words(name) }), field))));
  const stability = (unstable) => (unstable < 0 ? "not known"
    : unstable === 0 ? "stable" : `unstable (${unstable} mode${unstable > 1 ? "s" : ""})`);

  const main = charts[0];
  const shown = main ? [...new Set([...charts.map((chart) => chart.x[0]), main.columns[0][0]])] : [];
  const rows = new Map();
  // the counts on both sides, as the program writes them
  const passage = (curve, { point, unstable }) => {
    const known = (count) => (count === undefined || count === null || count < 0 ? "–" : String(count));
    const [before, after] = (unstable ?? [curve.unstable[point - 1], curve.unstable[point + 1]]).map(known);
    return before === after ? before : `${before} → ${after}`;
  };
  const table = document.getElementById("events");
  const several = curves.length > 1;
  const titles = ["kind", ...(several ? ["curve"] : []), ...shown.map(words), "unstable"];
  table.append(element("thead", {}, element("tr", {},
    ...titles.map((name) => element("th", { scope: "col", textContent: name })))));
  const body = element("tbody");
  table.append(body);
  curves.forEach((curve, k) => curve.marks.forEach((mark) => {
    const button = element("button", { type: "button" }, glyph(mark.kind), mark.kind);
    button.addEventListener("click", () => want({ curve: k, point: mark.point }));
    const cells = shown.map((name) => text(curve.columns[name]?.[mark.point]));
    const row = element("tr", {}, element("td", {}, button),
      ...[...(several ? [curve.label] : []), ...cells, passage(curve, mark)].map((cell) =>
        element("td", { textContent: cell })));
    // on narrow screens every cell stands under its own title
    [...row.cells].forEach((cell, j) => { cell.dataset.title = titles[j]; });
    rows.set(`${k}/${mark.point}`, row);
    body.append(row);
  }));
  document.getElementById("special").hidden = rows.size === 0;

  let lit = null;
  const showNumbers = () => {
    const curve = current();
    const at = curve.point;
    const kind = marked[selected.curve].get(at);
    const put = (name, value) => {
      const field = fields.get(name);
      if (field.textContent !== value) field.textContent = value;
    };
    put("curve", `${curve.label}, point ${at + 1} of ${curve.size}`);
    for (const name of names) put(name, text(curve.columns[name]?.[at]));
    for (const name of flags) {
      const flag = curve.flags[name]?.[at];
      put(name, flag === undefined ? "–" : flag ? "yes" : "no");
    }
    put("stability", stability(curve.unstable[at]));
    put("special point", kind ?? "–");
    const { input, output } = sliders[selected.curve];
    if (Number(input.value) !== at) input.value = at;
    output.textContent = `${at + 1} / ${curve.size}`;
    const values = shown.map((name) => `${words(name)} ${text(curve.columns[name]?.[at])}`);
    input.setAttribute("aria-valuetext",
      [`point ${at + 1} of ${curve.size}`, ...values, stability(curve.unstable[at]), ...(kind ? [kind] : [])].join(", "));
    lit?.classList.remove("selected");
    lit = rows.get(`${selected.curve}/${at}`) ?? null;
    lit?.classList.add("selected");
  };

  const show = (other) => {
    if (other) {
      sliders.forEach(({ row }, k) => row.classList.toggle("selected", k === selected.curve));
      for (const one of figures) {
        if (one.kind.includes("own")) one.rescale();
        else one.redraw();
        one.legend?.(one.key);
      }
    }
    for (const one of figures) {
      if (!other && one.kind.includes("live")) one.redraw();
      one.move();
    }
    showNumbers();
  };

  // ---- what the charts show
  const column = (curve, name) => curve.columns[name] ?? [];
  const kinds = [...new Set(curves.flatMap((curve) => curve.marks.map((mark) => mark.kind)))];
  const anyUnstable = curves.some((curve) => curve.stretches.some((stretch) => stretch.dashed));
  const legendOf = (key, entries) => key.replaceChildren(...entries.map(([picture, label]) => element("span", {}, picture, label)));
  const anyJump = curves.some((curve) => curve.stretches.some((stretch) => stretch.jump));
  const lineKey = () => [
    [sample("var(--soft)"), "stable"],
    ...(anyUnstable ? [[sample("var(--soft)", DASHED), "unstable"]] : []),
    ...(anyJump ? [[sample("var(--soft)", DOTTED), "jump"]] : []),
  ];
  const states = curves.some((curve) => curve.states.length > 0);

  const of_curves = (chart, first) => {
    const [x, xTitle] = chart.x;
    const y = chart.columns[0][0];
    const limits = { x: extent(curves.map((c) => column(c, x))), y: extent(curves.map((c) => column(c, y))) };
    return {
      name: chart.title, kind: first ? "first" : "", x: xTitle, y: chart.y, zooms: true,
      height: (width) => Math.round(Math.min(first ? 470 : 360, Math.max(260, 0.72 * width))),
      range: (scale) => limits[scale],
      lines: () => {
        const order = curves.map((_, k) => k).filter((k) => k !== selected.curve).concat(selected.curve);
        return order.flatMap((k) => curves[k].stretches.map((stretch) => ({
          ...stretch, x: column(curves[k], x), y: column(curves[k], y), colour: colour(k),
          width: stretch.jump ? 1.5 : several && k === selected.curve ? 3.2 : 2,
        })));
      },
      marks: () => curves.flatMap((curve) => curve.marks.map(({ point, kind }) => (
        { kind, x: column(curve, x)[point] ?? null, y: column(curve, y)[point] ?? null }))),
      point: () => ({ x: column(current(), x)[current().point], y: column(current(), y)[current().point] }),
      pick: () => curves.map((curve, k) => ({ curve: k, x: column(curve, x), y: column(curve, y) })),
      legend: (key) => legendOf(key, [...lineKey(), ...(first ? kinds.map((kind) => [glyph(kind), kind === "jump" ? "after a jump" : kind]) : [])]),
    };
  };
  const of_parts = (chart) => {
    const [x, xTitle] = chart.x;
    const parts = () => chart.columns.map(([name]) => column(current(), name));
    const hue = (k) => (k === 0 ? 6 : k - 1);
    return {
      name: chart.title, kind: "own", x: xTitle, y: chart.y,
      height: (width) => Math.round(Math.min(360, Math.max(260, 0.72 * width))),
      range: (scale) => extent(scale === "x" ? [column(current(), x)] : parts()),
      lines: () => parts().flatMap((values, k) => current().stretches.map((stretch) => (
        { ...stretch, x: column(current(), x), y: values, colour: colour(hue(k)), width: stretch.jump ? 1.2 : 2 }))),
      point: () => ({ x: column(current(), x)[current().point], y: parts()[0][current().point] }),
      pick: () => parts().map((values) => ({ curve: selected.curve, x: column(current(), x), y: values })),
      legend: (key) => legendOf(key, [...chart.columns.map(([, label], k) => [sample(`var(--c${hue(k)})`), label]), ...lineKey().slice(1)]),
    };
  };
  const of_shape = () => {
    const all = curves.flatMap((curve) => curve.states);
    const wide = 1.06 * Math.max(radius, ...all.map((one) => Math.max(...one.sigma)));
    const high = 1.06 * Math.max(radius, ...all.map((one) => Math.max(...one.z.map(Math.abs))));
    const turn = Array.from({ length: 121 }, (_, i) => (i * Math.PI) / 60);
    const rest = { x: turn.map((a) => radius * Math.cos(a)), y: turn.map((a) => radius * Math.sin(a)), from: 0, to: 120, width: 1, dashed: true };
    return {
      name: "Shape", kind: "shape live", x: lengths[0], y: lengths[1],
      height: (width) => Math.round(Math.min(470, Math.max(280, 0.92 * width))),
      range: (scale, self) => {
        // one unit is as long on both axes
        const width = (self.u?.width ?? 400) - AXIS.y - AXIS.right;
        const height = (self.u?.height ?? 400) - AXIS.x - AXIS.top;
        const unit = Math.min(width / wide, height / high);
        const half = (scale === "x" ? width : height) / unit;
        return [-half, half];
      },
      lines: (u) => {
        const one = state(current());
        if (!one) return [];
        const end = u.scales.x.max;
        const dashed = current().unstable[current().point] > 0;
        // a meridian from pole to pole has a plate of its own at either
        const whole = "below" in one;
        const heights = (whole ? [one.plate, one.below] : one.plate === null ? [] : [one.plate, -one.plate]).filter((z) => z !== null);
        const plates = heights.map((z) => (
          { x: [-end, end], y: [z, z], from: 0, to: 1, colour: ink.ink, width: 2.5 }));
        const images = [[1, 1], [-1, 1], ...(whole ? [] : [[1, -1], [-1, -1]])];
        const quarters = images.map(([right, up]) => (
          { x: one.sigma, y: one.z, from: 0, to: one.sigma.length - 1, right, up, colour: colour(selected.curve), width: 2.5, dashed }));
        return [{ ...rest, colour: ink.soft }, ...plates, ...quarters];
      },
      legend: (key) => legendOf(key, [[sample("var(--ink)"), data.bounds], [sample("var(--soft)", DASHED), "sphere at rest"]]),
    };
  };
  const of_pressure = () => {
    const limits = curves.map((curve) => ({
      x: [0, 1.04 * Math.max(0.1 * radius, ...curve.states.map((one) => Math.max(...one.sigma)))],
      y: extent(curve.states.map((one) => one.pressure)),
    }));
    return {
      name: "Pressure of the film", kind: "own live", x: lengths[0],
      y: physical ? `pressure Π [${laboratory.film[0]}]` : "pressure Π δ_A/w₀",
      height: (width) => Math.round(Math.min(360, Math.max(260, 0.72 * width))),
      range: (scale) => limits[selected.curve][scale],
      lines: () => {
        const one = state(current());
        if (!one) return [];
        const last = one.sigma.length - 1;
        const line = { x: one.sigma, y: one.pressure, width: 2, dashed: current().unstable[current().point] > 0 };
        if (!("below" in one)) return [{ ...line, from: 0, to: last, colour: colour(selected.curve) }];
        // the films of both plates, from their poles to the widest place
        const middle = one.sigma.indexOf(Math.max(...one.sigma));
        return [
          { ...line, from: middle, to: last, colour: ink.soft, width: 3.5 },
          { ...line, from: 0, to: middle, colour: colour(selected.curve) },
        ];
      },
      legend: (key) => {
        if (curves.some((curve) => curve.states.some((one) => "below" in one))) {
          legendOf(key, [[sample(`var(--c${selected.curve})`), "upper plate"], [sample("var(--soft)"), "lower plate"]]);
        }
      },
    };
  };

  readColours();
  if (main) figure(main.columns.length > 1 ? of_parts(main) : of_curves(main, true));
  if (states) figure(of_shape());
  for (const chart of charts.slice(1)) figure(chart.columns.length > 1 ? of_parts(chart) : of_curves(chart, false));
  if (curves.some((curve) => curve.states.some((one) => one.pressure.length > 0))) figure(of_pressure());
  document.getElementById("charts").classList.toggle("alone", !states);
  // the shape's units depend on its size, which is known only now
  for (const one of figures) {
    one.rescale();
    one.legend?.(one.key);
  }
  matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => {
    readColours();
    for (const one of figures) one.redraw();
  });
  new ResizeObserver(() => {
    for (const one of figures) {
      one.resize();
      one.move();
    }
  }).observe(document.getElementById("charts"));
  sliders.forEach(({ output }, k) => { output.textContent = `1 / ${curves[k].size}`; });
  if (laboratory) {
    const choice = document.getElementById("units");
    choice.hidden = false;
    for (const button of choice.querySelectorAll("button")) {
      const here = (button.value === "physical") === physical;
      button.setAttribute("aria-pressed", String(here));
      button.addEventListener("click", () => {
        if (here) return;
        location.hash = `units=${button.value}&curve=${selected.curve}&point=${current()?.point ?? 0}`;
        location.reload();
      });
    }
  }
  if (curves.length > 0) show(true);
})();
