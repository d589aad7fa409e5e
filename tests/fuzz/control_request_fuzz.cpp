// Sends any lines to a peer's control interface: each gets one line of JSON of this version, in bounded work, and the
// peer's own objects stay within the range of updates.
//
// An input is a row of requests, one a line.
#include <cstdint>
#include <string_view>

#include <nlohmann/json.hpp>

#include "peerd/peer/control/answer.hpp"
#include "peerd/peer/control/request.hpp"
#include "peerd/peer/feed/json_members.hpp"
#include "tests/fuzz/driven_peer.hpp"
#include "tests/fuzz/require.hpp"

namespace {

using namespace peerd;
using fuzz::require;

// The world has sensors of a few keys; one sets a velocity and one disables other sensors.
constexpr const char* kWorld = R"(#VRML V2.0 utf8
DEF A Transform { children Shape { geometry Box { } } }
DEF B Transform { children Shape { geometry Box { } } }
DEF ADD KeySensor { recipient "A" keyValue 65 value 4e5 0 -1 consume FALSE }
DEF ALSO KeySensor { recipient "B" keyValue 65 value 1 1 1 }
DEF SET KeySensor { recipient "A" keyValue 4115 keyState 256 value 0 3e38 0 absoluteValue TRUE }
DEF OFF KeySensor { keyValue 66 }
ROUTE OFF.keyHit TO ADD.disable
ROUTE ADD.keyHit TO OFF.enabled
)";
constexpr int kLinesMax = 64;  // in one input

class Driver : public fuzz::DrivenPeer {
 public:
  Driver() : DrivenPeer(kWorld) {
    config::PeerObjects objects;
    objects.owned = {object("A")};
    make(std::move(objects));
    pass_until_it_runs();
  }

  void ask(std::string_view line) {
    const control::Answer answer = control::answer(*node_, now_, line);
    require(answer.line.find('\n') == std::string::npos);
    const auto reply = nlohmann::json::parse(answer.line);
    require(reply.at("v") == feed::kMessageVersion && reply.at("ok").is_boolean());
    require(reply.at("ok") == control::parse_request(line).has_value());
    pass();
    while (node_->poll_key_report()) {
    }
    while (node_->poll_edit_report()) {
    }
  }
};

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  Driver driver;
  fuzz::for_each_line(data, size, kLinesMax,
                      [&](std::string_view line) { driver.ask(line.substr(0, control::kLineMax_bytes)); });
  return 0;
}
