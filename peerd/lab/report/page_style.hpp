#pragma once
#include <string_view>

namespace peerd::report {

// The page's style sheet. The dark scheme exchanges the pictures' neutral colours, which are attributes that a rule
// overrides; colours with a meaning stay.
inline constexpr std::string_view kPageStyle = R"css(
:root { color-scheme: light dark; --back: #fff; --text: #222; --faint: #5b6168; --line: #d4d7db; --head: #f3f4f6; }
body { margin: 0 auto; padding: 1rem; max-width: 84rem; background: var(--back); color: var(--text);
  font: 15px/1.5 'DejaVu Sans', Verdana, Helvetica, Arial, sans-serif; overflow-wrap: anywhere; }
h1 { font-size: 1.5rem; margin: 0.2em 0; } h2 { font-size: 1.15rem; margin: 2em 0 0.4em; }
h3 { font-size: 1rem; margin: 1.2em 0 0.3em; }
a { color: #0069a6; }
p { max-width: 75ch; }
code { font-family: 'DejaVu Sans Mono', monospace; font-size: 0.9em; }
.faint, figcaption { color: var(--faint); font-size: 0.87rem; }
.scroll { overflow-x: auto; }
.scroll:focus-visible { outline: 2px solid #0072b2; }
table { border-collapse: collapse; font-size: 0.85rem; font-variant-numeric: tabular-nums; overflow-wrap: normal; }
th, td { padding: 0.15rem 0.7rem; text-align: left; vertical-align: top; white-space: nowrap;
  border-bottom: 1px solid var(--line); }
td.wrap { white-space: normal; overflow-wrap: anywhere; }
th { background: var(--head); font-weight: 600; }
.n { text-align: right; }
tbody tr:hover { background: var(--head); }
figure { margin: 1rem 0; }
figure svg { display: block; height: auto; max-width: max(100%, 72rem); }
details { border-top: 1px solid var(--line); padding: 0.35rem 0; }
details details { border: 0; }
summary { cursor: pointer; }
ul { padding-left: 1.3rem; margin: 0.4rem 0; }
.counters { columns: 19rem; font-size: 0.85rem; list-style: none; padding: 0; }
@media (prefers-color-scheme: dark) {
  :root { --back: #16181b; --text: #dcdfe3; --faint: #9aa1a9; --line: #3a3f45; --head: #22262a; }
  a { color: #6cb8ee; }
  svg [fill='#fff'] { fill: #16181b; }
  svg [fill='#222'] { fill: #dcdfe3; }
  svg [fill='#444'], svg [fill='#666'] { fill: #aab1b9; }
  svg [stroke='#222'] { stroke: #dcdfe3; }
  svg [stroke='#555'], svg [stroke='#777'] { stroke: #8d949c; }
  svg [stroke='#e4e4e4'] { stroke: #2f3439; }
  svg [stroke='#b8b8b8'] { stroke: #565d65; }
  svg [fill='#0072b2'] { fill: #3b9fd9; } svg [stroke='#0072b2'] { stroke: #3b9fd9; }
}
@media print {
  body { max-width: none; font-size: 11px; }
  .scroll { overflow: visible; }
  figure { break-inside: avoid; }
  figure svg { max-width: 100%; }
  table { font-size: 0.75rem; }
  th, td { padding: 0.1rem 0.3rem; }
}
)css";

}  // namespace peerd::report
