#include "peerd/control/control_path.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>

#include "tests/peerd/scratch_folder.hpp"

namespace peerd::api::control_path_test {

namespace fs = std::filesystem;
using testing::HasSubstr;

// Sets XDG_RUNTIME_DIR to a folder of the test's own, and restores it.
class ControlPath : public testing::Test {
 protected:
  ControlPath() {
    if (const char* value = std::getenv("XDG_RUNTIME_DIR")) before = value;
    setenv("XDG_RUNTIME_DIR", folder.path().c_str(), 1);
    fs::create_directory(folder / "peerd");
  }
  ~ControlPath() override {
    if (before) {
      setenv("XDG_RUNTIME_DIR", before->c_str(), 1);
    } else {
      unsetenv("XDG_RUNTIME_DIR");
    }
  }
  void listen(const std::string& peer) const { folder.write("peerd/" + peer + ".sock", ""); }

  testing_support::ScratchFolder folder;
  std::optional<std::string> before;
};

TEST_F(ControlPath, TheFolderIsThatOfTheVariable) {
  EXPECT_EQ(runtime_folder(), folder / "peerd");
  EXPECT_EQ(default_socket("car"), folder / "peerd" / "car.sock");
}

TEST_F(ControlPath, ARelativePathOrNoneIsNoFolder) {
  setenv("XDG_RUNTIME_DIR", "run", 1);
  EXPECT_EQ(runtime_folder(), std::nullopt) << "XDG: it must be absolute";
  unsetenv("XDG_RUNTIME_DIR");
  EXPECT_EQ(runtime_folder(), std::nullopt);
  EXPECT_EQ(default_socket("car"), std::nullopt);
  const auto found = find_socket("car");
  ASSERT_FALSE(found);
  EXPECT_THAT(found.error().text, HasSubstr("say --control PATH"));
}

TEST_F(ControlPath, ANamedPeersSocketIsFoundWithoutLooking) {
  EXPECT_EQ(find_socket("car").value(), folder / "peerd" / "car.sock");
}

TEST_F(ControlPath, TheOnlyPeerNeedsNoName) {
  listen("car");
  folder.write("peerd/car.sock.lock", "");
  EXPECT_EQ(find_socket("").value(), folder / "peerd" / "car.sock");
}

TEST_F(ControlPath, OfSeveralPeersNoneIsChosen) {
  listen("van");
  listen("car");
  const auto found = find_socket("");
  ASSERT_FALSE(found);
  EXPECT_EQ(found.error().text, "error: which peer? Say --name NAME; there are car, van");
}

TEST_F(ControlPath, WithoutPeersTheEnvironmentIsTheError) {
  const auto found = find_socket("");
  ASSERT_FALSE(found);
  EXPECT_THAT(found.error().text, HasSubstr("no peer listens in " + (folder / "peerd").string()));
  EXPECT_EQ(found.error().exit_code, 3);
}

}  // namespace peerd::api::control_path_test
