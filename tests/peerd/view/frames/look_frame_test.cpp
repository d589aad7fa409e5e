#include "peerd/view/frames/look_frame.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstring>
#include <string>

#include "tests/peerd/view/picture/picture_of_text.hpp"

namespace peerd::view::look_frame_test {

using peerd::testing_support::scene_of;
using testing::ElementsAre;
using testing::FloatEq;
using testing::IsEmpty;
using testing::SizeIs;

struct Record {
  std::uint32_t kind = 0, number = 0;
  std::vector<float> values{};
};

template <class T>
T read_at(std::span<const std::byte> bytes, std::size_t at) {
  T out{};
  if (at + sizeof out > bytes.size()) throw std::runtime_error("the frame is cut off");
  std::memcpy(&out, bytes.data() + at, sizeof out);
  return out;
}

// A viewer reads it so, by the reference alone.
std::vector<Record> read(std::span<const std::byte> bytes) {
  EXPECT_EQ(read_at<std::uint32_t>(bytes, 0), 0x314B4C50u);
  std::vector<Record> out;
  std::size_t at = 8;
  for (std::uint32_t i = read_at<std::uint32_t>(bytes, 4); i > 0; --i) {
    Record& record =
        out.emplace_back(Record{read_at<std::uint32_t>(bytes, at), read_at<std::uint32_t>(bytes, at + 4), {}});
    const auto count = read_at<std::uint32_t>(bytes, at + 8);
    at += 16;
    for (std::uint32_t k = 0; k < count; ++k, at += 4) record.values.push_back(read_at<float>(bytes, at));
  }
  EXPECT_EQ(at, bytes.size());
  return out;
}

std::vector<Record> next(LookStream& stream, const LookTable& table) {
  std::vector<std::byte> frame;
  stream.append(table, frame);
  return read(frame);
}

HostTime at_ms(int ms) { return HostTime{std::chrono::milliseconds(ms)}; }

const char* const kWorld = R"(
DEF T TimeSensor { loop TRUE cycleInterval 4 }
DEF WAVE CoordinateInterpolator { key [0 1] keyValue [0 0 0, 1 0 0, 0 1 0, 0 0 8, 1 0 8, 0 1 8] }
DEF GROW PositionInterpolator { key [0 1] keyValue [1 1 1, 5 5 5] }
DEF GLOW ScalarInterpolator { key [0 1] keyValue [0 1] }
DEF CAR Transform { translation 9 0 0 children DEF X Transform { translation 1 2 3 children Shape {
  appearance Appearance { material DEF M Material { } } geometry Box { } } } }
Shape { geometry IndexedFaceSet { coord DEF C Coordinate { point [0 0 0, 1 0 0, 0 1 0] } coordIndex [0 1 2] } }
ROUTE T.fraction_changed TO WAVE.set_fraction ROUTE WAVE.value_changed TO C.point
ROUTE T.fraction_changed TO GROW.set_fraction ROUTE GROW.value_changed TO X.scale
ROUTE T.fraction_changed TO GLOW.set_fraction ROUTE GLOW.value_changed TO M.transparency)";

std::shared_ptr<const Scene> share(const char* text) { return std::make_shared<const Scene>(scene_of(text)); }

TEST(LookFrame, HasAllThatChangesAtAnInstant) {
  const auto scene = share(kWorld);
  LookTable table;
  table.reset(scene, std::vector{*scene->find("CAR")});
  table.refresh(at_ms(0), 1.0);
  LookStream stream;
  const auto records = next(stream, table);
  ASSERT_THAT(records, SizeIs(3));
  EXPECT_EQ(records[0].kind, 0u);
  EXPECT_THAT(records[0].values, ElementsAre(0, 0, FloatEq(2), 1, 0, FloatEq(2), 0, 1, FloatEq(2)));
  EXPECT_EQ(records[1].kind, 1u);
  EXPECT_THAT(records[1].values, ElementsAre(FloatEq(2), 0, 0, 1, 0, FloatEq(2), 0, 2, 0, 0, FloatEq(2), 3))
      << "in the frame of the car, wherever that is";
  EXPECT_EQ(records[2].kind, 2u);
  EXPECT_THAT(records[2].values, ElementsAre(FloatEq(0.25F)));
}

TEST(LookFrame, EachClientGetsWhatHasChangedSinceItsLastOne) {
  const auto scene = share(kWorld);
  LookTable table;
  table.reset(scene, {});
  table.refresh(at_ms(0), -1.0);
  LookStream first, second;
  EXPECT_THAT(next(first, table), SizeIs(3));
  EXPECT_THAT(next(first, table), IsEmpty());
  table.refresh(at_ms(1000), -1.0);
  EXPECT_THAT(next(first, table), IsEmpty()) << "the world has not begun to move";
  table.refresh(at_ms(2000), 1.0);
  EXPECT_THAT(next(first, table), SizeIs(3));
  EXPECT_THAT(next(second, table), SizeIs(3));
  table.reset(scene, {});
  table.refresh(at_ms(3000), 1.0);
  EXPECT_THAT(next(first, table), SizeIs(3)) << "another revision has everything again";
}

TEST(LookFrame, IsComputedSoOftenAtMost) {
  const auto scene = share(kWorld);
  LookTable table;
  table.reset(scene, {});
  table.refresh(at_ms(0), 1.0);
  LookStream stream;
  (void)next(stream, table);
  table.refresh(at_ms(39), 1.5);
  EXPECT_THAT(next(stream, table), IsEmpty());
  table.refresh(at_ms(40), 1.5);
  EXPECT_THAT(next(stream, table), SizeIs(3));
}

// Each of 20 flags has 5,000 points: 60 kB. A frame has four of them, and all of them come in turn.
TEST(LookFrame, IsBoundedAndLeavesNothingOut) {
  std::string text = "DEF T TimeSensor { loop TRUE }\n";
  std::string points, keys;
  for (int i = 0; i < 5000; ++i) points += std::to_string(i % 100) + " " + std::to_string(i / 100) + " 0, ";
  keys = points;
  for (int i = 0; i < 5000; ++i) keys += std::to_string(i % 100) + " " + std::to_string(i / 100) + " 1, ";
  for (int i = 0; i < 20; ++i) {
    const std::string n = std::to_string(i);
    text += "DEF I" + n + " CoordinateInterpolator { key [0 1] keyValue [" + keys + "] }\n";
    text += "Shape { geometry IndexedFaceSet { coord DEF C" + n + " Coordinate { point [" + points +
            "] } coordIndex [0 1 101] } }\n";
    text += "ROUTE T.fraction_changed TO I" + n + ".set_fraction ROUTE I" + n + ".value_changed TO C" + n + ".point\n";
  }
  const auto scene = share(text.c_str());
  LookTable table;
  table.reset(scene, {});
  LookStream stream;
  std::vector<int> seen(20, 0);
  for (int frame = 0; frame < 10; ++frame) {
    table.refresh(at_ms(100 * frame), 0.05 * frame + 0.01);
    std::vector<std::byte> bytes;
    stream.append(table, bytes);
    EXPECT_LE(bytes.size(), LookStream::kFrame_bytes + 8);
    for (const Record& record : read(bytes)) ++seen[record.number];
  }
  for (const int count : seen) EXPECT_EQ(count, 2);
}

}  // namespace peerd::view::look_frame_test
