#pragma once
#include <cstdint>
#include <memory>
#include <optional>
#include <string_view>
#include <vector>

#include "core/animation/animation.hpp"
#include "core/vrml/document.hpp"

namespace peerd::view {

// The fields that are seen, move nothing, and are driven by the world's own TimeSensors, as a function of world time:
// diffuseColor, emissiveColor and transparency of a Material; on, color and intensity of a
// light. A driven look goes by its number: they are sorted by node and field.
class DrivenLooks {
 public:
  explicit DrivenLooks(const std::shared_ptr<const vrml::Document>& document);

  [[nodiscard]] std::uint32_t count() const { return static_cast<std::uint32_t>(looks_.size()); }
  // The number of a field of a node of the document; none: nothing drives it, or no viewer shows that it changes.
  [[nodiscard]] std::optional<std::uint32_t> find(std::uint32_t node, std::string_view field) const;
  // Writes the value of a look at world time t_s; where no event has come by then, that of the file.
  void value(std::uint32_t look, double t_s, std::vector<float>& out);

 private:
  struct Look {
    std::uint32_t node = 0;  // of the document
    std::string_view field;
    animation::FieldId id;
  };
  std::shared_ptr<const vrml::Document> document_;
  std::optional<animation::Animation> animation_;  // none: nothing is driven
  std::vector<Look> looks_;
  animation::Value value_;  // scratch
};

}  // namespace peerd::view
