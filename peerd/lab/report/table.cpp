#include "peerd/lab/report/table.hpp"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
#include <map>
#include <ranges>
#include <utility>
#include <vector>

#include <nlohmann/json.hpp>

#include "peerd/input/console/columns.hpp"
#include "peerd/input/json_text.hpp"
#include "peerd/lab/measure/csv.hpp"
#include "peerd/lab/measure/sweep.hpp"
#include "peerd/lab/report/figure_json.hpp"

namespace peerd::report {
namespace {

// Two that are no farther apart than this are at one place, for whoever looks.
constexpr double kSameAtRest_m = 1e-6;

std::vector<std::string> observers_of(const Json& summary, const std::string& path) {
  std::vector<std::string> names;
  for (const Json& run : summary.at("runs")) {
    for (const Json& row : run.at("objects")) {
      const auto name = row.at("observer").get<std::string>();
      if (row.at("path") == path && std::ranges::find(names, name) == names.end()) names.push_back(name);
    }
  }
  return names;
}

const Json* find_row(const Json& run, const std::string& path, const std::string& observer) {
  for (const Json& row : run.at("objects")) {
    if (row.at("path") == path && (observer.empty() || row.at("observer") == observer)) return &row;
  }
  return nullptr;
}

std::vector<measure::Params> params_of(const Json& summary) {
  std::vector<measure::Params> params;
  for (const Json& run : summary.at("runs")) params.push_back(run.at("params"));
  return params;
}

void add_error_cells(const Json* row, std::span<Column> mean_p99_max, ErrorText error_text) {
  static constexpr std::array names{"mean", "p99", "max"};
  for (std::size_t i = 0; i < names.size(); ++i) {
    const bool seen = row != nullptr && row->at("samples") > 0;  // a row without samples is not a row without error
    mean_p99_max[i].cells.push_back(seen ? error_text(row->at("ghost_error_m").at(names[i]).get<double>()) : "-");
  }
}

void add_error_columns(std::vector<Column>& columns, const std::string& group) {
  for (const char* name : {"mean", "p99", "max"}) columns.push_back({group, name, true, {}});
}

std::vector<Column> lay_out(const Json& summary, const std::string& path, ErrorText error_text) {
  const std::vector<measure::Params> params = params_of(summary);
  const std::vector<std::string> keys = measure::varying_keys(params);
  const std::vector<std::string> observers = observers_of(summary, path);
  const bool row_per_observer = observers.size() > 2;

  std::vector<Column> columns{{"", "run", true, {}}};
  for (const std::string& key : keys) {
    const bool numeric =
        std::ranges::all_of(params, [&](const measure::Params& p) { return !p.contains(key) || p[key].is_number(); });
    columns.push_back({"", measure::short_name(key, keys), numeric, {}});
  }
  columns.push_back({"", "updates", true, {}});
  const std::size_t before_errors = columns.size();
  if (row_per_observer) {
    columns.push_back({"", "observer", false, {}});
    add_error_columns(columns, "");
  } else {
    for (const std::string& observer : observers) add_error_columns(columns, "at " + observer);
  }
  columns.push_back({"", "bytes/s", true, {}});

  const auto add_row = [&](std::size_t i, const std::string& one_observer) {
    const Json& run = summary.at("runs")[i];
    std::size_t c = 0;
    columns[c++].cells.push_back(std::to_string(i + 1));
    for (const std::string& key : keys) columns[c++].cells.push_back(measure::value_text(params[i], key));
    const Json* any = find_row(run, path, "");
    columns[c++].cells.push_back(any ? json_line(any->at("updates_sent")) : "-");
    const std::span rest = std::span(columns).subspan(before_errors);
    if (row_per_observer) {
      rest[0].cells.push_back(one_observer);
      add_error_cells(find_row(run, path, one_observer), rest.subspan(1), error_text);
    } else {
      for (std::size_t o = 0; o < observers.size(); ++o)
        add_error_cells(find_row(run, path, observers[o]), rest.subspan(3 * o), error_text);
    }
    columns.back().cells.push_back(fixed(run.at("traffic").at("bytes_per_s").get<double>(), 0));
  };
  for (std::size_t i = 0; i < params.size(); ++i) {
    if (row_per_observer) {
      for (const std::string& observer : observers) add_row(i, observer);
    } else {
      add_row(i, "");
    }
  }
  return columns;
}

// The mean and the half width of a point's number, such as "0.123 ± 0.004"; "-" where none of its runs has it.
std::string interval_cell(const Json* holder, const char* measure, int decimals) {
  if (holder == nullptr || !holder->contains(measure)) return "-";
  const Json& number = holder->at(measure);
  return fixed(number.at("mean").get<double>(), decimals) + " ± " +
         fixed(number.at("half_width_95").get<double>(), decimals);
}

// One row for each point and observer, with means over the seeds.
std::vector<Column> lay_out_points(const Json& summary, const std::string& path) {
  std::vector<measure::Params> params;
  for (const Json& point : summary.at("points")) params.push_back(point.at("params"));
  const std::vector<std::string> keys = measure::varying_keys(params);
  std::vector<Column> columns{{"", "runs", true, {}}};
  for (const std::string& key : keys) columns.push_back({"", measure::short_name(key, keys), true, {}});
  for (const char* name : {"updates", "observer", "mean", "p99", "max", "bytes/s"}) {
    columns.push_back({"", name, std::string_view(name) != "observer", {}});
  }
  for (std::size_t i = 0; i < params.size(); ++i) {
    const Json& point = summary.at("points")[i];
    const Json& runs = point.at("runs");
    for (const std::string& observer : observers_of(summary, path)) {
      const Json* view = find_row(point, path, observer);
      const Json* error = view != nullptr && view->contains("ghost_error_m") ? &view->at("ghost_error_m") : nullptr;
      std::size_t c = 0;
      columns[c++].cells.push_back(json_line(runs.front()) + "-" + json_line(runs.back()));
      for (const std::string& key : keys) columns[c++].cells.push_back(measure::value_text(params[i], key));
      columns[c++].cells.push_back(interval_cell(view, "updates_sent", 1));
      columns[c++].cells.push_back(observer);
      for (const char* name : {"mean", "p99", "max"}) columns[c++].cells.push_back(interval_cell(error, name, 3));
      columns[c++].cells.push_back(interval_cell(&point.at("traffic"), "bytes_per_s", 0));
    }
  }
  return columns;
}

// The end of a text, which tells objects apart, where it has more than `most` characters.
std::string ending(const std::string& text, std::size_t most) {
  const auto begins = [](char c) { return (c & 0xc0) != 0x80; };  // a UTF-8 character
  std::size_t surplus = static_cast<std::size_t>(std::ranges::count_if(text, begins));
  if (surplus <= most) return text;
  surplus -= most - 1;
  std::size_t at = 0;
  while (surplus > 0 || !begins(text[at])) surplus -= begins(text[at++]) ? 1 : 0;
  return "…" + text.substr(at);
}

// Adds parts with commas between them, in lines that are no longer than a terminal is wide.
void append_list(std::string& out, std::string line, const std::vector<std::string>& parts) {
  constexpr std::size_t kWidth = 80;
  for (std::size_t i = 0; i < parts.size(); ++i) {
    const std::string part = parts[i] + (i + 1 < parts.size() ? "," : "");
    if (line.size() + 1 + part.size() > kWidth) {
      append_line(out, line);
      line = " ";
    }
    line += ' ' + part;
  }
  append_line(out, line);
}

// "a to b: " for a key of the link from a to b, such as network.link.a.b.loss; empty for one of the whole network.
std::string ends_of_link(const std::string& key) {
  constexpr std::string_view kLink = "network.link.";
  if (!key.starts_with(kLink)) return "";
  std::string ends = key.substr(kLink.size(), key.rfind('.') - kLink.size());
  if (std::ranges::count(ends, '.') == 1) ends.replace(ends.find('.'), 1, " to ");  // a name may have dots itself
  return ends + ": ";
}

// The settings of the network that all runs have and no column shows.
void append_network(std::string& out, const Json& summary) {
  std::vector<measure::Params> params;
  bool shaped = summary.at("mode") == "sim";
  for (const Json& run : summary.at("runs")) {
    const bool has_settings = run.contains("network_settings");
    params.push_back(
        measure::with_network(run.at("params"), has_settings ? run.at("network_settings") : Json::object()));
    shaped |= has_settings;
  }
  if (!shaped || params.empty()) return;
  const std::vector<std::string> varying = measure::varying_keys(params);
  std::vector<std::string> keys, parts;
  for (const auto& item : params.front().items()) {
    const std::string& key = item.key();
    const bool in_column = std::ranges::find(varying, key) != varying.end();
    if (key.starts_with("network.") && !in_column) keys.push_back(key);
  }
  for (const std::string& key : keys) {
    parts.push_back(ends_of_link(key) + measure::describe(params.front(), key, std::span(&key, 1)));
  }
  if (!parts.empty()) append_list(out, "network:", parts);
}

// All that runs and observers say of one object.
struct ObjectTotals {
  std::string owner;
  std::uint64_t updates = 0, runs = 0;  // all rows of an object in a run have the same updates
  const Json* last_run = nullptr;
  std::uint64_t views = 0;  // those with samples
  double sum_of_means_m = 0.0, p99_m = 0.0, max_m = 0.0;
};

std::map<std::string, ObjectTotals> totals_by_path(const Json& summary) {
  std::map<std::string, ObjectTotals> totals;
  for (const Json& run : summary.at("runs")) {
    for (const Json& row : run.at("objects")) {
      ObjectTotals& object = totals[row.at("path").get<std::string>()];
      object.owner = row.at("owner").get<std::string>();
      if (object.last_run != &run) {
        object.last_run = &run;
        ++object.runs;
        object.updates += row.at("updates_sent").get<std::uint64_t>();
      }
      if (row.at("samples") == 0) continue;
      const Json& error = row.at("ghost_error_m");
      ++object.views;
      object.sum_of_means_m += error.at("mean").get<double>();
      object.p99_m = std::max(object.p99_m, error.at("p99").get<double>());
      object.max_m = std::max(object.max_m, error.at("max").get<double>());
    }
  }
  return totals;
}

// The ghost of an object at rest that was farthest from the truth, over all runs; empty where nothing was at rest.
std::string rest_line(const Json& summary) {
  const Json* worst = nullptr;
  const auto error_m = [](const Json& row) { return row.at("rest").at("ghost_error_max_m").get<double>(); };
  for (const Json& run : summary.at("runs")) {
    for (const Json& row : run.at("objects")) {
      if (row.at("rest").at("samples") == 0) continue;
      if (worst == nullptr || error_m(row) > error_m(*worst)) worst = &row;
    }
  }
  if (worst == nullptr) return "";
  if (error_m(*worst) <= kSameAtRest_m) return "at rest: every ghost is where its object is";
  const auto name_of = [&](const char* what, std::size_t most) {
    return ending(worst->at(what).get<std::string>(), most);
  };
  return "at rest, the worst: " + name_of("path", 28) + " at " + name_of("observer", 8) + ", " +
         fixed(error_m(*worst), 6) + " m";
}

// The deepest pair of all runs: `of` is "overlap" or "ghost_overlap". Null where none is in another as far as can be
// told from rounding.
const Json* deepest_pair(std::span<const Json* const> runs, const char* of) {
  constexpr double kTouch_m = 1e-6;
  const Json* deepest = nullptr;
  double depth_m = kTouch_m;
  for (const Json* run : runs) {
    const Json& contacts = run->at("contacts");
    if (!contacts.contains(of)) continue;
    for (const char* which : {"deepest", "deepest_mesh_at_least"}) {
      const Json& pair = contacts.at(of).at(which);
      if (pair.at("depth_m").get<double>() <= depth_m) continue;
      depth_m = pair.at("depth_m").get<double>();
      deepest = &pair;
    }
  }
  return deepest;
}

std::string pair_text(const Json& pair) {
  const auto name = [&](std::size_t i) { return ending(pair.at("between")[i].get<std::string>(), 20); };
  std::string text = length_text(pair.at("depth_m").get<double>()) + " (" + name(0) + " and " + name(1) + " at " +
                     fixed(pair.at("at_s").get<double>(), 2) + " s";
  if (pair.contains("observer")) text += ", at " + ending(pair.at("observer").get<std::string>(), 8);
  return text + ')';
}

// The sentence on the contacts of runs; empty where there are none, and nothing is in anything else.
std::vector<std::string> contacts_parts(std::span<const Json* const> runs) {
  std::uint64_t least = std::numeric_limits<std::uint64_t>::max(), most = 0, per_s = 0, last = 0, objects = 0;
  for (const Json* run : runs) {
    const Json& contacts = run->at("contacts");
    const auto number = [&](const char* name) { return contacts.at(name).get<std::uint64_t>(); };
    least = std::min(least, number("count"));
    most = std::max(most, number("count"));
    per_s = std::max(per_s, contacts.at("per_s").at("max").get<std::uint64_t>());
    last = std::max(last, number("last_s"));
    objects = std::max(objects, number("island_objects_max"));
  }
  const Json *const truth = deepest_pair(runs, "overlap"), *const ghosts = deepest_pair(runs, "ghost_overlap");
  std::vector<std::string> parts;
  if (most == 0 && truth == nullptr && ghosts == nullptr) return parts;
  const std::string from = least < most ? std::to_string(least) + " to " : "";
  parts.push_back(from + std::to_string(most) + (runs.size() > 1 ? " a run" : ""));
  if (most > 0) parts.push_back("at most " + std::to_string(per_s) + " in a second");
  if (most > 0) parts.push_back((last == 0 ? "none" : std::to_string(last)) + " in the last");
  if (objects > 0) parts.push_back("islands of " + (objects > 1 ? "up to " + std::to_string(objects) : "one object"));
  parts.push_back("deepest overlap " + (truth != nullptr ? pair_text(*truth) : "none"));
  if (ghosts != nullptr) parts.push_back("of ghosts " + pair_text(*ghosts));
  if (runs.size() == 1 && runs.front()->contains("energy_j")) {
    const Json& kinetic = runs.front()->at("energy_j").at("kinetic");
    if (kinetic.at("greatest").get<double>() == 0.0) return parts;
    const auto joules = [&](const char* name) { return fixed(kinetic.at(name).get<double>(), 3) + " J"; };
    parts.push_back("kinetic energy " + joules("start") + " at first");
    parts.push_back(joules("greatest") + " at most");
    parts.push_back(joules("end") + " at last");
  }
  return parts;
}

std::string heading(const Json& summary, const std::string& path) {
  const std::size_t count = summary.at("runs").size();
  std::string text = summary.at("scenario").get<std::string>() + " (" + summary.at("mode").get<std::string>() +
                     ", seed " + json_line(summary.at("seed")) + "): " + std::to_string(count) +
                     (count == 1 ? " run" : " runs");
  if (path.empty()) return text + ", no object that another peer observes";
  return text + "; " + path + ": updates sent, ghost error [m]";
}

}  // namespace

std::vector<std::string> worst_objects(const Json& summary, std::size_t most) {
  struct Score {
    double error_m = 0.0;
    std::uint64_t updates = 0;
    std::string path;
  };
  std::vector<Score> scores;
  std::map<std::string, std::size_t> index_of;
  for (const Json& run : summary.at("runs")) {
    for (const Json& row : run.at("objects")) {
      const auto& path = row.at("path").get_ref<const std::string&>();
      const auto [at, is_new] = index_of.try_emplace(path, scores.size());
      if (is_new) scores.emplace_back().path = path;
      Score& score = scores[at->second];
      score.error_m += row.at("ghost_error_m").at("mean").get<double>();
      score.updates += row.at("updates_sent").get<std::uint64_t>();
    }
  }
  std::ranges::stable_sort(scores, std::ranges::greater{},
                           [](const Score& s) { return std::pair(s.error_m, s.updates); });
  std::vector<std::string> paths;
  for (const Score& score : scores | std::views::take(most)) paths.push_back(score.path);
  return paths;
}

std::string principal_object(const Json& summary) {
  const std::vector<std::string> worst = worst_objects(summary, 1);
  return worst.empty() ? "" : worst.front();
}

std::vector<Column> run_columns(const Json& summary, ErrorText error_text) {
  return lay_out(summary, principal_object(summary), error_text);
}

std::vector<Column> object_columns(const Json& summary, std::size_t most, ErrorText error_text) {
  const std::map<std::string, ObjectTotals> totals = totals_by_path(summary);
  const bool whole = summary.at("runs").size() == 1;
  std::vector<Column> columns{{"", "", false, {}},       {"", "object", false, {}}, {"", "owner", false, {}},
                              {"", "updates", true, {}}, {"", "mean", true, {}},    {"", "p99", true, {}},
                              {"", "max", true, {}}};
  for (const std::string& path : worst_objects(summary, most)) {
    const ObjectTotals& object = totals.at(path);
    const bool seen = object.views > 0;
    const double updates = static_cast<double>(object.updates) / static_cast<double>(object.runs);
    const double mean_m = object.sum_of_means_m / static_cast<double>(std::max<std::uint64_t>(1, object.views));
    std::size_t c = 0;
    columns[c].cells.emplace_back(columns[c].cells.empty() ? kPrincipalMark : "");
    for (const std::string& text : {path, object.owner, fixed(updates, whole ? 0 : 1)})
      columns[++c].cells.push_back(text);
    for (const double error_m : {mean_m, object.p99_m, object.max_m}) {
      columns[++c].cells.push_back(seen ? error_text(error_m) : "-");
    }
  }
  return columns;
}

std::string objects_table(const Json& summary) {
  constexpr std::size_t kRows = 12, kPathWidth = 28, kOwnerWidth = 8;
  const std::size_t count = worst_objects(summary, std::numeric_limits<std::size_t>::max()).size();
  if (count < 2) return "";
  std::vector<Column> columns = object_columns(summary, kRows, [](double error_m) { return fixed(error_m, 3); });
  for (std::string& path : columns[1].cells) path = ending(path, kPathWidth);
  for (std::string& owner : columns[2].cells) owner = ending(owner, kOwnerWidth);
  const std::size_t runs = summary.at("runs").size();
  std::string out;
  append_line(out, "");
  append_line(out, "all objects, the worst first: " + std::string(runs > 1 ? "updates a run" : "updates") +
                       ", ghost error [m]" + (runs > 1 ? " over all runs" : ""));
  append_rows(out, columns);
  if (count > kRows)
    append_line(out, "and " + std::to_string(count - kRows) + " more, in report.html and summary.json");
  if (const std::string rest = rest_line(summary); !rest.empty()) append_line(out, rest);
  return out;
}

std::string contacts_line(const Json& run) {
  const Json* const one = &run;
  std::string line;
  for (const std::string& part : contacts_parts({&one, 1})) line += (line.empty() ? "" : ", ") + part;
  return line;
}

std::string contacts_lines(const Json& summary) {
  std::vector<const Json*> runs;
  for (const Json& run : summary.at("runs")) runs.push_back(&run);
  const std::vector<std::string> parts = contacts_parts(runs);
  std::string out;
  if (!parts.empty()) append_list(out, "contacts:", parts);
  return out;
}

std::string table(const Json& summary) {
  const std::string path = principal_object(summary);
  std::string out;
  append_line(out, heading(summary, path));
  append_network(out, summary);
  const bool repeated = summary.contains("points");
  if (repeated)
    append_line(
        out, "mean ± half width of its 95 % confidence interval, over " + json_line(summary.at("repeat")) + " seeds");
  const auto in_millimetres = [](double error_m) { return fixed(error_m, 3); };
  append_rows(out, repeated ? lay_out_points(summary, path) : lay_out(summary, path, in_millimetres));
  if (summary.contains("warnings")) {
    for (const Json& warning : summary.at("warnings")) append_line(out, "warning: " + warning.get<std::string>());
  }
  return out;
}

std::string wrong_outcomes_table(const Json& summary) {
  const std::vector<measure::Params> params = params_of(summary);
  std::vector<std::string> keys = measure::varying_keys(params);
  std::erase(keys, "decisions.policy");
  std::vector<Column> columns{{"", "wrong outcomes", false, {}}};
  std::vector<std::vector<std::uint64_t>> wrong;  // indices: row, column
  std::uint64_t truth = 0;
  const auto index_in = [](std::vector<std::string>& names, const std::string& name) {
    const auto at = std::ranges::find(names, name);
    if (at == names.end()) names.push_back(name);
    return static_cast<std::size_t>(std::ranges::find(names, name) - names.begin());
  };
  std::vector<std::string> policies, situations;
  for (std::size_t i = 0; i < params.size(); ++i) {
    const Json& collisions = summary.at("runs")[i].at("collisions");
    if (!collisions.contains("wrong")) continue;
    const Json& w = collisions.at("wrong");
    const std::size_t row = index_in(policies, measure::value_text(params[i], "decisions.policy"));
    const std::size_t column = index_in(situations, measure::describe(params[i], keys));
    if (wrong.size() <= row) wrong.resize(row + 1);
    if (wrong[row].size() <= column) wrong[row].resize(column + 1);
    wrong[row][column] += w.at("missing").get<std::uint64_t>() + w.at("spurious").get<std::uint64_t>();
    truth = std::max(truth, w.at("truth").get<std::uint64_t>());
  }
  if (wrong.empty()) return "";
  for (const std::string& situation : situations) columns.push_back({"", situation, true, {}});
  for (std::size_t row = 0; row < wrong.size(); ++row) {
    columns[0].cells.push_back(policies[row].empty() ? "-" : policies[row]);
    wrong[row].resize(situations.size());
    for (std::size_t c = 0; c < situations.size(); ++c) columns[c + 1].cells.push_back(std::to_string(wrong[row][c]));
  }
  std::string out;
  append_line(out, "");
  append_line(out, "of up to " + std::to_string(truth) + " outcomes a run without latency:");
  append_rows(out, columns);
  return out;
}

std::string thinned_rows(const measure::ScenarioInfo& info, std::span<const measure::RunRecord> runs) {
  std::string text;
  const auto add = [&](const char* file, const measure::RowCount& rows, const char* what) {
    if (rows.written == rows.of) return;
    text += (text.empty() ? "" : ", ") + std::string(file) + " has " + std::to_string(rows.written) + " of " +
            std::to_string(rows.of) + ' ' + what;
  };
  add("errors.csv", measure::errors_rows(runs, info.csv_rows), "samples");
  add("traffic.csv", measure::traffic_rows(runs, info.csv_rows), "updates and datagrams");
  return text.empty() ? "" : text + " (--samples all: all of them); summary.json counts all";
}

}  // namespace peerd::report
