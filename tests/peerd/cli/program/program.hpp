#pragma once
#include <gtest/gtest.h>
#include <sys/wait.h>

#include <cstdlib>
#include <string>
#include <string_view>

#include "tests/peerd/scratch_folder.hpp"

namespace peerd::testing_support {

// The program itself, as a shell starts it.
struct Said {
  int exit_code;  // -1: a signal has ended it
  std::string out, err;
};

class Program : public testing::Test {
 protected:
  // `words` are a shell's, so they may redirect the program's input and outputs.
  Said run(const std::string& words, const std::string& program = PEERD_PROGRAM) {
    const std::string out = folder / "said.out", err = folder / "said.err";
    const std::string line =
        "cd '" + folder.path().string() + "' && '" + program + "' >'" + out + "' 2>'" + err + "' " + words;
    const int status = std::system(line.c_str());
    return {WIFEXITED(status) ? WEXITSTATUS(status) : -1, text_of(out), text_of(err)};
  }
  ScratchFolder folder;
};

inline constexpr std::string_view kStillWorld =
    "#VRML V2.0 utf8\nDEF A Transform { children Shape { geometry Box {} } }\n";
inline constexpr std::string_view kMovingBox =  // a scenario in w.wrl, which is that world
    "world = \"w.wrl\"\nduration_s = 0.1\n[peer.a]\nid = 1\nowns = [\"A\"]\n[motion.A]\nx = \"t\"\n";

}  // namespace peerd::testing_support
