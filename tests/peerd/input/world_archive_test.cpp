#include "peerd/input/world_archive.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <random>

#include "core/scene/reader.hpp"
#include "peerd/input/world_file.hpp"
#include "tests/must.hpp"
#include "tests/peerd/scratch_folder.hpp"

namespace peerd::world_archive_test {

using testing_support::ScratchFolder;

constexpr std::uint64_t kMost_bytes = 1 << 20;

// A world of three files in two folders, one of which is included twice and one has a prototype.
class Archived : public testing::Test {
 protected:
  Archived() {
    std::filesystem::create_directories(folder / "parts");
    folder.write("parts/wheel.wrl", "#VRML V2.0 utf8\nDEF WHEEL Transform { }\n");
    folder.write("parts/lib.wrl",
                 "#VRML V2.0 utf8\nPROTO CAR [ ] { Transform { children Inline { url \"wheel.wrl\" } } }\n");
    path = folder.write("town.wrl",
                        "#VRML V2.0 utf8\nEXTERNPROTO CAR [ ] \"parts/lib.wrl#CAR\"\nDEF ONE CAR { }\n"
                        "DEF TWO Inline { url [ \"nowhere.wrl\", \"./parts/wheel.wrl\" ] }\n");
  }
  static std::unique_ptr<const WorldFile> read(const std::filesystem::path& from) {
    auto file = read_world_file(from);
    EXPECT_TRUE(file && (*file)->result.scene) << from;
    return file ? *std::move(file) : nullptr;
  }

  ScratchFolder folder;
  std::filesystem::path path;
};

TEST_F(Archived, GivesTheSameWorldWithoutItsFiles) {
  const auto original = read(path);
  const std::string bytes = pack(archive_of(*original));
  std::filesystem::remove_all(folder / "parts");
  std::filesystem::remove(path);
  const auto again = read(folder.write("elsewhere", bytes));
  EXPECT_EQ(content_hash(again->result), content_hash(original->result));
  ASSERT_EQ(again->result.scene->instances.size(), original->result.scene->instances.size());
  for (std::uint32_t i = 0; i < original->result.scene->instances.size(); ++i) {
    EXPECT_EQ(again->result.scene->id_of(i), original->result.scene->id_of(i));
  }
  EXPECT_EQ(again->result.diagnostics.size(), original->result.diagnostics.size());
}

TEST_F(Archived, IsTheSameWhereverTheFilesAre) {
  const std::string bytes = pack(archive_of(*read(path)));
  const ScratchFolder& here = folder;
  std::filesystem::rename(here / "parts", here / "parts.moved");
  std::filesystem::create_directories(here / "deeper" / "parts");
  std::filesystem::rename(here / "parts.moved", here / "deeper" / "parts");
  std::filesystem::rename(path, here / "deeper" / "city.wrl");
  EXPECT_EQ(pack(archive_of(*read(here / "deeper" / "city.wrl"))), bytes);
}

TEST_F(Archived, CanBeArchivedAgain) {
  const std::string bytes = pack(archive_of(*read(path)));
  EXPECT_EQ(pack(archive_of(*read(folder.write("elsewhere", bytes)))), bytes);
}

TEST_F(Archived, DamageIsSaid) {
  const std::string bytes = pack(archive_of(*read(path)));
  for (std::size_t size = 0; size < bytes.size(); ++size) {
    EXPECT_FALSE(unpack(std::string_view(bytes).substr(0, size), kMost_bytes)) << size;
  }
  EXPECT_FALSE(unpack(bytes + "x", kMost_bytes));
  EXPECT_THAT(error_of(read_world_file(folder.write("cut", bytes.substr(0, bytes.size() - 1)))),
              IsError(1, testing::HasSubstr("cut: error: the archive cannot be read: ")));
}

TEST_F(Archived, AChangedByteIsReadOrRefused) {
  const std::string bytes = pack(archive_of(*read(path)));
  std::mt19937_64 random(1);
  for (int i = 0; i < 20'000; ++i) {
    std::string changed = bytes;
    changed[random() % changed.size()] = static_cast<char>(random());
    const auto archive = unpack(changed, kMost_bytes);
    if (!archive) continue;
    for (const ArchivedUrl& each : archive->urls) {
      ASSERT_LT(each.in, archive->files.size());
      ASSERT_LT(each.leads_to, archive->files.size());
    }
  }
}

TEST(WorldArchive, UnpacksNoMoreThanItMay) {
  const std::string bytes = pack({{{"", std::string(1 << 20, ' ')}}, {}});
  EXPECT_LT(bytes.size(), 10'000u);
  EXPECT_TRUE(unpack(bytes, 2 << 20));
  EXPECT_THAT(error_of(unpack(bytes, 1 << 20)), testing::HasSubstr("more than 1048576 bytes"));
}

}  // namespace peerd::world_archive_test
