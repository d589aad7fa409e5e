"""The page: sections of tables, pictures and notes, as one HTML file without scripts or outside resources."""
import html
import re

STYLE = """
:root { color-scheme: light dark; --back: #fff; --text: #1d2127; --faint: #5b6168; --line: #d4d7db; --head: #f1f3f5;
  --c0: #0072b2; --c1: #d55e00; --c2: #009e73; --c3: #a3468c; --c4: #8a6d00; --c5: #56707f; }
@media (prefers-color-scheme: dark) { :root { --back: #15171a; --text: #dcdfe3; --faint: #9aa1a9; --line: #3a3f45;
  --head: #22262a; --c0: #4ba6dd; --c1: #f08a3c; --c2: #35c297; --c3: #d98cc4; --c4: #d9b53a; --c5: #9fb4c0; } }
* { box-sizing: border-box; }
body { margin: 0 auto; padding: 1rem; max-width: 78rem; background: var(--back); color: var(--text);
  font: 16px/1.5 'DejaVu Sans', Verdana, Helvetica, Arial, sans-serif; overflow-wrap: anywhere; }
h1 { font-size: 1.5rem; line-height: 1.25; margin: 0.3em 0; } h2 { font-size: 1.2rem; margin: 2.2em 0 0.3em; }
h3 { font-size: 1.02rem; margin: 1.8em 0 0.2em; }
a { color: var(--c0); } p, li { max-width: 75ch; } p { margin: 0.5em 0; }
code { font-family: 'DejaVu Sans Mono', monospace; font-size: 0.86em; }
.faint { color: var(--faint); font-size: 0.9rem; }
.scroll { overflow-x: auto; margin: 0.7rem 0; }
table { border-collapse: collapse; font-size: 0.85rem; font-variant-numeric: tabular-nums; overflow-wrap: normal; }
th, td { padding: 0.15rem 0.6rem; text-align: right; white-space: nowrap; border-bottom: 1px solid var(--line); }
th { background: var(--head); font-weight: 600; vertical-align: bottom; white-space: normal; } th.l { text-align: left; }
th:first-child, td:first-child { text-align: left; position: sticky; left: 0; background: var(--back); }
th:first-child { background: var(--head); }
td.p { color: var(--faint); } td.l { text-align: left; } td.w { white-space: normal; min-width: 16rem; }
.figures { display: grid; grid-template-columns: repeat(auto-fill, minmax(min(100%, 17.5rem), 1fr)); gap: 1rem; margin: 1rem 0; }
figure { margin: 0; min-width: 0; } svg { display: block; width: 100%; height: auto; }
svg text { fill: var(--text); font: 11.5px 'DejaVu Sans', Verdana, sans-serif; }
svg .t { font-size: 13px; font-weight: 600; } svg .a { fill: var(--faint); } svg .e { text-anchor: end; } svg .m { text-anchor: middle; }
svg .g { stroke: var(--line); stroke-width: 0.7; fill: none; } svg .k { stroke: var(--faint); fill: none; }
""" + "\n".join(f"svg .s{i} {{ stroke: var(--c{i}); stroke-width: 1.5; fill: none; stroke-linejoin: round; }} "
                f"svg .f{i} {{ fill: var(--c{i}); }}" for i in range(6)) + """
ul.deviations { padding-left: 1.2rem; margin: 0.5rem 0; } ul.deviations li { margin: 0.25rem 0; }
nav { columns: 16rem; font-size: 0.9rem; } nav a { display: block; }
@media print { body { max-width: none; font-size: 11px; } .scroll { overflow: visible; } figure { break-inside: avoid; } }
"""


def is_number(cell):
    return re.match(r"[−+<-]? ?[\d.]|$|never$|none$", cell) is not None


class Table:
    """Columns that begin with "thesis" hold printed numbers. Cells are texts."""

    def __init__(self, columns, rows):
        self.columns, self.rows = columns, rows

    def markup(self):
        texts = [any(not is_number(row[i]) for row in self.rows) for i in range(len(self.columns))]
        head = "".join(f'<th{" class=l" * text}>{html.escape(c)}</th>' for c, text in zip(self.columns, texts))
        body = "".join("<tr>" + "".join(self.cell(c, v) for c, v in zip(self.columns, row)) + "</tr>" for row in self.rows)
        return f'<div class="scroll" tabindex="0"><table><thead><tr>{head}</tr></thead><tbody>{body}</tbody></table></div>'

    @staticmethod
    def cell(column, value):
        kinds = ["p"] * column.startswith("thesis") + ["l"] * (not is_number(value)) + ["w"] * (len(value) > 44)
        kind = f' class="{" ".join(kinds)}"' if kinds else ""
        return f"<td{kind}>{html.escape(value)}</td>"


class Section:
    """One table or figure of the thesis: `number` such as "Table 3.1", what it asks, ours, and each deviation in a line."""

    def __init__(self, number, question):
        self.number, self.question = number, question
        self.tables, self.pictures, self.deviations, self.commands = [], [], [], []

    @property
    def anchor(self):
        return self.number.lower().replace(" ", "-").replace(".", "-").replace(",", "")

    def markup(self):
        out = [f'<h3 id="{self.anchor}">{html.escape(self.number)}</h3><p>{html.escape(self.question)}</p>']
        out += [table.markup() for table in self.tables]
        if self.pictures:
            out.append('<div class="figures">' + "".join(f"<figure>{p}</figure>" for p in self.pictures) + "</div>")
        out.append('<ul class="deviations">' + "".join(f"<li>{html.escape(d)}</li>" for d in self.deviations) + "</ul>")
        for command in self.commands:
            out.append(f'<p class="faint"><code>{html.escape(command)}</code></p>')
        return "".join(out)


def page(title, introduction, chapters, slips):
    """`chapters`: pairs of a heading and its sections."""
    links = "".join(f'<a href="#{s.anchor}">{html.escape(s.number)}</a>' for _, sections in chapters for s in sections)
    parts = [f"<h1>{html.escape(title)}</h1>"] + [f"<p>{html.escape(p)}</p>" for p in introduction]
    parts.append(f"<nav>{links}</nav>")
    for heading, sections in chapters:
        parts.append(f"<h2>{html.escape(heading)}</h2>" + "".join(s.markup() for s in sections))
    parts.append("<h2>Slips of the thesis that are mended here</h2><ul>" + "".join(f"<li>{html.escape(s)}</li>" for s in slips) + "</ul>")
    return ('<!doctype html><html lang="en"><head><meta charset="utf-8"><meta name="viewport" content="width=device-width, '
            f'initial-scale=1"><title>{html.escape(title)}</title><style>{STYLE}</style></head><body>' + "\n".join(parts) +
            "</body></html>\n")
