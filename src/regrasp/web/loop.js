import { GREY, INK, Labels, add, arrow, colour, node, short, size } from "./scene.js";
import { Camera, turnable } from "./turning.js";

const BACK = "#bbbbbb";

// The part of a segment that is near: a locus may be without end.
function clipped([a, b], placed, reach) {
  const along = (k) => add(a, add(b, a, -1), k), near = [];
  for (let k = 0; k <= 200; k++) if (size(placed(along(k / 200))) <= reach) near.push(k / 200);
  return near.length > 1 ? [along(near[0]), along(near.at(-1))] : [a, b];
}

// Wrench space in the plane: the load, then the wrenches of the fingers tail to head; that the loop closes is equilibrium.
export function loop_look(svg) {
  const camera = new Camera(-0.9, 0.45);
  let shown = null;
  turnable(svg, camera, () => draw());
  function draw() {
    svg.replaceChildren();
    if (!shown || !shown.answer.state || !shown.answer.state.wrenches) return node(svg, "text", { x: 8, y: 20, "font-size": 13, fill: INK }, "No wrenches: nothing holds.");
    const { answer, list, load, moment, width } = shown, height = Math.round(Math.min(0.86 * width, 400));
    svg.setAttribute("viewBox", `0 0 ${width} ${height}`);
    const all = answer.plan ? answer.plan.wrenches[moment] : answer.state.wrenches;
    const away = new Set(answer.plan ? answer.plan.leaving : []);
    const order = list.map((c, i) => i).sort((a, b) => away.has(list[b].name) - away.has(list[a].name) || a - b);
    let at = load;
    const tails = order.map((i) => { const tail = at; at = add(at, all[i]); return tail; });
    const own = [[0, 0, 0], load, ...tails, at], forces = Math.max(...own.flatMap((p) => p.slice(0, 2).map(Math.abs))) || 1;
    const torques = Math.max(...own.map((p) => Math.abs(p[2]))), squeezed = torques > 0 ? forces / torques : 1;
    const placed = (w) => [w[0], w[1], w[2] * squeezed];  // an axis of its own
    const segment = answer.locus ? clipped(answer.locus.wrenches.map((w) => add(load, w[0])), placed, 1.6 * forces) : [], points = [...own, ...segment];
    const seen = points.map(placed), low = [0, 1, 2].map((i) => Math.min(...seen.map((p) => p[i]))), high = [0, 1, 2].map((i) => Math.max(...seen.map((p) => p[i])));
    const longest = Math.max(...order.map((i) => size(placed(all[i])))) || 1;
    const cones = order.map((i, k) => {
      const tail = placed(tails[k]), long = Math.max(1.1 * size(placed(all[i])), 0.3 * longest);
      return [tail, ...answer.state.cones[i].map(placed).map((e) => add(tail, e, long / (size(e) || 1)))];
    });
    const pixels = [...seen, ...cones.flat()].map((p) => camera.flat(p)), ends = (i) => [Math.min(...pixels.map((p) => p[i])), Math.max(...pixels.map((p) => p[i]))];
    const [x0, x1] = ends(0), [y0, y1] = ends(1), room = [(width - 90) / (x1 - x0 || 1), (height - 66) / (y1 - y0 || 1)];
    camera.middle = add(camera.right.map((v) => (v * (x0 + x1)) / 2), camera.up, (y0 + y1) / 2);
    camera.frame(width, height, Math.min(...room));
    const labels = new Labels(svg, camera);
    // The plane without torque, and the three axes with their ends in words.
    const floor = [[low[0], low[1]], [high[0], low[1]], [high[0], high[1]], [low[0], high[1]]].map(([x, y]) => camera.at([x, y, 0]));
    node(svg, "polygon", { points: floor.map((p) => p.join(",")).join(" "), fill: "#f3f3f3" });
    [["fx", "N"], ["fy", "N"], ["torque", "N m"]].forEach(([name, unit], i) => {
      const to = [0, 0, 0].with(i, Math.abs(high[i]) >= Math.abs(low[i]) ? high[i] : low[i]), [a, b] = [camera.at([0, 0, 0]), camera.at(to)];
      if (size(add(b, a, -1)) < 4) return;
      node(svg, "line", { x1: a[0], y1: a[1], x2: b[0], y2: b[1], stroke: BACK, "stroke-width": 1.2 });
      const value = to[i] / (i === 2 ? squeezed : 1);
      labels.add(`${name} ${short(value, 2)} ${unit}`, to, camera.flat(to), { "font-size": 12, fill: "#555" });
    });
    order.forEach((i, k) => {
      const corners = cones[k].map((p) => camera.at(p));
      node(svg, "polygon", { points: corners.map((p) => p.join(",")).join(" "), fill: colour(i), "fill-opacity": 0.14, stroke: colour(i), "stroke-width": 0.8 });
    });
    if (segment.length) {
      const [a, b] = segment.map((p) => camera.at(placed(p)));
      node(svg, "line", { x1: a[0], y1: a[1], x2: b[0], y2: b[1], stroke: INK, "stroke-width": 6, "stroke-opacity": 0.35, "stroke-linecap": "round", class: "locus" });
      labels.add("LS_B", placed(segment[1]), [1, 0.4]);
    }
    arrow(svg, camera, [0, 0, 0], placed(load), { stroke: INK, width: 2.6 });
    labels.line([0, 0, 0], placed(load)); labels.add("load", add([0, 0, 0], placed(load), 0.5), [1, 0]);
    order.forEach((i, k) => {
      const tail = placed(tails[k]), head = add(tail, placed(all[i]));
      if (!arrow(svg, camera, tail, head, { stroke: colour(i), width: 2.6, class: "wrench" })) return;
      labels.line(tail, head); labels.add(list[i].name, add(tail, placed(all[i]), 0.5), [1, 0]);
    });
    const [x, y] = camera.at([0, 0, 0]);
    node(svg, "circle", { cx: x, cy: y, r: 3.5, fill: INK });
    node(svg, "text", { x: 4, y: 13, "font-size": 12, fill: INK }, "wrenches, tail to head; torque on its own scale");
    node(svg, "text", { x: 4, y: height - 6, "font-size": 12, fill: GREY }, "drag or arrow keys turn it");
  }
  return (now) => { shown = now; draw(); };
}
