#include "peerd/lab/report/page.hpp"

#include <algorithm>
#include <array>
#include <cstddef>
#include <functional>
#include <limits>
#include <string_view>
#include <utility>
#include <vector>

#include <nlohmann/json.hpp>

#include "peerd/input/json_text.hpp"
#include "peerd/lab/measure/pareto.hpp"
#include "peerd/lab/measure/sweep.hpp"
#include "peerd/lab/report/markup.hpp"
#include "peerd/lab/report/page_frame.hpp"
#include "peerd/lab/report/table.hpp"

namespace peerd::report {
namespace {

// A browser opens some ten megabytes without a stutter.
constexpr std::size_t kMostFigureBytes = 8u << 20;  // for all figures of single runs
constexpr std::size_t kMostRuns = 200;              // runs with details
constexpr std::size_t kMostRunRows = 400;           // rows of the table of runs
constexpr std::size_t kMostObjectRows = 24;         // rows of a run's table of objects
constexpr std::size_t kMostObjects = 100;           // rows of the table of all objects
constexpr std::size_t kMostNames = 40;              // names of peers, of objects, and values of a key

// Four digits are more than the samples bear, and they tell errors of all sizes apart.
std::string four_digits(double value) { return digits_text(value, 4); }

std::string counted(std::size_t count, std::string_view what) {
  return std::to_string(count) + ' ' + std::string(what) + (count == 1 ? "" : "s");
}

// Lists all names of a short list, else its beginning and the number of the others.
std::string listed(const std::vector<std::string>& names) {
  std::string out;
  for (std::size_t i = 0; i < std::min(names.size(), kMostNames); ++i) out += (i > 0 ? ", " : "") + names[i];
  if (names.size() > kMostNames) out += " and " + std::to_string(names.size() - kMostNames) + " more";
  return out;
}

// Wide content scrolls by itself instead of the page. tabindex lets the keyboard scroll it.
std::string scrolling(const std::string& content) {
  return "<div class=\"scroll\" tabindex=\"0\">" + content + "</div>\n";
}

// Prints columns as a table. Rows beyond `most` are left out and counted. first_cell may link a row to another place.
std::string table_of(const std::vector<Column>& columns, std::size_t most,
                     std::string (*first_cell)(const std::string&) = nullptr) {
  if (columns.empty()) return "";
  std::string out = "<table>\n<thead>";
  if (std::ranges::any_of(columns, [](const Column& c) { return !c.group.empty(); })) {
    out += "<tr>";
    for (std::size_t c = 0; c < columns.size();) {
      std::size_t end = c + 1;
      while (end < columns.size() && columns[end].group == columns[c].group) ++end;
      out += element("th colspan=\"" + std::to_string(end - c) + "\"", markup_text(columns[c].group));
      c = end;
    }
    out += "</tr>";
  }
  out += "<tr>";
  for (const Column& c : columns) out += element(c.numeric ? "th class=\"n\"" : "th", markup_text(c.name));
  out += "</tr></thead>\n<tbody>\n";
  const std::size_t rows = columns.front().cells.size();
  for (std::size_t r = 0; r < std::min(rows, most); ++r) {
    out += "<tr>";
    for (std::size_t c = 0; c < columns.size(); ++c) {
      const std::string& cell = columns[c].cells[r];
      out += element(columns[c].numeric ? "td class=\"n\"" : "td",
                     c == 0 && first_cell != nullptr ? first_cell(cell) : markup_text(cell));
    }
    out += "</tr>\n";
  }
  out += "</tbody></table>";
  out = scrolling(out);
  if (rows > most) {
    out += element("p class=\"faint\"", std::to_string(rows - most) +
                                            " more rows are left out of this page; "
                                            "<a href=\"summary.json\">summary.json</a> has them.") +
           '\n';
  }
  return out;
}

std::string run_anchor(std::size_t number) { return "run-" + std::to_string(number); }

std::string run_link(const std::string& number) { return "<a href=\"#run-" + number + "\">" + number + "</a>"; }

// --- The scenario and its command

std::string keys_table(std::span<const measure::RunRecord> runs) {
  std::vector<measure::Params> params;
  std::vector<std::string> keys;
  for (const measure::RunRecord& run : runs) {
    params.push_back(measure::with_network(run.params, run.network_settings));
    for (const auto& item : params.back().items()) {
      if (std::ranges::find(keys, item.key()) == keys.end()) keys.push_back(item.key());
    }
  }
  if (keys.empty()) return "";
  const std::vector<std::string> varying = measure::varying_keys(params);
  std::string rows;
  for (const std::string& key : keys) {
    std::vector<std::string> values;
    for (const measure::Params& p : params) {
      const std::string value = p.contains(key) ? measure::value_text(p, key) : "not set";
      if (std::ranges::find(values, value) == values.end()) values.push_back(value);
    }
    const bool swept = std::ranges::find(varying, key) != varying.end();
    rows += "<tr><td><code>" + markup_text(key) + "</code></td><td>" + (swept ? "swept" : "set") +
            "</td><td class=\"wrap\">" + markup_text(listed(values)) + "</td></tr>\n";
  }
  return scrolling("<table>\n<thead><tr><th>key</th><th></th><th>values</th></tr></thead>\n<tbody>\n" + rows +
                   "</tbody></table>");
}

std::string what_was_run(const measure::ScenarioInfo& info, std::span<const measure::RunRecord> runs) {
  std::string out = "<h2>What was run</h2>\n";
  std::string text = "Scenario " + element("strong", markup_text(info.name)) + ", " +
                     (info.mode == "sim"    ? "on a simulated network"
                      : info.mode == "real" ? "between real processes on this computer's network"
                                            : "mode " + markup_text(info.mode)) +
                     ", seed " + std::to_string(info.seed) + ", " + counted(runs.size(), "run");
  if (!runs.empty()) {
    const measure::RunRecord& run = runs.front();
    std::vector<std::string> peers, objects;
    for (const measure::PeerInfo& peer : run.peers) peers.push_back(peer.name);
    for (const measure::ObjectInfo& object : run.objects) objects.push_back(object.path);
    text += " of " + four_digits(run.duration_s) + " s. Peers: " + markup_text(listed(peers)) +
            ". Objects that peers run: " + (objects.empty() ? "none" : markup_text(listed(objects)));
  }
  out += element("p", text + '.') + '\n';
  if (!info.command.empty()) out += scrolling(element("code", markup_text(info.command)));
  return out + keys_table(runs);
}

// The list of warnings, which come before the numbers.
std::string warnings_list(const Json& summary) {
  if (!summary.contains("warnings")) return "";
  std::string items;
  for (const Json& warning : summary.at("warnings")) {
    items += element("li", markup_text(warning.get<std::string>())) + '\n';
  }
  return "<h2>Warnings</h2>\n" + element("ul", items) + '\n';
}

// The results of the expectations, as summary.json has them.
std::string expectations_section(const Json& summary) {
  if (!summary.contains("expectations")) return "";
  std::vector<Column> columns{{"", "name", false, {}},    {"", "expected", false, {}}, {"", "", false, {}},
                              {"", "compared", true, {}}, {"", "failed", true, {}},    {"", "the worst", false, {}}};
  for (const Json& e : summary.at("expectations")) {
    std::string expected = e.at("that").get<std::string>();
    for (const auto& [key, words] :
         {std::pair("at_least", " >= "), std::pair("at_most", " <= "), std::pair("equals", " = "),
          std::pair("object", " of "), std::pair("observer", " at ")}) {
      if (!e.contains(key)) continue;
      expected += words + (e.at(key).is_string() ? e.at(key).get<std::string>() : json_line(e.at(key)));
    }
    std::string worst;
    if (!e.at("failures").empty()) {
      const Json& failure = e.at("failures").front();
      worst = json_line(failure.at("found")) + " in run " + json_line(failure.at("run"));
      for (const char* key : {"object", "observer", "why"}) {
        if (failure.contains(key)) worst += ", " + failure.at(key).get<std::string>();
      }
    }
    const Json& held = e.at("held");
    const std::array cells{e.at("name").get<std::string>(),
                           expected,
                           std::string(held.is_null()     ? "not checked"
                                       : held.get<bool>() ? "held"
                                                          : "FAILED"),
                           json_line(e.at("values")),
                           json_line(e.at("failed")),
                           worst};
    for (std::size_t c = 0; c < cells.size(); ++c) columns[c].cells.push_back(cells[c]);
  }
  return "<h2>Expectations</h2>\n" + table_of(columns, kMostRunRows);
}

// --- All runs

std::string runs_table(const Json& summary) {
  const std::string object = principal_object(summary);
  std::string out = "<h2>Runs</h2>\n";
  out +=
      element("p class=\"faint\"",
              object.empty() ? "No object that another peer observes."
                             : "Updates sent of " + markup_text(object) +
                                   ", errors of its ghost [m], bytes/s of all datagrams. A number leads to its run.");
  out += '\n' + table_of(run_columns(summary, four_digits), kMostRunRows, run_link);
  const std::string wrong = wrong_outcomes_table(summary);
  return wrong.empty() ? out : out + scrolling(element("pre", markup_lines(wrong)));
}

// All objects over all runs; the figures and the table of runs show the first of them.
std::string all_objects_section(const Json& summary) {
  std::vector<Column> columns = object_columns(summary, std::numeric_limits<std::size_t>::max(), four_digits);
  if (columns.front().cells.size() < 2) return "";
  for (std::size_t c = 4; c < columns.size(); ++c) columns[c].group = "ghost error [m]";
  return "<h2>Objects</h2>\n" +
         element("p class=\"faint\"",
                 "All runs and observers together, the worst first: updates a run, the mean of the mean errors, the "
                 "greatest p99 and the greatest error. " +
                     std::string(kPrincipalMark) + " marks the object that the table of runs and most figures show.") +
         '\n' + table_of(columns, kMostObjects);
}

std::string front_sentence(const Json& summary) {
  std::string out;
  for (const measure::Situation& s : measure::pareto_fronts(summary)) {
    std::vector<std::string> numbers;
    for (const measure::RunCost& run : s.runs) {
      if (run.on_front) numbers.push_back(std::to_string(run.run + 1));
    }
    out += (out.empty() ? "" : "; ") + (s.label.empty() ? "" : s.label + ": ") + "run " + listed(numbers);
  }
  return "Not beaten: " + markup_text(out) + '.';
}

std::string overview_section(const Json& summary, const Figures& figures) {
  std::string out = "<h2>All runs at a glance</h2>\n";
  out += figure_markup(figures.overview, "overview", "Mean error of the ghost, and the updates that it took.");
  if (!figures.pareto.is_null()) {
    out += figure_markup(
        figures.pareto, "pareto",
        "Error against bytes: the mean over observers and over the objects that err at all, and all that all "
        "peers send. " +
            front_sentence(summary));
  }
  if (summary.at("runs").size() > 1) {
    out += data_element("sweep", figures.sweep) + '\n' +
           figure_markup({{"kind", "multiples"}}, "multiples",
                         "Run by run, numbered row by row: path, error and the owner's output. One scale for equal "
                         "latencies.");
  }
  return out +
         figure_markup(figures.plan, "plan",
                       "From above, the run with the greatest mean error: the paths of all objects that move, and what "
                       "stands about them.");
}

// --- One run

// The rows of objects, those with the greatest mean errors first.
std::string views_table(const Json& run, const std::string& principal) {
  std::vector<const Json*> rows;
  for (const Json& row : run.at("objects")) rows.push_back(&row);
  std::ranges::stable_sort(rows, std::ranges::greater{},
                           [](const Json* row) { return row->at("ghost_error_m").at("mean").get<double>(); });
  std::vector<Column> columns{{"", "", false, {}},
                              {"", "object", false, {}},
                              {"", "owner", false, {}},
                              {"", "observer", false, {}},
                              {"", "updates", true, {}},
                              {"", "bytes", true, {}},
                              {"", "samples", true, {}},
                              {"ghost error [m]", "mean", true, {}},
                              {"ghost error [m]", "rms", true, {}},
                              {"ghost error [m]", "p99", true, {}},
                              {"ghost error [m]", "max", true, {}},
                              {"shown error [m]", "mean", true, {}},
                              {"shown error [m]", "max", true, {}},
                              {"", "integral [m s]", true, {}}};
  for (const Json* row : rows) {
    std::size_t c = 0;
    const bool seen = row->at("samples") > 0;
    const auto add = [&](std::string text) { columns[c++].cells.push_back(std::move(text)); };
    const auto add_error = [&](const char* which, const char* what) {
      add(seen ? four_digits(row->at(which).at(what).get<double>()) : "-");
    };
    add(row->at("path") == principal ? std::string(kPrincipalMark) : "");
    for (const char* name : {"path", "owner", "observer"}) add(row->at(name).get<std::string>());
    for (const char* name : {"updates_sent", "bytes_sent", "samples"}) add(json_line(row->at(name)));
    for (const char* what : {"mean", "rms", "p99", "max"}) add_error("ghost_error_m", what);
    for (const char* what : {"mean", "max"}) add_error("shown_error_m", what);
    add(seen ? four_digits(row->at("inconsistency_m_s").get<double>()) : "-");
  }
  return "<h3>Objects</h3>\n" + table_of(columns, kMostObjectRows);
}

// Adds those numbers of a JSON object that it has as the cells of one row.
void add_row(std::vector<Column>& columns, const std::string& name, const Json& numbers) {
  columns.front().cells.push_back(name);
  for (Column& c : std::span(columns).subspan(1)) {
    c.cells.push_back(numbers.contains(c.name) ? json_line(numbers.at(c.name)) : "");
  }
}

std::string contacts_table(const Json& collisions) {
  std::vector<Column> columns{{"", "", false, {}}};
  for (const char* name : {"decided", "agreed", "disagreed", "missed", "spurious", "revised"})
    columns.push_back({"", name, true, {}});
  add_row(columns, "all contacts", collisions);
  add_row(columns, "between objects of two peers", collisions.at("shared"));
  std::string out = "<h3>Contacts</h3>\n" + table_of(columns, 2);
  const Json& latency = collisions.at("decision_latency_ms");
  std::string text = "From a contact until a peer held it: mean " + four_digits(latency.at("mean").get<double>()) +
                     " ms, p99 " + four_digits(latency.at("p99").get<double>()) + " ms, at most " +
                     four_digits(latency.at("max").get<double>()) + " ms.";
  if (collisions.contains("wrong")) {
    const Json& wrong = collisions.at("wrong");
    text += " Against the run without latency: of " + json_line(wrong.at("truth")) + " outcomes " +
            json_line(wrong.at("missing")) + " missing, and " + json_line(wrong.at("spurious")) +
            " that it does not have.";
  }
  return out + element("p", text) + '\n';
}

std::string interest_table(const Json& interest) {
  std::vector<Column> columns{{"", "peer", false, {}}};
  for (const char* name : {"objects", "received_bytes", "interest_bytes", "received_over_interest", "groups", "joins",
                           "leaves", "joins_in_a_second"})
    columns.push_back({"", name, true, {}});
  for (const Json& peer : interest.at("peers")) {
    columns.front().cells.push_back(peer.at("peer").get<std::string>());
    for (Column& c : std::span(columns).subspan(1)) {
      const Json& value = peer.at(c.name);
      c.cells.push_back(value.is_number_float() ? four_digits(value.get<double>()) : json_line(value));
    }
  }
  for (Column& c : columns) std::ranges::replace(c.name, '_', ' ');
  return "<h3>Areas of interest</h3>\n" + table_of(columns, kMostObjectRows) +
         element("p", "Longest without an object in the area " +
                          four_digits(interest.at("longest_missing_ms").get<double>()) + " ms, with an outdated one " +
                          four_digits(interest.at("longest_outdated_ms").get<double>()) + " ms; links delay up to " +
                          four_digits(interest.at("latency_ms").get<double>()) + " ms.") +
         '\n';
}

std::string counters_list(const Json& counters) {
  std::string items;
  for (const auto& [name, count] : counters.items()) items += element("li", markup_text(name) + ' ' + json_line(count));
  return "<details><summary>Counters</summary>" + element("ul class=\"counters\"", items) + "</details>\n";
}

std::string run_summary_line(const Json& run, std::size_t number, const std::string& object) {
  const Json& params = run.at("params");
  std::vector<std::string> keys;
  for (const auto& item : params.items()) keys.push_back(item.key());
  std::string line = element("strong", "Run " + std::to_string(number));
  if (!keys.empty()) line += ' ' + markup_text(measure::describe(params, keys));
  for (const Json& row : run.at("objects")) {
    if (row.at("path") != object) continue;
    line += ": " + json_line(row.at("updates_sent")) + " updates";
    if (row.at("samples") > 0) {
      line += ", mean error at " + markup_text(row.at("observer").get<std::string>()) + ' ' +
              four_digits(row.at("ghost_error_m").at("mean").get<double>()) + " m";
    }
    break;
  }
  return line + ", " + fixed(run.at("traffic").at("bytes_per_s").get<double>(), 0) + " bytes/s";
}

// `figures`: the markup of the run's figures; empty where the page has no room for them.
std::string run_details(const Json& run, std::size_t number, const std::string& object, const std::string& figures,
                        bool open) {
  std::string out = std::string(open ? "<details open>" : "<details>") + "<summary>" +
                    run_summary_line(run, number, object) + "</summary>\n<div id=\"" + run_anchor(number) + "\">\n";
  out += figures.empty() ? element("p class=\"faint\"", "Its figures are left out of this page.") + '\n' : figures;
  out += views_table(run, object) + contacts_table(run.at("collisions"));
  if (const std::string line = contacts_line(run); !line.empty()) {
    out += element("p", "Contacts: " + markup_text(line) + '.') + '\n';
  }
  if (run.contains("interest")) out += interest_table(run.at("interest"));
  const Json& traffic = run.at("traffic");
  out += element("p", "All peers together: " + json_line(traffic.at("packets")) + " datagrams, " +
                          json_line(traffic.at("bytes")) +
                          " bytes; worlds equal: " + (run.at("state_roots_equal").get<bool>() ? "yes" : "no") + '.') +
         '\n';
  return out + counters_list(run.at("counters")) + "</div></details>\n";
}

// The data of a run, and the two figures that the script draws of them.
std::string run_figures(const Json& data, std::size_t number, const std::string& object) {
  return data_element("run", data) + '\n' +
         figure_markup({{"kind", "run"}, {"number", number}}, "run-" + std::to_string(number),
                       "Path and ghosts of " + markup_text(object) + ", their errors, and its owner's output.") +
         figure_markup(
             {{"kind", "timeline"}, {"number", number}}, "timeline-" + std::to_string(number),
             "What each peer sends; the threshold that each update was sent by; who said what of contacts, and when.");
}

std::string runs_section(const Json& summary, const Figures& figures) {
  const Json& runs = summary.at("runs");
  const std::string object = principal_object(summary);
  std::string details;
  std::size_t bytes = 0;
  std::size_t without_figures = 0;
  for (std::size_t i = 0; i < std::min(runs.size(), kMostRuns); ++i) {
    std::string drawn = run_figures(figures.runs[i], i + 1, object);
    const bool fits = bytes + drawn.size() <= kMostFigureBytes;
    if (!fits) drawn.clear();
    bytes += drawn.size();
    without_figures += fits ? 0 : 1;
    details += run_details(runs[i], i + 1, object, drawn, runs.size() == 1);
  }
  std::string left_out;
  if (without_figures > 0)
    left_out += "The figures of " + counted(without_figures, "run") +
                " are left out of this page; a sweep of fewer runs has them. ";
  if (runs.size() > kMostRuns) {
    left_out += "Of " + counted(runs.size() - kMostRuns, "run") + " (from " + std::to_string(kMostRuns + 1) +
                " on) there is nothing below; summary.json has their numbers. ";
  }
  std::string out = "<h2>Run by run</h2>\n";
  if (!left_out.empty()) out += element("p", left_out) + '\n';
  return out + details;
}

// Says which of the tables have only some of the rows.
std::string rows_sentence(const measure::ScenarioInfo& info, std::span<const measure::RunRecord> runs) {
  const std::string text = thinned_rows(info, runs);
  return text.empty() ? "" : element("p class=\"faint\"", markup_text(text) + '.') + '\n';
}

std::string files_section() {
  std::string links;
  for (const char* file : {"summary.json", "errors.csv", "traffic.csv", "collisions.csv"}) {
    links += std::string(links.empty() ? "" : ", ") + "<a href=\"" + file + "\">" + file + "</a>";
  }
  return element("p class=\"faint\"", "All numbers: " + links + ".") + '\n';
}

}  // namespace

std::string report_page(const measure::ScenarioInfo& info, std::span<const measure::RunRecord> runs,
                        const Json& summary, const Figures& figures) {
  std::string body = element("h1", markup_text(info.name)) + '\n' + files_section() + rows_sentence(info, runs);
  body += warnings_list(summary) + expectations_section(summary) + what_was_run(info, runs) + runs_table(summary);
  body += overview_section(summary, figures) + all_objects_section(summary) + runs_section(summary, figures);
  return page_around(info.name + ": report of peerd", body);
}

}  // namespace peerd::report
