#include "peerd/view/gateway/route.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include <nlohmann/json.hpp>

#include "peerd/input/json_text.hpp"

namespace peerd::gateway {
namespace {

constexpr std::string_view kApi = "/api/v1/", kAssets = "/assets/", kRecording = "recording";

struct Parameter {
  std::string_view name;
  bool is_number;
};
// The requests that have a place of their own.
struct Place {
  std::string_view name;
  std::array<Parameter, 2> parameters{};
};
constexpr std::array kPlaces{
    Place{"status"},
    Place{"peers", {{{"from", true}}}},
    Place{"objects", {{{"from", true}, {"count", true}}}},
    Place{"conflicts", {{{"from", true}}}},
    Place{"world"},
    Place{"data", {{{"path", false}, {"key", false}}}},
};

std::expected<nlohmann::json, RefusalKind> value_of(std::string_view text, bool is_number) {
  auto decoded = percent_decoded(text);
  if (!decoded) return std::unexpected(decoded.error());
  if (!is_number) return *std::move(decoded);
  std::uint64_t number = 0;
  const char* const end = decoded->data() + decoded->size();
  const auto [at, failed] = std::from_chars(decoded->data(), end, number);
  if (failed != std::errc() || at != end) return std::unexpected(RefusalKind::kMalformed);
  return number;
}

std::expected<Route, RefusalKind> ask(const Place& place, std::string_view query) {
  nlohmann::json request{{"do", place.name}};
  while (!query.empty()) {
    const std::string_view part = query.substr(0, query.find('&'));
    query.remove_prefix(std::min(query.size(), part.size() + 1));
    const auto equals = part.find('=');
    const std::string_view name = part.substr(0, equals);
    const auto known = std::ranges::find(place.parameters, name, &Parameter::name);
    if (name.empty() || equals == std::string_view::npos || known == place.parameters.end() ||
        request.contains(std::string(name))) {
      return std::unexpected(RefusalKind::kMalformed);
    }
    auto value = value_of(part.substr(equals + 1), known->is_number);
    if (!value) return std::unexpected(value.error());
    request[std::string(name)] = *std::move(value);
  }
  return AskRoute{json_line(request)};
}

std::expected<Route, RefusalKind> found(std::string_view path, std::string_view query) {
  if (path == "/") return AssetRoute{"index.html"};
  if (path == "/metrics") return MetricsRoute{};
  if (path.starts_with(kAssets)) return AssetRoute{std::string(path.substr(1))};
  if (!path.starts_with(kApi)) return std::unexpected(RefusalKind::kNotFound);
  const std::string_view name = path.substr(kApi.size());
  if (name == "request") return RequestRoute{};
  if (name == "scene.glb") return SceneRoute{};
  if (name == "live") return LiveRoute{};
  if (name == kRecording) return RecordingRoute{};
  if (name.starts_with(kRecording) && name[kRecording.size()] == '/') {
    return RecordingRoute{std::string(name.substr(kRecording.size() + 1))};
  }
  const auto place = std::ranges::find(kPlaces, name, &Place::name);
  if (place == kPlaces.end()) return std::unexpected(RefusalKind::kNotFound);
  return ask(*place, query);
}

}  // namespace

std::expected<std::string, RefusalKind> percent_decoded(std::string_view text) {
  std::string decoded;
  while (!text.empty()) {
    const auto length = text.find('%');
    decoded += text.substr(0, length);
    if (length == std::string_view::npos) break;
    unsigned code = 0;
    const std::string_view digits = text.substr(length + 1, 2);
    const auto [at, failed] = std::from_chars(digits.data(), digits.data() + digits.size(), code, 16);
    if (failed != std::errc() || digits.size() != 2 || at != digits.data() + 2) {
      return std::unexpected(RefusalKind::kMalformed);
    }
    decoded += static_cast<char>(code);
    text.remove_prefix(length + 3);
  }
  const auto is_control = [](char c) { return static_cast<unsigned char>(c) < 0x20 || c == 0x7f; };
  if (std::ranges::any_of(decoded, is_control)) return std::unexpected(RefusalKind::kMalformed);
  return decoded;
}

std::expected<Route, RefusalKind> find_route(std::string_view method, std::string_view target) {
  const auto question = target.find('?');
  const std::string_view path = target.substr(0, question);
  const std::string_view query = question == std::string_view::npos ? "" : target.substr(question + 1);
  auto route = found(path, query);
  if (!route) return route;
  const bool posts = std::holds_alternative<RequestRoute>(*route);
  if (method != (posts ? "POST" : "GET")) return std::unexpected(RefusalKind::kMethod);
  return route;
}

}  // namespace peerd::gateway
