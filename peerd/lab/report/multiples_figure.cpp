#include <algorithm>
#include <cstddef>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "peerd/lab/measure/sweep.hpp"
#include "peerd/lab/report/figure_parts.hpp"
#include "peerd/lab/report/figures.hpp"

namespace peerd::report {
namespace {

constexpr std::size_t kMostColumns = 7;
constexpr std::size_t kMostRows = 8;
constexpr std::size_t kMostColours = 4;

struct Key {
  std::string name;
  std::vector<std::string> values;  // in order of appearance; numbers by size
  bool numeric = true;
};

Key key_of(const std::string& name, std::span<const measure::RunRecord> runs) {
  Key key{.name = name, .values = {}};
  std::vector<std::pair<double, std::string>> found;
  for (const measure::RunRecord& run : runs) {
    const std::string text = measure::value_text(run.params, name);
    const auto it = run.params.find(name);
    key.numeric = key.numeric && it != run.params.end() && it->is_number();
    if (std::ranges::find(found, text, &std::pair<double, std::string>::second) == found.end())
      found.emplace_back(key.numeric ? it->get<double>() : 0.0, text);
  }
  if (key.numeric) std::ranges::sort(found);
  for (auto& [number, text] : found) key.values.push_back(std::move(text));
  return key;
}

// The keys of columns, rows and colours. A key that the sweep does not have is an empty name with one value.
struct Layout {
  Key columns, rows, colours;
};

std::optional<Layout> layout_of(std::span<const measure::RunRecord> runs) {
  std::vector<measure::Params> params;
  for (const measure::RunRecord& run : runs) params.push_back(run.params);
  std::vector<Key> keys;
  for (const std::string& name : measure::varying_keys(params)) keys.push_back(key_of(name, runs));
  if (keys.empty() || keys.size() > 3) return std::nullopt;
  const auto take = [&](auto rank) {
    if (keys.empty()) return Key{.name = "", .values = {""}};
    const auto best = std::ranges::max_element(keys, {}, rank);
    Key key = std::move(*best);
    keys.erase(best);
    return key;
  };
  Layout layout;
  layout.columns = take([](const Key& k) { return std::pair(k.numeric, k.values.size()); });
  layout.rows = take([](const Key& k) { return k.values.size(); });
  layout.colours = take([](const Key& k) { return k.values.size(); });
  if (layout.columns.values.size() > kMostColumns || layout.rows.values.size() > kMostRows ||
      layout.colours.values.size() > kMostColours)
    return std::nullopt;
  return layout;
}

std::optional<std::size_t> find_run(std::span<const measure::RunRecord> runs, const Layout& layout, std::size_t row,
                                    std::size_t column, std::size_t colour) {
  const auto is = [](const measure::RunRecord& run, const Key& key, std::size_t i) {
    return key.name.empty() || measure::value_text(run.params, key.name) == key.values[i];
  };
  for (std::size_t i = 0; i < runs.size(); ++i) {
    if (is(runs[i], layout.rows, row) && is(runs[i], layout.columns, column) && is(runs[i], layout.colours, colour))
      return i;
  }
  return std::nullopt;
}

std::vector<std::string> key_names(const Layout& layout) {
  std::vector<std::string> names;
  for (const Key* key : {&layout.rows, &layout.columns, &layout.colours}) {
    if (!key->name.empty()) names.push_back(key->name);
  }
  return names;
}

// The one observer that is drawn: the first observer of the first run that has any.
std::optional<measure::PeerInfo> observer_of(std::span<const measure::RunRecord> runs, const std::string& path) {
  for (const measure::RunRecord& run : runs) {
    const measure::ObjectInfo* object = find_object(run, path);
    if (object == nullptr) continue;
    const std::vector<measure::PeerInfo> observers = observers_of(run, *object);
    if (!observers.empty()) return observers.front();
  }
  return std::nullopt;
}

// The cell of a row and a column; null where the sweep has no such run.
Json cell_of(std::span<const measure::RunRecord> runs, const Layout& layout, std::size_t row, std::size_t column) {
  const std::vector<std::string> names = key_names(layout);
  std::vector<std::string> in_common = names;
  std::erase(in_common, layout.colours.name);
  Json cell;
  for (std::size_t colour = 0; colour < layout.colours.values.size(); ++colour) {
    const std::optional<std::size_t> run = find_run(runs, layout, row, column, colour);
    if (!run) continue;
    const measure::Params& params = runs[*run].params;
    const std::size_t number = row * layout.columns.values.size() + column + 1;
    cell["heading"] = std::to_string(number) + "  " + measure::describe(params, in_common);
    cell["runs"].push_back(
        {{"number", *run + 1},
         {"words", layout.colours.name.empty() ? "" : measure::describe(params, layout.colours.name, names)}});
  }
  return cell;
}

}  // namespace

Json multiples_figure(const measure::ScenarioInfo& info, std::span<const measure::RunRecord> runs,
                      const FigureChoice& choice) {
  const std::optional<Layout> layout = layout_of(runs);
  const std::optional<measure::PeerInfo> observer = observer_of(runs, choice.object);
  if (!layout || !observer) return nullptr;
  const std::size_t columns = layout->columns.values.size(), rows = layout->rows.values.size();
  const std::size_t drawn = columns * rows * layout->colours.values.size();
  std::string subtitle =
      info.mode + ", seed " + std::to_string(info.seed) + "; one scale for each latency, one for output";
  if (runs.size() > drawn)
    subtitle += "; " + std::to_string(runs.size() - drawn) + " runs repeat others and are left out";
  Json figure{{"kind", "multiples"},
              {"title", info.name + ": " + choice.object + " and its ghost at " + observer->name + ", run by run"},
              {"subtitle", subtitle},
              {"observer", observer->name},
              {"columns", columns},
              {"width", 260},
              {"cells", Json::array()}};
  for (std::size_t row = 0; row < rows; ++row) {
    for (std::size_t column = 0; column < columns; ++column)
      figure["cells"].push_back(cell_of(runs, *layout, row, column));
  }
  return figure;
}

}  // namespace peerd::report
