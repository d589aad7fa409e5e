#include "peerd/peer/control/control_path.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <memory>
#include <vector>

#include <sys/stat.h>
#include <unistd.h>
#include <boost/asio/io_context.hpp>
#include <boost/asio/local/stream_protocol.hpp>

#include "tests/must.hpp"
#include "tests/peerd/scratch_folder.hpp"

namespace peerd::control::control_path_test {

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
  void listen(const std::string& peer) {
    const Protocol::endpoint at((folder / "peerd" / (peer + ".sock")).string());
    listening.push_back(std::make_unique<Protocol::acceptor>(io, at));
  }

  using Protocol = boost::asio::local::stream_protocol;
  boost::asio::io_context io{1};
  std::vector<std::unique_ptr<Protocol::acceptor>> listening;
  testing_support::ScratchFolder folder;
  std::optional<std::string> before;
};

TEST_F(ControlPath, TheFolderIsThatOfTheVariable) {
  EXPECT_EQ(runtime_folder(), folder / "peerd");
  EXPECT_EQ(default_socket("car", 7), folder / "peerd" / "car.sock");
}

TEST_F(ControlPath, WithoutTheVariableTheFolderIsAUsersOwn) {
  setenv("XDG_RUNTIME_DIR", "run", 1);
  const fs::path relative = runtime_folder();
  unsetenv("XDG_RUNTIME_DIR");
  EXPECT_EQ(runtime_folder(), relative) << "XDG: it must be absolute";
  EXPECT_TRUE(relative.is_absolute());
  EXPECT_THAT(relative.string(), HasSubstr(std::to_string(geteuid())));
}

TEST_F(ControlPath, TheFolderIsMadeForThisUserAlone) {
  fs::remove(folder / "peerd");
  ASSERT_TRUE(make_runtime_folder());
  struct stat made {};
  ASSERT_EQ(stat((folder / "peerd").c_str(), &made), 0);
  EXPECT_EQ(made.st_mode & 0777, 0700u);
  EXPECT_TRUE(make_runtime_folder()) << "once more";
}

TEST_F(ControlPath, AFolderThatOthersMayWriteToIsRefused) {
  fs::permissions(folder / "peerd", fs::perms::all);
  EXPECT_THAT(error_of(make_runtime_folder()), IsError(3, HasSubstr("other users may write to it")));
}

TEST_F(ControlPath, ALinkIsNoFolder) {
  fs::remove(folder / "peerd");
  fs::create_directory_symlink(folder.path(), folder / "peerd");
  EXPECT_THAT(error_of(make_runtime_folder()).text, HasSubstr("something else stands there"));
}

TEST_F(ControlPath, ASecondPeerOfTheNameHasASocketOfItsOwn) {
  listen("car");
  EXPECT_EQ(default_socket("car", 7), folder / "peerd" / "car-7.sock");
  listening.clear();
  EXPECT_EQ(default_socket("car", 7), folder / "peerd" / "car.sock") << "the first is dead";
}

TEST_F(ControlPath, ANamedPeersSocketIsFound) {
  listen("car");
  listen("van");
  EXPECT_EQ(find_socket("van").value(), folder / "peerd" / "van.sock");
  EXPECT_THAT(error_of(find_socket("bus")), IsError(3, "error: no peer bus listens; there are car, van"));
}

TEST_F(ControlPath, TheOnlyPeerNeedsNoName) {
  listen("van");
  listening.clear();  // it was killed, and its socket stays
  listen("car");
  folder.write("peerd/car.sock.lock", "");
  EXPECT_EQ(find_socket("").value(), folder / "peerd" / "car.sock");
}

TEST_F(ControlPath, OfSeveralPeersNoneIsChosen) {
  listen("van");
  listen("car");
  EXPECT_EQ(error_of(find_socket("")).text, "error: which peer? Say --name NAME; there are car, van");
}

TEST_F(ControlPath, WithoutPeersTheEnvironmentIsTheError) {
  EXPECT_THAT(error_of(find_socket("")), IsError(3, HasSubstr("no peer listens in " + (folder / "peerd").string())));
}

}  // namespace peerd::control::control_path_test
