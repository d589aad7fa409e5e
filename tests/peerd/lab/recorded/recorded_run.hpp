#pragma once
#include <gtest/gtest.h>

#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <string>

#include "tests/peerd/scratch_folder.hpp"

namespace peerd::testing_support {

// A scenario that the program has simulated, where asked for with a capture of each peer.
class SimulatedFolder {
 public:
  enum class Captures : std::uint8_t { kNone, kAll };
  explicit SimulatedFolder(const std::string& scenario, const std::string& options = "",
                           Captures wanted = Captures::kNone) {
    const std::string command = std::string(PEERD_PROGRAM) + " sim " + scenario + " --samples all --out " +
                                run().string() + (wanted == Captures::kAll ? " --capture " + captures().string() : "") +
                                ' ' + options + " >/dev/null 2>" + (folder_ / "errors").string();
    EXPECT_EQ(std::system(command.c_str()), 0) << command << '\n' << text_of(folder_ / "errors");
  }
  [[nodiscard]] std::filesystem::path run() const { return folder_ / "run"; }
  [[nodiscard]] std::filesystem::path captures() const { return folder_ / "captures"; }

 private:
  ScratchFolder folder_;
};

}  // namespace peerd::testing_support
