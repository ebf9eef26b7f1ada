// SPDX-License-Identifier: Apache-2.0
// The plot of a sweep's page: choices of columns, and what draws them.
#pragma once

#include <string_view>

namespace sunder::app::sweep {

inline constexpr std::string_view kPlotStyle = R"css(
.choices { display:flex; flex-wrap:wrap; gap:8px 18px; margin-bottom:12px; }
.choices select { font:inherit; max-width:22em; }
#plot { width:100%; height:auto; display:block; }
#plot text { fill:var(--soft); font-size:12px; font-family:inherit; }
#plot .grid { stroke:var(--line); }
#plot .dots { fill:none; stroke-width:4; stroke-linecap:round; opacity:.75; }
#plot .mean { fill:none; stroke-width:1.6; }
)css";

inline constexpr std::string_view kPlot = R"html(<section><h2>Any column over any key</h2>
<div class="choices">
<label>column <select id="y"></select></label>
<label>over <select id="x"></select></label>
<label>coloured by <select id="by"></select></label>
</div>
<svg id="plot" viewBox="0 0 1000 460" role="img"></svg>
<p class="note">Points are runs, lines their means; words stand in the order of the table. What has no value
is left out.</p>
<noscript><p class="note">The plot needs scripts; the numbers are in sweep.csv.</p></noscript>
</section>
)html";

inline constexpr std::string_view kPlotScript = R"js(
const at = id => document.getElementById(id);
const names = sweep.columns, rows = sweep.rows, colours = 5;
const box = { left: 90, right: 985, top: 14, bottom: 410 };
function choose(id, from, chosen, none) {
  if (none) at(id).add(new Option("nothing", -1));
  from.forEach(i => at(id).add(new Option(names[i], i)));
  at(id).value = chosen;
  at(id).addEventListener("change", draw);
}
const isNumber = v => typeof v === "number";
const numeric = i => rows.some(r => isNumber(r[i]));
// Places of a column's values: numbers as they are, words by their order.
function scale(i) {
  const words = [...new Set(rows.map(r => r[i]).filter(v => v !== ""))];
  return words.every(isNumber) ? { of: v => v, label: null } : { of: v => words.indexOf(v), label: words };
}
function ticks(low, high) {
  const raw = (high - low) / 6, power = Math.pow(10, Math.floor(Math.log10(raw))), lead = raw / power;
  const step = (lead <= 1 ? 1 : lead <= 2 ? 2 : lead <= 5 ? 5 : 10) * power, all = [];
  for (let t = Math.ceil(low / step - 1e-9); t * step <= high + 1e-9 * step; ++t) all.push(t * step);
  return all;
}
function range(values) {
  let low = Infinity, high = -Infinity;
  for (const v of values) { low = Math.min(low, v); high = Math.max(high, v); }
  if (!(high > low)) { const d = low === 0 ? 1 : Math.abs(low) / 2; low -= d; high += d; }
  return [low, high];
}
const short = v => String(Number(v.toPrecision(5)));
const clean = s => String(s).replace(/[&<>"]/g, c => "&#" + c.charCodeAt(0) + ";");
function draw() {
  const x = +at("x").value, y = +at("y").value, by = +at("by").value, sx = scale(x);
  const points = rows.filter(r => isNumber(r[y]) && r[x] !== "").map(r => [sx.of(r[x]), r[y], by < 0 ? "" : r[by]]);
  if (!points.length) { at("plot").innerHTML = "<text x='500' y='220' text-anchor='middle'>no run has a value</text>"; return; }
  const [x0, x1] = range(points.map(p => p[0])), [y0, y1] = range(points.map(p => p[1]));
  const px = v => box.left + (v - x0) / (x1 - x0) * (box.right - box.left);
  const py = v => box.bottom - (v - y0) / (y1 - y0) * (box.bottom - box.top);
  let out = "";
  for (const t of ticks(y0, y1)) out += `<path class="grid" d="M${box.left} ${py(t)}H${box.right}"/><text x="${box.left - 8}" y="${py(t) + 4}" text-anchor="end">${short(t)}</text>`;
  const xt = sx.label ? sx.label.map((w, i) => [i, w]) : ticks(x0, x1).map(t => [t, short(t)]);
  const every = Math.ceil(xt.length / 12);
  xt.forEach(([v, w], i) => { if (i % every === 0 && v >= x0 && v <= x1) out += `<text x="${px(v)}" y="${box.bottom + 18}" text-anchor="middle">${clean(String(w).slice(0, 24))}</text>`; });
  out += `<text x="${(box.left + box.right) / 2}" y="450" text-anchor="middle">${clean(names[x])}</text>`;
  const groups = new Map();
  for (const p of points) { if (!groups.has(p[2])) groups.set(p[2], []); groups.get(p[2]).push(p); }
  let g = 0;
  for (const [name, group] of groups) {
    const c = g % colours, sums = new Map();
    for (const p of group) { const s = sums.get(p[0]) || [0, 0]; sums.set(p[0], [s[0] + p[1], s[1] + 1]); }
    const mean = [...sums].sort((a, b) => a[0] - b[0]).map(([v, s]) => `${px(v)} ${py(s[0] / s[1])}`);
    out += `<path class="dots s${c}" d="${group.map(p => `M${px(p[0])} ${py(p[1])}h0`).join("")}"/>`;
    if (groups.size <= 40) out += `<path class="mean s${c}" d="M${mean.join("L")}"/>`;
    if (by >= 0 && g < 20) out += `<text class="f${c}" style="fill:var(--c${c})" x="${box.right - 4}" y="${box.top + 16 + 15 * g}" text-anchor="end">${clean(String(name).slice(0, 30))}</text>`;
    ++g;
  }
  at("plot").innerHTML = out;
}
const keys = names.map((_, i) => i).slice(0, sweep.keys);
const results = names.map((_, i) => i).filter(i => i >= sweep.keys && numeric(i));
const first = results.find(i => names[i] === "destroyed" ) ?? results[0];
choose("y", results, first);
choose("x", keys.concat(results), 0);
choose("by", keys, sweep.keys > 1 ? sweep.keys - 1 : -1, true);
draw();
)js";

}  // namespace sunder::app::sweep
