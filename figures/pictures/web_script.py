"""The page of a web: HTML, style and script, all in one. `@NAME@` stands for what is filled in."""

from __future__ import annotations

PAGE = """<!DOCTYPE html>
<html lang="en">
<head>
<meta charset="utf-8">
<meta name="viewport" content="width=device-width, initial-scale=1">
<title>@TITLE@</title>
<style>
:root { color-scheme: light dark; --ink: #222; --paper: #fff; --quiet: #666; --faint: #eee; --rule: #ccc; }
@media (prefers-color-scheme: dark) {
  :root { --ink: #e6e6e6; --paper: #17191c; --quiet: #a8a8a8; --faint: #2c3035; --rule: #555; }
}
body { font: 15px/1.45 system-ui, sans-serif; color: var(--ink); margin: 0 auto; padding: 1rem;
  background: var(--paper); max-width: 78rem; }
h1 { font-size: 1.25rem; }
.panels { display: grid; grid-template-columns: 1fr 1fr; gap: 1rem; }
h1 button { font-size: .8rem; font-weight: normal; }
main { display: flex; flex-direction: column; }
@media (max-width: 50rem) { .panels { grid-template-columns: 1fr; order: -1; } }
.legend span { margin-right: 1rem; white-space: nowrap; }
.legend i { height: 3px; display: inline-block; margin-right: .3rem; vertical-align: middle; width: 1.6rem; }
canvas { width: 100%; aspect-ratio: 4 / 3; border: 1px solid var(--rule); touch-action: none; }
button { font: inherit; margin: 0 .4rem .4rem 0; padding: .1rem .5rem; border: 2px solid; border-radius: .4rem; }
button { background: none; color: inherit; overflow-wrap: anywhere; }
button[aria-pressed="true"] { font-weight: bold; background: var(--faint); }
#meets button { border-color: #999; border-style: dotted; }
.along { display: flex; align-items: center; } .along button { border-color: #999; white-space: nowrap; }
input[type="range"] { flex: 1; min-width: 0; }
dl { display: grid; grid-template-columns: max-content 1fr; gap: 0 .8rem; margin: .5rem 0; }
dd { margin: 0; } .small { color: var(--quiet); font-size: .85rem; } summary { cursor: pointer; }
#theorem p { margin: .3rem 0; overflow-wrap: anywhere; }
</style>
</head>
<body>
<h1><button id="back" type="button" hidden>back</button> @TITLE@</h1>
<main>
<div id="arcs"></div>
<div class="panels">
<div><canvas id="diagram"></canvas><p class="small legend" id="legend"></p>
<p class="small">Vertices are filled, libration points as diamonds@STABLE@. A vertex at which arcs start at
different points of its orbit is drawn at each, joined by a dotted line. Click an arc, or a vertex for its name.
<label><input id="whole" type="checkbox"> all arcs</label></p></div>
<div><canvas id="space"></canvas><p class="small">The orbit in space; drag to turn it. Dots: the two primaries, if near.
</p></div>
</div>
</main>
<div class="along"><button id="move" type="button" aria-pressed="false">move along</button>
<input id="along" type="range" min="0" value="0" aria-label="along the arc"></div>
<div id="meets"></div>
<dl id="facts"></dl>
<p class="small">Ranges of level and period, meetings, indices and the theorem are those that certificates say are
proved.
Single orbits, their levels, periods and multipliers are computed in double precision, and not proved.</p>
<details open><summary>The theorem</summary><div id="theorem">@THEOREM@</div></details>
<script id="data" type="application/json">@DATA@</script>
<script>
"use strict";
const data = JSON.parse(document.getElementById("data").textContent);
const byId = name => document.getElementById(name);
const diagram = byId("diagram"), space = byId("space"), along = byId("along");
let chosen = 0, turn = [-0.7, 0.5];
// The vertex that is asked for, and the one under the pointer.
let picked = null, pointed = null;
let span, rise;
const shade = name => getComputedStyle(document.documentElement).getPropertyValue("--" + name).trim();
function frame() {
  const arcs = byId("whole").checked ? data.arcs : data.arcs[chosen].beside.map(number => data.arcs[number]);
  const ends = index => {
    const values = arcs.flatMap(arc => arc.line.map(p => p[index]));
    const low = Math.min(...values), high = Math.max(...values);
    const room = 0.06 * (high - low) || 1;
    return [low - room, high + room];
  };
  span = ends(0); rise = ends(1);
}
function prepared(canvas) {
  const ratio = window.devicePixelRatio || 1, width = canvas.clientWidth, height = canvas.clientHeight;
  canvas.width = width * ratio; canvas.height = height * ratio;
  const pen = canvas.getContext("2d");
  pen.scale(ratio, ratio); pen.clearRect(0, 0, width, height); pen.font = "12px system-ui, sans-serif";
  return [pen, width, height];
}
function place(level, x, width, height) {
  return [56 + (width - 66) * (level - span[0]) / (span[1] - span[0]),
          height - 40 - (height - 50) * (x - rise[0]) / (rise[1] - rise[0])];
}
function ticks(from, to) {
  const raw = (to - from) / 5, unit = 10 ** Math.floor(Math.log10(raw));
  const step = unit * [1, 2, 5, 10].find(factor => factor * unit >= raw), found = [];
  for (let value = Math.ceil(from / step) * step; value <= to; value += step) found.push(+value.toPrecision(6));
  return found;
}
function drawDiagram() {
  const [pen, width, height] = prepared(diagram);
  pen.fillStyle = shade("quiet"); pen.strokeStyle = shade("faint"); pen.lineWidth = 1;
  for (const value of ticks(...span)) {
    const [u] = place(value, rise[0], width, height);
    pen.beginPath(); pen.moveTo(u, 0); pen.lineTo(u, height - 36); pen.stroke();
    pen.fillText(value, u - 12, height - 22);
  }
  for (const value of ticks(...rise)) {
    const [, v] = place(span[0], value, width, height);
    pen.beginPath(); pen.moveTo(50, v); pen.lineTo(width, v); pen.stroke(); pen.fillText(value, 18, v + 4);
  }
  pen.textAlign = "center"; pen.fillText("Jacobi constant", width / 2, height - 5);
  pen.save(); pen.translate(12, height / 2); pen.rotate(-Math.PI / 2); pen.fillText("x where the orbit starts", 0, 0);
  pen.restore(); pen.textAlign = "start";
  const stroke = (points, colour, thick, dash = []) => {
    pen.strokeStyle = colour; pen.lineWidth = thick; pen.setLineDash(dash.map(length => 2 * length)); pen.beginPath();
    points.forEach((p, i) => pen[i ? "lineTo" : "moveTo"](...place(p[0], p[1], width, height)));
    pen.stroke(); pen.setLineDash([]);
  };
  data.arcs.forEach((arc, number) => {
    arc.stable.forEach(part => stroke(part, arc.colour + "40", 10));
    stroke(arc.line, arc.colour, number === chosen ? 4 : 1.6, arc.dash);
  });
  data.vertices.forEach((vertex, number) => {
    const places = vertex.places.map(([level, x]) => place(level, x, width, height)), noted = number === named();
    pen.fillStyle = pen.strokeStyle = shade("ink"); pen.lineWidth = noted ? 2 : 1;
    pen.setLineDash([2, 4]); pen.beginPath();
    places.forEach((at, i) => pen[i ? "lineTo" : "moveTo"](...at));
    pen.stroke(); pen.setLineDash([]);
    for (const [u, v] of places) {
      pen.beginPath();
      if (vertex.kind === "libration point") {
        pen.moveTo(u, v - 6); pen.lineTo(u + 5, v); pen.lineTo(u, v + 6); pen.lineTo(u - 5, v); pen.fill();
        pen.fillText(vertex.name, u - 22, v - 4);
      } else { pen.arc(u, v, noted ? 6 : 4, 0, 7); pen.fill(); }
    }
  });
  const orbit = current();
  if (orbit) {
    const [u, v] = place(orbit.c, orbit.x, width, height);
    pen.strokeStyle = shade("ink"); pen.lineWidth = 2; pen.beginPath(); pen.arc(u, v, 7, 0, 7); pen.stroke();
  }
  if (named() !== null) label(pen, data.vertices[named()], width, height);
}
function label(pen, vertex, width, height) {
  const size = pen.measureText(vertex.name).width;
  let last = Infinity;
  for (const [level, x] of vertex.places) {
    const [u, v] = place(level, x, width, height);
    if (u < 0 || u > width || v < 0 || v > height || last - v < 18) continue;
    const left = u + 10 + size < width ? u + 10 : Math.max(2, u - 10 - size), line = Math.max(12, v - 6);
    pen.strokeStyle = shade("paper"); pen.lineWidth = 4; pen.lineJoin = "round";
    pen.strokeText(vertex.name, left, line);
    pen.fillStyle = shade("ink"); pen.fillText(vertex.name, left, line);
    last = v;
  }
}
function named() { return pointed === null ? picked : pointed; }
function vertexAt(event) {
  const far = vertex => Math.min(...vertex.places.map(([level, x]) => {
    const [u, v] = place(level, x, diagram.clientWidth, diagram.clientHeight);
    return Math.hypot(u - event.offsetX, v - event.offsetY);
  }));
  const distances = data.vertices.map(far), nearest = Math.min(...distances);
  return nearest < 9 ? distances.indexOf(nearest) : null;
}
function current() { return data.arcs[chosen].orbits[+along.value]; }
function drawSpace() {
  const [pen, width, height] = prepared(space), arc = data.arcs[chosen], orbit = current();
  if (!orbit) { pen.fillText("No orbit of this arc could be followed.", 20, 30); return; }
  const box = [[1, -1], [1, -1], [1, -1]].map(() => [Infinity, -Infinity]);
  for (const each of arc.orbits) each.p.forEach((value, i) => {
    box[i % 3][0] = Math.min(box[i % 3][0], value); box[i % 3][1] = Math.max(box[i % 3][1], value);
  });
  const middle = box.map(side => (side[0] + side[1]) / 2);
  const size = Math.hypot(...box.map(side => side[1] - side[0])) || 1, scale = 0.92 * Math.min(width, height) / size;
  const [ca, sa, cb, sb] = [Math.cos(turn[0]), Math.sin(turn[0]), Math.cos(turn[1]), Math.sin(turn[1])];
  const seen = (x, y, z) => {
    const [a, b, c] = [x - middle[0], y - middle[1], z - middle[2]], far = sa * a + ca * b;
    return [width / 2 + scale * (ca * a - sa * b), height / 2 - scale * (cb * c + sb * far)];
  };
  const path = (each, colour, thick) => {
    pen.strokeStyle = colour; pen.lineWidth = thick; pen.beginPath();
    for (let i = 0; i < each.p.length; i += 3) pen[i ? "lineTo" : "moveTo"](...seen(...each.p.slice(i, i + 3)));
    pen.stroke();
  };
  arc.orbits.forEach((each, i) => { if (i % 4 === 0) path(each, arc.colour + "30", 1); });
  path(orbit, arc.colour, 3);
  data.bodies.forEach((x, i) => {
    if (x < box[0][0] - size / 2 || x > box[0][1] + size / 2) return;
    const [u, v] = seen(x, 0, 0);
    pen.fillStyle = shade("ink"); pen.beginPath(); pen.arc(u, v, i ? 4 : 7, 0, 7); pen.fill();
  });
  pen.fillStyle = pen.strokeStyle = shade("quiet"); pen.lineWidth = 1;
  [["x", 1, 0, 0], ["y", 0, 1, 0], ["z", 0, 0, 1]].forEach(([name, a, b, c]) => {
    const from = seen(...middle), to = seen(middle[0] + a, middle[1] + b, middle[2] + c);
    const u = [36, height - 36], length = 26 / scale;
    const v = [u[0] + (to[0] - from[0]) * length, u[1] + (to[1] - from[1]) * length];
    pen.beginPath(); pen.moveTo(...u); pen.lineTo(...v); pen.stroke(); pen.fillText(name, v[0] + 2, v[1] - 2);
  });
}
function tell() {
  const arc = data.arcs[chosen], orbit = current(), list = byId("facts");
  const stable = !orbit ? "" : orbit.m < 1.001 ? "linearly stable, as computed" : "largest multiplier about " + orbit.m;
  const vertex = picked === null ? null : data.vertices[picked];
  const through = data.arcs.filter(each => each.meets.some(([, number]) => number === picked)).map(each => each.name);
  const facts = [["arc", arc.id + ": " + arc.words + (arc.meets.length ? "" : "; meets no vertex")],
    ["Jacobi constant", "all in " + arc.level + (orbit ? "; this orbit about " + orbit.c : "")],
    ["period", "all in " + arc.period + (orbit ? "; this orbit about " + orbit.t : "")],
    ["stability", [stable, arc.list].filter(Boolean).join("; ")],
    ["index", orbit && orbit.i !== null ? "Conley-Zehnder index of orbits about here " + orbit.i : "not counted here"]];
  if (vertex) facts.push(["vertex", vertex.name + ": " + vertex.kind + ", Jacobi constant in " + vertex.level
    + "; met by " + through.join(", ")]);
  list.replaceChildren(...facts.flatMap(([name, text]) => ["dt", "dd"].map((kind, i) => {
    const element = document.createElement(kind);
    element.textContent = i ? text : name;
    return element;
  })));
}
function draw() {
  frame(); drawDiagram(); drawSpace(); tell();
  const meets = data.arcs[chosen].meets;
  [...byId("meets").children].forEach((button, i) => button.setAttribute("aria-pressed", meets[i][1] === picked));
}
function pick(number) { picked = number === picked ? null : number; draw(); }
let moving = 0;
function move(starts) {
  clearInterval(moving); moving = 0;
  byId("move").setAttribute("aria-pressed", starts);
  if (!starts) return;
  if (+along.value >= +along.max) along.value = 0;
  moving = setInterval(() => {
    along.value = +along.value + 1; draw();
    if (+along.value >= +along.max) move(false);
  }, 120);
}
byId("move").onclick = () => { move(!moving); draw(); };
function choose(number) {
  move(false);
  chosen = number; along.max = Math.max(0, data.arcs[number].orbits.length - 1);
  along.value = Math.floor(along.max / 2);
  [...byId("arcs").children].forEach((button, i) => button.setAttribute("aria-pressed", i === number));
  byId("meets").replaceChildren(...data.arcs[number].meets.map(([how, vertex]) => {
    const button = document.createElement("button");
    button.textContent = how + " " + data.vertices[vertex].name; button.onclick = () => pick(vertex);
    return button;
  }));
  history.replaceState(null, "", "#" + encodeURIComponent(data.arcs[number].id));
  draw();
}
data.arcs.forEach((arc, number) => {
  const button = document.createElement("button");
  button.textContent = arc.name; button.style.borderColor = arc.colour; button.onclick = () => choose(number);
  byId("arcs").append(button);
});
const kinds = new Map(data.arcs.map(arc => [arc.words, arc]));
byId("legend").replaceChildren(...[...kinds].map(([words, { colour, dash }]) => {
  const entry = document.createElement("span"), line = document.createElement("i");
  let at = 0;
  const parts = dash.map((length, i) => `${i % 2 ? "transparent" : colour} ${2 * at}px ${2 * (at += length)}px`);
  line.style.background = dash.length ? `repeating-linear-gradient(90deg, ${parts})` : colour;
  entry.append(line, words);
  return entry;
}));
byId("back").hidden = history.length < 2;
byId("back").onclick = () => history.back();
matchMedia("(prefers-color-scheme: dark)").onchange = () => draw();
along.oninput = () => { move(false); draw(); };
byId("whole").onchange = draw;
diagram.onpointermove = event => {
  const before = pointed;
  pointed = event.pointerType === "mouse" ? vertexAt(event) : null;
  if (pointed !== before) drawDiagram();
};
diagram.onpointerleave = () => { pointed = null; drawDiagram(); };
diagram.onclick = event => {
  const vertex = vertexAt(event);
  if (vertex !== null) { pick(vertex); return; }
  const [width, height] = [diagram.clientWidth, diagram.clientHeight];
  const far = arc => Math.min(...arc.line.map(p => {
    const [u, v] = place(p[0], p[1], width, height);
    return Math.hypot(u - event.offsetX, v - event.offsetY);
  }));
  const distances = data.arcs.map(far);
  choose(distances.indexOf(Math.min(...distances)));
};
let held = null;
space.onpointerdown = event => { held = [event.clientX, event.clientY]; space.setPointerCapture(event.pointerId); };
space.onpointermove = event => {
  if (!held) return;
  turn = [turn[0] + (event.clientX - held[0]) / 120, turn[1] + (event.clientY - held[1]) / 120];
  held = [event.clientX, event.clientY]; drawSpace();
};
space.onpointerup = () => { held = null; };
window.onresize = draw;
const asked = decodeURIComponent(location.hash.slice(1));
choose(Math.max(0, data.arcs.findIndex(arc => arc.id === asked)));
</script>
</body>
</html>
"""
