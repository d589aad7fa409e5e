#include "peerd/lab/measure/expectations.hpp"

#include <algorithm>
#include <array>
#include <cassert>
#include <charconv>
#include <cmath>
#include <functional>
#include <limits>
#include <ranges>

#include "peerd/input/console/columns.hpp"
#include "peerd/input/json_text.hpp"
#include "peerd/lab/measure/meter.hpp"
#include "peerd/lab/measure/summary.hpp"
#include "peerd/lab/measure/sweep.hpp"
#include "peerd/peer/config/measures.hpp"
#include "peerd/peer/config/node_pattern.hpp"

namespace peerd::measure {
namespace {

using Json = nlohmann::ordered_json;
using config::Expectation;

// Further failures are counted, not listed: a crowd has thousands of views.
constexpr std::size_t kListed = 20;

// The numbers of the part of a run between two times, as if the run had been this part alone.
Json part_row(const RunRecord& run, const TimeSpan& part) {
  const std::optional<Measured> measured = measured_of(run, part);
  assert(measured && "who runs a scenario measures the parts that it has expectations of");
  RunRecord rest;
  rest.params = run.params;
  rest.seed = run.seed;
  rest.peers = run.peers;
  rest.objects = run.objects;
  rest.contacts = run.contacts;
  rest.wrong = run.wrong;
  rest.interest = run.interest;
  rest.network = run.network;
  rest.clocks = run.clocks;
  rest.groups_joined = run.groups_joined;
  rest.worlds_equal = run.worlds_equal;
  rest.counters = run.counters;
  rest.duration_s = part.until_s - part.from_s;
  std::erase_if(rest.contacts, [&](const ContactRow& row) { return row.t_s < part.from_s || row.t_s > part.until_s; });
  return summarise_part(rest, *measured);
}

bool is_meant(const std::string& pattern, const std::string& path) {
  if (pattern.empty() || pattern == path || config::matches(pattern, path)) return true;
  return pattern.find('/') == std::string::npos && config::matches(pattern, path.substr(path.rfind('/') + 1));
}

// The distance of a number from what is expected; 0 where it is as expected.
double off_by(const Expectation& e, const Json& found) {
  if (e.equals && found.is_boolean()) return found == *e.equals ? 0.0 : 1.0;
  const auto x = found.get<double>();
  double off = 0.0;
  if (e.at_least) off = std::max(off, *e.at_least - x);
  if (e.at_most) off = std::max(off, x - *e.at_most);
  if (e.equals) off = std::max(off, std::abs(x - e.equals->get<double>()));
  return off;
}

class Checker {
 public:
  Checker(const Expectation& e, const config::Measure& measure) : measure_(measure) { checked_.expected = e; }

  void check(std::size_t run, const Json& row) {
    run_ = run;
    if (measure_.of_view) return check_views(row);
    compare(row, "", "");
  }

  CheckedExpectation finish() && {
    std::ranges::stable_sort(checked_.failures, std::greater<>{}, [&](const Failure& f) {
      return f.found.is_null() ? std::numeric_limits<double>::infinity() : off_by(checked_.expected, f.found);
    });
    return std::move(checked_);
  }

 private:
  void check_views(const Json& run) {
    const Expectation& e = checked_.expected;
    const bool of_rest = measure_.name == "rest.ghost_error_max_m";
    bool any = false, seen = of_rest;  // a run may end before anything rests
    for (const Json& row : run.at("objects")) {
      const auto path = row.at("path").get<std::string>(), observer = row.at("observer").get<std::string>();
      if (!is_meant(e.object, path) || (!e.observer.empty() && observer != e.observer)) continue;
      any = true;
      if (measure_.error && (of_rest ? row.at("rest") : row).at("samples") == 0) continue;
      seen = true;
      compare(row, path, observer);
    }
    if (!any) return fail(e.object, e.observer, nullptr, "no such view: nobody runs it, or only who observes it");
    if (!seen) fail(e.object, e.observer, nullptr, "no samples");
  }

  // The number of that name, or null.
  [[nodiscard]] const Json* number(const Json& row) const {
    const Json* at = &row;
    std::string_view rest = measure_.name;
    while (!rest.empty()) {
      const bool counter = at == counters(row);  // names of counters may hold dots
      const std::string key(counter ? rest : rest.substr(0, rest.find('.')));
      rest.remove_prefix(std::min(rest.size(), key.size() + 1));
      const auto found = at->find(key);
      if (found == at->end()) return nullptr;
      at = &*found;
    }
    return at;
  }
  [[nodiscard]] static const Json* counters(const Json& row) {
    const auto found = row.find("counters");
    return found == row.end() ? nullptr : &*found;
  }

  void compare(const Json& row, const std::string& object, const std::string& observer) {
    const Json* const found = number(row);
    if (found == nullptr) return fail(object, observer, nullptr, "the run has no such number");
    ++checked_.values;
    if (off_by(checked_.expected, *found) > 0.0) fail(object, observer, *found, "");
  }

  void fail(const std::string& object, const std::string& observer, const Json& found, const std::string& why) {
    checked_.failures.push_back({run_, object, observer, found, why});
  }

  config::Measure measure_;
  CheckedExpectation checked_;
  std::size_t run_ = 0;
};

// Six digits show by how much a number is off; summary.json has all digits.
std::string found_text(const Json& found) {
  if (!found.is_number_float()) return json_line(found);
  std::array<char, 32> digits;
  const auto end =
      std::to_chars(digits.data(), digits.data() + digits.size(), found.get<double>(), std::chars_format::general, 6)
          .ptr;
  return {digits.data(), end};
}

std::string window_text(const Expectation& e) {
  const auto seconds = [](double t) { return json_line(Json(t)) + " s"; };
  if (e.until_s) return " from " + seconds(e.from_s) + " to " + seconds(*e.until_s);
  return e.from_s > 0.0 ? " from " + seconds(e.from_s) : "";
}

}  // namespace

std::vector<TimeSpan> measured_parts(std::span<const Expectation> expectations, std::size_t run, double duration_s) {
  std::vector<TimeSpan> parts;
  for (const Expectation& e : expectations) {
    const bool whole = e.from_s == 0.0 && !e.until_s;
    if (whole || std::ranges::find(e.runs, run) == e.runs.end()) continue;
    const TimeSpan part{e.from_s, e.until_s.value_or(duration_s)};
    const auto same = [&](const TimeSpan& p) { return p.from_s == part.from_s && p.until_s == part.until_s; };
    if (std::ranges::none_of(parts, same)) parts.push_back(part);
  }
  return parts;
}

std::vector<CheckedExpectation> check_expectations(std::span<const Expectation> expectations, const std::string& mode,
                                                   std::span<const RunRecord> runs, const Json& run_rows) {
  std::vector<CheckedExpectation> all;
  for (const Expectation& e : expectations) {
    Checker checker(e, config::find_measure(e.that).value());
    for (const std::size_t run : e.runs) {
      if (!e.mode.empty() && e.mode != mode) break;
      if (e.from_s == 0.0 && !e.until_s) {
        checker.check(run, run_rows[run]);
        continue;
      }
      checker.check(run, part_row(runs[run], {e.from_s, e.until_s.value_or(runs[run].duration_s)}));
    }
    all.push_back(std::move(checker).finish());
  }
  return all;
}

std::string describe(const Expectation& e) {
  std::string text = e.that;
  const auto limit = [&](const char* sign, double x) { text += sign + json_line(Json(x)); };
  if (e.equals) text += " = " + e.equals->dump();
  if (e.at_least) limit(" >= ", *e.at_least);
  if (e.at_most) limit(" <= ", *e.at_most);
  if (!e.object.empty()) text += " of " + e.object;
  if (!e.observer.empty()) text += " at " + e.observer;
  return text + window_text(e);
}

Json expectations_json(std::span<const CheckedExpectation> checked) {
  Json all = Json::array();
  for (const CheckedExpectation& c : checked) {
    const Expectation& e = c.expected;
    Json row = {{"name", e.name}, {"that", e.that}};
    if (e.at_least) row["at_least"] = *e.at_least;
    if (e.at_most) row["at_most"] = *e.at_most;
    if (e.equals) row["equals"] = *e.equals;
    if (!e.object.empty()) row["object"] = e.object;
    if (!e.observer.empty()) row["observer"] = e.observer;
    if (!e.where.empty()) row["where"] = e.where;
    if (!e.mode.empty()) row["mode"] = e.mode;
    if (e.from_s > 0.0) row["from_s"] = e.from_s;
    if (e.until_s) row["until_s"] = *e.until_s;
    row["held"] = c.checked() ? Json(!c.failed()) : Json(nullptr);
    row["values"] = c.values;
    row["failed"] = c.failures.size();
    row["failures"] = Json::array();
    for (const Failure& f : c.failures | std::views::take(kListed)) {
      Json& failure = row["failures"].emplace_back(Json{{"run", f.run + 1}});
      if (!f.object.empty()) failure["object"] = f.object;
      if (!f.observer.empty()) failure["observer"] = f.observer;
      failure["found"] = f.found;
      if (!f.why.empty()) failure["why"] = f.why;
    }
    all.push_back(std::move(row));
  }
  return all;
}

std::string expectations_table(std::span<const CheckedExpectation> checked, const Json& run_rows) {
  if (checked.empty()) return "";
  std::vector<Params> params;
  for (const Json& run : run_rows) params.push_back(run.at("params"));
  const std::vector<std::string> keys = varying_keys(params);

  std::vector<Column> columns{{"", "failed", false, {}}, {"", "expected", false, {}}, {"", "found", true, {}},
                              {"", "object", false, {}}, {"", "observer", false, {}}, {"", "run", true, {}},
                              {"", "seed", true, {}},    {"", "of", false, {}}};
  std::string more;
  std::size_t held = 0, failed = 0;
  std::uint64_t values = 0;
  for (const CheckedExpectation& c : checked) {
    values += c.values;
    if (!c.checked())
      append_line(more, "expect." + c.expected.name + " was not checked: it is about none of these runs" +
                            (c.expected.that.starts_with("rest.") ? ", or nothing came to rest in them" : ""));
    if (!c.checked() || !c.failed()) {
      held += c.checked() ? 1 : 0;
      continue;
    }
    ++failed;
    for (const Failure& f : c.failures | std::views::take(kListed)) {
      const std::string cells[] = {c.expected.name,
                                   describe(c.expected),
                                   f.found.is_null() ? f.why : found_text(f.found),
                                   f.object,
                                   f.observer,
                                   std::to_string(f.run + 1),
                                   json_line(run_rows[f.run].at("seed")),
                                   describe(params[f.run], keys)};
      for (std::size_t i = 0; i < columns.size(); ++i) columns[i].cells.push_back(cells[i]);
    }
    if (c.failures.size() > kListed) {
      append_line(more, "expect." + c.expected.name + " failed " + std::to_string(c.failures.size() - kListed) +
                            " times more, by less");
    }
  }
  std::string out;
  append_line(out, "");
  append_line(out, "expectations: " + std::to_string(held) + " held, " + std::to_string(failed) + " failed (" +
                       std::to_string(values) + " values)");
  if (failed > 0) append_rows(out, columns);
  return out + more;
}

}  // namespace peerd::measure
