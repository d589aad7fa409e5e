#pragma once
#include <span>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

namespace peerd::report {

// How a sweep is laid out and put into words. params: one object per run, swept values by dotted name.
using Params = nlohmann::ordered_json;

// The keys whose value is not the same in all runs (absent counts as a value), in the order of their first appearance.
[[nodiscard]] std::vector<std::string> varying_keys(std::span<const Params> runs);

// "latency_ms" of "network.latency_ms"; the whole key where another of keys ends alike.
[[nodiscard]] std::string short_name(const std::string& key, std::span<const std::string> keys);

// "dr+rcp", "100", "" if absent.
[[nodiscard]] std::string value_text(const Params& run, const std::string& key);

// "latency 100 ms": a unit at the end of a name (STYLE 3) goes behind the value; a bare word such as dr+rcp speaks for
// itself and goes without its key.
[[nodiscard]] std::string describe(const Params& run, const std::string& key, std::span<const std::string> keys);

// All keys in words: "order 1, dr+rcp, latency 100 ms".
[[nodiscard]] std::string describe(const Params& run, std::span<const std::string> keys);

// "latency [ms]".
[[nodiscard]] std::string axis_label(const std::string& key, std::span<const std::string> keys);

}  // namespace peerd::report
