#include "peerd/lab/cluster/run_bytes.hpp"

#include "peerd/lab/cluster/bytes.hpp"

namespace peerd::cluster {

// A new field, or another order, is another kRunFormat. The structured bindings do not compile where a field is
// missing.
template <class A>
void fields(A& a, typename A::template Of<measure::ObjectInfo>& s) {
  auto& [object, path, owner] = s;
  a(object, path, owner);
}
template <class A>
void fields(A& a, typename A::template Of<measure::PeerInfo>& s) {
  auto& [peer, name, there_s] = s;
  a(peer, name, there_s);
}
template <class A>
void fields(A& a, typename A::template Of<measure::GhostSample>& s) {
  auto& [t_s, observer, object, truth, ghost, shown, seen] = s;
  a(t_s, observer, object, truth, ghost, shown, seen);
}
template <class A>
void fields(A& a, typename A::template Of<measure::UpdateSent>& s) {
  auto& [t_s, sender, object, bytes, threshold_m, reason] = s;
  a(t_s, sender, object, bytes, threshold_m, reason);
}
template <class A>
void fields(A& a, typename A::template Of<measure::DatagramSent>& s) {
  auto& [t_s, sender, bytes] = s;
  a(t_s, sender, bytes);
}
template <class A>
void fields(A& a, typename A::template Of<ShapePolygon>& s) {
  auto& [shape, polygon] = s;
  a(shape, polygon);
}
template <class A>
void fields(A& a, typename A::template Of<ShapePair>& s) {
  auto& [collider, collidee] = s;
  a(collider, collidee);
}
template <class A>
void fields(A& a, typename A::template Of<TouchedPolygons>& s) {
  auto& [count, pairs] = s;
  a(count, pairs);
}
template <class A>
void fields(A& a, typename A::template Of<measure::ContactRow>& s) {
  auto& [t_s, peer, kind, collider, collidee, normal, reported_at_s, type, polygons] = s;
  a(t_s, peer, kind, collider, collidee, normal, reported_at_s, type, polygons);
  if constexpr (requires { a.refuse(); }) {
    if (type > CollisionType::kAllPairs) a.refuse();
  }
}
template <class A>
void fields(A& a, typename A::template Of<measure::WrongOutcomes>& s) {
  auto& [truth, missing, spurious] = s;
  a(truth, missing, spurious);
}
template <class A>
void fields(A& a, typename A::template Of<measure::PeerInterest>& s) {
  auto& [peer, objects, received_bytes, interest_bytes, joins, leaves, joins_in_a_second, groups] = s;
  a(peer, objects, received_bytes, interest_bytes, joins, leaves, joins_in_a_second, groups);
}
template <class A>
void fields(A& a, typename A::template Of<measure::InterestRecord>& s) {
  auto& [latency_ms, longest_missing_ms, longest_outdated_ms, gaps, samples, missing_samples, peers] = s;
  a(latency_ms, longest_missing_ms, longest_outdated_ms, gaps, samples, missing_samples, peers);
}
template <class A>
void fields(A& a, typename A::template Of<measure::EventMark>& s) {
  auto& [t_s, name] = s;
  a(t_s, name);
}
template <class A>
void fields(A& a, typename A::template Of<measure::PeerClock>& s) {
  auto& [peer, samples, error_p99_ms, error_max_ms, bound_median_ms, bound_max_ms, beyond_bound] = s;
  a(peer, samples, error_p99_ms, error_max_ms, bound_median_ms, bound_max_ms, beyond_bound);
}
template <class A>
void fields(A& a, typename A::template Of<measure::SceneOutline>& s) {
  auto& [owned, corners, bottom_m, top_m] = s;
  a(owned, corners, bottom_m, top_m);
}
template <class A>
void fields(A& a, typename A::template Of<measure::Statistics>& s) {
  auto& [count, mean, rms, p99, max, p99_exact] = s;
  a(count, mean, rms, p99, max, p99_exact);
}
template <class A>
void fields(A& a, typename A::template Of<measure::UpdateTotals>& s) {
  auto& [updates, bytes] = s;
  a(updates, bytes);
}
template <class A>
void fields(A& a, typename A::template Of<measure::ViewMeasured>& s) {
  auto& [observer, object, not_finite, ghost_error_m, shown_error_m, view_difference_m, inconsistency_m_s, rest_samples,
         rest_error_max_m] = s;
  a(observer, object, not_finite, ghost_error_m, shown_error_m, view_difference_m, inconsistency_m_s, rest_samples,
    rest_error_max_m);
}
template <class A>
void fields(A& a, typename A::template Of<measure::Measured>& s) {
  auto& [from_s, until_s, views, updates, datagrams, datagram_bytes] = s;
  a(from_s, until_s, views, updates, datagrams, datagram_bytes);
}
template <class A>
void fields(A& a, typename A::template Of<measure::RunMeasured>& s) {
  auto& [whole, rows_complete, parts, output_bytes] = s;
  a(whole, rows_complete, parts, output_bytes);
}
template <class A>
void fields(A& a, typename A::template Of<measure::LinkMeasured>& s) {
  auto& [from, to, probes_sent, probes_lost, probes_duplicated, delay_ms, packets, packets_lost] = s;
  a(from, to, probes_sent, probes_lost, probes_duplicated, delay_ms, packets, packets_lost);
}
template <class A>
void fields(A& a, typename A::template Of<measure::NetworkMeasured>& s) {
  auto& [links, oversleep_before_ms, oversleep_during_ms] = s;
  a(links, oversleep_before_ms, oversleep_during_ms);
}
template <class A>
void fields(A& a, typename A::template Of<measure::ShownDelay>& s) {
  auto& [least_ms, most_ms, latest_by_ms] = s;
  a(least_ms, most_ms, latest_by_ms);
}
template <class A>
void fields(A& a, typename A::template Of<measure::RunRecord>& s) {
  auto& [params, network_settings, seed, duration_s, stopped, peers, objects, scene_paths, outlines, outlines_left_out,
         ghost_samples, updates, datagrams, measured, contacts, events, wrong, interest, network, shown_delay, clocks,
         groups_joined, worlds_equal, counters] = s;
  a(params, network_settings, seed, duration_s, stopped, peers, objects, scene_paths, outlines, outlines_left_out,
    ghost_samples, updates, datagrams, measured, contacts, events, wrong, interest, network, shown_delay, clocks,
    groups_joined, worlds_equal, counters);
}

std::string to_bytes(const RunResult& result) {
  ByteWriter writer;
  writer(kRunFormat, result.record, result.warnings);
  return writer.take();
}

std::expected<RunResult, std::string> run_result_from(std::string_view bytes) {
  return read_result<RunResult>(bytes, kRunFormat, "run",
                                [](ByteReader& reader, RunResult& result) { reader(result.record, result.warnings); });
}

}  // namespace peerd::cluster
