import { GREY, INK, Labels, View, add, arrow, bars, body, boxOf, centreOfMass, colour, cone, escape, hull, node, short, size, tip, turned, unit } from "./scene.js";
import { chart } from "./charts.js";

const STEP = 0.01, UNITS = { length: "m", force: "N" };
const HINT_ESCAPE = "Green: how the object escapes, its contacts with arrows; a cross: a finger that cannot oppose it.";
const HINT = "Drag a finger, or the load's arrow. Keys: Tab chooses, arrows move, Q and E turn a normal. " +
  "Solid arrows: forces now; dashed: at the end; broad bands: LS_B, where their heads can be; sectors: friction cones.";

// An HTML element with properties and children.
function make(kind, properties = {}, ...children) {
  const made = Object.assign(document.createElement(kind), properties);
  made.append(...children);
  return made;
}

// The explorer inside an element. begin: title, question, answer, rings; ask: from a question to a promise.
function open_explorer(root, begin, ask) {
  const question = structuredClone(begin.question), rings = begin.rings || [];
  let answer = begin.answer, busy = false, waiting = null, chosen = 0, view = null, perNewton = 0, playing = 0, moment = 0, charts = [];
  const drawn = [];  // milliseconds from a movement to its picture, read by the tests and the benchmark
  root.regrasp = { question, drawn, answer: () => answer };

  // -- what stands on the page ---------------------------------------------------------------------------
  const stage = document.createElementNS("http://www.w3.org/2000/svg", "svg");
  const graph = () => document.createElementNS("http://www.w3.org/2000/svg", "svg");
  const margins = graph(), clock = graph(), locus = graph();
  stage.setAttribute("class", "stage"); stage.setAttribute("role", "group"); stage.setAttribute("aria-label", "The object and its fingers");
  for (const [svg, name] of [[margins, "Angle margins over time"], [clock, "T(t)"], [locus, "Margin along LS_B"]]) { svg.setAttribute("role", "img"); svg.setAttribute("aria-label", name); }
  const verdict = make("p", { className: "verdict" });
  verdict.setAttribute("role", "status");
  const leaves = make("select", { id: "leaves" }), objective = make("select", { id: "objective" }), whose = make("select", { id: "whose" });
  const slider = (id, min, max, step) => make("input", { type: "range", id, min, max, step });
  const friction = slider("friction", 0, 1.5, 0.01), torque = slider("torque", -1, 1, "any"), squeeze = slider("squeeze", 0, 1, "any"), time = slider("time", 0, 1, "any");
  const said = { friction: make("output"), torque: make("output"), squeeze: make("output"), time: make("output") };
  const best = make("button", { type: "button", textContent: "best", title: "The squeeze that is best for the objective" });
  const play = make("button", { type: "button", id: "play", textContent: "Play" });
  const button = (text, id, run) => { const b = make("button", { type: "button", id, textContent: text }); b.addEventListener("click", run); return b; };
  const text = make("textarea", { readOnly: true, id: "copied", spellcheck: false }), copied = make("div", { className: "copied", hidden: true }, text);
  const label = (text, input) => { const l = make("label", { textContent: text, htmlFor: input.id }); input.setAttribute("aria-label", text); return l; };
  const controls = make("div", { className: "controls" },
    label("leaves", leaves), make("span", { className: "wide" }, leaves, " for ", objective),
    label("friction", friction), friction, said.friction, make("span"), make("span", { className: "wide" }, "of ", whose),
    label("torque", torque), torque, said.torque,
    label("squeeze", squeeze), squeeze, said.squeeze, make("span"), make("span", { className: "wide" }, best),
  );
  objective.setAttribute("aria-label", "chosen for"); whose.setAttribute("aria-label", "friction of");
  const key = make("p", { className: "key" });
  const left = make("div", {}, stage,
    make("div", { className: "row" }, play, make("span", { className: "grow" }, time), said.time),
    key);
  time.setAttribute("aria-label", "time");
  const right = make("div", {}, controls, locus, margins, clock, make("div", { className: "row" },
    button("Copy as Python", "python", () => copy("python")), button("Copy as scenario", "scenario", () => copy("scenario")),
    button("Save picture", "save", save), button("Add a finger", "more", more), button("Remove the chosen", "fewer", fewer)));
  const page = make("div", { className: "regrasp" }, make("h1", { textContent: begin.title }), verdict, left, right, copied);
  root.replaceChildren(page);
  objective.append(...begin.objectives.map((o) => make("option", { value: o, textContent: o.replaceAll("_", " ") })));

  // -- asking --------------------------------------------------------------------------------------------
  // One question is on its way at a time; of those that come meanwhile only the last is asked.
  async function changed(stamp = performance.now()) {
    if (busy) { waiting = stamp; return; }
    busy = true;
    const asked = JSON.stringify(question);
    try { answer = await ask({ question: JSON.parse(asked) }); } catch (problem) { answer = { holds: false, says: `No answer: ${problem}. Does regrasp explore still run?` }; }
    busy = false;
    draw();
    requestAnimationFrame(() => { drawn.push(performance.now() - stamp); if (drawn.length > 5000) drawn.shift(); });
    if (waiting !== null) { const next = waiting; waiting = null; changed(next); }
  }
  const contacts = () => (answer.contacts && answer.contacts.length === question.contacts.length ? answer.contacts : question.contacts);

  // -- drawing -------------------------------------------------------------------------------------------
  function frame() {
    const width = stage.clientWidth || 560, height = Math.round(Math.min(width * 0.95, 560));
    stage.setAttribute("viewBox", `0 0 ${width} ${height}`);
    const points = rings.length ? rings.flat() : question.contacts.map((c) => c.position).concat([[0, 0]]);
    const box = boxOf(points), wide = Math.max(box[2] - box[0], box[3] - box[1]) || 1, pad = 0.17 * wide;
    view = new View(width, height, [box[0] - pad, box[1] - pad, box[2] + pad, box[3] + pad], 14);
    view.wide = wide;
  }
  const forcesNow = () => {
    if (answer.plan) return { at: answer.plan.forces[moment], start: answer.plan.forces[0], end: answer.plan.forces.at(-1) };
    if (answer.state) return { at: answer.state.forces };
    return null;
  };
  function scaleForces() {
    const now = forcesNow(), all = [size(question.load)];
    if (now) for (const f of [now.at, now.start, now.end]) if (f) all.push(...f.map(size));
    const longest = Math.max(...all) * perNewton;
    if (!(longest > 0.2 * view.wide && longest < 0.52 * view.wide)) perNewton = (0.42 * view.wide) / (Math.max(...all) || 1);  // kept while it fits
  }
  function draw() {
    if (!view) frame();
    scaleForces();
    const focused = document.activeElement && document.activeElement.getAttribute && document.activeElement.getAttribute("data-handle");
    stage.replaceChildren();
    const layer = node(stage, "g"), now = forcesNow(), list = contacts(), away = new Set(answer.plan ? answer.plan.leaving : []);
    body(layer, view, rings.length ? rings : [hull(list.map((c) => c.position))], rings.length ? {} : { stroke: "none" });
    const labels = new Labels(layer, view);
    list.forEach((c, i) => {
      const n = unit(c.normal), t = [-n[1], n[0]], half = 0.06 * view.wide;
      if (!rings.length) { const [a, b] = [view.at(add(c.position, t, half)), view.at(add(c.position, t, -half))]; node(layer, "line", { x1: a[0], y1: a[1], x2: b[0], y2: b[1], stroke: INK, "stroke-width": 1.4 }); }
      cone(layer, view, c.position, n, c.friction, 0.2 * view.wide, colour(i));
      labels.block(c.position, 10);
    });
    centreOfMass(layer, view);
    const tipOf = (f, c) => add(c.position, f, perNewton);
    if (now) list.forEach((c, i) => {
      if (now.end) {
        const [a, b] = [view.at(tipOf(now.start[i], c)), view.at(tipOf(now.end[i], c))];
        node(layer, "line", { x1: a[0], y1: a[1], x2: b[0], y2: b[1], stroke: colour(i), "stroke-width": 1.2, "stroke-dasharray": "2 3" });
        arrow(layer, view, c.position, tipOf(now.end[i], c), { stroke: colour(i), width: 1.3, dash: "5 4", open: true });
      }
      arrow(layer, view, c.position, tipOf(now.at[i], c), { stroke: colour(i), width: 3, class: "force", "data-name": c.name });
    });
    if (answer.locus && now) segment(layer, list);
    if (answer.escape) escape(layer, view, answer.escape, list, rings.length ? rings : [hull(list.map((c) => c.position))], 0.35 * view.wide);
    arrow(layer, view, [0, 0], add([0, 0], question.load, perNewton), { stroke: INK, width: 3, class: "load" });
    list.forEach((c, i) => {
      const force = now ? size(now.at[i]) : 0, idle = now && force * perNewton < 1e-3 * view.wide;
      const group = handle(i, c.position, `${c.name}, finger ${i + 1}`);
      tip(group, view, c.position, unit(c.normal), colour(i), idle ? "idle" : "pushes");
      labels.add(now ? `${c.name} ${short(force)} N` : c.name, c.position, [-c.normal[0], -c.normal[1]], { class: "name", ...(away.has(c.name) ? { "font-style": "italic" } : {}) });
    });
    const head = add([0, 0], question.load, perNewton), loaded = handle(-1, head, "load");
    const [x, y] = view.at(head);
    node(loaded, "circle", { cx: x, cy: y, r: 5, fill: "white", stroke: INK, "stroke-width": 1.6 });
    labels.add(`load ${short(size(question.load))} N`, head, question.load);
    bars(layer, view, perNewton, UNITS);
    if (focused !== null && focused !== undefined && document.activeElement === document.body) stage.querySelector(`[data-handle="${focused}"]`)?.focus();
    sides();
    show(moment);
  }
  // LS_B where it acts: every place the heads of the two forces can be.
  function segment(layer, list) {
    answer.locus.names.forEach((name, k) => {
      const i = list.findIndex((c) => c.name === name);
      const [a, b] = answer.locus.ends.map((f) => view.at(add(list[i].position, f[k], perNewton)));
      node(layer, "line", { x1: a[0], y1: a[1], x2: b[0], y2: b[1], stroke: colour(i), "stroke-width": 7, "stroke-opacity": 0.22, "stroke-linecap": "round", class: "locus" });
    });
  }
  function handle(i, at, name) {
    const group = node(stage, "g", { class: `handle${i === chosen ? " chosen" : ""}`, tabindex: 0, role: "button", "aria-label": `${name}: arrow keys move it`, "data-handle": i });
    const [x, y] = view.at(at);
    node(group, "circle", { cx: x, cy: y, r: 20, class: "ring" });
    return group;
  }
  function sides() {
    verdict.textContent = answer.says || "";
    key.textContent = answer.escape ? `${HINT_ESCAPE} ${HINT}` : HINT;
    verdict.className = `verdict ${answer.holds ? "yes" : "no"}`;
    const names = question.contacts.map((c) => c.name), fill = (select, options, value) => {
      if (select.dataset.of !== JSON.stringify(options)) { select.replaceChildren(...options.map(([v, t]) => make("option", { value: v, textContent: t }))); select.dataset.of = JSON.stringify(options); }
      select.value = value;
    };
    fill(leaves, [["", "nobody"], ...names.map((n, i) => [`${i}`, n])], question.leaves === null ? "" : `${names.indexOf(question.leaves)}`);
    fill(whose, [["", "all"], ...names.map((n, i) => [`${i}`, n])], whose.value in names ? whose.value : "");
    objective.value = question.objective;
    const of = question.contacts[whose.value === "" ? 0 : Number(whose.value)];
    friction.value = of.friction; said.friction.textContent = short(of.friction);
    const arm = Math.max(size(question.load), 1e-9) * view.wide;
    torque.min = -arm; torque.max = arm; torque.value = question.load[2]; said.torque.textContent = `${short(question.load[2])} N m`;
    const found = answer.locus, width = right.clientWidth || 360;
    squeeze.disabled = best.disabled = !found;
    locus.replaceChildren(); margins.replaceChildren(); clock.replaceChildren(); charts = [];
    locus.style.display = found ? "" : "none";
    margins.style.display = clock.style.display = answer.plan ? "" : "none";
    if (found) {
      [squeeze.min, squeeze.max] = found.interval; squeeze.value = found.chosen; said.squeeze.textContent = `${short(found.chosen)} N`;
      const at = found.squeezes.map((x, k) => [Math.abs(x - found.chosen), found.margins[k]]).sort((a, b) => a[0] - b[0])[0][1];
      chart(locus, { width, height: 110, xs: found.squeezes, lines: [{ values: found.margins, colour: INK }], title: `least margin along LS_B of ${found.names.join(", ").slice(0, 24)}`, unit: "deg", xunit: "N", marks: [{ x: found.chosen, y: at, fill: "#E69F00" }] });
    } else said.squeeze.textContent = "–";
    play.disabled = time.disabled = !answer.plan;
    if (!answer.plan) { said.time.textContent = ""; return; }
    const { times, margins: m, clock: T } = answer.plan;
    time.max = times.length - 1; time.step = 1;
    charts.push(chart(margins, { width, height: 150, xs: times, title: "angle margin", unit: "deg", xunit: "s", lines: question.contacts.map((c, i) => ({ values: m.map((row) => row[i]), colour: colour(i), name: c.name, dash: ["", "8 3", "3 3", "8 3 2 3"][i % 4] })) }));
    charts.push(chart(clock, { width, height: 90, xs: times, title: "T(t)", xunit: "s", lines: [{ values: T, colour: INK }], rules: [{ value: 1, colour: "#bbb" }] }));
  }
  function show(k) {
    if (!answer.plan) return;
    time.value = k; said.time.textContent = `${short(answer.plan.times[k])} s`;
    charts.forEach((c) => c.show(answer.plan.times[k]));
  }
  function stop() { if (playing) cancelAnimationFrame(playing); playing = 0; play.textContent = "Play"; }
  play.addEventListener("click", () => {
    if (playing) return stop();
    const began = performance.now() - (moment >= answer.plan.times.length - 1 ? 0 : moment * 40);
    play.textContent = "Pause";
    const tick = () => {
      if (!answer.plan) return stop();
      moment = Math.min(answer.plan.times.length - 1, Math.floor((performance.now() - began) / 40));
      draw();
      if (moment >= answer.plan.times.length - 1) return stop();
      playing = requestAnimationFrame(tick);
    };
    tick();
  });

  // -- hands and keys ------------------------------------------------------------------------------------
  const edit = () => { stop(); moment = 0; question.squeeze = null; };
  function move(i, to) {
    edit();
    if (i < 0) { question.load[0] = to[0] / perNewton; question.load[1] = to[1] / perNewton; } else question.contacts[i].position = to;
    changed();
  }
  stage.addEventListener("pointerdown", (event) => {
    const target = event.target.closest("[data-handle]");
    if (!target || event.button) return;
    const i = Number(target.dataset.handle), box = stage.getBoundingClientRect(), held = event.pointerId;
    chosen = i;
    target.focus({ preventScroll: true });
    stage.setPointerCapture(held);
    const onMove = (e) => {
      if (e.pointerId !== held) return;
      const zoom = view.width / box.width;
      move(i, view.back((e.clientX - box.left) * zoom, (e.clientY - box.top) * zoom));
    };
    const onEnd = (e) => {
      if (e.pointerId !== held) return;
      for (const kind of ["pointerup", "pointercancel"]) stage.removeEventListener(kind, onEnd);
      stage.removeEventListener("pointermove", onMove);
      settle();
    };
    stage.addEventListener("pointermove", onMove);
    for (const kind of ["pointerup", "pointercancel"]) stage.addEventListener(kind, onEnd);
    event.preventDefault();
  });
  // What was asked becomes what was answered: a contact dragged away from the outline is on it.
  function settle() { if (rings.length && answer.contacts) question.contacts.forEach((c, i) => { if (contacts()[i]) { c.position = [...contacts()[i].position]; c.normal = [...contacts()[i].normal]; } }); }
  const WAYS = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1] };
  stage.addEventListener("keydown", (event) => {
    const target = event.target.closest("[data-handle]");
    if (!target) return;
    const i = Number(target.dataset.handle), way = WAYS[event.key], spin = { q: 1, e: -1 }[event.key.toLowerCase()];
    chosen = i;
    if (way) {
      settle();
      const from = i < 0 ? question.load.slice(0, 2).map((v) => v * perNewton) : contacts()[i].position;
      move(i, along(i, from, way, (event.shiftKey ? 5 : 1) * STEP * view.wide));
    } else if (spin && i >= 0 && !rings.length) { edit(); question.contacts[i].normal = turned(question.contacts[i].normal, spin * 0.035); changed(); } else return;
    event.preventDefault();
  });
  // On an outline the surface leads: a key moves along it, in the direction that is nearest to the key's.
  function along(i, from, way, far) {
    if (i < 0 || !rings.length) return add(from, way, far);
    const n = unit(contacts()[i].normal), t = [-n[1], n[0]], dot = t[0] * way[0] + t[1] * way[1];
    return Math.abs(dot) < 1e-3 ? add(from, t, far * (way[0] + way[1])) : add(from, t, Math.sign(dot) * far);
  }
  leaves.addEventListener("change", () => { edit(); question.leaves = leaves.value === "" ? null : question.contacts[Number(leaves.value)].name; changed(); });
  objective.addEventListener("change", () => { edit(); question.objective = objective.value; changed(); });
  whose.addEventListener("change", () => sides());
  friction.addEventListener("input", () => { edit(); question.contacts.forEach((c, i) => { if (whose.value === "" || Number(whose.value) === i) c.friction = Number(friction.value); }); changed(); });
  torque.addEventListener("input", () => { edit(); question.load[2] = Number(torque.value); changed(); });
  squeeze.addEventListener("input", () => { stop(); moment = answer.plan ? answer.plan.times.length - 1 : 0; question.squeeze = Number(squeeze.value); changed(); });
  best.addEventListener("click", () => { question.squeeze = null; changed(); });
  time.addEventListener("input", () => { stop(); moment = Number(time.value); draw(); });

  // -- more and fewer fingers, copies, pictures ------------------------------------------------------------
  function more() {
    if (question.contacts.length >= begin.most) return;
    const far = rings.length ? rings[0][Math.floor(rings[0].length * 0.37)] : [0.6 * view.wide, 0], taken = new Set(question.contacts.map((c) => c.name));
    let k = question.contacts.length + 1;
    while (taken.has(`P${k}`)) k++;
    edit();
    question.contacts.push({ name: `P${k}`, position: [...far], normal: unit([-far[0], -far[1]]), friction: question.contacts[0].friction });
    chosen = question.contacts.length - 1;
    changed();
  }
  function fewer() {
    if (question.contacts.length <= 2 || chosen < 0) return;
    edit();
    const [gone] = question.contacts.splice(chosen, 1);
    if (question.leaves === gone.name) question.leaves = null;
    chosen = 0;
    changed();
  }
  async function copy(kind) {
    const made = await ask({ question: structuredClone(question), copy: true });
    text.value = made[kind] || made.says || "";
    copied.hidden = false;
    text.select();
    try { await navigator.clipboard.writeText(text.value); } catch { /* it stands there to be copied by hand */ }
  }
  function save() {
    const picture = stage.cloneNode(true), zoom = 2;
    picture.querySelectorAll(".ring").forEach((r) => r.remove());
    picture.setAttribute("xmlns", "http://www.w3.org/2000/svg");
    picture.setAttribute("width", view.width); picture.setAttribute("height", view.height);
    picture.setAttribute("font-family", "sans-serif");
    const image = new Image(), canvas = make("canvas", { width: zoom * view.width, height: zoom * view.height });
    image.onload = () => {
      const pen = canvas.getContext("2d");
      pen.fillStyle = "white"; pen.fillRect(0, 0, canvas.width, canvas.height);
      pen.drawImage(image, 0, 0, canvas.width, canvas.height);
      make("a", { href: canvas.toDataURL("image/png"), download: "regrasp.png" }).click();
    };
    image.src = `data:image/svg+xml;charset=utf-8,${encodeURIComponent(new XMLSerializer().serializeToString(picture))}`;
  }
  const again = () => { if (stage.clientWidth && (!view || stage.clientWidth !== view.width)) { frame(); draw(); } };
  const watching = new ResizeObserver(again);
  watching.observe(page);
  frame(); draw();
  return () => { stop(); watching.disconnect(); };
}
