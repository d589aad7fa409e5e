#pragma once
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>

#include "peerd/lab/recorded/recording.hpp"
#include "peerd/view/gateway/gateway_source.hpp"

namespace peerd::recorded {

// A recording as a gateway shows it. Its files (docs/reference/gateway.md) are unpacked when they are asked for. What
// needs a peer is refused.
class RecordedSource : public gateway::GatewaySource {
 public:
  explicit RecordedSource(Recording recording) : recording_(std::move(recording)) {}

  control::Answer ask(std::string_view request) override;
  std::string metrics() override { return {}; }
  std::uint32_t revision() override { return 0; }
  void make_scene(std::function<void(const gateway::SceneFile&)> done) override;
  std::span<const std::byte> next_frame(view::PoseStream& client) override { return client.next(nothing_); }
  std::string surroundings() override;
  std::string hierarchy(const std::string& path, std::uint32_t level) override;
  std::string pick(const Vec3& origin, const Vec3& direction) override;
  std::string walk(const view::AvatarSize& size, const view::Stride& stride, const std::string& except) override;
  std::string inspect(std::uint32_t node) override;
  std::string inspect_at(const std::string& path) override;
  std::optional<gateway::RecordedFile> recorded_file(std::string_view name) override;

 private:
  [[nodiscard]] std::string contents() const;

  Recording recording_;
  view::PoseTable nothing_;
};

}  // namespace peerd::recorded
