import { INK, add, colour, short, size, unit } from "./scene.js";
import { chart } from "./charts.js";
import { dragged, saved } from "./handles.js";
import { plane_stage } from "./plane.js";
import { solid_stage } from "./solid.js";
import { loop_look } from "./loop.js";
import { map_look } from "./placement.js";

const STEP = 0.01, IDLE = 300;  // [ms] without a change, before what takes longer is asked for
const DASHES = ["", "8 3", "3 3", "8 3 2 3"];
const KEYS = "Keys: Tab chooses, arrows move it, Shift farther";
const HINT_ESCAPE = "Green: how the object escapes, its contacts with arrows; a cross: a finger that cannot oppose it.";
const HINTS = {
  2: `Drag a finger, or the load's arrow. ${KEYS}, Q and E turn a normal. Solid arrows: forces now; dashed: at the end; broad bands: LS_B, where their heads can be; sectors: friction cones.`,
  3: `Drag a finger over the surface, or the load's head; drag beside them to turn, tap the surface to put the chosen finger there. ${KEYS}, arrows on the picture turn it. Dashed rings: fingers behind.`,
};

// An HTML element with properties and children.
function make(kind, properties = {}, ...children) {
  const made = Object.assign(document.createElement(kind), properties);
  made.append(...children);
  return made;
}

// The explorer inside an element. begin: title, question, answer, rings or solid; ask: from a question to a promise.
function open_explorer(root, begin, ask) {
  const question = structuredClone(begin.question), flat = question.load.length === 3, d = flat ? 2 : 3;
  let answer = begin.answer, busy = false, waiting = null, chosen = 0, view = null, perNewton = 0, playing = 0, moment = 0, charts = [];
  let look = "time", found = { of: null }, later = 0, places = null;
  const drawn = [];  // milliseconds from a movement to its picture, read by the tests and the benchmark
  root.regrasp = { question, drawn, answer: () => answer, found: () => found };

  // -- what stands on the page ---------------------------------------------------------------------------
  const picture = (name, role = "img") => { const svg = document.createElementNS("http://www.w3.org/2000/svg", "svg"); svg.setAttribute("role", role); svg.setAttribute("aria-label", name); return svg; };
  const stage = picture("The object and its fingers", "group"), under = make("canvas", { hidden: flat });
  const margins = picture("Angle margins over time"), clock = picture("T(t)"), locus = picture("Margin along LS_B");
  const loop = picture("Wrench loop"), map = picture("Map of two fingers");
  stage.setAttribute("class", "stage"); loop.setAttribute("class", "turns"); map.setAttribute("class", "turns");
  const verdict = make("p", { className: "verdict" });
  verdict.setAttribute("role", "status");
  const leaves = make("select", { id: "leaves" }), objective = make("select", { id: "objective" }), whose = make("select", { id: "whose" });
  const slider = (id, min, max, step) => make("input", { type: "range", id, min, max, step });
  const friction = slider("friction", 0, 1.5, 0.01), torque = slider("torque", -1, 1, "any"), squeeze = slider("squeeze", 0, 1, "any"), time = slider("time", 0, 1, "any");
  const said = { friction: make("output"), torque: make("output"), squeeze: make("output"), time: make("output") };
  const duration = make("input", { type: "number", id: "duration", min: 0.001, step: "any" });
  const loads = flat ? [] : ["fx", "fy", "fz", "torque x", "torque y", "torque z"].map((name) => { const i = make("input", { type: "number", step: "any" }); i.setAttribute("aria-label", name); i.title = name; return i; });
  const button = (text, id, run) => { const b = make("button", { type: "button", id, textContent: text }); b.addEventListener("click", run); return b; };
  const best = button("best", "best", () => { question.squeeze = null; changed(); });
  best.title = "The squeeze that is best for the objective";
  const play = make("button", { type: "button", id: "play", textContent: "Play" });
  const text = make("textarea", { readOnly: true, id: "copied", spellcheck: false }), copied = make("div", { className: "copied", hidden: true }, text);
  const label = (words, input) => { const l = make("label", { textContent: words, htmlFor: input.id }); input.setAttribute("aria-label", words); return l; };
  const controls = make("div", { className: "controls" },
    label("leaves", leaves), make("span", { className: "wide" }, leaves, " for ", objective),
    label("friction", friction), friction, said.friction, make("span"), make("span", { className: "wide" }, "of ", whose, " in ", duration, " s"),
    ...(flat
      ? [label("torque", torque), torque, said.torque, label("squeeze", squeeze), squeeze, said.squeeze, make("span"), make("span", { className: "wide" }, best)]
      : [make("span", { textContent: "load [N]" }), make("span", { className: "wide numbers" }, ...loads.slice(0, 3)), make("span", { textContent: "[N m]" }), make("span", { className: "wide numbers" }, ...loads.slice(3))]));
  objective.setAttribute("aria-label", "chosen for"); whose.setAttribute("aria-label", "friction of"); duration.setAttribute("aria-label", "duration");
  const key = make("p", { className: "key" }), note = make("p", { className: "key" }), table = make("div", { className: "table" });
  const anew = button("with forces chosen anew (seconds)", "anew", () => refresh("answered"));
  const names = [["time", "over time"], ...(flat ? [["loop", "wrench loop"]] : []), ["tolerances", "tolerances"], ...(flat && begin.rings ? [["map", "map of two"], ["places", "places"]] : [])];
  const tabs = names.map(([name, words]) => { const t = button(words, `look-${name}`, () => { look = name; sides(); refresh(); draw(); }); t.setAttribute("role", "tab"); return t; });
  const list = make("div", { className: "row tabs" }, ...tabs);
  list.setAttribute("role", "tablist");
  const left = make("div", {}, make("div", { className: "layers" }, under, stage),
    make("div", { className: "row" }, play, make("span", { className: "grow" }, time), said.time), key);
  time.setAttribute("aria-label", "time");
  const right = make("div", {}, controls, locus, list, margins, clock, loop, table, map, note, anew, make("div", { className: "row" },
    button("Copy as Python", "python", () => copy("python")), button("Copy as scenario", "scenario", () => copy("scenario")),
    button("Save picture", "save", () => saved(stage, view.width, view.height, scene.under && !under.hidden ? under : null)), button("Add a finger", "more", more), button("Remove the chosen", "fewer", fewer)));
  const page = make("div", { className: "regrasp" }, make("h1", { textContent: begin.title }), verdict, left, right, copied);
  root.replaceChildren(page);
  objective.append(...begin.objectives.map((o) => make("option", { value: o, textContent: o.replaceAll("_", " ") })));
  const scene = flat ? plane_stage(stage, begin.rings || []) : solid_stage(stage, under, begin.solid, () => draw(), (at) => { if (chosen >= 0) move(chosen, at); });
  const shaped = Boolean(begin.rings || begin.solid);
  const show_loop = loop_look(loop), two = map_look(map, put);

  // -- asking --------------------------------------------------------------------------------------------
  // One question is on its way at a time; of those that come meanwhile only the last is asked.
  async function changed(stamp = performance.now()) {
    if (busy) { waiting = stamp; return; }
    busy = true;
    try { answer = await ask({ question: structuredClone(question) }); } catch (problem) { answer = { holds: false, says: `No answer: ${problem}. Does regrasp explore still run?` }; }
    busy = false;
    draw(); sides(); refresh();
    requestAnimationFrame(() => { drawn.push(performance.now() - stamp); if (drawn.length > 5000) drawn.shift(); });
    if (waiting !== null) { const next = waiting; waiting = null; changed(next); }
  }
  // What a look depends on: a map not on where its two fingers are.
  function depends(name) {
    const { squeeze: s, duration: t, contacts: all, ...rest } = question;
    const stay = all.filter((c) => c.name !== question.leaves);
    const fixed = name === "map" ? all.map(({ position, normal, ...c }, i) => (stay.indexOf(all[i]) < 2 ? c : all[i])) : all;
    return JSON.stringify([name === "answered" ? "tolerances" : name, rest, fixed]);
  }
  // Tolerances, maps and places take longer than a frame: they are asked for when nothing has changed for a while.
  function refresh(name = look) {
    clearTimeout(later);
    if (!["tolerances", "answered", "map", "places"].includes(name)) return;
    const of = depends(name);
    if (name !== "answered" && found.of === of) return;
    page.classList.add("stale");
    later = setTimeout(async () => {
      let made;
      try { made = await ask({ question: structuredClone(question), look: name }); } catch (problem) { made = { says: `No answer: ${problem}` }; }
      if (depends(name) !== of || !(look === name || name === "answered")) return;
      found = { of, name: look, made };
      sides(); draw();
    }, name === "answered" ? 0 : IDLE);
  }
  const contacts = () => (answer.contacts && answer.contacts.length === question.contacts.length ? answer.contacts : question.contacts);
  const load = () => question.load.slice(0, d);

  // -- drawing -------------------------------------------------------------------------------------------
  const forcesNow = () => {
    if (answer.plan) return { at: answer.plan.forces[moment], start: answer.plan.forces[0], end: answer.plan.forces.at(-1) };
    return answer.state ? { at: answer.state.forces } : null;
  };
  function scaleForces(now) {
    const all = [size(load())];
    if (now) for (const f of [now.at, now.start, now.end]) if (f) all.push(...f.map(size));
    const longest = Math.max(...all) * perNewton;
    if (!(longest > 0.2 * view.wide && longest < 0.52 * view.wide)) perNewton = (0.42 * view.wide) / (Math.max(...all) || 1);  // kept while it fits
  }
  function draw() {
    if (!view) view = scene.frame(question.contacts);
    const now = forcesNow(), focused = document.activeElement?.getAttribute?.("data-handle") ?? null;
    scaleForces(now);
    stage.replaceChildren();
    const regions = look === "places" && found.name === "places" && found.of === depends("places") ? found.made : null;
    scene.draw({ answer, list: contacts(), now, load: load(), perNewton, chosen, away: new Set(answer.plan ? answer.plan.leaving : []), places: regions?.alone ? regions : null });
    if (focused !== null && document.activeElement === document.body) stage.querySelector(`[data-handle="${focused}"]`)?.focus();
    show(moment);
  }
  function fill(select, options, value) {
    const of = JSON.stringify(options);
    if (select.dataset.of !== of) { select.replaceChildren(...options.map(([v, t]) => make("option", { value: v, textContent: t }))); select.dataset.of = of; }
    select.value = value;
  }
  function sides() {
    verdict.textContent = answer.says || "";
    key.textContent = answer.escape ? `${HINT_ESCAPE} ${HINTS[d]}` : HINTS[d];
    verdict.className = `verdict ${answer.holds ? "yes" : "no"}`;
    const fingers = question.contacts.map((c) => c.name), active = document.activeElement;
    fill(leaves, [["", "nobody"], ...fingers.map((n, i) => [`${i}`, n])], question.leaves === null ? "" : `${fingers.indexOf(question.leaves)}`);
    fill(whose, [["", "all"], ...fingers.map((n, i) => [`${i}`, n])], whose.value in fingers ? whose.value : "");
    objective.value = question.objective;
    const of = question.contacts[whose.value === "" ? 0 : Number(whose.value)];
    friction.value = of.friction; said.friction.textContent = short(of.friction);
    if (active !== duration) duration.value = question.duration;
    loads.forEach((input, i) => { if (active !== input) input.value = Number(question.load[i].toPrecision(4)); });
    if (flat) {
      const arm = Math.max(size(load()), 1e-9) * view.wide;
      torque.min = -arm; torque.max = arm; torque.value = question.load[2]; said.torque.textContent = `${short(question.load[2])} N m`;
    }
    const along = answer.locus, width = right.clientWidth || 360, plan = answer.plan;
    squeeze.disabled = best.disabled = !along;
    for (const svg of [locus, margins, clock]) svg.replaceChildren();
    charts = [];
    locus.style.display = along ? "" : "none";
    if (along) {
      [squeeze.min, squeeze.max] = along.interval; squeeze.value = along.chosen; said.squeeze.textContent = `${short(along.chosen)} N`;
      const at = along.squeezes.map((x, k) => [Math.abs(x - along.chosen), along.margins[k]]).sort((a, b) => a[0] - b[0])[0][1];
      chart(locus, { width, height: 110, xs: along.squeezes, lines: [{ values: along.margins, colour: INK }], title: `least margin along LS_B of ${along.names.join(", ").slice(0, 24)}`, unit: "deg", xunit: "N", marks: [{ x: along.chosen, y: at, fill: "#E69F00" }] });
    } else said.squeeze.textContent = "–";
    tabs.forEach((t, i) => t.setAttribute("aria-selected", names[i][0] === look));
    margins.style.display = clock.style.display = look === "time" && plan ? "" : "none";
    loop.style.display = look === "loop" ? "" : "none";
    play.disabled = time.disabled = !plan;
    if (plan) { time.max = plan.times.length - 1; time.step = 1; } else said.time.textContent = "";
    if (plan && look === "time") {
      const lines = question.contacts.map((c, i) => ({ values: plan.margins.map((row) => row[i]), colour: colour(i), name: c.name, dash: DASHES[i % 4] }));
      charts.push(chart(margins, { width, height: 150, xs: plan.times, title: "angle margin", unit: "deg", xunit: "s", lines }));
      charts.push(chart(clock, { width, height: 90, xs: plan.times, title: "T(t)", xunit: "s", lines: [{ values: plan.clock, colour: INK }], rules: [{ value: 1, colour: "#bbb" }] }));
    }
    looked(width);
  }
  // What was asked for on request; pale while it is of an earlier question.
  function looked(width) {
    const wanted = ["tolerances", "map", "places"].includes(look), mine = found.name === look, made = mine ? found.made : {};
    page.classList.toggle("stale", wanted && !(mine && found.of === depends(look)));
    note.hidden = !wanted; note.textContent = made.says || (mine ? "" : "Worked out as soon as nothing moves ...");
    table.hidden = anew.hidden = look !== "tolerances" || !made.rows;
    map.style.display = look === "map" && made.values ? "" : "none";
    if (look === "tolerances" && made.rows && table.of !== made) {
      const row = (cells, kind) => make("tr", {}, ...cells.map((c) => make(kind, { textContent: c })));
      table.replaceChildren(make("table", {}, make("thead", {}, row(made.head, "th")), make("tbody", {}, ...made.rows.map((r) => row(r, "td")))));
      table.of = made;
    }
    if (look === "map" && made.values) {
      if (map.of !== made || map.wide !== width) { two.draw(made, width); map.of = made; map.wide = width; }
      two.show(contacts());
      note.textContent = "Tap, drag or arrow keys put both fingers there; bright is better.";
    }
    if (look === "places" && made.alone) note.textContent = `Thin lines beside the surface: where one finger may be while the others stay; broad bands: where all may be at once. ${made.says}`;
  }
  function show(k) {
    if (look === "loop") show_loop({ answer, list: contacts(), load: question.load, moment: k, width: right.clientWidth || 360 });
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
    if (i < 0) to.forEach((v, k) => { question.load[k] = v / perNewton; }); else question.contacts[i].position = to;
    changed();
  }
  // Both fingers of a map at once.
  function put(whom, where) {
    const moving = whom.map((name) => question.contacts.find((c) => c.name === name));
    if (moving.some((c) => !c) || moving.every((c, k) => c.position[0] === where[k][0] && c.position[1] === where[k][1])) return;
    edit();
    moving.forEach((c, k) => { c.position = [...where[k]]; });
    changed();
  }
  const held = (i) => (i < 0 ? load().map((v) => v * perNewton) : contacts()[i].position);
  dragged(stage, () => view, {
    taken(i) { chosen = i; },
    moved(i, x, y) { const to = scene.moved(i, x, y, held(i)); if (to) move(i, to); },
    settled: settle,
  });
  // What was asked becomes what was answered: a contact dragged away from the surface is on it.
  function settle() { if (shaped && answer.contacts) question.contacts.forEach((c, i) => { if (contacts()[i]) { c.position = [...contacts()[i].position]; c.normal = [...contacts()[i].normal]; } }); }
  const WAYS = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1] };
  stage.addEventListener("keydown", (event) => {
    const target = event.target.closest("[data-handle]");
    if (!target) return;
    const i = Number(target.dataset.handle), way = WAYS[event.key], spin = { q: 1, e: -1 }[event.key.toLowerCase()];
    chosen = i;
    if (way) {
      settle();
      move(i, scene.along(i, held(i), way, (event.shiftKey ? 5 : 1) * STEP * view.wide, contacts()[i]));
    } else if (spin && i >= 0 && scene.spun) { edit(); question.contacts[i].normal = scene.spun(question.contacts[i].normal, spin * 0.035); changed(); } else return;
    event.preventDefault();
  });
  leaves.addEventListener("change", () => { edit(); question.leaves = leaves.value === "" ? null : question.contacts[Number(leaves.value)].name; changed(); });
  objective.addEventListener("change", () => { edit(); question.objective = objective.value; changed(); });
  whose.addEventListener("change", () => sides());
  friction.addEventListener("input", () => { edit(); question.contacts.forEach((c, i) => { if (whose.value === "" || Number(whose.value) === i) c.friction = Number(friction.value); }); changed(); });
  torque.addEventListener("input", () => { edit(); question.load[2] = Number(torque.value); changed(); });
  loads.forEach((input, i) => input.addEventListener("input", () => { if (input.value === "") return; edit(); question.load[i] = Number(input.value); changed(); }));
  duration.addEventListener("input", () => { if (!(duration.value > 0)) return; stop(); moment = 0; question.duration = Number(duration.value); changed(); });
  squeeze.addEventListener("input", () => { stop(); moment = answer.plan ? answer.plan.times.length - 1 : 0; question.squeeze = Number(squeeze.value); changed(); });
  time.addEventListener("input", () => { stop(); moment = Number(time.value); draw(); });

  // -- more and fewer fingers, copies ----------------------------------------------------------------------
  function more() {
    if (question.contacts.length >= begin.most) return;
    const far = scene.free || [0.6 * view.wide, 0, 0].slice(0, d), taken = new Set(question.contacts.map((c) => c.name));
    let k = question.contacts.length + 1;
    while (taken.has(`P${k}`)) k++;
    edit();
    question.contacts.push({ name: `P${k}`, position: [...far], normal: unit(far.map((v) => -v)), friction: question.contacts[0].friction });
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
  const again = () => { if (stage.clientWidth && (!view || stage.clientWidth !== view.width)) { view = scene.frame(question.contacts); draw(); sides(); } };
  const watching = new ResizeObserver(again);
  watching.observe(page);
  view = scene.frame(question.contacts); draw(); sides();
  return () => { stop(); clearTimeout(later); watching.disconnect(); };
}
