#pragma once
#include <array>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/scene/scene.hpp"
#include "core/vrml/diagnostics.hpp"
#include "core/vrml/document.hpp"
#include "core/vrml/file_loader.hpp"
#include "core/vrml/parse_options.hpp"

namespace peerd {

// Settings of a world stand beside its file, in a side file or on a command line. Paths and patterns are those of
// CollisionInterests. `offset` is the place in the side file's text that a problem is reported at.
struct InterestSetting {
  std::string object;
  std::vector<std::string> with, except;
  CollisionType type = CollisionType::kWitness;
  std::size_t offset = 0;
};

// The fields that appendix C.5 of the thesis adds to a Transform.
struct ObjectSetting {
  std::string object;
  std::optional<std::array<float, 3>> velocity_m_s;
  std::optional<float> distance_threshold_m;
  std::optional<bool> owned_by_founder;
  std::optional<std::uint32_t> layers;
  std::optional<CollisionResponse> response;
  std::size_t offset = 0;
};

struct WorldSettings {
  Conversion conversion;
  bool has_unit = false, has_up = false;  // whether the side file gives them
  bool collides_all = false;              // each object with each other: those at the first level with more than one
  std::vector<InterestSetting> interests;
  std::vector<ObjectSetting> objects;

  [[nodiscard]] bool changes_nodes() const { return collides_all || !interests.empty() || !objects.empty(); }
};

// Returns what ReadOptions::amend is for settings that stand in `side`, a text that becomes one of the world's.
[[nodiscard]] std::function<void(vrml::Document&, vrml::Problems&)> amender_of(WorldSettings settings, Source side,
                                                                               const ReadLimits& limits);

}  // namespace peerd
