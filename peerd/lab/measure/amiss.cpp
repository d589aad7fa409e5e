#include "peerd/lab/measure/amiss.hpp"

#include <algorithm>
#include <cstdint>
#include <functional>

#include <nlohmann/json.hpp>

#include "peerd/input/console/columns.hpp"
#include "peerd/input/json_text.hpp"

namespace peerd::measure {
namespace {

using Json = nlohmann::ordered_json;

// Contacts of what does not move: more than these in a second are work for nothing.
constexpr std::uint64_t kAtRestMost_per_s = 100;
// Contact times are found up to a micrometre early, and what bends to some more.
constexpr double kDepth_m = 1e-5;
constexpr double kEnergyGrows = 1e-6;
// A decider does not find some of the contacts that others leave to it, as a state comes late.
constexpr double kRefutedMost = 0.1;

std::uint64_t counter(const Json& run, const char* name) {
  const Json& counters = run.at("counters");
  return counters.value(name, std::uint64_t{0});
}

std::string busy_at_rest(const Json& run) {
  const auto count = run.at("contacts").at("at_rest_per_s").get<std::uint64_t>();
  if (count <= kAtRestMost_per_s) return "";
  return std::to_string(count) + " contacts in the last second of objects that do not move";
}

std::string overlap(const Json& run) {
  if (!run.at("contacts").contains("overlap")) return "";
  const Json& unexplained = run.at("contacts").at("overlap").at("unexplained");
  if (unexplained.at("beyond_m").get<double>() <= kDepth_m) return "";
  const Json& between = unexplained.at("between");
  return between[0].get<std::string>() + " and " + between[1].get<std::string>() + " were " +
         length_text(unexplained.at("depth_m").get<double>()) + " in each other at " +
         fixed(unexplained.at("at_s").get<double>(), 2) + " s, " +
         length_text(unexplained.at("beyond_m").get<double>()) + " more than latency explains";
}

// The energy of bodies of several peers is that of one world only while nothing is under way between them.
std::string energy(const Json& run) {
  if (!run.contains("energy_j")) return "";
  const Json& energy = run.at("energy_j");
  if (energy.at("driven").get<bool>()) return "";
  const Json& sum = energy.at("sum");
  const bool one_owner = energy.at("owners").get<std::uint64_t>() == 1;
  if (!one_owner && run.at("contacts").at("last_s") > 0) return "";
  const double start = sum.at("start").get<double>();
  const double later = sum.at(one_owner ? "greatest" : "end").get<double>();
  const double scale = std::max(std::abs(start), energy.at("kinetic").at("greatest").get<double>());
  if (later <= start + kEnergyGrows * scale) return "";
  return "energy came from nothing: " + fixed(start, 6) + " J became " + fixed(later, 6) + " J";
}

std::string capped(const Json& run) {
  const std::uint64_t count = counter(run, "contacts_capped");
  if (count == 0) return "";
  return std::to_string(count) + " ticks had more contacts than are answered: what met stood still (contacts_capped)";
}

// An object that is driven into what has no room jams: nothing else is possible.
std::string jammed(const Json& run) {
  const std::uint64_t count = counter(run, "jammed");
  if (count == 0 || (run.contains("energy_j") && run.at("energy_j").at("driven").get<bool>())) return "";
  return std::to_string(count) + " contacts were answered by all that touched, as no two could part (jammed)";
}

std::string refuted(const Json& run) {
  const std::uint64_t count = counter(run, "contacts_refuted"), held = counter(run, "contacts_held");
  if (static_cast<double>(count) <= kRefutedMost * static_cast<double>(held)) return "";
  return std::to_string(count) + " of " + std::to_string(held) +
         " contacts that were left to another peer were none there (contacts_refuted)";
}

std::string blocked(const Json& run) {
  const std::uint64_t count = counter(run, "convergence_blocked");
  if (count == 0) return "";
  return std::to_string(count) +
         " times an object that was shown jumped, as something was in its way "
         "(convergence_blocked)";
}

}  // namespace

std::vector<std::string> amiss(const Json& runs) {
  std::vector<std::string> all;
  for (std::string (*const find)(const Json&) : {busy_at_rest, overlap, energy, capped, jammed, refuted, blocked}) {
    std::string first;
    std::size_t more = 0;
    for (std::size_t i = 0; i < runs.size(); ++i) {
      const std::string found = find(runs[i]);
      if (found.empty()) continue;
      if (!first.empty()) {
        ++more;
        continue;
      }
      first = (runs.size() > 1 ? "run " + std::to_string(i + 1) + ": " : "") + found;
    }
    if (more > 0) first += "; the like in " + std::to_string(more) + (more == 1 ? " more run" : " more runs");
    if (!first.empty()) all.push_back(std::move(first));
  }
  return all;
}

}  // namespace peerd::measure
