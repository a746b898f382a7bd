// How all pages look that the program writes.
#pragma once

namespace matchlight {

inline constexpr const char* page_style = R"(
:root { color-scheme: light; }
body { font: 15px/1.5 system-ui, "DejaVu Sans", sans-serif; color: #1c2430; background: #fff; margin: 0 auto;
  max-width: 1180px; padding: 1.5rem 2rem 4rem; }
h1 { font-size: 1.6rem; margin-bottom: .2rem; }
h2 { font-size: 1.25rem; margin: 2.6rem 0 .3rem; border-bottom: 1px solid #d5dbe3; padding-bottom: .2rem; }
p { margin: .3rem 0 .7rem; max-width: 60rem; }
.note { color: #566274; }
table { border-collapse: collapse; font-size: 13px; font-variant-numeric: tabular-nums; margin: .6rem 0 1rem; }
th, td { padding: .22rem .6rem; text-align: right; border-bottom: 1px solid #e6eaf0; white-space: nowrap; }
th { color: #566274; font-weight: 600; }
th.word, td.word { text-align: left; }
td.long { white-space: normal; min-width: 18rem; }
td.knobs { white-space: normal; min-width: 11rem; font-size: 12px; }
tr.front td:first-child { font-weight: 700; }
tr.skipped td { color: #566274; font-style: italic; }
td.pass { color: #1b7f4b; font-weight: 600; } td.fail { color: #b3261e; font-weight: 700; }
.plot { width: 100%; max-width: 760px; height: auto; display: block; }
.grid { stroke: #e6eaf0; } .self { stroke: #b3261e; stroke-dasharray: 5 4; }
.front { fill: none; stroke: #2a62b8; stroke-width: 1.6; } polyline.front { pointer-events: none; }
.range { stroke: #9fb2cc; stroke-width: 2; }
.best { fill: #2a62b8; } .other { fill: #fff; stroke: #2a62b8; stroke-width: 1.6; }
.tick { font-size: 11px; fill: #566274; } .axis { font-size: 12px; fill: #1c2430; } .label { font-size: 11px; fill: #1c2430; }
.pictures { display: flex; flex-wrap: wrap; gap: .9rem; align-items: flex-start; }
figure { margin: 0; } figure img { display: block; max-width: 240px; image-rendering: auto; background: #000; }
figcaption { font-size: 12px; color: #566274; max-width: 240px; }
pre { font-size: 12px; background: #f5f7fa; padding: .8rem; overflow-x: auto; }
)";

}  // namespace matchlight
