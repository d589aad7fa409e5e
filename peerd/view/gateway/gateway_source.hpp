#pragma once
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "core/math.hpp"
#include "peerd/peer/control/answer.hpp"
#include "peerd/view/frames/pose_frame.hpp"
#include "peerd/view/picks/walk.hpp"

namespace peerd::gateway {

// The scene as glTF binary.
struct SceneFile {
  std::uint32_t revision = 0;
  std::shared_ptr<const std::string> glb;  // null: it can't be written
  std::string why_not;
};

// A file of a recording.
struct RecordedFile {
  std::shared_ptr<const std::string> bytes;
  std::string_view content_type = "application/octet-stream";
};

// The peer, or the recording, that a gateway shows. Everything is called in the thread of its io_context, and does a
// bounded amount of work.
class GatewaySource {
 public:
  GatewaySource() = default;
  GatewaySource(const GatewaySource&) = delete;
  GatewaySource& operator=(const GatewaySource&) = delete;
  virtual ~GatewaySource() = default;

  // Answers one request of the control protocol.
  virtual control::Answer ask(std::string_view request) = 0;
  // The peer's counters, peers, clock and regions in the text format of Prometheus.
  virtual std::string metrics() = 0;

  // The revision of the scene that viewers have to have.
  virtual std::uint32_t revision() = 0;
  // Calls `done` once it has the scene of the revision as it was at this call, or of a later one; before it returns
  // where it has that already.
  virtual void make_scene(std::function<void(const SceneFile&)> done) = 0;
  // The client's next frame of poses, valid until its next one.
  virtual std::span<const std::byte> next_frame(view::PoseStream& client) = 0;
  // The replies to "surroundings" and "hierarchy".
  virtual std::string surroundings() = 0;
  virtual std::string hierarchy(const std::string& path, std::uint32_t level) = 0;
  // The replies to "pick", "walk" and "inspect".
  virtual std::string pick(const Vec3& origin, const Vec3& direction) = 0;
  virtual std::string walk(const view::AvatarSize& size, const view::Stride& stride, const std::string& except) = 0;
  virtual std::string inspect(std::uint32_t node) = 0;
  virtual std::string inspect_at(const std::string& path) = 0;

  // A file of the recording that it shows, by its name; "" says what it has. None: there is none of that name. A peer
  // has no recording, and says so.
  virtual std::optional<RecordedFile> recorded_file(std::string_view name);
};

}  // namespace peerd::gateway
