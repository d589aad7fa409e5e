#include "collision/engines/engine.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cstdint>
#include <map>
#include <optional>

#include "collision/engines/box_volumes.hpp"
#include "collision/engines/cylinder_query.hpp"
#include "collision/engines/i_collide.hpp"
#include "collision/engines/kdop_query.hpp"
#include "collision/engines/sphere_query.hpp"
#include "collision/engines/volume_query.hpp"
#include "core/suggestion.hpp"

namespace peerd::collision::engines {
namespace {

constexpr std::array<EngineDescription, 9> kEngines = {{
    {"ours", true, "docs/decisions/collision-hierarchies.md", "trees of eight children, by vector instructions"},
    {"kdop", true, "Ohlenburg 2003, chapter 3",
     "binary trees of k-DOPs; options k (6, 14, 18, 26), rule (of splitting), threshold (triangles of a leaf), build "
     "(lazy, whole), realign (slabs, boundary, hull)"},
    {"quickcd", true, "Klosowski, Held, Mitchell, Sowizral and Zikan 1998",
     "QuickCD: binary trees of 18-DOPs, split by the least variance, a triangle in each leaf"},
    {"obb", true, "Gottschalk, Lin and Manocha 1996", "RAPID: binary trees of oriented boxes, separating axes"},
    {"aabb", true, "van den Bergen 1997", "SOLID: binary trees of boxes along each object's own axes"},
    {"sphere", false, "Hubbard 1995 and 1996",
     "sphere trees, which answer alone: near is taken for a touch; space-time bounds; options bounds (space-time, "
     "none), "
     "depth (the last level of the trees)"},
    {"cylinders", false, "Zyda, Osborne, Monahan and Pratt 1993",
     "NPSNET: heights, then upright cylinders: near is taken for a touch; option axis (world, model)"},
    {"i-collide", true, "Cohen, Lin, Manocha and Ponamgi 1995",
     "I-COLLIDE: sweep and prune over convex pieces, closest features kept from question to question"},
    {"rapid-world", true, "Hudson, Lin, Cohen, Gottschalk and Manocha 1997",
     "V-COLLIDE: sweep and prune over all objects, then RAPID"},
}};

constexpr std::uint32_t kThresholdMax = 1'000'000;
constexpr std::uint32_t kDepthMax = 64;

using Options = std::map<std::string, std::string, std::less<>>;

std::expected<std::uint32_t, std::string> number_of(const std::string& name, const std::string& text) {
  std::uint32_t number = 0;
  const auto [end, failed] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (failed != std::errc{} || end != text.data() + text.size()) {
    return std::unexpected(name + "=" + text + " is no whole number");
  }
  return number;
}

std::unique_ptr<NarrowPhase> make_kdop(const KdopOptions& options) {
  switch (options.k) {
    case 6:
      return std::make_unique<KdopQuery<6>>(options.tree, options.whole, options.realign);
    case 14:
      return std::make_unique<KdopQuery<14>>(options.tree, options.whole, options.realign);
    case 18:
      return std::make_unique<KdopQuery<18>>(options.tree, options.whole, options.realign);
    case 26:
      return std::make_unique<KdopQuery<26>>(options.tree, options.whole, options.realign);
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

std::expected<KdopOptions, std::string> kdop_of(const Options& options) {
  KdopOptions out;
  for (const auto& [name, value] : options) {
    if (name == "rule") {
      const auto rule = rule_of(value);
      if (!rule) return std::unexpected(rule.error());
      out.tree.rule = *rule;
      continue;
    }
    if (name == "build") {
      if (value != "lazy" && value != "whole") return std::unexpected("build=" + value + " is neither lazy nor whole");
      out.whole = value == "whole";
      continue;
    }
    if (name == "realign") {
      const auto way = realign_of(value);
      if (!way) return std::unexpected(way.error());
      out.realign = *way;
      continue;
    }
    const auto number = number_of(name, value);
    if (name == "k") {
      if (!number) return std::unexpected(number.error());
      out.k = *number;
    } else if (name == "threshold") {
      if (!number) return std::unexpected(number.error());
      if (*number < 1 || *number > kThresholdMax) return std::unexpected("threshold=" + value + " is not 1 to 1000000");
      out.tree.split_threshold = *number;
    } else {
      return std::unexpected("kdop has no option " + name + "; it has k, rule, threshold, build and realign");
    }
  }
  if (make_kdop(out) == nullptr) return std::unexpected("k=" + std::to_string(out.k) + " is none of 6, 14, 18, 26");
  return out;
}

// `engine` is the sphere trees'.
std::expected<void, std::string> set_sphere(Engine& engine, const Options& options) {
  engine.has_space_time_bounds = true;
  std::uint32_t depth = SphereQuery::kNoLimit;
  for (const auto& [name, value] : options) {
    if (name == "bounds") {
      if (value != "space-time" && value != "none") {
        return std::unexpected("bounds=" + value + " is none of space-time, none");
      }
      engine.has_space_time_bounds = value == "space-time";
    } else if (name == "depth") {
      const auto number = number_of(name, value);
      if (!number) return std::unexpected(number.error());
      if (*number > kDepthMax) return std::unexpected("depth=" + value + " is not 0 to 64");
      depth = *number;
    } else {
      return std::unexpected("sphere has no option " + name + "; it has bounds and depth");
    }
  }
  engine.narrow_phase = std::make_unique<SphereQuery>(depth);
  return {};
}

std::expected<std::unique_ptr<NarrowPhase>, std::string> cylinders_of(const Options& options) {
  CylinderAxis axis = CylinderAxis::kWorld;
  for (const auto& [name, value] : options) {
    if (name != "axis") return std::unexpected("cylinders has no option " + name + "; it has axis");
    if (value != "world" && value != "model") return std::unexpected("axis=" + value + " is none of world, model");
    axis = value == "world" ? CylinderAxis::kWorld : CylinderAxis::kModel;
  }
  return std::make_unique<CylinderQuery>(axis);
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

// The words "option=value,..", each option once.
std::expected<Options, std::string> options_of(std::string_view words) {
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
  return options;
}

}  // namespace

std::span<const EngineDescription> engines() { return kEngines; }

std::expected<Engine, std::string> make_engine(std::string_view words) {
  const auto description = described(take_word(words));
  if (!description) return std::unexpected(description.error());
  const auto options = options_of(words);
  if (!options) return std::unexpected(options.error());
  Engine engine{*description, nullptr};
  const std::string_view name = description->name;
  if (name == "kdop") {
    const auto kdop = kdop_of(*options);
    if (!kdop) return std::unexpected(kdop.error());
    engine.narrow_phase = make_kdop(*kdop);
    return engine;
  }
  if (name == "sphere") {
    if (const auto set = set_sphere(engine, *options); !set) return std::unexpected(set.error());
    return engine;
  }
  if (name == "cylinders") {
    auto made = cylinders_of(*options);
    if (!made) return std::unexpected(made.error());
    engine.narrow_phase = *std::move(made);
    return engine;
  }
  if (!options->empty()) return std::unexpected(std::string(name) + " has no options");
  if (name == "quickcd") {
    engine.narrow_phase = std::make_unique<KdopQuery<18>>(TreeOptions{SplitRule::kSplatter, 1}, false);
  } else if (name == "obb" || name == "rapid-world") {
    engine.narrow_phase = std::make_unique<VolumeQuery<OrientedBox>>();
    if (name == "rapid-world") engine.broad_phase = BroadPhaseMethod::kSweepAndPrune;
  } else if (name == "aabb") {
    engine.narrow_phase = std::make_unique<VolumeQuery<AlignedBox>>();
  } else if (name == "i-collide") {
    engine.narrow_phase = std::make_unique<ICollide>();
  }
  return engine;
}

std::expected<KdopOptions, std::string> kdop_options(std::string_view words) {
  const auto options = options_of(words);
  if (!options) return std::unexpected(options.error());
  return kdop_of(*options);
}

}  // namespace peerd::collision::engines
