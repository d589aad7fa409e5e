#include "collision/baselines/engine.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cstdint>
#include <map>
#include <optional>

#include "collision/baselines/box_volumes.hpp"
#include "collision/baselines/i_collide.hpp"
#include "collision/baselines/kdop_query.hpp"
#include "collision/baselines/sphere_volume.hpp"
#include "collision/baselines/volume_query.hpp"
#include "core/suggestion.hpp"

namespace peerd::collision::baselines {
namespace {

constexpr std::array<EngineDescription, 8> kEngines = {{
    {"ours", true, "docs/decisions/collision-hierarchies.md", "trees of eight children, by vector instructions"},
    {"kdop", true, "Ohlenburg 2003, chapter 3",
     "binary trees of k-DOPs; options k (6, 14, 18, 26), rule (of splitting), threshold (triangles of a leaf), realign "
     "(slabs, boundary, hull)"},
    {"quickcd", true, "Klosowski, Held, Mitchell, Sowizral and Zikan 1998",
     "QuickCD: binary trees of 18-DOPs, split by the least variance, a triangle in each leaf"},
    {"obb", true, "Gottschalk, Lin and Manocha 1996", "RAPID: binary trees of oriented boxes, separating axes"},
    {"aabb", true, "van den Bergen 1997", "SOLID: binary trees of boxes along each object's own axes"},
    {"sphere", false, "Hubbard 1996", "sphere trees, which answer alone: near is taken for a touch"},
    {"i-collide", true, "Cohen, Lin, Manocha and Ponamgi 1995",
     "I-COLLIDE: sweep and prune over convex pieces, closest features kept from question to question"},
    {"rapid-world", true, "Hudson, Lin, Cohen, Gottschalk and Manocha 1997",
     "V-COLLIDE: sweep and prune over all objects, then RAPID"},
}};

constexpr std::uint32_t kThresholdMax = 1'000'000;

using Options = std::map<std::string, std::string, std::less<>>;

std::expected<std::uint32_t, std::string> number_of(const std::string& name, const std::string& text) {
  std::uint32_t number = 0;
  const auto [end, failed] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (failed != std::errc{} || end != text.data() + text.size()) {
    return std::unexpected(name + "=" + text + " is no whole number");
  }
  return number;
}

std::unique_ptr<NarrowPhase> make_kdop(std::uint32_t k, const TreeOptions& options, RealignBy realign) {
  switch (k) {
    case 6:
      return std::make_unique<KdopQuery<6>>(options, realign);
    case 14:
      return std::make_unique<KdopQuery<14>>(options, realign);
    case 18:
      return std::make_unique<KdopQuery<18>>(options, realign);
    case 26:
      return std::make_unique<KdopQuery<26>>(options, realign);
    default:
      return nullptr;
  }
}

std::expected<SplitRule, std::string> rule_of(const std::string& name) {
  const auto rule = std::ranges::find(kSplitRuleNames, name, &SplitRuleName::name);
  if (rule != kSplitRuleNames.end()) return rule->rule;
  std::string all;
  for (const SplitRuleName& each : kSplitRuleNames) all += (all.empty() ? "" : ", ") + std::string(each.name);
  return std::unexpected("rule=" + name + " is none of " + all);
}

std::expected<RealignBy, std::string> realign_of(const std::string& name) {
  if (name == "slabs") return RealignBy::kSlabs;
  if (name == "boundary") return RealignBy::kBoundary;
  if (name == "hull") return RealignBy::kHull;
  return std::unexpected("realign=" + name + " is none of slabs, boundary, hull");
}

std::expected<std::unique_ptr<NarrowPhase>, std::string> kdop_of(Options& options) {
  TreeOptions tree;
  RealignBy realign = RealignBy::kSlabs;
  std::uint32_t k = 18;
  for (const auto& [name, value] : options) {
    if (name == "rule") {
      const auto rule = rule_of(value);
      if (!rule) return std::unexpected(rule.error());
      tree.rule = *rule;
      continue;
    }
    if (name == "realign") {
      const auto way = realign_of(value);
      if (!way) return std::unexpected(way.error());
      realign = *way;
      continue;
    }
    const auto number = number_of(name, value);
    if (name == "k") {
      if (!number) return std::unexpected(number.error());
      k = *number;
    } else if (name == "threshold") {
      if (!number) return std::unexpected(number.error());
      if (*number < 1 || *number > kThresholdMax) return std::unexpected("threshold=" + value + " is not 1 to 1000000");
      tree.split_threshold = *number;
    } else {
      return std::unexpected("kdop has no option " + name + "; it has k, rule, threshold and realign");
    }
  }
  auto made = make_kdop(k, tree, realign);
  if (made == nullptr) return std::unexpected("k=" + std::to_string(k) + " is none of 6, 14, 18, 26");
  return made;
}

std::expected<EngineDescription, std::string> described(std::string_view name) {
  Suggestion suggestion(name);
  for (const EngineDescription& each : kEngines) {
    if (each.name == name) return each;
    suggestion.consider(each.name);
  }
  const auto meant = suggestion.best();
  return std::unexpected("there is no engine " + std::string(name) +
                         (meant ? "; did you mean " + std::string(*meant) + "?" : ""));
}

// Takes what is before the next comma from the text.
std::string_view take_word(std::string_view& text) {
  const std::size_t end = std::min(text.find(','), text.size());
  const std::string_view word = text.substr(0, end);
  text.remove_prefix(std::min(end + 1, text.size()));
  return word;
}

}  // namespace

std::span<const EngineDescription> engines() { return kEngines; }

std::expected<Engine, std::string> make_engine(std::string_view words) {
  const auto description = described(take_word(words));
  if (!description) return std::unexpected(description.error());
  Options options;
  while (!words.empty()) {
    const std::string_view word = take_word(words);
    const std::size_t middle = word.find('=');
    if (middle == std::string_view::npos) {
      return std::unexpected("\"" + std::string(word) + "\" is no option=value");
    }
    if (!options.emplace(word.substr(0, middle), word.substr(middle + 1)).second) {
      return std::unexpected("the option " + std::string(word.substr(0, middle)) + " is given twice");
    }
  }
  Engine engine{*description, nullptr};
  const std::string_view name = description->name;
  if (name == "kdop") {
    auto made = kdop_of(options);
    if (!made) return std::unexpected(made.error());
    engine.narrow_phase = *std::move(made);
    return engine;
  }
  if (!options.empty()) return std::unexpected(std::string(name) + " has no options");
  if (name == "quickcd") {
    engine.narrow_phase = std::make_unique<KdopQuery<18>>(TreeOptions{SplitRule::kSplatter, 1});
  } else if (name == "obb" || name == "rapid-world") {
    engine.narrow_phase = std::make_unique<VolumeQuery<OrientedBox>>();
    if (name == "rapid-world") engine.broad_phase = BroadPhaseMethod::kSweepAndPrune;
  } else if (name == "aabb") {
    engine.narrow_phase = std::make_unique<VolumeQuery<AlignedBox>>();
  } else if (name == "i-collide") {
    engine.narrow_phase = std::make_unique<ICollide>();
  } else if (name == "sphere") {
    engine.narrow_phase = std::make_unique<VolumeQuery<Sphere>>();
  }
  return engine;
}

}  // namespace peerd::collision::baselines
