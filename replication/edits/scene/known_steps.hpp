#pragma once
#include <cstddef>
#include <cstdint>
#include <vector>

namespace peerd::replication {

// KnownSteps say what one author knew of the log of another as its own log went on: from an operation of that number
// on, all up to one of the other's. A step is kept as its differences from the one before it, in two bytes mostly.
class KnownSteps {
 public:
  // 0: there is none.
  [[nodiscard]] std::uint32_t last_number() const { return last_.number; }
  [[nodiscard]] std::uint32_t last_known() const { return last_.known; }
  // Both are higher than those of the last one.
  void add(std::uint32_t number, std::uint32_t known);
  // The last operation of the other's log that was known from that number on; 0: none.
  [[nodiscard]] std::uint32_t known_at(std::uint32_t number) const;

 private:
  static constexpr std::size_t kSteps = 32;  // from one mark to the next
  struct Step {
    std::uint32_t number = 0, known = 0;
  };
  struct Mark {
    Step step;             // the first of kSteps
    std::size_t next = 0;  // where the differences of those behind it begin
  };
  void put(std::uint32_t difference);
  [[nodiscard]] std::uint32_t take(std::size_t& at) const;

  std::vector<Mark> marks_;
  std::vector<std::uint8_t> differences_;  // as varints
  Step last_;
  std::size_t since_mark_ = 0;  // steps
};

}  // namespace peerd::replication
