#pragma once
#include <span>
#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

namespace peerd::measure {

// The parameters of a run: swept values by dotted name.
using Params = nlohmann::ordered_json;

// The keys that have different values in different runs (a missing key counts as a value), in the order of their first
// appearance.
[[nodiscard]] std::vector<std::string> varying_keys(std::span<const Params> runs);

// The parameters of a run with the settings of its network that are not among them.
[[nodiscard]] Params with_network(Params params, const Params& network_settings);

// The last part of a key, such as "latency_ms" of "network.latency_ms", or the whole key where another key ends alike.
[[nodiscard]] std::string short_name(const std::string& key, std::span<const std::string> keys);

// The value as text, such as "dr+rcp" or "100". It is empty where the run has none.
[[nodiscard]] std::string value_text(const Params& run, const std::string& key);

// A key and its value in words: "latency 100 ms". A unit at the end of the key's name goes behind the value. A word
// such as dr+rcp stands without its key.
[[nodiscard]] std::string describe(const Params& run, const std::string& key, std::span<const std::string> keys);

// All keys in words: "order 1, dr+rcp, latency 100 ms".
[[nodiscard]] std::string describe(const Params& run, std::span<const std::string> keys);

// The label of an axis, such as "latency [ms]".
[[nodiscard]] std::string axis_label(const std::string& key, std::span<const std::string> keys);

}  // namespace peerd::measure
