#include "peerd/lab/baselines/comparison.hpp"

#include <algorithm>
#include <functional>
#include <set>

#include <spdlog/fmt/fmt.h>
#include <nlohmann/json.hpp>

#include "peerd/input/console/columns.hpp"
#include "peerd/lab/measure/agreement.hpp"
#include "peerd/lab/measure/lookup.hpp"
#include "peerd/lab/measure/meter.hpp"
#include "peerd/lab/report/markup.hpp"
#include "peerd/lab/report/page_frame.hpp"

namespace peerd::baselines {
namespace {

std::optional<double> median_ms(std::vector<double> seconds) {
  if (seconds.empty()) return std::nullopt;
  const auto middle = seconds.begin() + static_cast<std::ptrdiff_t>(seconds.size() / 2);
  std::ranges::nth_element(seconds, middle);
  return *middle * 1e3;
}

// Calls `function` with the samples of each view.
void for_each_view(const measure::RunRecord& record,
                   const std::function<void(std::span<const measure::GhostSample>)>& function) {
  const std::span<const measure::GhostSample> all = record.ghost_samples;
  for (std::size_t begin = 0; begin < all.size();) {
    std::size_t end = begin;
    while (end < all.size() && all[end].observer == all[begin].observer && all[end].object == all[begin].object) ++end;
    function(all.subspan(begin, end - begin));
    begin = end;
  }
}

void add_delays(const measure::RunRecord& record, std::span<const KeyMove> keys, Compared& to) {
  std::vector<double> own, others, key_to_own, key_to_others;
  const auto add = [](std::vector<double>& list, std::optional<double> value) {
    if (value) list.push_back(*value);
  };
  for_each_view(record, [&](std::span<const measure::GhostSample> view) {
    add(own, delay_s(view, Picture::kOwners));
    add(others, delay_s(view, Picture::kObservers));
    for (const KeyMove& key : keys) {
      if (key.object != view.front().object) continue;
      add(key_to_own, response_s(view, Picture::kOwners, key.at_s));
      add(key_to_others, response_s(view, Picture::kObservers, key.at_s));
    }
  });
  to.own_delay_ms = median_ms(std::move(own));
  to.others_delay_ms = median_ms(std::move(others));
  to.key_to_own_ms = median_ms(std::move(key_to_own));
  to.key_to_others_ms = median_ms(std::move(key_to_others));
}

std::string cell(const std::optional<double>& ms) { return ms ? fixed(*ms, 0) : "-"; }

}  // namespace

Compared compared(const std::string& system, const measure::RunRecord& record, double cpu_s,
                  std::span<const KeyMove> keys) {
  Compared of{.system = system, .simulated_s = record.duration_s, .cpu_s = cpu_s};
  const measure::Measured measured = measure::measured_of(record);
  of.bytes_per_s = static_cast<double>(measured.datagram_bytes) / record.duration_s;
  of.datagrams_per_s = static_cast<double>(measured.datagrams) / record.duration_s;
  std::set<std::pair<PeerId, ObjectId>> moving;
  for_each_view(record, [&](std::span<const measure::GhostSample> view) {
    if (moves(view)) moving.emplace(view.front().observer, view.front().object);
  });
  for (const measure::ViewMeasured& view : measured.views) {
    if (!moving.contains({view.observer, view.object})) continue;
    const auto views = static_cast<double>(moving.size());
    of.shown_error_m += view.shown_error_m.mean / views;
    of.view_difference_m += view.view_difference_m.mean / views;
    of.worst_p99_m = std::max(of.worst_p99_m, view.shown_error_m.p99);
  }
  add_delays(record, keys, of);
  if (record.wrong) {
    of.outcomes = record.wrong->truth;
    of.missing = record.wrong->missing;
    of.spurious = record.wrong->spurious;
  }
  of.disagreed = measure::agreement(record).disagreed;
  return of;
}

std::string table(std::span<const Compared> systems) {
  std::vector<Column> columns{{"", "system", false, {}},         {"", "CPU s", true, {}},
                              {"", "bytes/s", true, {}},         {"error [m]", "mean", true, {}},
                              {"error [m]", "p99", true, {}},    {"error [m]", "views", true, {}},
                              {"late [ms]", "own", true, {}},    {"late [ms]", "others", true, {}},
                              {"key to [ms]", "own", true, {}},  {"key to [ms]", "others", true, {}},
                              {"collisions", "true", true, {}},  {"collisions", "missed", true, {}},
                              {"collisions", "false", true, {}}, {"collisions", "disagree", true, {}}};
  for (const Compared& s : systems) {
    const std::vector<std::string> cells{s.system,
                                         fixed(s.cpu_s, 2),
                                         fixed(s.bytes_per_s, 0),
                                         fixed(s.shown_error_m, 3),
                                         fixed(s.worst_p99_m, 3),
                                         fixed(s.view_difference_m, 3),
                                         cell(s.own_delay_ms),
                                         cell(s.others_delay_ms),
                                         cell(s.key_to_own_ms),
                                         cell(s.key_to_others_ms),
                                         std::to_string(s.outcomes),
                                         std::to_string(s.missing),
                                         std::to_string(s.spurious),
                                         std::to_string(s.disagreed)};
    for (std::size_t i = 0; i < columns.size(); ++i) columns[i].cells.push_back(cells[i]);
  }
  std::string text;
  append_rows(text, columns);
  return text;
}

std::string page(const std::string& title, std::span<const Compared> systems) {
  const report::Json figure{{"kind", "compare"}, {"title", title}, {"systems", to_json(systems)}};
  return report::page_around(
      title, report::element("h1", report::markup_text(title)) + '\n' +
                 report::figure_markup(figure, "compare", "What each system sends, and what it shows.") +
                 report::element("div class=\"scroll\" tabindex=\"0\"",
                                 report::element("pre", report::markup_lines(table(systems)))));
}

nlohmann::ordered_json to_json(std::span<const Compared> systems) {
  const auto or_null = [](const std::optional<double>& ms) -> nlohmann::ordered_json {
    if (ms) return *ms;
    return nullptr;
  };
  nlohmann::ordered_json rows = nlohmann::ordered_json::array();
  for (const Compared& s : systems) {
    rows.push_back(
        {{"system", s.system},
         {"simulated_s", s.simulated_s},
         {"cpu_s", s.cpu_s},
         {"bytes_per_s", s.bytes_per_s},
         {"datagrams_per_s", s.datagrams_per_s},
         {"shown_error_m", s.shown_error_m},
         {"worst_p99_m", s.worst_p99_m},
         {"view_difference_m", s.view_difference_m},
         {"own_delay_ms", or_null(s.own_delay_ms)},
         {"others_delay_ms", or_null(s.others_delay_ms)},
         {"key_to_own_ms", or_null(s.key_to_own_ms)},
         {"key_to_others_ms", or_null(s.key_to_others_ms)},
         {"collisions",
          {{"truth", s.outcomes}, {"missing", s.missing}, {"spurious", s.spurious}, {"disagreed", s.disagreed}}}});
  }
  return rows;
}

}  // namespace peerd::baselines
