#pragma once
#include <algorithm>
#include <cstdint>
#include <vector>

namespace peerd::vrml {

// A PositionMap says where the parts of a text that was made of another one stand in that other one, as offsets. The
// texts of X3D in XML are read so: mistakes are reported in the file that somebody wrote.
class PositionMap {
 public:
  // From `made` on, up to the next part, the text was copied byte by byte from `original` on.
  void add_copy(std::size_t made, std::size_t original) { add(made, original, true); }
  // From `made` on, up to the next part, the text stands for what is at `original`.
  void add_place(std::size_t made, std::size_t original) { add(made, original, false); }
  // Forgets all parts from `made` on.
  void cut(std::size_t made) {
    while (!parts_.empty() && parts_.back().made >= made) parts_.pop_back();
  }

  [[nodiscard]] std::uint32_t original_of(std::uint32_t made) const {
    const auto next = std::ranges::upper_bound(parts_, made, {}, &Part::made);
    if (next == parts_.begin()) return 0;
    const Part& part = *(next - 1);
    return part.original + (part.is_copy ? made - part.made : 0);
  }

 private:
  struct Part {
    std::uint32_t made = 0;
    std::uint32_t original : 31 = 0;
    std::uint32_t is_copy : 1 = 0;
  };

  void add(std::size_t made, std::size_t original, bool is_copy) {
    parts_.push_back({static_cast<std::uint32_t>(made), static_cast<std::uint32_t>(original) & 0x7FFFFFFFU, is_copy});
  }

  std::vector<Part> parts_;  // by `made`, ascending
};

}  // namespace peerd::vrml
