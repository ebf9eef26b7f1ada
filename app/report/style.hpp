// SPDX-License-Identifier: Apache-2.0
// Style sheet of the report.
#pragma once

#include <string_view>

namespace sunder::app {

inline constexpr std::string_view kStyle = R"css(
:root { --page:#f6f5f3; --card:#fff; --text:#22262a; --soft:#667078; --line:#dedcd8; --accent:#b3261e;
  --c0:#4e79a7; --c1:#e15759; --c2:#f2a93b; --c3:#59a14f; --c4:#9c6bb0; }
@media (prefers-color-scheme: dark) { :root { --page:#15171a; --card:#1f2226; --text:#e6e7e8;
  --soft:#9aa3ab; --line:#34393f; --accent:#ff7a70; --c0:#7ba7d6; --c1:#ff8a86; --c2:#f7c267;
  --c3:#86c97c; --c4:#c79bd9; } }
* { box-sizing:border-box; }
body { margin:0; background:var(--page); color:var(--text);
  font:15px/1.5 system-ui, "Segoe UI", "DejaVu Sans", sans-serif; }
main { max-width:1180px; margin:0 auto; padding:28px 22px 60px; }
h1 { font-size:27px; line-height:1.25; margin:0 0 4px; }
h2 { font-size:18px; margin:0 0 12px; }
h3 { font-size:14px; margin:18px 0 6px; color:var(--soft); font-weight:600; }
header p { margin:0; color:var(--soft); }
section { background:var(--card); border:1px solid var(--line); border-radius:10px;
  padding:18px 20px; margin-top:18px; }
.chip { display:inline-block; padding:1px 10px; border-radius:99px; font-size:13px; margin-left:8px;
  background:var(--c3); color:#fff; vertical-align:middle; }
.chip.bad { background:var(--accent); }
.keys { display:grid; grid-template-columns:repeat(auto-fit,minmax(150px,1fr)); gap:12px; margin-top:18px; }
.keys div { background:var(--card); border:1px solid var(--line); border-radius:10px; padding:12px 14px; }
.keys b { display:block; font-size:22px; font-weight:650; }
.keys span { color:var(--soft); font-size:13px; }
.paper { background:#fff; border:1px solid var(--line); border-radius:10px; margin:18px 0 0; padding:10px;
  text-align:center; color:#444; }
.paper svg, .paper img { max-width:100%; height:auto; }
.paper figcaption { font-size:13px; padding:4px; }
.snapshots { display:grid; grid-template-columns:repeat(auto-fit,minmax(330px,1fr)); gap:14px; }
.snapshots .paper { margin:0; }
.charts { display:grid; grid-template-columns:repeat(auto-fit,minmax(430px,1fr)); gap:18px; }
.chart { width:100%; height:auto; display:block; }
.chart text { fill:var(--soft); font-size:12px; font-family:inherit; }
.chart .label { fill:var(--text); }
.chart .grid { stroke:var(--line); }
.chart .axis { stroke:var(--soft); }
.chart polyline { fill:none; stroke-width:1.8; }
.s0{stroke:var(--c0)} .s1{stroke:var(--c1)} .s2{stroke:var(--c2)} .s3{stroke:var(--c3)} .s4{stroke:var(--c4)}
.f0{fill:var(--c0)} .f1{fill:var(--c1)} .f2{fill:var(--c2)} .f3{fill:var(--c3)} .f4{fill:var(--c4)}
.scroll { overflow:auto; max-height:430px; }
table { border-collapse:collapse; width:100%; font-size:13.5px; font-variant-numeric:tabular-nums; }
th, td { text-align:right; padding:4px 10px; border-bottom:1px solid var(--line); white-space:nowrap; }
th { color:var(--soft); font-weight:600; position:sticky; top:0; background:var(--card); }
th:first-child, td:first-child { text-align:left; }
td.text, th.text { text-align:left; white-space:normal; }
dl { display:grid; grid-template-columns:max-content 1fr; gap:4px 18px; margin:0; }
dt { color:var(--soft); } dd { margin:0; }
ul { margin:0; padding-left:20px; }
.note { color:var(--soft); margin:6px 0; }
.warn { border-left:4px solid var(--c2); } .bad-box { border-left:4px solid var(--accent); }
code { font-family:ui-monospace, "DejaVu Sans Mono", monospace; font-size:13px; }
@media (max-width:640px) { .charts, .snapshots { grid-template-columns:1fr; } }
)css";

}  // namespace sunder::app
