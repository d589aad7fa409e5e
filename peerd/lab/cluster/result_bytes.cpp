// The encoding of a result: a number is copied from memory, so that a double comes back bit for bit; a struct is its
// fields in order; a list is its length in 64 bits, then its items; JSON is its text.
#include "peerd/lab/cluster/result_bytes.hpp"

#include <algorithm>
#include <concepts>
#include <cstdint>
#include <cstring>
#include <iterator>
#include <map>
#include <tuple>
#include <type_traits>
#include <utility>

#include <nlohmann/json.hpp>

#include "core/ids.hpp"
#include "core/math.hpp"
#include "core/shape_polygon.hpp"
#include "peerd/input/json_text.hpp"

namespace peerd::cluster {
namespace {

using Json = nlohmann::ordered_json;

constexpr int kJsonDepthMax = 16;  // deeper than any JSON in a result

// Ties the fields of a struct, const or not. The structured binding does not compile where a field is missing.
#define PEERD_FIELDS(Type, ...)                       \
  template <class T>                                  \
  requires std::same_as<std::remove_const_t<T>, Type> \
  auto fields(T& fielded) {                           \
    auto& [__VA_ARGS__] = fielded;                    \
    return std::tie(__VA_ARGS__);                     \
  }

PEERD_FIELDS(PeerId, value)
PEERD_FIELDS(ObjectId, number, origin)
PEERD_FIELDS(ShapePolygon, shape, polygon)
PEERD_FIELDS(ShapePair, collider, collidee)
PEERD_FIELDS(TouchedPolygons, count, pairs)
PEERD_FIELDS(measure::ObjectInfo, object, path, owner)
PEERD_FIELDS(measure::PeerInfo, peer, name, there_s)
PEERD_FIELDS(measure::GhostSample, t_s, observer, object, truth, ghost, shown, seen)
PEERD_FIELDS(measure::UpdateSent, t_s, sender, object, bytes, threshold_m, reason)
PEERD_FIELDS(measure::DatagramSent, t_s, sender, bytes)
PEERD_FIELDS(measure::ContactRow, t_s, peer, kind, collider, collidee, normal, reported_at_s, type, polygons)
PEERD_FIELDS(measure::WrongOutcomes, truth, missing, spurious)
PEERD_FIELDS(measure::PeerInterest, peer, objects, received_bytes, interest_bytes, joins, leaves, joins_in_a_second,
             groups)
PEERD_FIELDS(measure::InterestRecord, latency_ms, longest_missing_ms, longest_outdated_ms, gaps, samples,
             missing_samples, peers)
PEERD_FIELDS(measure::EventMark, t_s, name)
PEERD_FIELDS(measure::PeerClock, peer, samples, error_p99_ms, error_max_ms, bound_median_ms, bound_max_ms, beyond_bound)
PEERD_FIELDS(measure::SceneOutline, owned, corners, bottom_m, top_m)
PEERD_FIELDS(measure::Statistics, count, mean, rms, p99, max, p99_exact)
PEERD_FIELDS(measure::UpdateTotals, updates, bytes)
PEERD_FIELDS(measure::ViewMeasured, observer, object, not_finite, ghost_error_m, shown_error_m, view_difference_m,
             inconsistency_m_s, rest_samples, rest_error_max_m)
PEERD_FIELDS(measure::Measured, from_s, until_s, views, updates, datagrams, datagram_bytes)
PEERD_FIELDS(measure::RunMeasured, whole, rows_complete, parts, output_bytes)
PEERD_FIELDS(measure::LinkMeasured, from, to, probes_sent, probes_lost, probes_duplicated, delay_ms, packets,
             packets_lost)
PEERD_FIELDS(measure::NetworkMeasured, links, oversleep_before_ms, oversleep_during_ms)
PEERD_FIELDS(measure::ShownDelay, least_ms, most_ms, latest_by_ms)
PEERD_FIELDS(measure::WorstPair, depth_m, a, b, at_s, explained_m)
PEERD_FIELDS(measure::EnergyMeasured, start_j, greatest_j, end_j)
PEERD_FIELDS(measure::ContactsMeasured, samples, view_samples, energy_samples, pairs_not_measured, truth, truth_meshes,
             views, view_meshes, observer, unexplained, at_rest, bodies, owners, kinetic, potential, sum, is_driven)
PEERD_FIELDS(measure::RunRecord, params, network_settings, seed, duration_s, stopped, peers, objects, scene_paths,
             outlines, outlines_left_out, ghost_samples, updates, datagrams, measured, contacts, contacts_measured,
             events, wrong, interest, network, shown_delay, clocks, groups_joined, worlds_equal, counters)
PEERD_FIELDS(RunResult, record, warnings)
PEERD_FIELDS(chaos::ChaosReport, seed, violations, trace_hash, peers, lives, faults, edits, operations, held, datagrams,
             damaged, one_world_after_s, branches)
#undef PEERD_FIELDS

template <class T>
requires std::same_as<std::remove_const_t<T>, Pose>
auto fields(T& pose) { return std::tie(pose.position, pose.orientation.coeffs()); }
template <class T>
requires requires { typename T::first_type; }
auto fields(T& pair) { return std::tie(pair.first, pair.second); }

template <class T>
concept Struct = requires(T& value) {
  fields(value);
};
template <class T>
concept Optional = requires(T& value) {
  value.emplace();
  value.has_value();
};
template <class T>
concept FixedVector = requires {
  T::SizeAtCompileTime;
};

template <class T>
void put(std::string& bytes, const T& value) {
  if constexpr (std::is_arithmetic_v<T> || std::is_enum_v<T>) {
    bytes.append(reinterpret_cast<const char*>(&value), sizeof value);
  } else if constexpr (std::same_as<T, Json>) {
    put(bytes, json_line(value));
  } else if constexpr (Struct<const T>) {
    std::apply([&](const auto&... field) { (put(bytes, field), ...); }, fields(value));
  } else if constexpr (Optional<T>) {
    put(bytes, value.has_value());
    if (value) put(bytes, *value);
  } else {
    if constexpr (!FixedVector<T>) put(bytes, std::uint64_t{value.size()});
    for (const auto& item : value) put(bytes, item);
  }
}

// An item of a list, or of a map, whose items can't be changed in place.
template <class T>
struct ItemOf {
  using Item = typename T::value_type;
};
template <class K, class V>
struct ItemOf<std::map<K, V>> {
  using Item = std::pair<K, V>;
};

// Takes a value from the front of the bytes. False: they do not begin with one that put() writes; what was read is to
// be thrown away then. Makes no list of more items than there are bytes left.
template <class T>
[[nodiscard]] bool get(std::string_view& bytes, T& value) {
  if constexpr (std::same_as<T, bool> || std::is_enum_v<T>) {
    std::uint8_t number = 0;
    static_assert(sizeof value == sizeof number && (std::same_as<T, bool> || std::same_as<T, CollisionType>));
    if (!get(bytes, number)) return false;
    value = static_cast<T>(number);
    return number <= (std::same_as<T, bool> ? 1 : static_cast<int>(CollisionType::kAllPairs));
  } else if constexpr (std::is_arithmetic_v<T>) {
    if (bytes.size() < sizeof value) return false;
    bytes.copy(reinterpret_cast<char*>(&value), sizeof value);
    bytes.remove_prefix(sizeof value);
    return true;
  } else if constexpr (std::same_as<T, Json>) {
    std::string text;
    if (!get(bytes, text)) return false;
    value = Json::parse(
        text, [](int depth, auto, auto&) { return depth <= kJsonDepthMax; }, false);
    return !value.is_discarded() && json_line(value) == text;
  } else if constexpr (Struct<T>) {
    return std::apply([&](auto&... field) { return (get(bytes, field) && ...); }, fields(value));
  } else if constexpr (Optional<T>) {
    bool there = false;
    return get(bytes, there) && (!there || get(bytes, value.emplace()));
  } else if constexpr (FixedVector<T>) {
    return std::ranges::all_of(value, [&](double& item) { return get(bytes, item); });
  } else {
    std::uint64_t count = 0;
    if (!get(bytes, count) || count > bytes.size()) return false;
    for (std::uint64_t left = count; left > 0; --left) {
      typename ItemOf<T>::Item item{};
      if (!get(bytes, item)) return false;
      const auto at = value.insert(value.end(), std::move(item));
      if (std::next(at) != value.end()) return false;  // the keys of a map ascend
    }
    return value.size() == count;  // .. and each is there once
  }
}

template <class Result>
std::string bytes_of(const Result& result) {
  std::string bytes;
  put(bytes, result);
  return bytes;
}
template <class Result>
std::expected<Result, std::string> read(std::string_view bytes, const char* item) {
  Result result;
  if (get(bytes, result) && bytes.empty()) return result;
  return std::unexpected(std::string("it is no result of a ") + item + ", or only a part of one");
}

}  // namespace

std::string to_bytes(const RunResult& result) { return bytes_of(result); }
std::string to_bytes(const chaos::ChaosReport& report) { return bytes_of(report); }
std::expected<RunResult, std::string> run_result_from(std::string_view bytes) { return read<RunResult>(bytes, "run"); }
std::expected<chaos::ChaosReport, std::string> chaos_report_from(std::string_view bytes) {
  return read<chaos::ChaosReport>(bytes, "seed");
}

}  // namespace peerd::cluster
