import { INK, Labels, View, add, arrow, bars, body, boxOf, centreOfMass, colour, cone, node, short, size, tip, turned } from "./scene.js";
import { chart } from "./charts.js";

const DASHES = ["", "8 3", "3 3", "8 3 2 3"], FRAME_TIME = 45;  // [ms]

const make = (kind, properties = {}, ...children) => {
  const made = Object.assign(document.createElement(kind), properties);
  made.append(...children);
  return made;
};
const drawing = (name, kind = "") => {
  const svg = document.createElementNS("http://www.w3.org/2000/svg", "svg");
  svg.setAttribute("role", "img"); svg.setAttribute("aria-label", name); svg.setAttribute("class", kind);
  return svg;
};

// A plan in the plane, playing. shown: title, caption, units, rings, frames, steps, times, lines; see the page's writer.
function open_player(root, shown) {
  let k = 0, playing = 0, charts = [];
  const stage = drawing("The object and its fingers in the world", "stage"), margins = drawing("Angle margins over time"), forces = drawing("Forces over time"), rates = drawing("Rates of force over time");
  const play = make("button", { type: "button", id: "play", textContent: "Play" });
  const slider = make("input", { type: "range", id: "time", min: 0, max: shown.frames.length - 1, step: 1, value: 0 });
  slider.setAttribute("aria-label", "time");
  const now = make("output"), steps = make("ol", { className: "steps" }, ...shown.steps.map((s) => make("li", { textContent: s.words })));
  const fingers = make("p", { className: "legend" });
  shown.fingers.forEach((names, i) => {
    const dot = drawing("", "dot");
    dot.setAttribute("viewBox", "0 0 34 14");
    node(dot, "circle", { cx: 7, cy: 7, r: 6, fill: colour(i) });
    node(dot, "line", { x1: 14, x2: 34, y1: 7, y2: 7, stroke: colour(i), "stroke-width": 2.2, "stroke-dasharray": DASHES[i % 4] });
    fingers.append(make("span", {}, dot, names));
  });
  const key = make("p", { className: "key", textContent: shown.key });
  const left = make("div", {}, stage, shown.frames.length > 1 ? make("div", { className: "row" }, play, make("span", { className: "grow" }, slider), now) : "", fingers, key);
  const right = make("div", {}, margins, forces, rates, steps);
  root.replaceChildren(make("div", { className: "regrasp" }, make("h1", { textContent: shown.title }), make("p", { className: "verdict", textContent: shown.caption }), left, right));

  let view = null;
  const perNewton = shown.perNewton;
  function frame() {
    const width = stage.clientWidth || 560, height = Math.round(Math.min(width, 560));
    stage.setAttribute("viewBox", `0 0 ${width} ${height}`);
    view = new View(width, height, [-shown.reach, -shown.reach, shown.reach, shown.reach], 30);
  }
  function sides() {
    for (const svg of [margins, forces, rates]) { svg.replaceChildren(); svg.style.display = shown.times.length > 1 ? "" : "none"; }
    charts = [];
    if (shown.times.length < 2) return;
    const width = right.clientWidth || 400, lines = (key) => shown.lines.map((l, i) => ({ values: l[key], colour: colour(i), name: l.name, dash: DASHES[i % 4] }));
    const of = (key) => shown.lines.flatMap((l, i) => ((l[key] ?? null) === null ? [] : [{ value: l[key], colour: colour(i) }])), rules = of("limit");
    charts.push(chart(margins, { width, height: 190, xs: shown.times, title: "angle margin", unit: "deg", xunit: shown.units.time, lines: lines("margins") }));
    charts.push(chart(forces, { width, height: 190, xs: shown.times, title: rules.length ? "force, dashed its limit" : "force", unit: shown.units.force, xunit: shown.units.time, lines: lines("forces"), rules }));
    if (shown.lines.every((l) => l.rates)) charts.push(chart(rates, { width, height: 150, xs: shown.times, title: "rate of force, dashed its limit", unit: `${shown.units.force}/${shown.units.time}`, xunit: shown.units.time, lines: lines("rates"), rules: of("rate_limit") }));
    else rates.style.display = "none";
  }
  function draw() {
    if (!view) frame();
    const [t, step, moving, angle, load, list] = shown.frames[k];
    stage.replaceChildren();
    const layer = node(stage, "g"), labels = new Labels(layer, view);
    body(layer, view, shown.rings.map((ring) => ring.map((p) => turned(p, angle))), shown.known ? {} : { stroke: "none" });
    const axis = [[0, 0], turned([0.25 * shown.radius, 0], angle)].map((p) => view.at(p));
    node(layer, "line", { x1: axis[0][0], y1: axis[0][1], x2: axis[1][0], y2: axis[1][1], stroke: INK, "stroke-dasharray": "2 3" });
    for (const f of list) if (f.normal) { cone(layer, view, f.at, f.normal, f.friction, 0.4 * shown.radius, colour(f.number)); labels.block(f.at, 10); }
    centreOfMass(layer, view);
    arrow(layer, view, [0, 0], add([0, 0], load, perNewton), { stroke: INK, width: 3, class: "load" });
    if (size(load)) labels.add(`load ${short(size(load))} ${shown.units.force}`, add([0, 0], load, perNewton), load);
    for (const f of list) {
      const force = size(f.force), pushes = force * perNewton > 1e-3 * shown.radius;
      if (pushes) arrow(layer, view, f.at, add(f.at, f.force, perNewton), { stroke: colour(f.number), width: 3, class: "force" });
      tip(layer, view, f.at, f.normal, colour(f.number), f.normal ? (pushes ? "pushes" : "idle") : "air");
      if (f.normal) labels.add(pushes ? `${f.name} ${short(force)} ${shown.units.force}` : f.name, f.at, [-f.normal[0], -f.normal[1]], { class: "name" });
    }
    bars(layer, view, perNewton, shown.units);
    charts.forEach((c) => c.show(t));
    slider.value = k;
    now.textContent = `${short(t)} ${shown.units.time}${moving ? ", a finger moves" : ""}`;
    [...steps.children].forEach((item, i) => item.classList.toggle("now", i === step));
  }
  const stop = () => { if (playing) cancelAnimationFrame(playing); playing = 0; play.textContent = "Play"; };
  play.addEventListener("click", () => {
    if (playing) return stop();
    if (k >= shown.frames.length - 1) k = 0;
    const began = performance.now() - k * FRAME_TIME;
    play.textContent = "Pause";
    const tick = () => {
      k = Math.min(shown.frames.length - 1, Math.floor((performance.now() - began) / FRAME_TIME));
      draw();
      if (k >= shown.frames.length - 1) return stop();
      playing = requestAnimationFrame(tick);
    };
    tick();
  });
  slider.addEventListener("input", () => { stop(); k = Number(slider.value); draw(); });
  new ResizeObserver(() => { if (stage.clientWidth && stage.clientWidth !== view.width) { frame(); sides(); draw(); } }).observe(root);
  frame(); sides(); draw();
  root.dataset.regrasp = "drawn";
}
