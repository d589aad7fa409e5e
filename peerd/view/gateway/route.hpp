#pragma once
#include <expected>
#include <string>
#include <string_view>
#include <variant>

#include "peerd/view/gateway/refusal_kind.hpp"

namespace peerd::gateway {

// A route is what a request of HTTP asks for, by its method and target. All of it is hostile input.
struct AssetRoute {
  std::string name;  // as ViewerAssets has it: "index.html", "assets/NAME"
};
struct AskRoute {
  std::string request;  // of the control protocol, which changes nothing
};
struct RequestRoute {};  // the request of the control protocol is in the body
struct SceneRoute {};
struct MetricsRoute {};
struct LiveRoute {};
struct RecordingRoute {
  std::string name;  // of a file of the recording; "": what it has
};
using Route = std::variant<AssetRoute, AskRoute, RequestRoute, SceneRoute, MetricsRoute, LiveRoute, RecordingRoute>;

[[nodiscard]] std::expected<Route, RefusalKind> find_route(std::string_view method, std::string_view target);

// Decodes %XX. None of a text that has another % or a control character.
[[nodiscard]] std::expected<std::string, RefusalKind> percent_decoded(std::string_view text);

}  // namespace peerd::gateway
