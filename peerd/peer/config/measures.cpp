#include "peerd/peer/config/measures.hpp"

#include <algorithm>

namespace peerd::config {
namespace {

constexpr Measure count(std::string_view name) { return {.name = name, .of_view = true}; }
constexpr Measure error(std::string_view name) { return {.name = name, .of_view = true, .error = true}; }
constexpr Measure of_run(std::string_view name) { return {.name = name}; }
constexpr Measure of_whole_run(std::string_view name) { return {.name = name, .window = false}; }

constexpr Measure kMeasures[] = {
    count("updates_sent"),
    count("bytes_sent"),
    count("samples"),
    error("ghost_error_m.mean"),
    error("ghost_error_m.rms"),
    error("ghost_error_m.p99"),
    error("ghost_error_m.max"),
    error("shown_error_m.mean"),
    error("shown_error_m.rms"),
    error("shown_error_m.p99"),
    error("shown_error_m.max"),
    error("view_difference_m.mean"),
    error("view_difference_m.rms"),
    error("view_difference_m.p99"),
    error("view_difference_m.max"),
    error("inconsistency_m_s"),
    error("rest.ghost_error_max_m"),
    count("rest.samples"),
    of_run("collisions.decided"),
    of_run("collisions.agreed"),
    of_run("collisions.disagreed"),
    of_run("collisions.spurious"),
    of_run("collisions.missed"),
    of_run("collisions.revised"),
    of_run("collisions.shared.decided"),
    of_run("collisions.shared.agreed"),
    of_run("collisions.shared.disagreed"),
    of_run("collisions.shared.missed"),
    of_run("collisions.shared.spurious"),
    of_run("collisions.decision_latency_ms.mean"),
    of_run("collisions.decision_latency_ms.p99"),
    of_run("collisions.decision_latency_ms.max"),
    of_whole_run("collisions.wrong.truth"),
    of_whole_run("collisions.wrong.missing"),
    of_whole_run("collisions.wrong.spurious"),
    of_run("contacts.count"),
    of_run("contacts.per_s.max"),
    of_run("contacts.per_s.mean"),
    of_whole_run("contacts.last_s"),
    of_whole_run("contacts.at_rest_per_s"),
    of_whole_run("contacts.islands"),
    of_whole_run("contacts.island_objects_max"),
    of_whole_run("contacts.pairs_not_measured"),
    of_whole_run("contacts.overlap.samples"),
    of_whole_run("contacts.overlap.deepest.depth_m"),
    of_whole_run("contacts.overlap.deepest.at_s"),
    of_whole_run("contacts.overlap.deepest_mesh_at_least.depth_m"),
    of_whole_run("contacts.overlap.deepest_mesh_at_least.at_s"),
    of_whole_run("contacts.overlap.unexplained.depth_m"),
    of_whole_run("contacts.overlap.unexplained.at_s"),
    of_whole_run("contacts.overlap.unexplained.beyond_m"),
    of_whole_run("contacts.ghost_overlap.samples"),
    of_whole_run("contacts.ghost_overlap.deepest.depth_m"),
    of_whole_run("contacts.ghost_overlap.deepest.at_s"),
    of_whole_run("contacts.ghost_overlap.deepest_mesh_at_least.depth_m"),
    of_whole_run("contacts.ghost_overlap.deepest_mesh_at_least.at_s"),
    of_whole_run("energy_j.bodies"),
    of_whole_run("energy_j.owners"),
    of_whole_run("energy_j.samples"),
    {.name = "energy_j.driven", .window = false, .yes_or_no = true},
    of_whole_run("energy_j.kinetic.start"),
    of_whole_run("energy_j.kinetic.greatest"),
    of_whole_run("energy_j.kinetic.end"),
    of_whole_run("energy_j.potential.start"),
    of_whole_run("energy_j.potential.greatest"),
    of_whole_run("energy_j.potential.end"),
    of_whole_run("energy_j.sum.start"),
    of_whole_run("energy_j.sum.greatest"),
    of_whole_run("energy_j.sum.end"),
    of_whole_run("energy_j.taken_by_rest"),
    of_whole_run("shown_delay_ms.min"),
    of_whole_run("shown_delay_ms.max"),
    of_whole_run("late.updates"),
    of_whole_run("late.updates_missing"),
    of_whole_run("late.decisions"),
    of_whole_run("late.by_ms"),
    of_run("traffic.packets"),
    of_run("traffic.bytes"),
    of_run("traffic.bytes_per_s"),
    of_whole_run("groups_joined"),
    {.name = "state_roots_equal", .window = false, .yes_or_no = true},
    of_whole_run("interest.latency_ms"),
    of_whole_run("interest.longest_missing_ms"),
    of_whole_run("interest.longest_outdated_ms"),
    of_whole_run("interest.gaps"),
    of_whole_run("interest.samples"),
    of_whole_run("interest.missing_samples"),
    of_whole_run("interest.received_over_interest"),
};

}  // namespace

std::span<const Measure> measures() { return kMeasures; }

std::optional<Measure> find_measure(std::string_view name) {
  const auto known = std::ranges::find(kMeasures, name, &Measure::name);
  if (known != std::end(kMeasures)) return *known;
  constexpr std::string_view kCounter = "counters.";
  if (name.starts_with(kCounter) && name.size() > kCounter.size()) return of_whole_run(name);
  return std::nullopt;
}

}  // namespace peerd::config
