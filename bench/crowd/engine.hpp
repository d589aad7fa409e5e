#pragma once
#include <cstdint>
#include <memory>
#include <string_view>
#include <vector>

#include "bench/crowd/scene.hpp"

namespace peerd::bench {

inline constexpr double kStep_s = 1.0 / 60.0;

// A scene in an engine, from its beginning on.
class CrowdEngine {
 public:
  virtual ~CrowdEngine() = default;
  virtual void step() = 0;  // by kStep_s
  // The bodies in their order, as they are after the last step.
  virtual void poses(std::vector<CrowdPose>& bodies) = 0;
  // How often two have begun to touch so far.
  [[nodiscard]] virtual std::uint64_t contacts() = 0;
};

// An engine by its name, and how it begins; `begin` is null where it was not found.
struct CrowdEngineKind {
  std::string_view name;
  std::unique_ptr<CrowdEngine> (*begin)(const CrowdScene& scene);
  bool is_exact;  // its contacts are at contact times, so that nothing may be in anything
};

[[nodiscard]] std::unique_ptr<CrowdEngine> peerd_engine(const CrowdScene& scene);
[[nodiscard]] std::unique_ptr<CrowdEngine> bullet_engine(const CrowdScene& scene);
[[nodiscard]] std::unique_ptr<CrowdEngine> jolt_engine(const CrowdScene& scene);
[[nodiscard]] std::unique_ptr<CrowdEngine> box3d_engine(const CrowdScene& scene);

}  // namespace peerd::bench
