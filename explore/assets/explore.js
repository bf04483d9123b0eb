// The live page: sliders ask for branches, one at a time, the latest value next; charts follow.

import { Chart, extent, form, FORMS, shape } from "./chart.js";

const byId = (id) => document.getElementById(id);
const element = (name, properties = {}, ...children) => {
  const made = Object.assign(document.createElement(name), properties);
  made.append(...children);
  return made;
};
const good = (value) => value !== null && value !== undefined && Number.isFinite(value);

// ---- text
const text = (value) => {
  if (!good(value)) return "–";
  if (value === 0) return "0";
  const size = Math.abs(value);
  const shown = size >= 1e-3 && size < 1e6 ? String(Number(value.toPrecision(6))) : value.toExponential(4);
  return shown.replace("-", "−").replace("e-", "e−");
};
const words = (name) => name.replaceAll("_", " ");
const UNITS = {
  R0: "R_{0}", "R0^3": "R_{0}^{3}", "chi/R0": "χ/R_{0}", "chi R0^2": "χR_{0}^{2}", chi: "χ", "sqrt(chi k_b)": "√(χk_{b})",
  "2e-6 pi chi R0": "2·10^{−6} πχR_{0}", degrees: "°", "w0/delta_A": "w_{0}/δ_{A}", "sqrt(chi k_b)/R0": "√(χk_{b})/R_{0}",
  um: "µm", uN: "µN", "nm^3": "nm^{3}", "um^3": "µm^{3}", "mm^3": "mm^{3}",
};
const unitText = (unit) => UNITS[unit] ?? unit;
/** The same without small letters, for text outside of charts. */
const flat = (markup) => markup.replace(/\^\{3\}/gu, "³").replace(/\^\{2\}/gu, "²").replace(/_\{0\}/gu, "₀").replace(/[_^]\{([^}]*)\}/gu, "$1");

/** Small letters below and above the line, outside of charts. */
const small = (markup) => markup.split(/([_^]\{[^}]*\})/u).map((part) => (
  /^[_^]\{/u.test(part) ? element(part[0] === "_" ? "sub" : "sup", { textContent: part.slice(2, -1) }) : part));

// ---- what is shown
const view = {
  description: null, branch: null, exact: false, physical: false, x: null, y: null,
  along: 0, point: 0, pins: [], measured: null, changed: new Map(), settled: [],
};
const HUES = ["c1", "c2", "c3", "c4", "c5", "c6"];
const WORDS = {
  unstable: "unstable to modes of its own symmetry", asymmetric: "unstable to other modes only",
  unknown: "stability not known, or not certain",
};

/** A number's factor and unit in the units that are chosen. */
const scale = (name, branch = view.branch) => {
  const about = branch.about[name];
  if (view.physical && about?.physical) return { factor: about.physical[1], unit: about.physical[0] };
  return { factor: 1, unit: about?.unit ?? "" };
};
const column = (name, branch = view.branch) => {
  const values = branch.columns[name] ?? [];
  const { factor } = scale(name, branch);
  return factor === 1 ? values : values.map((value) => (value === null ? null : factor * value));
};
const axisTitle = (name) => {
  const { label } = view.branch.about[name] ?? { label: name };
  const { unit } = scale(name);
  return unit ? `${label} [${unitText(unit)}]` : words(label);
};

/** Sums of the changes of the parameter along a branch: a place that stays where it is while others move. */
const travelled = (branch) => {
  let sum = 0;
  const parameter = branch.columns[branch.parameter] ?? [];
  return parameter.map((value, k) => {
    if (k > 0 && good(value) && good(parameter[k - 1])) sum += Math.abs(value - parameter[k - 1]);
    return sum;
  });
};
const nearest = (places, place) => places.reduce((best, own, k) => (
  Math.abs(own - place) < Math.abs(places[best] - place) ? k : best), 0);

/** Stretches of one kind of line; where its ends differ a segment takes what promises less, or the side of the mark. */
const stretches = (branch) => {
  const { stability, special } = branch;
  const marked = new Set(special.map(({ point }) => point));
  const kind = (k) => {
    const [a, b] = [stability[k], stability[k + 1]];
    if (a === b) return a;
    if (a === "unknown" || b === "unknown") return "unknown";
    if (marked.has(k) !== marked.has(k + 1)) return marked.has(k) ? b : a;
    return a.startsWith("stable") ? b : a;
  };
  const found = [];
  for (let k = 0; k + 1 < stability.length; k += 1) {
    const last = found[found.length - 1];
    if (last && last.kind === kind(k)) last.to = k + 1;
    else found.push({ from: k, to: k + 1, kind: kind(k) });
  }
  return found;
};

// ---- charts
const charts = {
  main: new Chart(byId("main-chart"), {
    name: "Curves", height: (width) => (width < 500 ? 250 : Math.min(540, Math.max(300, 0.6 * width))),
    onPick: (point) => select(point),
  }),
  shape: new Chart(byId("shape").querySelector(".host"), {
    name: "Shape", height: (width) => Math.min(430, Math.max(240, 0.9 * width)), equal: true,
  }),
  film: new Chart(byId("film").querySelector(".host"), {
    name: "Pressure of the film", height: (width) => Math.min(430, Math.max(240, 0.9 * width)),
  }),
  energies: new Chart(byId("energies").querySelector(".host"), {
    name: "Energies", height: (width) => Math.min(400, Math.max(220, 0.8 * width)),
  }),
};
const ENERGIES = ["energy_total", "energy_stretching", "energy_bending", "energy_film", "energy_gas", "energy_surface"];
const hue = (k) => `var(--c${k === 0 ? 6 : k - 1})`;
const linesOf = (branch, x, y, colour, width) => branch.stretches.map((stretch) => ({ ...stretch, x, y, colour, width }));
const marksOf = (branch, x, y) => branch.special
  // of the many losses of symmetry, those where the line changes
  .filter(({ kind, point }) => kind !== "symmetry-breaking" || branch.stability[point - 1] !== branch.stability[point + 1])
  .map(({ point, kind, label }) => ({ kind, label, x: x[point], y: y[point] }));

const drawMain = () => {
  const { branch, x, y } = view;
  const [xs, ys] = [column(x), column(y)];
  const lines = view.pins
    .filter((pin) => pin.branch.columns[x] && pin.branch.columns[y])
    .flatMap((pin) => linesOf(pin.branch, column(x, pin.branch), column(y, pin.branch), `var(--${pin.hue})`, 1.6));
  charts.main.draw({
    x: axisTitle(x), y: axisTitle(y),
    lines: [...lines, ...linesOf(branch, xs, ys, "var(--c0)", 2.4)],
    points: view.measured ? [{ ...measuredPoints(), colour: "var(--measured)" }] : [],
    marks: marksOf(branch, xs, ys),
    pick: { x: xs, y: ys },
    here: { x: xs[view.point], y: ys[view.point] },
  });
};

const sample = (kind, colour = "currentColor") => {
  const svg = shape("svg", { width: 26, height: 12, viewBox: "0 0 26 12", "aria-hidden": "true" });
  svg.append(shape("path", { d: "M0 6H26", class: `line ${kind}`, style: `stroke: ${colour}`, "stroke-width": kind === "stable" ? 2.4 : 2 }));
  return svg;
};
const glyph = (kind) => {
  const [name, filled] = form(kind);
  const svg = shape("svg", { width: 16, height: 16, viewBox: "-8 -8 16 16", "aria-hidden": "true" });
  svg.append(shape("path", { d: FORMS[name], class: `mark ${filled ? "filled" : "hollow"} ${name}` }));
  return svg;
};
const drawKey = () => {
  const { branch } = view;
  const kinds = new Set(branch.stretches.map(({ kind }) => kind));
  const label = (kind) => (kind.startsWith("stable") ? branch.examined : WORDS[kind]);
  const lines = ["stable", "stable-to-some", "unstable", "asymmetric", "unknown"].filter((kind) => kinds.has(kind));
  const marks = [...new Set(marksOf(branch, [], []).map(({ kind }) => kind))];
  byId("key").replaceChildren(
    ...lines.map((kind) => element("li", {}, sample(kind), label(kind))),
    ...marks.map((kind) => element("li", {}, glyph(kind), kind)),
  );
};

const turn = Array.from({ length: 121 }, (_, k) => (k * Math.PI) / 60);
/** The state at the selected point, or the nearest one that is there. */
const stateHere = () => {
  const { states } = view.branch;
  return states.reduce((best, one) => (
    !best || Math.abs(one.point - view.point) < Math.abs(best.point - view.point) ? one : best), null);
};
const drawState = () => {
  const one = stateHere();
  const { branch } = view;
  byId("shape").hidden = !one;
  byId("film").hidden = !one || one.pressure.length === 0;
  if (!one) return;
  // while something moves only one state is there: of another point it is not shown as that of this one
  const stale = !view.exact && Math.abs(one.point - view.point) > 1;
  for (const id of ["shape", "film"]) byId(id).classList.toggle("stale", stale);
  const { factor, unit } = scale(branch.about.z0 ? "z0" : "pole_height");
  const times = (values, by = factor) => values.map((value) => by * value);
  const kind = branch.stability[one.point] ?? "unknown";
  const plates = good(one.plate) ? [one.plate, -one.plate] : [];
  const quarters = [[1, 1], [-1, 1], [1, -1], [-1, -1]].map(([right, up]) => (
    { x: times(one.sigma, right * factor), y: times(one.z, up * factor), colour: "var(--c0)", width: 2.2, kind }));
  const most = Math.max(1, ...one.sigma, one.plate ?? 0) * 1.06 * factor;
  charts.shape.draw({
    x: `distance from the axis [${unitText(unit)}]`, y: `height [${unitText(unit)}]`,
    range: { x: [-most, most], y: [-most, most] },
    lines: [
      { x: times(turn.map(Math.cos)), y: times(turn.map(Math.sin)), colour: "var(--edge)", width: 1, kind: "rest" },
      ...plates.map((z) => ({ x: [-most, most], y: [z * factor, z * factor], colour: "var(--ink)", width: 2 })),
      ...quarters,
    ],
  });
  if (one.pressure.length === 0) return;
  const film = view.physical && branch.film ? { factor: branch.film[1], unit: branch.film[0] } : { factor: 1, unit: "w0/delta_A" };
  charts.film.draw({
    x: `distance from the axis [${unitText(unit)}]`, y: `pressure [${unitText(film.unit)}]`,
    lines: [{ x: times(one.sigma), y: times(one.pressure, film.factor), colour: "var(--c0)", width: 2, kind }],
  });
};

const drawEnergies = () => {
  const names = ENERGIES.filter((name) => view.branch.columns[name]?.some((value) => good(value) && value !== 0));
  byId("energies").hidden = names.length === 0;
  if (names.length === 0) return;
  const xs = column(view.x);
  const all = names.map((name) => column(name));
  charts.energies.draw({
    x: axisTitle(view.x), y: `energy [${unitText(scale(names[0]).unit)}]`,
    lines: all.flatMap((values, k) => linesOf(view.branch, xs, values, hue(k), 1.7)),
    here: { x: xs[view.point], y: all[0][view.point] },
  });
  byId("energies").querySelector(".legend").replaceChildren(...names.map((name, k) => (
    element("li", {}, sample("stable", hue(k)), name.replace("energy_", "")))));
};

const STABILITY = { stable: "stable", "stable-to-some": "", unstable: "unstable", asymmetric: "unstable to asymmetric modes", unknown: "stability not known" };
const stabilityHere = () => {
  const kind = view.branch.stability[view.point];
  return kind === "stable-to-some" ? view.branch.examined : STABILITY[kind] ?? "";
};
const drawNumbers = () => {
  const { branch, point } = view;
  const special = branch.special.filter((one) => one.point === point).map(({ kind, label }) => (label ? `${label} (${kind})` : kind));
  const rows = Object.keys(branch.columns)
    .filter((name) => branch.columns[name].some(good))
    .map((name) => {
      const { factor, unit } = scale(name);
      const value = branch.columns[name][point];
      return [words(name), `${text(good(value) ? factor * value : null)} ${flat(unitText(unit))}`.trim()];
    });
  const all = [["stability", stabilityHere()], ...special.map((one) => ["special point", one]), ...rows];
  byId("numbers").replaceChildren(...all.map(([name, value]) => (
    element("div", { className: name === "stability" ? "wide" : "" }, element("dt", { textContent: name }), element("dd", { textContent: value })))));
  const slider = byId("along");
  slider.max = Math.max(0, branch.stability.length - 1);
  slider.value = point;
  byId("place").textContent = `${point + 1} / ${branch.stability.length}`;
  const told = [view.x, view.y].map((name) => `${words(name)} ${text(column(name)[point])} ${flat(unitText(scale(name).unit))}`.trim());
  slider.setAttribute("aria-valuetext", [`point ${point + 1} of ${branch.stability.length}`, ...told, stabilityHere(), ...special].join(", "));
};

const drawEvents = () => {
  const { branch } = view;
  const count = (value) => (value === null ? "–" : String(value));
  const shown = [branch.parameter, view.y].filter((name, k, all) => name && all.indexOf(name) === k);
  const head = ["special point", "", ...shown.map((name) => `${words(name)} ${flat(unitText(scale(name).unit))}`.trim()), "unstable"];
  const rows = branch.special.map(({ point, kind, label, before, after, mode }) => {
    const button = element("button", { type: "button", textContent: kind });
    button.addEventListener("click", () => select(point));
    const counts = before === after ? count(before) : `${count(before)} → ${count(after)}`;
    const cells = [button, label, ...shown.map((name) => text(column(name)[point])), mode ? `${mode}: ${counts}` : counts];
    return element("tr", {}, ...cells.map((cell, k) => {
      const made = element("td", {}, cell);
      made.dataset.title = head[k];
      return made;
    }));
  });
  byId("events").replaceChildren(
    element("thead", {}, element("tr", {}, ...head.map((title) => element("th", { textContent: title, scope: "col" })))),
    element("tbody", {}, ...rows),
  );
};

const drawAll = () => {
  drawMain();
  drawKey();
  drawState();
  drawEnergies();
  drawNumbers();
};

/** Selects a point of the branch. */
const select = (point) => {
  if (!view.branch || point === view.point) return;
  view.point = point;
  view.along = view.branch.travelled[point];
  const place = (name) => column(name)[point];
  charts.main.move({ x: place(view.x), y: place(view.y) });
  if (charts.energies.content && !byId("energies").hidden) {
    charts.energies.move({ x: place(view.x), y: column(ENERGIES.find((name) => view.branch.columns[name]))[point] });
  }
  drawState();
  drawNumbers();
};

// ---- a branch has arrived
const takeBranch = (branch, exact) => {
  // what rounding leaves of zero
  for (const values of Object.values(branch.columns)) {
    const least = 1e-12 * values.reduce((largest, value) => Math.max(largest, Math.abs(value ?? 0)), 0);
    values.forEach((value, k) => { if (value !== null && Math.abs(value) < least) values[k] = 0; });
  }
  branch.travelled = travelled(branch);
  branch.stretches = stretches(branch);
  view.branch = branch;
  byId("summary").replaceChildren(...small(branch.about_case));
  view.exact = exact;
  view.point = nearest(branch.travelled, view.along);
  fillAxes();
  drawAll();
  drawEvents();
};
const fillAxes = () => {
  const { branch } = view;
  const names = Object.keys(branch.columns).filter((name) => branch.columns[name].some(good));
  const offered = ["deformation", branch.parameter, "z0", "base", "deflection_over_h"].filter((name, k, all) => names.includes(name) && all.indexOf(name) === k);
  const fill = (id, list, current, usual) => {
    const box = byId(id);
    const chosen = list.includes(current) ? current : usual;
    const now = [...box.options].map((option) => option.value).join();
    if (now !== list.join()) box.replaceChildren(...list.map((name) => element("option", { value: name, textContent: words(name) })));
    box.value = chosen;
    return chosen;
  };
  const first = ["force"].find((name) => names.includes(name)) ?? names.find((name) => name !== branch.parameter && name !== "unstable") ?? branch.parameter;
  // what was chosen by hand stays, even while a branch does not have it
  view.x = fill("x-axis", offered.length > 0 ? offered : [branch.parameter], view.wanted?.x ?? view.x, offered[0] ?? branch.parameter);
  view.y = fill("y-axis", names.filter((name) => name !== view.x), view.wanted?.y ?? view.y, first);
};

const say = (message) => { byId("status").textContent = message; };
const complain = (message) => {
  byId("error").hidden = !message;
  byId("error").textContent = message;
  for (const link of byId("files").querySelectorAll("a")) link.setAttribute("aria-disabled", String(Boolean(message)));
};

// ---- asking: one request in flight, the latest values next; at rest, the case itself
const REST = 120;
const asking = { flight: null, dirty: null, timer: 0 };
const setOf = (changed) => [...changed].map(([key, value]) => `${key}=${value}`);
const address = (name, pairs) => `${name}?${pairs.map(([key, value]) => `${key}=${encodeURIComponent(value)}`).join("&")}`;

const ask = async (quality) => {
  const changed = new Map(view.changed);
  const set = setOf(changed);
  const begun = asking.dirty ?? performance.now();
  asking.dirty = null;
  const stop = new AbortController();
  asking.flight = { quality, stop };
  const pairs = set.map((one) => ["set", one]);
  pairs.push(["quality", quality]);
  if (quality !== "rest") pairs.push(["along", String(view.along)]);
  else say(view.told ? `${view.told}; looking at every kind of mode …` : "computing the case itself …");
  let answer = null;
  let lost = null;
  try {
    const response = await fetch(address("trace", pairs), { signal: stop.signal, cache: "no-store" });
    answer = response.ok ? await response.json() : null;
    if (!answer) lost = `the program refused the request (${response.status})`;
  } catch (error) {
    if (error.name !== "AbortError") lost = "the program does not answer: it has ended";
  }
  asking.flight = null;
  if (lost) {
    complain(lost);
    say("");
  } else if (answer?.error) {
    complain(answer.error);
    byId("command").value = answer.command;
    say("the curve is that of the last values that have one");
  } else if (answer?.branch) {
    const { branch } = answer;
    complain("");
    takeBranch(branch, quality === "rest");
    byId("command").value = answer.command;
    const mesh = branch.elements === null ? "" : `${branch.elements} elements, `;
    const how = { rest: "at rest", settling: "settling", moving: "while moving" }[quality];
    const modes = branch.full ? "" : "; not every kind of mode was examined";
    const ended = branch.complete ? "" : `; stopped: ${branch.stopped}`;
    const told = `${how}: ${mesh}${branch.stability.length} points, ${branch.took.toFixed(0)} ms${modes}${ended}`;
    view.told = quality === "settling" ? told : "";
    say(told);
    const notes = [...branch.notes, ...(branch.warning ? [branch.warning] : [])];
    byId("notes").hidden = notes.length === 0;
    byId("notes").replaceChildren(...notes.map((note) => element("li", { textContent: note })));
    if (performance.getEntriesByName(quality).length > 500) performance.clearMeasures(quality);
    performance.measure(quality, { start: begun, end: performance.now() });
  }
  document.body.dataset.shown = `${quality} ${set.join(" ")}`;
  clearTimeout(asking.timer);
  const next = view.description.settles && quality === "moving" ? "settling" : "rest";
  if (asking.dirty !== null) ask("moving");
  else if (quality === "settling" && answer?.branch) ask("rest");
  else if (answer?.superseded || (quality === "moving" && answer?.branch)) asking.timer = setTimeout(() => ask(next), REST);
};

/** Values have changed. */
const moved = () => {
  asking.dirty = performance.now();
  clearTimeout(asking.timer);
  const fragment = setOf(view.changed).map(encodeURIComponent).join("&");
  history.replaceState(null, "", fragment ? `#${fragment}` : location.pathname);
  fillFiles();
  if (!asking.flight) ask("moving");
  else if (asking.flight.quality !== "moving") asking.flight.stop.abort();
};

// ---- controls
const STEPS = 400;
/** Place of a value on a slider of so many steps, and back. */
const places = ({ division, ends: [low, high] }) => {
  const log = (value) => Math.log(Math.max(value, Number.MIN_VALUE));
  const linear = {
    steps: STEPS, place: (value) => ((value - low) / (high - low)) * STEPS, value: (place) => low + ((high - low) * place) / STEPS,
  };
  const logarithmic = {
    steps: STEPS,
    place: (value) => ((log(value) - log(low)) / (log(high) - log(low))) * STEPS,
    value: (place) => Math.exp(log(low) + ((log(high) - log(low)) * place) / STEPS),
  };
  if (division === "logarithmic") return logarithmic;
  if (division === "logarithmic-from-zero") {
    return {
      steps: STEPS,
      place: (value) => (value <= 0 ? 0 : Math.max(1, logarithmic.place(value))),
      value: (place) => (place <= 0 ? 0 : logarithmic.value(place)),
    };
  }
  if (division === "whole") return { steps: high - low, place: (value) => value - low, value: (place) => low + place };
  return linear;
};
const short = (value) => String(Number(value.toPrecision(4)));

/** The number at the start of a text, and what follows it. */
const split = (value) => {
  const [, number, unit] = /^\s*([-+]?[\d.]+(?:e[-+]?\d+)?)\s*(.*)$/iu.exec(value) ?? [null, value, ""];
  return [number, unit];
};

const controls = [];
const makeControl = (about, place) => {
  const id = `control-${place}`;
  const own = element("div", { className: "control", title: about.help });
  own.dataset.key = about.key;
  const label = element("label", { htmlFor: id, textContent: about.label });
  const back = element("button", { type: "button", className: "back", textContent: "↺", title: `${about.label} as the case` });
  back.setAttribute("aria-label", back.title);
  const control = { about, own, usual: about.quantity ? split(about.value)[0] : about.value };
  const full = (value) => (about.quantity && !/[a-zµ]\s*[\w/]*$/iu.test(split(value)[1]) ? `${value} ${about.unit}` : value);
  control.full = full;
  control.put = (value, tell) => {
    const usual = Number(value) === Number(control.usual) || value === control.usual;
    own.classList.toggle("changed", !usual);
    // what the case does not have is always said
    if (usual && about.own) view.changed.delete(about.key);
    else view.changed.set(about.key, full(value));
    control.show(value);
    if (tell) moved();
  };
  if (about.words.length > 0) {
    const box = element("select", { id }, ...about.words.map((word) => element("option", { value: word, textContent: word })));
    control.show = (value) => { box.value = value; };
    box.addEventListener("change", () => {
      control.put(box.value, false);
      dependent();
      moved();
    });
    own.append(label, box, back);
  } else {
    const box = element("input", { type: "text", id, inputMode: "decimal", autocomplete: "off", spellcheck: false });
    const unit = element("span", { className: "unit", textContent: flat(unitText(about.unit)) });
    const hint = [about.help, about.range && `must be ${about.range}`].filter(Boolean).join("; ");
    box.title = hint;
    const slider = element("input", { type: "range", min: 0, step: 1 });
    const at = places(about);
    control.show = (value) => {
      if (document.activeElement !== box) box.value = Number.isFinite(Number(value)) ? String(Number(Number(value).toPrecision(6))) : value;
      if (about.division === "typed") return;
      slider.max = at.steps;
      slider.value = Math.round(at.place(Number(split(value)[0])));
      slider.setAttribute("aria-valuetext", `${value} ${flat(unitText(about.unit))}`.trim());
    };
    slider.setAttribute("aria-label", `${about.label}, slider`);
    slider.title = hint;
    slider.addEventListener("input", () => {
      const value = at.value(Number(slider.value));
      control.put(about.division === "whole" ? String(value) : short(value), false);
      box.value = about.division === "whole" ? String(value) : short(value);
      moved();
    });
    box.addEventListener("change", () => {
      const value = box.value.trim();
      control.put(value === "" ? control.usual : value, true);
    });
    own.append(label, box, unit, back, ...(about.division === "typed" ? [] : [slider]));
  }
  back.addEventListener("click", () => {
    control.put(control.usual, false);
    const box = own.querySelector("input[type=text]");
    if (box) box.value = control.usual;
    dependent();
    moved();
  });
  control.show(control.usual);
  return control;
};
/** What only one law or one film has: shown, and sent where the case has no value of its own, as long as it is chosen. */
const dependent = () => {
  for (const { about, own, usual, full } of controls) {
    if (!about.needs) continue;
    const [key, word] = about.needs;
    const choice = controls.find((other) => other.about.key === key);
    if (!choice) continue;
    const needed = choice.own.querySelector("select").value === word;
    own.hidden = !needed;
    if (!needed) view.changed.delete(about.key);
    else if (!about.own && !view.changed.has(about.key)) {
      view.changed.set(about.key, about.quantity ? full(usual) : own.querySelector("input[type=text]").value);
    }
  }
};
const resetAll = () => {
  for (const control of controls) {
    const box = control.own.querySelector("input[type=text]");
    control.put(control.usual, false);
    if (box) box.value = control.usual;
  }
  dependent();
  moved();
};

// ---- saving
const fillFiles = () => {
  const { description } = view;
  const contact = description.problem === "contact" || description.problem === "two-plates";
  const names = [
    "case.toml", "branch.csv", ...(description.physical ? ["branch-physical.csv"] : []), "events.json",
    ...(contact ? ["force_deformation.svg", "force_distance.svg", "shapes.svg", "film_pressure.svg", "energies.svg"] : []),
    ...(description.physical ? ["force_deformation-physical.svg", "force_distance-physical.svg", "film_pressure-physical.svg", "energies-physical.svg"] : []),
    ...(description.problem === "ring-load" ? ["diagram.svg", "shapes.svg"] : []),
    ...(!contact && description.problem !== "ring-load" ? ["diagram.svg"] : []),
  ];
  const pairs = setOf(view.changed).map((one) => ["set", one]);
  byId("files").replaceChildren(...names.map((name) => (
    element("a", { href: address("file", [...pairs, ["name", name]]), download: `${description.name}-${name}`, textContent: name }))));
};

// ---- pins
const pin = () => {
  const used = new Set(view.pins.map((one) => one.hue));
  const free = HUES.find((one) => !used.has(one)) ?? HUES[view.pins.length % HUES.length];
  const label = setOf(view.changed).map((one) => one.replace(/^[\w.]*\./u, "")).join(", ") || "the case";
  const coarse = view.exact ? "" : ` (${view.branch.elements ?? "few"} elements, while moving)`;
  view.pins.push({ branch: view.branch, hue: free, label: label + coarse });
  drawPins();
  drawMain();
};
const drawPins = () => {
  byId("pins").replaceChildren(...view.pins.map((one) => {
    const off = element("button", { type: "button", textContent: "Remove" });
    off.setAttribute("aria-label", `Remove ${one.label}`);
    off.addEventListener("click", () => {
      view.pins = view.pins.filter((other) => other !== one);
      drawPins();
      drawMain();
    });
    const what = one.branch.full ? "" : `; ${one.branch.examined}`;
    return element("li", {}, sample("stable", `var(--${one.hue})`), element("span", { textContent: one.label + what }), off);
  }));
};

// ---- a measured curve
const MOST = 30e6;
const SI = { m: 1, mm: 1e-3, um: 1e-6, nm: 1e-9, pm: 1e-12, N: 1, mN: 1e-3, uN: 1e-6, nN: 1e-9, pN: 1e-12, Pa: 1, kPa: 1e3, MPa: 1e6, aJ: 1e-18, fJ: 1e-15, J: 1 };
const unitOf = (title) => {
  const found = /[[(]\s*([^\])]+?)\s*[\])]\s*$|_([a-zµ]+)$/iu.exec(title);
  const unit = (found?.[1] ?? found?.[2] ?? "").replace(/[µμ]/gu, "u");
  return SI[unit] === undefined ? null : unit;
};
/** Columns of a text: header names where there are any, one list of numbers for each. */
const readTable = (content) => {
  const lines = content.split(/\r\n|\n|\r/u).filter((line) => line.trim() !== "" && !/^\s*[#%]/u.test(line));
  if (lines.length === 0) throw new Error("the file is empty");
  const comma = lines.some((line) => line.includes(";"));
  const cut = lines[0].includes("\t") ? "\t" : comma ? ";" : lines[0].includes(",") ? "," : /\s+/u;
  const cells = (line) => (cut instanceof RegExp ? line.trim().split(cut) : line.split(cut)).map((cell) => cell.trim().replace(/^"(.*)"$/u, "$1"));
  const number = (cell) => {
    const plain = comma ? cell.replace(",", ".") : cell;
    return plain === "" || !Number.isFinite(Number(plain)) ? null : Number(plain);
  };
  const first = cells(lines[0]);
  const titled = first.some((cell) => cell !== "" && number(cell) === null);
  const titles = titled ? first : first.map((_, k) => `column ${k + 1}`);
  const columns = titles.map(() => []);
  for (const line of titled ? lines.slice(1) : lines) {
    const row = cells(line);
    columns.forEach((values, k) => values.push(number(row[k] ?? "")));
  }
  const numeric = columns.map((values) => values.filter((value) => value !== null).length);
  if (numeric.filter((count) => count > 1).length < 2) throw new Error("fewer than two columns of numbers");
  return { titles, columns };
};
/** The measured points in the units of the axes. */
const measuredPoints = () => {
  const { titles, columns, x, y } = view.measured;
  const convert = (k, name) => {
    const unit = unitOf(titles[k]);
    const about = view.branch.about[name];
    const factor = scale(name).factor;
    if (unit === null) return columns[k].map((value) => (value === null ? null : factor * value));
    if (!about?.physical) return columns[k];
    // from its own unit to the dimensionless one, and on to that of the axis
    const dimensionless = SI[unit] / (SI[about.physical[0].replace("^", "")] * about.physical[1]);
    return columns[k].map((value) => (value === null ? null : factor * dimensionless * value));
  };
  return { x: convert(x, view.x), y: convert(y, view.y) };
};
const overlay = () => {
  const { measured } = view;
  byId("overlay").hidden = !measured;
  if (measured) {
    for (const [id, key] of [["measured-x", "x"], ["measured-y", "y"]]) {
      byId(id).replaceChildren(...measured.titles.map((title, k) => element("option", { value: k, textContent: title })));
      byId(id).value = measured[key];
    }
    const units = [measured.x, measured.y].map((k) => unitOf(measured.titles[k]));
    const known = view.description.physical;
    const how = units.some((unit) => unit !== null)
      ? (known ? "Units of the columns' names are converted." : "The columns have units, the case has none: numbers are drawn as they are.")
      : "Numbers without a unit are taken as dimensionless.";
    byId("measured-note").textContent = `${measured.name}: ${measured.columns[0].length} rows. ${how}`;
  }
  drawMain();
};
const readMeasured = async (file) => {
  try {
    if (file.size > MOST) throw new Error(`longer than ${MOST / 1e6} MB`);
    const table = readTable(await file.text());
    const find = (pattern, not) => {
      const at = table.titles.findIndex((title, k) => k !== not && pattern.test(title));
      return at < 0 ? null : at;
    };
    const y = find(/force|^f\b|deflection/iu) ?? (table.titles.length > 1 ? 1 : 0);
    const x = find(/deformation|indentation|z0|distance|separation|height|piezo/iu, y) ?? (y === 0 ? 1 : 0);
    const named = ["deformation", "z0", "base"].find((name) => table.titles[x].toLowerCase().startsWith(name));
    if (named && view.branch.columns[named]?.some(good)) view.x = named;
    byId("x-axis").value = view.x;
    view.measured = { ...table, x, y, name: file.name };
    complain("");
    overlay();
  } catch (error) {
    complain(`${file.name}: ${error.message}`);
  }
};

// ---- begin
const begin = async () => {
  const response = await fetch("case", { cache: "no-store" });
  const description = await response.json();
  view.description = description;
  document.title = `${description.name}: arclen explore`;
  byId("title").textContent = description.name;
  byId("summary").textContent = description.summary || (description.problem === description.name ? "" : description.problem);
  byId("command").value = description.command;
  byId("units").hidden = !description.physical;
  const folded = element("div");
  for (const about of description.controls) {
    const control = makeControl(about, controls.length);
    controls.push(control);
    folded.append(control.own);
  }
  byId("sliders").append(folded);
  const wanted = location.hash.slice(1).split("&").filter(Boolean).map((one) => {
    try {
      return decodeURIComponent(one);
    } catch {
      return "";
    }
  });
  for (const one of wanted) {
    const [key, ...rest] = one.split("=");
    const control = controls.find(({ about }) => about.key === key);
    if (!control || rest.length === 0) continue;
    const value = rest.join("=");
    control.put(control.about.quantity && split(value)[1] === control.about.unit ? split(value)[0] : value, false);
  }
  dependent();
  fillFiles();
  moved();
};

byId("along").addEventListener("input", (event) => select(Number(event.target.value)));
byId("reset").addEventListener("click", resetAll);
byId("pin").addEventListener("click", () => view.branch && pin());
byId("units").addEventListener("click", () => {
  view.physical = !view.physical;
  byId("units").setAttribute("aria-pressed", String(view.physical));
  if (!view.branch) return;
  drawAll();
  drawEvents();
});
for (const [id, axis] of [["x-axis", "x"], ["y-axis", "y"]]) {
  byId(id).addEventListener("change", (event) => {
    view[axis] = event.target.value;
    view.wanted = { ...view.wanted, [axis]: view[axis] };
    fillAxes();
    drawAll();
    drawEvents();
  });
}
byId("measured").addEventListener("change", (event) => {
  const [file] = event.target.files;
  if (file && view.branch) readMeasured(file);
});
for (const [id, key] of [["measured-x", "x"], ["measured-y", "y"]]) {
  byId(id).addEventListener("change", (event) => {
    view.measured[key] = Number(event.target.value);
    overlay();
  });
}
byId("measured-off").addEventListener("click", () => {
  view.measured = null;
  byId("measured").value = "";
  overlay();
});
byId("copy").addEventListener("click", async () => {
  const field = byId("command");
  field.select();
  try {
    await navigator.clipboard.writeText(field.value);
    say("the command was copied");
  } catch {
    say("the command is selected: copy it with the keyboard");
  }
});
// arrow keys move along the branch where nothing else takes them
document.addEventListener("keydown", (event) => {
  if (event.target !== document.body || !view.branch || event.altKey || event.ctrlKey || event.metaKey) return;
  const step = { ArrowRight: 1, ArrowLeft: -1 }[event.key];
  if (!step) return;
  event.preventDefault();
  select(Math.max(0, Math.min(view.branch.stability.length - 1, view.point + step)));
});
begin().catch(() => complain("the program does not answer: it has ended"));
